//! The court's paving and the fountain in its middle.

use super::{HALF, Part, Plan};
use crate::scene::builder::Mesh;
use crate::scene::builtin::profile::Profile;
use glam::{Vec2, Vec3};

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let (mut field, mut border) = (Mesh::default(), Mesh::default());
    // The paving reaches under the step; a band of another stone goes around the field.
    let outer = Vec2::from(HALF) - 0.5;
    let inner = outer - 0.75;
    let slab = |mesh: &mut Mesh, min: Vec2, max: Vec2| {
        let start = Vec3::new(min.x, 0.0, max.y);
        mesh.plane(start, Vec3::X * (max.x - min.x), Vec3::NEG_Z * (max.y - min.y), plan.cell(), 4.0, Vec2::new(min.x, -max.y));
    };
    slab(&mut field, -inner, inner);
    slab(&mut border, Vec2::new(-outer.x, inner.y), outer);
    slab(&mut border, -outer, Vec2::new(outer.x, -inner.y));
    slab(&mut border, Vec2::new(-outer.x, -inner.y), Vec2::new(-inner.x, inner.y));
    slab(&mut border, Vec2::new(inner.x, -inner.y), Vec2::new(outer.x, inner.y));

    let sides = plan.detail.count(64.0, 8);
    let basin = Profile::from(1.75, 0.0)
        .line(1.75, 0.11)
        .curve((1.75, 0.14), (1.72, 0.14), 2.0)
        .line(1.52, 0.14)
        .curve((1.46, 0.16), (1.46, 0.22), 3.0)
        .line(1.44, 0.24)
        .curve((1.50, 0.34), (1.42, 0.44), 5.0)
        .line(1.46, 0.47)
        .line(1.52, 0.48)
        .torus(0.035, 0.56, 4.0)
        .line(1.28, 0.56)
        .curve((1.22, 0.50), (1.22, 0.36), 3.0);
    let stem = Profile::from(0.34, 0.36)
        .line(0.34, 0.56)
        .curve((0.24, 0.58), (0.22, 0.66), 3.0)
        .torus(0.03, 0.72, 3.0)
        .curve((0.36, 0.86), (0.20, 1.02), 6.0)
        .curve((0.13, 1.10), (0.13, 1.18), 3.0)
        .torus(0.03, 1.24, 3.0);
    let bowl = Profile::from(0.13, 1.22)
        .curve((0.36, 1.22), (0.56, 1.34), 6.0)
        .curve((0.64, 1.38), (0.66, 1.43), 3.0)
        .torus(0.025, 1.48, 3.0)
        .line(0.61, 1.48)
        .curve((0.55, 1.44), (0.50, 1.41), 3.0);
    let finial = Profile::from(0.09, 1.38)
        .curve((0.05, 1.48), (0.05, 1.56), 3.0)
        .torus(0.03, 1.60, 3.0)
        .curve((0.14, 1.66), (0.11, 1.76), 5.0)
        .curve((0.07, 1.84), (0.0, 1.88), 4.0);
    let (mut stone, mut bronze, mut water) = (Mesh::default(), Mesh::default(), Mesh::default());
    stone.lathe(&basin, sides, plan.detail, 1.5);
    stone.lathe(&stem, sides / 2, plan.detail, 1.5);
    bronze.lathe(&bowl, sides * 3 / 4, plan.detail, 1.0);
    bronze.lathe(&finial, sides / 3 + 3, plan.detail, 0.5);
    for (radius, height) in [(1.225, 0.44), (0.54, 1.425)] {
        let surface = Profile::from(radius, height).line(radius * 0.5, height).line(0.04, height);
        water.lathe(&surface, sides / 2, plan.detail, 1.0);
    }
    vec![
        Part::once(field, palette.paving),
        Part::once(border, palette.border),
        Part::once(stone, palette.stone),
        Part::once(bronze, palette.bronze),
        Part::once(water, palette.water),
    ]
}
