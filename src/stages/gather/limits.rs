//! Features that the gather's methods need, configs that they refuse, and warnings about a frame.

use super::conservative::shell_bytes;
use super::shells::CONSERVATIVE;
use crate::config::{CacheOcclusion, Config, Culling, GatherMethod, Rasterization, Reflection, StochasticCulling};
use crate::fail;
use crate::gpu::{Adapter, Feature};
use crate::graph::counted;
use crate::scene::Scene;
use crate::scene::caches::LightCaches;
use crate::stages::facts::{Facts, planned_turns};
use crate::stages::methods::{Choice, Method, NOTHING, Needs};
use anyhow::Result;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// VPLs that a pixel can sum. A subgroup has 4 lanes at least where loop turns are counted, and a loop's end counts as a turn. So four VPLs
/// take three turns without culling, which is unrolled by four, and four in tiles, by two.
///
/// With clustered culling a subgroup goes through the light lists of all froxels that its pixels are in, at worst one for each of its 4 pixels a
/// lane: four VPLs take four turns 16 times, or eight six turns 32 times.
///
/// Counting takes a turn more for each VPL.
const fn most_vpls_a_pixel(culling: Culling, counts: bool) -> u64 {
    let counting = if counts { 1 } else { 0 };
    match culling {
        Culling::None => planned_turns(60_000) * 4 / (3 + 4 * counting),
        Culling::Tiled => planned_turns(60_000) / (1 + counting),
        Culling::Clustered => planned_turns(60_000) / (24 + counting),
    }
}

/// VALs that a cache gathers: a turn takes 128 of them.
const MOST_VALS: u64 = planned_turns(60_000) * 128;

/// Light caches of a scene. A tile of 64, which takes four turns, is at worst before all others.
pub(super) const MOST_CACHES: u64 = planned_turns(60_000) * 64 / 4;

/// Loop turns of an invocation of stochastic culling: one for each VPL of its pixel on each list, and less than one for culling.
pub const MOST_TURNS: u64 = planned_turns(60_000);

impl Choice for GatherMethod {
    const KEY: &'static str = "gather.method";

    fn needs(self) -> Needs {
        match self {
            Self::PerPixel | Self::Stochastic => &[&[Feature::SubgroupBallot]],
            Self::LightCaches => &[&[Feature::MultiDrawIndirect, Feature::ShaderDrawParameters]],
        }
    }
}

impl Choice for CacheOcclusion {
    const KEY: &'static str = "gather.light_caches.occlusion";

    fn needs(self) -> Needs {
        match self {
            Self::None | Self::DoubleProjection | Self::RayTraced => NOTHING,
        }
    }
}

impl Choice for Culling {
    const KEY: &'static str = "gather.per_pixel.culling";

    fn needs(self) -> Needs {
        match self {
            Self::None | Self::Tiled | Self::Clustered => NOTHING,
        }
    }
}

impl Choice for StochasticCulling {
    const KEY: &'static str = "gather.stochastic.culling";

    fn needs(self) -> Needs {
        use Feature::{BlendedRgba32Float, ClipDistance, FragmentStores, MultiDrawIndirect};
        match self {
            Self::Tiled => NOTHING,
            Self::Splatting => &[&[MultiDrawIndirect, ClipDistance, BlendedRgba32Float]],
            Self::ConservativeClusters => &[&[MultiDrawIndirect, FragmentStores]],
        }
    }
}

impl Choice for Rasterization {
    const KEY: &'static str = "gather.conservative_clusters.rasterization";

    fn needs(self) -> Needs {
        match self {
            Self::Automatic => &[&[Feature::GeometryShader], CONSERVATIVE],
            Self::GeometryShader => &[&[Feature::GeometryShader]],
            Self::Extension => &[CONSERVATIVE],
        }
    }
}

