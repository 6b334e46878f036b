//! Features that the gather's methods need, configs that they refuse, and warnings about a frame.

use super::conservative::shell_bytes;
use super::shells::CONSERVATIVE;
use crate::config::{Config, Culling, GatherMethod, Rasterization, Reflection, StochasticCulling};
use crate::fail;
use crate::gpu::{Adapter, Feature};
use crate::graph::counted;
use crate::stages::facts::{Facts, planned_turns};
use crate::stages::methods::{Choice, Method, NOTHING, Needs};
use anyhow::Result;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// VPLs that a pixel can sum: `glsl/gather/per-pixel.glsl` takes at most two loop turns for four of them.
const MOST_VPLS_A_PIXEL: u64 = planned_turns(50_000) * 4 / 2;

/// Loop turns of an invocation of stochastic culling: one for each VPL of its pixel on each list, and less than one for culling.
pub const MOST_TURNS: u64 = planned_turns(60_000);

impl Choice for GatherMethod {
    const KEY: &'static str = "gather.method";

    fn needs(self) -> Needs {
        match self {
            Self::PerPixel | Self::Stochastic => &[&[Feature::SubgroupBallot]],
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

/// Methods of a config's gather.
pub fn methods(config: &Config) -> Vec<Method> {
    let gather = &config.gather;
    let culling = gather.stochastic_culling();
    let mut methods = vec![Method::of(gather.method), culling.map_or_else(|| Method::of(gather.per_pixel.culling), Method::of)];
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
        let pairs = u64::from(width) * u64::from(height) * each;
        if gather.stochastic.statistics && pairs > u64::from(u32::MAX) {
            return Err(fail!(
                BadInput,
                "gather.stochastic.statistics: pictures of {width}x{height} may have {pairs} pairs of pixels and VPLs, over the {} that are counted; raise gather.interleave or take a smaller picture",
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
        if each > MOST_VPLS_A_PIXEL {
            return Err(fail!(
                BadInput,
                "gather.interleave: {} leaves {each} VPLs to each pixel, over the {MOST_VPLS_A_PIXEL} that every driver sums; raise it or lower {key}",
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

/// Warnings about a frame's light lists, from its counters.
pub fn warnings_of_frame(counts: &[(String, u64)]) -> Vec<String> {
    let warning = |count| {
        format!(
            "gather.stochastic.culling: {count} nodes found no room in the clusters' light lists, and their light is missing; raise gather.stochastic.delta or gather.interleave"
        )
    };
    counted(counts, "gather/lost").filter(|count| *count > 0).map(warning).collect()
}
