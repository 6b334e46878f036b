//! Further bounces: clusters of VPLs, the maps seen from them, and the VPLs of the next bounce.

use crate::common::*;
use bytemuck::pod_collect_to_vec;
use glam::{DVec3, Vec2, Vec3};
use manylight::config::{
    BounceVisibility, Builtin, Centers, Config, Emitters, FilterKind, Importance, Layers, LightConfig, LightKeyframe, Pattern,
    Representative, SceneConfig, Shares, VisibilityMethod, VplSampler,
};
use manylight::graph::Execution;
use manylight::metrics::Intensity;
use manylight::reference::Sum;
use manylight::renderer::{Rendered, Renderer};
use manylight::scene::Scene;
use manylight::scene::pack::{octahedral_inverse, octahedral_snorm16_inverse};
use manylight::scene::source::load_scene;
use manylight::stages::bounce::VplCluster;
use manylight::stages::vpls::VplPlace;
use manylight::walk::flicker_of_walk;
use std::f64::consts::{FRAC_PI_4, PI};
use std::path::Path;

const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);

fn lamp() -> LightConfig {
    spot(Vec3::new(1.8, 2.6, 2.2), Vec3::new(0.2, -1.0, 0.1), [20.0, 15.0, 10.0], 25.0, 55.0)
}

/// A closed box of one colour, with two bounces.
fn closed_box(albedo: DVec3) -> (Scene, Config) {
    let mut config = plain([64, 64], Vec3::new(3.6, 1.7, 4.6), Vec3::new(1.0, 1.2, 0.5), 95.0, lamp());
    config.rsm.size = [128, 128];
    config.vpls.sampler = VplSampler::Hammersley;
    config.vpls.count = 256;
    config.bounce.count = 2;
    config.bounce.vpls = 1024;
    (split_room(&walls(SIZE, [albedo; 6])), config)
}

/// A room with split triangles: maps bend the edges of walls as large as the room.
fn split_room(walls: &[Wall]) -> Scene {
    let mut scene = room(walls);
    scene.split_triangles(0.02);
    scene
}

fn clusters(rendered: &Rendered) -> Vec<VplCluster> {
    pod_collect_to_vec(dumped(rendered, "bounce/clusters"))
}

fn intensities(rendered: &Rendered, name: &str) -> Vec<DVec3> {
    let values: Vec<[f32; 3]> = pod_collect_to_vec(dumped(rendered, name));
    values.into_iter().map(|v| Vec3::from(v).as_dvec3()).collect()
}

#[test]
fn the_second_bounce_carries_the_flux_that_its_clusters_reflect() {
    let albedo = DVec3::new(0.6, 0.5, 0.3);
    let (scene, mut config) = closed_box(albedo);
    let mut renderer = renderer(scene);
    for (count_of_clusters, pattern, shares) in [
        (1, Pattern::Disk, Shares::Equal),
        (4, Pattern::Disk, Shares::Equal),
        (8, Pattern::Disk, Shares::Equal),
        (8, Pattern::Disk, Shares::Flux),
        (1, Pattern::Box, Shares::Equal),
    ] {
        config.bounce.shares = shares;
        config.bounce.clusters.count = count_of_clusters;
        config.bounce.pattern = pattern;
        let rendered = dump(&mut renderer, &config, 0, &["vpls/hammersley", "bounce/k-means", "bounce/sample"]);
        let first: DVec3 = intensities(&rendered, "vpls/intensities").into_iter().sum::<DVec3>() * PI;
        let flux: DVec3 = clusters(&rendered).iter().map(|cluster| Vec3::from(cluster.flux).as_dvec3()).sum();
        let second: DVec3 = intensities(&rendered, "bounce/intensities").into_iter().sum::<DVec3>() * PI;
        let error = ((second / (flux * albedo)) - 1.0).abs().max_element();
        println!(
            "{count_of_clusters} clusters, {pattern:?}: flux {flux}, of its VPLs {first}, passed on {second}, off by {:.3} %",
            100.0 * error
        );
        assert!(((flux / first) - 1.0).abs().max_element() < 1e-4, "clusters reflect {flux}, their VPLs {first}");
        assert!(error < 0.02, "{count_of_clusters} clusters, {pattern:?}: {second} of {flux} were passed on");
    }
    finish(renderer.gpu());
}

#[test]
fn samples_over_the_disk_waste_nothing_and_those_over_the_box_its_corners() {
    let (scene, mut config) = closed_box(DVec3::splat(0.5));
    let mut renderer = renderer(scene);
    let mut wasted = |pattern| {
        config.bounce.pattern = pattern;
        let rendered = dump(&mut renderer, &config, 0, &[]);
        (count(&rendered, "bounce/wasted"), count(&rendered, "bounce/lit"))
    };
    let (wasted_of_disk, lit_of_disk) = wasted(Pattern::Disk);
    // A sample may hit a texel at the rim, half of which is empty.
    assert!(wasted_of_disk == 0 && lit_of_disk >= 1016, "{wasted_of_disk} of 1024 wasted, {lit_of_disk} lit");
    let (wasted, lit) = wasted(Pattern::Box);
    assert!((1016..=1024).contains(&(wasted + lit)), "{wasted} of 1024 wasted, {lit} lit");
    assert!((wasted as f64 / 1024.0 - (1.0 - FRAC_PI_4)).abs() < 0.02, "{wasted} of 1024");
    finish(renderer.gpu());
}

