//! Light caches: what caches gather, what hides it from them, and what pixels make of it.

use crate::common::*;
use crate::make::Make;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use manylight::cache::Cache;
use manylight::config::{
    CacheOcclusion, Config, GatherMethod, Importance, LightConfig, NeighbourWeights, Numbers, OccluderSides, ProxyBound, ProxyWeights,
    Receiver, VplSampler,
};
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::renderer::Renderer;
use manylight::scene::caches::{LightCaches, NONE, Spacing};
use manylight::scene::{Material, Vertex, pack};
use manylight::stages::gather::caches::ListedVertex;
use manylight::stages::gather::light_caches::{PlacedLightCache, ProxiesParams, ProxyLight, VertexLight, VerticesParams};
use manylight::stages::vpls::VplPlace;
use manylight::world::device::DrawData;
use manylight::world::projection::View;
use serde_json::json;
use std::f64::consts::PI;

/// A room that a spot light shines into, with caches as close as its pixels need.
fn lit_room() -> (Renderer, Config) {
    let albedos = [[0.8, 0.2, 0.2], [0.2, 0.8, 0.2], [0.7; 3], [0.7; 3], [0.3, 0.3, 0.9], [0.5; 3]].map(DVec3::from);
    let mut scene = room(&walls(DVec3::new(4.0, 3.0, 5.0), albedos));
    scene.split_triangles(0.05);
    let light = spot(Vec3::new(2.0, 2.0, 2.5), Vec3::new(0.3, -1.0, -0.4), [20.0; 3], 20.0, 50.0);
    let mut config = plain([64, 48], Vec3::new(2.0, 1.5, 4.5), Vec3::new(2.0, 1.2, 0.0), 70.0, light);
    config.rsm.size = [64, 64];
    config.vpls.count = 1000;
    config.gather.method = GatherMethod::LightCaches;
    config.gather.light_caches.distance = 0.5;
    config.gather.light_caches.occlusion = CacheOcclusion::None;
    (renderer(scene), config)
}

const PASSES: [&str; 3] = ["gather/cache-places", "gather/cache-proxies", "gather/cache-vertices"];

#[test]
fn every_cache_has_the_irradiance_of_all_area_lights() {
    let (mut renderer, mut config) = lit_room();
    for (sampler, importance, count, weights) in [
        (VplSampler::Regular, Importance::None, 1, ProxyWeights::FormFactor),
        (VplSampler::Regular, Importance::None, 1000, ProxyWeights::FormFactor),
        (VplSampler::Hammersley, Importance::PassedFlux, 777, ProxyWeights::FormFactor),
        (VplSampler::InverseTransform, Importance::View, 1000, ProxyWeights::FormFactor),
        (VplSampler::InverseTransform, Importance::View, 1000, ProxyWeights::Flux),
        (VplSampler::MetropolisHastings, Importance::View, 300, ProxyWeights::FormFactor),
        (VplSampler::EveryTexel, Importance::None, 1000, ProxyWeights::FormFactor),
    ] {
        config.gather.light_caches.proxy_weights = weights;
        config.vpls.sampler = sampler;
        config.vpls.importance = importance;
        config.vpls.count = count;
        let sampling = ["vpls/regular", "vpls/important", "vpls/inverse-transform", "vpls/metropolis-hastings", "vpls/every-texel"];
        let (names, _) = renderer.names(&config).unwrap();
        let passes: Vec<&str> = PASSES.into_iter().chain(sampling.into_iter().filter(|name| names.contains(name))).collect();
        let rendered = dump(&mut renderer, &config, 0, &passes);
        let caches: Vec<PlacedLightCache> = pod(&rendered, "gather/caches");
        let proxies: Vec<ProxyLight> = pod(&rendered, "gather/proxies");
        let places: Vec<VplPlace> = pod(&rendered, "vpls/places");
        let intensities: Vec<[f32; 3]> = pod(&rendered, "vpls/intensities");
        let areas: Vec<f32> = pod(&rendered, "vpls/areas");
        let disks: Vec<[f32; 2]> = pod(&rendered, "vpls/disks");
        let mut lit = 0;
        for (cache, proxy) in caches.iter().zip(&proxies) {
            let at = Vec3::from(cache.position).as_dvec3();
            let normal = Vec3::from(cache.normal).as_dvec3();
            let (mut irradiance, mut sum, mut way) = (DVec3::ZERO, 0.0, DVec3::ZERO);
            for i in (0..places.len()).filter(|i| areas[*i] > 0.0) {
                let d = Vec3::from(places[i].position).as_dvec3() - at;
                let facing = pack::octahedral_snorm16_inverse(places[i].normal).as_dvec3();
                let cosines = d.dot(normal).max(0.0) * (-d.dot(facing)).max(0.0) / d.length_squared();
                let form = cosines / (f64::from(disks[i][0]) + PI * d.length_squared());
                irradiance += PI * form * Vec3::from(intensities[i]).as_dvec3();
                let luminance = Vec3::from(intensities[i]).dot(Vec3::new(0.2126, 0.7152, 0.0722));
                let weight = f64::from(if weights == ProxyWeights::Flux { luminance } else { disks[i][1] }) * form;
                sum += weight;
                way += weight * d;
            }
            let found = Vec3::from(proxy.irradiance).as_dvec3();
            assert!((found - irradiance).length() <= 1e-4 * irradiance.length(), "{sampler:?}, {count}: {found} instead of {irradiance}");
            if sum > 0.0 {
                lit += 1;
                let found = Vec3::from(proxy.way).as_dvec3();
                assert!((found - way / sum).length() < 1e-3, "{sampler:?}, {count}: the proxy is at {found}, not {}", way / sum);
                assert!(found.dot(normal) > 0.0, "{sampler:?}, {count}: a proxy is behind its cache");
                // A variance is a difference of squares.
                assert!(count > 1 || proxy.extent < 1e-3 * found.length() as f32, "a single light has the extent {}", proxy.extent);
            }
        }
        assert!(lit > caches.len() / 4, "{sampler:?}, {count}: {lit} of {} caches are lit", caches.len());
    }
    finish(renderer.gpu());
}

