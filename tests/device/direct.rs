//! Direct light against its formulas.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{Config, LightConfig, Shadows};
use manylight::output::Picture;
use manylight::renderer::Renderer;
use manylight::scene::{Light, Scene, SpotFalloff};
use std::f64::consts::PI;

const ALBEDO: [f32; 3] = [0.5, 0.25, 0.75];
const SHADOWS: [Shadows; 3] = [Shadows::None, Shadows::Variance, Shadows::PercentageCloser];
/// Relative step of a half-float, since a device may round down on storing one, and a little for the arithmetic.
const ROUNDING: f64 = 1.0 / 1024.0 + 5e-5;
/// Error of a device's acos and cos, radians.
const ANGLE: f64 = 1e-4;

/// A square of side 8 around the origin, facing `up`.
fn plane(up: Vec3) -> Scene {
    let mut scene = Scene { name: "plane".into(), ..Scene::default() };
    let u = up.any_orthonormal_vector() * 4.0;
    let v = up.cross(u);
    add_quad(&mut scene, [-u - v, u - v, u + v, -u + v], matte(ALBEDO));
    scene
}

fn seen_from(eye: Vec3, light: LightConfig) -> Config {
    plain([96, 96], eye, Vec3::ZERO, 40.0, light)
}

/// Compares each pixel's direct light with the expected value at its position, up to rounding and, for spot lights, a given
/// radiance.
fn compare(what: &str, picture: &Picture, expected: impl Fn(DVec3) -> DVec3, slack: f64) {
    let mut worst: f64 = 0.0;
    for (x, found) in picture.positions().into_iter().zip(picture.direct.rgb()) {
        let expected = expected(x.as_dvec3());
        let error = ((found.as_dvec3() - expected).abs() / (expected * ROUNDING + slack)).max_element();
        assert!(error <= 1.0, "{what}: at {x}: {found} instead of {expected}");
        worst = worst.max(error);
    }
    println!("{what}: {worst:.2} of what is allowed");
}

fn shaded(renderer: &mut Renderer, config: &Config, shadows: Shadows) -> Picture {
    let mut config = config.clone();
    config.direct.shadows = shadows;
    picture(renderer, &config)
}

#[test]
fn a_plane_in_the_sun_is_as_bright_as_albedo_over_pi_times_irradiance_times_cosine() {
    for up in [Vec3::Y, Vec3::new(0.3, 0.9, 0.2).normalize()] {
        let mut renderer = renderer(plane(up));
        let direction = Vec3::new(0.4, -1.0, -0.3).normalize();
        let irradiance = [3.0, 2.0, 1.0];
        let config = seen_from(up * 5.0 + Vec3::new(1.5, 0.0, 1.0), directional(direction, irradiance));
        let cosine = -up.as_dvec3().dot(direction.as_dvec3());
        let radiance = Vec3::from(ALBEDO).as_dvec3() / PI * Vec3::from(irradiance).as_dvec3() * cosine;
        for shadows in SHADOWS {
            compare(&format!("{shadows:?}"), &shaded(&mut renderer, &config, shadows), |_| radiance, 0.0);
        }
        finish(renderer.gpu());
    }
}

/// Radiance of the plane under a spot at (0, 3, 0) that shines down, with the falloff over the angle to its axis.
fn under_spot(intensity: DVec3, falloff: impl Fn(f64) -> f64) -> impl Fn(DVec3) -> DVec3 {
    move |x| {
        let d = x - DVec3::new(0.0, 3.0, 0.0);
        let cosine = -d.y / d.length();
        Vec3::from(ALBEDO).as_dvec3() / PI * intensity * falloff(cosine.acos()) * (cosine / d.length_squared())
    }
}