/// Whether a config's gather traces rays.
pub fn needs_rays(config: &Config) -> bool {
    config.gather.method == GatherMethod::LightCaches && config.gather.light_caches.occlusion == CacheOcclusion::RayTraced
}

/// Methods of a config's gather.
pub fn methods(config: &Config) -> Vec<Method> {
    let gather = &config.gather;
    let culling = gather.stochastic_culling();
    let mut methods = vec![Method::of(gather.method)];
    match gather.method {
        GatherMethod::PerPixel => methods.push(Method::of(gather.per_pixel.culling)),
        GatherMethod::Stochastic => methods.extend(culling.map(Method::of)),
        GatherMethod::LightCaches => methods.push(Method::of(gather.light_caches.occlusion)),
    }
    if culling == Some(StochasticCulling::ConservativeClusters) {
        methods.push(Method::of(gather.conservative_clusters.rasterization));
    }
    methods
}

/// Refuses configs that the methods cannot run on every driver, or on this device.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    let gather = &config.gather;
    let [width, height] = config.frame.size;
    let lists = if config.vpls.reflection == Reflection::Both { 2 } else { 1 };
    for list in &facts.lists {
        let (each, key) = (list.each, list.key);
        if gather.method == GatherMethod::Stochastic && each > MOST_TURNS / (lists + 1) {
            return Err(fail!(
                BadInput,
                "gather.interleave: {} leaves {each} VPLs to each pixel, over the {} that every driver culls by chance; raise it or lower {key}",
                gather.interleave,
                MOST_TURNS / (lists + 1)
            ));
        }
        if gather.method == GatherMethod::LightCaches && u64::from(list.count) > MOST_VALS {
            return Err(fail!(
                BadInput,
                "gather.method: {} VPLs are over the {MOST_VALS} that every driver gathers at light caches; lower {key}",
                list.count
            ));
        }
        let pairs = u64::from(width) * u64::from(height) * each;
        let counts = match gather.method {
            GatherMethod::PerPixel => gather.per_pixel.statistics.then_some("gather.per_pixel.statistics"),
            GatherMethod::Stochastic => gather.stochastic.statistics.then_some("gather.stochastic.statistics"),
            GatherMethod::LightCaches => None,
        };
        if let Some(key) = counts.filter(|_| pairs > u64::from(u32::MAX)) {
            return Err(fail!(
                BadInput,
                "{key}: pictures of {width}x{height} may have {pairs} pairs of pixels and VPLs, over the {} that are counted; raise gather.interleave or take a smaller picture",
                u32::MAX
            ));
        }
        let limit = facts.adapter.limits.storage_buffer_bytes;
        let bytes = shell_bytes(config.frame.size, facts.interleave, list.count);
        if gather.stochastic_culling() == Some(StochasticCulling::ConservativeClusters) && bytes > limit {
            return Err(fail!(
                BadInput,
                "gather.stochastic.culling: \"conservative-clusters\" needs {} MB for {} VPLs in pictures of {width}x{height}, over the {} MB that {} allows a buffer; raise gather.interleave",
                bytes >> 20,
                list.count,
                limit >> 20,
                facts.adapter.name
            ));
        }
        let most = most_vpls_a_pixel(gather.per_pixel.culling, gather.per_pixel.statistics);
        if gather.method == GatherMethod::PerPixel && each > most {
            return Err(fail!(
                BadInput,
                "gather.interleave: {} leaves {each} VPLs to each pixel, over the {most} that every driver sums with this gather.per_pixel.culling; raise it or lower {key}",
                gather.interleave
            ));
        }
    }
    Ok(())
}

/// Choices that the config leaves to the program, by key, resolved for a device.
pub fn choices(config: &Config, adapter: &Adapter) -> BTreeMap<&'static str, Value> {
    let mut choices = BTreeMap::new();
    let rasterization = config.gather.conservative_clusters.rasterization;
    let is_used = config.gather.stochastic_culling() == Some(StochasticCulling::ConservativeClusters);
    if is_used && rasterization == Rasterization::Automatic {
        let resolved = rasterization.resolved(adapter.missing(CONSERVATIVE).is_empty());
        choices.insert(Rasterization::KEY, json!(resolved));
    }
    choices
}

