//! Roofs with their gables, gutters, dormers and chimneys, and the clock tower.

use super::lots::{Beside, House, Top};
use super::meshes::{Meshes, cells, mix};
use super::windows::quarter;
use super::{DEPTH, Plan};
use crate::scene::builder::Mesh;
use crate::scene::builtin::noise::unit;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

pub fn build(out: &mut Meshes, house: &House, plan: &Plan) {
    let (eaves, z) = (house.eaves(), house.projection());
    let palette = &plan.palette;
    let ridge = Vec2::new(-0.5 * DEPTH, eaves);
    match house.lot.top {
        Top::Parapet | Top::Tower => {
            slope(out.of(palette.gravel), house, [Vec2::new(z - 0.2, eaves), Vec2::new(-DEPTH, eaves)], 3.0, plan);
            if house.lot.top == Top::Tower {
                tower(out, house, plan);
            } else {
                hatch(out, house, plan);
            }
        }
        Top::Tiles => {
            let ridge = ridge + Vec2::Y * 2.9;
            let line = [Vec2::new(z + 0.44, eaves), ridge, Vec2::new(-DEPTH, eaves)];
            for pair in line.windows(2) {
                slope(out.of(palette.clay), house, [pair[0], pair[1]], 2.4, plan);
            }
            gables(out, house, &line, plan);
            gutter(out, house, [eaves - 0.07, eaves + 0.05], [z + 0.36, z + 0.50], plan);
            cap(out, house, ridge, palette.clay, plan);
            chimneys(out, house, ridge.y, plan);
        }
        Top::Mansard => {
            let line = [
                Vec2::new(z + 0.02, eaves),
                Vec2::new(z - 1.1, eaves + 2.7),
                ridge + Vec2::Y * 3.5,
                Vec2::new(1.1 - DEPTH, eaves + 2.7),
                Vec2::new(-DEPTH, eaves),
            ];
            for (i, pair) in line.windows(2).enumerate() {
                let material = if i == 1 || i == 2 { palette.zinc } else { palette.slate };
                slope(out.of(material), house, [pair[0], pair[1]], 2.0, plan);
            }
            gables(out, house, &line, plan);
            gutter(out, house, [eaves - 0.02, eaves + 0.11], [z + 0.24, z + 0.36], plan);
            // A roll of zinc where the steep part ends.
            let (width, edge) = (house.lot.width, line[1]);
            let (min, max) = (Vec3::new(0.0, edge.y - 0.08, edge.x - 0.12), Vec3::new(width, edge.y + 0.08, edge.x + 0.07));
            out.of(palette.zinc).solid(min, max, plan.cell(), 1.0);
            dormers(out, house, plan);
            chimneys(out, house, ridge.y + 3.5, plan);
        }
    }
}

/// A part of a roof over the whole width, between two points (z, y) of its section, facing up.
fn slope(mesh: &mut Mesh, house: &House, [from, to]: [Vec2; 2], tile: f32, plan: &Plan) {
    let length = from.distance(to);
    let normal = Vec3::new(0.0, from.x - to.x, to.y - from.y).normalize();
    let width = house.lot.width;
    mesh.patch(cells(width, plan.cell()), cells(length, plan.cell()), |u, v| {
        let at = Vec3::new(mix(0.0, width, u), mix(from.y, to.y, v), mix(from.x, to.x, v));
        // The texture's top is the roof's.
        let up = if to.y >= from.y { v } else { 1.0 - v };
        (at, normal, Vec2::new(at.x, -length * up) / tile)
    });
}

/// The walls at both sides between the eaves and the roof.
fn gables(out: &mut Meshes, house: &House, line: &[Vec2], plan: &Plan) {
    let mesh = out.of(plan.palette.walls[house.lot.walls[1] as usize]);
    let eaves = house.eaves();
    for (x, normal) in [(0.0, Vec3::NEG_X), (house.lot.width, Vec3::X)] {
        for pair in line.windows(2) {
            let along = cells(pair[0].distance(pair[1]), plan.cell());
            let up = cells(pair[0].y.max(pair[1].y) - eaves, plan.cell());
            mesh.patch(along, up, |u, v| {
                let (z, top) = (mix(pair[0].x, pair[1].x, u), mix(pair[0].y, pair[1].y, u));
                let at = Vec3::new(x, mix(eaves, top, v), z);
                (at, normal, Vec2::new(at.z, -at.y) / 3.0)
            });
        }
    }
}