#[test]
fn a_spot_light_falls_off_with_the_squared_distance_and_linearly_with_the_angle() {
    let mut renderer = renderer(plane(Vec3::Y));
    let intensity = [30.0, 20.0, 10.0];
    let light = spot(Vec3::Y * 3.0, Vec3::NEG_Y, intensity, 12.0, 30.0);
    let config = seen_from(Vec3::new(1.0, 6.0, 1.5), light);
    let expected = under_spot(Vec3::from(intensity).as_dvec3(), |angle| linear_falloff(angle, 12.0 * PI / 180.0, 30.0 * PI / 180.0));
    // The light's edge is in the picture, where the error is that of the device's angle.
    let peak = expected(DVec3::ZERO).max_element();
    let slack = peak * ANGLE / 18f64.to_radians();
    let unshadowed = shaded(&mut renderer, &config, Shadows::None);
    compare("None", &unshadowed, &expected, slack);
    assert!(unshadowed.direct.rgb().any(|l| l == Vec3::ZERO) && unshadowed.direct.rgb().any(|l| l.x > 0.9 * peak as f32));
    for shadows in [Shadows::Variance, Shadows::PercentageCloser] {
        compare(&format!("{shadows:?}"), &shaded(&mut renderer, &config, shadows), &expected, slack);
    }
    // At twice the distance the axis gets a quarter of the light.
    let far = picture(&mut renderer, &seen_from(Vec3::new(1.0, 6.0, 1.5), spot(Vec3::Y * 6.0, Vec3::NEG_Y, intensity, 12.0, 30.0)));
    let middle = 48 * 96 + 48;
    let ratio = unshadowed.direct.at(middle)[0] / far.direct.at(middle)[0];
    assert!((ratio - 4.0).abs() < 0.01, "{ratio}");
    finish(renderer.gpu());
}

