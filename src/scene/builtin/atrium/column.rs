//! The columns of both storeys, and the piers in the corners.

use super::{PLINTH, Part, Plan, RAIL, SPRING, UPPER, all_columns, corners};
use crate::scene::builder::Mesh;
use crate::scene::builtin::noise::smooth;
use crate::scene::builtin::profile::Profile;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Side of the limestone texture, m.
const TILE: f32 = 1.5;

/// The measures of one storey's order.
struct Order {
    /// Heights of the column's foot and of the arches' springing line.
    foot: f32,
    top: f32,
    /// Radius of the shaft over the base and under the capital.
    radius: [f32; 2],
    /// Half the side of the plinth and of the abacus, and their heights.
    plinth: [f32; 2],
    abacus: [f32; 2],
    /// Height of the capital under the abacus.
    capital: f32,
}

const ORDERS: [Order; 2] = [
    Order { foot: PLINTH, top: SPRING[0], radius: [0.25, 0.215], plinth: [0.34, 0.11], abacus: [0.35, 0.13], capital: 0.42 },
    Order { foot: RAIL, top: SPRING[1], radius: [0.15, 0.128], plinth: [0.21, 0.07], abacus: [0.255, 0.11], capital: 0.30 },
];

pub fn parts(plan: &Plan) -> Vec<Part> {
    let mut parts: Vec<_> = ORDERS.iter().map(|order| Part::at(column(order, plan), plan.palette.stone, all_columns())).collect();
    let (shafts, trims) = piers(plan);
    parts.push(Part::merged(&shafts, plan.palette.ashlar, &corners()));
    parts.push(Part::merged(&trims, plan.palette.stone, &corners()));
    parts
}

fn column(order: &Order, plan: &Plan) -> Mesh {
    let detail = plan.detail;
    let sides = detail.count(36.0, 5);
    let [bottom, top] = order.radius;
    let scale = bottom / 0.25;
    let base = order.foot + order.plinth[1];
    let neck = order.top - order.abacus[1] - order.capital;
    let mut mesh = Mesh::default();

    let half = order.plinth[0];
    mesh.cuboid(Vec3::new(-half, order.foot, -half), Vec3::new(half, base, half), "-x+x+y-z+z", TILE);
    let y = |height: f32| base + height * scale;
    let r = |extra: f32| bottom + extra * scale;
    let profile = Profile::from(r(0.06), base)
        .torus(0.03 * scale, y(0.09), 3.0)
        .line(r(0.05), y(0.10))
        .curve((r(0.02), y(0.13)), (r(0.035), y(0.17)), 3.0)
        .line(r(0.035), y(0.175))
        .torus(0.022 * scale, y(0.23), 3.0)
        .line(r(0.02), y(0.24))
        .curve((r(0.0), y(0.26)), (r(0.0), y(0.32)), 3.0)
        // Entasis: the shaft runs upright for its lower third and leans in above.
        .curve((r(0.004), base + (neck - base) * 0.5), (top, neck - 0.07 * scale), 8.0)
        .curve((top, neck - 0.05 * scale), (top + 0.015 * scale, neck - 0.045 * scale), 2.0)
        .torus(0.02 * scale, neck, 3.0)
        .line(top, neck);
    mesh.lathe(&profile, sides, detail, TILE);
    capital(&mut mesh, order, sides, neck, plan);

    let half = order.abacus[0];
    let lower = order.top - order.abacus[1];
    mesh.cuboid(Vec3::new(-half, lower, -half), Vec3::new(half, order.top, half), "-x+x-y+y-z+z", TILE);
    mesh
}

/// A bell with two rows of leaves that curl outwards, from the neck to the abacus.
fn capital(mesh: &mut Mesh, order: &Order, sides: usize, neck: f32, plan: &Plan) {
    let top = order.radius[1];
    let widest = order.abacus[0] * 1.02;
    // Leaves would only be noise on fewer sides.
    let relief = ((sides as f32 - 14.0) / 14.0).clamp(0.0, 1.0) * order.radius[0] / 0.25;
    let leaf = |angle: f32, height: f32, from: f32, to: f32| {
        let t = (height - from) / (to - from);
        if !(0.0..=1.0).contains(&t) {
            return 0.0;
        }
        let lobes = (4.0 * angle).cos().abs().powf(0.7);
        let tip = 1.0 - smooth(((t - 0.93) / 0.07).clamp(0.0, 1.0));
        (0.012 + 0.05 * t * t * t) * lobes * tip
    };
    let rows = plan.detail.count(16.0, 1);
    let around = if relief > 0.0 { sides.div_ceil(8) * 16 } else { sides };
    mesh.surface(
        [around, rows],
        false,
        |u, v| {
            let angle = TAU * u;
            let bell = top + (widest - top) * v.powf(3.0) * 0.85 + 0.02 * v;
            let leaves = leaf(angle, v, -0.05, 0.52).max(leaf(angle + TAU / 16.0, v, 0.2, 0.86));
            let radius = bell + relief * leaves;
            Vec3::new(radius * angle.cos(), neck + v * order.capital, -radius * angle.sin())
        },
        |u, v| Vec2::new(u, -v * order.capital / TILE),
    );
}

/// The corner piers' shafts, and their bases, caps and impost blocks.
fn piers(plan: &Plan) -> (Mesh, Mesh) {
    let (mut shafts, mut trims) = (Mesh::default(), Mesh::default());
    for (order, foot) in ORDERS.iter().zip([PLINTH, UPPER]) {
        let half = order.abacus[0] - 0.05;
        let cap = order.top - 0.24;
        // The shaft continues behind its mouldings.
        let head = cap + 0.1;
        shafts.cuboid(Vec3::new(-half, foot, -half), Vec3::new(half, head, half), "-x+x-z+z", 3.0);
        let mut band = |out: f32, from: f32, to: f32| {
            let half = half + out;
            trims.cuboid(Vec3::new(-half, from, -half), Vec3::new(half, to, half), "-x+x-y+y-z+z", TILE);
        };
        band(0.05, foot, foot + 0.22);
        if plan.detail.shows(0.12) {
            band(0.025, foot + 0.22, foot + 0.28);
            band(0.02, cap, cap + 0.08);
        }
        band(0.05, cap + 0.08, order.top);
    }
    (shafts, trims)
}
