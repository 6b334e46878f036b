//! Answers about a frame: why a pixel is lit, by every VPL's share of its light, beside what rays say, and the way from these shares to the
//! picture; and the VPLs themselves, with their shadow maps.

use crate::color::luminance;
use crate::frame::Frame;
use crate::graph::{Buffer, FrameOutcome, Graph, Image, ReadBack};
use crate::output::Plane;
use crate::scene::pack::{octahedral_inverse, octahedral_snorm16_inverse};
use crate::stages::gather::VplShare;
use crate::stages::visibility::Visibility;
use crate::stages::vpls::{Lobe, VplPlace, Vpls};
use crate::world::Inspection;
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

/// Answers to an [`Inspection`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Inspected {
    pub explanation: Option<Explanation>,
    /// VPLs of each bounce, if they were asked for.
    pub bounces: Vec<BounceVpls>,
}

/// VPLs of a bounce.
#[derive(Debug, Clone, PartialEq)]
pub struct BounceVpls {
    pub vpls: Vec<PlacedVpl>,
    /// Their shadow maps; `None` if the visibility has none.
    pub maps: Option<VplMaps>,
}

/// A VPL in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedVpl {
    pub position: Vec3,
    pub facing: Vec3,
    /// Radiant intensity along the normal, W/sr. A glossy VPL counts with what a diffuse surface would make of its flux.
    pub intensity: Vec3,
    /// Number of its shadow map, or of its cluster; `None` without maps, and of VPLs without light in clusters.
    pub map: Option<u32>,
}

/// Shadow maps of the VPLs of a bounce: tiles of one image, or its layers.
#[derive(Debug, Clone, PartialEq)]
pub struct VplMaps {
    /// Size of the image.
    pub image: [u32; 2],
    /// Side of a map, texels.
    pub size: u32,
    /// Maps side by side; 1 if each has a layer.
    pub columns: u32,
    /// Distances over the scene's diagonal, row by row, layer by layer; 1 where a map sees nothing.
    pub texels: Vec<f32>,
}

impl VplMaps {
    /// Upper left corner of a map in the image, and its layer.
    pub fn corner(&self, map: u32) -> ([u32; 2], u32) {
        if self.image == [self.size, self.size] {
            return ([0, 0], map);
        }
        ([map % self.columns * self.size, map / self.columns * self.size], 0)
    }

    /// Number of the map that has a texel of the image's layer 0.
    pub fn map_at(&self, [x, y]: [u32; 2]) -> u32 {
        y / self.size * self.columns + x / self.size
    }

    /// Texels of a map, row by row; `None` if there is no such map.
    pub fn map(&self, map: u32) -> Option<Vec<f32>> {
        let ([x, y], layer) = self.corner(map);
        let row = |row: u32| {
            let start = ((layer * self.image[1] + y + row) as usize) * self.image[0] as usize + x as usize;
            self.texels.get(start..start + self.size as usize)
        };
        (0..self.size).map(row).collect::<Option<Vec<_>>>().map(|rows| rows.concat())
    }
}

/// Resources that are read back for answers.
pub(crate) struct Wanted {
    pixel: Option<WantedPixel>,
    bounces: Vec<WantedVpls>,
}

struct WantedPixel {
    pixel: [u32; 2],
    planes: Vec<(Image, ReadBack)>,
    has_reflection: bool,
    has_occlusion: bool,
    shares: Vec<ReadBack>,
}

struct WantedVpls {
    places: ReadBack,
    intensities: Option<ReadBack>,
    lobes: Option<ReadBack>,
    /// Number of each VPL's map; by its own number without.
    labels: Option<ReadBack>,
    /// The maps' image, side and columns.
    maps: Option<(Image, ReadBack, u32, u32)>,
}

impl Wanted {
    /// Asks for a frame's resources.
    pub fn of(g: &mut Graph, frame: &Frame, inspection: Inspection) -> Self {
        let pixel = inspection.pixel.map(|pixel| WantedPixel::of(g, frame, pixel));
        let lights = if inspection.vpls { frame.lights.as_slice() } else { &[] };
        Self { pixel, bounces: lights.iter().map(|(vpls, visibility)| WantedVpls::of(g, vpls, *visibility)).collect() }
    }

