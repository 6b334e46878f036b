//! The path tracer against closed forms, the rasterized frame, and itself.

use crate::common::*;
use glam::{Affine3A, DVec3, Vec2, Vec3};
use manylight::config::{Config, LightConfig, Shadows, VisibilityMethod};
use manylight::graph::Execution;
use manylight::reference::{Settings, Sum, Sums, Tracer};
use manylight::renderer::Renderer;
use manylight::scene::builder::Mesh;
use manylight::scene::builtin::{self, Atrium};
use manylight::scene::{Filter, Map, Material, Scene, Texture};

const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);

fn no_light() -> LightConfig {
    LightConfig::Environment { radiance: [0.0; 3], map: None, rotation_deg: 0.0 }
}

fn emitting(albedo: f32, emission: f32) -> Material {
    Material { emission: [emission; 3], ..matte([albedo; 3]) }
}

fn scene_of(quads: &[([Vec3; 4], Material)]) -> Scene {
    let mut scene = Scene::default();
    quads.iter().for_each(|(corners, material)| add_quad(&mut scene, *corners, material.clone()));
    scene
}

/// A square of side `2 r` around a point, facing up.
fn floor(center: Vec3, r: f32) -> [Vec3; 4] {
    [[-r, r], [r, r], [r, -r], [-r, -r]].map(|[x, z]| center + Vec3::new(x, 0.0, z))
}

/// All six walls of a box emit E and reflect `albedo`: radiance is E / (1 - albedo) everywhere.
#[test]
fn a_furnace_glows_by_its_closed_form() {
    for (albedo, bounces_traced) in [(0.5f32, 12), (0.7, 24), (0.9, 60)] {
        let mut scene = room(&walls(SIZE, [DVec3::splat(albedo.into()); 6]));
        for material in &mut scene.materials {
            material.emission = [0.2, 0.3, 0.4];
        }
        let mut renderer = traced(scene);
        let config = plain([16, 16], Vec3::new(1.0, 1.0, 1.0), Vec3::new(3.0, 2.0, 4.0), 70.0, no_light());
        let sums = reference(&mut renderer, &config, bounces(bounces_traced), 1024);
        finish(renderer.gpu());
        for (channel, emission) in [0.2, 0.3, 0.4].into_iter().enumerate() {
            let expected = emission / f64::from(1.0 - albedo);
            let found = sums.mean(Sum::Radiance).iter().map(|t| f64::from(t[channel])).sum::<f64>() / sums.pixels() as f64;
            println!("albedo {albedo}: {found:.5}, expected {expected:.5}");
            assert!((found / expected - 1.0).abs() < 0.01, "albedo {albedo}: {found} instead of {expected}");
        }
        // Each bounce is the albedo times the one before.
        let layers: Vec<f64> = [Sum::Direct, Sum::Bounce(1), Sum::Bounce(2)].map(|l| mean(&sums.mean(l), |_| true)).into();
        for pair in layers.windows(2) {
            assert!((pair[1] / pair[0] / f64::from(albedo) - 1.0).abs() < 0.02, "albedo {albedo}: {layers:?}");
        }
    }
}

