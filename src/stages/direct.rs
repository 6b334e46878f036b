//! Direct light, with shadows from the depth of the reflective shadow maps, from maps of its own, or from rays.

use super::facts::Facts;
use super::gather::Indirect;
use super::methods::{Choice, NOTHING, Needs};
use super::rsm::{self, Rsm};
use super::surroundings::Surroundings;
use crate::config::{Config, Dielectric, DirectConfig, Shadows};
use crate::gpu::{Feature, Format, Sampler};
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;
use crate::world::device::{FrameScene, Maps};
use crate::world::projection::Projector;
use anyhow::Result;

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

/// What the lights see, as layers of an image: the depth of reflective shadow maps, or maps of their own.
#[derive(Debug, Clone, Copy)]
pub struct ShadowMaps {
    /// The projectors, one a layer.
    lights: Buffer,
    layers: u32,
    size: [u32; 2],
    depth: Image,
}

/// Refuses maps larger than the device's limits.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    config.shadow_map_size().map_or(Ok(()), |size| rsm::check_size("direct.map_size", size, facts))
}

/// The maps that shadow direct light: those of `projectors` if there are any, drawn with nothing but depth, else the reflective ones.
pub fn shadow_maps(g: &mut Graph, scene: FrameScene<'_>, rsm: &Rsm, projectors: &[Projector], config: &Config) -> ShadowMaps {
    let Some(size) = config.shadow_map_size().filter(|_| !projectors.is_empty()) else {
        return ShadowMaps { lights: rsm.lights, layers: rsm.layers, size: rsm.size, depth: rsm.depth };
    };
    let layers = projectors.len() as u32;
    let maps = ShadowMaps {
        lights: g.upload("direct/lights", &rsm::block(projectors)),
        layers,
        size,
        depth: g.layered_image("direct/depth", Format::Depth32, size, layers),
    };
    let lists = scene.draw_lists(g, "direct", Maps::Shadow, layers, |bounds| {
        projectors.iter().filter(|light| light.sees(bounds)).map(|light| light.distance(bounds)).reduce(f32::min)
    });
    g.raster("direct/shadow-map")
        .reads("lights", maps.lights)
        .reads("draws", scene.draws)
        .constant("SEVERAL_LIGHTS", layers > 1)
        .depth(maps.depth)
        .draw(lists);
    maps
}

/// Direct light with the shadows that the config chooses, and the filtered light of the sky if there is any: an image of outgoing radiance,
/// albedo included.
pub fn shade(g: &mut Graph, around: Surroundings<'_>, maps: &ShadowMaps, sky: Option<Indirect>, config: &DirectConfig) -> Image {
    let Surroundings { scene, traced, gbuffer, rsm, wants, .. } = around;
    let direct = g.image("direct/radiance", Format::Rgba16Float, gbuffer.size);
    // Without a light there is no map.
    let shadows = if maps.layers == 0 { Shadows::None } else { config.shadows };
    let moments = match shadows {
        Shadows::Variance => Some(variance_moments(g, maps, config.blur)),
        Shadows::PercentageCloser | Shadows::RayTraced | Shadows::None => None,
    };
    let (shadow, map) = match shadows {
        Shadows::Variance => ("direct/shadow-variance", moments.map(|image| ("moments", image, Sampler::Linear))),
        Shadows::PercentageCloser => ("direct/shadow-percentage-closer", Some(("shadow_depth", maps.depth, Sampler::Nearest))),
        Shadows::RayTraced => ("direct/shadow-ray-traced", None),
        Shadows::None => ("direct/shadow-none", None),
    };
    let mut pass = g
        .compute("direct/shade")
        .part("shadow", shadow)
        .reads("view", gbuffer.view)
        .reads("lights", maps.lights)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("albedo", gbuffer.albedo)
        .reads("metallic_roughness", gbuffer.metallic_roughness)
        .writes("direct", direct)
        .constant("GLOSSY_DIELECTRIC", wants.dielectric == Dielectric::Ggx)
        .constant("LIGHT_KIND", rsm.kind)
        .constant("METALS", scene.has_metals())
        .params(&ShadeParams {
            lights: maps.layers,
            bias: config.bias,
            map_size: maps.size.map(|n| n as i32),
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
fn variance_moments(g: &mut Graph, maps: &ShadowMaps, radius: u32) -> Image {
    let ShadowMaps { lights, layers, size, depth } = *maps;
    let [width, height] = size;
    let rows = g.layered_image("direct/moments-rows", Format::Rg32Float, size, layers);
    let moments = g.layered_image("direct/moments", Format::Rg32Float, size, layers);
    let params = MomentParams { size: [width, height, layers].map(|n| n as i32), radius: radius as i32 };
    g.compute("direct/moments")
        .reads("lights", lights)
        .reads("shadow_depth", depth)
        .writes("moments", rows)
        .params(&params)
        .dispatch([width, height, layers]);
    g.compute("direct/moments-blur").reads("moments", rows).writes("blurred", moments).params(&params).dispatch([width, height, layers]);
    moments
}
