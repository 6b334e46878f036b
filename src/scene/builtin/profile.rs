//! Moulding profiles: plane curves to be turned on a lathe or run along a wall.

use super::Detail;
use glam::Vec2;

/// One smooth piece of a profile: a quadratic Bezier curve, or a line if `control` is `None`.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from: Vec2,
    control: Option<Vec2>,
    to: Vec2,
    /// Segments at full detail.
    segments: f32,
}

/// A point of a sampled profile: position, unit normal, and the length of the profile up to it.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    pub point: Vec2,
    pub normal: Vec2,
    pub length: f32,
}

/// A profile: `x` is the radius or the distance from the wall, `y` the height along the axis. The solid is on the left of the
/// curve's direction, so an outline is drawn upwards.
#[derive(Debug, Clone)]
pub struct Profile {
    pen: Vec2,
    pieces: Vec<Piece>,
}

impl Profile {
    pub fn from(x: f32, y: f32) -> Self {
        Self { pen: Vec2::new(x, y), pieces: Vec::new() }
    }

    pub fn line(mut self, x: f32, y: f32) -> Self {
        let to = Vec2::new(x, y);
        self.pieces.push(Piece { from: self.pen, control: None, to, segments: 1.0 });
        self.pen = to;
        self
    }

    /// A quadratic Bezier curve.
    pub fn curve(mut self, control: (f32, f32), to: (f32, f32), segments: f32) -> Self {
        self.pieces.push(Piece { from: self.pen, control: Some(control.into()), to: to.into(), segments });
        self.pen = to.into();
        self
    }

    /// A half-round moulding at the present `x`, from the present `y` to the given one.
    pub fn torus(self, bulge: f32, y: f32, segments: f32) -> Self {
        let (x, middle) = (self.pen.x, 0.5 * (self.pen.y + y));
        let quarter = 0.5 * (middle - self.pen.y).abs().min(bulge);
        self.curve((x + bulge, middle - quarter), (x + bulge, middle), segments).curve((x + bulge, middle + quarter), (x, y), segments)
    }

    /// The smooth runs of the profile at a level of detail. At low levels mouldings are simplified to their main lines.
    pub fn runs(&self, detail: Detail) -> Vec<Vec<Sample>> {
        let mut length = 0.0;
        // Long profiles are simplified first, so that the number of triangles does not jump.
        if !detail.shows(if self.pieces.len() > 12 { 0.46 } else { 0.56 }) {
            let mut points = vec![self.pieces[0].from];
            for piece in &self.pieces {
                if piece.control.is_some() {
                    points.extend([0.2, 0.4, 0.6, 0.8].map(|t| piece.at(t).0));
                }
                points.push(piece.to);
            }
            let tolerance = (0.0025 / detail.0).min(0.12);
            return thinned(&points, tolerance)
                .windows(2)
                .map(|ends| {
                    let normal = -(ends[1] - ends[0]).perp().normalize();
                    let from = Sample { point: ends[0], normal, length };
                    length += ends[0].distance(ends[1]);
                    vec![from, Sample { point: ends[1], normal, length }]
                })
                .collect();
        }
        self.pieces
            .iter()
            .map(|piece| {
                let segments = if piece.control.is_some() { detail.count(piece.segments, 1) } else { 1 };
                let mut last = piece.from;
                (0..=segments)
                    .map(|i| {
                        let (point, tangent) = piece.at(i as f32 / segments as f32);
                        length += last.distance(point);
                        last = point;
                        Sample { point, normal: -tangent.perp().normalize(), length }
                    })
                    .collect()
            })
            .collect()
    }
}

impl Piece {
    /// Point and tangent at the parameter `t`.
    fn at(&self, t: f32) -> (Vec2, Vec2) {
        match self.control {
            None => (self.from.lerp(self.to, t), self.to - self.from),
            Some(control) => {
                let (a, b) = (self.from.lerp(control, t), control.lerp(self.to, t));
                (a.lerp(b, t), b - a)
            }
        }
    }
}

/// Ramer-Douglas-Peucker simplification: no omitted point is farther than `tolerance` from the line.
fn thinned(points: &[Vec2], tolerance: f32) -> Vec<Vec2> {
    let (first, last) = (points[0], points[points.len() - 1]);
    let chord = (last - first).normalize_or(Vec2::X);
    let far =
        (1..points.len().saturating_sub(1)).map(|i| (i, (points[i] - first).perp_dot(chord).abs())).max_by(|a, b| a.1.total_cmp(&b.1));
    match far {
        Some((i, distance)) if distance > tolerance => {
            let mut kept = thinned(&points[..=i], tolerance);
            kept.pop();
            kept.extend(thinned(&points[i..], tolerance));
            kept
        }
        _ => vec![first, last],
    }
}