#[test]
fn pixels_have_the_light_of_all_vpls_where_nothing_hides_it() {
    let (mut renderer, mut config) = lit_room();
    config.vpls.sampler = VplSampler::EveryTexel;
    let mut means = |method: GatherMethod, bound: ProxyBound| {
        config.gather.method = method;
        config.gather.light_caches.proxy_bound = bound;
        let irradiance = irradiance(&mut renderer, &config);
        irradiance.iter().map(|light| light.as_dvec3()).sum::<DVec3>() / irradiance.len() as f64
    };
    let all = means(GatherMethod::PerPixel, ProxyBound::Extent);
    for (bound, bar) in [(ProxyBound::Extent, 0.005), (ProxyBound::None, 0.02)] {
        let ratio = means(GatherMethod::LightCaches, bound) / all;
        println!("{bound:?}: {ratio}");
        assert!((ratio - 1.0).abs().max_element() < bar, "{bound:?}: {ratio} of the light of all VPLs");
    }
    finish(renderer.gpu());
}

#[test]
fn caches_are_counted_that_are_dark_or_in_the_sphere_of_their_light() {
    let (mut renderer, mut config) = lit_room();
    config.gather.light_caches.occlusion = CacheOcclusion::DoubleProjection;
    // Light on the floor and its walls, some of whose caches lie in it, and on the floor alone, which has none of its own.
    for (light, some_dark, some_within) in
        [(config.light[0].clone(), false, true), (spot(Vec3::new(2.0, 2.0, 2.5), Vec3::NEG_Y, [20.0; 3], 5.0, 20.0), true, false)]
    {
        config.light = vec![light];
        let rendered = dump(&mut renderer, &config, 0, &["gather/cache-proxies"]);
        let proxies: Vec<ProxyLight> = pod(&rendered, "gather/proxies");
        let is_dark = |proxy: &&ProxyLight| proxy.irradiance == [0.0; 3];
        let is_within = |proxy: &&ProxyLight| Vec3::from(proxy.way).length() < proxy.extent.max(0.25 * config.gather.light_caches.distance);
        let dark = proxies.iter().filter(is_dark).count();
        let within = proxies.iter().filter(|proxy| !is_dark(proxy) && is_within(proxy)).count();
        println!("{dark} of {} caches are dark, {within} in their light", proxies.len());
        assert!((dark > 0) == some_dark && (within > 0) == some_within, "{dark} caches are dark, {within} in their light");
        assert_eq!((count(&rendered, "gather/dark-caches"), count(&rendered, "gather/caches-within")), (dark as u64, within as u64));
        assert_eq!(count(&rendered, "gather/lone-vertices"), 0, "every vertex of a room has caches around it");
    }
    finish(renderer.gpu());
}

#[test]
fn the_viewer_shows_every_cache_around_and_lights_over_the_surfaces() {
    let (mut renderer, mut config) = lit_room();
    config.gather.light_caches.viewer = true;
    let rendered = dump(&mut renderer, &config, 0, &["gather/cache-viewer"]);
    let colors = |name: &str| words(dumped(&rendered, name)).collect::<std::collections::BTreeSet<u32>>().len();
    let (disks, lights) = (colors("gather/cache-disks"), colors("gather/cache-lights"));
    println!("{disks} and {lights} colours");
    assert!(disks > 50 && lights > 50, "disks have {disks} colours, and lights {lights}");
    finish(renderer.gpu());
}

/// A cache that faces up, and its proxy light.
#[derive(Clone, Copy)]
struct Lit {
    position: Vec3,
    way: Vec3,
    extent: f32,
    irradiance: f32,
}

