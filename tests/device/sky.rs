//! Light of the sky: closed forms, the reference, presets, and the camera's view of it.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{self, Block, Config, FilterKind, IsmRenderer, LightConfig, SkyVisibility, SplatDepth};
use manylight::output::exr::Precision;
use manylight::output::{ExrLayer, write_exr};
use manylight::presets;
use manylight::reference::Sum;
use manylight::renderer::{Renderer, needs};
use manylight::scene::builtin::{self, Atrium};
use manylight::scene::sky::SkyMap;
use manylight::scene::{Material, Scene};
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

fn constant(radiance: [f32; 3]) -> LightConfig {
    LightConfig::Environment { radiance, map: None, rotation_deg: 0.0 }
}

fn mapped(map: &Path, rotation_deg: f32) -> LightConfig {
    LightConfig::Environment { radiance: [1.0; 3], map: Some(map.to_owned()), rotation_deg }
}

/// Writes a map of 64 x 32 texels whose colour depends on the direction.
fn write_map(folder: &Path, color: impl Fn(DVec3) -> DVec3) -> PathBuf {
    let (width, height) = (64, 32);
    let at = |x: u32, y: u32| {
        let (phi, theta) = (2.0 * PI * (f64::from(x) + 0.5) / f64::from(width), PI * (f64::from(y) + 0.5) / f64::from(height));
        color(DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin()))
    };
    let colors = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| at(x, y).as_vec3().to_array());
    let layer = ExrLayer::interleaved("", "RGB", 3, &colors.collect::<Vec<f32>>(), Precision::Float);
    let path = folder.join("sky.exr");
    write_exr(&path, width, height, vec![layer], &[]).unwrap();
    path
}

/// One half of the sky is bright, with a gradient; a lamp of some texels stands in the other.
fn uneven(w: DVec3) -> DVec3 {
    let lamp = if w.dot(DVec3::new(-0.6, 0.6, 0.5).normalize()) > 0.98 { 40.0 } else { 0.0 };
    DVec3::new(0.1 + w.x.max(0.0), 0.1 + 0.5 * (w.z + 1.0), 0.2 + lamp)
}

/// Irradiance of a map on a plane of this normal, by a fine grid of the sphere.
fn irradiance_of(map: &SkyMap, normal: DVec3) -> DVec3 {
    let n = 512;
    let grid = (0..n).flat_map(|i| (0..2 * n).map(move |k| (i, k))).map(|(i, k)| {
        let (theta, phi) = (PI * (f64::from(i) + 0.5) / f64::from(n), PI * (f64::from(k) + 0.5) / f64::from(n));
        let w = DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin());
        map.radiance(w.as_vec3()).as_dvec3() * (theta.sin() * w.dot(normal).max(0.0) * (PI / f64::from(n)).powi(2))
    });
    grid.sum()
}

/// A square of side `2 r` around a point, facing up.
fn floor(center: Vec3, r: f32) -> [Vec3; 4] {
    [[-r, r], [r, r], [r, -r], [-r, -r]].map(|[x, z]| center + Vec3::new(x, 0.0, z))
}

/// A plane of side 12 m, and a box of 2 x 3 x 2 m that stands in its middle.
fn plane_with_box(with_box: bool, material: Material) -> Scene {
    let mut scene = Scene { name: "plane".into(), ..Scene::default() };
    add_quad(&mut scene, floor(Vec3::ZERO, 6.0), material.clone());
    if with_box {
        let [a, b, c, d] = floor(Vec3::new(0.0, 3.0, 0.0), 1.0);
        let down = |v: Vec3| v - 3.0 * Vec3::Y;
        for corners in
            [[a, b, c, d], [down(a), down(b), b, a], [down(b), down(c), c, b], [down(c), down(d), d, c], [down(d), down(a), a, d]]
        {
            add_quad(&mut scene, corners, material.clone());
        }
    }
    scene
}

/// The plane as seen from above, 12 m wide in the picture's height.
fn from_above(light: LightConfig) -> Config {
    let mut config = plain([48, 48], Vec3::new(0.0, 20.0, 0.0), Vec3::ZERO, 2.0 * (0.29f32).atan().to_degrees(), light);
    config.camera.as_mut().unwrap().up = Some([0.0, 0.0, -1.0]);
    config
}

fn oblique(light: LightConfig) -> Config {
    plain([96, 64], Vec3::new(6.0, 5.0, 8.0), Vec3::new(0.0, 0.8, 0.0), 50.0, light)
}