#[test]
fn shares_by_flux_spend_vpls_where_light_goes_on_and_keep_its_sum() {
    let (scene, mut config) = small_atrium();
    config.bounce.vpls = 4096;
    let mut renderer = renderer(scene);
    let mut passed_on = |shares| {
        config.bounce.shares = shares;
        let rendered = dump(&mut renderer, &config, 0, &["bounce/sample"]);
        let fluxes: Vec<f64> = intensities(&rendered, "bounce/intensities").into_iter().map(|v| v.element_sum()).collect();
        let (sum, squares) = fluxes.iter().fold((0.0, 0.0), |(sum, squares), flux| (sum + flux, squares + flux * flux));
        (sum, squares / (sum * sum) * fluxes.len() as f64, count(&rendered, "bounce/lit"))
    };
    let (equal, equal_spread, equal_lit) = passed_on(Shares::Equal);
    let (flux, flux_spread, flux_lit) = passed_on(Shares::Flux);
    println!(
        "flux {flux:.2} of {equal:.2}; mean square over squared mean {flux_spread:.2}, {equal_spread:.2}; lit {flux_lit}, {equal_lit}"
    );
    assert!((flux / equal - 1.0).abs() < 0.05, "{flux} by flux, {equal} in equal shares");
    assert!(flux_spread < 0.8 * equal_spread, "VPLs' flux spreads by {flux_spread}, {equal_spread} in equal shares");
    assert!(flux_lit > equal_lit, "{flux_lit} lit, {equal_lit} in equal shares");
    finish(renderer.gpu());
}

#[test]
fn two_bounces_in_an_empty_box_are_the_path_tracers() {
    let (scene, mut config) = closed_box(DVec3::new(0.6, 0.5, 0.3));
    config.vpls.count = 1024;
    config.bounce.vpls = 4096;
    config.bounce.clusters.count = 32;
    let mut renderer = traced(scene);
    let sums = reference(&mut renderer, &config, centered(2), 192);
    let (first, second) = (sums.mean(Sum::Bounce(1)), sums.mean(Sum::Bounce(2)));
    let rendered = dump(&mut renderer, &config, 0, &[]);
    let picture = rendered.picture.unwrap();
    let found: Vec<[f32; 4]> = (0..sums.pixels()).map(|i| picture.indirect.at(i)).collect();
    // Pixels near walls are left out: VPLs are unbounded on near surfaces.
    let positions = picture.positions();
    let away = |i: usize| {
        let x = positions[i].as_dvec3();
        [x, SIZE - x].iter().flat_map(|d| d.to_array()).filter(|d| *d < 0.4).count() <= 1
    };
    let expected = mean(&first, away) + mean(&second, away);
    let ratio = mean(&found, away) / expected;
    config.bounce.count = 1;
    let once = dump(&mut renderer, &config, 0, &[]).picture.unwrap();
    let once: Vec<[f32; 4]> = (0..sums.pixels()).map(|i| once.indirect.at(i)).collect();
    let of_once = mean(&once, away) / mean(&first, away);
    let of_second = (mean(&found, away) - mean(&once, away)) / mean(&second, away);
    println!("two bounces {ratio:.4} of the path tracer's, the first {of_once:.4}, the second {of_second:.4}");
    assert!((ratio - 1.0).abs() < 0.03, "two bounces are {ratio} of the path tracer's");
    assert!((of_second - 1.0).abs() < 0.04, "the second bounce is {of_second} of the path tracer's");
    assert!(mean(&second, away) > 0.2 * expected, "the second bounce is too little to tell");
    finish(renderer.gpu());
}

#[test]
fn a_third_bounce_is_the_second_step_again() {
    let (scene, mut config) = closed_box(DVec3::splat(0.7));
    config.vpls.count = 1024;
    config.bounce.vpls = 2048;
    config.bounce.clusters.count = 32;
    config.bounce.count = 3;
    let mut renderer = traced(scene);
    let rendered = dump(&mut renderer, &config, 0, &["bounce/sample", "bounce/sample#2"]);
    let second: DVec3 = intensities(&rendered, "bounce/intensities").into_iter().sum();
    let third: DVec3 = intensities(&rendered, "bounce/intensities#2").into_iter().sum();
    assert!(((third / (second * 0.7)) - 1.0).abs().max_element() < 0.02, "{third} after {second}");
    let sums = reference(&mut renderer, &config, centered(3), 64);
    let picture = rendered.picture.unwrap();
    let found: Vec<[f32; 4]> = (0..sums.pixels()).map(|i| picture.indirect.at(i)).collect();
    let ratio = mean(&found, |_| true) / mean(&sums.indirect(), |_| true);
    println!("three bounces are {ratio:.4} of the path tracer's");
    assert!((ratio - 1.0).abs() < 0.05, "three bounces are {ratio} of the path tracer's");
    finish(renderer.gpu());
}

