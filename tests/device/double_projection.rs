//! Double projection: what hides the light of a cache from it.

use crate::common::*;
use glam::{Mat3, Vec3};
use manylight::config::{Before, DoubleProjectionConfig, OccluderSides, Occluders, ProxyRadius};
use manylight::graph::{Engine, Execution, Graph, Library};
use manylight::stages::gather::light_caches::{CacheTile, CountParams, OcclusionParams, PlacedLightCache, ProxyLight, TILE};

/// Share of a proxy's light that reaches the first cache past the others: the proxy is 4 m above it, and a sphere of a metre.
fn seen_of(caches: &[PlacedLightCache], choice: &DoubleProjectionConfig) -> f32 {
    seen_of_lights(caches, &[Vec3::new(0.0, 4.0, 0.0)], choice)[0]
}

/// The same of a cache with one light or two, spheres of a metre.
fn seen_of_lights(caches: &[PlacedLightCache], ways: &[Vec3], choice: &DoubleProjectionConfig) -> Vec<f32> {
    let mut engine = Engine::new(gpu(), Library::new().unwrap());
    let mut proxies = vec![ProxyLight { way: [0.0; 3], extent: 0.0, irradiance: [0.0; 3] }; caches.len() * ways.len()];
    for (proxy, way) in proxies.iter_mut().zip(ways) {
        *proxy = ProxyLight { way: (*way).into(), extent: 1.0, irradiance: [1.0; 3] };
    }
    let mut g = Graph::new();
    let count = caches.len() as u32;
    let (caches, proxies) = (g.upload("test/caches", caches), g.upload("test/proxies", &proxies));
    let tiles = g.buffer::<CacheTile>("test/tiles", count.div_ceil(TILE));
    g.compute("gather/cache-tiles").reads("caches", caches).writes("tiles", tiles).params(&CountParams { count }).dispatch_groups([
        count.div_ceil(TILE),
        1,
        1,
    ]);
    let (seen, within) = (g.buffer::<f32>("test/seen", count * ways.len() as u32), g.count("test/within"));
    g.compute("gather/cache-occlusion")
        .part("proxies", ["gather/proxies-one", "gather/proxies-two"][ways.len() - 1])
        .reads("caches", caches)
        .reads("tiles", tiles)
        .reads("proxies", proxies)
        .writes("seen", seen)
        .updates("within", within)
        .constant("BEFORE_SPHERE", choice.before == Before::Sphere)
        .constant("FRONTS", choice.sides == OccluderSides::Front)
        .constant("SILHOUETTES", choice.occluders == Occluders::Silhouettes)
        .params(&OcclusionParams { count, least_radius: 0.0, deviations: if choice.radius == ProxyRadius::TwoSigma { 2.0 } else { 1.0 } })
        .dispatch_groups([count.div_ceil(4), 1, 1]);
    let read = g.read_back(seen);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let shares = words(outcome.bytes(read)).take(ways.len()).map(f32::from_bits).collect();
    finish(&engine.gpu);
    shares
}

/// The same of a cache at the origin, which faces up, past disks of caches. All is turned about the vertical by each angle.
fn seen(disks: &[(Vec3, Vec3, f32)], angles: &[f32], choice: &DoubleProjectionConfig) -> Vec<f32> {
    let of_angle = |angle: &f32| {
        let turn = Mat3::from_rotation_y(*angle);
        let cache = |position: Vec3, normal: Vec3, area: f32| disk(turn * position, turn * normal, area);
        let caches: Vec<_> = std::iter::once(cache(Vec3::ZERO, Vec3::Y, 1.0))
            .chain(disks.iter().map(|(at, normal, area)| cache(*at, *normal, *area)))
            .collect();
        seen_of(&caches, choice)
    };
    angles.iter().map(of_angle).collect()
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
        // Most tiles of 64 caches lie behind or beyond the light, and half a roof is in between, after more than the 4,096 caches whose
        // tiles a workgroup lists at once.
        (
            "half a roof among many surfaces",
            [
                tiles([-40.0, 40.0], [-40.0, 40.0], -1.0, 1.0, Vec3::Y),
                tiles([0.0, 4.0], [-4.0, 4.0], 1.0, 0.25, Vec3::NEG_Y),
                tiles([-40.0, 40.0], [-40.0, 40.0], 30.0, 2.0, Vec3::NEG_Y),
            ]
            .concat(),
            0.5,
            0.1,
        ),
    ] {
        let seen = seen(&disks, &angles, &DoubleProjectionConfig { sides: OccluderSides::Both, ..Default::default() });
        println!("{what}: {seen:?}");
        assert!(seen.iter().all(|seen| (seen - expected).abs() <= tolerance), "{what}: {seen:?} instead of {expected}");
    }
}