#[test]
fn light_of_each_kind_arrives_as_its_unit_says() {
    let albedo = 0.6f32;
    let mut renderer = traced(scene_of(&[(floor(Vec3::ZERO, 50.0), matte([albedo; 3]))]));
    let spot_at = |x: f32| spot(Vec3::new(x, 2.0, 0.0), Vec3::NEG_Y, [5.0, 6.0, 7.0], 20.0, 40.0);
    let point = LightConfig::Point { position: [0.0, 2.0, 0.0], intensity: [5.0, 6.0, 7.0], keyframes: Vec::new() };
    let per_pi = f64::from(albedo) / std::f64::consts::PI;
    let slanted = Vec3::new(0.6, -0.8, 0.0);
    let cases: [(&str, Vec<LightConfig>, f64); 6] = [
        ("directional", vec![directional(Vec3::NEG_Y, [5.0, 6.0, 7.0])], 5.0 * per_pi),
        ("slanted", vec![directional(slanted, [5.0, 6.0, 7.0])], 4.0 * per_pi),
        ("spot", vec![spot_at(0.0)], 5.0 / 4.0 * per_pi),
        ("point", vec![point], 5.0 / 4.0 * per_pi),
        // The middle of the falloff, 30 degrees off the axis.
        ("falloff", vec![spot_at(2.0 * 30f32.to_radians().tan())], 5.0 * 0.5 * 30f64.to_radians().cos().powi(3) / 4.0 * per_pi),
        (
            "environment",
            vec![LightConfig::Environment { radiance: [5.0, 6.0, 7.0], map: None, rotation_deg: 0.0 }],
            5.0 * f64::from(albedo),
        ),
    ];
    for (name, light, expected) in cases {
        let mut config = plain([8, 8], Vec3::new(0.0, 1.0, 0.0), Vec3::ZERO, 1.0, no_light());
        config.camera.as_mut().unwrap().up = Some([1.0, 0.0, 0.0]);
        config.light = light;
        let sums = reference(&mut renderer, &config, bounces(1), 16);
        let direct = sums.mean(Sum::Direct);
        let found = direct.iter().map(|t| f64::from(t[0])).sum::<f64>() / direct.len() as f64;
        println!("{name}: {found:.6}, expected {expected:.6}");
        assert!((found / expected - 1.0).abs() < 2e-3, "{name}: {found} instead of {expected}");
        assert!((f64::from(direct[0][2] / direct[0][0]) - 1.4).abs() < 1e-3, "{name}: colours");
        assert_eq!(mean(&sums.indirect(), |_| true), 0.0, "{name}: a plane has no indirect light");
        assert!(sums.mean(Sum::Radiance).iter().all(|t| t[3] == 1.0), "{name}: the plane covers every pixel");
    }
    finish(renderer.gpu());
}

/// A small square lamp over a floor, with both sampling strategies combined: the form factor times its radiance.
#[test]
fn an_emitting_surface_lights_by_its_form_factor() {
    // The lamp is the floor's square flipped to face down.
    let r = 0.5f32;
    let mut lamp = floor(Vec3::new(0.0, 2.0, 0.0), r);
    lamp.reverse();
    for double_sided in [false, true] {
        let lamp_material = Material { double_sided, ..emitting(0.0, 3.0) };
        let mut renderer = traced(scene_of(&[(floor(Vec3::ZERO, 50.0), matte([0.5; 3])), (lamp, lamp_material)]));
        let config = plain([8, 8], Vec3::new(0.0, 1.0, 0.6), Vec3::new(0.0, 0.0, 0.0), 2.0, no_light());
        let sums = reference(&mut renderer, &config, bounces(0), 512);
        finish(renderer.gpu());
        // Below the middle of a square, the form factor is four times that of a quarter.
        let a = f64::from(r) / 2.0;
        let quarter = 2.0 / std::f64::consts::TAU * (a / (1.0 + a * a).sqrt() * (a / (1.0 + a * a).sqrt()).atan());
        let expected = 0.5 * 3.0 * 4.0 * quarter;
        let found = mean(&sums.mean(Sum::Direct), |_| true);
        println!("{found:.5}, expected {expected:.5}");
        assert!((found / expected - 1.0).abs() < 0.01, "{found} instead of {expected}");
        let all = mean(&sums.mean(Sum::Radiance), |_| true);
        assert!((all / found - 1.0).abs() < 1e-6, "all light is direct: {all}, {found}");
    }
}

/// A texture of two columns, one of which is a hole.
fn half_open() -> (Scene, Material) {
    let mut scene = Scene::default();
    let texels = [[255, 255, 255, 255], [255, 255, 255, 0]].concat();
    let texture = scene.add_texture(Texture { name: "holes".into(), width: 2, height: 1, srgb: true, texels });
    let map = Map { filter: Filter::Nearest, ..Map::new(texture) };
    let material = Material { base_color_map: Some(map), alpha_cutoff: Some(0.5), double_sided: true, ..matte([0.8; 3]) };
    (scene, material)
}

