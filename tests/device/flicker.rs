//! Flicker on a device: still surfaces do not flicker, moving ones are followed, and keyframes drive cameras and lights.

use crate::common::*;
use glam::Vec3;
use manylight::color::luminance;
use manylight::config::{
    CameraConfig, CameraKeyframe, Config, FilterKind, FrameConfig, Importance, Interpolation, LightConfig, LightKeyframe, Shadows,
    VisibilityMethod, VplSampler,
};
use manylight::graph::Execution;
use manylight::metrics::Intensity;
use manylight::metrics::flicker::{Fate, Surfaces, matches};
use manylight::output::Picture;
use manylight::presets;
use manylight::renderer::Renderer;
use manylight::scene::builtin;
use manylight::walk::{Visit, Walk, flicker_of_walk};
use std::path::Path;

const LAYERS: [Intensity; 4] = [Intensity::Radiance, Intensity::Direct, Intensity::Indirect, Intensity::Irradiance];

fn key(time: f32, position: [f32; 3], target: [f32; 3]) -> CameraKeyframe {
    CameraKeyframe { time, position, target, fov_y_deg: None }
}

/// The box under a wide lamp at its ceiling, seen along a camera path.
fn cornell(size: [u32; 2], keyframes: Vec<CameraKeyframe>) -> Config {
    let light = spot(Vec3::new(0.0, 5.4, 0.3), Vec3::NEG_Y, [45.0, 40.0, 32.0], 50.0, 75.0);
    let camera = CameraConfig { keyframes, fov_y_deg: Some(37.0), ..CameraConfig::default() };
    let mut config = Config { camera: Some(camera), light: vec![light], ..Config::default() };
    config.frame.size = size;
    config.frame.fps = 1.0;
    config.rsm.size = [128, 128];
    config.vpls.count = 256;
    config
}

fn still() -> Vec<CameraKeyframe> {
    vec![key(0.0, [0.0, 2.74, 10.9], [0.0, 2.74, 0.0])]
}

fn walk(renderer: &mut Renderer, config: &Config, layer: Intensity, on_frame: &mut dyn FnMut(&Visit)) -> Walk {
    renderer.check(config).unwrap_or_else(|error| panic!("{error:#}"));
    let mut on_frame = |visit: &Visit| {
        on_frame(visit);
        Ok(())
    };
    flicker_of_walk(renderer, config, layer, None, &Execution::default(), &mut on_frame).unwrap_or_else(|error| panic!("{error:#}"))
}

fn surfaces(picture: &Picture) -> Surfaces {
    Surfaces { view: picture.view, positions: picture.positions(), normals: picture.normals() }
}

#[test]
fn a_still_camera_in_a_still_scene_flickers_by_exactly_nothing() {
    let mut renderer = renderer(builtin::cornell());
    let mut config = cornell([160, 120], still());
    config.frame.count = 3;
    for layer in LAYERS {
        let mut changes = 0;
        let walk = walk(&mut renderer, &config, layer, &mut |visit| {
            changes += visit.differences().unwrap_or_default().iter().flatten().filter(|change| **change != 0.0).count();
        });
        assert_eq!((walk.flicker.flicker, walk.flicker.largest, walk.flicker.matched_share, changes), (0.0, 0.0, 1.0, 0), "{layer:?}");
        assert!(walk.flicker.mean > 0.01 && walk.steps.len() == 2, "{walk:?}");
        assert!(walk.steps[0].pair.surfaces > walk.steps[0].pair.pixels / 3, "{walk:?}");
    }
    finish(renderer.gpu());
}