/// The direct layer, pixel by pixel.
fn direct(renderer: &mut Renderer, config: &Config) -> Vec<Vec3> {
    picture(renderer, config).direct.rgb().collect()
}

fn energy(pixels: &[Vec3]) -> f64 {
    pixels.iter().map(|p| f64::from(p.x + p.y + p.z)).sum()
}

const ALL: [SkyVisibility; 3] = [SkyVisibility::None, SkyVisibility::RayTraced, SkyVisibility::ImperfectShadowMaps];

#[test]
fn a_plane_under_a_constant_sky_gets_pi_times_its_radiance_everywhere() {
    let albedo = 0.6f32;
    let mut renderer = traced(plane_with_box(false, matte([albedo; 3])));
    let expected = albedo * Vec3::new(1.0, 2.0, 0.5);
    for visibility in ALL {
        for (interleave, filter, seed) in [(1, FilterKind::None, 0), (4, FilterKind::Bilateral, 0), (4, FilterKind::Bilateral, 5)] {
            let mut config = from_above(constant([1.0, 2.0, 0.5]));
            config.sky.visibility = visibility;
            config.gather.interleave = interleave.into();
            config.filter.kind = filter;
            config.frame.seed = seed;
            let found = direct(&mut renderer, &config);
            // At the picture's edge the filter has not all of the sample sets.
            let inner = |i: &usize| [i % 48, i / 48].iter().all(|at| (4..44).contains(at));
            let off = |p: &Vec3| ((*p - expected) / expected).abs().max_element();
            let worst = (0..found.len()).filter(inner).map(|i| off(&found[i])).fold(0.0, f32::max);
            let mean = off(&(found.iter().sum::<Vec3>() / found.len() as f32));
            println!("{visibility:?}, interleave {interleave}, seed {seed}: off by {mean:.4}, the worst pixel by {worst:.4}");
            // Maps of points shadow the plane by itself here and there.
            let most = if visibility == SkyVisibility::ImperfectShadowMaps { (0.05, 0.2) } else { (0.01, 0.01) };
            assert!(mean < most.0 && worst < most.1, "{visibility:?}, interleave {interleave}, seed {seed}: {mean}, {worst}");
        }
    }
    finish(renderer.gpu());
}

/// VPLs on a sphere would have a parallax, and err by a third here.
#[test]
fn a_map_lights_a_plane_alike_in_the_middle_and_five_metres_off_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_map(folder.path(), uneven);
    let map = SkyMap::read(&path).unwrap();
    let mut renderer = traced(plane_with_box(false, matte([1.0; 3])));
    for rotation in [0.0, 70.0] {
        for visibility in ALL {
            let mut config = from_above(mapped(&path, rotation));
            config.sky.visibility = visibility;
            config.sky.count = 1024;
            let found = direct(&mut renderer, &config);
            // A turn about the plane's normal changes nothing on it.
            let expected = irradiance_of(&map, DVec3::Y) / PI;
            for (x, y) in [(24, 24), (4, 24), (43, 24), (24, 4), (4, 4), (43, 43)] {
                let pixel = found[y * 48 + x].as_dvec3();
                let off = ((pixel - expected) / expected).abs().max_element();
                let most = if visibility == SkyVisibility::ImperfectShadowMaps { 0.2 } else { 0.02 };
                assert!(off < most, "{visibility:?} at {x}, {y}: {pixel} instead of {expected}");
            }
        }
    }
    finish(renderer.gpu());
}

/// A wall shows which way the map is turned.
#[test]
fn a_map_is_turned_counter_clockwise_seen_from_above() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_map(folder.path(), |w| DVec3::new(w.x.max(0.0), w.z.max(0.0), 0.1));
    let map = SkyMap::read(&path).unwrap();
    let mut scene = Scene::default();
    // It faces +Z.
    add_quad(&mut scene, [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)), matte([1.0; 3]));
    let mut renderer = traced(scene);
    for rotation in [0.0f32, 90.0, -30.0] {
        let mut config = plain([8, 8], 3.0 * Vec3::Z, Vec3::ZERO, 20.0, mapped(&path, rotation));
        config.sky.visibility = SkyVisibility::None;
        config.sky.count = 1024;
        // Turned back, the wall looks elsewhere in the map.
        let normal = glam::DQuat::from_rotation_y(-f64::from(rotation).to_radians()) * DVec3::Z;
        let expected = irradiance_of(&map, normal) / PI;
        let found = direct(&mut renderer, &config)[0].as_dvec3();
        let sums = reference(&mut renderer, &config, centered(0), 256);
        let truth: Vec<f64> = (0..3).map(|c| sums.mean(Sum::Direct).iter().map(|t| f64::from(t[c])).sum::<f64>() / 64.0).collect();
        let truth = DVec3::from_slice(&truth);
        println!("{rotation} degrees: {found}, reference {truth}, expected {expected}");
        assert!((found - expected).abs().max_element() < 0.02, "{rotation}: {found} instead of {expected}");
        assert!((truth - expected).abs().max_element() < 0.02, "{rotation}: the reference has {truth} instead of {expected}");
    }
    finish(renderer.gpu());
}

