//! Edge-aware filter for the noise of interleaved sampling.

use super::gather::Indirect;
use super::gbuffer::GBuffer;
use super::methods::{Choice, NOTHING, Needs};
use crate::config::{FilterConfig, FilterKind};
use crate::gpu::Format;
use crate::graph::{Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct SeparableParams {
        radius: i32,
        min_cosine: f32,
        plane_distance: f32,
    }
}

impl Choice for FilterKind {
    const KEY: &'static str = "filter.kind";

    fn needs(self) -> Needs {
        match self {
            Self::Bilateral | Self::Gaussian | Self::CrossBilateral | Self::None => NOTHING,
        }
    }
}

/// Filters the indirect light as the config says; without interleaving and without a radius of its own it returns the input.
pub fn smooth(g: &mut Graph, gbuffer: &GBuffer, noisy: Indirect, config: &FilterConfig) -> Indirect {
    let block = [noisy.pattern.across(), noisy.pattern.down()].map(|side| config.radius.unwrap_or(side));
    let (weights, scale) = match config.kind {
        FilterKind::None => return noisy,
        // Without an interleaving pattern and without a radius in the config, there is no noise to filter.
        _ if block[0].max(block[1]) <= 1 => return noisy,
        FilterKind::Bilateral => ("filter/weights-bilateral", 1),
        FilterKind::Gaussian => ("filter/weights-gaussian", if config.radius.is_some() { 1 } else { 2 }),
        FilterKind::CrossBilateral => ("filter/weights-cross-bilateral", 1),
    };
    // Rows by the block's width, columns by its height.
    let radii = block.map(|side| if side > 1 { side * scale } else { 1 });
    let irradiance =
        separable(g, gbuffer, noisy.irradiance, weights, ["filter/rows", "filter/columns", "filter/irradiance"], radii, config);
    let names = ["filter/reflection-rows", "filter/reflection-columns", "filter/reflection"];
    let reflection = noisy.reflection.map(|noisy| separable(g, gbuffer, noisy, weights, names, radii, config));
    Indirect { irradiance, reflection, ..noisy }
}

/// Filters the light of the sky, if there is any, as the indirect light before it.
pub fn smooth_sky(g: &mut Graph, gbuffer: &GBuffer, noisy: Option<Indirect>, config: &FilterConfig) -> Option<Indirect> {
    noisy.map(|noisy| g.again(2, |g| smooth(g, gbuffer, noisy, config)))
}

/// Depth- and normal-aware separable filter, along rows, then along columns (Laine et al. 2007); the part `weights` gives the falloff.
fn separable(
    g: &mut Graph,
    gbuffer: &GBuffer,
    noisy: Image,
    weights: &'static str,
    [in_rows, in_columns, name]: [&'static str; 3],
    radii: [u32; 2],
    config: &FilterConfig,
) -> Image {
    let rows = g.image(in_rows, Format::Rgba16Float, gbuffer.size);
    let smoothed = g.image(name, Format::Rgba16Float, gbuffer.size);
    let params = |radius| SeparableParams {
        radius,
        min_cosine: config.normal_threshold_deg.to_radians().cos(),
        plane_distance: config.plane_distance,
    };
    for (name, vertical, from, to, radius) in [(in_rows, false, noisy, rows, radii[0]), (in_columns, true, rows, smoothed, radii[1])] {
        g.compute(name)
            .shader("filter/separable")
            .part("weights", weights)
            .reads("view", gbuffer.view)
            .reads("depth", gbuffer.depth)
            .reads("normal", gbuffer.normal)
            .reads("noisy", from)
            .writes("smoothed", to)
            .constant("VERTICAL", vertical)
            .params(&params(radius as i32))
            .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    }
    smoothed
}
