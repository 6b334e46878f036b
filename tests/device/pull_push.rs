//! What fills the holes between single pixels, texel by texel, against the same in 64 bits.

use crate::common::*;
use glam::{DVec2, DVec3, Vec3};
use manylight::config::{PullPushConfig, PullWeights, VisibilityMethod};

const EMPTY: u32 = 0xffff_ffff;
/// Side of a map, and of the image of four of them, texels.
const MAP: usize = 64;
const SIDE: usize = 2 * MAP;

/// A texel's point: depth and end of its interval over the farthest, radius in texels of the finest level, and place from the texel's centre.
#[derive(Debug, Clone, Copy)]
struct Point {
    depth: f64,
    radius: f64,
    extent: f64,
    offset: DVec2,
}

fn depth_of(word: u32) -> f64 {
    f64::from(word >> 8) / 16_777_214.0
}

fn radius_of(word: u32) -> f64 {
    ((f64::from(word & 255) - 96.0) / 16.0).exp2()
}

/// A half-float of 0 or more, from its bits.
fn half(bits: u32) -> f32 {
    let (exponent, fraction) = ((bits >> 10 & 31) as i32, (bits & 1023) as f32 / 1024.0);
    if exponent == 0 { fraction * 2f32.powi(-14) } else { (1.0 + fraction) * 2f32.powi(exponent - 15) }
}

/// A single pixel with the interval of the config.
fn single(word: u32, [x, y]: [usize; 2], interval: f64) -> Option<Point> {
    let place = (DVec2::new((x % MAP) as f64, (y % MAP) as f64) + 0.5) * (2.0 / MAP as f64) - 1.0;
    let (depth, radius) = (depth_of(word), radius_of(word));
    let extent = 2.0 * radius * depth * 4.0 * interval / (1.0 + place.length_squared()) / MAP as f64;
    (word != EMPTY).then_some(Point { depth, radius, extent, offset: DVec2::ZERO })
}

/// The pull of four texels, or nothing where rounding decides which of them count.
fn pulled(from: [Option<Point>; 4], keys: &PullPushConfig) -> Option<Option<Point>> {
    let there = || from.iter().enumerate().filter_map(|(i, point)| Some((DVec2::new((i & 1) as f64, (i >> 1) as f64), (*point)?)));
    let Some((_, front)) = there().min_by(|a, b| a.1.depth.total_cmp(&b.1.depth)) else { return Some(None) };
    let limit = front.depth + front.extent;
    if there().any(|(_, point)| (point.depth - limit).abs() < 1e-5 * limit) {
        return None;
    }
    let (mut sum, mut squares) = (Point { depth: 0.0, radius: 0.0, extent: 0.0, offset: DVec2::ZERO }, 0.0);
    let (mut weights, mut end) = (0.0, 0f64);
    for (corner, point) in there().filter(|(_, point)| point.depth <= limit) {
        let place = 0.5 * (point.offset + corner - 0.5);
        let weight = match keys.weights {
            PullWeights::Even => 1.0,
            PullWeights::Gaussian => (-2.0 * place.length_squared()).exp(),
        };
        sum.depth += weight * point.depth;
        sum.radius += weight * point.radius;
        sum.offset += weight * place;
        squares += weight * place.length_squared();
        weights += weight;
        end = end.max(point.depth + point.extent);
    }
    let (depth, offset, radius) = (sum.depth / weights, sum.offset / weights, sum.radius / weights);
    // A texel of the coarser level is two of the finest wide.
    let spread = (squares / weights - offset.length_squared()) * f64::from(keys.spread) * 4.0;
    Some(Some(Point { depth, radius: (radius * radius + spread).sqrt(), extent: end - depth, offset }))
}