#[test]
fn a_spot_light_of_a_gltf_file_falls_off_with_the_squared_cosine_term_of_its_extension() {
    let mut scene = plane(Vec3::Y);
    let (inner, outer) = (10.0f64.to_radians(), 32.0f64.to_radians());
    scene.lights.push(Light::Spot {
        position: Vec3::Y * 3.0,
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(25.0),
        inner: inner as f32,
        outer: outer as f32,
        falloff: SpotFalloff::CosineSquared,
    });
    let mut renderer = renderer(scene);
    let mut config = seen_from(Vec3::new(1.0, 6.0, 1.5), directional(Vec3::NEG_Y, [1.0; 3]));
    config.light.clear();
    let expected =
        under_spot(DVec3::splat(25.0), |angle| ((angle.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0).powi(2));
    let peak = expected(DVec3::ZERO).max_element();
    compare("None", &picture(&mut renderer, &config), &expected, peak * ANGLE);
    finish(renderer.gpu());
}

#[test]
fn a_point_light_shines_alike_through_the_seams_of_its_six_maps() {
    let mut renderer = renderer(plane(Vec3::Y));
    let light = LightConfig::Point { position: [0.0, 1.0, 0.0], intensity: [9.0; 3], keyframes: Vec::new() };
    let expected = |x: DVec3| {
        let d = x - DVec3::Y;
        Vec3::from(ALBEDO).as_dvec3() / PI * 9.0 * (-d.y / d.length()) / d.length_squared()
    };
    let config = plain([96, 96], Vec3::new(0.0, 7.0, 0.01), Vec3::ZERO, 40.0, light);
    compare("None", &picture(&mut renderer, &config), expected, 0.0);
    finish(renderer.gpu());
}

#[test]
fn a_point_under_a_blocker_is_dark_and_one_beside_it_is_lit() {
    let mut scene = plane(Vec3::Y);
    let corner = |x: f32, z: f32| Vec3::new(x, 1.0, z);
    let blocker = matte([0.5; 3]);
    add_quad(
        &mut scene,
        [corner(-0.6, 0.6), corner(0.6, 0.6), corner(0.6, -0.6), corner(-0.6, -0.6)],
        manylight::scene::Material { double_sided: true, ..blocker },
    );
    let mut renderer = renderer(scene);
    let lights = [
        directional(Vec3::new(0.2, -1.0, 0.0), [3.0; 3]),
        spot(Vec3::new(0.0, 4.0, 0.0), Vec3::NEG_Y, [30.0; 3], 30.0, 40.0),
        LightConfig::Point { position: [0.0, 4.0, 0.0], intensity: [30.0; 3], keyframes: Vec::new() },
    ];
    for light in lights {
        // The camera is below the blocker's height, so that the plane under it is in the picture.
        let config = plain([128, 128], Vec3::new(0.0, 0.7, 3.5), Vec3::new(0.0, 0.0, 0.0), 50.0, light.clone());
        let open = shaded(&mut renderer, &config, Shadows::None);
        for shadows in [Shadows::Variance, Shadows::PercentageCloser] {
            let picture = shaded(&mut renderer, &config, shadows);
            let (mut dark, mut lit) = (0, 0);
            for (i, x) in picture.positions().into_iter().enumerate() {
                if picture.depth.values[i] <= 0.0 || x.y > 1e-3 {
                    continue;
                }
                // Point where the path to the light crosses the blocker's height.
                let crossing = match &light {
                    LightConfig::Directional { .. } => x + Vec3::new(-0.2, 1.0, 0.0),
                    _ => x + (Vec3::new(0.0, 4.0, 0.0) - x) * 0.25,
                };
                let outside = crossing.x.abs().max(crossing.z.abs()) - 0.6;
                let (found, full) = (picture.direct.at(i)[0], open.direct.at(i)[0]);
                if outside < -0.15 {
                    dark += 1;
                    assert!(found <= full * 0.02, "{shadows:?}: at {x} under the blocker there is {found} of {full}");
                } else if outside > 0.15 {
                    lit += 1;
                    assert!((found - full).abs() <= full * 0.002, "{shadows:?}: at {x} beside the blocker there is {found} of {full}");
                }
            }
            assert!(dark > 200 && lit > 500, "{dark} dark and {lit} lit pixels were looked at");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_scene_without_a_camera_is_framed_and_a_spot_far_outside_of_it_lights_it() {
    for shadows in [Shadows::None, Shadows::Variance, Shadows::PercentageCloser] {
        let mut scene = Scene::default();
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        add_quad(&mut scene, [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], matte([0.5; 3]));
        let mut renderer = renderer(scene);
        // The light is fifteen metres over a square whose diagonal is less than three.
        let light = spot(Vec3::new(0.0, 15.0, 0.0), Vec3::NEG_Y, [225.0; 3], 10.0, 12.0);
        let mut config = plain([64, 64], Vec3::Y, Vec3::ZERO, 60.0, light);
        config.camera = None;
        config.direct.shadows = shadows;
        let picture = picture(&mut renderer, &config);
        let surface: Vec<usize> = (0..64 * 64).filter(|i| picture.depth.values[*i] > 0.0).collect();
        assert!(surface.len() > 600, "{} pixels show the square", surface.len());
        let direct: Vec<Vec3> = picture.direct.rgb().collect();
        for i in surface {
            // 225 W/sr at 15 m give 1 W/m^2, and a little less towards the corners.
            let expected = 0.5 / std::f32::consts::PI;
            assert!(direct[i].x > expected * 0.97 && direct[i].x < expected * 1.01, "{shadows:?}: {} for {expected}", direct[i].x);
        }
        finish(renderer.gpu());
    }
}

#[test]
fn an_empty_room_has_no_shadows_however_its_walls_slope_to_the_light() {
    use glam::DVec3 as V;
    let mut renderer = renderer(room(&walls(V::new(4.0, 3.0, 5.0), [V::splat(0.5); 6])));
    let lights = [
        spot(Vec3::new(2.1, 2.9, 2.4), Vec3::NEG_Y, [40.0; 3], 60.0, 79.0),
        spot(Vec3::new(0.3, 2.0, 0.4), Vec3::new(1.0, -0.3, 0.8), [40.0; 3], 20.0, 70.0),
    ];
    for light in lights {
        let mut config = plain([64, 64], Vec3::new(3.6, 1.7, 4.6), Vec3::new(1.0, 1.2, 0.5), 95.0, light);
        config.direct.shadows = Shadows::None;
        let open = picture(&mut renderer, &config);
        // Windows are small: a wide one reaches around the room's corners, where it rightly finds nearer walls.
        for shadows in [Shadows::Variance, Shadows::PercentageCloser] {
            for blur in [0, 1] {
                (config.direct.shadows, config.direct.blur) = (shadows, blur);
                let shaded = picture(&mut renderer, &config);
                let sum = |picture: &Picture| picture.direct.rgb().map(|c| f64::from(c.x)).sum::<f64>();
                let ratio = sum(&shaded) / sum(&open);
                println!("{shadows:?}, blur {blur}: {ratio:.5}");
                assert!((ratio - 1.0).abs() < 0.01, "{shadows:?} with blur {blur} keeps {ratio} of the light");
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_plane_at_a_grazing_angle_does_not_shadow_itself_however_wide_the_filter() {
    let mut scene = Scene::default();
    let corner = |x: f32, z: f32| Vec3::new(10.0 * x, 0.0, 10.0 * z);
    add_quad(&mut scene, [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], matte([0.5; 3]));
    let mut renderer = renderer(scene);
    for degrees in [30.0f32, 60.0, 75.0, 85.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(0.8 * sine, -cosine, 0.6 * sine);
        let mut config = plain([64, 64], Vec3::new(0.0, 4.0, 0.1), Vec3::ZERO, 60.0, directional(direction, [10.0; 3]));
        config.rsm.size = [256, 256];
        config.direct.shadows = Shadows::None;
        let open = picture(&mut renderer, &config);
        for shadows in [Shadows::Variance, Shadows::PercentageCloser] {
            for blur in [0, 1, 8] {
                (config.direct.shadows, config.direct.blur) = (shadows, blur);
                let shaded = picture(&mut renderer, &config);
                let least = shaded.direct.rgb().zip(open.direct.rgb()).map(|(a, b)| a.x / b.x).fold(f32::INFINITY, f32::min);
                assert!(least > 0.99, "{shadows:?}, blur {blur}, {degrees} degrees: a pixel keeps {least} of its light");
            }
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_shadow_map_of_its_own_shadows_as_the_reflective_map_does_that_covers_everything() {
    // The atrium has leaves with holes.
    let atrium = manylight::scene::builtin::atrium(&manylight::scene::builtin::Atrium { triangles: 20_000, seed: 0 });
    let mut renderer = renderer(atrium);
    let lights = [
        directional(Vec3::new(0.3, -1.0, 0.2), [3.0; 3]),
        spot(Vec3::new(0.0, 6.0, 0.0), Vec3::NEG_Y, [30.0; 3], 30.0, 60.0),
        LightConfig::Point { position: [3.0, 4.0, 0.0], intensity: [30.0; 3], keyframes: Vec::new() },
    ];
    for several in [&lights[..1], &lights[1..2], &lights[..]] {
        let mut config = plain([96, 64], Vec3::new(-8.0, 2.0, 0.5), Vec3::new(8.0, 2.5, 0.0), 65.0, several[0].clone());
        config.light = several.to_vec();
        for shadows in [Shadows::Variance, Shadows::PercentageCloser] {
            (config.rsm.size, config.rsm.bounds, config.direct.map_size) = ([256, 192], None, None);
            let shared = shaded(&mut renderer, &config, shadows);
            assert!(shared.direct.values.iter().any(|value| *value > 0.0), "nothing is lit");
            config.direct.map_size = Some([256, 192]);
            let own = shaded(&mut renderer, &config, shadows);
            assert!(own.direct.values == shared.direct.values, "{shadows:?}: the same map gives other shadows");
            // Neither the reflective map's size nor its box matters any more.
            config.rsm.size = [64, 32];
            config.rsm.bounds = Some(manylight::config::BoxConfig { min: [-1.0, 0.0, -1.0], max: [1.0, 1.0, 1.0] });
            let own = shaded(&mut renderer, &config, shadows);
            assert!(own.direct.values == shared.direct.values, "{shadows:?}: the reflective map still shadows");
            config.direct.map_size = None;
            let narrow = shaded(&mut renderer, &config, shadows);
            assert!(narrow.direct.values != shared.direct.values, "{shadows:?}: the reflective map does not shadow");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn maps_larger_than_the_device_allows_are_refused_by_the_name_of_their_key() {
    let renderer = renderer(plane(Vec3::Y));
    let light = directional(Vec3::NEG_Y, [1.0; 3]);
    let fine = plain([16, 16], Vec3::new(0.0, 4.0, 4.0), Vec3::ZERO, 60.0, light);
    renderer.check(&fine).unwrap();
    for (key, change) in [
        ("rsm.size", (|config: &mut Config| config.rsm.size = [16, 1 << 20]) as fn(&mut Config)),
        ("direct.map_size", |config| config.direct.map_size = Some([1 << 20, 16])),
    ] {
        let mut config = fine.clone();
        config.direct.shadows = Shadows::PercentageCloser;
        change(&mut config);
        let error = renderer.check(&config).unwrap_err().to_string();
        assert!(error.starts_with(key) && error.contains("is over the"), "{error}");
    }
    finish(renderer.gpu());
}