#[test]
fn the_holes_of_a_glowing_surface_do_not_glow() {
    let (mut scene, material) = half_open();
    add_quad(&mut scene, floor(Vec3::ZERO, 50.0), matte([0.5; 3]));
    let mut mesh = Mesh::default();
    mesh.quad(floor(Vec3::new(0.0, 2.0, 0.0), 0.5), [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO]);
    let lamp = scene.add_material(Material { emission: [3.0; 3], base_color: [0.0, 0.0, 0.0, 1.0], ..material });
    scene.add_mesh(&mesh, lamp, &[Affine3A::IDENTITY]);
    let mut renderer = traced(scene);
    let config = plain([8, 8], Vec3::new(0.0, 1.0, 0.6), Vec3::ZERO, 2.0, no_light());
    let sums = reference(&mut renderer, &config, bounces(0), 1024);
    finish(renderer.gpu());
    // Half the light of the whole square, below its middle.
    let a = 0.25f64;
    let quarter = 2.0 / std::f64::consts::TAU * (a / (1.0 + a * a).sqrt() * (a / (1.0 + a * a).sqrt()).atan());
    let (found, expected) = (mean(&sums.mean(Sum::Direct), |_| true), 0.5 * 3.0 * 2.0 * quarter);
    println!("{found:.5}, expected {expected:.5}");
    assert!((found / expected - 1.0).abs() < 0.015, "{found} instead of {expected}");
}

#[test]
fn rays_pass_through_masked_texels_and_stop_at_the_others() {
    let (mut scene, material) = half_open();
    add_quad(&mut scene, floor(Vec3::ZERO, 2.0), matte([0.5; 3]));
    // A canopy, open where u > 1/2, at positive x.
    let mut mesh = Mesh::default();
    mesh.quad(floor(Vec3::new(0.0, 1.0, 0.0), 2.0), [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO]);
    let canopy = scene.add_material(material);
    scene.add_mesh(&mesh, canopy, &[Affine3A::IDENTITY]);
    let mut renderer = traced(scene);
    let mut config = plain([32, 16], Vec3::new(0.0, 3.0, 0.0), Vec3::ZERO, 60.0, directional(Vec3::NEG_Y, [3.0; 3]));
    config.camera.as_mut().unwrap().up = Some([0.0, 0.0, -1.0]);
    let tracer = Tracer::new(&mut renderer, &config, bounces(0), None).unwrap();
    let heights: Vec<f32> = tracer.features(&mut renderer).unwrap().positions.iter().map(|p| p[1]).collect();
    let sums = reference(&mut renderer, &config, bounces(0), 16);
    // From above, the floor is seen and lit through the holes. From below the canopy, it is lit under the holes and dark elsewhere.
    for y in 0..16 {
        for x in [10usize, 14, 17, 21] {
            let expected = if x < 16 { 1.0 } else { 0.0 };
            assert!((heights[y * 32 + x] - expected).abs() < 1e-5, "pixel {x}, {y}: a height of {}", heights[y * 32 + x]);
            let (albedo, found) = (if x < 16 { 0.8 } else { 0.5 }, sums.mean(Sum::Direct)[y * 32 + x][0]);
            let expected = albedo / std::f32::consts::PI * 3.0;
            assert!((found / expected - 1.0).abs() < 1e-4, "pixel {x}, {y}: {found} instead of {expected}");
        }
    }
    config.camera.as_mut().unwrap().position = Some([0.0, 0.5, 1.9]);
    config.camera.as_mut().unwrap().target = Some([0.0, 0.0, 0.0]);
    let below = reference(&mut renderer, &config, bounces(0), 16).mean(Sum::Direct);
    finish(renderer.gpu());
    assert_eq!((below[15 * 32 + 4][0], below[15 * 32 + 14][0]), (0.0, 0.0), "in the shadow");
    assert!(below[15 * 32 + 18][0] > 0.4 && below[15 * 32 + 28][0] > 0.4, "under the holes: {:?}", below[15 * 32 + 18]);
}

#[test]
fn the_camera_looks_through_the_back_of_a_single_sided_wall_and_light_ends_there() {
    for double_sided in [false, true] {
        let lid = Material { double_sided, ..matte([0.5; 3]) };
        let mut above = floor(Vec3::new(0.0, 1.0, 0.0), 1.0);
        above.reverse(); // it faces down
        let mut renderer = traced(scene_of(&[(floor(Vec3::ZERO, 1.0), matte([0.5; 3])), (above, lid)]));
        let mut config = plain([8, 8], Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO, 20.0, directional(Vec3::NEG_Y, [1.0; 3]));
        config.camera.as_mut().unwrap().up = Some([0.0, 0.0, -1.0]);
        let tracer = Tracer::new(&mut renderer, &config, bounces(1), None).unwrap();
        let features = tracer.features(&mut renderer).unwrap();
        let sums = reference(&mut renderer, &config, bounces(1), 16);
        finish(renderer.gpu());
        let middle = features.positions[4 * 8 + 4];
        assert_eq!(middle[1], if double_sided { 1.0 } else { 0.0 }, "the camera sees a height of {}", middle[1]);
        let direct = mean(&sums.mean(Sum::Direct), |_| true);
        // The lid's back is lit if it is double-sided, and shadows the floor in any case.
        assert_eq!(direct > 0.0, double_sided, "direct light of {direct}");
    }
}

