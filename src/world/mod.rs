//! The scene at a frame's time: on the device, animated, with views and lights.

pub mod bent;
mod buckets;
pub mod bvh;
pub mod device;
pub mod device_bvh;
pub mod masks;
mod mips;
pub mod projection;
pub mod shot;
pub mod sky;
pub mod traced;
pub mod view;
mod word_image;

use crate::config::Config;
use crate::gpu::Gpu;
use crate::graph::Graph;
use crate::scene::Scene;
use crate::trace;
use anyhow::Result;
use device::{DeviceScene, FrameScene};
pub use shot::{Inspection, Lighting, Shot};
use sky::{FrameSky, Skies};
use traced::{TracedHandles, TracedScene};

/// Requirements of frames on the scene, beside the rasterizer's own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Acceleration structure and materials for rays.
    pub rays: bool,
}

impl Needs {
    /// Union of two requirements.
    pub fn and(self, other: Self) -> Self {
        Self { rays: self.rays || other.rays }
    }
}

/// A scene on the host and on the device. The device owns its buffers and images.
pub struct World {
    /// The host's scene, without textures unless `may_need` has rays.
    scene: Scene,
    device: DeviceScene,
    traced: Option<TracedScene>,
    skies: Skies,
    /// Animation time of the acceleration structure, seconds; `None` before the first build and after a failed one.
    time_of_rays: Option<f64>,
    may_need: Needs,
}

impl World {
    /// Uploads a scene to the device. Textures stay on the host only if `may_need` has rays, for which they are uploaded a second time,
    /// into one image.
    ///
    /// # Errors
    /// `BadInput` if the scene is over a limit of the device; the error names the limit and the key.
    pub fn bring(gpu: &mut Gpu, mut scene: Scene, may_need: Needs) -> Result<Self> {
        scene.set_time(0.0);
        let device = DeviceScene::upload(gpu, &scene)?;
        if !may_need.rays {
            scene.textures = Vec::new();
        }
        Ok(Self { scene, device, traced: None, skies: Skies::default(), time_of_rays: None, may_need })
    }

    /// Makes missing parts. It is called before frames are described, because building a hierarchy takes seconds.
    ///
    /// # Errors
    /// As [`TracedScene::upload`].
    ///
    /// # Panics
    /// If the world was brought without the requirement.
    pub fn ensure(&mut self, gpu: &mut Gpu, needs: Needs) -> Result<()> {
        if needs.rays && self.traced.is_none() {
            assert!(self.may_need.rays, "{}: rays are asked for, and World::bring was told that none would be", self.scene.name);
            self.scene.set_time(0.0);
            self.traced = Some(TracedScene::upload(gpu, &self.scene)?);
            self.time_of_rays = Some(0.0);
        }
        Ok(())
    }

    /// Reads the map of a config's environment, if it has one and it is not there yet.
    ///
    /// # Errors
    /// As [`Skies::bring`].
    pub fn ensure_sky(&mut self, gpu: &mut Gpu, config: &Config) -> Result<()> {
        config.sky_map().map_or(Ok(()), |(key, path)| self.skies.bring(gpu, &key, path))
    }

    /// The maps of environments.
    pub fn skies(&self) -> &Skies {
        &self.skies
    }

    /// The host's scene at the time that was set last.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The host's scene at second 0 of its animation.
    pub fn at_rest(&mut self) -> &Scene {
        self.scene.set_time(0.0);
        &self.scene
    }

    /// Moves the rasterizer's scene, and the acceleration structure if `needs` has rays, to a time of the animation, seconds.
    ///
    /// # Errors
    /// As [`TracedScene::follow`].
    pub fn set_time(&mut self, gpu: &mut Gpu, seconds: f64, needs: Needs) -> Result<()> {
        if self.scene.animation.is_none() {
            return Ok(());
        }
        if needs.rays {
            self.set_time_of_rays(gpu, seconds)?;
        }
        // The device bends the vertices itself.
        self.scene.pose(seconds);
        self.device.follow(&self.scene);
        Ok(())
    }

    /// Moves the acceleration structure to a time of the animation, seconds; does nothing if it is there already.
    ///
    /// # Errors
    /// As [`TracedScene::follow`].
    pub fn set_time_of_rays(&mut self, gpu: &mut Gpu, seconds: f64) -> Result<()> {
        let Some(traced) = &mut self.traced else { return Ok(()) };
        if self.scene.animation.is_some() && self.time_of_rays != Some(seconds) {
            let _span = trace::span("moving what rays meet");
            self.scene.set_time(seconds);
            self.time_of_rays = None;
            traced.follow(gpu, &self.scene)?;
            self.time_of_rays = Some(seconds);
        }
        Ok(())
    }

    /// The rasterizer's scene.
    pub fn device(&self) -> &DeviceScene {
        &self.device
    }

    /// The acceleration structure; `None` until it was [ensured](Self::ensure).
    pub fn traced(&self) -> Option<&TracedScene> {
        self.traced.as_ref()
    }

    /// Whether the scene is animated.
    pub fn moves(&self) -> bool {
        self.scene.animation.is_some()
    }

    /// Imports the environment of a frame's lighting into the frame's graph.
    ///
    /// # Panics
    /// If its map was not [read](Self::ensure_sky).
    pub fn import_sky(&self, g: &mut Graph, lighting: &Lighting) -> FrameSky<'_> {
        self.skies.import(g, &lighting.environment)
    }

    /// Imports the scene into a frame's graph, with the acceleration structure if there is one.
    pub fn import(&self, g: &mut Graph) -> (FrameScene<'_>, Option<TracedHandles>) {
        (self.device.import(g), self.traced.as_ref().map(|traced| traced.import(g)))
    }
}
