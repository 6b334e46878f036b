//! Visibility of VPLs from receivers.

mod adaptive;
mod areas;
mod density;
mod ism;
mod masks;
mod points;
mod poses;
mod pull_push;
mod ray_traced;
mod shared;
mod splat;
pub mod stored;
pub mod triangles;

pub use ism::{Ism, SkyFrame, of_directions, partition_capacity};
pub use ray_traced::BITS;
pub use shared::MOST_TEXELS_A_MAP;

use super::bounce::{Bounce, VplClusters};
use super::facts::Facts;
use super::methods::{Choice, Method, NOTHING, Needs};
use super::surroundings::Surroundings;
use super::vpls::Vpls;
use crate::config::{Collect, Config, IsmConfig, IsmRenderer, Lookup, PointSet, VisibilityConfig, VisibilityMethod};
use crate::fail;
use crate::gpu::Feature;
use crate::graph::{Buffer, Graph, Image, counted};
use anyhow::Result;

/// Visibility data that the gather tests VPLs with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Visibility {
    /// No shadows.
    None,
    /// Exact visibility: a bit a pixel and VPL of its sample set, 32 VPLs a word, one layer for each 32.
    Bits(Image),
    /// A small map for each VPL.
    Ism(Ism),
    /// A small map for several VPLs: `labels` gives each VPL's map, `proxies` the places that maps are seen from.
    SharedIsm { ism: Ism, labels: Buffer, proxies: Buffer },
    /// A map for each cluster of VPLs; the bias is in widths of a texel.
    Clusters { clusters: VplClusters, bias: f32, lookup: Lookup },
}

impl Choice for VisibilityMethod {
    const KEY: &'static str = "visibility.method";

    fn needs(self) -> Needs {
        match self {
            Self::None | Self::RayTraced | Self::ImperfectShadowMaps | Self::Clusters => NOTHING,
        }
    }
}

impl Choice for PointSet {
    const KEY: &'static str = "visibility.ism.points";

    fn needs(self) -> Needs {
        match self {
            Self::Uniform | Self::Adaptive => NOTHING,
        }
    }
}

impl Choice for Collect {
    const KEY: &'static str = "visibility.ism.collect";

    fn needs(self) -> Needs {
        match self {
            Self::Compute | Self::Stored => NOTHING,
            Self::Tessellation => &[&[Feature::TessellationShader, Feature::GeometryShader, Feature::VertexPipelineStores]],
        }
    }
}

impl Choice for IsmRenderer {
    const KEY: &'static str = "visibility.ism.renderer";

    fn needs(self) -> Needs {
        match self {
            Self::SinglePixel => NOTHING,
            Self::Splat => &[&[Feature::TessellationShader, Feature::GeometryShader, Feature::LargePoints]],
        }
    }
}

/// The renderer of imperfect shadow maps, with the features it needs. Splats of stored points need no tessellator.
pub fn renderer(ism: &IsmConfig) -> Method {
    match (ism.renderer, ism.collect) {
        (IsmRenderer::Splat, Collect::Stored) => Method::only(IsmRenderer::KEY, "splat", &[&[Feature::LargePoints]]),
        (renderer, _) => Method::of(renderer),
    }
}

/// Whether a config traces shadow rays to VPLs.
pub fn needs_rays(config: &Config) -> bool {
    config.visibility_methods().any(|method| method == VisibilityMethod::RayTraced)
}

/// Refuses configs that the methods cannot run on every driver, or on this device.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    if let Some(shared) = config.shared_maps() {
        let each = facts.texels / u64::from(shared.max(facts.maps).max(1));
        if each > MOST_TEXELS_A_MAP {
            return Err(fail!(
                BadInput,
                "visibility.ism.shared_maps: {shared} leave {each} texels to each, over the {MOST_TEXELS_A_MAP} that every driver takes; raise it"
            ));
        }
    }
    let most = u64::from(facts.adapter.limits.image_layers) * u64::from(BITS);
    for list in &facts.lists {
        if list.visibility == VisibilityMethod::RayTraced && list.each > most {
            return Err(fail!(
                BadInput,
                "gather.interleave: {} leaves {} VPLs to each pixel, over the {most} that \"ray-traced\" visibility keeps on {}; raise it or lower {}",
                config.gather.interleave,
                list.each,
                facts.adapter.name,
                list.key
            ));
        }
    }
    Ok(())
}

/// Share by which the number of points may miss what was asked for without a warning.
const MISSED: f64 = 0.25;

/// Warnings about a frame's maps, from its counters.
pub fn warnings_of_frame(counts: &[(String, u64)]) -> Vec<String> {
    let lost = |count| {
        format!(
            "visibility.ism.capacity: {count} points came to partitions that do not hold as many and were left out; raise it, or leave it to the program"
        )
    };
    let missed = |(made, asked): (u64, u64)| {
        let why = if made > asked { "every triangle has one at least" } else { "large triangles have theirs in steps" };
        format!(
            "visibility.ism.point_count: {asked} points were asked for, and there are {made}: {why}; visibility.ism.thin = true comes near, and collect = \"stored\" gives as many"
        )
    };
    let made = counted(counts, "visibility/made-points").zip(counted(counts, "visibility/asked-points"));
    let far = made.filter(|(made, asked)| made.abs_diff(*asked) as f64 > MISSED * *asked as f64);
    let dropped = counted(counts, "visibility/dropped-points").filter(|count| *count > 0);
    dropped.map(lost).chain(far.map(missed)).collect()
}

/// VPLs of each bounce with their visibility: by the config's method for the first bounce, by `bounce.visibility` for further ones.
pub fn render(g: &mut Graph, around: Surroundings<'_>, bounces: &[Bounce], config: &VisibilityConfig) -> Vec<(Vpls, Visibility)> {
    let of_bounce = |(bounce, number): (&Bounce, u32)| {
        let visibility = g.again(number, |g| match (around.wants.shared_maps, number) {
            (Some(maps), 1) => shared::render(g, around, &bounce.vpls, maps, config),
            _ => of_vpls(g, around, bounce, around.wants.visibility_of(number), config),
        });
        (bounce.vpls, visibility)
    };
    bounces.iter().zip(1..).map(of_bounce).collect()
}

fn of_vpls(g: &mut Graph, around: Surroundings<'_>, bounce: &Bounce, method: VisibilityMethod, config: &VisibilityConfig) -> Visibility {
    let vpls = &bounce.vpls;
    match (method, around.traced, bounce.clusters) {
        (VisibilityMethod::None, ..) => Visibility::None,
        (VisibilityMethod::RayTraced, Some(traced), _) => ray_traced::render(g, traced, around.gbuffer, vpls, around.wants.interleave),
        (VisibilityMethod::RayTraced, None, _) => unreachable!("the scene was brought without what rays need"),
        (VisibilityMethod::ImperfectShadowMaps, ..) => ism::render(g, around, vpls, config),
        (VisibilityMethod::Clusters, _, Some(clusters)) => Visibility::Clusters { clusters, bias: config.bias, lookup: config.lookup },
        (VisibilityMethod::Clusters, _, None) => unreachable!("clusters are made where they say what is seen"),
    }
}