    /// Reads them after the frame.
    pub fn read(&self, outcome: &FrameOutcome, view: &View) -> Inspected {
        Inspected {
            explanation: self.pixel.as_ref().map(|pixel| pixel.read(outcome, view)),
            bounces: self.bounces.iter().map(|vpls| vpls.read(outcome)).collect(),
        }
    }
}

impl WantedVpls {
    fn of(g: &mut Graph, vpls: &Vpls, visibility: Visibility) -> Self {
        let mut back = |buffer: Buffer| g.read_back(buffer);
        let (places, lobes) = (back(vpls.places), vpls.lobes.map(&mut back));
        let intensities = vpls.diffuse.then(|| back(vpls.intensities));
        let (labels, maps) = match visibility {
            Visibility::None | Visibility::Bits(_) => (None, None),
            Visibility::Ism(ism) => (None, Some((ism.maps, ism.size, ism.columns))),
            Visibility::SharedIsm { ism, labels, .. } => (Some(labels), Some((ism.maps, ism.size, ism.columns))),
            Visibility::Clusters { clusters, .. } => (Some(clusters.labels), Some((clusters.distances, clusters.size, 1))),
        };
        let labels = labels.map(&mut back);
        let maps = maps.map(|(image, size, columns)| (image, g.read_back(image), size, columns));
        Self { places, intensities, lobes, labels, maps }
    }

    fn read(&self, outcome: &FrameOutcome) -> BounceVpls {
        let places: Vec<VplPlace> = bytemuck::pod_collect_to_vec(outcome.bytes(self.places));
        let intensities: Vec<[f32; 3]> = self.intensities.map(|read| bytemuck::pod_collect_to_vec(outcome.bytes(read))).unwrap_or_default();
        let lobes: Vec<Lobe> = self.lobes.map(|read| bytemuck::pod_collect_to_vec(outcome.bytes(read))).unwrap_or_default();
        let labels: Option<Vec<u32>> = self.labels.map(|read| bytemuck::pod_collect_to_vec(outcome.bytes(read)));
        let vpl = |(i, place): (usize, &VplPlace)| {
            let diffuse = intensities.get(i).map_or(Vec3::ZERO, |intensity| Vec3::from(*intensity));
            let glossy = lobes.get(i).map_or(Vec3::ZERO, |lobe| Vec3::from(lobe.flux) * Vec3::from(lobe.f0) / std::f32::consts::PI);
            let map = labels.as_ref().map_or(Some(i as u32), |labels| labels.get(i).copied().filter(|label| *label != u32::MAX));
            PlacedVpl {
                position: place.position.into(),
                facing: octahedral_snorm16_inverse(place.normal),
                intensity: diffuse + glossy,
                map: map.filter(|_| self.maps.is_some()),
            }
        };
        let maps = self.maps.map(|(image, read, size, columns)| VplMaps {
            image: image.size,
            size,
            columns,
            texels: Plane::decode(image.format, outcome.bytes(read)).values,
        });
        BounceVpls { vpls: places.iter().enumerate().map(vpl).collect(), maps }
    }
}

impl WantedPixel {
    fn of(g: &mut Graph, frame: &Frame, pixel: [u32; 2]) -> Self {
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

    fn read(&self, outcome: &FrameOutcome, view: &View) -> Explanation {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_a_tile_of_the_atlas_or_a_layer() {
        let texels = (0..24).map(|i| i as f32).collect();
        let atlas = VplMaps { image: [6, 4], size: 2, columns: 3, texels };
        assert_eq!((atlas.corner(4), atlas.map_at([3, 2])), (([2, 2], 0), 4));
        assert_eq!(atlas.map(4), Some(vec![14.0, 15.0, 20.0, 21.0]));
        assert_eq!(atlas.map(6), None);
        let layered = VplMaps { image: [2, 2], size: 2, columns: 1, texels: (0..8).map(|i| i as f32).collect() };
        assert_eq!((layered.map(1), layered.map(2)), (Some(vec![4.0, 5.0, 6.0, 7.0]), None));
    }
}