#[test]
fn a_box_on_a_plane_has_the_references_direct_light() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_map(folder.path(), uneven);
    let mut renderer = traced(plane_with_box(true, matte([0.7; 3])));
    for (name, light) in [("constant", constant([1.0, 0.8, 0.6])), ("map", mapped(&path, 20.0))] {
        let mut config = oblique(light);
        config.gather.interleave = Block([4, 2]);
        config.filter.kind = FilterKind::Bilateral;
        let sums = reference(&mut renderer, &config, centered(0), 1024);
        let truth: Vec<Vec3> = sums.mean(Sum::Direct).iter().map(|t| Vec3::new(t[0], t[1], t[2])).collect();
        let mut off = |visibility, renderer_of_points, depth| {
            config.sky.visibility = visibility;
            config.visibility.ism.renderer = renderer_of_points;
            config.sky.map_size = 128;
            config.visibility.ism.splat_depth = depth;
            let found = direct(&mut renderer, &config);
            let rmse = found.iter().zip(&truth).map(|(a, b)| f64::from((*a - *b).length_squared())).sum::<f64>() / truth.len() as f64;
            let off = energy(&found) / energy(&truth) - 1.0;
            println!("{name}, {visibility:?}, {renderer_of_points:?}, {depth:?}: energy {:+.4}, rmse {:.4}", off, rmse.sqrt());
            off.abs()
        };
        assert!(off(SkyVisibility::RayTraced, IsmRenderer::SinglePixel, SplatDepth::Center) < 0.03, "{name} by rays");
        assert!(off(SkyVisibility::ImperfectShadowMaps, IsmRenderer::SinglePixel, SplatDepth::Center) < 0.08, "{name} by single pixels");
        assert!(off(SkyVisibility::ImperfectShadowMaps, IsmRenderer::Splat, SplatDepth::Center) < 0.08, "{name} by splats");
        assert!(off(SkyVisibility::ImperfectShadowMaps, IsmRenderer::Splat, SplatDepth::Plane) < 0.08, "{name} by splats' planes");
        assert!(off(SkyVisibility::None, IsmRenderer::SinglePixel, SplatDepth::Center) > 0.08, "{name}: the box throws a shadow");
    }
    finish(renderer.gpu());
}

/// Walls that face inwards alone stop the sky's light from outside, too.
#[test]
fn a_closed_room_stays_dark() {
    let size = DVec3::new(4.0, 3.0, 5.0);
    let mut renderer = traced(room(&walls(size, [DVec3::splat(0.7); 6])));
    let mut config = plain([32, 32], Vec3::new(1.0, 1.0, 1.0), Vec3::new(3.0, 1.5, 4.0), 80.0, constant([1.0; 3]));
    for (visibility, most) in [(SkyVisibility::RayTraced, 0.0), (SkyVisibility::ImperfectShadowMaps, 0.15)] {
        config.sky.visibility = visibility;
        let found = energy(&direct(&mut renderer, &config)) / (3.0 * 32.0 * 32.0 * 0.7);
        println!("{visibility:?}: {found:.4} of the open sky's light");
        assert!(found <= most, "{visibility:?}: {found}");
    }
    finish(renderer.gpu());
}

