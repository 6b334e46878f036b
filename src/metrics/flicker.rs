//! Flicker: how much what stays in sight changes from frame to frame.
//!
//! The temporal image difference of Barák, Bittner and Havran 2013, section 6.2: each pixel of a frame is looked for in the next
//! one by its world position, and the figure is the root mean square of the differences of intensity over the pixels that were
//! found. An intensity is the luminance of a colour, in the colour's unit.
//!
//! A pixel is compared with the **nearest** pixel of the next frame, not with a blend of four. A blend averages noise away, by an
//! amount that depends on where the camera's motion puts the four: noise of variance s² would give a flicker from √(5/4) s to √2 s.
//! With the nearest pixel it is √2 s however the camera moves, and 0 where nothing does. The price is that a gradient shows by up
//! to half a pixel of it, whatever lights the picture: a reference sequence through the same matches says how much that is.

use super::heatmap;
use crate::world::projection::View;
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

/// Cosine of 20 degrees: what is turned farther is another surface, or another side of it.
const SAME_NORMAL: f32 = 0.939_692_6;

/// A point may be so many pixels' footprints off the tangent plane of what it is compared with. On one surface it is off by its
/// curvature, and by the slope of its shading normal against it, which is not the tangent plane's.
const OFF_PLANE: f64 = 1.0;

/// And so many, stretched as the surface is slanted, along it. The nearest pixel's centre is at most 0.71 away; the rest is for
/// shading normals that are less slanted than their surface.
const ALONG_PLANE: f64 = 2.0;

/// Slants beyond about 84 degrees stretch no more.
const MOST_SLANTED: f64 = 0.1;

/// What the pixels of a frame show, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Surfaces {
    pub view: View,
    /// World positions, metres.
    pub positions: Vec<Vec3>,
    /// World normals of length 1; zero where a pixel shows no surface.
    pub normals: Vec<Vec3>,
}

/// What became of a pixel in the next frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// It is shown by the next frame's pixel of this number.
    Matched(u32),
    /// It shows no surface.
    Empty,
    /// It went out of the picture.
    Outside,
    /// Another surface is there, or none.
    Hidden,
    /// The surface there faces another way.
    Turned,
}

/// What became of each pixel of a frame in the next one.
#[derive(Debug, Clone, PartialEq)]
pub struct Matches(Vec<Fate>);

/// The flicker between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pair {
    /// Root mean square of the differences of the matched pixels' intensities; `None` where no pixel was matched.
    pub flicker: Option<f64>,
    /// Mean intensity of the matched pixels in both frames: what `flicker` may be held against.
    pub mean: Option<f64>,
    /// Pixels of the first frame that the next one shows again.
    pub matched: u64,
    /// Those that show a surface at all: `matched`, `outside`, `hidden` and `turned` together.
    pub surfaces: u64,
    /// Those whose surface went out of the picture.
    pub outside: u64,
    /// Those in whose place another surface is seen.
    pub hidden: u64,
    /// Those in whose place the surface faces another way.
    pub turned: u64,
    /// All of them.
    pub pixels: u64,
}

/// The flicker over a walk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flicker {
    /// Root mean square over the matched pixels of all pairs together: a pair counts by its matched pixels.
    pub flicker: f64,
    /// Mean of the pairs' flicker, each pair counting the same.
    pub mean_of_pairs: f64,
    /// The flicker of the worst pair.
    pub largest: f64,
    /// Mean intensity of the matched pixels.
    pub mean: f64,
    /// Matched pixels over those that show a surface, of all pairs.
    pub matched_share: f64,
}

/// Looks for each pixel of a frame in the next one. The two may differ in size.
///
/// A pixel's world position is projected into the next view, and the pixel there is its match unless what it shows is elsewhere:
/// farther than a pixel's footprint off the tangent plane, farther along it than the nearest pixel can be, or turned by more than
/// 20 degrees.
pub fn matches(previous: &Surfaces, next: &Surfaces) -> Matches {
    previous.check();
    next.check();
    let pixels = previous.positions.par_iter().zip(&previous.normals);
    Matches(pixels.map(|(position, normal)| next.fate(*position, *normal)).collect())
}

impl Surfaces {
    fn check(&self) {
        let pixels = self.view.width as usize * self.view.height as usize;
        assert!(self.positions.len() == pixels && self.normals.len() == pixels, "a position and a normal for each of {pixels} pixels");
    }

