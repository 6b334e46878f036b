//! Why a pixel is lit: every VPL's share of its light, beside what rays say, and the way from these shares to the picture.

use crate::color::luminance;
use crate::frame::Frame;
use crate::graph::{FrameOutcome, Graph, Image, ReadBack};
use crate::output::Plane;
use crate::scene::pack::octahedral_inverse;
use crate::stages::gather::VplShare;
use crate::world::projection::View;
use glam::{Vec2, Vec3};

/// The light of one pixel, taken apart. Irradiance in W/m^2, radiance in W/(m^2 sr).
#[derive(Debug, Clone, PartialEq)]
pub struct Explanation {
    pub pixel: [u32; 2],
    /// Place of the surface and its normal; `None` where the pixel shows the sky.
    pub surface: Option<(Vec3, Vec3)>,
    pub albedo: Vec3,
    /// Radiance of the pixel.
    pub radiance: Vec3,
    /// Radiance of the direct light, the sky's included.
    pub direct: Vec3,
    /// Radiance of the indirect light.
    pub indirect: Vec3,
    /// Indirect irradiance before the filter: the sum of the shares.
    pub gathered: Vec3,
    /// Indirect irradiance after the filter.
    pub irradiance: Vec3,
    /// Radiance that a glossy receiver reflects, before the filter and after it; `None` if receivers are diffuse.
    pub reflection: Option<[Vec3; 2]>,
    /// Share of the indirect light that ambient occlusion leaves.
    pub visible: f32,
    /// All VPLs of each bounce, in order.
    pub bounces: Vec<Vec<VplShare>>,
}

/// A VPL that may light the pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lighting<'e> {
    /// From 1.
    pub bounce: usize,
    /// Number of the VPL in its bounce.
    pub index: usize,
    pub share: &'e VplShare,
    /// Distance from the pixel's surface, metres.
    pub distance: f32,
    /// Cosine at the VPL.
    pub from: f32,
    /// Cosine at the surface.
    pub to: f32,
}

/// Irradiance of all VPLs, W/m^2, under several assumptions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Nothing shadows them.
    pub open: Vec3,
    /// They are shadowed by rays.
    pub by_rays: Vec3,
    /// They are shadowed by the config's visibility; `None` where that knows the pixel's own sample set alone.
    pub seen: Option<Vec3>,
    /// What the config's visibility lets through and rays stop.
    pub leaked: Option<Vec3>,
    /// What rays let through and the config's visibility stops.
    pub lost: Option<Vec3>,
    /// What the gather sums: those of the pixel's sample set, times the number of sets, after roulette.
    pub light: Vec3,
}

impl Explanation {
    /// Sums over all VPLs of all bounces.
    pub fn sums(&self) -> Sums {
        let none = Some(Vec3::ZERO);
        let mut sums = Sums { seen: none, leaked: none, lost: none, ..Sums::default() };
        for share in self.bounces.iter().flatten() {
            let open = Vec3::from(share.open);
            sums.open += open;
            sums.by_rays += open * share.by_rays;
            sums.light += Vec3::from(share.light);
            let known = share.seen >= 0.0 || open == Vec3::ZERO;
            for (sum, part) in [
                (&mut sums.seen, share.seen),
                (&mut sums.leaked, share.seen * (1.0 - share.by_rays)),
                (&mut sums.lost, (1.0 - share.seen) * share.by_rays),
            ] {
                *sum = sum.filter(|_| known).map(|sum| sum + open * part);
            }
        }
        sums
    }

    /// VPLs that bring light, or that would if nothing shadowed them, the brightest first: by what the gather sums, else by what it would.
    pub fn lighting(&self) -> Vec<Lighting<'_>> {
        let Some((position, normal)) = self.surface else { return Vec::new() };
        let mut all = Vec::new();
        for (bounce, shares) in (1..).zip(&self.bounces) {
            for (index, share) in shares.iter().enumerate() {
                if Vec3::from(share.open) == Vec3::ZERO && Vec3::from(share.light) == Vec3::ZERO {
                    continue;
                }
                let way = Vec3::from(share.position) - position;
                let (distance, direction) = (way.length(), way.normalize_or_zero());
                let (from, to) = (-Vec3::from(share.facing).dot(direction), normal.dot(direction));
                all.push(Lighting { bounce, index, share, distance, from, to });
            }
        }
        let key = |light: &Lighting<'_>| (luminance(&light.share.light), luminance(&light.share.open));
        all.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1))
        });
        all
    }
}

/// Resources that are read back for an explanation.
pub(crate) struct Wanted {
    pixel: [u32; 2],
    planes: Vec<(Image, ReadBack)>,
    has_reflection: bool,
    has_occlusion: bool,
    shares: Vec<ReadBack>,
}

impl Wanted {
    /// Asks for a frame's resources.
    pub fn of(g: &mut Graph, frame: &Frame, pixel: [u32; 2]) -> Self {
        let reflection = frame.gathered.light.reflection.zip(frame.indirect.reflection);
        let gbuffer = &frame.gbuffer;
        let mut images = vec![gbuffer.depth, gbuffer.normal, gbuffer.albedo];
        images.extend([frame.composed.radiance, frame.direct, frame.composed.indirect]);
        images.extend([frame.gathered.light.irradiance, frame.indirect.irradiance]);
        images.extend(frame.visible);
        images.extend(reflection.map(|(before, after)| [before, after]).into_iter().flatten());
        let planes = images.into_iter().map(|image| (image, g.read_back(image))).collect();
        let shares = frame.gathered.shares.iter().map(|buffer| g.read_back(*buffer)).collect();
        Self { pixel, planes, has_reflection: reflection.is_some(), has_occlusion: frame.visible.is_some(), shares }
    }

    /// Reads them after the frame.
    pub fn read(&self, outcome: &FrameOutcome, view: &View) -> Explanation {
        let [x, y] = self.pixel;
        let mut values = self.planes.iter().map(|(image, read)| {
            let bytes = image.format.texel_bytes();
            let at = (y as usize * image.size[0] as usize + x as usize) * bytes;
            Plane::decode(image.format, &outcome.bytes(*read)[at..][..bytes]).at(0)
        });
        let mut next = || values.next().unwrap_or_default();
        let color = |[r, g, b, _]: [f32; 4]| Vec3::new(r, g, b);
        let [depth, ..] = next();
        let [u, v, ..] = next();
        let surface = (depth > 0.0).then(|| (view.position_at(x, y, depth), octahedral_inverse(Vec2::new(u, v))));
        let [albedo, radiance, direct, indirect, gathered, irradiance] = std::array::from_fn(|_| color(next()));
        let visible = if self.has_occlusion { next()[0] } else { 1.0 };
        let reflection = self.has_reflection.then(|| [color(next()), color(next())]);
        let bounces = self.shares.iter().map(|read| bytemuck::pod_collect_to_vec(outcome.bytes(*read))).collect();
        Explanation { pixel: self.pixel, surface, albedo, radiance, direct, indirect, gathered, irradiance, reflection, visible, bounces }
    }
}
