//! Screen-space ambient occlusion, for occluders of indirect light that are too near for VPLs and for the low resolution of their maps. It
//! is one of the thesis's passes (Linke 2016, section 4.2), here by horizons (Jimenez et al. 2016).

use super::gbuffer::GBuffer;
use super::methods::{Choice, NOTHING, Needs};
use crate::config::{SsaoConfig, SsaoMethod, SsaoResolution};
use crate::gpu::{Feature, Format};
use crate::graph::{Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct DistancesParams {
        size: [i32; 2],
        step: i32,
    }

    struct HorizonsParams {
        size: [i32; 2],
        step: i32,
        radius: f32,
        samples: i32,
    }

    struct BlurParams {
        size: [i32; 2],
        tolerance: f32,
    }

    struct ShareParams {
        size: [i32; 2],
        step: i32,
        strength: f32,
    }
}

/// Deviation from the surface's extrapolated depth at which a texel belongs to another surface, relative to the surface's distance.
const TOLERANCE: f32 = 0.01;

impl Choice for SsaoMethod {
    const KEY: &'static str = "ssao.method";

    fn needs(self) -> Needs {
        match self {
            Self::None => NOTHING,
            Self::Horizons => &[&[Feature::FilteredRg32Float]],
        }
    }
}

/// Cosine-weighted share of the hemisphere that each pixel sees, in [0, 1]; `None` if the config chooses no method.
pub fn occlusion(g: &mut Graph, gbuffer: &GBuffer, config: &SsaoConfig) -> Option<Image> {
    match config.method {
        SsaoMethod::None => None,
        SsaoMethod::Horizons => Some(horizons(g, gbuffer, config)),
    }
}

fn horizons(g: &mut Graph, gbuffer: &GBuffer, config: &SsaoConfig) -> Image {
    let step = match config.resolution {
        SsaoResolution::Full => 1,
        SsaoResolution::Half => 2,
    };
    let texels = gbuffer.size.map(|n| n.div_ceil(step));
    let size = texels.map(|n| n as i32);
    let step = step as i32;
    let distances = g.image("ssao/distances", Format::R32Float, texels);
    let [sharp, rows, seen] = ["ssao/sharp", "ssao/rows", "ssao/seen"].map(|name| g.image(name, Format::Rg32Float, texels));
    let visible = g.image("ssao/visible", Format::R32Float, gbuffer.size);
    g.compute("ssao/distances")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .writes("distances", distances)
        .params(&DistancesParams { size, step })
        .dispatch([texels[0], texels[1], 1]);
    g.compute("ssao/horizons")
        .reads("view", gbuffer.view)
        .reads("normal", gbuffer.normal)
        .reads("distances", distances)
        .writes("seen", sharp)
        .params(&HorizonsParams { size, step, radius: config.radius, samples: config.samples as i32 })
        .dispatch([texels[0], texels[1], 1]);
    for (name, vertical, from, to) in [("ssao/blur-rows", false, sharp, rows), ("ssao/blur-columns", true, rows, seen)] {
        g.compute(name)
            .shader("ssao/blur")
            .reads("distances", distances)
            .reads("sharp", from)
            .writes("blurred", to)
            .constant("VERTICAL", vertical)
            .params(&BlurParams { size, tolerance: TOLERANCE })
            .dispatch([texels[0], texels[1], 1]);
    }
    g.compute("ssao/share")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("distances", distances)
        .reads("seen", seen)
        .writes("visible", visible)
        .params(&ShareParams { size, step, strength: config.strength })
        .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    visible
}