/// Irradiance of a vertex at the origin, which faces up, from caches around it.
fn light_of_vertex(caches: &[Lit], bounded: bool) -> f64 {
    light_by(caches, bounded, NeighbourWeights::Distance)
}

/// The same with a choice of weights: half a metre off a cache's tangent plane is the end of it.
fn light_by(caches: &[Lit], bounded: bool, weights: NeighbourWeights) -> f64 {
    let mut engine = Engine::new(gpu(), Library::new().unwrap());
    let mut g = Graph::new();
    let up = pack::octahedral_snorm16(Vec3::Y);
    let list: [u32; 16] = std::array::from_fn(|i| if i < caches.len() { i as u32 } else { NONE });
    let transform = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let place = |cache: &Lit| PlacedLightCache {
        position: cache.position.into(),
        area: 1.0,
        normal: [0.0, 1.0, 0.0],
        exponent: 0.0,
        silhouette: 1.0,
        opacity: 1.0,
        one_of_two: 0,
    };
    let proxy = |cache: &Lit| ProxyLight { way: cache.way.into(), extent: cache.extent, irradiance: [cache.irradiance; 3] };
    let buffers = [
        ("view", g.upload("test/view", &[View::zeroed()])),
        ("listed", g.upload("test/listed", &[ListedVertex { vertex: 0, list: 0, draw: 0, first_cache: 0, sides: 1 }])),
        ("lists", g.upload("test/lists", &list)),
        ("draws", g.upload("test/draws", &[DrawData { transform, material: 0, double_sided: 0 }])),
        ("vertices", g.upload("test/vertices", &[Vertex { position: [0.0; 3], normal: up, uv: [0.0; 2], color: 0, tangent: 0 }])),
        ("caches", g.upload("test/caches", &caches.iter().map(place).collect::<Vec<_>>())),
        ("proxies", g.upload("test/proxies", &caches.iter().map(proxy).collect::<Vec<_>>())),
    ];
    let lights = g.buffer::<VertexLight>("test/lights", 1);
    let alone = g.count("test/alone");
    let mut pass = g.compute("gather/cache-vertices").writes("vertex_lights", lights).updates("alone", alone);
    for (binding, buffer) in buffers {
        pass = pass.reads(binding, buffer);
    }
    pass.constant("BOUNDED", bounded)
        .constant("SIDES", 1u32)
        .constant("ON_PLANE", weights == NeighbourWeights::TangentPlane)
        .params(&VerticesParams { count: 1, off_plane: 0.5 })
        .dispatch_groups([1, 1, 1]);
    let read = g.read_back(lights);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let light: VertexLight = bytemuck::pod_read_unaligned(outcome.bytes(read));
    finish(&engine.gpu);
    let lit = f64::from(light.lit).max(1e-20);
    let (way, extent) = (Vec3::from(light.way).as_dvec3() / lit, f64::from(light.extent) / lit);
    let squared = way.length_squared() + extent * extent;
    f64::from(light.flux[0]) * proxy_cosine(DVec3::Y, way, extent) / (4.0 * PI * squared).max(1e-20)
}

/// Mean of the clamped cosines to a proxy's places, in 64 bits: cosines are evenly spread about that to its middle.
fn proxy_cosine(normal: DVec3, way: DVec3, extent: f64) -> f64 {
    let cosine = normal.dot(way) / way.length().max(1e-30);
    let width = extent / way.length().hypot(extent).max(1e-30);
    if cosine >= width { cosine } else { (cosine + width).max(0.0).powi(2) / (4.0 * width).max(1e-30) }
}

#[test]
fn a_vertex_at_a_cache_has_the_caches_irradiance() {
    let far = Lit { position: Vec3::new(0.0, 0.0, 100.0), way: Vec3::Y, extent: 0.0, irradiance: 0.0 };
    for [x, y, z, extent] in random_numbers(24) {
        let way = Vec3::new(8.0 * x - 4.0, 0.02 + 3.0 * y, 8.0 * z - 4.0);
        for (extent, bounded) in [(2.0 * extent, true), (2.0 * extent, false), (0.0, true)] {
            let found = light_of_vertex(&[Lit { position: Vec3::ZERO, way, extent, irradiance: 3.0 }, far], bounded);
            // Without the bound the vertex's light has no extent either.
            assert!((found / 3.0 - 1.0).abs() < 1e-4, "{found} instead of 3 by a light at {way} of {extent} m, {bounded}");
        }
    }
}

