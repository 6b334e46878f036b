//! Screen-space ambient occlusion against results computed by hand.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{Config, SsaoMethod, SsaoResolution};
use manylight::gpu::Format;
use manylight::output::Plane;
use manylight::renderer::Renderer;
use manylight::scene::Scene;
use std::f64::consts::PI;

const SIZE: [u32; 2] = [160, 120];

fn config(position: Vec3, target: Vec3) -> Config {
    let mut config = plain(SIZE, position, target, 60.0, directional(Vec3::new(0.1, -1.0, 0.1), [1.0; 3]));
    config.ssao.method = SsaoMethod::Horizons;
    config.ssao.resolution = SsaoResolution::Full;
    config.ssao.samples = 12;
    config.ssao.radius = 0.5;
    config.vpls.count = 16;
    config
}

/// Visible share of each pixel, row by row, and the pixels' positions.
fn shares(renderer: &mut Renderer, config: &Config) -> (Vec<f32>, Vec<Vec3>) {
    let rendered = dump(renderer, config, 0, &["ssao/share"]);
    let shares = Plane::decode(Format::R32Float, dumped(&rendered, "ssao/visible")).values;
    (shares, rendered.picture.unwrap().positions())
}

fn quad(scene: &mut Scene, corners: [[f32; 3]; 4]) {
    add_quad(scene, corners.map(Vec3::from_array), matte([0.5; 3]));
}

#[test]
fn a_plane_is_not_occluded_near_or_far_or_at_a_grazing_view() {
    let mut scene = Scene::default();
    quad(&mut scene, [[-50.0, 0.0, 50.0], [50.0, 0.0, 50.0], [50.0, 0.0, -50.0], [-50.0, 0.0, -50.0]]);
    let mut renderer = renderer(scene);
    for (height, target) in [(0.3, [0.0, 0.0, -1.0]), (3.0, [0.0, 0.0, -0.5]), (2.0, [0.0, 0.0, -40.0])] {
        for resolution in [SsaoResolution::Full, SsaoResolution::Half] {
            let mut config = config(Vec3::new(0.0, height, 0.0), Vec3::from_array(target));
            config.ssao.resolution = resolution;
            let (shares, _) = shares(&mut renderer, &config);
            let least = shares.iter().copied().fold(f32::INFINITY, f32::min);
            assert!(least > 0.99, "{resolution:?} from {height}: {least}");
        }
    }
    finish(renderer.gpu());
}

/// Cosine-weighted visibility of a floor point at a distance from a wall that occludes up to the radius, by rays.
fn corner_share(distance: f64, radius: f64) -> f64 {
    let n = 400;
    let mut seen = 0.0;
    for i in 0..n {
        for j in 0..n {
            // Cosine-weighted directions. The wall is at x = 0 and hides everything behind it.
            let (u, phi) = ((f64::from(i) + 0.5) / f64::from(n), 2.0 * PI * (f64::from(j) + 0.5) / f64::from(n));
            let direction = DVec3::new(u.sqrt() * phi.cos(), (1.0 - u).sqrt(), u.sqrt() * phi.sin());
            let t = distance / -direction.x;
            let hidden = if direction.x < 0.0 { (1.0 - t * t / (radius * radius)).clamp(0.0, 1.0) } else { 0.0 };
            seen += 1.0 - hidden;
        }
    }
    seen / f64::from(n * n)
}

