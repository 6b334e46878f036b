//! Irradiance at every pixel from the VPLs.

use super::gbuffer::GBuffer;
use super::visibility::Visibility;
use super::vpls::Vpls;
use crate::config::{GatherConfig, GatherMethod};
use crate::gpu::Format;
use crate::graph::{Graph, Image};
use crate::shader_struct;

shader_struct! {
    /// `glsl/gather/ism.glsl`.
    struct IsmBlock {
        far: f32,
        bias: f32,
        size: i32,
        columns: u32,
    }

    struct PerPixelParams {
        count: u32,
        squared_min_distance: f32,
    }
}

/// llvmpipe ends an invocation's loops after 65,535 turns in all, without a word; `glsl/gather/per-pixel.glsl` takes at most
/// two turns for four VPLs.
pub const MOST_VPLS_A_PIXEL: u64 = 100_000;

/// Fills the slot with the config's method; the image holds indirect irradiance, W/m^2.
pub fn indirect(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, visibility: Visibility, config: &GatherConfig) -> Image {
    match config.method {
        GatherMethod::PerPixel => per_pixel(g, gbuffer, vpls, visibility, config),
    }
}

/// VPLs that each pixel sums, at most.
pub fn vpls_a_pixel(count: u32, interleave: u32) -> u32 {
    count.div_ceil(interleave * interleave)
}

/// Workgroups of one sample set each that cover the picture; one shades 8 x 4 times `pixels` pixels of its set.
pub(super) fn groups_of_sets(size: [u32; 2], interleave: u32, pixels: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|axis| size[axis].div_ceil([8, 4][axis] * pixels[axis] * interleave) * interleave)
}

/// Every pixel takes one of every `interleave^2` VPLs (Linke 2016, section 4.5).
fn per_pixel(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, visibility: Visibility, config: &GatherConfig) -> Image {
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let n = config.interleave;
    let groups = groups_of_sets(gbuffer.size, n, [2, 2]);
    let pass = match visibility {
        Visibility::None => g.compute("gather/per-pixel"),
        Visibility::Bits(visible) => g.compute("gather/per-pixel-visible").reads("visible", visible),
        Visibility::Ism(ism) => {
            let block = IsmBlock { far: ism.far, bias: ism.bias, size: ism.size as i32, columns: ism.columns };
            let block = g.upload("gather/ism", &[block]);
            g.compute("gather/per-pixel-ism").reads("ism", block).reads("maps", ism.maps)
        }
    };
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("points", vpls.points)
        .reads("intensities", vpls.intensities)
        .writes("irradiance", irradiance)
        .constant("INTERLEAVE", n)
        .params(&PerPixelParams { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance })
        .dispatch_groups([groups[0], groups[1], 1]);
    irradiance
}