#[test]
fn metals_and_coats_reflect_the_sky_as_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_map(folder.path(), |w| DVec3::new(0.3 + w.y.max(0.0), 0.5 + 0.4 * w.x, 0.4 + 0.3 * w.z));
    let metal = |metallic: f32, roughness: f32| Material { metallic, roughness, ..matte([0.9, 0.6, 0.3]) };
    for (material, coated) in [(metal(1.0, 0.7), false), (metal(1.0, 0.4), false), (metal(0.5, 0.6), true), (metal(0.0, 0.5), true)] {
        let mut renderer = traced(plane_with_box(true, material.clone()));
        let mut config = oblique(mapped(&path, 0.0));
        config.sky.visibility = SkyVisibility::RayTraced;
        config.sky.count = 1024;
        if coated {
            config.materials.dielectric = manylight::config::Dielectric::Ggx;
        }
        let sums = reference(&mut renderer, &config, centered(0), 512);
        let truth: Vec<Vec3> = sums.mean(Sum::Direct).iter().map(|t| Vec3::new(t[0], t[1], t[2])).collect();
        let found = direct(&mut renderer, &config);
        let ratio = energy(&found) / energy(&truth);
        println!("metallic {}, roughness {}, coated {coated}: energy {ratio:.4}", material.metallic, material.roughness);
        assert!((ratio - 1.0).abs() < 0.03, "metallic {}, roughness {}: {ratio}", material.metallic, material.roughness);
        finish(renderer.gpu());
    }
}

/// The sky behind everything is the host's bilinear lookup, in frames and in references.
#[test]
fn the_camera_sees_the_map_the_right_way_round() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_map(folder.path(), |w| w * 0.5 + 0.5);
    let map = SkyMap::read(&path).unwrap();
    let mut renderer = traced(plane_with_box(false, matte([0.5; 3])));
    for (target, rotation) in [(Vec3::X, 0.0f32), (Vec3::NEG_X, 0.0), (Vec3::Z, 0.0), (Vec3::NEG_Z, 0.0), (Vec3::new(0.3, 0.8, 0.2), 50.0)]
    {
        let position = 3.0 * Vec3::Y;
        let config = plain([24, 16], position, position + target, 60.0, mapped(&path, rotation));
        let shown = picture(&mut renderer, &config);
        let sums = reference(&mut renderer, &config, centered(0), 1);
        let traced = sums.mean(Sum::Radiance);
        let view = shown.view;
        let mut seen = 0;
        for (i, (found, depth)) in shown.radiance.rgb().zip(&shown.depth.values).enumerate() {
            if *depth > 0.0 {
                continue;
            }
            seen += 1;
            let w = view.position_at(i as u32 % 24, i as u32 / 24, 1e-3) - position;
            let expected = map.radiance(glam::Quat::from_rotation_y(-rotation.to_radians()) * w);
            let truth = Vec3::new(traced[i][0], traced[i][1], traced[i][2]);
            assert!((found - expected).abs().max_element() < 2e-3, "towards {target}, pixel {i}: {found} instead of {expected}");
            assert!(
                (truth - expected).abs().max_element() < 1e-3,
                "towards {target}, pixel {i}: the reference has {truth}, not {expected}"
            );
        }
        assert!(seen > 100, "towards {target}: the sky is in the picture");
        if rotation == 0.0 {
            // A map of w / 2 + 1/2 shows the axes themselves.
            let middle = shown.radiance.rgb().nth(8 * 24 + 12).unwrap() * 2.0 - 1.0;
            assert!(middle.dot(target) > 0.9, "towards {target}: {middle}");
        }
    }
    finish(renderer.gpu());
}

/// One texel has most of the light: the reference must find it, or it would be all noise.
#[test]
fn a_reference_samples_a_small_sun() {
    let folder = tempfile::tempdir().unwrap();
    let sun = DVec3::new(0.5, 0.7, 0.4).normalize();
    let path = write_map(folder.path(), |w| DVec3::splat(if w.dot(sun) > 0.999 { 5000.0 } else { 0.2 }));
    let map = SkyMap::read(&path).unwrap();
    let mut renderer = traced(plane_with_box(false, matte([0.5; 3])));
    let config = from_above(mapped(&path, 0.0));
    let sums = reference(&mut renderer, &config, centered(1), 64);
    finish(renderer.gpu());
    let pixels = sums.mean(Sum::Direct);
    let expected = 0.5 * irradiance_of(&map, DVec3::Y).x / PI;
    let found = mean(&pixels, |_| true);
    let spread = (pixels.iter().map(|p| (f64::from(p[0]) - expected).powi(2)).sum::<f64>() / pixels.len() as f64).sqrt();
    println!("{found:.3}, expected {expected:.3}, deviation of a pixel {spread:.3}");
    assert!((found / expected - 1.0).abs() < 0.02, "{found} instead of {expected}");
    assert!(spread / expected < 0.15, "64 paths a pixel deviate by {spread} of {expected}");
}

