//! One bounce of indirect light against sums computed without the engine.

use crate::common::*;
use glam::{DQuat, DVec3, Vec3};
use manylight::config::{Block, Config, LightConfig};
use manylight::output::Picture;
use manylight::scene::{Material, Scene};
use std::f64::consts::PI;

const SIZE: DVec3 = DVec3::new(4.0, 3.0, 5.0);
const ALBEDOS: [DVec3; 6] = [
    DVec3::new(0.8, 0.2, 0.1),
    DVec3::new(0.1, 0.7, 0.3),
    DVec3::new(0.6, 0.6, 0.6),
    DVec3::new(0.9, 0.8, 0.7),
    DVec3::new(0.3, 0.4, 0.9),
    DVec3::new(0.5, 0.5, 0.2),
];
/// Side of the map, texels.
const MAP: u32 = 128;
/// Distance to another wall below which receivers count as at an edge, m.
const EDGE: f64 = 0.5;

/// A view from a corner of the turned room onto floor, walls and some ceiling.
fn config(turn: DQuat, light: LightConfig, vpls: u32) -> Config {
    let turned = |v: DVec3| (turn * v).as_vec3();
    let mut config = plain([64, 64], turned(DVec3::new(3.6, 1.7, 4.6)), turned(DVec3::new(1.0, 1.2, 0.5)), 95.0, light);
    config.rsm.size = [MAP, MAP];
    config.vpls.count = vpls;
    config
}

/// Position, normal and irradiance of pixels away from edges.
fn receivers(picture: &Picture, walls: &[Wall]) -> Vec<(DVec3, DVec3, DVec3)> {
    let (positions, normals) = (picture.positions(), picture.normals());
    let irradiance: Vec<Vec3> = picture.irradiance.rgb().collect();
    (0..positions.len())
        .filter(|i| picture.depth.values[*i] > 0.0)
        .map(|i| (positions[i].as_dvec3(), normals[i].as_dvec3(), irradiance[i].as_dvec3()))
        .filter(|(x, n, _)| walls.iter().all(|wall| wall.normal.dot(*n) > 0.9 || (*x - wall.corner).dot(wall.normal) > EDGE))
        .collect()
}

/// Mean relative error of all channels.
fn mean_error(pairs: &[(DVec3, DVec3)]) -> f64 {
    pairs.iter().map(|(found, expected)| ((*found - *expected).abs() / *expected).element_sum() / 3.0).sum::<f64>() / pairs.len() as f64
}

/// Compares a room under a light with the sum over its walls; `lit` is their direct irradiance.
fn compare(turn: DQuat, walls: &[Wall], light: LightConfig, lit: impl Fn(&Wall, DVec3) -> DVec3) {
    let mut renderer = renderer(room(walls));
    let every = picture(&mut renderer, &config(turn, light.clone(), MAP * MAP));
    let sampled = picture(&mut renderer, &config(turn, light, 1024));
    finish(renderer.gpu());

    let all = receivers(&every, walls);
    assert!(all.len() > 1000, "{} receivers", all.len());
    let against_walls: Vec<_> = all.iter().step_by(7).map(|(x, n, found)| (*found, one_bounce(walls, 0.0, 96, *x, *n, &lit))).collect();
    let error = mean_error(&against_walls);
    println!("all texels against the walls: {:.3} % over {} pixels", error * 100.0, against_walls.len());
    assert!(error < 0.02, "all texels differ from the walls by {:.2} %", error * 100.0);

    let against_all: Vec<_> =
        receivers(&sampled, walls).iter().zip(&all).map(|((_, _, found), (_, _, expected))| (*found, *expected)).collect();
    let error = mean_error(&against_all);
    println!("1,024 VPLs against all texels: {:.3} %", error * 100.0);
    assert!(error < 0.02, "1,024 VPLs differ from all texels by {:.2} %", error * 100.0);
    assert!(error > 1e-6, "1,024 VPLs cannot be all texels");
}

#[test]
fn a_closed_box_under_a_spot_light_gets_the_one_bounce_light_that_its_walls_reflect() {
    let walls = walls(SIZE, ALBEDOS);
    let (position, direction) = (DVec3::new(1.8, 2.6, 2.2), DVec3::new(0.2, -1.0, 0.1).normalize());
    let intensity = DVec3::new(20.0, 15.0, 10.0);
    let (inner, outer) = (25.0f64, 55.0f64);
    let light = spot(position.as_vec3(), direction.as_vec3(), intensity.as_vec3().into(), inner as f32, outer as f32);
    compare(DQuat::IDENTITY, &walls, light, |wall, y| {
        let d = y - position;
        let angle = (d.dot(direction) / d.length()).clamp(-1.0, 1.0).acos();
        let cosine = (-d.dot(wall.normal) / d.length()).max(0.0);
        intensity * linear_falloff(angle, inner * PI / 180.0, outer * PI / 180.0) * (cosine / d.length_squared())
    });
}

