//! A frame, read aloud.

use crate::config::Config;
use crate::graph::{Graph, Image};
use crate::stages::compose::{Composed, Light};
use crate::stages::gather::{Gathered, Indirect, Roulette};
use crate::stages::gbuffer::GBuffer;
use crate::stages::residents::Residents;
use crate::stages::surroundings::Surroundings;
use crate::stages::visibility::Visibility;
use crate::stages::vpls::Vpls;
use crate::stages::wants::Wants;
use crate::stages::{bounce, compose, deform, direct, filter, gather, gbuffer, rsm, sky, ssao, visibility, vpls};
use crate::world::{Shot, World};

/// Resources that a frame makes.
#[derive(Debug, Clone)]
pub struct Frame {
    pub gbuffer: GBuffer,
    /// VPLs of each bounce, with their visibility.
    pub lights: Vec<(Vpls, Visibility)>,
    /// Indirect light before filtering.
    pub gathered: Gathered,
    /// Indirect light after filtering.
    pub indirect: Indirect,
    /// Share of the indirect light that ambient occlusion leaves.
    pub visible: Option<Image>,
    /// Direct light's radiance.
    pub direct: Image,
    pub composed: Composed,
}

/// Many-light global illumination, one slot a line.
pub fn frame(g: &mut Graph, world: &World, residents: &Residents, shot: &Shot, config: &Config) -> Frame {
    let wants = Wants::of(config, shot.lighting.projectors.len() as u32);
    let (scene, traced) = world.import(g);
    let residents = residents.import(g);
    let scene = deform::vertices(g, scene, &residents);
    let sky = world.import_sky(g, &shot.lighting);
    let gbuffer = gbuffer::draw(g, scene, &shot.view);
    let rsm = rsm::draw(g, scene, &shot.lighting.projectors, &wants, &config.rsm);
    let vpls = vpls::sample(g, &rsm, &gbuffer, &wants, &config.vpls);
    let bounces = bounce::propagate(g, scene, vpls, &wants, &config.bounce);
    let (traced, view, asked) = (traced.as_ref(), &shot.view, shot.inspection.pixel);
    let around = Surroundings { scene, residents, traced, view, gbuffer: &gbuffer, rsm: &rsm, wants: &wants, asked };
    let lights = visibility::render(g, around, &bounces, &config.visibility);
    let gathered = gather::indirect(g, around, &lights, Roulette::of(config, shot.index), &config.gather);
    let indirect = filter::smooth(g, &gbuffer, gathered.light, &config.filter);
    let visible = ssao::occlusion(g, &gbuffer, &config.ssao);
    let sky_light = sky::light(g, around, &sky, bounces.len() as u32 + 1, config);
    let sky_light = filter::smooth_sky(g, &gbuffer, sky_light, &config.filter);
    let shadow_maps = direct::shadow_maps(g, scene, &rsm, &shot.lighting.shadow_projectors, config);
    let direct = direct::shade(g, around, &shadow_maps, sky_light, &config.direct);
    let light = Light { direct, indirect, visible };
    let composed = compose::sum(g, &gbuffer, light, vpls.as_ref(), &sky, &config.compose);
    Frame { gbuffer, lights, gathered, indirect, visible, direct, composed }
}
