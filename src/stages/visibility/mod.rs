//! Which VPLs a point sees.

mod adaptive;
mod ism;
mod points;
mod pull_push;
mod ray_traced;
mod shared;

pub use ism::{Ism, partition_capacity};
pub use ray_traced::BITS;
pub use shared::MOST_TEXELS_A_MAP;

use super::bounce::{Bounce, Clusters};
use super::gbuffer::GBuffer;
use super::rsm::Rsm;
use super::vpls::Vpls;
use crate::config::{Config, Lookup, VisibilityConfig, VisibilityMethod};
use crate::graph::{Buffer, Graph, Image};
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
    /// A small map for several VPLs: of each which one, and the places that the maps are seen from.
    SharedIsm { ism: Ism, labels: Buffer, proxies: Buffer },
    /// A map a cluster of VPLs; the bias is in widths of a texel.
    Clusters { clusters: Clusters, bias: f32, lookup: Lookup },
}

/// What a method may look at.
#[derive(Clone, Copy)]
pub struct Surroundings<'f> {
    pub scene: &'f DeviceScene,
    pub handles: SceneHandles,
    /// There where the method traces rays.
    pub traced: Option<&'f TracedHandles>,
    pub gbuffer: &'f GBuffer,
    pub rsm: &'f Rsm,
    /// Each pixel takes one of every `interleave^2` VPLs.
    pub interleave: u32,
    pub seed: u32,
}

/// The VPLs of each bounce, with what they see: fills the slot with the config's method for the first ones, and with
/// `bounce.visibility` for the others.
pub fn render(g: &mut Graph, around: Surroundings<'_>, bounces: &[Bounce], config: &Config) -> Vec<(Vpls, Visibility)> {
    let of_bounce = |((bounce, method), time): ((&Bounce, VisibilityMethod), u32)| {
        let visibility = g.again(time, |g| match (config.shared_maps(), time) {
            (Some(maps), 1) => shared::render(g, around, &bounce.vpls, maps, &config.visibility),
            _ => of_vpls(g, around, bounce, method, &config.visibility),
        });
        (bounce.vpls, visibility)
    };
    bounces.iter().zip(config.visibility_methods()).zip(1..).map(of_bounce).collect()
}

fn of_vpls(g: &mut Graph, around: Surroundings<'_>, bounce: &Bounce, method: VisibilityMethod, config: &VisibilityConfig) -> Visibility {
    let vpls = &bounce.vpls;
    match (method, around.traced, bounce.clusters) {
        (VisibilityMethod::None, ..) => Visibility::None,
        (VisibilityMethod::RayTraced, Some(traced), _) => ray_traced::render(g, traced, around.gbuffer, vpls, around.interleave),
        (VisibilityMethod::RayTraced, None, _) => unreachable!("the scene was brought without what rays need"),
        (VisibilityMethod::ImperfectShadowMaps, ..) => ism::render(g, around, vpls, config),
        (VisibilityMethod::Clusters, _, Some(clusters)) => Visibility::Clusters { clusters, bias: config.bias, lookup: config.lookup },
        (VisibilityMethod::Clusters, _, None) => unreachable!("clusters are made where they say what is seen"),
    }
}