#[test]
fn every_vpl_is_in_the_cluster_nearest_to_it() {
    let (scene, mut config) = closed_box(DVec3::splat(0.5));
    let diagonal = SIZE.length();
    let mut renderer = renderer(scene);
    for (count_of_clusters, vpls, representative) in [
        (8, 256, Representative::NearestMember),
        (8, 256, Representative::Mean),
        (32, 1000, Representative::Mean),
        (64, 16, Representative::Mean),
    ] {
        config.bounce.clusters.count = count_of_clusters;
        config.vpls.count = vpls;
        config.bounce.clusters.representative = representative;
        let rendered = dump(&mut renderer, &config, 0, &["vpls/hammersley", "bounce/k-means"]);
        let points: Vec<VplPlace> = pod_collect_to_vec(dumped(&rendered, "vpls/places"));
        let lit: Vec<bool> = intensities(&rendered, "vpls/intensities").iter().map(|i| i.max_element() > 0.0).collect();
        let labels: Vec<u32> = words(dumped(&rendered, "bounce/labels")).collect();
        let clusters = clusters(&rendered);
        let place = |i: usize| (Vec3::from(points[i].position).as_dvec3(), octahedral_snorm16_inverse(points[i].normal).as_dvec3());
        let mut members = vec![Vec::new(); clusters.len()];
        for i in 0..points.len() {
            assert_eq!(lit[i], labels[i] != u32::MAX, "VPLs with light have a cluster, and they alone");
            if lit[i] {
                members[labels[i] as usize].push(i);
            }
        }
        let all = lit.iter().filter(|lit| **lit).count();
        // All clusters are in use, or as many as there are lit VPLs.
        let used = members.iter().filter(|m| !m.is_empty()).count();
        assert_eq!(used, clusters.len().min(all), "clusters without VPLs");
        let means: Vec<Option<(DVec3, DVec3)>> = members
            .iter()
            .map(|m| {
                let sum = m.iter().map(|i| place(*i)).fold((DVec3::ZERO, DVec3::ZERO), |(p, n), (q, m)| (p + q, n + m));
                (!m.is_empty()).then(|| (sum.0 / m.len() as f64, sum.1.normalize()))
            })
            .collect();
        let distance = |i: usize, (position, normal): (DVec3, DVec3)| {
            let (p, n) = place(i);
            0.6 * p.distance(position) / diagonal + 0.4 * (1.0 - n.dot(normal).max(0.0))
        };
        for (j, mean) in means.iter().enumerate() {
            let Some(mean) = *mean else { continue };
            assert_eq!(clusters[j].members as usize, members[j].len());
            for i in &members[j] {
                let nearest = means.iter().flatten().map(|mean| distance(*i, *mean)).fold(f64::INFINITY, f64::min);
                assert!(distance(*i, mean) <= nearest + 1e-4, "VPL {i} is nearer to another cluster than {j}");
            }
            let (stands, faces) = (Vec3::from(clusters[j].position).as_dvec3(), octahedral_snorm16_inverse(clusters[j].normal).as_dvec3());
            match representative {
                Representative::Mean => {
                    assert!(stands.distance(mean.0) < 1e-3 && faces.distance(mean.1) < 1e-3, "cluster {j} is not its mean")
                }
                Representative::NearestMember => {
                    let nearest = members[j].iter().map(|i| distance(*i, mean)).fold(f64::INFINITY, f64::min);
                    let own = members[j].iter().find(|i| place(**i).0.distance(stands) < 1e-6).expect("a member stands for its cluster");
                    assert!(distance(*own, mean) <= nearest + 1e-5, "cluster {j} has a member nearer to its mean");
                }
            }
        }
    }
    finish(renderer.gpu());
}

/// Distances, normals and albedos of all maps, decoded.
fn maps(rendered: &Rendered) -> (Vec<f32>, Vec<Vec3>, Vec<u8>) {
    let normals = dumped(rendered, "bounce/normals").chunks_exact(4).map(|t| {
        let part = |a, b| (f32::from(i16::from_ne_bytes([a, b])) / 32767.0).max(-1.0);
        octahedral_inverse(Vec2::new(part(t[0], t[1]), part(t[2], t[3])))
    });
    (pod_collect_to_vec(dumped(rendered, "bounce/distances")), normals.collect(), dumped(rendered, "bounce/albedos").to_vec())
}

/// Ways to fill the maps of eleven clusters, and the last pass of each.
const DRAWS: [(Layers, &str); 3] =
    [(Layers::Instanced, "bounce/draw"), (Layers::GeometryShader, "bounce/draw"), (Layers::PerLayer, "bounce/draw-11")];

#[test]
fn maps_are_the_same_however_their_layers_are_filled() {
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, ..SceneConfig::default() };
    let mut config = Config { scene: scene.clone(), ..Config::default() };
    config.frame.size = [96, 54];
    config.bounce.count = 2;
    // 11 is no multiple of the layers per instance of the geometry shader.
    config.bounce.clusters.count = 11;
    config.bounce.clusters.map_size = 64;
    let mut renderer = renderer(load_scene(&scene).unwrap().0);
    let mut filled = DRAWS.map(|(layers, pass)| {
        config.bounce.clusters.layers = layers;
        maps(&dump(&mut renderer, &config, 0, &[pass]))
    });
    let there = filled[0].0.iter().filter(|d| **d < 1.0).count();
    assert!(there > filled[0].0.len() / 4, "only {there} texels of the maps show something");
    let [first, others @ ..] = &mut filled;
    for (other, (layers, _)) in others.iter().zip(&DRAWS[1..]) {
        let color = |maps: &(Vec<f32>, Vec<Vec3>, Vec<u8>), i: usize| maps.2[8 * i..8 * i + 6].to_vec();
        let same = |i: usize| first.0[i] == other.0[i] && first.1[i] == other.1[i] && color(first, i) == color(other, i);
        let differ = (0..first.0.len()).filter(|i| !same(*i)).count();
        println!("{layers:?}: {differ} of {there} texels differ");
        assert!(differ * 1000 <= there, "{layers:?}: {differ} of {there} texels differ");
    }
    finish(renderer.gpu());
}