/// The box has no lid, whose back would stop the light: the sun reaches surfaces that see it through the opening. The box is
/// turned, so that the light's edges do not coincide with rows of samples.
#[test]
fn an_open_box_under_the_sun_gets_the_one_bounce_light_that_its_walls_reflect() {
    let turn = DQuat::from_rotation_y(0.4);
    let turned = |wall: Wall| Wall {
        corner: turn * wall.corner,
        u: turn * wall.u,
        v: turn * wall.v,
        normal: turn * wall.normal,
        albedo: wall.albedo,
    };
    let walls: Vec<Wall> = walls(SIZE, ALBEDOS).into_iter().enumerate().filter(|(i, _)| *i != 3).map(|(_, wall)| turned(wall)).collect();
    let direction = turn * DVec3::new(0.35, -1.0, -0.25).normalize();
    let irradiance = DVec3::new(3.0, 2.5, 2.0);
    let light = directional(direction.as_vec3(), irradiance.as_vec3().into());
    compare(turn, &walls, light, |wall, y| {
        // The way back along the light, up to the height of the opening.
        let out = turn.inverse() * (y - direction * ((SIZE.y - y.y) / -direction.y));
        let seen = out.x > 0.0 && out.x < SIZE.x && out.z > 0.0 && out.z < SIZE.z;
        let cosine = (-direction.dot(wall.normal)).max(0.0);
        if seen { irradiance * cosine } else { DVec3::ZERO }
    });
}

#[test]
fn interleaving_keeps_the_mean_of_every_block_of_its_pattern() {
    let walls = walls(SIZE, ALBEDOS);
    let mut renderer = renderer(room(&walls));
    // The view is of the far half of the side wall: light from the floor is smooth there, and nearly equal over a block's
    // pixels.
    let light = spot(Vec3::new(2.0, 2.8, 2.5), Vec3::new(0.0, -1.0, 0.0), [10.0; 3], 10.0, 35.0);
    let mut config = plain([128, 128], Vec3::new(3.5, 1.8, 2.5), Vec3::new(0.0, 1.8, 2.5), 30.0, light);
    config.rsm.size = [MAP, MAP];
    config.vpls.count = 4096;
    let mut blocks = |interleave: Block| {
        config.gather.interleave = interleave;
        let picture = picture(&mut renderer, &config);
        let texels: Vec<Vec3> = picture.irradiance.rgb().collect();
        let block = |i: usize| {
            let (x, y) = (i % 16 * 8, i / 16 * 8);
            (0..64).map(|k| texels[(y + k / 8) * 128 + x + k % 8].as_dvec3()).sum::<DVec3>() / 64.0
        };
        (texels.clone(), (0..256).map(block).collect::<Vec<_>>())
    };
    let (plain, expected) = blocks(1.into());
    for interleave in [[2, 2], [4, 2], [4, 4], [1, 8], [8, 8]].map(Block) {
        let (texels, found) = blocks(interleave);
        assert_ne!(texels, plain, "interleaving changes single pixels");
        let errors = found.iter().zip(&expected).map(|(a, b)| ((*a - *b).abs() / *b).max_element());
        let worst = errors.fold(0.0, f64::max);
        println!("interleave {interleave}: the worst block is off by {:.3} %", worst * 100.0);
        assert!(worst < 0.01, "interleave {interleave}: a block is off by {:.2} %", worst * 100.0);
    }
    finish(renderer.gpu());
}

