//! Which VPLs a point sees.

use super::gather::{groups_of_sets, vpls_a_pixel};
use super::gbuffer::GBuffer;
use super::vpls::Vpls;
use crate::config::{VisibilityConfig, VisibilityMethod};
use crate::gpu::Format;
use crate::graph::{Graph, Image};
use crate::scene::traced::TracedHandles;
use crate::shader_struct;

shader_struct! {
    struct RayTracedParams {
        count: u32,
    }
}

/// What the gather tests a VPL's visibility with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Visibility {
    /// Nothing hides anything.
    None,
    /// A bit for each pixel and VPL that it takes: 32 a word, layer after layer.
    Bits(Image),
}

/// VPLs whose bits a texel holds.
pub const BITS: u32 = 32;

/// Fills the slot with the config's method. Each pixel takes one of every `interleave^2` VPLs; `traced` is there where the method
/// traces rays.
pub fn render(
    g: &mut Graph,
    traced: Option<&TracedHandles>,
    gbuffer: &GBuffer,
    vpls: &Vpls,
    interleave: u32,
    config: &VisibilityConfig,
) -> Visibility {
    match (config.method, traced) {
        (VisibilityMethod::None, _) => Visibility::None,
        (VisibilityMethod::RayTraced, Some(traced)) => ray_traced(g, traced, gbuffer, vpls, interleave),
        (VisibilityMethod::RayTraced, None) => unreachable!("the scene was brought without what rays need"),
    }
}

/// A ray from every pixel to every VPL that it takes: exact, and as slow as that.
fn ray_traced(g: &mut Graph, traced: &TracedHandles, gbuffer: &GBuffer, vpls: &Vpls, interleave: u32) -> Visibility {
    let layers = vpls_a_pixel(vpls.count, interleave).div_ceil(BITS);
    let visible = g.layered_image("visibility/visible", Format::R32Uint, gbuffer.size, layers);
    let groups = groups_of_sets(gbuffer.size, interleave, [1, 1]);
    g.compute("visibility/ray-traced")
        .traces(traced)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("points", vpls.points)
        .reads("intensities", vpls.intensities)
        .writes("visible", visible)
        .constant("INTERLEAVE", interleave)
        .params(&RayTracedParams { count: vpls.count })
        .dispatch_groups([groups[0], groups[1], layers]);
    Visibility::Bits(visible)
}
