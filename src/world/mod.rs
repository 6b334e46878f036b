//! The scene as frames see it: on the device, moved by its animation, and from where a frame shows it.

pub mod bvh;
pub mod device;
pub mod device_bvh;
pub mod projection;
pub mod shot;
pub mod traced;
pub mod view;

use crate::gpu::Gpu;
use crate::graph::Graph;
use crate::scene::Scene;
use crate::trace;
use anyhow::Result;
use device::{DeviceScene, FrameScene};
pub use shot::{Lighting, Shot};
use traced::{TracedHandles, TracedScene};

/// What frames need of the scene beside what is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// The hierarchy that rays traverse, and the materials that they find.
    pub rays: bool,
}

impl Needs {
    /// What either needs.
    pub fn and(self, other: Self) -> Self {
        Self { rays: self.rays || other.rays }
    }
}

/// A scene on the host and on the device. The device owns its buffers and images.
pub struct World {
    /// Without its textures, unless the world may be asked for rays.
    scene: Scene,
    device: DeviceScene,
    traced: Option<TracedScene>,
    /// Where the scene's animation was when the hierarchy was built, seconds; unknown after one that failed.
    time_of_rays: Option<f64>,
    may_need: Needs,
}

impl World {
    /// Brings a scene to the device. Textures stay on the host only if `may_need` has rays, which look them up in an image of their own.
    ///
    /// # Errors
    /// `BadInput` where the device's limits are passed; the error names the limit and the key.
    pub fn bring(gpu: &mut Gpu, mut scene: Scene, may_need: Needs) -> Result<Self> {
        scene.set_time(0.0);
        let device = DeviceScene::upload(gpu, &scene)?;
        if !may_need.rays {
            scene.textures = Vec::new();
        }
        Ok(Self { scene, device, traced: None, time_of_rays: None, may_need })
    }

    /// Makes what frames need and is not there. It is called before frames are described, since building a hierarchy takes seconds.
    ///
    /// # Errors
    /// As [`TracedScene::upload`].
    ///
    /// # Panics
    /// If the world was brought without what it now needs.
    pub fn ensure(&mut self, gpu: &mut Gpu, needs: Needs) -> Result<()> {
        if needs.rays && self.traced.is_none() {
            assert!(self.may_need.rays, "{}: rays are asked for, and World::bring was told that none would be", self.scene.name);
            self.scene.set_time(0.0);
            self.traced = Some(TracedScene::upload(gpu, &self.scene)?);
            self.time_of_rays = Some(0.0);
        }
        Ok(())
    }

    /// The host's scene, where its animation has it at second 0.
    pub fn at_rest(&mut self) -> &Scene {
        self.scene.set_time(0.0);
        &self.scene
    }

    /// Moves what is drawn, and what rays meet where that is needed, to where the scene's animation has it at a time.
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
        self.scene.set_time(seconds);
        self.device.follow(&self.scene);
        Ok(())
    }

    /// Moves what rays meet to where the scene's animation has it at a time; does nothing where it is there.
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

    /// What is drawn.
    pub fn device(&self) -> &DeviceScene {
        &self.device
    }

    /// What rays meet; `None` until it was [ensured](Self::ensure).
    pub fn traced(&self) -> Option<&TracedScene> {
        self.traced.as_ref()
    }

    /// Whether the scene has an animation that moves it.
    pub fn moves(&self) -> bool {
        self.scene.animation.is_some()
    }

    /// The scene as a frame's resources, and what rays meet where that is there.
    pub fn import(&self, g: &mut Graph) -> (FrameScene<'_>, Option<TracedHandles>) {
        (self.device.import(g), self.traced.as_ref().map(|traced| traced.import(g)))
    }
}