#[test]
fn the_least_distance_bounds_what_near_lights_give_and_no_others() {
    let walls = walls(SIZE, ALBEDOS);
    let mut renderer = renderer(room(&walls));
    let (position, intensity) = (DVec3::new(2.0, 2.8, 2.5), DVec3::splat(10.0));
    let light = spot(position.as_vec3(), Vec3::NEG_Y, intensity.as_vec3().into(), 30.0, 40.0);
    let mut config = config(DQuat::IDENTITY, light, MAP * MAP);
    config.gather.min_distance = 1.5;
    let picture = picture(&mut renderer, &config);
    finish(renderer.gpu());
    let lit = |wall: &Wall, y: DVec3| {
        let d = y - position;
        let falloff = linear_falloff((-d.y / d.length()).acos(), 30f64.to_radians(), 40f64.to_radians());
        intensity * falloff * ((-d.dot(wall.normal)).max(0.0) / d.length() / d.length_squared())
    };
    let receivers = receivers(&picture, &walls);
    let against = |nearest: f64| {
        let pairs = receivers.iter().step_by(11).map(|(x, n, found)| (*found, one_bounce(&walls, nearest, 96, *x, *n, lit)));
        // The floor is left out: it is coplanar with everything lit, and gets no light.
        mean_error(&pairs.filter(|(_, expected)| expected.min_element() > 1e-6).collect::<Vec<_>>())
    };
    let (bounded, free) = (against(1.5), against(0.0));
    println!("{:.3} % with the bound, {:.3} % without it", bounded * 100.0, free * 100.0);
    assert!(bounded < 0.02 && free > 0.05, "off by {bounded} with the bound and by {free} without it");
}

#[test]
fn the_back_of_a_single_sided_wall_stops_light_and_reflects_none() {
    for double_sided in [false, true] {
        // A floor, and a wall across its middle, lit by the sun from behind.
        let mut scene = Scene { name: "wall".into(), ..Scene::default() };
        let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        add_quad(
            &mut scene,
            [corner(-4.0, 0.0, 3.0), corner(4.0, 0.0, 3.0), corner(4.0, 0.0, -3.0), corner(-4.0, 0.0, -3.0)],
            matte([0.5; 3]),
        );
        let material = Material { double_sided, ..matte([0.8; 3]) };
        add_quad(&mut scene, [corner(0.0, 0.0, -3.0), corner(0.0, 0.0, 3.0), corner(0.0, 2.0, 3.0), corner(0.0, 2.0, -3.0)], material);
        let mut renderer = renderer(scene);
        let sun = directional(Vec3::new(-1.0, -1.0, 0.0).normalize(), [3.0; 3]);
        let mut config = plain([64, 64], Vec3::new(0.0, 9.0, 0.01), Vec3::ZERO, 40.0, sun);
        config.rsm.size = [MAP, MAP];
        config.direct.shadows = manylight::config::Shadows::PercentageCloser;
        let picture = picture(&mut renderer, &config);
        finish(renderer.gpu());
        let (mut before, mut behind) = (0, 0);
        for (i, x) in picture.positions().into_iter().enumerate().filter(|(_, x)| x.y.abs() < 1e-3 && x.z.abs() < 2.0) {
            let (bounced, direct) = (picture.irradiance.at(i)[0], picture.direct.at(i)[0]);
            if x.x > 0.3 && x.x < 2.0 {
                before += 1;
                assert_eq!(bounced > 0.01, double_sided, "at {x} before the wall there is {bounced}");
                assert!(direct > 0.1, "at {x} before the wall there is {direct}");
            } else if x.x < -0.3 && x.x > -1.7 {
                behind += 1;
                assert_eq!((bounced, direct), (0.0, 0.0), "at {x} behind the wall");
            }
        }
        assert!(before > 100 && behind > 100, "{before} pixels before and {behind} behind the wall");
    }
}

#[test]
fn a_pixel_can_take_sixty_thousand_vpls_and_no_more_than_drivers_sum() {
    let walls = walls(SIZE, ALBEDOS);
    let light = spot(Vec3::new(2.0, 2.8, 2.5), Vec3::new(0.1, -1.0, 0.2), [50.0; 3], 30.0, 40.0);
    let mut renderer = renderer(room(&walls));
    let mut config = config(DQuat::IDENTITY, light, 60_000);
    config.rsm.size = [256, 256];
    let mut mean = |interleave: u32| {
        config.gather.interleave = interleave.into();
        let picture = picture(&mut renderer, &config);
        picture.irradiance.rgb().map(|c| f64::from(c.x + c.y + c.z)).sum::<f64>() / 4096.0
    };
    let (whole, quarters) = (mean(1), mean(2));
    assert!(whole > 0.0 && (whole / quarters - 1.0).abs() < 2e-3, "{whole} in one go, {quarters} in quarters");

    config.gather.interleave = 1.into();
    config.rsm.size = [512, 512];
    let refused = |renderer: &manylight::renderer::Renderer, config: &Config| renderer.check(config).unwrap_err().to_string();
    config.vpls.count = 512 * 512;
    assert!(refused(&renderer, &config).starts_with("gather.interleave: 1 leaves 262144 VPLs"));
    config.vpls.count = 512 * 512 + 1;
    assert!(refused(&renderer, &config).starts_with("vpls.count: 262145 is out of range, expected 1 to 262144"));
    finish(renderer.gpu());
}
