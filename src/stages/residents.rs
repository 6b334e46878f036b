//! Resources that stages make once and keep over frames.

use super::gather::caches::{self, Caches, FrameCaches};
use super::gather::shells::{self, FrameShells, Shells};
use super::visibility::stored::{FrameSegment, Stored};
use super::visibility::triangles::{self, FrameTriangles, Triangles};
use crate::config::{Collect, Config};
use crate::gpu::Gpu;
use crate::graph::{Buffer, Graph};
use crate::trace;
use crate::world::{Lighting, World};
use anyhow::Result;
use std::collections::BTreeMap;

/// One field a resource; `None` until a config needs it. The device owns the buffers.
#[derive(Default)]
pub struct Residents {
    caches: Option<Caches>,
    shells: Option<Shells>,
    triangles: Option<Triangles>,
    /// Stored points by their number, and whether they are thinned.
    stored: BTreeMap<(u32, bool), Stored>,
}

impl Residents {
    /// Number of light caches, if a config needs them and they are there.
    pub fn light_cache_count(&self, config: &Config) -> Option<u64> {
        let spacing = caches::needs_caches(config)?;
        self.caches.as_ref().filter(|there| there.are_of(spacing)).map(Caches::count)
    }

    /// Makes missing resources of a config's stages, from the world's scene at second 0 of its animation.
    ///
    /// # Errors
    /// The device's own, when memory runs out.
    pub fn bring(&mut self, gpu: &mut Gpu, world: &mut World, config: &Config) -> Result<()> {
        if let Some(spacing) =
            caches::needs_caches(config).filter(|spacing| !self.caches.as_ref().is_some_and(|there| there.are_of(*spacing)))
        {
            if let Some(caches) = self.caches.take() {
                caches.free(gpu);
            }
            self.caches = Some(Caches::upload(gpu, world.at_rest(), spacing)?);
        }
        if let Some(caches) = self.caches.as_ref().filter(|_| caches::needs_caches(config).is_some()) {
            let maps = Lighting::of(config, world, &gpu.adapter, 0)?.projectors.len() as u32;
            caches.check(&gpu.adapter, config.vpl_count(maps), config)?;
        }
        if self.shells.is_none() && shells::needs_shells(config) {
            self.shells = Some(Shells::upload(gpu)?);
        }
        if self.triangles.is_none() && triangles::needs_triangles(config) {
            self.triangles = Some(Triangles::upload(gpu, world.at_rest())?);
        }
        let ism = &config.visibility.ism;
        for thin in triangles::thinnings(config).into_iter().filter(|_| ism.collect == Collect::Stored) {
            let key = (ism.point_count, thin);
            if let Some(triangles) = self.triangles.as_ref().filter(|_| !self.stored.contains_key(&key)) {
                let _span = trace::span("storing points");
                self.stored.insert(key, Stored::upload(gpu, world.at_rest(), key.0, key.1, triangles.most_bytes)?);
            }
        }
        Ok(())
    }

    /// Imports the residents into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameResidents<'_> {
        FrameResidents {
            caches: self.caches.as_ref(),
            shells: self.shells.as_ref().map(|shells| shells.import(g)),
            triangles: self.triangles.as_ref().map(|triangles| triangles.import(g)),
            stored: &self.stored,
        }
    }
}

/// The residents in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameResidents<'f> {
    caches: Option<&'f Caches>,
    shells: Option<FrameShells<'f>>,
    triangles: Option<FrameTriangles<'f>>,
    stored: &'f BTreeMap<(u32, bool), Stored>,
}

impl<'f> FrameResidents<'f> {
    /// Light caches.
    pub fn caches(&self, g: &mut Graph) -> FrameCaches {
        self.caches.unwrap_or_else(|| unreachable!("caches::needs_caches says who gathers at caches")).import(g)
    }

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

    /// Stored points of this number, in the segments that buffers hold.
    pub fn stored(&self, g: &mut Graph, count: u32, thin: bool) -> Vec<FrameSegment> {
        self.stored.get(&(count, thin)).unwrap_or_else(|| unreachable!("points are stored where a config wants them")).import(g)
    }
}