#[test]
fn what_the_middle_of_a_pixel_shows_is_what_the_rasterizer_draws() {
    let mut scene = builtin::atrium(&Atrium { triangles: 20_000, seed: 0 });
    // Leaves are made opaque, since their holes differ in the rasterizer's mips.
    scene.materials.iter_mut().for_each(|material| material.alpha_cutoff = None);
    let mut renderer = traced(scene);
    let mut config =
        plain([96, 54], Vec3::new(-9.5, 2.2, -0.4), Vec3::new(8.0, 3.6, 0.0), 60.0, directional(Vec3::new(0.2, -1.0, 0.3), [5.0; 3]));
    config.rsm.size = [64, 64];
    config.vpls.count = 64;
    let picture = picture(&mut renderer, &config);
    let tracer = Tracer::new(&mut renderer, &config, bounces(0), None).unwrap();
    let features = tracer.features(&mut renderer).unwrap();
    finish(renderer.gpu());
    let (positions, normals, distances) = (picture.positions(), picture.normals(), picture.distances());
    let (mut same, mut normals_same) = (0, 0);
    for i in 0..positions.len() {
        let ([nx, ny, nz, z], [x, y, z_world, surface]) = (features.normals_and_distances[i], features.positions[i]);
        // The rasterizer moves corners by up to 1/256 of a pixel, which is a distance on slanted surfaces.
        let near = (z - distances[i]).abs() < 1e-3 * (1.0 + z) && (surface > 0.0) == (distances[i] > 0.0);
        if near && (surface == 0.0 || positions[i].distance(Vec3::new(x, y, z_world)) < 1e-3 * (1.0 + z)) {
            same += 1;
            normals_same += usize::from(surface == 0.0 || normals[i].dot(Vec3::new(nx, ny, nz)) > 0.99);
        }
    }
    let (share, of_normals) = (f64::from(same) / positions.len() as f64, normals_same as f64 / f64::from(same));
    println!("{:.2} % of the pixels show the same place, {:.2} % of these the same normal", share * 100.0, of_normals * 100.0);
    // The rasterizer filters normal maps.
    assert!(share > 0.995, "only {share} of the pixels show the same place");
    assert!(of_normals > 0.9, "only {of_normals} of the normals are the same");
}

/// One bounce in an empty convex box, from all texels of the map: no visibility test is needed.
#[test]
fn one_bounce_vpls_in_an_empty_box_are_the_path_tracers_first_bounce() {
    const EDGE: f32 = 0.5;
    let albedos = [[0.8, 0.2, 0.1], [0.1, 0.7, 0.3], [0.6, 0.6, 0.6], [0.9, 0.8, 0.7], [0.3, 0.4, 0.9], [0.5, 0.5, 0.2]];
    let walls = walls(SIZE, albedos.map(DVec3::from));
    let mut renderer = traced(room(&walls));
    let light = spot(Vec3::new(1.8, 2.6, 2.2), Vec3::new(0.2, -1.0, 0.1), [20.0, 15.0, 10.0], 25.0, 55.0);
    let mut config = plain([40, 40], Vec3::new(3.6, 1.7, 4.6), Vec3::new(1.0, 1.2, 0.5), 90.0, light);
    config.rsm.size = [128, 128];
    config.vpls.count = 128 * 128;
    let picture = picture(&mut renderer, &config);

    let truth = reference(&mut renderer, &config, centered(1), 1536).mean(Sum::Bounce(1));
    finish(renderer.gpu());
    let (positions, normals) = (picture.positions(), picture.normals());
    let away = |i: &usize| {
        let (x, n) = (positions[*i].as_dvec3(), normals[*i].as_dvec3());
        walls.iter().all(|wall| wall.normal.dot(n) > 0.9 || (x - wall.corner).dot(wall.normal) > f64::from(EDGE))
    };
    let pixels: Vec<usize> = (0..positions.len()).filter(away).collect();
    assert!(pixels.len() > 500);
    let found: Vec<Vec3> = picture.indirect.rgb().collect();
    let (mut sum, mut true_sum, mut squares) = (0.0, 0.0, 0.0);
    for i in &pixels {
        for k in 0..3 {
            let (found, truth) = (f64::from(found[*i][k]), f64::from(truth[*i][k]));
            sum += found;
            true_sum += truth;
            squares += (found - truth).powi(2) / (truth * truth + 1e-4);
        }
    }
    let relative = squares / (3.0 * pixels.len() as f64);
    println!("mean ratio {:.4}, relative MSE {relative:.5}", sum / true_sum);
    assert!((sum / true_sum - 1.0).abs() < 0.01, "mean ratio {}", sum / true_sum);
    assert!(relative < 0.002, "relative MSE {relative}");
}