/// The inside of a box, seen from three clusters.
#[test]
fn maps_hold_the_distances_normals_and_colours_that_rays_find() {
    let albedos = [0.8, 0.1, 0.6, 0.9, 0.3, 0.5].map(DVec3::splat);
    let walls = walls(SIZE, albedos);
    let (_, mut config) = closed_box(DVec3::ONE);
    config.bounce.clusters.count = 3;
    let mut renderer = renderer(split_room(&walls));
    let rendered = dump(&mut renderer, &config, 0, &["bounce/k-means", "bounce/draw"]);
    let clusters = clusters(&rendered);
    let (distances, normals, colors) = maps(&rendered);
    let size = config.bounce.clusters.map_size as usize;
    let (mut worst, mut wrong, mut all) = (0.0f64, 0, 0);
    for (j, cluster) in clusters.iter().enumerate() {
        let n = octahedral_snorm16_inverse(cluster.normal);
        let (a, s) = (-1.0 / (if n.z >= 0.0 { 1.0 } else { -1.0 } + n.z), if n.z >= 0.0 { 1.0 } else { -1.0 });
        let b = n.x * n.y * a;
        let axes = [Vec3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x), Vec3::new(b, s + n.y * n.y * a, -n.y), n];
        let position = Vec3::from(cluster.position).as_dvec3();
        for t in 0..size * size {
            let p = (Vec2::new((t % size) as f32, (t / size) as f32) + 0.5) * (2.0 / size as f32) - 1.0;
            // Texels at the rim are half outside the map.
            if p.length() > 0.97 {
                continue;
            }
            let local = Vec3::new(2.0 * p.x, 2.0 * p.y, 1.0 - p.length_squared()) / (1.0 + p.length_squared());
            let along = (axes[0] * local.x + axes[1] * local.y + axes[2] * local.z).as_dvec3();
            // A ray ends at the nearest wall that faces it.
            let hit = |wall: &Wall| {
                let toward = -along.dot(wall.normal);
                (toward > 1e-6).then(|| (position - wall.corner).dot(wall.normal) / toward)
            };
            let (wall, expected) = (0..6).filter_map(|w| Some((w, hit(&walls[w])?))).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            let texel = j * size * size + t;
            let found = f64::from(distances[texel]) * SIZE.length();
            all += 1;
            let color = f16(&colors[8 * texel..]);
            let same = normals[texel].as_dvec3().dot(walls[wall].normal) > 0.999 && (f64::from(color) - albedos[wall].x).abs() < 1e-3;
            // In corners, where two walls' images meet, a texel may show the other wall.
            if same {
                worst = worst.max((found / expected - 1.0).abs());
            } else {
                wrong += 1;
            }
        }
    }
    println!("distances off by {:.4} % at most; {wrong} of {all} texels show another wall", 100.0 * worst);
    assert!(worst < 0.002, "a distance is off by {:.2} %", 100.0 * worst);
    assert!(wrong * 1000 < all, "{wrong} of {all} texels show another wall");
    finish(renderer.gpu());
}

fn f16(bytes: &[u8]) -> f32 {
    half::f16::from_ne_bytes([bytes[0], bytes[1]]).to_f32()
}

/// A board before a wall, with long, bent edges in the map of a cluster on the wall.
#[test]
fn a_board_of_two_triangles_looks_as_one_of_many_once_it_is_split() {
    let board = |cells: u32| {
        let mut scene = Scene { name: "board".into(), ..Scene::default() };
        let wall = |scene: &mut Scene| {
            let corners = [[-5.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 6.0, 0.0], [-5.0, 6.0, 0.0]];
            add_quad(scene, corners.map(Vec3::from), matte([0.5; 3]));
        };
        wall(&mut scene);
        // The board is a floor that begins a metre before the wall.
        for i in 0..cells * cells {
            let (x, z) = (f64::from(i % cells), f64::from(i / cells));
            let at = |x: f64, z: f64| Vec3::new(-4.0 + 8.0 * (x / f64::from(cells)) as f32, 0.5, 1.0 + 8.0 * (z / f64::from(cells)) as f32);
            add_quad(&mut scene, [at(x, z), at(x, z + 1.0), at(x + 1.0, z + 1.0), at(x + 1.0, z)], matte([0.9; 3]));
        }
        scene
    };
    let light = spot(Vec3::new(0.0, 3.0, 4.0), Vec3::NEG_Z, [10.0; 3], 1.0, 3.0);
    let mut config = plain([16, 16], Vec3::new(0.0, 3.0, 8.0), Vec3::new(0.0, 3.0, 0.0), 60.0, light);
    config.vpls.count = 16;
    config.bounce.count = 2;
    config.bounce.clusters.count = 1;
    let shown = |scene: Scene| {
        let mut renderer = renderer(scene);
        let rendered = dump(&mut renderer, &config, 0, &["bounce/draw"]);
        finish(renderer.gpu());
        maps(&rendered).0
    };
    let (fine, coarse) = (shown(board(64)), shown(board(1)));
    let mut split = board(1);
    split.split_triangles(0.02);
    let split = shown(split);
    let size = config.bounce.clusters.map_size as i32;
    let there = |map: &[f32], x: i32, y: i32| (0..size).contains(&x) && (0..size).contains(&y) && map[(y * size + x) as usize] < 1.0;
    // Number of texels covered in map `a` without a covered neighbour in map `b`.
    let beyond = |a: &[f32], b: &[f32]| {
        let missing = |i: i32| {
            let (x, y) = (i % size, i / size);
            there(a, x, y) && !(-1..=1).any(|dy| (-1..=1).any(|dx| there(b, x + dx, y + dy)))
        };
        (0..size * size).filter(|i| missing(*i)).count()
    };
    let covered = fine.iter().filter(|d| **d < 1.0).count();
    let (unsplit, left) = (beyond(&fine, &coarse) + beyond(&coarse, &fine), beyond(&fine, &split) + beyond(&split, &fine));
    let off = fine.iter().zip(&split).filter(|(a, b)| **a < 1.0 && **b < 1.0).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f32::max);
    println!("of {covered} texels {unsplit} are off by more than a texel, {left} once split; distances by {:.4} % at most", 100.0 * off);
    assert!(covered > 5000 && unsplit > 100, "{covered} texels covered, {unsplit} off without splitting: nothing is shown");
    assert_eq!(left, 0, "texels off by more than a texel");
    assert!(off < 0.002, "distances are off by {:.2} %", 100.0 * off);
}

