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
    let interleave = noisy.pattern.side();
    let (weights, radius) = match config.kind {
        FilterKind::None => return noisy,
        // Without an interleaving pattern and without a radius in the config, there is no noise to filter.
        _ if config.radius.unwrap_or(interleave) <= 1 => return noisy,
        FilterKind::Bilateral => ("filter/weights-bilateral", interleave),
        FilterKind::Gaussian => ("filter/weights-gaussian", 2 * interleave),
        FilterKind::CrossBilateral => ("filter/weights-cross-bilateral", interleave),
    };
    let radius = config.radius.unwrap_or(radius);
    let irradiance =
        separable(g, gbuffer, noisy.irradiance, weights, ["filter/rows", "filter/columns", "filter/irradiance"], radius, config);
    let names = ["filter/reflection-rows", "filter/reflection-columns", "filter/reflection"];
    let reflection = noisy.reflection.map(|noisy| separable(g, gbuffer, noisy, weights, names, radius, config));
    Indirect { irradiance, reflection, ..noisy }
}

/// Depth- and normal-aware separable filter, along rows, then along columns (Laine et al. 2007); the part `weights` gives the falloff.
fn separable(
    g: &mut Graph,
    gbuffer: &GBuffer,
    noisy: Image,
    weights: &'static str,
    [in_rows, in_columns, name]: [&'static str; 3],
    radius: u32,
    config: &FilterConfig,
) -> Image {
    let rows = g.image(in_rows, Format::Rgba16Float, gbuffer.size);
    let smoothed = g.image(name, Format::Rgba16Float, gbuffer.size);
    let params = SeparableParams {
        radius: radius as i32,
        min_cosine: config.normal_threshold_deg.to_radians().cos(),
        plane_distance: config.plane_distance,
    };
    for (name, vertical, from, to) in [(in_rows, false, noisy, rows), (in_columns, true, rows, smoothed)] {
        g.compute(name)
            .shader("filter/separable")
            .part("weights", weights)
            .reads("view", gbuffer.view)
            .reads("depth", gbuffer.depth)
            .reads("normal", gbuffer.normal)
            .reads("noisy", from)
            .writes("smoothed", to)
            .constant("VERTICAL", vertical)
            .params(&params)
            .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    }
    smoothed
}