/// Ray-traced VPLs of all texels of a 128 x 128 map against the first bounce; the reference is traced with and without the
/// least distance.
fn compare_ray_traced(name: &str, renderer: &mut Renderer, config: &mut Config, samples: u32) {
    config.rsm.size = [128, 128];
    config.vpls.count = 128 * 128;
    config.gather.interleave = 1.into();
    config.gather.min_distance = 0.3;
    config.visibility.method = VisibilityMethod::RayTraced;
    // Irradiance, since a few pixels' albedos are noise: paths read single texels, the rasterizer their means.
    let found = picture(renderer, config);
    let found: Vec<[f32; 4]> = (0..found.depth.values.len()).map(|i| found.irradiance.at(i)).collect();
    let bounded = reference(renderer, config, Settings { min_distance: 0.3, ..centered(1) }, samples);
    let free = reference(renderer, config, centered(1), samples);
    let mean_of = |sums: &Sums| mean(&sums.mean(Sum::Irradiance), |_| true);
    let ratio = mean(&found, |_| true) / mean_of(&bounded);
    let cost = mean_of(&bounded) / mean_of(&free);
    println!("{name}: VPLs by rays to paths, both bounded at 0.3 m: {ratio:.4}; the bound leaves {cost:.4} of the light");
    assert!((ratio - 1.0).abs() < 0.02, "{name}: the VPLs' light is {ratio} of the paths'");
    assert!(cost < 1.0 && cost > 0.6, "{name}: the bound leaves {cost}");
    // Visibility matters: without the test there is more light.
    config.visibility.method = VisibilityMethod::None;
    let open = picture(renderer, config);
    let open: Vec<[f32; 4]> = (0..open.depth.values.len()).map(|i| open.irradiance.at(i)).collect();
    assert!(mean(&open, |_| true) > 1.02 * mean(&found, |_| true), "{name}: nothing was hidden");
}

#[test]
fn all_texels_seen_by_rays_are_the_first_bounce_in_the_cornell_box() {
    let mut renderer = traced(builtin::cornell());
    let light = spot(Vec3::new(0.0, 5.4, 0.3), Vec3::NEG_Y, [45.0, 40.0, 32.0], 50.0, 75.0);
    let mut config = plain([24, 24], Vec3::new(0.0, 2.74, 10.9), Vec3::new(0.0, 2.74, 0.0), 37.0, light);
    compare_ray_traced("cornell", &mut renderer, &mut config, 2048);
    finish(renderer.gpu());
}

#[test]
fn all_texels_seen_by_rays_are_the_first_bounce_in_the_atrium() {
    let mut scene = builtin::atrium(&Atrium { triangles: 20_000, seed: 0 });
    // The map does not see the lanterns' light.
    scene.materials.iter_mut().for_each(|material| material.emission = [0.0; 3]);
    let mut renderer = traced(scene);
    let light = directional(Vec3::new(0.22, -1.0, 0.3), [22.0, 20.5, 18.0]);
    let mut config = plain([32, 18], Vec3::new(-9.5, 2.2, -0.4), Vec3::new(8.0, 3.6, 0.0), 60.0, light);
    compare_ray_traced("atrium", &mut renderer, &mut config, 1024);
    finish(renderer.gpu());
}