fn gutter(out: &mut Meshes, house: &House, [y0, y1]: [f32; 2], [z0, z1]: [f32; 2], plan: &Plan) {
    let overhang = house.beside.map(|beside| if matches!(beside, Beside::Street) { 0.06 } else { 0.0 });
    let (min, max) = (Vec3::new(-overhang[0], y0, z0), Vec3::new(house.lot.width + overhang[1], y1, z1));
    out.of(plan.palette.zinc).solid(min, max, plan.cell(), 1.0);
}

/// A row of tiles along the ridge.
fn cap(out: &mut Meshes, house: &House, ridge: Vec2, material: u32, plan: &Plan) {
    if plan.detail.shows(0.3) {
        let width = house.lot.width;
        let count = cells(width, plan.cell());
        let around = plan.detail.count(6.0, 2);
        out.of(material).patch(count, around, |u, v| {
            let (sin, cos) = (FRAC_PI_2 * 1.5 * (2.0 * v - 1.0)).sin_cos();
            let at = Vec3::new(width * u, ridge.y - 0.06 + 0.13 * cos, ridge.x + 0.14 * sin);
            (at, Vec3::new(0.0, cos, sin), Vec2::new(at.x, 0.3 * v) / 2.4)
        });
    }
}

/// A stack at each side of the ridge, with pots.
fn chimneys(out: &mut Meshes, house: &House, ridge: f32, plan: &Plan) {
    let width = house.lot.width;
    for (hand, at) in [0.12, 0.86].into_iter().enumerate() {
        let tall = 0.9 + 0.7 * unit(house.number, hand as u32, 0xc41);
        let (x, z) = (width * at, -0.5 * DEPTH - 0.25);
        let brick = out.of(plan.palette.walls[super::lots::Wall::RedBrick as usize]);
        brick.divided_cuboid(
            Vec3::new(x - 0.62, ridge - 0.9, z - 0.34),
            Vec3::new(x + 0.62, ridge + tall, z + 0.34),
            "-x+x-z+z",
            plan.cell(),
            1.92,
        );
        let stone = out.of(plan.palette.limestone);
        if plan.detail.shows(0.06) {
            let (min, max) = (Vec3::new(x - 0.70, ridge + tall, z - 0.42), Vec3::new(x + 0.70, ridge + tall + 0.12, z + 0.42));
            stone.solid(min, max, f32::INFINITY, 1.5);
        } else {
            stone.cuboid(Vec3::new(x - 0.62, ridge, z - 0.34), Vec3::new(x + 0.62, ridge + tall, z + 0.34), "+y", 1.5);
        }
        if plan.detail.shows(0.22) {
            let profile = Profile::from(0.15, 0.0).line(0.12, 0.40).torus(0.03, 0.48, 3.0).line(0.09, 0.48).line(0.08, 0.30);
            let mut pot = Mesh::default();
            pot.lathe(&profile, plan.detail.count(12.0, 4), plan.detail, 0.7);
            for i in 0..3 {
                let place = Vec3::new(x + 0.42 * (i as f32 - 1.0), ridge + tall + 0.12, z);
                out.of(plan.palette.pots).append(&pot, Affine3A::from_translation(place));
            }
        }
    }
}

