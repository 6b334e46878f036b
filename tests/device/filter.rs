//! Filters of the indirect light: noise that they remove, and edges that they keep.

use crate::common::*;
use glam::{DVec3, Vec3};
use manylight::config::{Block, Config, FilterKind};
use manylight::renderer::Renderer;

const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
const KINDS: [FilterKind; 3] = [FilterKind::Bilateral, FilterKind::Gaussian, FilterKind::CrossBilateral];

/// A room in which a lamp lights only the far wall, z = 0.
fn lit_wall(target: Vec3, fov_y_deg: f32) -> (Renderer, Config) {
    let renderer = renderer(room(&walls(SIZE, [DVec3::splat(0.6); 6])));
    let lamp = spot(Vec3::new(2.0, 1.5, 4.0), Vec3::new(0.0, 0.0, -1.0), [30.0; 3], 12.0, 18.0);
    let mut config = plain([120, 90], Vec3::new(2.0, 1.6, 3.0), target, fov_y_deg, lamp);
    config.vpls.count = 256;
    (renderer, config)
}

fn indirect(renderer: &mut Renderer, config: &Config) -> (Vec<f32>, Vec<Vec3>) {
    let picture = picture(renderer, config);
    ((0..120 * 90).map(|i| picture.indirect.at(i)[0]).collect(), picture.positions())
}

/// Mean difference over mean, of the chosen pixels.
fn off(values: &[f32], truth: &[f32], chosen: &dyn Fn(usize) -> bool) -> f64 {
    let pixels = || (0..values.len()).filter(|i| chosen(*i));
    let difference: f64 = pixels().map(|i| f64::from((values[i] - truth[i]).abs())).sum();
    difference / pixels().map(|i| f64::from(truth[i])).sum::<f64>()
}

#[test]
fn every_filter_takes_the_pattern_of_interleaving_away() {
    // Only the floor counts, far enough from the lit wall.
    let (mut renderer, mut config) = lit_wall(Vec3::new(2.0, 0.0, 2.2), 40.0);
    let (truth, positions) = indirect(&mut renderer, &config);
    let on_floor = |i: usize| positions[i].y < 1e-3 && (1.0..4.0).contains(&positions[i].z);
    for block in [[4, 4], [4, 2], [1, 4]].map(Block) {
        config.gather.interleave = block;
        config.filter.radius = None;
        config.filter.kind = FilterKind::None;
        let noisy = off(&indirect(&mut renderer, &config).0, &truth, &on_floor);
        for kind in KINDS {
            config.filter.kind = kind;
            let left = off(&indirect(&mut renderer, &config).0, &truth, &on_floor);
            // A filter blurs light that has no pattern, too: as much is no pattern that is left.
            config.gather.interleave = 1.into();
            let longest = block.0[0].max(block.0[1]);
            config.filter.radius = Some(if kind == FilterKind::Gaussian { 2 * longest } else { longest });
            let blur = off(&indirect(&mut renderer, &config).0, &truth, &on_floor);
            (config.gather.interleave, config.filter.radius) = (block, None);
            println!("{block}, {kind:?}: {left:.5} of {noisy:.4} is left, and the blur is {blur:.5}");
            assert!(left < 0.02 * noisy + blur && blur < 0.05 * noisy, "{block}, {kind:?} leaves {left} of {noisy}, and blurs by {blur}");
        }
    }
    finish(renderer.gpu());
}

#[test]
fn no_filter_crosses_the_edge_between_a_wall_and_a_floor() {
    // Both surfaces get slanted light, the floor more. The view is so close that light hardly changes over a filter's width.
    let (mut renderer, mut config) = lit_wall(Vec3::new(4.0, 0.0, 2.0), 8.0);
    let (truth, positions) = indirect(&mut renderer, &config);
    let beside = |i: usize| positions[i].y < 0.02 && positions[i].x > 3.98;
    assert!((0..truth.len()).filter(|i| beside(*i)).count() > 500);
    config.filter.radius = Some(8);
    for kind in KINDS {
        config.filter.kind = kind;
        let mut with = |normal_threshold_deg, plane_distance| {
            (config.filter.normal_threshold_deg, config.filter.plane_distance) = (normal_threshold_deg, plane_distance);
            off(&indirect(&mut renderer, &config).0, &truth, &beside)
        };
        // Either threshold suffices alone: the normals', or the plane's at half a millimetre, less than a pixel.
        let (by_normal, by_plane, crossing) = (with(25.0, 1e6), with(90.0, 2e-4), with(90.0, 1e6));
        println!("{kind:?}: off by {by_normal:.4}, {by_plane:.4}, without thresholds {crossing:.4}");
        // At 90 degrees the cross-bilateral filter still has weights of at most e^-2.
        for keeping in [by_normal, by_plane] {
            assert!(keeping < 0.01 && crossing > 3.0 * keeping, "{kind:?}: off by {keeping}, without thresholds {crossing}");
        }
    }
    finish(renderer.gpu());
}
