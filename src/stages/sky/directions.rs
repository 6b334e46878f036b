//! Directions of the sky, drawn by its luminance.

use crate::graph::{Buffer, Graph};
use crate::scene::pack::octahedral_snorm16;
use crate::scene::sky::{Drawn, SkyMap};
use crate::scene::{Aabb, Light};
use crate::stages::interleave::Interleave;
use crate::stages::surroundings::Surroundings;
use crate::stages::visibility::SkyFrame;
use crate::stages::vpls::{VplPlace, Vpls};
use crate::stages::wants::Wants;
use crate::world::projection::Projector;
use crate::world::sky::FrameSky;
use glam::{DMat3, DVec2, DVec3, Vec3};
use std::f64::consts::PI;

/// Directions of the sky, each with its share of the sky's irradiance.
pub(super) struct Directions(Vec<Drawn>);

impl Directions {
    /// Draws at least `count`, and equally many for each sample set.
    pub fn draw(sky: &FrameSky<'_>, count: u32, wants: &Wants) -> Self {
        let even;
        let map = match sky.map {
            Some(map) => map.map,
            None => {
                even = SkyMap::new([1, 1], vec![[1.0; 3]]);
                &even
            }
        };
        let rotation = DMat3::from_rotation_y(f64::from(sky.rotation));
        let (factor, numbers) = (sky.radiance.as_dvec3(), points(count, wants.interleave, wants.seed));
        let share = 1.0 / numbers.len() as f64;
        let one = |u: DVec2| {
            let Drawn { direction, irradiance } = map.draw(u);
            Drawn { direction: (rotation * direction).normalize_or(DVec3::Y), irradiance: irradiance * factor * share }
        };
        Self(numbers.into_iter().map(one).collect())
    }

    /// Directions as VPLs. A VPL is where its direction leaves the sphere around the scene's bounds, and faces inwards. In place of its
    /// intensity stands the irradiance on a plane that faces it, W/m^2.
    pub fn vpls(&self, g: &mut Graph, around: Surroundings<'_>) -> Vpls {
        let bounds = around.scene.bounds();
        let radius = 0.5 * bounds.size().length();
        let place = |Drawn { direction, .. }: &Drawn| {
            let direction = direction.as_vec3();
            VplPlace { position: (bounds.center() + radius * direction).into(), normal: octahedral_snorm16(-direction) }
        };
        let places: Vec<VplPlace> = self.0.iter().map(place).collect();
        let irradiances: Vec<[f32; 3]> = self.0.iter().map(|drawn| drawn.irradiance.as_vec3().into()).collect();
        // Its part of the sphere.
        let area = (4.0 * PI / self.0.len() as f64) as f32 * radius * radius;
        let areas: Vec<f32> = irradiances.iter().map(|light| if light.iter().any(|l| *l > 0.0) { area } else { 0.0 }).collect();
        Vpls {
            count: self.0.len() as u32,
            places: g.upload("sky/places", &places),
            intensities: g.upload("sky/irradiances", &irradiances),
            areas: g.upload("sky/areas", &areas),
            disks: None,
            kept: None,
            lobes: None,
            diffuse: true,
        }
    }

    /// A [`SkyFrame`] for each direction, fitted to the scene's bounds.
    pub fn frames(&self, g: &mut Graph, around: Surroundings<'_>) -> Buffer {
        let bounds = around.scene.bounds();
        let frames: Vec<SkyFrame> = self.0.iter().map(|drawn| frame(drawn.direction.as_vec3(), bounds)).collect();
        g.upload("sky/frames", &frames)
    }
}

/// The frame of a direction's map: as a directional light's map, but that no axis is shorter than a third of the other, since points are
/// round in texels.
fn frame(direction: Vec3, bounds: Aabb) -> SkyFrame {
    let light = Projector::of_lights(&[Light::Directional { direction: -direction, irradiance: Vec3::ONE }], [256; 2], bounds, bounds)[0];
    let [right, up] = [light.right, light.up].map(Vec3::from);
    let longest = right.length().max(up.length());
    let [right, up] = [right, up].map(|half| half.normalize() / half.length().max(longest / 3.0));
    let scale = (right.length() * up.length()).sqrt();
    SkyFrame { right: right.into(), scale, up: up.into(), extent: 1.0 / (scale * bounds.size().length()) }
}

/// Points in [0, 1)^2, at least `count`, point i for sample set i modulo the number of sets. The points are a (0, 2)-sequence (Sobol's first
/// two dimensions), and each set has a run of it, so that all of them and those of each set are spread evenly. A seed other than 0 shifts
/// all bits alike, which keeps that.
fn points(count: u32, interleave: Interleave, seed: u32) -> Vec<DVec2> {
    let (sets, each) = (interleave.sets(), interleave.per_pixel(count));
    let shift = if seed == 0 { [0; 2] } else { [hashed(seed), hashed(seed ^ 0x9e37_79b9)] };
    let middle = 0.5 / f64::from((sets * each).next_power_of_two());
    let unit = |bits: u32, shift: u32| (f64::from(bits ^ shift) / 2f64.powi(32) + if shift == 0 { middle } else { 0.0 }).min(1.0 - 1e-9);
    let point = |i: u32| {
        let number = i % sets * each + i / sets;
        DVec2::new(unit(number.reverse_bits(), shift[0]), unit(sobol(number), shift[1]))
    };
    (0..sets * each).map(point).collect()
}

/// Second dimension of Sobol's sequence, as 32 bits of a fraction.
fn sobol(mut number: u32) -> u32 {
    let (mut bits, mut direction) = (0, 1u32 << 31);
    while number != 0 {
        if number & 1 != 0 {
            bits ^= direction;
        }
        number >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

fn hashed(seed: u32) -> u32 {
    let mut bits = seed.wrapping_mul(0x85eb_ca6b);
    bits ^= bits >> 15;
    bits = bits.wrapping_mul(0xc2b2_ae35);
    bits ^ bits >> 13
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of n points in each of the n boxes of every shape there is one.
    fn is_net(points: &[DVec2]) -> bool {
        let n = points.len();
        (0..=n.ilog2()).all(|power| {
            let (across, down) = (1usize << power, n >> power);
            let boxes: std::collections::BTreeSet<_> =
                points.iter().map(|p| ((p.x * across as f64) as usize, (p.y * down as f64) as usize)).collect();
            boxes.len() == n
        })
    }

    #[test]
    fn all_points_and_those_of_each_set_are_spread_evenly_under_every_seed() {
        for seed in [0, 1, 77] {
            let all = points(256, Interleave::of(4.into()), seed);
            assert!(all.len() == 256 && is_net(&all), "seed {seed}");
            for set in 0..16 {
                let own: Vec<DVec2> = all.iter().copied().skip(set).step_by(16).collect();
                assert!(own.len() == 16 && is_net(&own), "set {set} of seed {seed}");
            }
        }
        assert_ne!(points(256, Interleave::of(4.into()), 0), points(256, Interleave::of(4.into()), 1));
        assert_eq!(points(100, Interleave::of(4.into()), 0).len(), 112, "each set has seven");
    }
}
