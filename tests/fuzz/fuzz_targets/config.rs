//! Configs from hostile text: loading never panics, and every error is one line. An accepted config can be saved, loaded to the
//! same value, and viewed: every light and camera is finite.
//!
//! Lines after a line `#--set` are `--set` options.
#![no_main]

use libfuzzer_sys::fuzz_target;
use manylight::config;
use manylight::error::{Exit, exit_code};
use manylight::scene::{Light, Scene};
use manylight::world::view;
use std::path::Path;

fuzz_target!(|text: &str| {
    let (text, sets) = text.split_once("#--set\n").unwrap_or((text, ""));
    let sets: Vec<String> = sets.lines().map(str::to_owned).collect();
    let origin = Path::new("/nowhere/x.toml");
    let config = match config::parse(text, origin, &sets) {
        Ok(loaded) => {
            assert!(loaded.warnings.iter().all(|warning| !warning.contains('\n')), "more than one line: {:?}", loaded.warnings);
            loaded.config
        }
        Err(error) => {
            assert_eq!(exit_code(&error), Exit::BadInput);
            let sentence = format!("{error:#}");
            assert!(!sentence.contains('\n'), "more than one line: {sentence}");
            assert!(sentence.contains("/nowhere/x.toml") || sentence.contains("--set "), "no place: {sentence}");
            return;
        }
    };
    let saved = config::to_toml(&config);
    match config::parse(&saved, origin, &[]) {
        Ok(again) => assert_eq!(again.config, config, "{saved}"),
        Err(error) => panic!("{error:#}\n{saved}"),
    }
    let scene = Scene::default();
    for frame in [0, 1, 30, u32::MAX] {
        if let Ok(camera) = view::camera(&config, &scene, scene.bounds(), frame) {
            assert!(camera.position.is_finite() && camera.target.is_finite() && camera.up.is_normalized(), "{camera:?}");
            assert!((1.0..=170.0).contains(&camera.fov_y_deg), "{camera:?}");
        }
        for light in view::lights(&config, &scene, frame) {
            let sound = match light {
                Light::Directional { direction, irradiance } => direction.is_normalized() && irradiance.is_finite(),
                Light::Spot { position, direction, intensity, inner, outer, .. } => {
                    position.is_finite() && direction.is_normalized() && intensity.is_finite() && inner <= outer && outer > 0.0
                }
                Light::Point { position, intensity } => position.is_finite() && intensity.is_finite(),
                Light::Environment { radiance, rotation, .. } => radiance.is_finite() && rotation.is_finite(),
            };
            assert!(sound, "{light:?}");
        }
    }
});
