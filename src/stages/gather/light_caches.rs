//! The method `"light-caches"`: light of all VPLs, as virtual area lights (VALs), at sparse caches on the models, and from these on to the
//! pixels (Bischoff, Schwandt and Broll 2017).
//!
//! A cache's proxy light stands for all VALs: it is at their mean place, weighted by form factors, and has the flux that gives the cache its
//! irradiance. A vertex has the mean of the proxies of its 16 nearest caches, weighted as in equation 8, by place relative to the vertex and by
//! flux; over a triangle both are linear, which is ours. So a pixel uses the neighbours of its triangle's three corners, and light is
//! continuous from triangle to triangle.

use super::super::interleave::Interleave;
use super::super::surroundings::Surroundings;
use super::super::vpls::Vpls;
use super::Indirect;
use super::caches::FrameCaches;
use crate::config::{CacheOcclusion, LightCachesConfig, ProxyBound, ProxyWeights};
use crate::gpu::Format;
use crate::graph::{Buffer, Graph};
use crate::shader_struct;
use crate::world::device::Maps;

shader_struct! {
    /// `glsl/lib/light-cache.glsl`.
    pub struct PlacedLightCache {
        pub position: [f32; 3],
        pub area: f32,
        pub normal: [f32; 3],
        pub one_of_two: u32,
    }

    /// `glsl/lib/light-cache.glsl`.
    pub struct ProxyLight {
        pub way: [f32; 3],
        pub extent: f32,
        pub irradiance: [f32; 3],
    }

    /// `glsl/gather/vertex-light.glsl`.
    pub struct VertexLight {
        pub way: [f32; 3],
        pub extent: f32,
        pub flux: [f32; 3],
        pub lit: f32,
    }

    /// Of passes over caches, and over vertices.
    pub struct CountParams {
        pub count: u32,
    }

    struct ProxiesParams {
        caches: u32,
        count: u32,
    }

    struct RaysParams {
        caches: u32,
        count: u32,
        off: f32,
    }

    /// `glsl/gather/cache-occlusion.comp`.
    pub struct OcclusionParams {
        pub count: u32,
        pub least_radius: f32,
    }
}

/// VALs whose bits fit into a word.
const BITS: u32 = 32;

/// Workgroups along the first axis: every device has at least so many.
const ROW: u32 = 32_768;

fn rows(count: u32) -> [u32; 3] {
    [count.min(ROW), count.div_ceil(ROW), 1]
}

/// Light of the VPLs by the caches. Counts `gather/alone`, vertices none of whose caches has weight: the nearest counts alone there.
pub(super) fn gathered(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, config: &LightCachesConfig) -> Indirect {
    let caches = around.residents.caches(g);
    let places = placed(g, around, &caches);
    let sight = (config.occlusion == CacheOcclusion::RayTraced).then(|| rays(g, around, places, vpls));
    let proxies = proxies(g, places, vpls, sight, config);
    let seen = match config.occlusion {
        CacheOcclusion::None | CacheOcclusion::RayTraced => None,
        CacheOcclusion::DoubleProjection => Some(occlusion(g, places, proxies, config)),
    };
    let sides = if caches.two_sided { 2 } else { 1 };
    let lights = vertices(g, around, &caches, [places, proxies], seen, sides, config);
    let gbuffer = around.gbuffer;
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let depth = g.image("gather/depth", Format::Depth32, gbuffer.size);
    let lists =
        around.scene.draw_lists(g, "gather", Maps::Mask, 1, |bounds| around.view.sees(bounds).then(|| around.view.distance(bounds)));
    g.raster("gather/cache-light")
        .reads("view", gbuffer.view)
        .reads("draws", around.scene.draws)
        .reads("firsts", caches.firsts)
        .reads("vertex_lights", lights)
        .reads("normal", gbuffer.normal)
        .constant("SIDES", sides)
        .color("irradiance", irradiance, [0.0, 0.0, 0.0, 1.0])
        .depth(depth)
        .draw(lists);
    Indirect { irradiance, reflection: None, pattern: Interleave::of(1.into()) }
}