/// As many clusters as VPLs: each VPL has its own map.
#[test]
fn a_cluster_of_one_vpl_sees_what_rays_see() {
    let scene = SceneConfig { builtin: Some(Builtin::Cornell), split: Some(0.02), ..SceneConfig::default() };
    let mut config = Config { scene: scene.clone(), ..Config::default() };
    config.frame.size = [160, 90];
    config.vpls.count = 24;
    config.rsm.size = [128, 128];
    config.bounce.clusters.count = 64;
    config.gather.interleave = 1.into();
    config.filter.kind = FilterKind::None;
    let mut renderer = traced(load_scene(&scene).unwrap().0);
    let mut indirect = |method| {
        config.visibility.method = method;
        let picture = picture(&mut renderer, &config);
        (0..picture.indirect.values.len() / 4).map(|i| picture.indirect.at(i)).collect::<Vec<_>>()
    };
    let [rays, maps, none] = [VisibilityMethod::RayTraced, VisibilityMethod::Clusters, VisibilityMethod::None].map(&mut indirect);
    let error = |test: &[[f32; 4]]| relmse(test, &rays);
    println!(
        "relMSE {:.5}, without shadows {:.5}; energy {:.4}",
        error(&maps),
        error(&none),
        mean(&maps, |_| true) / mean(&rays, |_| true)
    );
    assert!(error(&maps) < 0.1 * error(&none), "{} with maps, {} without shadows", error(&maps), error(&none));
    assert!((mean(&maps, |_| true) / mean(&rays, |_| true) - 1.0).abs() < 0.02);
    finish(renderer.gpu());
}

fn small_atrium() -> (Scene, Config) {
    let scene = SceneConfig { builtin: Some(Builtin::Atrium), triangles: 20_000, split: Some(0.02), ..SceneConfig::default() };
    let mut config = Config { scene: scene.clone(), ..Config::default() };
    config.frame.size = [160, 90];
    config.vpls.count = 256;
    config.vpls.sampler = VplSampler::Hammersley;
    config.visibility.method = VisibilityMethod::Clusters;
    config.bounce.count = 2;
    config.filter.kind = FilterKind::Gaussian;
    (load_scene(&scene).unwrap().0, config)
}

#[test]
fn a_still_scene_is_still_and_its_bytes_repeat() {
    let (scene, config) = small_atrium();
    let mut renderer = renderer(scene);
    let first = picture(&mut renderer, &config).radiance.values;
    for frame in 1..10 {
        let rendered = dump(&mut renderer, &config, frame, &[]);
        assert!(rendered.picture.as_ref().unwrap().radiance.values == first, "frame {frame} is another picture");
        // Clusters stay where they were, and one round of k-means confirms it.
        assert_eq!(count(&rendered, "bounce/rounds"), 1, "frame {frame}");
    }
    let mut other = config.clone();
    other.bounce.clusters.count = 7;
    picture(&mut renderer, &other);
    assert!(picture(&mut renderer, &config).radiance.values == first, "what was rendered before shows");
    finish(renderer.gpu());
}

#[test]
fn clusters_that_are_kept_flicker_less_than_ones_seeded_anew() {
    let (scene, mut config) = small_atrium();
    let walk = manylight::config::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/atrium-walk.toml")), &[]);
    config.camera = walk.unwrap_or_else(|error| panic!("{error:#}")).config.camera;
    config.frame.count = 20;
    config.gather.per_pixel.emitters = Emitters::Disks;
    // The pattern of interleaving would flicker whatever clusters do.
    config.gather.interleave = 1.into();
    let mut renderer = renderer(scene);
    let mut flicker = |centers| {
        config.bounce.clusters.centers = centers;
        let walk = flicker_of_walk(&mut renderer, &config, Intensity::Irradiance, None, &Execution::default(), &mut |_| Ok(()));
        walk.unwrap_or_else(|error| panic!("{error:#}")).flicker.flicker
    };
    let (kept, anew) = (flicker(Centers::Kept), flicker(Centers::Reseeded));
    println!("kept {kept:.5}, seeded anew {anew:.5}");
    assert!(kept < 0.5 * anew, "kept {kept}, seeded anew {anew}");
    finish(renderer.gpu());
}

#[test]
fn the_second_bounce_takes_every_way_to_find_shadows() {
    let (scene, mut config) = small_atrium();
    config.visibility.method = VisibilityMethod::RayTraced;
    let mut renderer = traced(scene);
    let mut indirect = |visibility| {
        config.bounce.visibility = visibility;
        let picture = picture(&mut renderer, &config);
        mean(&(0..160 * 90).map(|i| picture.indirect.at(i)).collect::<Vec<_>>(), |_| true)
    };
    let ways = [BounceVisibility::None, BounceVisibility::RayTraced, BounceVisibility::ImperfectShadowMaps];
    let [none, rays, maps] = ways.map(&mut indirect);
    println!("none {none:.4}, rays {rays:.4}, imperfect shadow maps {maps:.4}");
    assert!(rays < 0.97 * none, "rays {rays}, none {none}");
    assert!((maps / rays - 1.0).abs() < 0.1, "imperfect shadow maps {maps}, rays {rays}");
    finish(renderer.gpu());
}

