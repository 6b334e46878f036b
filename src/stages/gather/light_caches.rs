//! The method `"light-caches"`: light of all VPLs, as virtual area lights (VALs), at sparse caches on the models, and from these on to the
//! pixels (Bischoff, Schwandt and Broll 2017).
//!
//! A cache's proxy light stands for all VALs: it is at their mean place, weighted by form factors, and has the flux that gives the cache its
//! irradiance. Glossy receivers have a second one, for the light that a cache reflects to the eye.
//!
//! A vertex has the mean of the proxies of its 16 nearest caches, weighted as in equation 8, by place relative to the vertex and by flux; over a
//! triangle both are linear, which is ours. So a pixel uses the neighbours of its triangle's three corners, and light is continuous from
//! triangle to triangle.

use super::super::interleave::Interleave;
use super::super::surroundings::Surroundings;
use super::super::vpls::Vpls;
use super::caches::FrameCaches;
use super::{Indirect, explain};
use crate::config::{
    Before, CacheOcclusion, Dielectric, LightCachesConfig, NeighbourWeights, OccluderSides, Occluders, ProxyBound, ProxyRadius,
    ProxyWeights, Receiver,
};
use crate::gpu::Format;
use crate::graph::{Buffer, Graph};
use crate::shader_struct;
use crate::stages::compose::MarksParams;
use crate::world::device::Maps;

shader_struct! {
    /// `glsl/lib/light-cache.glsl`.
    pub struct PlacedLightCache {
        pub position: [f32; 3],
        pub area: f32,
        pub normal: [f32; 3],
        pub exponent: f32,
        pub silhouette: f32,
        pub opacity: f32,
        pub one_of_two: u32,
    }

    /// `glsl/gather/cache-tile.glsl`.
    pub struct CacheTile {
        pub low: [f32; 3],
        pub high: [f32; 3],
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

    /// Of passes over caches.
    pub struct CountParams {
        pub count: u32,
    }

    /// `glsl/gather/cache-proxies.comp`.
    pub struct ProxiesParams {
        pub caches: u32,
        pub count: u32,
    }

    struct ViewerParams {
        count: u32,
        distance: f32,
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
        pub deviations: f32,
    }

    /// `glsl/gather/cache-vertices.comp`.
    pub struct VerticesParams {
        pub count: u32,
        pub off_plane: f32,
    }
}

/// VALs whose bits fit into a word.
const BITS: u32 = 32;

/// Workgroups along the first axis: every device has at least so many.
const ROW: u32 = 32_768;

fn rows(count: u32) -> [u32; 3] {
    [count.min(ROW), count.div_ceil(ROW), 1]
}

/// Caches that a workgroup gathers at, and shadows: a VAL, and another cache, is fetched once for all of them.
const GATHERED: u32 = 4;

/// Caches of a tile, which are skipped together.
pub const TILE: u32 = 64;

/// Proxy lights of a cache.
fn lights_of(receiver: Receiver) -> u32 {
    match receiver {
        Receiver::Diffuse => 1,
        Receiver::Ggx => 2,
    }
}

/// Bytes of the lights of a vertex: of both sides if there are two.
pub(super) fn bytes_of_vertex(two_sided: bool, config: &LightCachesConfig) -> u64 {
    size_of::<VertexLight>() as u64 * u64::from(lights_of(config.receiver)) * if two_sided { 2 } else { 1 }
}

/// The shaders' part that says how many lights a cache has.
fn lights_part(receiver: Receiver) -> &'static str {
    match receiver {
        Receiver::Diffuse => "gather/proxies-one",
        Receiver::Ggx => "gather/proxies-two",
    }
}