#[test]
fn the_corner_of_two_planes_is_as_dark_as_rays_make_it() {
    let mut scene = Scene::default();
    quad(&mut scene, [[0.0, 0.0, 4.0], [8.0, 0.0, 4.0], [8.0, 0.0, -4.0], [0.0, 0.0, -4.0]]);
    quad(&mut scene, [[0.0, 0.0, 4.0], [0.0, 0.0, -4.0], [0.0, 6.0, -4.0], [0.0, 6.0, 4.0]]);
    let mut renderer = renderer(scene);
    let config = config(Vec3::new(1.6, 1.2, 0.4), Vec3::new(0.25, 0.0, 0.0));
    let (shares, positions) = shares(&mut renderer, &config);
    // Means over strips of the floor along the wall.
    for (from, to) in [(0.05, 0.1), (0.1, 0.2), (0.2, 0.3), (0.3, 0.45), (0.6, 0.9)] {
        let strip = |p: &Vec3| p.y.abs() < 1e-3 && p.x > from && p.x < to && p.z.abs() < 0.5;
        let inside: Vec<usize> = (0..shares.len()).filter(|i| strip(&positions[*i])).collect();
        assert!(inside.len() > 50, "{} pixels of the strip {from} to {to}", inside.len());
        let found = inside.iter().map(|i| f64::from(shares[*i])).sum::<f64>() / inside.len() as f64;
        let expected = inside.iter().map(|i| corner_share(f64::from(positions[*i].x), 0.5)).sum::<f64>() / inside.len() as f64;
        println!("{from} to {to}: {found:.4}, by rays {expected:.4}");
        assert!((found - expected).abs() < 0.025, "{from} to {to}: {found} is not {expected}");
    }
    finish(renderer.gpu());
}

#[test]
fn a_wall_far_behind_something_near_is_as_bright_as_without_it() {
    for resolution in [SsaoResolution::Full, SsaoResolution::Half] {
        let mut scene = Scene::default();
        quad(&mut scene, [[-20.0, -20.0, -10.0], [20.0, -20.0, -10.0], [20.0, 20.0, -10.0], [-20.0, 20.0, -10.0]]);
        quad(&mut scene, [[-0.5, -0.5, -2.0], [0.5, -0.5, -2.0], [0.5, 0.5, -2.0], [-0.5, 0.5, -2.0]]);
        let mut renderer = renderer(scene);
        let mut config = config(Vec3::ZERO, Vec3::NEG_Z);
        config.ssao.resolution = resolution;
        let (shares, _) = shares(&mut renderer, &config);
        let least = shares.iter().copied().fold(f32::INFINITY, f32::min);
        assert!(least > 0.98, "{resolution:?}: {least}");
        finish(renderer.gpu());
    }
}

#[test]
fn half_the_resolution_agrees_with_the_whole_in_the_mean_and_bytes_repeat() {
    let mut renderer = renderer(manylight::scene::builtin::cornell());
    let mut config = config(Vec3::new(0.0, 2.8, 8.0), Vec3::new(0.0, 2.6, 0.0));
    let (full, _) = shares(&mut renderer, &config);
    assert_eq!(full, shares(&mut renderer, &config).0);
    config.ssao.resolution = SsaoResolution::Half;
    let (half, _) = shares(&mut renderer, &config);
    let mean = |shares: &[f32]| shares.iter().map(|s| f64::from(*s)).sum::<f64>() / shares.len() as f64;
    assert!(mean(&full) < 0.99, "something is occluded: {}", mean(&full));
    assert!((mean(&full) - mean(&half)).abs() < 0.01, "{} and {}", mean(&full), mean(&half));
    finish(renderer.gpu());
}

#[test]
fn occlusion_darkens_the_indirect_light_alone() {
    let mut renderer = renderer(manylight::scene::builtin::cornell());
    let mut config = config(Vec3::new(0.0, 2.8, 8.0), Vec3::new(0.0, 2.6, 0.0));
    let (share, _) = shares(&mut renderer, &config);
    let with = picture(&mut renderer, &config);
    config.ssao.method = SsaoMethod::None;
    let without = picture(&mut renderer, &config);
    assert_eq!(with.direct.values, without.direct.values);
    assert_eq!(with.irradiance.values, without.irradiance.values);
    for (i, share) in share.iter().enumerate() {
        for c in 0..3 {
            let (a, b) = (with.indirect.at(i)[c], without.indirect.at(i)[c] * share);
            assert!((a - b).abs() <= 2e-3 * b + 1e-6, "pixel {i}: {a} is not {b}");
        }
    }
    finish(renderer.gpu());
}