#[test]
fn a_pull_averages_the_points_of_the_frontmost_surface_by_the_weights_of_its_keys() {
    let mut scene = room(&walls(DVec3::new(4.0, 3.0, 5.0), [DVec3::splat(0.6); 6]));
    // Something that stands before the walls.
    let corners = [[1.0, 0.2, 1.0], [3.0, 0.2, 1.0], [3.0, 1.8, 1.5], [1.0, 1.8, 1.5]].map(Vec3::from_array);
    add_quad(&mut scene, corners, manylight::scene::Material { double_sided: true, ..matte([0.5; 3]) });
    let mut renderer = renderer(scene);
    let light = spot(Vec3::new(2.0, 2.5, 2.5), Vec3::new(0.1, -1.0, -0.2), [20.0; 3], 20.0, 50.0);
    let mut config = plain([16, 16], Vec3::new(2.0, 1.5, 4.5), Vec3::new(2.0, 1.2, 0.0), 70.0, light);
    config.vpls.count = 4;
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    config.visibility.ism.point_count = 4_000;
    let thesis = PullPushConfig { weights: PullWeights::Even, grow: 0.0, interval: 1.0, spread: 0.0 };
    let ours = PullPushConfig::default();
    let gaussian = PullPushConfig { weights: PullWeights::Gaussian, ..ours };
    let mut maps = Vec::new();
    for keys in [ours, thesis, gaussian] {
        config.visibility.ism.pull_push = keys;
        let rendered = dump(&mut renderer, &config, 0, &["visibility/single-pixel", "visibility/pull-1", "visibility/push-0"]);
        let pixels: Vec<u32> = words(dumped(&rendered, "visibility/single-pixels")).collect();
        let found: Vec<u32> = words(dumped(&rendered, "visibility/pulled-1")).collect();
        assert_eq!((pixels.len(), found.len()), (SIDE * SIDE, SIDE * SIDE / 2));
        let (mut filled, mut mixed) = (0, 0);
        for (number, found) in found.chunks(2).enumerate() {
            let [x, y] = [number % (SIDE / 2), number / (SIDE / 2)];
            let from = std::array::from_fn(|i| {
                let [x, y] = [2 * x + (i & 1), 2 * y + (i >> 1)];
                single(pixels[y * SIDE + x], [x, y], f64::from(keys.interval))
            });
            match pulled(from, &keys) {
                None => {}
                Some(None) => assert_eq!(found[0], EMPTY, "{keys:?}: texel {x}, {y} is filled by nothing"),
                Some(Some(point)) => {
                    let (depth, radius) = (depth_of(found[0]), radius_of(found[0]));
                    assert!((depth - point.depth).abs() < 1e-5, "{keys:?}: texel {x}, {y} is at {depth} and not {}", point.depth);
                    // A radius has 16 steps an octave.
                    let steps = 16.0 * (radius / point.radius).log2();
                    assert!(steps.abs() < 0.6, "{keys:?}: texel {x}, {y} has radius {radius} and not {}", point.radius);
                    let offset = DVec2::new(f64::from(found[1] as u8 as i8), f64::from((found[1] >> 8) as u8 as i8)) * (8.0 / 127.0);
                    assert!((offset - point.offset).abs().max_element() < 0.04, "{keys:?}: texel {x}, {y} is at {offset}, {point:?}");
                    let extent = f64::from(half(found[1] >> 16));
                    assert!(
                        (extent - point.extent).abs() < 1e-3 * point.extent + 1e-5,
                        "{keys:?}: texel {x}, {y} ends after {extent}, {point:?}"
                    );
                    filled += 1;
                    mixed += u32::from(from.iter().flatten().count() > 1);
                }
            }
        }
        assert!(filled > 500 && mixed > 100, "{filled} texels are filled, {mixed} of several");
        maps.push(words(dumped(&rendered, "visibility/maps")).map(f32::from_bits).collect::<Vec<f32>>());
    }
    // Points that do not grow leave more holes.
    let holes: Vec<usize> = maps.iter().map(|map| map.iter().filter(|depth| **depth == 1.0).count()).collect();
    assert!(holes[1] > holes[0] && maps[2] != maps[0], "{holes:?} holes");
    finish(renderer.gpu());
}
