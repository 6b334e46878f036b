//! Ground truth: a progressive path tracer on the same scene, lights and camera as the rasterized frame.
//!
//! [`Tracer`] adds path after path to [`Sums`] that stay on the device. A pixel's n-th path depends on the seed, the pixel and n alone, so
//! a seed gives the same bytes however the work was divided, stopped and resumed. Direct light is light of emitters that the first surface
//! reflects; bounce k is light that it reflects after k more surfaces.

mod files;
mod identity;
mod sums;

pub use files::{develop, load_sums, save_sums};
pub use identity::{identity, scene_digest};
pub use sums::{Sum, Sums};

use crate::color::luminance;
use crate::config::{Config, Dielectric};
use crate::fail;
use crate::gpu::{Format, ImageId};
use crate::graph::{Execution, Graph, Part};
use crate::output::exr::MAX_DECODED_BYTES;
use crate::renderer::Renderer;
use crate::scene::{Aabb, Light};
use crate::shader_struct;
use crate::stages::methods::{Method, NOTHING};
use crate::world::projection::{Projector, View};
use crate::world::sky::Environment;
use crate::world::view;
use anyhow::{Context, Result};
use bytemuck::Zeroable;
use glam::Vec3;
use std::f32::consts::TAU;
use std::time::Instant;

shader_struct! {
    struct PathParams {
        first_row: u32,
        rows: u32,
        sample_index: u32,
        seed: u32,
        bounces: u32,
        lights: u32,
        emitters: u32,
        emitting_root: u32,
        emitter_chance: f32,
        squared_min_distance: f32,
    }
}

/// Largest number of indirect bounces: more would run into a software driver's limit of loop turns.
pub const MOST_BOUNCES: u32 = 64;

/// Part of the path tracer's shader for a sky that is a map.
pub const SKY_MAP: Part = ("sky", "reference/sky-map");

/// Settings of the tracer beside the config.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Layers of indirect light; 0 is direct light alone.
    pub bounces: u32,
    /// Frame of the config's camera path and lights, and of the scene's animation.
    pub frame_index: u32,
    /// The VPLs' bound (`gather.min_distance`) applied to each bounce, metres; 0 is the unbiased truth.
    pub min_distance: f32,
    /// Paths go through pixel centres, as in a rasterized frame, instead of being spread over pixels.
    pub centered: bool,
}

/// The one method of ground truth.
pub fn method() -> Method {
    Method::only("reference", "path", NOTHING)
}

/// A path tracer of a scene. The device owns its sums.
pub struct Tracer {
    view: View,
    lights: Vec<Projector>,
    environment: Environment,
    glossy_dielectric: bool,
    emitter_chance: f32,
    seed: u32,
    settings: Settings,
    /// Time of the frame, seconds.
    time: f64,
    sums: ImageId,
    samples: u32,
    /// Bytes of the last submission's resources, by name.
    memory: Vec<(String, u64)>,
    /// Rows of pixels of the next submission; adapted to the device's speed.
    pub rows_at_once: u32,
}

/// Target time of a submission: short enough for a display's watchdog and for stopping, long enough to hide its overhead.
const SUBMISSION_SECONDS: f64 = 0.25;

impl Tracer {
    /// A tracer without paths, or one that continues from `sums`.
    ///
    /// # Errors
    /// `BadInput` if there are too many lights or pixels, and the device's own if it cannot hold the sums.
    pub fn new(renderer: &mut Renderer, config: &Config, settings: Settings, sums: Option<&Sums>) -> Result<Self> {
        let time = view::seconds(config, settings.frame_index);
        renderer.ensure_sky(config)?;
        renderer.set_time_of_rays(time)?;
        let view = renderer.view(config, settings.frame_index)?;
        let lights = renderer.lights(config, settings.frame_index);
        let mut projectors = Vec::new();
        for light in &lights {
            // A point light is one light here, not six faces.
            let faces = Projector::of_lights(
                std::slice::from_ref(light),
                [1, 1],
                renderer.world().device().bounds,
                renderer.world().device().bounds,
            );
            projectors.extend(faces.first());
        }
        if projectors.len() > Projector::MAX {
            return Err(fail!(BadInput, "light: {} lights are over the {} that fit; take fewer", projectors.len(), Projector::MAX));
        }
        let Some(traced) = renderer.world().traced() else {
            unreachable!("a tracer is made where Renderer::ensure has brought what rays need")
        };
        let emitter_chance =
            emitter_chance(traced.emitted_power, lights.iter().map(|light| power(light, renderer.world().device().bounds)).sum());
        let limit = renderer.gpu().adapter.limits.image_size;
        if config.frame.size.iter().any(|side| *side > limit) {
            let [width, height] = config.frame.size;
            return Err(fail!(
                BadInput,
                "frame.size: {width}x{height} is over the {limit} a side that {} allows",
                renderer.gpu().adapter.name
            ));
        }
        let [width, height] = config.frame.size.map(u128::from);
        if width * height * u128::from(2 * Sum::count(settings.bounces)) * 16 > MAX_DECODED_BYTES {
            return Err(fail!(
                BadInput,
                "frame.size: {width}x{height} pixels with {} bounces are more than a file of sums holds; lower --bounces or the size",
                settings.bounces
            ));
        }
        let empty;
        let sums = match sums {
            Some(sums) => sums,
            None => {
                empty = Sums::new(config.frame.size, settings.bounces);
                &empty
            }
        };
        let [width, height] = sums.size;
        let image = renderer
            .engine()
            .gpu
            .create_filled_image(
                "reference/sums",
                Format::Rgba32Float,
                [width, height, sums.image_layers()],
                bytemuck::cast_slice(&sums.texels),
                true,
            )
            .context("the sums of the path tracer")?;
        Ok(Self {
            view,
            lights: projectors,
            environment: Environment::of(&lights),
            glossy_dielectric: config.materials.dielectric == Dielectric::Ggx,
            emitter_chance,
            seed: config.frame.seed,
            settings,
            time,
            sums: image,
            samples: sums.samples,
            memory: Vec::new(),
            rows_at_once: 8,
        })
    }

