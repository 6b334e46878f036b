//! Resources that stages make once and keep over frames.

use super::gather::shells::{self, FrameShells, Shells};
use super::visibility::triangles::{self, FrameTriangles, Triangles};
use crate::config::Config;
use crate::gpu::Gpu;
use crate::graph::{Buffer, Graph};
use crate::world::World;
use anyhow::Result;

/// One field a resource; `None` until a config needs it. The device owns the buffers.
#[derive(Default)]
pub struct Residents {
    shells: Option<Shells>,
    triangles: Option<Triangles>,
}

impl Residents {
    /// Makes missing resources of a config's stages, from the world's scene at second 0 of its animation.
    ///
    /// # Errors
    /// The device's own, when memory runs out.
    pub fn bring(&mut self, gpu: &mut Gpu, world: &mut World, config: &Config) -> Result<()> {
        if self.shells.is_none() && shells::needs_shells(config) {
            self.shells = Some(Shells::upload(gpu)?);
        }
        if self.triangles.is_none() && triangles::needs_triangles(config) {
            self.triangles = Some(Triangles::upload(gpu, world.at_rest())?);
        }
        Ok(())
    }

    /// Imports the residents into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameResidents<'_> {
        FrameResidents {
            shells: self.shells.as_ref().map(|shells| shells.import(g)),
            triangles: self.triangles.as_ref().map(|triangles| triangles.import(g)),
        }
    }
}

/// The residents in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameResidents<'f> {
    shells: Option<FrameShells<'f>>,
    triangles: Option<FrameTriangles<'f>>,
}

impl<'f> FrameResidents<'f> {
    /// Hulls of stochastic ranges.
    pub fn shells(&self) -> FrameShells<'f> {
        self.shells.unwrap_or_else(|| unreachable!("shells::needs_shells says who draws shells"))
    }

    /// Positions of the scene's vertices ([`FrameTriangles::positions`]), if any config has needed them.
    pub fn positions(&self) -> Option<Buffer> {
        self.triangles.map(|triangles| triangles.positions)
    }

    /// Triangles that the points of imperfect shadow maps are made from.
    pub fn triangles(&self) -> FrameTriangles<'f> {
        self.triangles.unwrap_or_else(|| unreachable!("triangles::needs_triangles says who makes points"))
    }
}
