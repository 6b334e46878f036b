//! Sequences of frames: state that continues from frame to frame, and events that end it.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{Config, LightConfig, VisibilityMethod, VplSampler};
use manylight::graph::Execution;
use manylight::renderer::{Lane, Rendered, Renderer};

/// Clusters of VPLs in a box, found by k-means over frames.
fn clustered() -> (Renderer, Config) {
    let renderer = renderer(room(&walls(DVec3::new(4.0, 3.0, 5.0), [DVec3::splat(0.5); 6])));
    let light = LightConfig::Point { position: [2.0, 1.5, 2.0], intensity: [1.0; 3], keyframes: Vec::new() };
    let mut config = plain([32, 32], Vec3::new(1.0, 1.0, 4.0), Vec3::ZERO, 60.0, light);
    config.scene.split = Some(0.5);
    config.rsm.size = [32, 32];
    config.vpls.sampler = VplSampler::Hammersley;
    config.vpls.count = 256;
    config.visibility.method = VisibilityMethod::Clusters;
    (renderer, config)
}

fn shoot(renderer: &mut Renderer, lane: &mut Lane, config: &Config, index: u32) -> Rendered {
    let shot = renderer.shot(config, index).unwrap_or_else(|error| panic!("{error:#}"));
    renderer.shoot(lane, shot, config, true, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"))
}

fn rounds(rendered: &Rendered) -> u64 {
    count(rendered, "bounce/rounds")
}

#[test]
fn an_edited_camera_or_exposure_keeps_history_and_a_cut_drops_it() {
    let (mut renderer, mut config) = clustered();
    renderer.prepare(&config, &[]).unwrap();
    let mut lane = Lane::new();
    let first = rounds(&shoot(&mut renderer, &mut lane, &config, 0));
    assert!(first > 1, "the first frame's clusters are to be found");
    // Lights are the same: k-means finds its centres unchanged.
    if let Some(camera) = &mut config.camera {
        camera.position = Some([1.5, 1.2, 4.0]);
    }
    assert_eq!(rounds(&shoot(&mut renderer, &mut lane, &config, 1)), 1);
    config.compose.exposure = 2.0;
    assert_eq!(rounds(&shoot(&mut renderer, &mut lane, &config, 2)), 1);
    assert_eq!(lane.before().map(|before| before.index), Some(2));
    lane.cut();
    assert_eq!(rounds(&shoot(&mut renderer, &mut lane, &config, 3)), first);
    finish(renderer.gpu());
}

#[test]
fn another_number_of_clusters_starts_them_anew_in_a_kept_lane() {
    let (mut renderer, mut config) = clustered();
    renderer.prepare(&config, &[]).unwrap();
    let mut lane = Lane::new();
    shoot(&mut renderer, &mut lane, &config, 0);
    config.bounce.clusters.count = 5;
    let kept = shoot(&mut renderer, &mut lane, &config, 1);
    let fresh = shoot(&mut renderer, &mut Lane::new(), &config, 1);
    assert_eq!(rounds(&kept), rounds(&fresh), "the clusters are found as by a frame that has none before it");
    assert_eq!(kept.picture.unwrap().image, fresh.picture.unwrap().image);
    finish(renderer.gpu());
}

#[test]
fn two_presets_in_turn_reallocate_nothing_and_forget_nothing() {
    let (mut renderer, clusters) = clustered();
    let mut tiled = clusters.clone();
    tiled.visibility.method = VisibilityMethod::None;
    tiled.frame.size = [48, 16];
    for config in [&clusters, &tiled] {
        renderer.prepare(config, &[]).unwrap();
    }
    let (mut a, mut b) = (Lane::new(), Lane::new());
    let alone = [shoot(&mut renderer, &mut a, &clusters, 0), shoot(&mut renderer, &mut b, &tiled, 0)];
    let bytes = renderer.gpu().memory_in_use();
    for index in 1..4 {
        let in_turn = [shoot(&mut renderer, &mut a, &clusters, index), shoot(&mut renderer, &mut b, &tiled, index)];
        assert_eq!(rounds(&in_turn[0]), 1, "frame {index}");
        assert_eq!(renderer.gpu().memory_in_use(), bytes, "frame {index}");
        for (now, first) in in_turn.iter().zip(&alone) {
            assert_eq!(now.picture.as_ref().unwrap().image, first.picture.as_ref().unwrap().image, "frame {index}");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn a_batch_of_frames_starts_anew_with_another_config() {
    let (mut renderer, mut config) = clustered();
    let mut frame = |config: &Config, index| {
        rounds(&renderer.render(config, index, false, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}")))
    };
    let first = frame(&config, 0);
    assert_eq!(frame(&config, 1), 1);
    config.compose.exposure = 2.0;
    assert_eq!(frame(&config, 2), first, "what was rendered before under another config changes nothing");
    assert_eq!(frame(&config, 3), 1);
    assert_eq!(frame(&config, 3), first, "the same frame again does not follow itself");
    finish(renderer.gpu());
}