#[test]
fn a_moving_camera_under_exact_visibility_sees_little_flicker_and_no_surface_for_another() {
    let mut renderer = traced(builtin::cornell());
    let path = vec![key(0.0, [-0.6, 2.6, 10.5], [0.0, 2.74, 0.0]), key(2.0, [0.4, 3.1, 9.9], [0.1, 2.6, 0.0])];
    let mut config = cornell([240, 240], path);
    config.frame.count = 3;
    config.visibility.method = VisibilityMethod::RayTraced;
    config.direct.shadows = Shadows::RayTraced;
    config.gather.interleave = 1.into();
    config.filter.kind = FilterKind::None;
    // The bound leaves a smooth function of the surface, without peaks near VPLs.
    config.gather.min_distance = 1.0;
    let mut frames: Vec<(Surfaces, Vec<Vec3>)> = Vec::new();
    let walk = walk(&mut renderer, &config, Intensity::Irradiance, &mut |visit| {
        frames.push((surfaces(visit.picture), visit.picture.albedo.rgb().collect()))
    });
    let relative = walk.flicker.flicker / walk.flicker.mean;
    assert!(relative > 0.0 && relative < 0.03, "{relative}");
    for step in &walk.steps {
        // The camera approaches, so that the walls' edges leave the picture.
        assert!(step.pair.matched as f64 > 0.97 * (step.pair.surfaces - step.pair.outside) as f64, "{step:?}");
        assert!(step.pair.outside < step.pair.surfaces / 10, "{step:?}");
    }
    finish(renderer.gpu());
    // Colours and positions of the walls are an independent check: the matching does not use them.
    for pair in frames.windows(2) {
        let [(before, albedo_before), (after, albedo_after)] = pair else { unreachable!("pairs") };
        for (i, fate) in matches(before, after).fates().iter().enumerate() {
            let Fate::Matched(there) = *fate else { continue };
            let there = there as usize;
            assert!(albedo_before[i].distance(albedo_after[there]) < 0.02, "pixel {i} went to another wall");
            let apart = before.positions[i].distance(after.positions[there]);
            assert!(apart < 0.2, "pixel {i} went {apart} m far, more than a slanted pixel");
        }
    }
}

#[test]
fn a_lights_keyframes_make_a_still_camera_see_the_change_that_they_say() {
    let mut renderer = renderer(builtin::cornell());
    let mut config = cornell([120, 90], still());
    config.frame.count = 4;
    config.frame.fps = 2.0;
    let LightConfig::Spot { keyframes, .. } = &mut config.light[0] else { unreachable!("it is a spot") };
    let intensity = |time: f32, scale: f32| LightKeyframe {
        time,
        position: None,
        direction: None,
        target: None,
        intensity: Some([40.0 * scale, 40.0 * scale, 40.0 * scale]),
        irradiance: None,
    };
    // Intensity goes from 1 to 4 in 1.5 s, by 1 a frame.
    *keyframes = vec![intensity(0.0, 1.0), intensity(1.5, 4.0)];
    let mut expected = 0.0;
    let walk = walk(&mut renderer, &config, Intensity::Direct, &mut |visit| {
        if visit.frame == 0 {
            let lit: Vec<f64> = visit.picture.direct.rgb().map(|color| luminance(&color.to_array())).collect();
            let surfaces = visit.picture.normals().iter().filter(|normal| **normal != Vec3::ZERO).count();
            expected = (lit.iter().map(|l| l * l).sum::<f64>() / surfaces as f64).sqrt();
        }
    });
    finish(renderer.gpu());
    assert!(expected > 0.1, "{expected}");
    for step in &walk.steps {
        let flicker = step.pair.flicker.unwrap();
        assert!((flicker / expected - 1.0).abs() < 0.01, "{step:?}, expected {expected}");
    }
}

#[test]
fn a_walk_follows_its_path_linearly_or_smoothly_as_the_config_says() {
    let mut renderer = renderer(builtin::cornell());
    let places = [[0.0, 2.0, 11.0], [0.5, 2.5, 10.0], [1.5, 2.5, 9.5], [1.0, 3.0, 9.0]];
    let path = places.iter().enumerate().map(|(i, place)| key(i as f32, *place, [0.0, 2.7, 0.0])).collect();
    let mut config = cornell([48, 36], path);
    config.frame.fps = 2.0;
    config.frame.count = 7;
    let [a, b, c, d] = places.map(Vec3::from);
    // Halfway between evenly spaced keyframes.
    let smooth = (9.0 * (b + c) - (a + d)) / 16.0;
    for (interpolation, halfway) in [(Interpolation::Linear, (b + c) / 2.0), (Interpolation::CatmullRom, smooth)] {
        config.camera.as_mut().unwrap().interpolation = interpolation;
        let mut seen = Vec::new();
        let walk = walk(&mut renderer, &config, Intensity::Radiance, &mut |visit| seen.push(Vec3::from(visit.picture.view.position)));
        assert_eq!(walk.steps.len(), 6);
        assert!(walk.flicker.flicker > 0.0);
        for (frame, expected) in [(0, a), (2, b), (3, halfway), (4, c), (6, d)] {
            assert!(seen[frame].distance(expected) < 1e-5, "{interpolation:?}, frame {frame}: {}, expected {expected}", seen[frame]);
        }
    }
    finish(renderer.gpu());
}