/// Direct light by a shadow map of high resolution, with single comparisons.
fn mapped(renderer: &mut Renderer, config: &mut Config) -> Vec<[f32; 4]> {
    config.direct.shadows = Shadows::PercentageCloser;
    config.direct.blur = 0;
    config.rsm.size = [4096, 4096];
    let picture = picture(renderer, config);
    (0..picture.depth.values.len()).map(|i| picture.direct.at(i)).collect()
}

#[test]
fn direct_light_is_the_path_tracers() {
    let sun = || directional(Vec3::new(0.22, -1.0, 0.3), [22.0, 20.5, 18.0]);
    let mut atrium = builtin::atrium(&Atrium { triangles: 20_000, seed: 0 });
    atrium.materials.iter_mut().for_each(|material| material.emission = [0.0; 3]);
    let cornell_light = spot(Vec3::new(0.0, 5.4, 0.3), Vec3::NEG_Y, [45.0, 40.0, 32.0], 50.0, 75.0);
    let cornell = plain([256, 256], Vec3::new(0.0, 2.74, 10.9), Vec3::new(0.0, 2.74, 0.0), 37.0, cornell_light);
    let court = plain([384, 216], Vec3::new(-9.5, 2.2, -0.4), Vec3::new(8.0, 3.6, 0.0), 60.0, sun());
    let sponza = plain([480, 270], Vec3::new(-11.5, 2.2, -0.35), Vec3::new(8.0, 3.6, 0.1), 60.0, sun());
    let mut cases = vec![("cornell", builtin::cornell(), cornell), ("atrium", atrium, court)];
    cases.extend(shared_scene("sponza_crytek.glb").map(|scene| ("Sponza", scene, sponza)));
    for (name, scene, mut config) in cases {
        config.vpls.count = 64;
        config.direct.shadows = Shadows::RayTraced;
        let mut renderer = traced(scene);
        let found = picture(&mut renderer, &config);
        let sums = reference(&mut renderer, &config, centered(0), 4);
        finish(renderer.gpu());
        let found: Vec<[f32; 4]> = (0..found.depth.values.len()).map(|i| found.direct.at(i)).collect();
        let truth = sums.mean(Sum::Direct);
        let ratio = mean(&found, |_| true) / mean(&truth, |_| true);
        println!("{name}: direct light by rays is {ratio:.4} of the path tracer's");
        assert!((ratio - 1.0).abs() < 0.01, "{name}: the direct light is {ratio} of the path tracer's");
        // With the map, only edges of shadows differ: pixels lit in both are equal.
        let mapped = mapped(&mut renderer, &mut config);
        let lit = |i: usize| truth[i][..3].iter().sum::<f32>() > 0.0 && mapped[i][..3].iter().sum::<f32>() > 0.0;
        let of_lit = mean(&mapped, lit) / mean(&truth, lit);
        let agree = |i: &usize| (mapped[*i][1] - found[*i][1]).abs() <= 0.02 * found[*i][1].max(0.02);
        let same = (0..truth.len()).filter(agree).count() as f64 / truth.len() as f64;
        let all = mean(&mapped, |_| true) / mean(&truth, |_| true);
        println!("{name}: by a map {all:.4}, where both are lit {of_lit:.4}; {:.1} % of the pixels are as by rays", same * 100.0);
        finish(renderer.gpu());
        assert!((of_lit - 1.0).abs() < 0.03 && same > 0.85, "{name}: {of_lit} where both are lit, {same} of the pixels");
    }
}

#[test]
fn the_error_halves_with_four_times_the_samples_and_the_variance_says_so() {
    let mut renderer = traced(builtin::cornell());
    let light = spot(Vec3::new(0.0, 5.4, 0.3), Vec3::NEG_Y, [45.0, 40.0, 32.0], 50.0, 75.0);
    let mut config = plain([48, 48], Vec3::new(0.0, 2.74, 10.9), Vec3::new(0.0, 2.74, 0.0), 37.0, light);
    let mut errors = Vec::new();
    for samples in [16, 64, 256, 1024] {
        // Two runs of different seeds differ by the square root of two times the error of each.
        let [one, other] = [1, 2].map(|seed| {
            config.frame.seed = seed;
            reference(&mut renderer, &config, bounces(2), samples)
        });
        let (a, b) = (one.mean(Sum::Radiance), other.mean(Sum::Radiance));
        let squares: f64 = a.iter().zip(&b).flat_map(|(a, b)| (0..3).map(move |k| f64::from(a[k] - b[k]).powi(2))).sum();
        let rmse = (squares / (3.0 * a.len() as f64) / 2.0).sqrt();
        let claimed = [&one, &other].map(|sums| sums.variance().iter().flatten().map(|v| f64::from(*v)).sum::<f64>()).iter().sum::<f64>();
        let claimed = (claimed / (6.0 * a.len() as f64)).sqrt();
        println!("{samples} samples: off by {rmse:.6}, by the variance {claimed:.6}");
        assert!((rmse / claimed - 1.0).abs() < 0.1, "{samples} samples: off by {rmse}, by the variance {claimed}");
        errors.push(rmse);
    }
    finish(renderer.gpu());
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 2.0 - 1.0).abs() < 0.1, "{errors:?}");
    }
}