/// Shortest part of a scene's diagonal that `scene.split` takes.
const LEAST_SPLIT: f32 = 0.001;

/// Number of caches from which on a warning says that they take long.
const MANY_CACHES: f64 = 40_000.0;

/// Parts of a scene's diagonal: the distance of caches from which on a warning says that they are large, and the one that it advises.
const LARGE_CACHE: [f32; 2] = [0.1, 0.04];

/// Warnings about a scene that a config's light caches are too many or too large for.
pub fn warnings(config: &Config, scene: &Scene) -> Vec<String> {
    if config.gather.method != GatherMethod::LightCaches {
        return Vec::new();
    }
    let (distance, diagonal) = (config.gather.light_caches.distance, scene.bounds().size().length());
    let about = LightCaches::about(scene, distance);
    let many = (about > MANY_CACHES).then(|| {
        let less = f64::from(distance) * (about / (0.5 * MANY_CACHES)).sqrt();
        format!(
            "gather.light_caches.distance: {distance} m makes about {about:.0} caches of {}, and the time of their shadows grows with their square; take {less:.2} for about {:.0}",
            scene.name,
            0.5 * MANY_CACHES
        )
    });
    let [large, fine] = LARGE_CACHE.map(|part| part * diagonal);
    let large = (distance > large).then(|| {
        format!("gather.light_caches.distance: {distance} m is large for {}, which is {diagonal:.1} m across: one cache stands for a room of it; take {fine:.2} or less", scene.name)
    });
    many.into_iter().chain(large).chain(warning_of_edges(distance, scene.longest_edge(), diagonal)).collect()
}

/// Warning about a scene whose triangles are too large for its light caches: vertices alone know caches.
fn warning_of_edges(distance: f32, longest: f32, diagonal: f32) -> Option<String> {
    if longest <= 1.01 * distance {
        return None;
    }
    let split = (distance / diagonal / LEAST_SPLIT).floor() * LEAST_SPLIT;
    let advice = if split < LEAST_SPLIT { "raise it".to_owned() } else { format!("take scene.split = {split:.3}") };
    Some(format!(
        "gather.light_caches.distance: edges of triangles are {longest:.2} m long, over the {distance} m around a cache, and light between their vertices is missed; {advice}"
    ))
}

/// Warnings about a frame's light lists, from its counters.
pub fn warnings_of_frame(counts: &[(String, u64)]) -> Vec<String> {
    let warning = |count| {
        format!(
            "gather.stochastic.culling: {count} nodes found no room in the clusters' light lists, and their light is missing; raise gather.stochastic.delta or gather.interleave"
        )
    };
    counted(counts, "gather/lost").filter(|count| *count > 0).map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn caches_that_are_too_many_or_too_large_for_a_scene_are_warned_of() {
        let scene = builtin::cornell();
        let mut config = Config::default();
        config.gather.method = GatherMethod::LightCaches;
        let size = scene.bounds().size().length();
        let mut warned = |part: f32| {
            config.gather.light_caches.distance = part * size;
            warnings(&config, &scene)
        };
        let said = |warnings: &[String], what: &str| warnings.iter().filter(|warning| warning.contains(what)).count();
        let [many, fine, large] = [0.002, 0.05, 0.2].map(&mut warned);
        assert_eq!([&many, &fine, &large].map(|all| said(all, " caches of ")), [1, 0, 0], "{many:?} {fine:?} {large:?}");
        assert_eq!([&many, &fine, &large].map(|all| said(all, "is large for")), [0, 0, 1], "{many:?} {fine:?} {large:?}");
        assert!(many[0].ends_with(" for about 20000"), "{}", many[0]);
    }
}
