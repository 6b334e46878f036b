//! Exact visibility by rays: a bit for each pixel and VPL.

use super::Visibility;
use crate::gpu::Format;
use crate::graph::Graph;
use crate::shader_struct;
use crate::stages::gbuffer::GBuffer;
use crate::stages::interleave::Interleave;
use crate::stages::vpls::Vpls;
use crate::world::traced::TracedHandles;

shader_struct! {
    struct RayTracedParams {
        count: u32,
    }
}

/// VPLs whose bits fit into a texel.
pub const BITS: u32 = 32;

/// A shadow ray from every pixel to every VPL of its sample set: exact, and slow.
pub(super) fn render(g: &mut Graph, traced: &TracedHandles, gbuffer: &GBuffer, vpls: &Vpls, interleave: Interleave) -> Visibility {
    let layers = interleave.per_pixel(vpls.count).div_ceil(BITS);
    let visible = g.layered_image("visibility/visible", Format::R32Uint, gbuffer.size, layers);
    let groups = interleave.groups(gbuffer.size, [8, 4]);
    g.compute("visibility/ray-traced")
        .traces(traced)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .writes("visible", visible)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .params(&RayTracedParams { count: vpls.count })
        .dispatch_groups([groups[0], groups[1], layers]);
    Visibility::Bits(visible)
}
