//! The houses: closed blocks with fronts to the streets.

use super::facade::{self, Front};
use super::lots::{self, Beside, House, Top};
use super::meshes::{Close, Meshes, cells, mix};
use super::{DEPTH, Plan, roofs};
use crate::scene::builder::Mesh;
use crate::scene::builtin::parts::Part;
use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec3A};
use rayon::prelude::*;

/// Height of the parapets over the eaves.
pub const PARAPET: f32 = 0.95;
/// Depth of the walls below the ground. Surfaces that merely met would show cracks.
pub const BELOW: f32 = -0.1;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let houses = lots::houses();
    let built: Vec<Meshes> = houses.par_iter().map(|house| build(house, &plan.of(house.number))).collect();
    let mut all = Meshes::default();
    for (house, meshes) in houses.iter().zip(&built) {
        all.append(meshes, house.place);
    }
    all.into_parts()
}

/// A house in its own frame.
fn build(house: &House, plan: &Plan) -> Meshes {
    let mut out = Meshes::default();
    let (width, projection) = (house.lot.width, house.projection());
    let parapet = matches!(house.lot.top, Top::Parapet | Top::Tower);
    let street = house.beside.map(|beside| matches!(beside, Beside::Street));
    // Walls reach into a neighbour that stands before them.
    let reach = house.beside.map(|beside| match beside {
        Beside::House { projection: other, .. } if other > projection => 0.02,
        _ => 0.0,
    });
    let corner = street.map(|street| if street { Close::Mitre } else { Close::Cap });
    let overhang = street.map(|street| if street { facade::COPING } else { 0.0 });
    let front = Front {
        width,
        bays: house.lot.bays,
        z: projection,
        main: true,
        parapet,
        ends: corner,
        open: street.map(|street| !street),
        reach,
        coping: [-overhang[0], width + overhang[1]],
    };
    facade::build(&mut out, house, &front, plan);
    for (hand, street) in street.into_iter().enumerate() {
        if !street {
            continue;
        }
        let long = DEPTH + projection;
        // The front on the side runs from the back of the house to its main front, or the other way round.
        let (axis, foot, coping) = if hand == 0 {
            (Vec3A::Z, Vec3A::new(0.0, 0.0, -DEPTH), [0.0, long - facade::THICK])
        } else {
            (Vec3A::NEG_Z, Vec3A::new(width, 0.0, projection), [facade::THICK, long])
        };
        let side = Front {
            width: long,
            bays: 4,
            z: 0.0,
            main: false,
            parapet,
            ends: if hand == 0 { [Close::Cap, Close::Mitre] } else { [Close::Mitre, Close::Cap] },
            open: if hand == 0 { [true, false] } else { [false, true] },
            reach: [0.0; 2],
            coping,
        };
        let mut built = Meshes::default();
        facade::build(&mut built, house, &side, plan);
        let place = Affine3A { matrix3: Mat3A::from_cols(axis, Vec3A::Y, axis.cross(Vec3A::Y)), translation: foot };
        out.append(&built, place);
    }
    bare_walls(&mut out, house, plan);
    roofs::build(&mut out, house, plan);
    out
}

/// The back, and what shows of the sides.
fn bare_walls(out: &mut Meshes, house: &House, plan: &Plan) {
    let (width, eaves, projection) = (house.lot.width, house.eaves(), house.projection());
    let mesh = out.of(plan.palette.walls[house.lot.walls[1] as usize]);
    let cell = plan.cell();
    mesh.patch(cells(width, cell), cells(eaves - BELOW, cell), |u, v| {
        let at = Vec3::new(mix(0.0, width, u), mix(BELOW, eaves, v), -DEPTH);
        (at, Vec3::NEG_Z, Vec2::new(-at.x, -at.y) / 3.0)
    });
    for (hand, beside) in house.beside.into_iter().enumerate() {
        let mut side = |from: f32, to: f32, back: f32| {
            if to > from && projection > back {
                side_wall(mesh, hand, [0.0, width][hand], [from, to], [back, projection], cell);
            }
        };
        match beside {
            Beside::House { eaves: other, projection: before } => {
                // The neighbour's roof hides the wall's foot.
                let foot = (other - 0.3).min(eaves);
                side(foot, eaves, -DEPTH);
                side(BELOW, foot, before - 0.05);
            }
            Beside::Nothing => side(BELOW, eaves, -DEPTH),
            Beside::Street => {}
        }
    }
}

/// A wall at one side of a house, between heights and between distances from the row's line.
pub fn side_wall(mesh: &mut Mesh, hand: usize, x: f32, [y0, y1]: [f32; 2], [z0, z1]: [f32; 2], cell: f32) {
    let normal = [Vec3::NEG_X, Vec3::X][hand];
    mesh.patch(cells(z1 - z0, cell), cells(y1 - y0, cell), |u, v| {
        let at = Vec3::new(x, mix(y0, y1, v), mix(z0, z1, u));
        (at, normal, Vec2::new(at.z, -at.y) / 3.0)
    });
}