#[test]
fn vertices_have_the_mean_of_equal_caches_and_dark_ones_take_their_share() {
    let at = |position: Vec3, irradiance: f32| Lit { position, way: Vec3::new(0.0, 1000.0, 0.0) - position, extent: 0.0, irradiance };
    // A farther cache has no weight, and gives the others theirs.
    let far = at(Vec3::new(0.0, 0.0, 100.0), 1.0);
    for (lit, dark) in [(1, 0), (4, 0), (1, 1), (3, 1), (1, 3), (1, 9)] {
        let mut caches: Vec<_> = (0..lit).map(|_| at(Vec3::X, 2.0)).collect();
        caches.extend((0..dark).map(|_| Lit { way: Vec3::ZERO, ..at(Vec3::NEG_X, 0.0) }));
        caches.push(far);
        let (found, expected) = (light_of_vertex(&caches, true), 2.0 * f64::from(lit) / f64::from(lit + dark));
        assert!((found / expected - 1.0).abs() < 1e-3, "{lit} lit and {dark} dark caches give {found} instead of {expected}");
    }
    let dark = Lit { way: Vec3::ZERO, ..at(Vec3::X, 0.0) };
    assert_eq!(light_of_vertex(&[dark, far], true), 0.0, "a vertex whose caches are all dark");
}

#[test]
fn by_the_tangent_plane_caches_of_another_floor_have_no_weight() {
    let at = |position: Vec3, irradiance: f32| Lit { position, way: Vec3::new(0.0, 1000.0, 0.0) - position, extent: 0.0, irradiance };
    // One of the same floor, one of a floor above, a step halfway between, and one far off.
    let (same, above, step, far) =
        (at(Vec3::X, 2.0), at(Vec3::Y, 10.0), at(Vec3::new(0.0, 0.25, 0.75), 4.0), at(Vec3::new(0.0, 0.0, 100.0), 1.0));
    let by = |caches: &[Lit], weights| light_by(caches, true, weights);
    let mean = by(&[same, above, far], NeighbourWeights::Distance);
    assert!((mean / 6.0 - 1.0).abs() < 1e-2, "{mean} instead of the mean of both floors");
    let own = by(&[same, above, far], NeighbourWeights::TangentPlane);
    assert!((own / 2.0 - 1.0).abs() < 1e-3, "{own} instead of 2 of the own floor");
    // The step counts half.
    let stepped = by(&[same, step, far], NeighbourWeights::TangentPlane);
    assert!((stepped / (8.0 / 3.0) - 1.0).abs() < 1e-2, "{stepped} instead of 8/3");
}

/// Irradiance at caches from VALs of an area, alone.
fn gathered(caches: &[(Vec3, Vec3)], vals: &[(Vec3, Vec3, f32)]) -> Vec<f64> {
    let mut engine = Engine::new(gpu(), Library::new().unwrap());
    let mut g = Graph::new();
    let place = |(position, normal): &(Vec3, Vec3)| PlacedLightCache {
        position: (*position).into(),
        area: 1.0,
        normal: (*normal).into(),
        exponent: 0.0,
        silhouette: 1.0,
        opacity: 1.0,
        one_of_two: 0,
    };
    let val =
        |(position, facing, _): &(Vec3, Vec3, f32)| VplPlace { position: (*position).into(), normal: pack::octahedral_snorm16(*facing) };
    let count = caches.len() as u32;
    let places = g.upload("test/caches", &caches.iter().map(place).collect::<Vec<_>>());
    let proxies = g.buffer::<ProxyLight>("test/proxies", count);
    let dark = g.count("test/dark");
    let view = g.upload("test/view", &[View::zeroed()]);
    let vpls = g.upload("test/vpls", &vals.iter().map(val).collect::<Vec<_>>());
    let intensities = g.upload("test/intensities", &vec![[1.0f32; 3]; vals.len()]);
    let areas = g.upload("test/areas", &vals.iter().map(|(.., area)| *area).collect::<Vec<_>>());
    g.compute("gather/cache-proxies")
        .reads("view", view)
        .reads("caches", places)
        .reads("places", vpls)
        .reads("intensities", intensities)
        .reads("areas", areas)
        .writes("proxies", proxies)
        .updates("dark", dark)
        .constant("BY_FLUX", false)
        .constant("BOUNDED", true)
        .params(&ProxiesParams { caches: count, count: vals.len() as u32 })
        .dispatch_groups([count.div_ceil(4), 1, 1]);
    let read = g.read_back(proxies);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let found = bytemuck::pod_collect_to_vec::<u8, ProxyLight>(outcome.bytes(read));
    finish(&engine.gpu);
    found.iter().map(|proxy| f64::from(proxy.irradiance[0])).collect()
}

/// Irradiance at a place from a disk whose points have the radiant intensity 1 W/sr in all, summed over its parts.
fn of_disk((at, normal): (Vec3, Vec3), (centre, facing, area): (Vec3, Vec3, f32)) -> f64 {
    let (at, normal, centre, facing) = (at.as_dvec3(), normal.as_dvec3(), centre.as_dvec3(), facing.as_dvec3());
    let (across, radius) = (facing.any_orthonormal_pair(), (f64::from(area) / PI).sqrt());
    let (rings, parts) = (64, 128);
    let mut sum = 0.0;
    for ring in 0..rings {
        for part in 0..parts {
            let (r, angle) = (radius * ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt(), 2.0 * PI * f64::from(part) / f64::from(parts));
            let way = centre + r * (angle.cos() * across.0 + angle.sin() * across.1) - at;
            sum += way.dot(normal).max(0.0) * (-way.dot(facing)).max(0.0) / way.length_squared().powi(2);
        }
    }
    sum / f64::from(rings * parts)
}