/// Windows in the steep part of the roof.
fn dormers(out: &mut Meshes, house: &House, plan: &Plan) {
    let (eaves, z) = (house.eaves(), house.projection() - 0.14);
    let pitch = house.lot.width / house.lot.bays as f32;
    for bay in 0..house.lot.bays {
        let x = (bay as f32 + 0.5) * pitch;
        let (low, high) = (eaves + 0.35, eaves + 2.15);
        let half = (0.32 * pitch).min(0.72);
        let stone = out.of(plan.palette.lime);
        stone.cuboid(Vec3::new(x - half, low, z - 1.2), Vec3::new(x + half, high, z), "-x+x-y+z", 3.0);
        let zinc = out.of(plan.palette.zinc);
        zinc.solid(Vec3::new(x - half - 0.1, high, z - 1.25), Vec3::new(x + half + 0.1, high + 0.1, z + 0.14), f32::INFINITY, 1.0);
        let inset = half - 0.16;
        let picture = quarter(house.number * 64 + bay as u32, plan.seed ^ 0xd0);
        out.of(plan.palette.glazing).picture([x - inset, x + inset], [low + 0.3, high - 0.16], z + 0.012, picture, plan.cell());
        if plan.detail.shows(0.5) {
            let frames = out.of(plan.palette.frames);
            let (y0, y1) = (low + 0.3, high - 0.16);
            for [x0, x1, y0, y1] in [
                [x - inset - 0.06, x - inset + 0.02, y0, y1],
                [x + inset - 0.02, x + inset + 0.06, y0, y1],
                [x - inset - 0.06, x + inset + 0.06, y1, y1 + 0.07],
                [x - inset - 0.10, x + inset + 0.10, y0 - 0.07, y0],
            ] {
                frames.block([x0, x1], [y0, y1], [z, z + 0.06], 1.5);
            }
        }
    }
}

/// A box over the stairs to a flat roof, and a skylight.
fn hatch(out: &mut Meshes, house: &House, plan: &Plan) {
    let (eaves, width) = (house.eaves(), house.lot.width);
    let x = width * (0.3 + 0.4 * unit(house.number, 4, 0x4a));
    let wall = out.of(plan.palette.lime);
    wall.divided_cuboid(Vec3::new(x - 1.3, eaves - 0.05, -8.6), Vec3::new(x + 1.3, eaves + 2.3, -6.0), "-x+x-z+z", plan.cell(), 3.0);
    let zinc = out.of(plan.palette.zinc);
    zinc.solid(Vec3::new(x - 1.45, eaves + 2.3, -8.75), Vec3::new(x + 1.45, eaves + 2.42, -5.85), plan.cell(), 1.0);
}

/// Half the side of the tower, and its height over the eaves to the cornice.
const TOWER: f32 = 2.5;
const SHAFT: f32 = 8.2;

/// A tower over the middle of the front, with a clock on three sides and a pyramid on top.
fn tower(out: &mut Meshes, house: &House, plan: &Plan) {
    let eaves = house.eaves();
    let palette = &plan.palette;
    let place = Affine3A::from_translation(Vec3::new(0.5 * house.lot.width, eaves, house.projection() - 0.5 - TOWER));
    let mut built = Meshes::default();
    let wall = built.of(palette.walls[house.lot.walls[1] as usize]);
    wall.divided_cuboid(Vec3::new(-TOWER, -0.1, -TOWER), Vec3::new(TOWER, SHAFT, TOWER), "-x+x-z+z", plan.cell(), 3.0);
    let half = Vec2::splat(TOWER);
    let stone = built.of(palette.limestone);
    for y in [1.0, 4.2] {
        let course = Profile::from(-0.01, y)
            .line(0.08, y)
            .line(0.08, y + 0.12)
            .curve((0.10, y + 0.18), (0.16, y + 0.19), 3.0)
            .line(0.16, y + 0.27)
            .line(-0.01, y + 0.31);
        stone.frame(&course, half, true, plan.cell(), plan.detail, 1.5);
    }
    let cornice = Profile::from(-0.01, SHAFT - 0.55)
        .line(0.08, SHAFT - 0.55)
        .torus(0.04, SHAFT - 0.45, 3.0)
        .line(0.10, SHAFT - 0.25)
        .line(0.34, SHAFT - 0.21)
        .line(0.34, SHAFT - 0.11)
        .curve((0.40, SHAFT - 0.08), (0.44, SHAFT - 0.03), 3.0)
        .line(0.50, SHAFT)
        .line(-0.01, SHAFT);
    stone.frame(&cornice, half, true, plan.cell(), plan.detail, 1.5);
    for turn in [0.0, FRAC_PI_2, -FRAC_PI_2] {
        let face = Affine3A::from_rotation_y(turn) * Affine3A::from_translation(Vec3::Z * TOWER);
        built.append(&clock(plan), face * Affine3A::from_translation(Vec3::Y * 6.0));
        built.append(&louvres(plan), face * Affine3A::from_translation(Vec3::Y * 1.55));
    }
    // The pyramid, in four faces that meet in a point.
    let (foot, tall) = (TOWER + 0.42, 5.2);
    let mut face = Mesh::default();
    let rows = cells(tall, plan.cell());
    let normal = Vec3::new(0.0, foot, tall).normalize();
    face.patch(cells(2.0 * foot, plan.cell()), rows, |u, v| {
        let across = foot * (1.0 - v);
        let at = Vec3::new(across * (2.0 * u - 1.0), mix(SHAFT - 0.005, SHAFT + tall, v), across);
        (at, normal, Vec2::new(at.x, -v * tall.hypot(foot)) / 2.0)
    });
    for i in 0..4 {
        built.of(palette.slate).append(&face, Affine3A::from_quat(Quat::from_rotation_y(FRAC_PI_2 * i as f32)));
    }
    let finial = Profile::from(0.14, SHAFT + tall - 0.25)
        .line(0.05, SHAFT + tall + 0.2)
        .curve((0.20, SHAFT + tall + 0.25), (0.20, SHAFT + tall + 0.4), 4.0)
        .curve((0.20, SHAFT + tall + 0.55), (0.04, SHAFT + tall + 0.6), 4.0)
        .line(0.02, SHAFT + tall + 1.6)
        .line(0.0, SHAFT + tall + 1.62);
    built.of(palette.zinc).lathe(&finial, plan.detail.count(12.0, 4), plan.detail, 1.0);
    out.append(&built, place);
}

