//! Imperfect shadow maps: content, repeatability, cost, and error against exact visibility.

use crate::common::*;
use glam::{Affine3A, Vec2, Vec3};
use manylight::config::{Builtin, Collect, Config, IsmConfig, IsmRenderer, PointSet, SceneConfig, SplatDepth, VisibilityMethod};
use manylight::graph::Execution;
use manylight::renderer::Renderer;
use manylight::report::Memory;
use manylight::scene::builder::Mesh;
use manylight::scene::source::load_scene;
use manylight::scene::{Material, Scene};

const RADIUS: f32 = 2.0;

/// An icosahedron whose triangles are split in four, five times: 20,480 triangles, seen from inside.
fn sphere(double_sided: bool) -> Scene {
    let mut triangles = icosahedron();
    for _ in 0..5 {
        let cut = |[a, b, c]: [Vec3; 3]| {
            let [d, e, f] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    let mut mesh = Mesh::default();
    for corners in triangles {
        let [a, b, c] = corners.map(|place| mesh.vertex(RADIUS * place, -place, Vec2::ZERO));
        mesh.indices.extend(if double_sided { [a, b, c] } else { [a, c, b] });
    }
    let mut scene = Scene { name: "sphere".into(), ..Scene::default() };
    let material = scene.add_material(Material { double_sided, ..matte([0.5; 3]) });
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
    scene
}

/// Triangles of an icosahedron, counter-clockwise from outside: all triples of neighbouring corners.
fn icosahedron() -> Vec<[Vec3; 3]> {
    let golden = 0.5 * (1.0 + 5f32.sqrt());
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners: Vec<Vec3> = signs
        .into_iter()
        .flat_map(|(a, b)| [Vec3::new(0.0, a, b * golden), Vec3::new(a, b * golden, 0.0), Vec3::new(b * golden, 0.0, a)])
        .collect();
    let near = |i: usize, k: usize| corners[i].distance(corners[k]) < 2.1;
    let mut triangles = Vec::new();
    for (i, k, l) in (0..12).flat_map(|i| (0..i).flat_map(move |k| (0..k).map(move |l| (i, k, l)))) {
        if near(i, k) && near(k, l) && near(l, i) {
            let [a, b, c] = [i, k, l].map(|i| corners[i].normalize());
            triangles.push(if (b - a).cross(c - a).dot(a) > 0.0 { [a, b, c] } else { [a, c, b] });
        }
    }
    triangles
}

fn maps_of_points(config: &mut Config) {
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
}

#[test]
fn the_map_of_a_sphere_has_no_hole_and_the_spheres_radius() {
    for double_sided in [false, true] {
        for points in [PointSet::Uniform, PointSet::Adaptive] {
            let mut scene = sphere(double_sided);
            // One VPL in the middle, on a small square that faces up.
            let corners = [[-0.05, 0.05], [0.05, 0.05], [0.05, -0.05], [-0.05, -0.05]].map(|[x, z]| Vec3::new(x, 0.0, z));
            add_quad(&mut scene, corners, matte([0.8; 3]));
            let light = spot(0.25 * Vec3::Y, Vec3::NEG_Y, [1.0; 3], 3.0, 5.0);
            let mut config = plain([16, 16], Vec3::new(0.0, 0.5, 1.5), Vec3::ZERO, 60.0, light);
            config.vpls.count = 1;
            maps_of_points(&mut config);
            config.visibility.ism.points = points;
            config.visibility.ism.point_count = 80_000;
            let mut renderer = renderer(scene);
            let rendered = dump(&mut renderer, &config, 0, &["visibility/push-0"]);
            let far = renderer.world().device().bounds.size().length();
            let map: Vec<f32> = words(dumped(&rendered, "visibility/maps")).map(f32::from_bits).collect();
            let side = 64;
            let (mut holes, mut worst) = (0, 0f32);
            for (i, depth) in map.iter().enumerate() {
                let p = (Vec2::new((i % side) as f32, (i / side) as f32) + 0.5) * (2.0 / side as f32) - 1.0;
                // Occluders less than two degrees above the VPL's own surface cast no shadow.
                if p.length() < 0.965 {
                    holes += u32::from(*depth == 1.0);
                    worst = worst.max((depth * far / RADIUS - 1.0).abs());
                }
            }
            assert!(holes == 0 && worst < 0.03, "{points:?}, both sides {double_sided}: {holes} holes, {worst} off");
            finish(renderer.gpu());
        }
    }
}

/// Mean relative error of distances in a VPL's map of a plane that recedes from it, and the share of empty texels.
fn slanted(change: impl Fn(&mut IsmConfig)) -> (f32, f32) {
    let mut scene = Scene::default();
    // The plane rises from low over the VPL on the left, up and away to the right.
    let corners = [[-1.0, 0.4, 4.0], [-1.0, 0.4, -4.0], [6.0, 3.9, -4.0], [6.0, 3.9, 4.0]].map(Vec3::from_array);
    add_quad(&mut scene, corners, Material { double_sided: true, ..matte([0.5; 3]) });
    let small = [[-0.05, 0.05], [0.05, 0.05], [0.05, -0.05], [-0.05, -0.05]].map(|[x, z]| Vec3::new(x, 0.0, z));
    add_quad(&mut scene, small, matte([0.8; 3]));
    let light = spot(0.25 * Vec3::Y, Vec3::NEG_Y, [1.0; 3], 3.0, 5.0);
    let mut config = plain([16, 16], Vec3::new(0.0, 0.5, 1.5), Vec3::ZERO, 60.0, light);
    config.vpls.count = 1;
    maps_of_points(&mut config);
    config.visibility.ism.point_count = 20_000;
    change(&mut config.visibility.ism);
    let pass = if config.visibility.ism.renderer == IsmRenderer::Splat { "visibility/splat-distances" } else { "visibility/push-0" };
    let mut renderer = renderer(scene);
    let rendered = dump(&mut renderer, &config, 0, &[pass]);
    let far = renderer.world().device().bounds.size().length();
    let plane = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let (mut errors, mut holes) = (Vec::new(), 0);
    for (i, depth) in words(dumped(&rendered, "visibility/maps")).map(f32::from_bits).enumerate() {
        let p = (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.5) * (2.0 / 64.0) - 1.0;
        // The axes of the VPL's space, whose normal is +Y, as in `basis_of` of glsl/lib/basis.glsl.
        let w = Vec3::new(2.0 * p.x, 1.0 - p.length_squared(), -2.0 * p.y) / (1.0 + p.length_squared());
        let d = corners[0].dot(plane) / w.dot(plane);
        let at = w * d;
        // Only texels well inside the plane's edges count.
        if d > 0.0 && at.x > -0.8 && at.x < 5.0 && at.z.abs() < 3.2 && p.length() < 0.95 {
            if depth == 1.0 {
                holes += 1;
            } else {
                errors.push((depth * far / d - 1.0).abs());
            }
        }
    }
    assert!(errors.len() > 500, "{} texels of the plane", errors.len());
    finish(renderer.gpu());
    (errors.iter().sum::<f32>() / errors.len() as f32, holes as f32 / (holes + errors.len()) as f32)
}

#[test]
fn where_normals_are_kept_a_slanted_planes_map_runs_as_the_plane() {
    let (without, _) = slanted(|_| {});
    let (with, holes) = slanted(|ism| ism.normals = true);
    println!("off by {without} without and {with} with normals, {holes} of it holes");
    assert!(with < 0.001 && with < 0.1 * without && holes < 0.03, "off by {without} without, {with} with normals, {holes} of it holes");
}

#[test]
fn splats_with_their_planes_depths_run_as_a_slanted_plane() {
    let splats = |depth| move |ism: &mut IsmConfig| (ism.renderer, ism.splat_depth, ism.enlarge) = (IsmRenderer::Splat, depth, Some(2.2));
    let (center, _) = slanted(splats(SplatDepth::Center));
    let (plane, holes) = slanted(splats(SplatDepth::Plane));
    println!("off by {center} with their middle's depth and {plane} with their plane's, {holes} of it holes");
    assert!(plane < 0.002 && plane < 0.1 * center && holes < 0.03, "off by {center} and {plane}, {holes} of it holes");
}

/// A small built-in scene with its own light.
fn builtin(builtin: Builtin) -> (Scene, Config) {
    let scene = SceneConfig { builtin: Some(builtin), triangles: 20_000, ..SceneConfig::default() };
    let mut config = Config { scene: scene.clone(), ..Config::default() };
    config.frame.size = [160, 90];
    config.vpls.count = 256;
    maps_of_points(&mut config);
    config.visibility.ism.point_count = 326_000 / 4;
    (load_scene(&scene).unwrap().0, config)
}

#[test]
fn bytes_repeat_whatever_the_points_and_the_renderer() {
    let (scene, config) = builtin(Builtin::Atrium);
    let mut renderer = renderer(scene);
    for (points, collect, kind) in [
        (PointSet::Uniform, Collect::Compute, IsmRenderer::SinglePixel),
        (PointSet::Uniform, Collect::Tessellation, IsmRenderer::SinglePixel),
        (PointSet::Adaptive, Collect::Compute, IsmRenderer::SinglePixel),
        (PointSet::Uniform, Collect::Compute, IsmRenderer::Splat),
        (PointSet::Uniform, Collect::Stored, IsmRenderer::SinglePixel),
        (PointSet::Uniform, Collect::Stored, IsmRenderer::Splat),
    ] {
        let mut config = config.clone();
        (config.visibility.ism.points, config.visibility.ism.collect, config.visibility.ism.renderer) = (points, collect, kind);
        // With normals, points may tie, and their order could show.
        config.visibility.ism.normals = points == PointSet::Adaptive;
        let pass = if kind == IsmRenderer::Splat { "visibility/splat-distances" } else { "visibility/push-0" };
        let mut frame = |i| {
            let rendered = dump(&mut renderer, &config, i, &[pass]);
            let maps = dumped(&rendered, "visibility/maps").to_vec();
            let picture = rendered.picture.unwrap();
            (maps, picture.image, picture.irradiance.values)
        };
        let first = frame(0);
        // The scene is still: all ten pictures are equal.
        for i in 1..10 {
            assert!(frame(i) == first, "{points:?}, {collect:?}, {kind:?}: frame {i} differs");
        }
    }
    finish(renderer.gpu());
}

/// relMSE of the indirect layer against exact visibility of the same VPLs, and the ratio of mean luminances, averaged over
/// seeds: one a truth.
fn against_rays(renderer: &mut Renderer, config: &Config, truths: &[Vec<[f32; 4]>]) -> (f64, f64) {
    let (mut relmse, mut energy) = (0.0, 0.0);
    for (seed, truth) in (0..).zip(truths) {
        let test = indirect(renderer, &with_seed(config, seed));
        let channels = || test.iter().zip(truth).flat_map(|(t, r)| (0..3).map(|c| (f64::from(t[c]), f64::from(r[c]))));
        relmse += channels().map(|(t, r)| (t - r).powi(2) / (r * r + 0.01)).sum::<f64>() / (3 * test.len()) as f64;
        let luminance = |p: &[[f32; 4]]| p.iter().map(|p| f64::from(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])).sum::<f64>();
        energy += luminance(&test) / luminance(truth);
    }
    (relmse / truths.len() as f64, energy / truths.len() as f64)
}

fn with_seed(config: &Config, seed: u32) -> Config {
    let mut config = config.clone();
    config.frame.seed = seed;
    config
}

fn indirect(renderer: &mut Renderer, config: &Config) -> Vec<[f32; 4]> {
    let picture = picture(renderer, config);
    (0..(picture.size[0] * picture.size[1]) as usize).map(|i| picture.indirect.at(i)).collect()
}

/// The indirect layer by exact visibility, for each of some seeds.
fn truths(renderer: &mut Renderer, config: &Config, seeds: u32) -> Vec<Vec<[f32; 4]>> {
    let mut config = config.clone();
    config.visibility.method = VisibilityMethod::RayTraced;
    (0..seeds).map(|seed| indirect(renderer, &with_seed(&config, seed))).collect()
}

#[test]
fn light_is_as_much_as_with_exact_visibility() {
    for scene in [Builtin::Cornell, Builtin::Atrium] {
        let (host, config) = builtin(scene);
        let mut renderer = traced(host);
        let truths = truths(&mut renderer, &config, 2);
        let mut none = config.clone();
        none.visibility.method = VisibilityMethod::None;
        let (unshadowed, without) = against_rays(&mut renderer, &none, &truths);
        let methods = [
            (PointSet::Uniform, IsmRenderer::SinglePixel, 0.1),
            (PointSet::Adaptive, IsmRenderer::SinglePixel, 0.1),
            (PointSet::Uniform, IsmRenderer::Splat, 0.2),
        ];
        let mut errors = Vec::new();
        for (points, kind, tolerance) in methods {
            let mut config = config.clone();
            (config.visibility.ism.points, config.visibility.ism.renderer) = (points, kind);
            let (relmse, energy) = against_rays(&mut renderer, &config, &truths);
            println!(
                "{scene:?} {points:?} {kind:?}: relmse {relmse:.5}, energy {energy:.4}; without shadows {unshadowed:.5}, {without:.4}"
            );
            assert!((energy - 1.0).abs() < tolerance, "{scene:?} {points:?} {kind:?}: energy {energy}");
            assert!(relmse < 0.7 * unshadowed, "{scene:?} {points:?} {kind:?}: {relmse}, without shadows {unshadowed}");
            errors.push(relmse);
        }
        let [uniform, adaptive, splats] = errors[..] else { unreachable!() };
        assert!(adaptive < uniform && uniform < splats, "{scene:?}: adaptive {adaptive}, uniform {uniform}, splats {splats}");
        // The rest of the small atrium's error is at contacts, which maps of this size cannot resolve.
        if scene == Builtin::Cornell {
            assert!(uniform < 0.5 * splats, "{scene:?}: {uniform}, splats {splats}");
        }
        finish(renderer.gpu());
    }
}

#[test]
fn single_pixels_of_adaptive_points_err_half_as_much_as_splats_at_most() {
    let mut config = Config::default();
    config.frame.size = [240, 135];
    maps_of_points(&mut config);
    config.vpls.count = 1024;
    config.visibility.ism.point_count = 326_000;
    let mut renderer = traced(load_scene(&config.scene).unwrap().0);
    let truths = truths(&mut renderer, &config, 1);
    let mut error = |points, kind| {
        let mut config = config.clone();
        (config.visibility.ism.points, config.visibility.ism.renderer) = (points, kind);
        against_rays(&mut renderer, &config, &truths).0
    };
    let adaptive = error(PointSet::Adaptive, IsmRenderer::SinglePixel);
    let splats = error(PointSet::Uniform, IsmRenderer::Splat);
    println!("adaptive {adaptive:.4}, splats {splats:.4}");
    assert!(adaptive < 0.5 * splats, "adaptive {adaptive}, splats {splats}");
    finish(renderer.gpu());
}

#[test]
fn more_points_and_then_larger_maps_are_nearer_to_exact_visibility() {
    let (host, mut config) = builtin(Builtin::Cornell);
    config.vpls.count = 64;
    let mut renderer = traced(host);
    // One seed: the VPLs of others are at contacts, whose error no number of points lessens.
    let truths = truths(&mut renderer, &config, 1);
    let base = 326_000 * 64 / 1024;
    let mut errors = Vec::new();
    for times in [1, 4, 16] {
        config.visibility.ism.point_count = base * times;
        errors.push(against_rays(&mut renderer, &config, &truths).0);
    }
    println!("points x1, x4, x16: {errors:?}");
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "points x1, x4, x16: {errors:?}");
    // A map of four times as many texels needs four times as many points; otherwise the points limit the error.
    config.visibility.ism.point_count = base * 128;
    let mut errors = Vec::new();
    for size in [32, 64, 128] {
        config.visibility.ism.map_size = size;
        errors.push(against_rays(&mut renderer, &config, &truths).0);
    }
    println!("maps of 32, 64, 128: {errors:?}");
    assert!(errors[0] > errors[1] && errors[1] > errors[2], "maps of 32, 64, 128: {errors:?}");
    finish(renderer.gpu());
}

