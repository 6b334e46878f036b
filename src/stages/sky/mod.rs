//! Light of the sky: virtual point lights on a sphere around the scene (Barák, Bittner and Havran 2013, table 1), taken as directions, so
//! that a map has no parallax. It is direct light, in a layer with that of the other lights.

mod directions;

use super::facts::Facts;
use super::gather::{Indirect, in_maps};
use super::methods::{Choice, NOTHING, Needs};
use super::surroundings::Surroundings;
use super::visibility::{self, BITS};
use super::vpls::Vpls;
use crate::config::{Config, Dielectric, SkyVisibility};
use crate::fail;
use crate::gpu::Format;
use crate::graph::{ComputePass, Graph, Image};
use crate::shader_struct;
use crate::world::sky::FrameSky;
use anyhow::Result;
use directions::Directions;

shader_struct! {
    struct GatherParams {
        count: u32,
        least_alpha: f32,
    }

    struct RayTracedParams {
        count: u32,
    }
}

impl Choice for SkyVisibility {
    const KEY: &'static str = "sky.visibility";

    fn needs(self) -> Needs {
        match self {
            Self::None | Self::RayTraced | Self::ImperfectShadowMaps => NOTHING,
        }
    }
}

/// Whether a config traces shadow rays to the sky.
pub fn needs_rays(config: &Config) -> bool {
    config.sky_visibility() == Some(SkyVisibility::RayTraced)
}

/// Whether a config renders imperfect shadow maps of the sky.
pub fn needs_maps(config: &Config) -> bool {
    config.sky_visibility() == Some(SkyVisibility::ImperfectShadowMaps)
}

/// Refuses numbers of directions whose shadows are over the device's limits.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    let limits = &facts.adapter.limits;
    let each = facts.interleave.per_pixel(config.sky.count);
    let most = limits.image_layers.saturating_mul(BITS);
    if needs_rays(config) && each > most {
        return Err(fail!(
            BadInput,
            "sky.count: {each} directions a pixel are over the {most} whose rays {} keeps; lower it or raise gather.interleave",
            facts.adapter.name
        ));
    }
    let columns = f64::from(each * facts.interleave.sets()).sqrt().ceil() as u32;
    let (side, most) = (columns * config.sky.map_size, limits.image_size);
    if needs_maps(config) && side > most {
        return Err(fail!(
            BadInput,
            "sky.count: the maps of all directions are {side} texels a side, over the {most} that {} allows; lower it or sky.map_size",
            facts.adapter.name
        ));
    }
    Ok(())
}

/// Warnings about light of the sky that frames lack.
pub fn warnings(config: &Config) -> Vec<String> {
    let warning = "light: an environment's light is direct light alone in a rasterized frame; surfaces do not pass it on to others";
    config.has_sky().then(|| warning.to_owned()).into_iter().collect()
}

/// Binds the radiance of the sky in a pass that has `#include "part/radiance=sky/radiance-constant"`.
pub fn sky_of<'g>(pass: ComputePass<'g>, sky: &FrameSky<'_>) -> ComputePass<'g> {
    let pass = pass.reads("sky", sky.block);
    match sky.map {
        None => pass,
        Some(map) => pass.part("radiance", "sky/radiance-map").reads("sky_map", map.texels),
    }
}

/// Light of the sky at the receivers, not yet filtered; `None` if no sky shines. `time` is the number of the sky's lights after the bounces'.
pub fn light(g: &mut Graph, around: Surroundings<'_>, sky: &FrameSky<'_>, time: u32, config: &Config) -> Option<Indirect> {
    let visibility = config.sky_visibility()?;
    let directions = Directions::draw(sky, config.sky.count, around.wants);
    Some(gather(g, around, &directions, visibility, time, config))
}

/// Sums the directions of its sample set at every pixel.
fn gather(
    g: &mut Graph,
    around: Surroundings<'_>,
    directions: &Directions,
    visibility: SkyVisibility,
    time: u32,
    config: &Config,
) -> Indirect {
    let vpls = &directions.vpls(g, around);
    let (gbuffer, interleave) = (around.gbuffer, around.wants.interleave);
    let glossy_dielectric = around.wants.dielectric == Dielectric::Ggx;
    let irradiance = g.image("sky/irradiance", Format::Rgba16Float, gbuffer.size);
    let reflection = (glossy_dielectric || around.scene.has_metals()).then(|| g.image("sky/reflection", Format::Rgba16Float, gbuffer.size));
    let [across, down] = interleave.groups(gbuffer.size, [16, 8]);
    let pass = match visibility {
        SkyVisibility::None => g.compute("sky/gather"),
        SkyVisibility::RayTraced => {
            let visible = ray_traced(g, around, vpls);
            g.compute("sky/gather").part("seen", "sky/seen-bits").reads("visible", visible)
        }
        SkyVisibility::ImperfectShadowMaps => {
            let (size, frames) = (config.sky.map_size, directions.frames(g, around));
            let ism = g.again(time, |g| visibility::of_directions(g, around, vpls, frames, size, &config.visibility));
            in_maps(g, "sky/gather", ism).part("seen", "sky/seen-ism").reads("frames", frames)
        }
    };
    let pass = match reflection {
        None => pass,
        Some(reflection) => pass
            .part("reflection", "sky/reflection-ggx")
            .reads("albedo", gbuffer.albedo)
            .reads("metallic_roughness", gbuffer.metallic_roughness)
            .writes("reflection", reflection)
            .constant("GLOSSY_DIELECTRIC", glossy_dielectric),
    };
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("irradiances", vpls.intensities)
        .writes("irradiance", irradiance)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        // A direction is a disk of 4 pi / n sr. Half its angular radius spreads a mirror's half vectors.
        .params(&GatherParams { count: vpls.count, least_alpha: 1.0 / f64::from(vpls.count).sqrt() as f32 })
        .dispatch_groups([across, down, 1]);
    Indirect { irradiance, reflection, pattern: interleave, shares: None }
}

/// A shadow ray from every pixel in every direction of its sample set: a bit each, as [`visibility::Visibility::Bits`].
fn ray_traced(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls) -> Image {
    let Surroundings { gbuffer, traced: Some(traced), wants, .. } = around else {
        unreachable!("the scene was brought without what rays need")
    };
    let layers = wants.interleave.per_pixel(vpls.count).div_ceil(BITS);
    let visible = g.layered_image("sky/visible", Format::R32Uint, gbuffer.size, layers);
    let [across, down] = wants.interleave.groups(gbuffer.size, [8, 4]);
    g.compute("sky/ray-traced")
        .traces(traced)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .writes("visible", visible)
        .constant("BLOCK_ACROSS", wants.interleave.across())
        .constant("BLOCK_DOWN", wants.interleave.down())
        .params(&RayTracedParams { count: vpls.count })
        .dispatch_groups([across, down, layers]);
    visible
}