#[test]
fn the_disk_of_a_light_is_exact_to_three_percent_from_ten_radii_on() {
    let vals = [(Vec3::new(0.3, 10.0, -0.2), Vec3::new(0.1, -1.0, 0.2).normalize(), PI as f32)];
    let caches: Vec<(Vec3, Vec3)> = random_numbers(64)
        .into_iter()
        .map(|[u, v, w, d]| {
            let turned = |u: f32, v: f32| {
                let (z, angle) = (2.0 * u - 1.0, v * 2.0 * PI as f32);
                Vec3::new(angle.cos() * (1.0 - z * z).sqrt(), z, angle.sin() * (1.0 - z * z).sqrt())
            };
            let way = turned(0.2 * u, v);
            (vals[0].0 + (10.0 + 20.0 * d) * way, (turned(w, u) - way).normalize_or(-way))
        })
        .collect();
    let found = gathered(&caches, &vals);
    let mut lit = 0;
    for (cache, found) in caches.iter().zip(found) {
        let exact = of_disk(*cache, vals[0]);
        // A disk that stands across the horizon is cut, which the formula does not know.
        let way = vals[0].0 - cache.0;
        if way.dot(cache.1) > 1.5 && -way.dot(vals[0].1) > 1.5 {
            lit += 1;
            assert!((found / exact - 1.0).abs() < 0.03, "{found} instead of {exact} at {} m", way.length());
        }
    }
    assert!(lit > 32, "{lit} caches are lit");
}

#[test]
fn drawn_area_lights_give_caches_the_light_of_all_and_err_as_a_mean_does() {
    let (mut renderer, mut config) = lit_room();
    config.rsm.size = [32, 32];
    config.gather.light_caches.distance = 1.5;
    let mut gathered = |config: &Config| -> Vec<f64> {
        let rendered = dump(&mut renderer, config, 0, &["gather/cache-proxies"]);
        pod::<ProxyLight>(&rendered, "gather/proxies").iter().map(|proxy| f64::from(proxy.irradiance.iter().sum::<f32>())).collect()
    };
    config.vpls.sampler = VplSampler::EveryTexel;
    let all = gathered(&config);
    config.vpls.sampler = VplSampler::InverseTransform;
    config.vpls.importance = Importance::View;
    config.vpls.numbers = Numbers::Random;
    config.vpls.view_importance.samples = 64;
    config.vpls.view_importance.defensive = 0.2;
    let seeds = 64;
    let mut errors = Vec::new();
    for count in [256, 1024] {
        config.vpls.count = count;
        let of_seed = |seed| {
            config.frame.seed = seed;
            gathered(&config)
        };
        let drawn: Vec<Vec<f64>> = (1..=seeds).map(of_seed).collect();
        let (mut within, mut lit, mut variance) = (0, 0, 0.0);
        for cache in (0..all.len()).filter(|cache| all[*cache] > 0.0) {
            let (mean, error) = crate::population::mean_and_error(drawn.iter().map(|caches| caches[cache]), seeds as usize);
            lit += 1;
            within += usize::from((mean - all[cache]).abs() <= 3.0 * error);
            variance += (error / all[cache]).powi(2);
        }
        println!("{count}: {within} of {lit} caches within three standard errors");
        assert!(lit > 20 && f64::from(within as u32) >= 0.95 * f64::from(lit), "{count}: {within} of {lit} caches");
        errors.push((variance / f64::from(lit)).sqrt());
    }
    // Four times as many err half as much.
    let ratio = errors[0] / errors[1];
    assert!((1.7..=2.3).contains(&ratio), "errors {errors:?}");
    finish(renderer.gpu());
}