/// A clock face in a ring of stone, with hours and hands, facing +z on the plane z = 0.
fn clock(plan: &Plan) -> Meshes {
    let mut built = Meshes::default();
    let upright = Affine3A::from_rotation_x(FRAC_PI_2);
    let sides = plan.detail.count(40.0, 10);
    let mut ring = Mesh::default();
    let profile = Profile::from(1.45, -0.05)
        .line(1.45, 0.10)
        .curve((1.42, 0.18), (1.34, 0.18), 3.0)
        .curve((1.24, 0.18), (1.22, 0.08), 3.0)
        .line(1.20, 0.02);
    ring.lathe(&profile, sides, plan.detail, 1.5);
    built.of(plan.palette.limestone).append(&ring, upright);
    let mut face = Mesh::default();
    face.lathe(&Profile::from(1.24, 0.04).line(0.6, 0.05).line(0.0, 0.05), sides, plan.detail, 1.0);
    built.of(plan.palette.clock).append(&face, upright);
    let iron = built.of(plan.palette.iron);
    for hour in 0..12 {
        let mut mark = Mesh::default();
        mark.block([-0.035, 0.035], [0.88, 1.10], [0.03, 0.07], 1.0);
        iron.append(&mark, Affine3A::from_rotation_z(TAU * hour as f32 / 12.0));
    }
    for (angle, long, half) in [(0.9, 0.62, 0.05), (-2.3, 0.92, 0.035)] {
        let mut hand = Mesh::default();
        hand.block([-half, half], [-0.14, long], [0.04, 0.09 + 0.1 * half], 1.0);
        iron.append(&hand, Affine3A::from_rotation_z(angle));
    }
    built
}

/// Two louvred openings of a belfry, facing +z on the plane z = 0.
fn louvres(plan: &Plan) -> Meshes {
    let mut built = Meshes::default();
    for x in [-0.95, 0.95] {
        let stone = built.of(plan.palette.limestone);
        stone.block([x - 0.62, x - 0.45], [0.0, 2.0], [0.0, 0.12], 1.5);
        stone.block([x + 0.45, x + 0.62], [0.0, 2.0], [0.0, 0.12], 1.5);
        stone.block([x - 0.70, x + 0.70], [2.0, 2.2], [0.0, 0.16], 1.5);
        stone.block([x - 0.70, x + 0.70], [-0.14, 0.0], [0.0, 0.18], 1.5);
        let wood = built.of(plan.palette.shutters[2]);
        let count = plan.detail.count(12.0, 4);
        let pitch = 2.0 / count as f32;
        for slat in 0..count {
            let y = slat as f32 * pitch;
            let normal = Vec3::new(0.0, 0.06, pitch).normalize();
            wood.patch(1, 1, |u, v| {
                let at = Vec3::new(x - 0.45 + 0.9 * u, y + pitch * v, 0.02 + 0.06 * (1.0 - v));
                (at, normal, Vec2::new(at.y, at.x))
            });
        }
    }
    built
}