/// Caches as they stand in the world.
fn placed(g: &mut Graph, around: Surroundings<'_>, caches: &FrameCaches) -> Buffer {
    let count = caches.placed.count;
    let places = g.buffer::<PlacedLightCache>("gather/caches", count);
    g.compute("gather/cache-places")
        .reads("model_caches", caches.model_caches)
        .reads("placed", caches.placed)
        .reads("draws", around.scene.draws)
        .reads("vertices", around.scene.vertices)
        .writes("caches", places)
        .params(&CountParams { count })
        .dispatch([count, 1, 1]);
    places
}

/// Proxy lights of all caches (equations 3 to 6, 13 and 14).
fn proxies(g: &mut Graph, caches: Buffer, vpls: &Vpls, sight: Option<Buffer>, config: &LightCachesConfig) -> Buffer {
    let proxies = g.buffer::<ProxyLight>("gather/proxies", caches.count);
    let mut pass = g.compute("gather/cache-proxies");
    if let Some(disks) = vpls.disks {
        pass = pass.part("disk", "gather/disk-stored").reads("disks", disks);
    }
    if let Some(bits) = sight {
        pass = pass.part("sight", "gather/sight-bits").reads("bits", bits);
    }
    pass.reads("caches", caches)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("areas", vpls.areas)
        .writes("proxies", proxies)
        .constant("BY_FLUX", config.proxy_weights == ProxyWeights::Flux)
        .params(&ProxiesParams { caches: caches.count, count: vpls.count })
        .dispatch_groups(rows(caches.count));
    proxies
}

/// Bits of the VALs that each cache sees, 32 a word.
fn rays(g: &mut Graph, around: Surroundings<'_>, caches: Buffer, vpls: &Vpls) -> Buffer {
    let Some(traced) = around.traced else { unreachable!("gather::needs_rays says who traces") };
    let words = vpls.count.div_ceil(BITS);
    let bits = g.buffer::<u32>("gather/cache-bits", caches.count * words);
    let [across, down, _] = rows(caches.count);
    g.compute("gather/cache-rays")
        .traces(traced)
        .reads("caches", caches)
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .writes("bits", bits)
        .params(&RaysParams { caches: caches.count, count: vpls.count, off: 2e-5 * around.scene.bounds().size().length() })
        .dispatch_groups([across, down, words.div_ceil(BITS)]);
    bits
}

/// Share of each cache's light that reaches it.
fn occlusion(g: &mut Graph, caches: Buffer, proxies: Buffer, config: &LightCachesConfig) -> Buffer {
    let seen = g.buffer::<f32>("gather/seen", caches.count);
    g.compute("gather/cache-occlusion")
        .reads("caches", caches)
        .reads("proxies", proxies)
        .writes("seen", seen)
        // Without an extent a proxy's sphere has no size: half of the caches' own distance, d_eps / 2, stands in.
        .params(&OcclusionParams { count: caches.count, least_radius: 0.25 * config.distance })
        .dispatch_groups(rows(caches.count));
    seen
}

/// Lights of all vertices (equations 7 to 9).
fn vertices(
    g: &mut Graph,
    around: Surroundings<'_>,
    caches: &FrameCaches,
    [places, proxies]: [Buffer; 2],
    seen: Option<Buffer>,
    sides: u32,
    config: &LightCachesConfig,
) -> Buffer {
    let count = caches.listed.count;
    let lights = g.buffer::<VertexLight>("gather/vertex-lights", count * sides);
    let alone = g.count("gather/alone");
    let mut pass = g.compute("gather/cache-vertices");
    if let Some(seen) = seen {
        pass = pass.part("reach", "gather/reach-share").reads("seen", seen);
    }
    pass.reads("listed", caches.listed)
        .reads("lists", caches.lists)
        .reads("draws", around.scene.draws)
        .reads("vertices", around.scene.vertices)
        .reads("caches", places)
        .reads("proxies", proxies)
        .writes("vertex_lights", lights)
        .updates("alone", alone)
        .constant("BOUNDED", config.proxy_bound == ProxyBound::Extent)
        .constant("SIDES", sides)
        .params(&CountParams { count })
        .dispatch_groups(rows(count.div_ceil(64)));
    lights
}