#[test]
fn pixels_have_the_light_of_the_caches_around_them() {
    // Equations 8 and 9 at the pixel's own place with its own sixteen caches, which the paper may mean, beside those at the vertices.
    let (mut renderer, mut config) = lit_room();
    config.vpls.sampler = VplSampler::EveryTexel;
    let rendered = dump(&mut renderer, &config, 0, &["gather/cache-places", "gather/cache-proxies"]);
    let caches: Vec<PlacedLightCache> = pod(&rendered, "gather/caches");
    let proxies: Vec<ProxyLight> = pod(&rendered, "gather/proxies");
    let picture = picture(&mut renderer, &config);
    let at = |(position, normal): (Vec3, Vec3)| -> f64 {
        let mut near: Vec<(f32, usize)> = caches.iter().map(|cache| Vec3::from(cache.position).distance(position)).zip(0..).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = &near[..16];
        let (mut weights, mut lit, mut flux, mut way, mut extent) = (0.0, 0.0, 0.0, DVec3::ZERO, 0.0);
        for (distance, number) in near {
            let (cache, proxy) = (&caches[*number], &proxies[*number]);
            let facing = Vec3::from(cache.normal);
            let weight = f64::from(1.0 - distance / near[15].0) * f64::from(facing.dot(normal).max(0.0)).sqrt();
            weights += weight;
            let (to, sigma) = (Vec3::from(proxy.way).as_dvec3(), f64::from(proxy.extent));
            if to.dot(facing.as_dvec3()) > 0.0 {
                let squared = to.length_squared() + sigma * sigma;
                lit += weight;
                way += weight * (to + (Vec3::from(cache.position) - position).as_dvec3());
                extent += weight * sigma;
                flux += weight * 4.0 * PI * squared / proxy_cosine(facing.as_dvec3(), to, sigma) * f64::from(proxy.irradiance[0]);
            }
        }
        if lit == 0.0 {
            return 0.0;
        }
        let (way, extent) = (way / lit, extent / lit);
        flux / weights * proxy_cosine(normal.as_dvec3(), way, extent) / (4.0 * PI * (way.length_squared() + extent * extent))
    };
    let (positions, normals) = (picture.positions(), picture.normals());
    let (mut ours, mut theirs, mut squares, mut pixels) = (0.0, 0.0, 0.0, 0);
    for i in (0..positions.len()).filter(|i| picture.depth.values[*i] > 0.0) {
        let (own, other) = (f64::from(picture.irradiance.at(i)[0]), at((positions[i], normals[i])));
        ours += own;
        theirs += other;
        squares += (own - other).powi(2);
        pixels += 1;
    }
    let pixels = f64::from(pixels);
    let (ratio, rms) = (ours / theirs, (squares / pixels).sqrt() / (theirs / pixels));
    println!("vertices over pixels: {ratio}, rms {rms}");
    assert!((ratio - 1.0).abs() < 0.005 && rms < 0.03, "vertices give {ratio} of what pixels' own caches do, rms {rms}");
    finish(renderer.gpu());
}

#[test]
fn metals_reflect_what_their_lobe_does_of_all_area_lights() {
    // A floor of metal before a wall that a spot lights.
    let mut scene = manylight::scene::Scene { name: "metal".into(), ..Default::default() };
    let metal = Material { metallic: 1.0, roughness: 0.6, ..matte([0.9, 0.6, 0.3]) };
    add_quad(&mut scene, [[-2.0, -2.0], [-2.0, 2.0], [2.0, 2.0], [2.0, -2.0]].map(|[x, z]| Vec3::new(x, 0.0, z)), metal);
    add_quad(&mut scene, [[-2.0, 0.0], [2.0, 0.0], [2.0, 3.0], [-2.0, 3.0]].map(|[x, y]| Vec3::new(x, y, -2.0)), matte([0.8; 3]));
    scene.split_triangles(0.04);
    let mut renderer = renderer(scene);
    let light = spot(Vec3::new(0.0, 1.5, 1.0), Vec3::NEG_Z, [20.0; 3], 10.0, 15.0);
    let mut config = plain([48, 32], Vec3::new(0.4, 1.5, 2.5), Vec3::new(0.0, 0.0, -0.3), 40.0, light);
    config.rsm.size = [32, 32];
    config.gather.method = GatherMethod::LightCaches;
    config.gather.light_caches.distance = 0.25;
    config.gather.light_caches.occlusion = CacheOcclusion::None;
    config.gather.light_caches.receiver = Receiver::Ggx;
    config.vpls.sampler = VplSampler::EveryTexel;
    let rendered = dump(&mut renderer, &config, 0, &["vpls/every-texel", "gather/cache-places"]);
    let places: Vec<VplPlace> = pod(&rendered, "vpls/places");
    let intensities: Vec<[f32; 3]> = pod(&rendered, "vpls/intensities");
    let disks: Vec<[f32; 2]> = pod(&rendered, "vpls/disks");
    let alpha: f64 = 0.36;
    let exponent = 0.5 / (alpha * alpha) - 0.5;
    let caches: Vec<PlacedLightCache> = pod(&rendered, "gather/caches");
    assert!(caches.iter().any(|cache| (f64::from(cache.exponent) / exponent - 1.0).abs() < 1e-3), "the metal's caches have its exponent");
    assert!(caches.iter().any(|cache| cache.exponent == 0.0), "the wall's caches are rough");
    let picture = picture(&mut renderer, &config);
    let (positions, normals) = (picture.positions(), picture.normals());
    let eye = Vec3::new(0.4, 1.5, 2.5).as_dvec3();
    let (mut found, mut expected, mut squares, mut pixels) = (0.0, 0.0, 0.0, 0);
    for i in
        (0..48 * 32).filter(|i| picture.depth.values[*i] > 0.0 && positions[*i].y.abs() < 1e-3 && positions[*i].abs().max_element() < 1.8)
    {
        let (at, normal) = (positions[i].as_dvec3(), normals[i].as_dvec3());
        let to_eye = (eye - at).normalize();
        let mirrored = 2.0 * normal.dot(to_eye) * normal - to_eye;
        let mut sum = 0.0;
        for (place, (intensity, disk)) in places.iter().zip(intensities.iter().zip(&disks)) {
            let d = Vec3::from(place.position).as_dvec3() - at;
            let facing = pack::octahedral_snorm16_inverse(place.normal).as_dvec3();
            let cosines = d.dot(normal).max(0.0) * (-d.dot(facing)).max(0.0) / d.length_squared();
            let light = PI * cosines / (f64::from(disk[0]) + PI * d.length_squared()) * f64::from(intensity[0]);
            let half = (d.normalize() + to_eye).normalize();
            let fresnel = 0.9 + 0.1 * (1.0 - half.dot(to_eye)).powi(5);
            sum += light * fresnel * (exponent + 2.0) / (2.0 * PI) * d.normalize().dot(mirrored).max(0.0).powf(exponent);
        }
        let own = f64::from(picture.indirect.at(i)[0]);
        found += own;
        expected += sum;
        squares += (own - sum).powi(2);
        pixels += 1;
    }
    let (ratio, rms) = (found / expected, (squares / f64::from(pixels)).sqrt() / (expected / f64::from(pixels)));
    println!("caches over all lights: {ratio}, rms {rms}, of {pixels} pixels");
    assert!(pixels > 400 && (ratio - 1.0).abs() < 0.02 && rms < 0.04, "{ratio} of the light, rms {rms}");
    finish(renderer.gpu());
}

