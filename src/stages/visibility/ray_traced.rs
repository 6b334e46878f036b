//! Exact visibility: a bit for each pixel and VPL.

use super::super::gather::{groups_of_sets, vpls_a_pixel};
use super::super::gbuffer::GBuffer;
use super::super::vpls::Vpls;
use super::Visibility;
use crate::gpu::Format;
use crate::graph::Graph;
use crate::scene::traced::TracedHandles;
use crate::shader_struct;

shader_struct! {
    struct RayTracedParams {
        count: u32,
    }
}

/// VPLs whose bits a texel holds.
pub const BITS: u32 = 32;

/// A ray from every pixel to every VPL that it takes: exact, and as slow as that.
pub(super) fn render(g: &mut Graph, traced: &TracedHandles, gbuffer: &GBuffer, vpls: &Vpls, interleave: u32) -> Visibility {
    let layers = vpls_a_pixel(vpls.count, interleave).div_ceil(BITS);
    let visible = g.layered_image("visibility/visible", Format::R32Uint, gbuffer.size, layers);
    let groups = groups_of_sets(gbuffer.size, interleave, [1, 1]);
    g.compute("visibility/ray-traced")
        .traces(traced)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .writes("visible", visible)
        .constant("INTERLEAVE", interleave)
        .params(&RayTracedParams { count: vpls.count })
        .dispatch_groups([groups[0], groups[1], layers]);
    Visibility::Bits(visible)
}