/// Lights of every kind, one of which moves.
#[test]
fn clusters_follow_moving_lights_of_every_kind() {
    let (scene, mut config) = small_atrium();
    let moving = match spot(Vec3::new(-3.0, 3.0, 0.0), Vec3::new(0.3, -1.0, 0.2), [300.0; 3], 20.0, 60.0) {
        LightConfig::Spot { position, direction, target, intensity, inner_deg, outer_deg, .. } => {
            let key = |time, x: f32| LightKeyframe {
                time,
                position: Some([x, 3.0, 0.0]),
                direction: None,
                target: None,
                intensity: None,
                irradiance: None,
            };
            LightConfig::Spot {
                position,
                direction,
                target,
                intensity,
                inner_deg,
                outer_deg,
                keyframes: vec![key(0.0, -3.0), key(0.2, 3.0)],
            }
        }
        other => unreachable!("{other:?}"),
    };
    let point = LightConfig::Point { position: [2.0, 2.0, 1.0], intensity: [100.0; 3], keyframes: Vec::new() };
    config.light = vec![directional(Vec3::new(0.3, -1.0, 0.2), [10.0; 3]), moving, point];
    config.vpls.count = 512;
    let mut renderer = renderer(scene);
    let walk = |renderer: &mut Renderer| -> Vec<(Vec<f32>, u64)> {
        let frame = |frame| {
            let rendered = dump(renderer, &config, frame, &[]);
            assert!(count(&rendered, "bounce/lit") > 16, "frame {frame} has {} lights", count(&rendered, "bounce/lit"));
            let rounds = count(&rendered, "bounce/rounds");
            (rendered.picture.unwrap().indirect.values, rounds)
        };
        (0..7).map(frame).collect()
    };
    let (first, again) = (walk(&mut renderer), walk(&mut renderer));
    assert!(first == again, "a walk does not repeat");
    let alone = dump(&mut renderer, &config, 6, &[]).picture.unwrap().indirect.values;
    assert!(alone != first[6].0, "frames start from the one before");
    for pair in first.windows(2) {
        assert!(pair[0].0 != pair[1].0, "the light moves, and nothing changes");
        assert!(pair[1].1 <= 5, "{} rounds of k-means where five are allowed", pair[1].1);
    }
    assert!(first.iter().skip(1).any(|(_, rounds)| *rounds > 1), "no cluster has moved");
    finish(renderer.gpu());
}

/// Clusters of many VPLs: each is shadowed by the map of its representative.
#[test]
fn clusters_see_about_as_much_as_rays_do() {
    let scene = SceneConfig { builtin: Some(Builtin::Cornell), split: Some(0.02), ..SceneConfig::default() };
    let mut config = Config { scene: scene.clone(), ..Config::default() };
    config.frame.size = [160, 90];
    config.vpls.count = 256;
    let mut renderer = traced(load_scene(&scene).unwrap().0);
    let mut indirect = |method| {
        config.visibility.method = method;
        let picture = picture(&mut renderer, &config);
        (0..picture.indirect.values.len() / 4).map(|i| picture.indirect.at(i)).collect::<Vec<_>>()
    };
    let [rays, maps, none] = [VisibilityMethod::RayTraced, VisibilityMethod::Clusters, VisibilityMethod::None].map(&mut indirect);
    let energy = |test: &[[f32; 4]]| mean(test, |_| true) / mean(&rays, |_| true);
    println!("relMSE {:.5}, without shadows {:.5}; energy {:.4}", relmse(&maps, &rays), relmse(&none, &rays), energy(&maps));
    assert!(relmse(&maps, &rays) < 0.6 * relmse(&none, &rays));
    assert!((energy(&maps) - 1.0).abs() < 0.1, "energy {}", energy(&maps));
    finish(renderer.gpu());
}

fn relmse(test: &[[f32; 4]], truth: &[[f32; 4]]) -> f64 {
    let channels = test.iter().zip(truth).flat_map(|(t, r)| (0..3).map(|c| (f64::from(t[c]), f64::from(r[c]))));
    channels.map(|(t, r)| (t - r).powi(2) / (r * r + 0.01)).sum::<f64>() / (3 * truth.len()) as f64
}

/// The presets as they are, against two bounces of the path tracer.
#[test]
fn the_preset_is_nearer_to_two_bounces_than_one_bounce_of_linkes() {
    let sponza = |preset: &str| {
        let scene = "light = [{ kind = \"directional\", direction = [0.22, -1, 0.3], irradiance = [22, 20.5, 18] }]\n\
                     [camera]\nposition = [-11.5, 2.2, -0.35]\ntarget = [8, 3.6, 0.1]\nfov_y_deg = 60\n";
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sponza.toml");
        let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(preset);
        std::fs::write(&path, format!("base = {:?}\n{scene}", base.display().to_string())).unwrap();
        manylight::config::load(&path, &["frame.size=[160,90]".to_owned()]).unwrap_or_else(|error| panic!("{error:#}")).config
    };
    let builtin = |name: &str, preset: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(preset);
        let sets = [format!("scene.builtin={name}"), "frame.size=[160,90]".to_owned()];
        manylight::config::load(&path, &sets).unwrap_or_else(|error| panic!("{error:#}")).config
    };
    let mut cases: Vec<_> = ["cornell", "atrium"]
        .map(|name| {
            let configs = ["ssvp.toml", "linke.toml"].map(|preset| builtin(name, preset));
            (name, load_scene(&configs[0].scene).unwrap().0, configs)
        })
        .into();
    cases.extend(shared_scene("sponza_crytek.glb").map(|mut scene| {
        scene.split_triangles(0.02);
        ("Sponza", scene, ["ssvp.toml", "linke.toml"].map(sponza))
    }));
    for (name, scene, [ssvp, linke]) in cases {
        let mut renderer = traced(scene);
        let truth = reference(&mut renderer, &ssvp, centered(2), 256).indirect();
        let mut indirect = |config: &Config| {
            let picture = picture(&mut renderer, config);
            (0..picture.indirect.values.len() / 4).map(|i| picture.indirect.at(i)).collect::<Vec<_>>()
        };
        let (two, one) = (indirect(&ssvp), indirect(&linke));
        let energy = mean(&two, |_| true) / mean(&truth, |_| true);
        println!("{name}: relMSE {:.4}, of linke's {:.4}; energy {energy:.4}", relmse(&two, &truth), relmse(&one, &truth));
        assert!(relmse(&two, &truth) < relmse(&one, &truth), "{name}");
        assert!((energy - 1.0).abs() < 0.15, "{name}: energy {energy}");
        finish(renderer.gpu());
    }
}

