use super::*;
use crate::scene::{Aabb, Camera};
use glam::Vec2;

const BOUNDS: Aabb = Aabb { min: Vec3::splat(-20.0), max: Vec3::splat(20.0) };

fn view(position: Vec3, target: Vec3, size: [u32; 2]) -> View {
    let up = if (target - position).normalize().y.abs() > 0.99 { Vec3::NEG_Z } else { Vec3::Y };
    View::new(&Camera { name: String::new(), position, target, up, fov_y_deg: 60.0 }, size, BOUNDS)
}

/// Surfaces that a view sees of planes, each given by a point and the normal of its front.
fn see(view: View, planes: &[(Vec3, Vec3)]) -> Surfaces {
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for pixel in 0..view.width * view.height {
        let eye = Vec3::from(view.position);
        let ray = view.position_at(pixel % view.width, pixel / view.width, view.near) - eye;
        let hits = planes.iter().filter_map(|(point, normal)| {
            let along = (*point - eye).dot(*normal) / ray.dot(*normal);
            (along.is_finite() && along > 0.0 && ray.dot(*normal) < 0.0).then_some((along, *normal))
        });
        let (along, normal) = hits.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, Vec3::ZERO));
        positions.push(if normal == Vec3::ZERO { Vec3::ZERO } else { eye + ray * along });
        normals.push(normal);
    }
    Surfaces { view, positions, normals }
}

const FLOOR: (Vec3, Vec3) = (Vec3::ZERO, Vec3::Y);

/// Radiance of a Lambertian floor under a small lamp at (0, 3, 0).
fn lit(surfaces: &Surfaces) -> Vec<f32> {
    let light = |(p, n): (&Vec3, &Vec3)| {
        let to = Vec3::Y * 3.0 - *p;
        let squared = to.length_squared();
        20.0 * n.dot(to).max(0.0) / (squared * squared.sqrt())
    };
    surfaces.positions.iter().zip(&surfaces.normals).map(light).collect()
}

