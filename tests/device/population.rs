//! The texels that samplers draw VPLs from, worked out one by one, and what chains over them must give.

use crate::common::*;
use glam::Vec3;
use manylight::config::{Config, VplSampler};
use manylight::graph::Execution;
use manylight::renderer::{Rendered, Renderer};
use manylight::stages::vpls::VplPlace;
use manylight::world::projection::Projector;

/// Chains of a test that counts them.
pub const CHAINS: u32 = 1 << 19;

/// A frame with what its sampler wrote, and its reflective shadow maps.
pub fn vpls(renderer: &mut Renderer, config: &Config) -> Rendered {
    renderer.check(config).unwrap_or_else(|error| panic!("{error:#}"));
    let (passes, _) = renderer.names(config).unwrap();
    let dump = passes.into_iter().filter(|pass| pass.starts_with("vpls/") || *pass == "rsm/draw").map(str::to_owned).collect();
    renderer.render(config, 0, false, &Execution { dump, ..Execution::default() }).unwrap_or_else(|error| panic!("{error:#}"))
}

/// The texels of all maps, by which VPLs are recognized.
pub struct Population {
    projectors: Vec<Projector>,
    /// Texels of a map.
    size: [u32; 2],
    /// Place of each texel; `None` without a surface.
    places: Vec<Option<Vec3>>,
    /// Importance of each texel to the view.
    pub importance: Vec<f64>,
    /// Cross section of each texel's beam, m^2.
    beams: Vec<f64>,
}

impl Population {
    /// Population of a config whose sampler has the map of importance.
    pub fn of(renderer: &mut Renderer, config: &Config) -> Self {
        let mut config = config.clone();
        (config.vpls.sampler, config.vpls.count) = (VplSampler::InverseTransform, 16);
        let rendered = vpls(renderer, &config);
        let projectors = renderer.shot(&config, 0).unwrap().lighting.projectors;
        let depths: Vec<f32> = pod(&rendered, "rsm/depth");
        let importance = pod::<f32>(&rendered, "vpls/importance-map").into_iter().map(f64::from).collect();
        let [width, height] = config.rsm.size;
        let texel = |i: usize| {
            let light = &projectors[i / (width * height) as usize];
            let (x, y) = (i as u32 % width, i as u32 / width % height);
            let ndc = [(x as f32 + 0.5) / width as f32 * 2.0 - 1.0, (y as f32 + 0.5) / height as f32 * 2.0 - 1.0];
            let [right, up, direction, origin] = [light.right, light.up, light.direction, light.origin].map(Vec3::from);
            let (across, down) = (f64::from(ndc[0] * right.length()), f64::from(ndc[1] * up.length()));
            let offset = ndc[0] * right - ndc[1] * up;
            let (place, beam) = if light.kind == 0 {
                (origin + offset + direction * (light.near * (1.0 - depths[i])), f64::from(light.texel_area))
            } else {
                let place = origin + (direction + offset) * (light.near / depths[i]);
                let angle = f64::from(light.texel_area) / (1.0 + across * across + down * down).powf(1.5);
                (place, angle * f64::from(place.distance_squared(origin)))
            };
            if depths[i] > 0.0 { (Some(place), beam) } else { (None, 0.0) }
        };
        let (places, beams) = (0..depths.len()).map(texel).unzip();
        Self { projectors, size: config.rsm.size, places, importance, beams }
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Number of the texel at a place.
    pub fn texel(&self, place: Vec3) -> usize {
        let [width, height] = self.size;
        let at = |(layer, light): (usize, &Projector)| {
            let clip = glam::Mat4::from_cols_array_2d(&light.world_to_clip) * place.extend(1.0);
            let (x, y) = ((clip.x / clip.w * 0.5 + 0.5) * width as f32, (clip.y / clip.w * 0.5 + 0.5) * height as f32);
            let inside = (0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y);
            let texel = layer * (width * height) as usize + y as usize * width as usize + x as usize;
            (inside && self.places[texel].is_some_and(|known| known.distance(place) < 1e-5 * (10.0 + place.length()))).then_some(texel)
        };
        self.projectors.iter().enumerate().find_map(at).unwrap_or_else(|| panic!("{place} is no texel's"))
    }

    /// Texel and weight of each lit VPL: 1 for a VPL of uniform sampling.
    pub fn weights(&self, rendered: &Rendered) -> Vec<(usize, f64)> {
        let (places, areas): (Vec<VplPlace>, Vec<f32>) = (pod(rendered, "vpls/places"), pod(rendered, "vpls/areas"));
        let uniform = self.len() as f64 / places.len() as f64;
        let one = |(place, area): (&VplPlace, &f32)| {
            let texel = self.texel(place.position.into());
            (texel, f64::from(*area) / self.beams[texel] / uniform)
        };
        places.iter().zip(&areas).filter(|(_, area)| **area > 0.0).map(one).collect()
    }

    /// Exact expectations of a Metropolis-Hastings chain of `steps` independent uniform proposals: the share of chains that end at each
    /// texel, and the mean, over all chains, of the sum of proposed importances where they end there.
    pub fn chain(&self, steps: u32) -> (Vec<f64>, Vec<f64>) {
        let (f, n) = (&self.importance, self.len());
        let each = 1.0 / n as f64;
        let (mut p, mut q) = (vec![each; n], f.iter().map(|f| f * each).collect::<Vec<_>>());
        for _ in 1..steps {
            let (mut next_p, mut next_q) = (vec![0.0; n], vec![0.0; n]);
            for v in 0..n {
                let (mut stays, mut rejected) = (each, f[v] * each);
                for y in (0..n).filter(|y| *y != v) {
                    let accepts = if f[v] > 0.0 { (f[y] / f[v]).min(1.0) } else { 1.0 } * each;
                    next_p[y] += p[v] * accepts;
                    next_q[y] += (q[v] + p[v] * f[y]) * accepts;
                    stays += each - accepts;
                    rejected += (each - accepts) * f[y];
                }
                next_p[v] += p[v] * stays;
                next_q[v] += q[v] * stays + p[v] * rejected;
            }
            (p, q) = (next_p, next_q);
        }
        (p, q)
    }
}

/// Mean of the numbers over `all`, of which those that are not listed are 0, and its standard error.
pub fn mean_and_error(numbers: impl Iterator<Item = f64>, all: usize) -> (f64, f64) {
    let (sum, squares) = numbers.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
    let n = all as f64;
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}
