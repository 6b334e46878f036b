//! A frame's view, lighting and time: all that it shows, apart from how it is rendered.

use super::projection::{Projector, View};
use super::sky::Environment;
use super::{World, view};
use crate::config::Config;
use crate::fail;
use crate::gpu::Adapter;
use crate::scene::{Aabb, Camera, Light};
use anyhow::Result;

/// View, lighting and time of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Number of the frame in its sequence; it seeds random numbers that change with the frame.
    pub index: u32,
    /// Time of the scene's animation and of all keyframes, seconds.
    pub seconds: f64,
    pub view: View,
    pub lighting: Lighting,
    pub inspection: Inspection,
}

/// Questions about a frame, beside its picture, which stays the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inspection {
    /// A pixel: why is it lit? Rays are traced from it.
    pub pixel: Option<[u32; 2]>,
    /// Whether the VPLs are brought back, with their shadow maps.
    pub vpls: bool,
}

/// Lighting of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Projectors, one a layer of the reflective shadow map; none if the environment is all that shines.
    pub projectors: Vec<Projector>,
    /// Projectors of the shadow maps that are apart from these; none if there are no such maps.
    pub shadow_projectors: Vec<Projector>,
    pub environment: Environment,
}

impl Shot {
    /// Frame `index` of a config's sequence: its camera and lights, or the scene's own, at second `index / frame.fps`.
    ///
    /// # Errors
    /// `BadInput` for a camera that the scene lacks or that looks nowhere, and for lights as [`Lighting::of`].
    pub fn of(config: &Config, world: &World, adapter: &Adapter, index: u32) -> Result<Self> {
        Ok(Self {
            index,
            seconds: view::seconds(config, index),
            view: world.view(config, index)?,
            lighting: Lighting::of(config, world, adapter, index)?,
            inspection: Inspection::default(),
        })
    }
}

impl Lighting {
    /// Lights of a config's frame, or the scene's own. Each has one layer of the RSM; a point light has six.
    ///
    /// # Errors
    /// `BadInput` if nothing shines, or if more layers are needed than the device has.
    pub fn of(config: &Config, world: &World, adapter: &Adapter, index: u32) -> Result<Self> {
        let lights = world.lights(config, index);
        let bounds = world.device.bounds;
        let target = config.rsm.bounds.map_or(bounds, |b| Aabb { min: b.min.into(), max: b.max.into() });
        let projectors = Projector::of_lights(&lights, config.rsm.size, target, bounds);
        let shadow_projectors =
            config.shadow_map_size().map(|size| Projector::of_lights(&lights, size, bounds, bounds)).unwrap_or_default();
        let limits = &adapter.limits;
        let most = limits.image_layers.min(limits.framebuffer_layers).min(Projector::MAX as u32);
        let environment = Environment::of(&lights);
        if projectors.is_empty() && !environment.shines() {
            return Err(fail!(
                BadInput,
                "light: {} has no directional, spot or point light, and no environment shines; add a [[light]] table to the config",
                world.scene.name
            ));
        }
        if projectors.len() > most as usize {
            return Err(fail!(
                BadInput,
                "light: {} shadow maps (a point light takes six) are over the {most} that fit on {}; take fewer [[light]] tables",
                projectors.len(),
                adapter.name
            ));
        }
        Ok(Self { projectors, shadow_projectors, environment })
    }
}

impl World {
    /// Lights of a config's frame: the config's if it has any, else the scene's.
    pub fn lights(&self, config: &Config, index: u32) -> Vec<Light> {
        view::lights(config, &self.scene, index)
    }

    /// Camera of a config's frame.
    ///
    /// # Errors
    /// As [`view::camera`].
    pub fn camera(&self, config: &Config, index: u32) -> Result<Camera> {
        view::camera(config, &self.scene, self.device.bounds, index)
    }

    /// Camera view of a config's frame.
    ///
    /// # Errors
    /// As [`Self::camera`].
    pub fn view(&self, config: &Config, index: u32) -> Result<View> {
        Ok(View::new(&self.camera(config, index)?, config.frame.size, self.device.bounds))
    }
}