#[test]
fn chains_flicker_less_than_the_inverse_transform_and_err_less_than_uniform_vpls() {
    const SEEDS: u32 = 7;
    let Some(scene) = shared_scene("sponza_crytek.glb") else { return };
    let (_, view) = presets::views().into_iter().find(|(name, _)| *name == "crytek-sponza-walk").unwrap();
    let text = format!("base = \"barak-walk.toml\"\n{view}");
    let mut config = manylight::config::parse(&text, Path::new("walk.toml"), &[]).unwrap_or_else(|error| panic!("{error:#}")).config;
    let mut renderer = renderer(scene);
    config.frame.size = [160, 90];
    config.frame.count = 12;
    // Nothing but the VPLs differs, and without peaks near them the nearest pixel is nearly as bright.
    config.gather.min_distance = 1.0;
    config.visibility.method = VisibilityMethod::None;
    config.gather.interleave = 1.into();
    config.filter.kind = FilterKind::None;
    let mut every = config.clone();
    (every.vpls.sampler, every.vpls.importance) = (VplSampler::EveryTexel, Importance::None);
    every.gather.interleave = manylight::config::Block([4, 2]);
    renderer.check(&every).unwrap();
    let last = config.frame.count - 1;
    let truth = render(&mut renderer, &every, last).picture.unwrap().irradiance;
    let mean = truth.values.iter().map(|x| f64::from(*x)).sum::<f64>() / truth.values.len() as f64;
    // Flicker of the camera's way alone: VPLs that stay where they are, and too many for their peaks to be seen.
    let mut still = config.clone();
    (still.vpls.sampler, still.vpls.importance, still.vpls.count) = (VplSampler::Uniform, Importance::None, 16_384);
    let still = walk(&mut renderer, &still, Intensity::Irradiance, &mut |_| ()).flicker.flicker;
    println!("still: flicker {still:.4}");
    let [uniform, inverse, chains] = [VplSampler::Uniform, VplSampler::InverseTransform, VplSampler::MetropolisHastings].map(|sampler| {
        let importance = if sampler == VplSampler::Uniform { Importance::None } else { Importance::View };
        (config.vpls.sampler, config.vpls.importance) = (sampler, importance);
        // One placing of so few VPLs says little, and a mean of few hangs on the peaks of one.
        let (mut flickers, mut squares) = (Vec::new(), 0.0);
        for seed in 0..SEEDS {
            let seeded = Config { frame: FrameConfig { seed, ..config.frame.clone() }, ..config.clone() };
            let walk = walk(&mut renderer, &seeded, Intensity::Irradiance, &mut |_| ());
            let found = render(&mut renderer, &seeded, last).picture.unwrap().irradiance.values;
            let square = found.iter().zip(&truth.values).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / truth.values.len() as f64;
            println!(
                "{sampler:?}, seed {seed}: flicker {:.4} of {:.4}, error {:.3}",
                walk.flicker.flicker,
                walk.flicker.mean,
                square.sqrt() / mean
            );
            flickers.push(walk.flicker.flicker);
            squares += square / f64::from(SEEDS);
        }
        flickers.sort_by(f64::total_cmp);
        (flickers[SEEDS as usize / 2], squares.sqrt() / mean)
    });
    let [of_inverse, of_chains] = [inverse, chains].map(|(flicker, _)| flicker - still);
    assert!(of_chains < 0.75 * of_inverse, "{still}, {uniform:?}, {chains:?}, {inverse:?}");
    assert!(inverse.1 < chains.1 && chains.1 < uniform.1, "{uniform:?}, {chains:?}, {inverse:?}");
    finish(renderer.gpu());
}