/// The thesis's figure 5.5: VPLs on a wall right behind a drape, in a room otherwise lit only by leaks past it.
fn drape() -> (Scene, Config) {
    let mut scene = Scene { name: "drape".into(), ..Scene::default() };
    let quad = |scene: &mut Scene, corners: [[f32; 3]; 4]| add_quad(scene, corners.map(Vec3::from_array), matte([0.7; 3]));
    // Faces of the room, inwards: floor, ceiling, left, right, back and front.
    quad(&mut scene, [[0.0, 0.0, 0.0], [0.0, 0.0, 6.0], [6.0, 0.0, 6.0], [6.0, 0.0, 0.0]]);
    quad(&mut scene, [[0.0, 4.0, 0.0], [6.0, 4.0, 0.0], [6.0, 4.0, 6.0], [0.0, 4.0, 6.0]]);
    quad(&mut scene, [[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 4.0, 6.0], [0.0, 0.0, 6.0]]);
    quad(&mut scene, [[6.0, 0.0, 0.0], [6.0, 0.0, 6.0], [6.0, 4.0, 6.0], [6.0, 4.0, 0.0]]);
    quad(&mut scene, [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 4.0, 0.0], [0.0, 4.0, 0.0]]);
    quad(&mut scene, [[0.0, 0.0, 6.0], [0.0, 4.0, 6.0], [6.0, 4.0, 6.0], [6.0, 0.0, 6.0]]);
    // A folded drape, 30 cm before the back wall, open below.
    let mut mesh = Mesh::default();
    let (across, down) = (48, 24);
    let corner = |i: u32, j: u32| {
        let (u, v) = (i as f32 / across as f32, j as f32 / down as f32);
        Vec3::new(6.0 * u, 0.8 + 3.2 * v, 0.3 + 0.03 * (u * 60.0).sin())
    };
    for (i, j) in (0..across).flat_map(|i| (0..down).map(move |j| (i, j))) {
        mesh.quad([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)], [Vec2::ZERO; 4]);
    }
    let material = scene.add_material(Material { double_sided: true, ..matte([0.5; 3]) });
    scene.add_mesh(&mesh, material, &[Affine3A::IDENTITY]);
    // The light shines along the wall from the side.
    let light = spot(Vec3::new(0.3, 2.6, 0.2), Vec3::new(1.0, -0.1, -0.07), [60.0; 3], 8.0, 20.0);
    let mut config = plain([96, 64], Vec3::new(5.0, 2.0, 5.5), Vec3::new(2.0, 1.2, 0.0), 70.0, light);
    config.vpls.count = 256;
    config.rsm.size = [128, 128];
    config.gather.min_distance = 0.3;
    maps_of_points(&mut config);
    config.visibility.ism.point_count = 326_000 / 4;
    (scene, config)
}