/// A court, 4 m wide and 6 m deep, in a roof of 20 m: all but a twenty-fifth of the sun's light falls on the roof, and is
/// reflected into the sky.
fn court_in_a_roof(albedo: f64) -> (Scene, Config) {
    let wall = |corner: [f64; 3], u: [f64; 3], v: [f64; 3], normal: DVec3| {
        let (u, v) = (DVec3::from(u), DVec3::from(v));
        let (u, v) = if u.cross(v).dot(normal) > 0.0 { (u, v) } else { (v, u) };
        Wall { corner: corner.into(), u, v, normal, albedo: DVec3::splat(albedo) }
    };
    let mut faces = vec![
        wall([-2.0, -6.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], DVec3::Y),
        wall([-2.0, -6.0, -2.0], [0.0, 6.0, 0.0], [0.0, 0.0, 4.0], DVec3::X),
        wall([2.0, -6.0, -2.0], [0.0, 6.0, 0.0], [0.0, 0.0, 4.0], DVec3::NEG_X),
        wall([-2.0, -6.0, -2.0], [4.0, 0.0, 0.0], [0.0, 6.0, 0.0], DVec3::Z),
        wall([-2.0, -6.0, 2.0], [4.0, 0.0, 0.0], [0.0, 6.0, 0.0], DVec3::NEG_Z),
    ];
    for (x, z, width, depth) in [(-10.0, -10.0, 20.0, 8.0), (-10.0, 2.0, 20.0, 8.0), (-10.0, -2.0, 8.0, 4.0), (2.0, -2.0, 8.0, 4.0)] {
        faces.push(wall([x, 0.0, z], [width, 0.0, 0.0], [0.0, 0.0, depth], DVec3::Y));
    }
    let sun = directional(Vec3::new(0.3, -1.0, 0.2), [10.0; 3]);
    let mut config = plain([64, 64], Vec3::new(1.5, -1.0, 1.5), Vec3::new(-1.0, -6.0, -1.0), 90.0, sun);
    config.vpls.sampler = VplSampler::Hammersley;
    config.vpls.count = 256;
    config.vpls.importance = Importance::PassedFlux;
    config.bounce.count = 2;
    config.bounce.vpls = 4096;
    (split_room(&faces), config)
}

#[test]
fn importance_puts_vpls_into_the_court_and_keeps_their_light() {
    let (scene, mut config) = court_in_a_roof(0.5);
    config.bounce.count = 1;
    let mut renderer = renderer(scene);
    let mut light = |importance, pass| {
        config.vpls.importance = importance;
        let rendered = dump(&mut renderer, &config, 0, &[pass]);
        let points: Vec<VplPlace> = pod_collect_to_vec(dumped(&rendered, "vpls/places"));
        let lights: Vec<_> = points.iter().zip(intensities(&rendered, "vpls/intensities")).filter(|(_, i)| i.x > 0.0).collect();
        let sum = |lights: &[&(&VplPlace, DVec3)]| lights.iter().map(|(_, i)| i.x * PI).sum::<f64>();
        let (court, roof): (Vec<_>, Vec<_>) = lights.iter().partition(|(point, _)| point.position[1] < -0.01);
        (court.len(), sum(&court), sum(&roof))
    };
    let (even, _, _) = light(Importance::None, "vpls/hammersley");
    let (court, in_court, on_roof) = light(Importance::PassedFlux, "vpls/important");
    // Irradiance times area times albedo.
    let cosine = f64::from(Vec3::new(0.3, -1.0, 0.2).normalize().y.abs());
    let (expected_court, expected_roof) = (0.5 * 10.0 * cosine * 16.0, 0.5 * 10.0 * cosine * 384.0);
    println!(
        "in the court {court} VPLs, {even} even ones; flux {in_court:.1} of {expected_court:.1}, on the roof {on_roof:.1} of {expected_roof:.1}"
    );
    assert!(court > 100 && court > 8 * even, "{court} of 256 VPLs are in the court, {even} even ones");
    assert!((in_court / expected_court - 1.0).abs() < 0.05, "{in_court} W instead of {expected_court}");
    assert!((on_roof / expected_roof - 1.0).abs() < 0.25, "{on_roof} W instead of {expected_roof}");
    finish(renderer.gpu());
}