#[test]
fn caches_that_rays_shadow_give_the_light_of_one_bounce() {
    let mut scene = manylight::scene::builtin::cornell();
    scene.split_triangles(0.05);
    let mut renderer = traced(scene);
    let light = renderer.lights(&Config::default(), 0);
    assert_eq!(light.len(), 1);
    let mut config = Config::default();
    config.frame.size = [64, 64];
    config.rsm.size = [64, 64];
    config.vpls.sampler = VplSampler::EveryTexel;
    config.filter.kind = manylight::config::FilterKind::None;
    config.gather.method = GatherMethod::LightCaches;
    config.gather.light_caches.distance = 0.7;
    let truth = reference(&mut renderer, &config, centered(1), 256);
    let truth: f64 = mean(&truth.indirect(), |_| true);
    let mut energy = |occlusion: CacheOcclusion, sides: OccluderSides| {
        config.gather.light_caches.occlusion = occlusion;
        config.gather.light_caches.double_projection.sides = sides;
        let picture = picture(&mut renderer, &config);
        let light: f64 = picture.indirect.rgb().map(|rgb| f64::from(rgb.element_sum()) / 3.0).sum();
        light / 4096.0 / truth
    };
    // Squares that overlap count twice, and so do both sides of a block: an independent implementation has .79 then.
    for (occlusion, sides, least, most) in [
        (CacheOcclusion::RayTraced, OccluderSides::Front, 0.97, 1.03),
        (CacheOcclusion::DoubleProjection, OccluderSides::Front, 0.85, 1.15),
        (CacheOcclusion::DoubleProjection, OccluderSides::Both, 0.73, 0.85),
        (CacheOcclusion::None, OccluderSides::Front, 1.1, 1.3),
    ] {
        let ratio = energy(occlusion, sides);
        println!("{occlusion:?}, {sides:?}: {ratio}");
        assert!((least..=most).contains(&ratio), "{occlusion:?}, {sides:?}: {ratio} of one bounce");
    }
    finish(renderer.gpu());
}

#[test]
fn caches_go_with_the_model_that_moves() {
    let mut make = Make::square();
    make.json["materials"] = json!([{"pbrMetallicRoughness": {"metallicFactor": 0}}]);
    make.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    make.animate(1, "translation", "LINEAR", &[0.0, 4.0], &[3.0, 0.0, 0.0, 3.0, 8.0, 0.0]);
    let mut renderer = renderer(make.scene());
    let light = LightConfig::Point { position: [0.5, 0.5, 2.0], intensity: [1.0; 3], keyframes: Vec::new() };
    let mut config = plain([16, 16], Vec3::new(2.0, 0.0, 6.0), Vec3::new(2.0, 0.0, 0.0), 60.0, light);
    config.frame.fps = 1.0;
    config.gather.method = GatherMethod::LightCaches;
    config.gather.light_caches.distance = 0.5;
    let mut positions = |frame| -> Vec<Vec3> {
        let rendered = dump(&mut renderer, &config, frame, &PASSES);
        pod::<PlacedLightCache>(&rendered, "gather/caches").iter().map(|cache| cache.position.into()).collect()
    };
    let (before, after) = (positions(0), positions(1));
    assert!(before.len() > 8 && before.len() % 2 == 0, "{} caches", before.len());
    let moved: Vec<Vec3> = before.iter().zip(&after).map(|(before, after)| after - before).collect();
    let still = moved.iter().filter(|by| by.length() < 1e-5).count();
    let rising = moved.iter().filter(|by| by.distance(Vec3::new(0.0, 2.0, 0.0)) < 1e-4).count();
    assert_eq!((still, rising), (before.len() / 2, before.len() / 2), "{moved:?}");
    finish(renderer.gpu());
}