/// Without a light that has a shadow map there are no VPLs, and no stage may mind.
#[test]
fn a_sky_alone_lights_the_scene_under_every_preset() {
    let mut renderer = traced(builtin::atrium(&Atrium { triangles: 20_000, seed: 0 }));
    let names = presets::all().into_iter().map(|(name, _)| name).filter(|name| !name.contains('/'));
    for name in names {
        let text = format!("base = \"{name}.toml\"\nframe.size = [64, 40]\n[[light]]\nkind = \"environment\"\nradiance = [1, 1, 1]\n");
        let loaded = config::parse(&text, Path::new("sky.toml"), &[]).unwrap_or_else(|error| panic!("{name}: {error:#}"));
        let config = Config { scene: Config::default().scene, camera: None, ..loaded.config };
        renderer.ensure(needs(&config)).unwrap();
        let rendered = render(&mut renderer, &config, 0);
        let shown = rendered.picture.unwrap();
        let light = energy(&shown.direct.rgb().collect::<Vec<_>>()) / (3.0 * 64.0 * 40.0);
        println!("{name}: mean direct light {light:.4}");
        assert!(light > 0.01 && light.is_finite(), "{name}: {light}");
        assert!(shown.indirect.rgb().all(|p| p == Vec3::ZERO), "{name}: a sky's light is direct");
        assert!(
            rendered.times.iter().all(|(pass, _)| !pass.starts_with("rsm") && !pass.starts_with("vpls") && !pass.starts_with("bounce"))
        );
    }
    finish(renderer.gpu());
}

/// A sky beside other lights adds its own direct light, and leaves theirs alone.
#[test]
fn a_sky_and_a_sun_add_up() {
    let mut renderer = traced(plane_with_box(true, matte([0.7; 3])));
    let sun = directional(Vec3::new(0.3, -1.0, -0.2), [3.0; 3]);
    let of = |lights: Vec<LightConfig>, renderer: &mut Renderer| {
        let mut config = oblique(sun.clone());
        config.light = lights;
        config.vpls.count = 64;
        let shown = picture(renderer, &config);
        (shown.direct.rgb().collect::<Vec<_>>(), shown.indirect.rgb().collect::<Vec<_>>())
    };
    let (of_sun, indirect) = of(vec![sun.clone()], &mut renderer);
    let (of_sky, _) = of(vec![constant([1.0; 3])], &mut renderer);
    let (of_both, indirect_of_both) = of(vec![sun.clone(), constant([1.0; 3])], &mut renderer);
    for ((a, b), both) in of_sun.iter().zip(&of_sky).zip(&of_both) {
        assert!((*a + *b - *both).abs().max_element() < 2e-3 * (1.0 + both.max_element()), "{a} and {b} are not {both}");
    }
    assert_eq!(indirect, indirect_of_both, "indirect light is the sun's alone");
    assert!(energy(&of_sky) > 0.0);
    finish(renderer.gpu());
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_one_other_directions() {
    let mut renderer = traced(plane_with_box(true, matte([0.7; 3])));
    let mut config = oblique(constant([1.0; 3]));
    config.gather.interleave = 4.into();
    for visibility in [SkyVisibility::RayTraced, SkyVisibility::ImperfectShadowMaps] {
        config.sky.visibility = visibility;
        let images: Vec<Vec<Vec3>> = [0, 0, 1]
            .map(|seed| {
                config.frame.seed = seed;
                direct(&mut renderer, &config)
            })
            .into();
        assert_eq!(images[0], images[1], "{visibility:?}");
        assert_ne!(images[0], images[2], "{visibility:?}");
    }
    finish(renderer.gpu());
}

#[test]
fn a_map_that_is_none_ends_in_one_sentence_with_its_key() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.exr");
    std::fs::write(&path, b"no picture").unwrap();
    let mut renderer = traced(plane_with_box(false, matte([0.7; 3])));
    let config = from_above(mapped(&path, 0.0));
    let error = renderer.prepare(&config, &[]).unwrap_err();
    let sentence = format!("{error:#}");
    assert!(sentence.starts_with("light.0.map: ") && sentence.contains("broken.exr: is neither an OpenEXR"), "{sentence}");
    let none = from_above(constant([0.0; 3]));
    let sentence = format!("{:#}", renderer.check(&none).unwrap_err());
    assert!(sentence.contains("no environment shines"), "{sentence}");
    finish(renderer.gpu());
}
