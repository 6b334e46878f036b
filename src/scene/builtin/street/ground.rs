//! The carriageways, the kerbs and the pavements.

use super::meshes::cells;
use super::{CROSS, END, FRONT, HALF, KERB, Plan, ROAD, WALK};
use crate::scene::builder::Mesh;
use crate::scene::builtin::parts::Part;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Width of the kerbs' stones.
const STONE: f32 = 0.15;
/// Height of the pavements' slabs: a little below the kerbs.
const SLAB: f32 = KERB - 0.006;
/// Radius of the kerbs around the corners.
const ROUND: f32 = 2.5;
/// How far the ground goes on under what stands beside it.
const UNDER: f32 = 0.1;
/// The crossings' lanes: from here, and so long.
const CROSSING: [f32; 2] = [50.0, 4.0];
/// The kerbs of the cross streets: the near one's distance from the middle of the street, and the far one's.
const ACROSS: [f32; 2] = [HALF + WALK, HALF + CROSS - WALK];

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let cell = plan.cell();
    let (edge, far) = (ROAD + 0.05, END + UNDER);
    let metres = |p: Vec2| p / 4.0;
    let width = |p: Vec2| 0.5 + p.y / (2.0 * ROAD);

    let mut lanes = Mesh::default();
    let [begin, long] = CROSSING;
    lanes.floor([&[-begin, begin], &[-edge, edge]], 0.0, cell, |_, _| false, |p| Vec2::new(p.x / 12.0, width(p)));
    let (mut crossing, mut asphalt) = (Mesh::default(), Mesh::default());
    let mirror_x = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let mirror_z = Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.0));
    let mut end = Mesh::default();
    end.floor([&[begin, begin + long], &[-edge, edge]], 0.0, cell, |_, _| false, |p| Vec2::new((p.x - begin) / long, width(p)));
    both(&mut crossing, &end, mirror_x);
    // The junction: the carriageway between the corners, and the cross street.
    let round = ROAD + ROUND + 0.05;
    let xs = [begin + long, ACROSS[0] - ROUND - 0.05, ACROSS[0] - 0.05, ACROSS[1] + 0.05];
    let zs = [-far, -round, -edge, edge, round, far];
    let mut junction = Mesh::default();
    junction.floor([&xs, &zs], 0.0, cell, |i, j| (j == 0 || j == 4) && i < 2 || (j == 1 || j == 3) && i < 1, metres);
    both(&mut asphalt, &junction, mirror_x);

    // The pavements of one side, then of both. They end under the kerbs' stones.
    let under = ROAD + STONE - 0.05;
    let corner = Vec2::new(ACROSS[0] - ROUND, ROAD + ROUND);
    let metres = |p: Vec2| p / 3.0;
    let mut side = Mesh::default();
    side.floor([&[-corner.x, corner.x], &[under, corner.y, FRONT + UNDER]], SLAB, cell, |_, _| false, metres);
    let mut beyond = Mesh::default();
    let inner = ACROSS[0] - STONE + 0.05;
    beyond.floor([&[HALF - UNDER, corner.x, inner], &[corner.y, FRONT + UNDER, far]], SLAB, cell, |i, j| i == 0 && j == 0, metres);
    let radius = corner.y - under;
    beyond.patch(plan.detail.count(10.0, 4).max(cells(ROUND, cell)), cells(radius, cell), |u, v| {
        let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
        let at = corner + radius * v * Vec2::new(sin, -cos);
        (Vec3::new(at.x, SLAB, at.y), Vec3::Y, metres(at))
    });
    both(&mut side, &beyond, mirror_x);
    let mut slabs = Mesh::default();
    both(&mut slabs, &side, mirror_z);
    let mut end = Mesh::default();
    let inner = ACROSS[1] + STONE - 0.05;
    end.floor([&[inner, HALF + CROSS + UNDER], &[-far, far]], SLAB, cell, |_, _| false, metres);
    both(&mut slabs, &end, mirror_x);

    let mut kerbs = Mesh::default();
    let mut side = Mesh::default();
    kerb(&mut side, &around(plan), plan);
    both(&mut kerbs, &side, mirror_z);
    let mut end = Mesh::default();
    let line = |z: f32| (Vec2::new(ACROSS[1], z), Vec2::NEG_X);
    kerb(&mut end, &straight(line(-far), line(far), cell), plan);
    both(&mut kerbs, &end, mirror_x);

    let covers = if plan.detail.shows(0.15) { covers(plan) } else { Mesh::default() };
    vec![
        Part::once(lanes, palette.lanes),
        Part::once(crossing, palette.crossing),
        Part::once(asphalt, palette.asphalt),
        Part::once(slabs, palette.slabs),
        Part::once(kerbs, palette.kerb),
        Part::once(covers, palette.iron),
    ]
}