    /// Paths a pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Bytes of each of the tracer's own resources, by name, as of its last sample.
    pub fn memory(&self) -> &[(String, u64)] {
        &self.memory
    }

    fn sums_size(&self) -> ([u32; 2], u32) {
        ([self.view.width, self.view.height], 2 * Sum::count(self.settings.bounces))
    }

    /// Traces one more path through every pixel. Returns the number of rays, and the device's time in milliseconds.
    pub fn sample(&mut self, renderer: &mut Renderer, execution: &Execution) -> Result<(u64, f64)> {
        let (mut rays, mut ms) = (0, 0.0);
        let mut row = 0;
        while row < self.view.height {
            let rows = self.rows_at_once.min(self.view.height - row);
            let start = Instant::now();
            let (traced, took) = self.rows(renderer, execution, row, rows)?;
            rays += traced;
            ms += took;
            row += rows;
            self.rows_at_once = fitting_rows(rows, start.elapsed().as_secs_f64(), self.view.height);
        }
        self.samples += 1;
        Ok((rays, ms))
    }

    fn rows(&mut self, renderer: &mut Renderer, execution: &Execution, first_row: u32, rows: u32) -> Result<(u64, f64)> {
        renderer.set_time_of_rays(self.time)?;
        let mut g = Graph::new();
        let Some(traced) = renderer.world().traced() else {
            unreachable!("a tracer is made where Renderer::ensure has brought what rays need")
        };
        let scene = traced.import(&mut g);
        let mut lights = vec![Projector::zeroed(); Projector::MAX];
        lights[..self.lights.len()].copy_from_slice(&self.lights);
        let lights = g.upload("reference/lights", &lights);
        let view = g.upload("reference/view", &[self.view]);
        let counter = g.upload("reference/rays", &[0u32; 2]);
        let (size, layers) = self.sums_size();
        let sums = g.keep_image("reference/sums", self.sums, Format::Rgba32Float, size, layers);
        let sky = renderer.world().skies().import(&mut g, &self.environment);
        let pass = g.compute("reference/path").reads("sky", sky.block);
        let pass = match sky.map {
            None => pass,
            Some(map) => pass.part(SKY_MAP.0, SKY_MAP.1).reads("sky_map", map.texels).reads("sky_rows", map.rows),
        };
        pass.traces(&scene)
            .shades(&scene)
            .reads("view", view)
            .reads("lights", lights)
            .reads("emitters", scene.emitters)
            .updates("sums", sums)
            .updates("rays", counter)
            .constant("GLOSSY_DIELECTRIC", self.glossy_dielectric)
            .constant("LIGHT_KIND", Projector::common_kind(&self.lights))
            .constant("CENTERED", self.settings.centered)
            .constant("ENVIRONMENT", self.environment.shines())
            .params(&PathParams {
                first_row,
                rows,
                sample_index: self.samples,
                seed: self.seed,
                bounces: self.settings.bounces,
                lights: self.lights.len() as u32,
                emitters: scene.emitter_count,
                emitting_root: scene.emitting_root,
                emitter_chance: self.emitter_chance,
                squared_min_distance: self.settings.min_distance * self.settings.min_distance,
            })
            .dispatch([self.view.width, rows, 1]);
        let counted = g.read_back(counter);
        self.memory = g.memory();
        let outcome = renderer.engine().execute(&g, execution)?;
        let [rays, unfinished] = bytemuck::pod_read_unaligned::<[u32; 2]>(outcome.bytes(counted));
        if unfinished != 0 {
            return Err(fail!(
                BadInput,
                "paths of {} bounces take more steps through this scene than {} lets a shader run; lower --bounces",
                self.settings.bounces,
                renderer.gpu().adapter.name
            ));
        }
        Ok((u64::from(rays), outcome.times.iter().map(|(_, ms)| ms).sum()))
    }