/// Light of the VPLs by the caches.
///
/// Counts `gather/dark-caches`, those that no light reaches; `gather/lone-vertices`, vertices none of whose caches has weight, so that the nearest
/// counts alone; and, with double projection, `gather/caches-within`, those in the sphere of their own proxy light.
pub(super) fn gathered(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, config: &LightCachesConfig) -> Indirect {
    let caches = around.residents.caches(g);
    let places = placed(g, around, &caches);
    let sight = (config.occlusion == CacheOcclusion::RayTraced).then(|| rays(g, around, places, vpls));
    let proxies = proxies(g, around, places, vpls, sight, config);
    let seen = match config.occlusion {
        CacheOcclusion::None | CacheOcclusion::RayTraced => None,
        CacheOcclusion::DoubleProjection => Some(occlusion(g, places, proxies, config)),
    };
    let sides = if caches.two_sided { 2 } else { 1 };
    if config.viewer {
        view(g, around, [places, proxies], seen, config);
    }
    let lights = vertices(g, around, &caches, [places, proxies], seen, sides, config);
    let light = pixels(g, around, &caches, lights, sides, config);
    Indirect { shares: explain::disk_lights(g, around, vpls), ..light }
}

/// Draws the caches as disks, and their diffuse proxy lights over the surfaces.
fn view(g: &mut Graph, around: Surroundings<'_>, [places, proxies]: [Buffer; 2], seen: Option<Buffer>, config: &LightCachesConfig) {
    let gbuffer = around.gbuffer;
    let [width, height] = gbuffer.size;
    let lights = lights_part(config.receiver);
    let marks = g.zeroed::<u32>("gather/proxy-marks", width * height);
    g.compute("gather/proxy-marks")
        .shader("compose/marks")
        .part("marked", "compose/marked-proxies")
        .part("proxies", lights)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("caches", places)
        .reads("proxies", proxies)
        .updates("marks", marks)
        .params(&MarksParams { count: places.count, radius: (height / 180).max(1) as i32 })
        .dispatch([places.count, 1, 1]);
    let tiles = g.again(2, |g| tiles(g, places));
    let [disks, spots] = ["gather/cache-disks", "gather/cache-lights"].map(|name| g.image(name, Format::Rgba8Unorm, gbuffer.size));
    let mut pass = g.compute("gather/cache-viewer").part("proxies", lights);
    if let Some(seen) = seen {
        pass = pass.part("reach", "gather/reach-share").reads("seen", seen);
    }
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("caches", places)
        .reads("tiles", tiles)
        .reads("proxies", proxies)
        .reads("marks", marks)
        .writes("disks", disks)
        .writes("lights", spots)
        .params(&ViewerParams { count: places.count, distance: config.distance })
        .dispatch([width, height, 1]);
}

/// Bounds of every [`TILE`] caches.
fn tiles(g: &mut Graph, caches: Buffer) -> Buffer {
    let count = caches.count.div_ceil(TILE);
    let tiles = g.buffer::<CacheTile>("gather/cache-tiles", count);
    g.compute("gather/cache-tiles")
        .reads("caches", caches)
        .writes("tiles", tiles)
        .params(&CountParams { count: caches.count })
        .dispatch_groups(rows(count));
    tiles
}

/// Light at the pixels: surfaces are drawn once more, with the lights of their vertices.
fn pixels(
    g: &mut Graph,
    around: Surroundings<'_>,
    caches: &FrameCaches,
    lights: Buffer,
    sides: u32,
    config: &LightCachesConfig,
) -> Indirect {
    let gbuffer = around.gbuffer;
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let depth = g.image("gather/depth", Format::Depth32, gbuffer.size);
    let glossy = config.receiver == Receiver::Ggx;
    let reflection = glossy.then(|| g.image("gather/reflection", Format::Rgba16Float, gbuffer.size));
    let lists =
        around.scene.draw_lists(g, "gather", Maps::Mask, 1, |bounds| around.view.sees(bounds).then(|| around.view.distance(bounds)));
    let pass = g
        .raster("gather/cache-light")
        .part("proxies", lights_part(config.receiver))
        .reads("view", gbuffer.view)
        .reads("draws", around.scene.draws)
        .reads("firsts", caches.firsts)
        .reads("vertex_lights", lights)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .constant("SIDES", sides)
        .color("irradiance", irradiance, [0.0, 0.0, 0.0, 1.0]);
    let pass = match reflection {
        None => pass,
        Some(reflection) => pass
            .part("mirror", "gather/mirror-lobes")
            .reads("albedo", gbuffer.albedo)
            .reads("metallic_roughness", gbuffer.metallic_roughness)
            .constant("GLOSSY_DIELECTRIC", around.wants.dielectric == Dielectric::Ggx)
            .color("reflection", reflection, [0.0, 0.0, 0.0, 1.0]),
    };
    pass.depth(depth).draw(lists);
    Indirect { irradiance, reflection, pattern: Interleave::of(1.into()), shares: None }
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
        .reads("materials", around.scene.materials)
        .writes("caches", places)
        .params(&CountParams { count })
        .dispatch([count, 1, 1]);
    places
}