#[test]
fn sides_and_the_sphere_decide_what_hides_a_light() {
    let roof = |height, normal| tiles([-4.0, 4.0], [-4.0, 4.0], height, 0.25, normal);
    let of = |before, sides| DoubleProjectionConfig { before, sides, ..Default::default() };
    for (what, disks, choice, expected) in [
        ("a roof that faces up, by fronts", roof(1.0, Vec3::Y), of(Before::Center, OccluderSides::Front), 1.0),
        ("a roof that faces down, by fronts", roof(1.0, Vec3::NEG_Y), of(Before::Center, OccluderSides::Front), 0.0),
        ("a roof in the sphere, before its middle", roof(3.5, Vec3::NEG_Y), of(Before::Center, OccluderSides::Both), 0.0),
        ("a roof in the sphere", roof(3.5, Vec3::NEG_Y), of(Before::Sphere, OccluderSides::Both), 1.0),
        ("a roof before the sphere", roof(1.0, Vec3::NEG_Y), of(Before::Sphere, OccluderSides::Both), 0.0),
        ("a roof before a sphere", roof(2.5, Vec3::NEG_Y), of(Before::Sphere, OccluderSides::Both), 0.0),
        (
            "a roof in a sphere of twice its radius",
            roof(2.5, Vec3::NEG_Y),
            DoubleProjectionConfig { radius: ProxyRadius::TwoSigma, ..of(Before::Sphere, OccluderSides::Both) },
            1.0,
        ),
    ] {
        let seen = seen(&disks, &[0.0], &choice);
        assert!((seen[0] - expected).abs() < 0.2, "{what}: {seen:?} instead of {expected}");
    }
}

/// A cache that is a disk.
fn disk(position: Vec3, normal: Vec3, area: f32) -> PlacedLightCache {
    PlacedLightCache {
        position: position.into(),
        area,
        normal: normal.into(),
        exponent: 0.0,
        silhouette: area,
        opacity: 1.0,
        one_of_two: 0,
    }
}

#[test]
fn a_side_of_a_sheet_hides_nothing_behind_it() {
    // A sheet has a cache on each side. Of the upper one the cache sees the back, and the lower one hides the light.
    let both = DoubleProjectionConfig { sides: OccluderSides::Both, ..Default::default() };
    let (target, upper) = (disk(Vec3::ZERO, Vec3::Y, 1.0), disk(Vec3::Y, Vec3::Y, 50.0));
    assert_eq!(seen_of(&[target, upper], &both), 0.0);
    assert_eq!(seen_of(&[target, PlacedLightCache { one_of_two: 1, ..upper }], &both), 1.0);
}

#[test]
fn both_lights_of_a_cache_have_shadows_of_their_own() {
    let ways = [Vec3::new(0.0, 4.0, 0.0), Vec3::new(3.0, 2.0, 0.0)];
    let target = disk(Vec3::ZERO, Vec3::Y, 1.0);
    for (position, expected) in [(Vec3::new(0.0, 2.0, 0.0), [0.0, 1.0]), (Vec3::new(1.5, 1.0, 0.0), [1.0, 0.0]), (Vec3::NEG_Y, [1.0, 1.0])]
    {
        let seen = seen_of_lights(&[target, disk(position, -position.normalize(), 4.0)], &ways, &Default::default());
        assert!(seen.iter().zip(expected).all(|(seen, expected)| (seen - expected).abs() < 0.02), "a disk at {position}: {seen:?}");
    }
}

#[test]
fn what_is_spread_over_more_than_its_area_hides_a_part_of_a_light() {
    // A disk of two square metres at a metre's height, before a light that it hides: at one place, and spread over 400 m^2.
    let spread = |silhouette: f32, opacity: f32| {
        [disk(Vec3::ZERO, Vec3::Y, 1.0), PlacedLightCache { silhouette, opacity, ..disk(Vec3::Y, Vec3::NEG_Y, 2.0) }]
    };
    for (what, caches, occluders, expected) in [
        ("a solid disk", spread(400.0, 1.0), Occluders::Silhouettes, 0.0),
        ("a disk of half its silhouette", spread(400.0, 0.5), Occluders::Silhouettes, 0.5),
        ("leaves in a large crown", spread(400.0, 0.005), Occluders::Silhouettes, 0.995),
        ("the same as an area", spread(400.0, 0.005), Occluders::Areas, 0.0),
    ] {
        let seen = seen_of(&caches, &DoubleProjectionConfig { occluders, ..Default::default() });
        assert!((seen - expected).abs() < 1e-3, "{what}: {seen} instead of {expected}");
    }
}