#[test]
fn importance_brings_the_pictures_sum_nearer_to_that_of_all_texels() {
    let (scene, mut config) = small_atrium();
    config.bounce.count = 1;
    config.visibility.method = VisibilityMethod::None;
    config.gather.interleave = 1.into();
    config.filter.kind = FilterKind::None;
    let mut renderer = renderer(scene);
    let mut indirect = |count, importance| {
        config.vpls.count = count;
        config.vpls.importance = importance;
        let picture = picture(&mut renderer, &config);
        (0..picture.indirect.values.len() / 4).map(|i| picture.indirect.at(i)).collect::<Vec<_>>()
    };
    let truth = indirect(32_768, Importance::None);
    let [few, many] = [256, 4096].map(|count| indirect(count, Importance::PassedFlux));
    let even = indirect(256, Importance::None);
    let energy = mean(&many, |_| true) / mean(&truth, |_| true);
    println!("relMSE {:.5}, of even ones {:.5}; energy of 4,096 {energy:.4}", relmse(&few, &truth), relmse(&even, &truth));
    assert!(relmse(&few, &truth) < 0.5 * relmse(&even, &truth));
    assert!((energy - 1.0).abs() < 0.01, "energy {energy}");
    finish(renderer.gpu());
}

/// In the scene's scale, the roof is close to the court's floor by place and normal.
#[test]
fn a_roofs_light_does_not_go_on_from_the_courts_clusters() {
    let (scene, mut config) = court_in_a_roof(0.5);
    let mut renderer = renderer(scene);
    let cosine = f64::from(Vec3::new(0.3, -1.0, 0.2).normalize().y.abs());
    for clusters in [1, 2, 8] {
        config.bounce.clusters.count = clusters;
        for seed in 0..4 {
            config.frame.seed = seed;
            let rendered = dump(&mut renderer, &config, 0, &["bounce/sample"]);
            let passed = intensities(&rendered, "bounce/intensities").into_iter().map(|v| v.x * PI).sum::<f64>();
            // The court's surfaces receive a part of the light that they reflect, and reflect half of it.
            let part = passed / (0.5 * 0.5 * 10.0 * cosine * 16.0);
            println!("{clusters} clusters, seed {seed}: {part:.3} of what the court's first VPLs send out meets it again");
            assert!((0.5..1.0).contains(&part), "{clusters} clusters, seed {seed}: {part}");
        }
    }
    finish(renderer.gpu());
}

/// A card just above a floor of two large triangles: neither shows through the other.
#[test]
fn what_lies_just_above_a_large_triangle_hides_it() {
    let mut scene = Scene { name: "card".into(), ..Scene::default() };
    let quad = |scene: &mut Scene, corners: [[f32; 3]; 4], albedo| add_quad(scene, corners.map(Vec3::from), matte([albedo; 3]));
    quad(&mut scene, [[-6.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 8.0, 0.0], [-6.0, 8.0, 0.0]], 0.5);
    quad(&mut scene, [[-6.0, 0.0, 0.5], [-6.0, 0.0, 9.0], [6.0, 0.0, 9.0], [6.0, 0.0, 0.5]], 0.2);
    quad(&mut scene, [[-1.0, 0.02, 3.0], [-1.0, 0.02, 5.0], [1.0, 0.02, 5.0], [1.0, 0.02, 3.0]], 0.9);
    let light = spot(Vec3::new(0.0, 3.0, 4.0), Vec3::NEG_Z, [10.0; 3], 1.0, 3.0);
    let mut config = plain([16, 16], Vec3::new(0.0, 3.0, 8.0), Vec3::new(0.0, 3.0, 0.0), 60.0, light);
    config.vpls.count = 16;
    config.bounce.count = 2;
    config.bounce.clusters.count = 1;
    let mut renderer = renderer(scene);
    let rendered = dump(&mut renderer, &config, 0, &["bounce/k-means", "bounce/draw"]);
    let place = Vec3::from(clusters(&rendered)[0].position);
    let (distances, _, colors) = maps(&rendered);
    let size = config.bounce.clusters.map_size as usize;
    let (mut card, mut other) = (0, 0);
    for t in 0..size * size {
        let p = (Vec2::new((t % size) as f32, (t / size) as f32) + 0.5) * (2.0 / size as f32) - 1.0;
        if p.length() > 0.97 || distances[t] >= 1.0 {
            continue;
        }
        // The wall faces +z: the map's axes are the world's, up to the signs of x and y.
        let local = Vec3::new(2.0 * p.x, 2.0 * p.y, 1.0 - p.length_squared()) / (1.0 + p.length_squared());
        if local.y >= 0.0 {
            continue;
        }
        let hit = place + local * ((place.y - 0.02) / -local.y);
        // Points well inside the card.
        if hit.x.abs() < 0.9 && (3.1..4.9).contains(&hit.z) {
            if (f16(&colors[8 * t..]) - 0.9).abs() < 0.01 { card += 1 } else { other += 1 }
        }
    }
    assert!(card > 200 && other == 0, "{card} texels show the card, {other} the floor below it");
    finish(renderer.gpu());
}

#[test]
fn three_bounces_go_with_every_way_to_fill_the_layers() {
    let (scene, mut config) = closed_box(DVec3::splat(0.5));
    config.bounce.count = 3;
    config.bounce.clusters.map_size = 64;
    let mut renderer = renderer(scene);
    let lit = DRAWS.map(|(layers, _)| {
        config.bounce.clusters.layers = layers;
        let rendered = dump(&mut renderer, &config, 0, &[]);
        (count(&rendered, "bounce/lit"), count(&rendered, "bounce/lit#2"))
    });
    assert!(lit.iter().all(|counts| *counts == lit[0] && counts.1 > 900), "{lit:?}");
    finish(renderer.gpu());
}
