//! The court's textures, painted from noise.

use super::super::noise::{hash, step};
use super::super::texels::{self, Fields, Masonry, color, surface};
use super::super::textures::{ashlar, ashlar_normal, grey, leaf, limestone, metal, of, plaster, slab_normals, weave, wood};
use crate::scene::Texture;

const COUNT: usize = 17;

/// All textures, in the order of the materials' names for them.
pub fn all(fields: &Fields, seed: u32) -> [Texture; COUNT] {
    let makers: [fn(&Fields, u32) -> Texture; COUNT] = [
        limestone,
        ashlar,
        ashlar_normal,
        plaster,
        paving,
        paving_normal,
        paving_surface,
        tiles,
        roof,
        wood,
        weave,
        |fields, _| banner("red banner", fields, [0.62, 0.05, 0.035]),
        |fields, _| banner("green banner", fields, [0.05, 0.33, 0.10]),
        |fields, _| banner("blue banner", fields, [0.035, 0.12, 0.52]),
        leaf,
        metal,
        glow,
    ];
    texels::all(makers, fields, seed)
}

/// Slabs in courses on four metres of floor.
fn slabs(seed: u32) -> Masonry {
    Masonry::new(5, 4, 0.3, seed ^ 0xf1)
}

const SLAB_JOINT: f32 = 0.003;

fn paving(fields: &Fields, seed: u32) -> Texture {
    let slabs = slabs(seed);
    color("paving", 1024, |x, y| {
        let (slab, edge) = slabs.at(x, y, 1024);
        let (sx, sy) = Masonry::cut(slab, x, y);
        let relief = Masonry::relief(edge, SLAB_JOINT);
        let vein = 1.0 - step(0.0, 0.05, (fields.stains.texel(sx, sy) - 0.5).abs());
        let value = 0.74 + 0.34 * (of(slab, 3) - 0.5) + 0.16 * (fields.clouds.texel(sx, sy) - 0.5) - 0.09 * vein
            + 0.08 * (fields.grain.texel(x, y) - 0.5);
        let stone = grey(value * (0.88 + 0.12 * step(0.0, 0.015, edge)) * 1.1, 0.16 * (of(slab, 4) - 0.4));
        let joint = grey(0.34, 0.05);
        std::array::from_fn(|i| joint[i] + (stone[i] - joint[i]) * relief)
    })
}

fn paving_normal(fields: &Fields, seed: u32) -> Texture {
    slab_normals("paving normals", fields, &slabs(seed), SLAB_JOINT, [3.0, 2.5, 0.5, 4.0])
}

fn paving_surface(fields: &Fields, seed: u32) -> Texture {
    let slabs = slabs(seed);
    surface("paving roughness", 512, |x, y| {
        let (slab, edge) = slabs.at(x, y, 512);
        let polished = Masonry::relief(edge, SLAB_JOINT) * (0.8 + 0.2 * of(slab, 5));
        [0.95 - 0.45 * polished + 0.2 * (fields.clouds.texel(x, y) - 0.5), 0.0]
    })
}

/// Square tiles, terracotta and cream by turns, on 1.2 m of floor.
fn tiles(fields: &Fields, seed: u32) -> Texture {
    color("floor tiles", 512, |x, y| {
        let (column, row) = (x / 128, y / 128);
        let edge = (x % 128).min(127 - x % 128).min(y % 128).min(127 - y % 128) as f32;
        let tile = hash(column as u32, row as u32, seed ^ 0x71e5);
        let relief = step(0.5, 2.5, edge);
        let shade = 0.9 + 0.25 * (of(tile, 1) - 0.5) + 0.3 * (fields.clouds.texel(x, y) - 0.5) + 0.1 * (fields.grain.texel(x, y) - 0.5);
        let base = if (column + row) % 2 == 0 { [0.50, 0.21, 0.11] } else { [0.64, 0.52, 0.36] };
        let joint = [0.30, 0.26, 0.21];
        let mix = |i: usize| joint[i] + (base[i] * shade - joint[i]) * relief;
        [mix(0), mix(1), mix(2), 1.0]
    })
}

/// Four shades of fired clay side by side, one for each roof tile.
fn roof(fields: &Fields, _seed: u32) -> Texture {
    const CLAYS: [[f32; 3]; 4] = [[0.52, 0.22, 0.11], [0.60, 0.29, 0.15], [0.46, 0.19, 0.10], [0.58, 0.34, 0.20]];
    color("roof tiles", 256, |x, y| {
        let shade = 0.9 + 0.5 * (fields.clouds.texel(x * 2, y * 2) - 0.5) + 0.3 * (fields.grain.texel(x, y) - 0.5);
        let [r, g, b] = CLAYS[x / 64].map(|c| c * shade);
        [r, g, b, 1.0]
    })
}

/// A whole banner: a coloured field with gold borders, flowers in a lattice of lozenges, and a fringe.
fn banner(name: &str, fields: &Fields, field: [f32; 3]) -> Texture {
    const GOLD: [f32; 3] = [0.70, 0.46, 0.13];
    color(name, 512, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / 512.0, (y as f32 + 0.5) / 512.0);
        let side = (u - 0.5).abs();
        let near = |at: f32, half: f32, d: f32| 1.0 - step(half - 0.004, half + 0.004, (d - at).abs());
        let mut light = near(0.43, 0.018, side).max(near(0.385, 0.006, side));
        light = light.max(if side < 0.45 { near(0.92, 0.014, v).max(near(0.885, 0.005, v)) } else { 0.0 });
        // A lattice of lozenges with a flower in each.
        let (a, b) = (((u + v * 1.8) * 5.0).rem_euclid(1.0), ((u - v * 1.8) * 5.0).rem_euclid(1.0));
        if side < 0.37 && v < 0.87 {
            let line = near(0.5, 0.03, a).max(near(0.5, 0.03, b));
            let (fa, fb) = ((a + 0.5).fract() - 0.5, (b + 0.5).fract() - 0.5);
            let flower = {
                let (radius, angle) = ((fa * fa + fb * fb).sqrt(), fb.atan2(fa));
                1.0 - step(-0.02, 0.02, radius - 0.17 - 0.07 * (4.0 * angle).cos())
            };
            light = light.max(line * 0.85).max(flower * 0.9);
        }
        if v > 0.96 {
            light = light.max(if (x / 5).is_multiple_of(2) { 1.0 } else { 0.35 });
        }
        let thread = 0.88 + 0.08 * ((x as f32 * 1.57).sin() * (y as f32 * 1.57).sin()) + 0.2 * (fields.clouds.texel(x, y) - 0.5);
        let [r, g, b] = std::array::from_fn(|i| (field[i] + (GOLD[i] - field[i]) * light) * thread);
        [r, g, b, 1.0]
    })
}

/// A flame's glow behind glass, brightest a little below the middle.
fn glow(fields: &Fields, _seed: u32) -> Texture {
    color("glow", 256, |x, y| {
        let v = (y as f32 + 0.5) / 256.0;
        let flame = (-((v - 0.55) / 0.22).powi(2)).exp();
        let value = 0.25 + 0.75 * flame + 0.1 * (fields.clouds.texel(x, y) - 0.5);
        [value, value * value.max(0.6), value * value, 1.0]
    })
}
