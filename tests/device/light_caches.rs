//! Light caches: what caches gather, what hides it from them, and what pixels make of it.

use crate::common::*;
use crate::make::Make;
use glam::{DVec3, Mat3, Vec3};
use manylight::config::{CacheOcclusion, Config, GatherMethod, Importance, LightConfig, ProxyBound, VplSampler};
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::renderer::Renderer;
use manylight::scene::caches::NONE;
use manylight::scene::{Material, Vertex, pack};
use manylight::stages::gather::caches::ListedVertex;
use manylight::stages::gather::light_caches::{CountParams, OcclusionParams, PlacedLightCache, ProxyLight, VertexLight};
use manylight::stages::vpls::VplPlace;
use manylight::world::device::DrawData;
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
    for (sampler, importance, count) in [
        (VplSampler::Regular, Importance::None, 1),
        (VplSampler::Regular, Importance::None, 1000),
        (VplSampler::Hammersley, Importance::PassedFlux, 777),
        (VplSampler::InverseTransform, Importance::View, 1000),
        (VplSampler::MetropolisHastings, Importance::View, 300),
        (VplSampler::EveryTexel, Importance::None, 1000),
    ] {
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
            let (mut irradiance, mut weights, mut way) = (DVec3::ZERO, 0.0, DVec3::ZERO);
            for i in (0..places.len()).filter(|i| areas[*i] > 0.0) {
                let d = Vec3::from(places[i].position).as_dvec3() - at;
                let facing = pack::octahedral_snorm16_inverse(places[i].normal).as_dvec3();
                let cosines = d.dot(normal).max(0.0) * (-d.dot(facing)).max(0.0) / d.length_squared();
                let form = cosines / (f64::from(disks[i][0]) + PI * d.length_squared());
                irradiance += PI * form * Vec3::from(intensities[i]).as_dvec3();
                let weight = f64::from(disks[i][1]) * form;
                weights += weight;
                way += weight * d;
            }
            let found = Vec3::from(proxy.irradiance).as_dvec3();
            assert!((found - irradiance).length() <= 1e-4 * irradiance.length(), "{sampler:?}, {count}: {found} instead of {irradiance}");
            if weights > 0.0 {
                lit += 1;
                let found = Vec3::from(proxy.way).as_dvec3();
                assert!((found - way / weights).length() < 1e-3, "{sampler:?}, {count}: the proxy is at {found}, not {}", way / weights);
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
    for (bound, bar) in [(ProxyBound::Extent, 0.02), (ProxyBound::None, 0.05)] {
        let ratio = means(GatherMethod::LightCaches, bound) / all;
        println!("{bound:?}: {ratio}");
        assert!((ratio - 1.0).abs().max_element() < bar, "{bound:?}: {ratio} of the light of all VPLs");
    }
    finish(renderer.gpu());
}

/// Shares of a proxy's light that reach a cache at the origin, which faces up, past disks of caches: the proxy is 4 m above it, and a
/// sphere of a metre. All is turned about the vertical by each angle.
fn seen(disks: &[(Vec3, Vec3, f32)], angles: &[f32]) -> Vec<f32> {
    let mut engine = Engine::new(gpu(), Library::new().unwrap());
    let of_angle = |angle: &f32| {
        let turn = Mat3::from_rotation_y(*angle);
        let cache = |position: Vec3, normal: Vec3, area: f32| PlacedLightCache {
            position: (turn * position).into(),
            area,
            normal: (turn * normal).into(),
            one_of_two: 0,
        };
        let caches: Vec<_> = std::iter::once(cache(Vec3::ZERO, Vec3::Y, 1.0))
            .chain(disks.iter().map(|(at, normal, area)| cache(*at, *normal, *area)))
            .collect();
        let mut proxies = vec![ProxyLight { way: [0.0; 3], extent: 0.0, irradiance: [0.0; 3] }; caches.len()];
        proxies[0] = ProxyLight { way: [0.0, 4.0, 0.0], extent: 1.0, irradiance: [1.0; 3] };
        let mut g = Graph::new();
        let count = caches.len() as u32;
        let (caches, proxies) = (g.upload("test/caches", &caches), g.upload("test/proxies", &proxies));
        let seen = g.buffer::<f32>("test/seen", count);
        g.compute("gather/cache-occlusion")
            .reads("caches", caches)
            .reads("proxies", proxies)
            .writes("seen", seen)
            .params(&OcclusionParams { count, least_radius: 0.0 })
            .dispatch_groups([count, 1, 1]);
        let read = g.read_back(seen);
        let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
        f32::from_bits(words(outcome.bytes(read)).next().unwrap())
    };
    let all = angles.iter().map(of_angle).collect();
    finish(&engine.gpu);
    all
}

/// Tiles of a side that cover a rectangle of x and z at a height, facing down or up.
fn tiles(x: [f32; 2], z: [f32; 2], height: f32, side: f32, normal: Vec3) -> Vec<(Vec3, Vec3, f32)> {
    let count = |[from, to]: [f32; 2]| ((to - from) / side).round() as u32;
    let middle = |i: u32, from: f32| from + (i as f32 + 0.5) * side;
    let at = |i| (0..count(z)).map(move |k| (Vec3::new(middle(i, x[0]), height, middle(k, z[0])), normal, side * side));
    (0..count(x)).flat_map(at).collect()
}

#[test]
fn double_projection_hides_what_is_between() {
    let angles: Vec<f32> = (0..4).map(|i| i as f32 * 0.4).collect();
    for (what, disks, expected, tolerance) in [
        ("nothing", Vec::new(), 1.0, 1e-6),
        ("a large disk", vec![(Vec3::Y, Vec3::NEG_Y, 50.0)], 0.0, 1e-6),
        // Turned tiles are squares along the axes all the same, with gaps between them.
        ("a roof", tiles([-4.0, 4.0], [-4.0, 4.0], 1.0, 0.25, Vec3::NEG_Y), 0.0, 0.2),
        ("half a roof", tiles([0.0, 4.0], [-4.0, 4.0], 1.0, 0.25, Vec3::NEG_Y), 0.5, 0.1),
        ("half a roof that faces up", tiles([0.0, 4.0], [-4.0, 4.0], 1.0, 0.25, Vec3::Y), 0.5, 0.1),
        ("a roof behind the proxy", tiles([-4.0, 4.0], [-4.0, 4.0], 5.0, 0.25, Vec3::NEG_Y), 1.0, 1e-6),
        ("a floor under the cache", tiles([-4.0, 4.0], [-4.0, 4.0], -1.0, 0.25, Vec3::Y), 1.0, 1e-6),
    ] {
        let seen = seen(&disks, &angles);
        println!("{what}: {seen:?}");
        assert!(seen.iter().all(|seen| (seen - expected).abs() <= tolerance), "{what}: {seen:?} instead of {expected}");
    }
}

/// Light of a vertex at the origin, which faces up, on its own surface: its caches have these places, all face up, and have proxies at these
/// ways and this irradiance.
fn light_of_vertex(caches: &[(Vec3, Vec3, f32)]) -> f64 {
    let mut engine = Engine::new(gpu(), Library::new().unwrap());
    let mut g = Graph::new();
    let up = pack::octahedral_snorm16(Vec3::Y);
    let list: [u32; 16] = std::array::from_fn(|i| if i < caches.len() { i as u32 } else { NONE });
    let transform = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let place = |(position, ..): &(Vec3, Vec3, f32)| PlacedLightCache {
        position: (*position).into(),
        area: 1.0,
        normal: [0.0, 1.0, 0.0],
        one_of_two: 0,
    };
    let proxy = |(_, way, light): &(Vec3, Vec3, f32)| ProxyLight { way: (*way).into(), extent: 0.0, irradiance: [*light; 3] };
    let buffers = [
        ("listed", g.upload("test/listed", &[ListedVertex { vertex: 0, list: 0, draw: 0, first_cache: 0 }])),
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
    pass.constant("BOUNDED", true).constant("SIDES", 1u32).params(&CountParams { count: 1 }).dispatch_groups([1, 1, 1]);
    let read = g.read_back(lights);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let light: VertexLight = bytemuck::pod_read_unaligned(outcome.bytes(read));
    finish(&engine.gpu);
    let way = Vec3::from(light.way).as_dvec3() / f64::from(light.lit).max(1e-20);
    f64::from(light.flux[0]) * way.y.max(0.0) / (4.0 * PI * way.length().powi(3)).max(1e-20)
}

#[test]
fn vertices_have_the_mean_of_equal_caches_and_dark_ones_take_their_share() {
    // A farther cache has no weight, and gives the others theirs.
    let far = (Vec3::new(0.0, 0.0, 100.0), Vec3::new(0.0, 1.0, -100.0), 1.0);
    let lamp = Vec3::new(0.0, 1000.0, 0.0);
    let at = |x: f32, light: f32| (Vec3::new(x, 0.0, 0.0), lamp - Vec3::new(x, 0.0, 0.0), light);
    for (lit, dark) in [(1, 0), (4, 0), (1, 1), (3, 1), (1, 3), (1, 9)] {
        let mut caches: Vec<_> = (0..lit).map(|_| at(1.0, 2.0)).collect();
        caches.extend((0..dark).map(|_| (Vec3::new(-1.0, 0.0, 0.0), Vec3::ZERO, 0.0)));
        caches.push(far);
        let (found, expected) = (light_of_vertex(&caches), 2.0 * f64::from(lit) / f64::from(lit + dark));
        assert!((found / expected - 1.0).abs() < 1e-3, "{lit} lit and {dark} dark caches give {found} instead of {expected}");
    }
    assert_eq!(light_of_vertex(&[(Vec3::X, Vec3::ZERO, 0.0), far]), 0.0, "a vertex whose caches are all dark");
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
    let mut energy = |occlusion: CacheOcclusion| {
        config.gather.light_caches.occlusion = occlusion;
        let picture = picture(&mut renderer, &config);
        let light: f64 = picture.indirect.rgb().map(|rgb| f64::from(rgb.element_sum()) / 3.0).sum();
        light / 4096.0 / truth
    };
    // Squares that overlap count twice, and so do both sides of a block: an independent implementation has .79.
    for (occlusion, least, most) in
        [(CacheOcclusion::RayTraced, 0.97, 1.03), (CacheOcclusion::DoubleProjection, 0.73, 0.85), (CacheOcclusion::None, 1.1, 1.3)]
    {
        let ratio = energy(occlusion);
        println!("{occlusion:?}: {ratio}");
        assert!((least..=most).contains(&ratio), "{occlusion:?}: {ratio} of one bounce");
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