#[test]
fn caches_bend_with_their_mesh() {
    let mut scene = crate::bends::strips();
    scene.set_time(0.0);
    let folder = tempfile::tempdir().unwrap();
    let spacing = Spacing { distance: 0.3, angle: 30f32.to_radians(), open: true };
    let caches = LightCaches::of(&scene, spacing, &Cache::at(folder.path())).unwrap();
    let mut renderer = renderer(scene.clone());
    let light = directional(Vec3::new(0.3, -0.8, -0.5).normalize(), [2.0; 3]);
    let mut config = plain([32, 32], Vec3::new(1.0, 0.5, 5.0), Vec3::new(1.0, 0.0, 0.0), 60.0, light);
    config.frame.fps = 4.0;
    config.rsm.size = [32, 32];
    config.gather.method = GatherMethod::LightCaches;
    config.gather.light_caches.distance = spacing.distance;
    let mut first: Vec<Vec3> = Vec::new();
    for frame in [0, 3] {
        let rendered = dump(&mut renderer, &config, frame, &["gather/cache-places"]);
        let found: Vec<Vec3> = pod::<PlacedLightCache>(&rendered, "gather/caches").iter().map(|cache| cache.position.into()).collect();
        scene.set_time(f64::from(frame) / 4.0);
        let mut expected = Vec::new();
        for model in &caches.models {
            for (draws, cache) in model.instances.iter().flat_map(|draws| model.caches.iter().map(move |cache| (draws, cache))) {
                let transform = scene.draws[draws[cache.draw as usize] as usize].transform;
                let [a, b, c] = cache.corners.map(|corner| transform.transform_point3(scene.vertices[corner as usize].position.into()));
                expected.push(a + cache.weights[0] * (b - a) + cache.weights[1] * (c - a));
            }
        }
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!(found.distance(*expected) < 1e-4, "frame {frame}: a cache is at {found} instead of {expected}");
        }
        if frame > 0 {
            let moved = found.iter().zip(&first).filter(|(now, then)| now.distance(**then) > 0.05).count();
            assert!(moved > found.len() / 4, "{moved} of {} caches have moved", found.len());
        }
        first = found;
    }
    finish(renderer.gpu());
}

#[test]
fn both_sides_of_a_sheet_have_their_own_light() {
    // A floor is lit, and a sheet above it; the sheet's lower side sees the floor, and its upper side nothing.
    let mut scene = manylight::scene::Scene { name: "sheet".into(), ..Default::default() };
    let quad = |height: f32, half: f32| [[-half, -half], [-half, half], [half, half], [half, -half]].map(|[x, z]| Vec3::new(x, height, z));
    add_quad(&mut scene, quad(0.0, 3.0), matte([0.8; 3]));
    add_quad(&mut scene, quad(1.0, 1.0), Material { double_sided: true, ..matte([0.8; 3]) });
    scene.split_triangles(0.04);
    let mut renderer = renderer(scene);
    // The spot stands between them, and shines on the floor alone.
    let light = spot(Vec3::new(0.0, 0.9, 0.0), Vec3::NEG_Y, [10.0; 3], 30.0, 60.0);
    let mut at = |eye: Vec3, method: GatherMethod| {
        let mut config = plain([32, 32], eye, Vec3::new(0.0, 1.0, 0.0), 30.0, light.clone());
        config.rsm.size = [64, 64];
        config.vpls.sampler = VplSampler::EveryTexel;
        config.gather.method = method;
        config.gather.light_caches.distance = 0.25;
        config.gather.light_caches.occlusion = CacheOcclusion::None;
        let middle: Vec<Vec3> =
            irradiance(&mut renderer, &config).chunks(32).skip(14).take(4).flat_map(|row| row[14..18].to_vec()).collect();
        middle.iter().map(|light| f64::from(light.x)).sum::<f64>() / middle.len() as f64
    };
    let (below, above) = (Vec3::new(0.5, 0.1, 0.6), Vec3::new(0.5, 4.0, 0.6));
    let (found, expected) = (at(below, GatherMethod::LightCaches), at(below, GatherMethod::PerPixel));
    assert!(expected > 0.1 && (found / expected - 1.0).abs() < 0.05, "the lower side has {found} W/m^2 instead of {expected}");
    let found = at(above, GatherMethod::LightCaches);
    assert!(found < 0.001 * expected, "the upper side has {found} W/m^2");
    finish(renderer.gpu());
}
