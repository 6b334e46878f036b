//! Slots of the frame: one module each, named as its folder of shaders. A method that fills a slot is a function with typed inputs and
//! outputs; its resources are reachable only through its result. A stage also says which features its methods need, which configs it
//! refuses and what it warns of. `README.md` beside this file says how to add a method.

pub mod bounce;
pub mod compose;
pub mod deform;
pub mod direct;
pub mod facts;
pub mod filter;
pub mod gather;
pub mod gbuffer;
pub mod interleave;
pub mod methods;
pub mod residents;
pub mod rsm;
pub mod sky;
pub mod ssao;
pub mod surroundings;
pub mod visibility;
pub mod vpls;
pub mod wants;

use crate::config::{
    CacheOcclusion, Collect, Config, Culling, FilterKind, GatherMethod, Importance, IsmRenderer, Layers, PointSet, Rasterization, Shadows,
    SkyVisibility, SsaoMethod, StochasticCulling, VisibilityMethod, VplSampler,
};
use crate::scene::{Light, Scene};
use anyhow::Result;
use facts::Facts;
use methods::Method;
use std::collections::BTreeMap;

/// All methods of all slots, in the frame's order.
pub fn methods() -> Vec<Method> {
    [
        vec![deform::method(), gbuffer::method(), rsm::method()],
        Method::every::<VplSampler>(),
        Method::every::<Importance>(),
        Method::every::<Layers>(),
        Method::every::<VisibilityMethod>(),
        Method::every::<PointSet>(),
        Method::every::<Collect>(),
        Method::every::<IsmRenderer>(),
        Method::every::<GatherMethod>(),
        Method::every::<CacheOcclusion>(),
        Method::every::<Culling>(),
        Method::every::<StochasticCulling>(),
        Method::every::<Rasterization>(),
        Method::every::<FilterKind>(),
        Method::every::<SkyVisibility>(),
        Method::every::<Shadows>(),
        Method::every::<SsaoMethod>(),
        vec![compose::method()],
    ]
    .concat()
}

/// Methods that a config uses.
pub fn methods_of(config: &Config) -> Vec<Method> {
    let mut methods = vec![gbuffer::method(), rsm::method(), Method::of(config.vpls.sampler), Method::of(config.vpls.importance)];
    if bounce::has_clusters(config) {
        methods.push(Method::of(config.bounce.clusters.layers));
    }
    methods.push(Method::of(config.visibility.method));
    if visibility::triangles::needs_triangles(config) {
        let ism = &config.visibility.ism;
        methods.extend([Method::of(ism.points), Method::of(ism.collect), visibility::renderer(ism)]);
    }
    methods.extend(gather::methods(config));
    methods.push(Method::of(config.filter.kind));
    methods.extend(config.sky_visibility().map(Method::of));
    methods.extend([Method::of(config.direct.shadows), Method::of(config.ssao.method), compose::method()]);
    methods
}

/// Names of the stages, in the frame's order: the part of a pass's name before the slash.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = methods().into_iter().map(|method| method.slot.split('.').next().unwrap_or(method.slot)).collect();
    names.dedup();
    names
}

/// Whether a config traces rays.
pub fn needs_rays(config: &Config) -> bool {
    visibility::needs_rays(config) || gather::needs_rays(config) || sky::needs_rays(config) || config.direct.shadows == Shadows::RayTraced
}

/// Refuses configs that the device cannot run; errors name the key.
///
/// # Errors
/// `BadInput` for a limit, `NoDevice` for a missing feature.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    gbuffer::check(config, facts)?;
    rsm::check(config, facts)?;
    direct::check(config, facts)?;
    methods_of(config).iter().try_for_each(|method| method.check(facts.adapter))?;
    if facts.maps > 0 {
        vpls::check(config, facts)?;
    }
    bounce::check(config, facts)?;
    visibility::check(config, facts)?;
    gather::check(config, facts)?;
    sky::check(config, facts)
}

/// Warnings about a config in a scene under these lights.
pub fn warnings(config: &Config, scene: &Scene, lights: &[Light], vpls: u32) -> Vec<String> {
    [rsm::warnings(lights), bounce::warnings(config, vpls), gather::warnings(config, scene), sky::warnings(config)].concat()
}

/// Warnings about rendering a config's sequence in parts.
pub fn warnings_of_parts(config: &Config) -> Vec<String> {
    bounce::warning_of_parts(config).into_iter().collect()
}

/// Figures derived from a frame's counters, by name: means a pixel, and shares.
pub fn means(counts: &BTreeMap<String, u64>) -> BTreeMap<String, f64> {
    gather::means(counts)
}

/// Warnings about a frame, from its counters.
pub fn warnings_of_frame(counts: &[(String, u64)]) -> Vec<String> {
    [visibility::warnings_of_frame(counts), gather::warnings_of_frame(counts)].concat()
}
