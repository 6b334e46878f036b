//! The tiled lean-to roofs, which fall towards the court.

use super::{EAVES, Part, Plan, Side, WALL};
use crate::scene::builder::Mesh;
use crate::scene::builtin::noise::unit;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The roof's extent: from the eaves, `INNER` inside the columns' axes, to the wall behind, `OUTER` outside them.
const INNER: f32 = WALL + 0.46;
const OUTER: f32 = super::DEPTH;
/// Rise over run.
const SLOPE: f32 = 0.36;
/// Distance of the tiles' ridges, and the visible length of a tile.
const PITCH: f32 = 0.27;
const COURSE: f32 = 0.46;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let (mut deck, mut tiles, mut valley) = (Mesh::default(), Mesh::default(), Mesh::default());
    for side in Side::all() {
        let mut lane = Mesh::default();
        let height = |out: f32| EAVES - 0.02 + SLOPE * (out + INNER);
        let normal = Vec3::new(0.0, 1.0, SLOPE).normalize();
        let half = side.half();
        lane.patch((half / plan.cell()).ceil() as usize, 4, |u, v| {
            // The deck begins a hand's breadth behind the tiles' lower ends, so that they overhang.
            let out = -(INNER - 0.12) + (OUTER + INNER - 0.12) * v;
            let x = (2.0 * u - 1.0) * (half + out);
            (Vec3::new(x, height(out), -out), normal, Vec2::new(x, out) / 1.5)
        });
        deck.append(&lane, side.frame);
        tiles.append(&covering(&side, plan), side.frame);
        // Lead along the diagonal where two roofs meet.
        let mut lead = Mesh::default();
        lead.patch(1, 1, |u, v| {
            let out = -INNER + (OUTER + INNER) * v;
            let x = half + out - 0.18 * (1.0 - u);
            (Vec3::new(x, height(out) + 0.11, -out), normal, Vec2::new(u, v))
        });
        lead.patch(1, 1, |u, v| {
            let out = -INNER + (OUTER + INNER) * v;
            let x = -(half + out - 0.18 * (1.0 - u));
            (Vec3::new(x, height(out) + 0.11, -out), normal, Vec2::new(u, v))
        });
        valley.append(&lead, side.frame);
    }
    let palette = &plan.palette;
    vec![Part::once(deck, palette.boards), Part::once(tiles, palette.roof), Part::once(valley, palette.lead)]
}

/// Rows of half-round tiles, cover over pan, each course lying on the one below.
fn covering(side: &Side, plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let around = plan.detail.count(4.0, 1);
    let courses = ((OUTER + INNER) / COURSE).round();
    let length = (OUTER + INNER) / courses;
    let top = side.half() + OUTER;
    let columns = (2.0 * top / PITCH) as u32;
    // Below the level of single tiles, the covers alone are drawn, as ridges.
    let along = if plan.detail.shows(0.36) { courses as usize } else { 1 };
    let salt = plan.seed ^ u32::from(side.frame.translation.x > 0.0) << 7 ^ u32::from(side.frame.translation.z > 0.0) << 8;
    let merge = if plan.detail.shows(0.36) {
        1
    } else if plan.detail.shows(0.06) {
        3
    } else {
        6
    };
    for column in (0..columns).step_by(merge) {
        let width = PITCH * merge as f32;
        let x = -top + (column as f32 + 0.5) * PITCH + 0.5 * (width - PITCH);
        // The first course inside the mitre.
        let start = (x.abs() + 0.5 * width - (side.half() - INNER)).max(0.0);
        let first = (start / length).floor() as usize;
        if start >= OUTER + INNER {
            continue;
        }
        let courses = if along == 1 { 0..1 } else { first..along };
        for course in courses {
            let (from, to) =
                if along == 1 { (start, OUTER + INNER) } else { (course as f32 * length, (course + 1) as f32 * length + 0.05) };
            let shake = (unit(column, course as u32, salt) - 0.5) * 0.025;
            let shade = unit(column, course as u32, salt ^ 77);
            mesh.surface(
                [around * 2, 1],
                false,
                |u, v| {
                    let out = from + (to - from) * v - INNER;
                    // The covers' arcs narrow upwards and slip under the next course.
                    let lift = if along == 1 { 0.06 } else { 0.045 * (1.0 - v) };
                    let wave = if u < 0.5 { (2.0 * PI * u).sin() * 0.075 } else { -(2.0 * PI * (u - 0.5)).sin() * 0.03 };
                    let y = EAVES + 0.05 + SLOPE * (out + INNER) + lift + wave + shake * 0.4;
                    Vec3::new(x + (u - 0.5) * width + shake * 0.3, y, -out)
                },
                |u, v| Vec2::new(0.25 * (shade * 4.0).floor() + 0.25 * u, v * 0.25 + shade),
            );
        }
    }
    mesh
}