/// Adds a mesh and its mirror image.
fn both(mesh: &mut Mesh, half: &Mesh, mirror: Affine3A) {
    mesh.append(half, Affine3A::IDENTITY);
    mesh.append(half, mirror);
}

/// Points of a kerb's edge, and the directions from there to the road.
type Edge = Vec<(Vec2, Vec2)>;

fn straight(from: (Vec2, Vec2), to: (Vec2, Vec2), cell: f32) -> Edge {
    let count = cells(from.0.distance(to.0), cell);
    (0..=count).map(|i| (from.0.lerp(to.0, i as f32 / count as f32), from.1)).collect()
}

/// The edge of the pavement at +z: along a cross street, around the corner, along the street, and around the other corner.
fn around(plan: &Plan) -> Edge {
    let cell = plan.cell();
    let corner = Vec2::new(ACROSS[0] - ROUND, ROAD + ROUND);
    let turns = plan.detail.count(10.0, 4);
    let arc = |hand: f32| {
        (0..=turns).map(move |i| {
            let (sin, cos) = (FRAC_PI_2 * i as f32 / turns as f32).sin_cos();
            let out = if hand > 0.0 { Vec2::new(cos, -sin) } else { Vec2::new(-sin, -cos) };
            (Vec2::new(hand * corner.x, corner.y) + ROUND * out, out)
        })
    };
    let mut edge = straight((Vec2::new(ACROSS[0], END + UNDER), Vec2::X), (Vec2::new(ACROSS[0], corner.y), Vec2::X), cell);
    edge.extend(arc(1.0).skip(1));
    edge.extend(straight((Vec2::new(corner.x, ROAD), Vec2::NEG_Y), (Vec2::new(-corner.x, ROAD), Vec2::NEG_Y), cell).into_iter().skip(1));
    edge.extend(arc(-1.0).skip(1));
    edge.extend(
        straight((Vec2::new(-ACROSS[0], corner.y), Vec2::NEG_X), (Vec2::new(-ACROSS[0], END + UNDER), Vec2::NEG_X), cell)
            .into_iter()
            .skip(1),
    );
    edge
}

/// The kerb's stones along an edge.
fn kerb(mesh: &mut Mesh, edge: &[(Vec2, Vec2)], plan: &Plan) {
    let profile = Profile::from(0.0, -0.05).line(0.0, KERB - 0.035).curve((0.0, KERB), (-0.035, KERB), 3.0);
    // The back is too low to be kept where mouldings are simplified: the stones would slope away under the pavement's edge.
    let profile = if plan.detail.shows(0.12) { profile.line(-STONE, KERB).line(-STONE, KERB - 0.03) } else { profile.line(-STONE, SLAB) };
    let lengths: Vec<f32> = edge
        .iter()
        .scan((edge[0].0, 0.0), |(last, length), (point, _)| {
            *length += point.distance(*last);
            *last = *point;
            Some(*length)
        })
        .collect();
    for run in profile.runs(plan.detail) {
        let last = run.len() - 1;
        mesh.patch(edge.len() - 1, last, |u, v| {
            let i = (u * (edge.len() - 1) as f32).round() as usize;
            let sample = run[(v * last as f32).round() as usize];
            let (point, out) = edge[i];
            let at = point + out * sample.point.x;
            let normal = Vec3::new(out.x * sample.normal.x, sample.normal.y, out.y * sample.normal.x);
            (Vec3::new(at.x, sample.point.y, at.y), normal, Vec2::new(lengths[i], -sample.length) / 1.5)
        });
    }
}

/// Covers of manholes.
fn covers(plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let mut cover = Mesh::default();
    let profile = Profile::from(0.36, -0.01).line(0.36, 0.006).line(0.34, 0.012).line(0.30, 0.007).line(0.0, 0.009);
    cover.lathe(&profile, plan.detail.count(24.0, 8), plan.detail, 0.7);
    for (x, z) in [(-38.0, 1.3), (-19.5, -1.4), (6.0, 1.2), (24.0, -1.3), (43.0, 1.4), (61.0, 0.5), (-61.0, -0.6)] {
        mesh.append(&cover, Affine3A::from_translation(Vec3::new(x, 0.0, z)));
    }
    mesh
}
