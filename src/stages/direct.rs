//! Direct light, with shadows from the depth of the reflective shadow maps, or from rays.

use super::gather::Indirect;
use super::methods::{Choice, NOTHING, Needs};
use super::rsm::Rsm;
use super::surroundings::Surroundings;
use crate::config::{Dielectric, DirectConfig, Shadows};
use crate::gpu::{Feature, Format, Sampler};
use crate::graph::{Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct ShadeParams {
        lights: u32,
        bias: f32,
        map_size: [i32; 2],
        radius: i32,
        lift: f32,
    }

    struct MomentParams {
        size: [i32; 3],
        radius: i32,
    }
}

impl Choice for Shadows {
    const KEY: &'static str = "direct.shadows";

    fn needs(self) -> Needs {
        match self {
            Self::Variance => &[&[Feature::FilteredRg32Float]],
            Self::PercentageCloser | Self::RayTraced | Self::None => NOTHING,
        }
    }
}

/// Direct light with the shadows that the config chooses, and the filtered light of the sky if there is any: an image of outgoing radiance,
/// albedo included.
pub fn shade(g: &mut Graph, around: Surroundings<'_>, sky: Option<Indirect>, config: &DirectConfig) -> Image {
    let Surroundings { scene, traced, gbuffer, rsm, wants, .. } = around;
    let direct = g.image("direct/radiance", Format::Rgba16Float, gbuffer.size);
    // Without a light there is no map.
    let shadows = if rsm.layers == 0 { Shadows::None } else { config.shadows };
    let moments = match shadows {
        Shadows::Variance => Some(variance_moments(g, rsm, config.blur)),
        Shadows::PercentageCloser | Shadows::RayTraced | Shadows::None => None,
    };
    let (shadow, map) = match shadows {
        Shadows::Variance => ("direct/shadow-variance", moments.map(|image| ("moments", image, Sampler::Linear))),
        Shadows::PercentageCloser => ("direct/shadow-percentage-closer", Some(("rsm_depth", rsm.depth, Sampler::Nearest))),
        Shadows::RayTraced => ("direct/shadow-ray-traced", None),
        Shadows::None => ("direct/shadow-none", None),
    };
    let mut pass = g
        .compute("direct/shade")
        .part("shadow", shadow)
        .reads("view", gbuffer.view)
        .reads("lights", rsm.lights)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("albedo", gbuffer.albedo)
        .reads("metallic_roughness", gbuffer.metallic_roughness)
        .writes("direct", direct)
        .constant("GLOSSY_DIELECTRIC", wants.dielectric == Dielectric::Ggx)
        .constant("LIGHT_KIND", rsm.kind)
        .constant("METALS", scene.has_metals())
        .params(&ShadeParams {
            lights: rsm.layers,
            bias: config.bias,
            map_size: rsm.size.map(|n| n as i32),
            radius: config.blur as i32,
            // The filter window's farthest texel must stay below the lifted point on a slope. A variance map needs no wider lift: its mean
            // stays on the slope.
            lift: if shadows == Shadows::PercentageCloser { config.blur as f32 + 1.0 } else { 1.0 },
        });
    pass = match (shadows, traced) {
        (Shadows::RayTraced, Some(traced)) => pass.traces(traced),
        (Shadows::RayTraced, None) => unreachable!("the scene was brought without what rays need"),
        _ => pass,
    };
    if let Some(Indirect { irradiance, reflection, .. }) = sky {
        pass = match reflection {
            None => pass.part("sky", "direct/sky-diffuse"),
            Some(reflection) => pass.part("sky", "direct/sky-glossy").reads("sky_reflection", reflection),
        };
        pass = pass.reads("sky_irradiance", irradiance);
    }
    if let Some((binding, image, sampler)) = map {
        pass = pass.samples(binding, image, sampler);
    }
    pass.dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    direct
}

/// Mean and mean square of the distances, box-blurred: a variance shadow map (Donnelly and Lauritzen 2006).
fn variance_moments(g: &mut Graph, rsm: &Rsm, radius: u32) -> Image {
    let [width, height] = rsm.size;
    let rows = g.layered_image("direct/moments-rows", Format::Rg32Float, rsm.size, rsm.layers);
    let moments = g.layered_image("direct/moments", Format::Rg32Float, rsm.size, rsm.layers);
    let params = MomentParams { size: [width, height, rsm.layers].map(|n| n as i32), radius: radius as i32 };
    g.compute("direct/moments")
        .reads("lights", rsm.lights)
        .reads("rsm_depth", rsm.depth)
        .writes("moments", rows)
        .params(&params)
        .dispatch([width, height, rsm.layers]);
    g.compute("direct/moments-blur")
        .reads("moments", rows)
        .writes("blurred", moments)
        .params(&params)
        .dispatch([width, height, rsm.layers]);
    moments
}
