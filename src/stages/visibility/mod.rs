//! Which VPLs a point sees.

mod adaptive;
mod ism;
mod points;
mod pull_push;
mod ray_traced;

pub use ism::{Ism, partition_capacity};
pub use ray_traced::BITS;

use super::gbuffer::GBuffer;
use super::vpls::Vpls;
use crate::config::{VisibilityConfig, VisibilityMethod};
use crate::graph::{Graph, Image};
use crate::scene::device::{DeviceScene, SceneHandles};
use crate::scene::traced::TracedHandles;

/// What the gather tests a VPL's visibility with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Visibility {
    /// Nothing hides anything.
    None,
    /// A bit for each pixel and VPL that it takes: 32 a word, layer after layer.
    Bits(Image),
    /// A small map a VPL.
    Ism(Ism),
}

/// What a method may look at.
#[derive(Clone, Copy)]
pub struct Surroundings<'f> {
    pub scene: &'f DeviceScene,
    pub handles: SceneHandles,
    /// There where the method traces rays.
    pub traced: Option<&'f TracedHandles>,
    pub gbuffer: &'f GBuffer,
    /// Each pixel takes one of every `interleave^2` VPLs.
    pub interleave: u32,
    pub seed: u32,
}

/// Fills the slot with the config's method.
pub fn render(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, config: &VisibilityConfig) -> Visibility {
    match (config.method, around.traced) {
        (VisibilityMethod::None, _) => Visibility::None,
        (VisibilityMethod::RayTraced, Some(traced)) => ray_traced::render(g, traced, around.gbuffer, vpls, around.interleave),
        (VisibilityMethod::RayTraced, None) => unreachable!("the scene was brought without what rays need"),
        (VisibilityMethod::ImperfectShadowMaps, _) => ism::render(g, around, vpls, config),
    }
}
