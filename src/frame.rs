//! A frame, read aloud.

use crate::config::Config;
use crate::graph::{Graph, Image};
use crate::scene::device::DeviceScene;
use crate::scene::projection::{Projector, View};
use crate::scene::traced::TracedScene;
use crate::stages::compose::Composed;
use crate::stages::gather::Roulette;
use crate::stages::gbuffer::GBuffer;
use crate::stages::visibility::Surroundings;
use crate::stages::{bounce, compose, direct, filter, gather, gbuffer, rsm, ssao, visibility, vpls};
use glam::Vec3;

/// What a frame is lit by.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// The layers of the reflective shadow map; at least one.
    pub projectors: Vec<Projector>,
    /// Radiance where the camera sees no surface.
    pub environment: Vec3,
}

/// What a frame makes.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub gbuffer: GBuffer,
    /// Indirect irradiance after filtering.
    pub irradiance: Image,
    /// Direct light's radiance.
    pub direct: Image,
    pub composed: Composed,
}

/// Many-light global illumination, one slot a line; frame number `index` of its sequence.
pub fn frame(
    g: &mut Graph,
    scene: &DeviceScene,
    traced: Option<&TracedScene>,
    view: &View,
    lighting: &Lighting,
    config: &Config,
    index: u32,
) -> Frame {
    let handles = scene.import(g);
    let traced = traced.map(|traced| traced.import(g));
    let gbuffer = gbuffer::draw(g, scene, handles, view);
    let rsm = rsm::draw(g, scene, handles, &lighting.projectors, config);
    let vpls = vpls::sample(g, &rsm, &gbuffer, &config.vpls);
    let bounces = bounce::propagate(g, scene, handles, vpls, config);
    let around = Surroundings {
        scene,
        handles,
        traced: traced.as_ref(),
        gbuffer: &gbuffer,
        rsm: &rsm,
        interleave: config.gather.interleave,
        seed: config.frame.seed,
    };
    let lights = visibility::render(g, around, &bounces, config);
    let roulette = Roulette::of(config, index);
    let indirect = gather::indirect(g, &scene.shells, &gbuffer, &lights, roulette, config.materials.dielectric, &config.gather);
    let indirect = filter::smooth(g, &gbuffer, indirect, config.gather.interleave, &config.filter);
    let visible = ssao::occlusion(g, &gbuffer, &config.ssao);
    let direct = direct::shade(g, scene, traced.as_ref(), &gbuffer, &rsm, config.materials.dielectric, &config.direct);
    let composed = compose::sum(g, &gbuffer, direct, indirect, visible, lighting.environment, &config.compose);
    Frame { gbuffer, irradiance: indirect.irradiance, direct, composed }
}