/// Normally distributed numbers of standard deviation 1, a function of the seed (Box and Muller 1958).
fn noise(count: usize, seed: u64) -> Vec<f32> {
    let uniform = |i: u64| {
        let mut z = i.wrapping_add(seed << 32).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let normal = |i: u64| (-2.0 * (1.0 - uniform(2 * i)).ln()).sqrt() * (std::f64::consts::TAU * uniform(2 * i + 1)).cos();
    (0..count as u64).map(|i| normal(i) as f32).collect()
}

fn slanted(shift: f32, size: [u32; 2]) -> Surfaces {
    let at = Vec3::new(shift, 2.0, 4.0);
    see(view(at, at - Vec3::new(0.0, 2.0, 4.0), size), &[FLOOR])
}

#[test]
fn a_still_camera_in_a_still_scene_has_no_flicker_at_all() {
    for size in [[64, 48], [320, 180], [7, 501]] {
        let frame = slanted(0.3, size);
        let light = lit(&frame);
        let matches = matches(&frame, &frame);
        let pair = matches.pair(&light, &light);
        assert_eq!((pair.flicker, pair.matched), (Some(0.0), pair.surfaces), "{pair:?}");
        assert!(pair.surfaces > pair.pixels / 2);
        let same = |(i, fate): (usize, &Fate)| *fate == Fate::Empty || *fate == Fate::Matched(i as u32);
        assert!(matches.fates().iter().enumerate().all(same), "each pixel is its own match");
    }
}

#[test]
fn noise_of_variance_s_squared_flickers_by_root_two_s_however_the_camera_moves() {
    let size = [256, 192];
    let first = slanted(0.0, size);
    for (seed, (shift, s)) in [(0.0, 0.1), (0.003, 0.1), (0.0213, 2.0), (0.2, 1e-3)].into_iter().enumerate() {
        let next = slanted(shift, size);
        let noisy =
            |surfaces: &Surfaces, seed: u64| -> Vec<f32> { noise(surfaces.positions.len(), seed).iter().map(|n| 5.0 + n * s).collect() };
        let (a, b) = (noisy(&first, 2 * seed as u64 + 1), noisy(&next, 2 * seed as u64 + 2));
        let pair = matches(&first, &next).pair(&a, &b);
        let expected = 2f64.sqrt() * f64::from(s);
        let flicker = pair.flicker.unwrap();
        assert!((flicker / expected - 1.0).abs() < 0.02, "shift {shift}: {flicker}, expected {expected}");
        assert!(pair.matched as f64 > 0.9 * pair.surfaces as f64, "{pair:?}");
    }
}

#[test]
fn a_translated_camera_over_a_lambertian_plane_sees_no_flicker_but_what_half_a_pixel_makes() {
    // The camera looks straight down and moves by whole pixels: every match is the same point.
    let size = [160, 120];
    let down = |shift: f32| see(view(Vec3::new(shift, 4.0, 0.0), Vec3::new(shift, 0.0, 0.0), size), &[FLOOR]);
    let step = down(0.0).view.pixel_size() as f32 * 4.0;
    for pixels in [1.0, 5.0, 31.0] {
        let (a, b) = (down(0.0), down(step * pixels));
        let pair = matches(&a, &b).pair(&lit(&a), &lit(&b));
        assert!(pair.flicker.unwrap() < 1e-5 * pair.mean.unwrap(), "{pair:?}");
        assert_eq!(pair.matched, u64::from(size[1]) * u64::from(size[0] - pixels as u32), "{pair:?}");
    }
    // The camera is slanted and moves by part of a pixel: the error is of first order, and half the pixel size halves it.
    let flicker = |height: u32| {
        let size = [height * 4 / 3, height];
        let (a, b) = (slanted(0.0, size), slanted(0.1234, size));
        let pair = matches(&a, &b).pair(&lit(&a), &lit(&b));
        assert!(pair.hidden + pair.turned == 0 && pair.matched > pair.surfaces * 9 / 10, "{pair:?}");
        pair.flicker.unwrap() / pair.mean.unwrap()
    };
    let (coarse, fine) = (flicker(120), flicker(480));
    assert!(coarse < 0.02 && fine < 0.3 * coarse, "{coarse}, {fine}");
}

#[test]
fn what_comes_out_from_behind_another_surface_is_not_compared() {
    // A screen with a free edge at x = 0, 2 m before a wall; the camera moves sideways.
    let size = [200, 150];
    let frame = |x: f32| {
        let screen = (Vec3::ZERO, Vec3::Z);
        let wall = (Vec3::NEG_Z * 2.0, Vec3::Z);
        let at = Vec3::new(x, 0.0, 3.0);
        let (near, far) = (see(view(at, at - Vec3::Z, size), &[screen]), see(view(at, at - Vec3::Z, size), &[wall]));
        let mut frame = near.clone();
        for (i, position) in frame.positions.iter_mut().enumerate() {
            if position.x > 0.0 {
                *position = far.positions[i];
            }
        }
        let light: Vec<f32> = frame.positions.iter().map(|p| if p.z < -1.0 { 1.0 } else { 100.0 }).collect();
        (frame, light)
    };
    let ((a, of_a), (b, of_b)) = (frame(0.0), frame(0.5));
    for ((a, of_a), (b, of_b)) in [((&a, &of_a), (&b, &of_b)), ((&b, &of_b), (&a, &of_a))] {
        let pair = matches(a, b).pair(of_a, of_b);
        assert_eq!(pair.flicker, Some(0.0), "{pair:?}");
        assert!(pair.matched > pair.pixels / 2 && pair.outside > 0, "{pair:?}");
    }
    assert!(matches(&b, &a).pair(&of_b, &of_a).hidden > 1000, "some of the wall is covered when the camera goes back");
}

#[test]
fn a_surface_that_turned_and_one_that_is_gone_are_told_apart() {
    let size = [64, 48];
    let seen = view(Vec3::new(0.0, 4.0, 2.0), Vec3::ZERO, size);
    let first = see(seen, &[FLOOR]);
    let tilted = |degrees: f32| {
        let mut next = first.clone();
        let turn = glam::Quat::from_rotation_x(degrees.to_radians());
        next.normals.iter_mut().for_each(|normal| *normal = turn * *normal);
        next
    };
    let count = |next: &Surfaces| {
        let light = vec![1.0; first.positions.len()];
        let pair = matches(&first, next).pair(&light, &light);
        assert_eq!(pair.matched + pair.outside + pair.hidden + pair.turned, pair.surfaces, "{pair:?}");
        pair
    };
    assert_eq!(count(&tilted(15.0)).matched, count(&first).surfaces);
    let turned = count(&tilted(25.0));
    assert_eq!((turned.flicker, turned.mean, turned.turned), (None, None, turned.surfaces));
    let empty = Surfaces { normals: vec![Vec3::ZERO; first.normals.len()], ..first.clone() };
    assert_eq!(count(&empty).hidden, count(&first).surfaces);
    let raised = see(seen, &[(Vec3::Y * 0.3, Vec3::Y)]);
    assert_eq!(count(&raised).matched, 0, "0.3 m are more than a pixel, everywhere");
    let behind = see(view(Vec3::new(0.0, 1.5, -8.0), Vec3::new(0.0, 1.0, -12.0), size), &[FLOOR]);
    assert_eq!(count(&behind).outside, count(&first).surfaces);
}

#[test]
fn a_walk_pools_its_pixels_and_keeps_its_mean_and_its_worst() {
    let pair = |flicker: f64, matched: u64| Pair {
        flicker: Some(flicker),
        mean: Some(flicker * 10.0),
        matched,
        surfaces: 2 * matched,
        outside: matched,
        hidden: 0,
        turned: 0,
        pixels: 100,
    };
    let none = Pair { flicker: None, mean: None, matched: 0, surfaces: 8, outside: 8, hidden: 0, turned: 0, pixels: 100 };
    let walk = Flicker::over(&[pair(3.0, 30), none, pair(4.0, 10)]).unwrap();
    assert!((walk.flicker - ((9.0 * 30.0 + 16.0 * 10.0) / 40.0f64).sqrt()).abs() < 1e-12);
    assert!((walk.mean - (30.0 * 30.0 + 40.0 * 10.0) / 40.0).abs() < 1e-12);
    assert_eq!((walk.mean_of_pairs, walk.largest, walk.matched_share), (3.5, 4.0, 40.0 / 88.0));
    assert_eq!(Flicker::over(&[none]), None);
    assert_eq!(Flicker::over(&[]), None);
}

#[test]
fn a_map_of_differences_is_black_but_where_it_changed_or_has_no_match() {
    let colors = difference_map(&[Some(0.0), Some(-0.5), Some(0.1), None], 1.0);
    let brightness = |i: usize| colors[3 * i..][..3].iter().map(|&v| u32::from(v)).sum::<u32>();
    assert!(brightness(0) < 10 && brightness(1) > 600 && brightness(2) > brightness(0) && brightness(2) < brightness(1), "{colors:?}");
    assert_eq!(colors[9..], UNMATCHED);
    assert_eq!(difference_map(&[Some(0.0)], 0.0), colors[..3]);
}

#[test]
fn the_nearest_pixel_is_that_whose_square_the_point_falls_into() {
    let size = [10, 8];
    let seen = view(Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO, size);
    let floor = see(seen, &[FLOOR]);
    let step = seen.pixel_size() as f32 * 4.0;
    for (offset, expected) in [(Vec2::ZERO, 33), (Vec2::new(0.45, -0.45), 33), (Vec2::new(0.55, 0.0), 34)] {
        let moved = floor.positions[33] + Vec3::new(offset.x, 0.0, offset.y) * step;
        assert_eq!(floor.fate(moved, Vec3::Y), Fate::Matched(expected), "{offset}");
    }
    assert_eq!(floor.fate(floor.positions[9] + Vec3::X * step, Vec3::Y), Fate::Outside);
}