#[test]
fn paths_are_the_same_however_the_work_is_cut_up() {
    let mut renderer = traced(builtin::cornell());
    let light = spot(Vec3::new(0.0, 5.4, 0.3), Vec3::NEG_Y, [45.0, 40.0, 32.0], 50.0, 75.0);
    let mut config = plain([40, 72], Vec3::new(0.0, 2.74, 10.9), Vec3::new(0.0, 2.74, 0.0), 37.0, light);
    let whole = reference(&mut renderer, &config, bounces(2), 6);
    for rows in [8, 72] {
        let mut tracer = Tracer::new(&mut renderer, &config, bounces(2), None).unwrap();
        for _ in 0..6 {
            tracer.rows_at_once = rows;
            tracer.sample(&mut renderer, &Execution::default()).unwrap();
        }
        assert!(tracer.sums(&mut renderer).unwrap() == whole, "{rows} rows at once give other sums");
    }
    // A run is stopped, read back, and resumed.
    let half = reference(&mut renderer, &config, bounces(2), 2);
    let mut tracer = Tracer::new(&mut renderer, &config, bounces(2), Some(&half)).unwrap();
    for _ in 0..4 {
        tracer.sample(&mut renderer, &Execution::default()).unwrap();
    }
    assert!(tracer.sums(&mut renderer).unwrap() == whole, "a resumed run differs from one that was not stopped");
    config.frame.seed = 1;
    assert!(reference(&mut renderer, &config, bounces(2), 6) != whole, "another seed takes other paths");
    // More bounces leave earlier ones unchanged.
    config.frame.seed = 0;
    let more = reference(&mut renderer, &config, bounces(3), 6);
    finish(renderer.gpu());
    for layer in [Sum::Direct, Sum::Bounce(1), Sum::Bounce(2)] {
        assert!(more.layer(layer) == whole.layer(layer), "{layer:?}");
    }
}

#[test]
fn a_sun_that_is_in_shadow_takes_no_lamp_its_samples() {
    // A roof keeps a strong sun off a floor, which a weak lamp under it lights.
    let shaded = [(floor(Vec3::ZERO, 4.0), matte([0.5; 3])), (floor(Vec3::new(0.0, 3.0, 0.0), 40.0), matte([0.5; 3]))];
    let mut renderer = traced(scene_of(&shaded));
    let lamp = spot(Vec3::new(0.0, 2.0, 0.0), Vec3::NEG_Y, [2.0; 3], 60.0, 75.0);
    let sun = directional(Vec3::new(0.1, -1.0, 0.0), [500.0; 3]);
    let mut config = plain([32, 32], Vec3::new(0.0, 1.5, 1.0), Vec3::ZERO, 60.0, lamp);
    let alone = reference(&mut renderer, &config, centered(0), 1).mean(Sum::Direct);
    config.light.push(sun);
    let beside = reference(&mut renderer, &config, centered(0), 64).mean(Sum::Direct);
    finish(renderer.gpu());
    let ratio = mean(&beside, |_| true) / mean(&alone, |_| true);
    assert!((ratio - 1.0).abs() < 0.03, "the lamp has {ratio} of its light beside a sun");
    // A sample is the lamp's with a probability of a quarter at least.
    let dark = beside.iter().zip(&alone).filter(|(beside, alone)| alone[0] > 0.0 && beside[0] == 0.0).count();
    assert_eq!(dark, 0, "pixels never met the lamp in 64 samples");
}