#[test]
fn adaptive_points_hold_light_back_that_shines_from_right_behind_a_drape() {
    let (host, mut config) = drape();
    let mut renderer = traced(host);
    let truths = truths(&mut renderer, &config, 3);
    let mut found = Vec::new();
    // Points are compared at equal numbers in total and, with one map per point, at equal numbers drawn.
    for (points, collected) in [(PointSet::Uniform, None), (PointSet::Adaptive, None), (PointSet::Adaptive, Some(1))] {
        (config.visibility.ism.points, config.visibility.ism.collected) = (points, collected);
        let (relmse, energy) = against_rays(&mut renderer, &config, &truths);
        println!("{points:?} {collected:?}: relmse {relmse:.6}, energy {energy:.3}");
        found.push((relmse, (energy - 1.0).abs()));
    }
    for adaptive in &found[1..] {
        assert!(adaptive.0 < 0.5 * found[0].0 && adaptive.1 < 0.65 * found[0].1, "adaptive {adaptive:?}, uniform {:?}", found[0]);
    }
    finish(renderer.gpu());
}

#[test]
fn a_full_partition_is_counted_told_of_and_drawn_by_nobody() {
    let (host, mut config) = builtin(Builtin::Cornell);
    let mut renderer = renderer(host);
    config.visibility.ism.capacity = Some(320);
    let mut frame = || dump(&mut renderer, &config, 0, &["visibility/push-0"]);
    let (first, second) = (frame(), frame());
    let count = |name: &str| count(&first, name);
    assert!(count("visibility/dropped-points") > 0 && count("visibility/drawn-points") > 0);
    assert_eq!(first.counts, second.counts);
    assert_eq!(dumped(&first, "visibility/maps"), dumped(&second, "visibility/maps"));
    let [warning] = first.warnings().try_into().unwrap();
    assert!(warning.contains("visibility.ism.capacity") && warning.contains(&count("visibility/dropped-points").to_string()), "{warning}");
    finish(renderer.gpu());
}

#[test]
fn the_maps_take_no_more_memory_than_the_thesiss() {
    let (host, mut config) = builtin(Builtin::Cornell);
    config.vpls.count = 1024;
    config.visibility.ism.point_count = 326_000;
    let mut renderer = renderer(host);
    for points in [PointSet::Uniform, PointSet::Adaptive] {
        config.visibility.ism.points = points;
        let rendered = renderer.render(&config, 0, false, &Execution::default()).unwrap();
        assert!(rendered.warnings().is_empty(), "{:?}", rendered.warnings());
        let bytes = Memory::of(&rendered.memory).stages["visibility"];
        println!("{points:?}: {bytes} bytes");
        assert!(bytes <= 79 << 20, "{points:?}: {bytes} bytes");
    }
    finish(renderer.gpu());
}