/// Proxy lights of all caches (equations 3 to 6 and 13 to 15).
fn proxies(
    g: &mut Graph,
    around: Surroundings<'_>,
    caches: Buffer,
    vpls: &Vpls,
    sight: Option<Buffer>,
    config: &LightCachesConfig,
) -> Buffer {
    let lights = lights_of(config.receiver);
    let proxies = g.buffer::<ProxyLight>("gather/proxies", caches.count * lights);
    let dark = g.count("gather/dark-caches");
    let mut pass = g.compute("gather/cache-proxies").part("proxies", lights_part(config.receiver));
    pass = match vpls.disks {
        Some(disks) => pass.part("disk", "gather/disk-stored").reads("disks", disks),
        None => pass.reads("areas", vpls.areas),
    };
    if let Some(bits) = sight {
        pass = pass.part("sight", "gather/sight-bits").reads("bits", bits);
    }
    pass.reads("view", around.gbuffer.view)
        .reads("caches", caches)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .writes("proxies", proxies)
        .updates("dark", dark)
        .constant("BY_FLUX", config.proxy_weights == ProxyWeights::Flux)
        .constant("BOUNDED", config.proxy_bound == ProxyBound::Extent)
        .params(&ProxiesParams { caches: caches.count, count: vpls.count })
        .dispatch_groups(rows(caches.count.div_ceil(GATHERED)));
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

/// Share of each proxy's light that reaches its cache.
fn occlusion(g: &mut Graph, caches: Buffer, proxies: Buffer, config: &LightCachesConfig) -> Buffer {
    let double_projection = &config.double_projection;
    let count = caches.count;
    let tiles = tiles(g, caches);
    let seen = g.buffer::<f32>("gather/seen", proxies.count);
    let within = g.count("gather/caches-within");
    g.compute("gather/cache-occlusion")
        .part("proxies", lights_part(config.receiver))
        .reads("caches", caches)
        .reads("tiles", tiles)
        .reads("proxies", proxies)
        .writes("seen", seen)
        .updates("within", within)
        .constant("BEFORE_SPHERE", double_projection.before == Before::Sphere)
        .constant("FRONTS", double_projection.sides == OccluderSides::Front)
        .constant("SILHOUETTES", double_projection.occluders == Occluders::Silhouettes)
        .params(&OcclusionParams {
            count,
            // Without an extent a proxy's sphere has no size: half of the caches' own distance, d_eps / 2, stands in.
            least_radius: 0.25 * config.distance,
            deviations: match double_projection.radius {
                ProxyRadius::Sigma => 1.0,
                ProxyRadius::TwoSigma => 2.0,
            },
        })
        .dispatch_groups(rows(count.div_ceil(GATHERED)));
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
    let each = lights_of(config.receiver);
    let lights = g.buffer::<VertexLight>("gather/vertex-lights", count * sides * each);
    let alone = g.count("gather/lone-vertices");
    let mut pass = g.compute("gather/cache-vertices").part("proxies", lights_part(config.receiver));
    if let Some(seen) = seen {
        pass = pass.part("reach", "gather/reach-share").reads("seen", seen);
    }
    pass.reads("view", around.gbuffer.view)
        .reads("listed", caches.listed)
        .reads("lists", caches.lists)
        .reads("draws", around.scene.draws)
        .reads("vertices", around.scene.vertices)
        .reads("caches", places)
        .reads("proxies", proxies)
        .writes("vertex_lights", lights)
        .updates("alone", alone)
        .constant("BOUNDED", config.proxy_bound == ProxyBound::Extent)
        .constant("SIDES", sides)
        .constant("ON_PLANE", config.neighbour_weights == NeighbourWeights::TangentPlane)
        .params(&VerticesParams { count, off_plane: 0.5 * config.distance })
        .dispatch_groups(rows(count.div_ceil(64)));
    lights
}