    /// What this frame shows of a point of the one before.
    fn fate(&self, position: Vec3, normal: Vec3) -> Fate {
        if normal == Vec3::ZERO {
            return Fate::Empty;
        }
        let inside = |at: f64, size: u32| (at >= 0.0 && at < f64::from(size)).then_some(at as usize);
        let Some((at, _)) = self.view.pixel_of(position) else { return Fate::Outside };
        let (Some(x), Some(y)) = (inside(at.x, self.view.width), inside(at.y, self.view.height)) else { return Fate::Outside };
        let pixel = y * self.view.width as usize + x;
        let there = self.normals[pixel];
        if there == Vec3::ZERO {
            return Fate::Hidden;
        }
        let seen = self.positions[pixel].as_dvec3();
        let plane = there.as_dvec3();
        let eye = seen - Vec3::from(self.view.position).as_dvec3();
        let footprint = self.view.pixel_size() * eye.dot(Vec3::from(self.view.forward).as_dvec3());
        let slant = (eye.normalize_or_zero().dot(plane)).abs().max(MOST_SLANTED);
        let apart = position.as_dvec3() - seen;
        let off = apart.dot(plane);
        let along = (apart - off * plane).length();
        if off.abs() > OFF_PLANE * footprint || along > ALONG_PLANE * footprint / slant {
            return Fate::Hidden;
        }
        if normal.dot(there) < SAME_NORMAL { Fate::Turned } else { Fate::Matched(pixel as u32) }
    }
}

impl Matches {
    /// The pixels' fates, row by row from the top of the first frame.
    pub fn fates(&self) -> &[Fate] {
        &self.0
    }

    /// The next frame's intensity less the first one's, for each pixel of the first; `None` where it has no match.
    pub fn differences(&self, previous: &[f32], next: &[f32]) -> Vec<Option<f64>> {
        assert_eq!(previous.len(), self.0.len(), "an intensity a pixel");
        let difference = |(fate, was): (&Fate, &f32)| match fate {
            Fate::Matched(pixel) => Some(f64::from(next[*pixel as usize]) - f64::from(*was)),
            _ => None,
        };
        self.0.iter().zip(previous).map(difference).collect()
    }

    /// The flicker between two frames of these intensities.
    pub fn pair(&self, previous: &[f32], next: &[f32]) -> Pair {
        assert_eq!(previous.len(), self.0.len(), "an intensity a pixel");
        let (mut squares, mut sum) = (0.0, 0.0);
        let mut pair =
            Pair { flicker: None, mean: None, matched: 0, surfaces: 0, outside: 0, hidden: 0, turned: 0, pixels: self.0.len() as u64 };
        for (fate, was) in self.0.iter().zip(previous) {
            match fate {
                Fate::Matched(pixel) => {
                    let (was, is) = (f64::from(*was), f64::from(next[*pixel as usize]));
                    squares += (is - was) * (is - was);
                    sum += 0.5 * (is + was);
                    pair.matched += 1;
                }
                Fate::Empty => continue,
                Fate::Outside => pair.outside += 1,
                Fate::Hidden => pair.hidden += 1,
                Fate::Turned => pair.turned += 1,
            }
            pair.surfaces += 1;
        }
        if pair.matched > 0 {
            let count = pair.matched as f64;
            pair.flicker = Some((squares / count).sqrt());
            pair.mean = Some(sum / count);
        }
        pair
    }
}

impl Flicker {
    /// Over the pairs of a walk; `None` where no pixel of any was matched.
    pub fn over(pairs: &[Pair]) -> Option<Self> {
        let matched: u64 = pairs.iter().map(|pair| pair.matched).sum();
        let surfaces: u64 = pairs.iter().map(|pair| pair.surfaces).sum();
        let weighted = |figure: &dyn Fn(&Pair) -> Option<f64>| -> f64 {
            let sums = pairs.iter().filter_map(|pair| Some(figure(pair)? * pair.matched as f64));
            sums.sum::<f64>() / matched as f64
        };
        let flickers: Vec<f64> = pairs.iter().filter_map(|pair| pair.flicker).collect();
        Some(Self {
            largest: flickers.iter().copied().reduce(f64::max)?,
            mean_of_pairs: flickers.iter().sum::<f64>() / flickers.len() as f64,
            flicker: weighted(&|pair| pair.flicker.map(|flicker| flicker * flicker)).sqrt(),
            mean: weighted(&|pair| pair.mean),
            matched_share: matched as f64 / surfaces as f64,
        })
    }
}

/// What a pixel without a match is shown in: no colour of the map of errors.
const UNMATCHED: [u8; 3] = [0, 70, 80];

/// A pixel's share of the mean intensity that [`difference_map`] shows brightest.
const BRIGHTEST: f64 = 0.5;

/// Differences as sRGB bytes, three a pixel: black where nothing changed, by way of purple and orange to pale yellow where the
/// intensity changed by half of `mean`, and dark teal where a pixel has no match.
pub fn difference_map(differences: &[Option<f64>], mean: f64) -> Vec<u8> {
    let scale = if mean > 0.0 { 1.0 / (BRIGHTEST * mean) } else { 0.0 };
    let errors: Vec<f32> = differences.iter().map(|difference| (difference.unwrap_or(0.0).abs() * scale) as f32).collect();
    let mut colors = heatmap(&errors);
    for (color, _) in colors.chunks_exact_mut(3).zip(differences).filter(|(_, difference)| difference.is_none()) {
        color.copy_from_slice(&UNMATCHED);
    }
    colors
}

#[cfg(test)]
mod tests;