    /// Sums so far.
    pub fn sums(&self, renderer: &mut Renderer) -> Result<Sums> {
        let mut g = Graph::new();
        let (size, layers) = self.sums_size();
        let sums = g.keep_image("reference/sums", self.sums, Format::Rgba32Float, size, layers);
        let read = g.read_back(sums);
        let outcome = renderer.engine().execute(&g, &Execution::default())?;
        let texels = bytemuck::pod_collect_to_vec(outcome.bytes(read));
        Ok(Sums { size, bounces: self.settings.bounces, samples: self.samples, texels })
    }

    /// Features at pixel centres: normal with distance along the view's axis, and position; zeros without a surface.
    pub fn features(&self, renderer: &mut Renderer) -> Result<Features> {
        renderer.set_time_of_rays(self.time)?;
        let mut g = Graph::new();
        let Some(traced) = renderer.world().traced() else {
            unreachable!("a tracer is made where Renderer::ensure has brought what rays need")
        };
        let scene = traced.import(&mut g);
        let view = g.upload("reference/view", &[self.view]);
        let (size, _) = self.sums_size();
        let normals = g.image("reference/normals", Format::Rgba32Float, size);
        let positions = g.image("reference/positions", Format::Rgba32Float, size);
        g.compute("reference/features")
            .traces(&scene)
            .shades(&scene)
            .reads("view", view)
            .writes("normals_and_distances", normals)
            .writes("positions", positions)
            .dispatch([size[0], size[1], 1]);
        let (normals, positions) = (g.read_back(normals), g.read_back(positions));
        let outcome = renderer.engine().execute(&g, &Execution::default())?;
        let vectors = |read| -> Vec<[f32; 4]> { bytemuck::pod_collect_to_vec(outcome.bytes(read)) };
        Ok(Features { normals_and_distances: vectors(normals), positions: vectors(positions) })
    }

    /// Compiles the shaders and creates the pipelines.
    pub fn prepare(&mut self, renderer: &mut Renderer) -> Result<()> {
        self.rows(renderer, &Execution::default(), self.view.height, 1).map(|_| ())
    }

    /// Frees the memory of the sums.
    pub fn free(self, renderer: &mut Renderer) {
        renderer.engine().gpu.free_image(self.sums);
    }
}

/// Rows of the next submission, after one of `rows` took `seconds`: whole workgroups, at least one, and at most twice as many as before,
/// since one measurement may be an outlier.
fn fitting_rows(rows: u32, seconds: f64, height: u32) -> u32 {
    let fitting = f64::from(rows) * SUBMISSION_SECONDS / seconds.max(1e-6);
    let most = rows.saturating_mul(2).min(height).max(8);
    (fitting.min(f64::from(most)) as u32).max(1).next_multiple_of(8)
}

/// Luminance of a light's flux into the scene, W.
fn power(light: &Light, bounds: Aabb) -> f32 {
    let luminance = |color: Vec3| luminance(&color.to_array()) as f32;
    match *light {
        Light::Directional { irradiance, .. } => luminance(irradiance) * bounds.size().length_squared() * 0.25,
        Light::Spot { intensity, outer, .. } => luminance(intensity) * TAU * (1.0 - outer.cos()),
        Light::Point { intensity, .. } => luminance(intensity) * 2.0 * TAU,
        Light::Environment { .. } => 0.0,
    }
}

/// Probability of sampling an emitting surface instead of a light: its share of the power, limited to [0.1, 0.9], since either kind may be
/// the only one that lights a part of the scene.
fn emitter_chance(emitters: f32, lights: f32) -> f32 {
    if emitters == 0.0 || lights == 0.0 { f32::from(emitters > 0.0) } else { (emitters / (emitters + lights)).clamp(0.1, 0.9) }
}

/// Features at pixel centres, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Features {
    /// World-space shading normal, and distance along the view's axis, metres.
    pub normals_and_distances: Vec<[f32; 4]>,
    /// World-space position, metres; the fourth number is 1 if there is a surface.
    pub positions: Vec<[f32; 4]>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_submission_is_never_empty_and_grows_and_shrinks_to_its_time() {
        assert_eq!(fitting_rows(8, 3600.0, 270), 8);
        assert_eq!(fitting_rows(1, 0.3, 9), 8);
        assert_eq!(fitting_rows(64, 0.25, 1080), 64);
        assert_eq!(fitting_rows(64, 0.5, 1080), 32);
        assert_eq!(fitting_rows(64, 1e-9, 1080), 128);
        assert_eq!(fitting_rows(u32::MAX, 1e-9, 270), 272);
    }
}
