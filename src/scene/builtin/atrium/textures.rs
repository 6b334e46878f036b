//! The court's textures, painted from noise.

use super::super::noise::{hash, step, unit};
use super::super::texels::{Fields, Masonry, color, normals, surface};
use crate::scene::Texture;
use rayon::prelude::*;
use std::f32::consts::FRAC_PI_4;

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
    let mut made: Vec<Texture> = makers.par_iter().map(|make| make(fields, seed)).collect();
    std::array::from_fn(|i| {
        std::mem::replace(&mut made[i], Texture { name: String::new(), width: 0, height: 0, srgb: false, texels: vec![] })
    })
}

/// Random number in [0, 1) of a block; `which` picks one of several.
fn of(block: u32, which: u32) -> f32 {
    unit(block, which, 0x7e)
}

fn grey(value: f32, warmth: f32) -> [f32; 4] {
    [value * (1.0 + 0.5 * warmth), value, value * (1.0 - warmth), 1.0]
}

/// Pale stone with faint bedding and pores.
fn limestone(fields: &Fields, _seed: u32) -> Texture {
    color("limestone", 512, |x, y| {
        let stain = fields.stains.texel(x, y);
        let bedding = fields.clouds.texel(x / 4, y * 3);
        let pore = step(0.80, 0.88, fields.grain.texel(x, y)) * step(0.45, 0.6, fields.clouds.texel(x, y));
        let value = 0.74 + 0.24 * (stain - 0.5) + 0.16 * (bedding - 0.5) + 0.10 * (fields.grain.texel(x, y) - 0.5) - 0.2 * pore;
        grey(value * 1.12, 0.16 * (stain - 0.4))
    })
}

/// Courses of squared blocks, half a metre high, on three metres of wall.
fn ashlar_masonry(seed: u32) -> Masonry {
    Masonry::new(6, 3, 0.35, seed ^ 0xa5)
}

const ASHLAR_JOINT: f32 = 0.0035;

fn ashlar(fields: &Fields, seed: u32) -> Texture {
    let masonry = ashlar_masonry(seed);
    color("ashlar", 1024, |x, y| {
        let (block, edge) = masonry.at(x as f32 / 1024.0, y as f32 / 1024.0);
        // Every block is cut from another part of the same texture.
        let (sx, sy) = (x + (hash(block, 1, 0) % 512) as usize, y + (hash(block, 2, 0) % 512) as usize);
        let relief = Masonry::relief(edge, ASHLAR_JOINT);
        let value = 0.70
            + 0.22 * (of(block, 3) - 0.5)
            + 0.22 * (fields.stains.texel(sx, sy) - 0.5)
            + 0.20 * (fields.clouds.texel(sx / 2, sy) - 0.5)
            + 0.10 * (fields.grain.texel(x, y) - 0.5);
        let worn = 0.86 + 0.14 * step(0.0, 0.02, edge);
        let warmth = 0.14 * (of(block, 4) - 0.4);
        let stone = grey(value * worn * 1.15, warmth);
        let mortar = grey(0.52 + 0.1 * fields.grain.texel(x, y), 0.0);
        std::array::from_fn(|i| mortar[i] + (stone[i] - mortar[i]) * relief)
    })
}

fn ashlar_normal(fields: &Fields, seed: u32) -> Texture {
    let masonry = ashlar_masonry(seed);
    normals("ashlar normals", 1024, |x, y| {
        let (block, edge) = masonry.at(x as f32 / 1024.0, y as f32 / 1024.0);
        let (sx, sy) = (x + (hash(block, 1, 0) % 512) as usize, y + (hash(block, 2, 0) % 512) as usize);
        4.0 * Masonry::relief(edge, ASHLAR_JOINT) + 5.0 * fields.clouds.texel(sx, sy) + 1.6 * fields.grain.texel(x, y)
    })
}

/// Smoothed lime plaster, nearly white: the material gives its colour.
fn plaster(fields: &Fields, _seed: u32) -> Texture {
    color("plaster", 512, |x, y| {
        let stain = fields.stains.texel(x, y);
        let patch = step(0.56, 0.62, fields.stains.texel(x * 2 + 100, y * 2 + 300));
        let cloud = fields.clouds.texel(x / 2, y / 2);
        let value = 0.87 + 0.30 * (stain - 0.5) - 0.05 * patch + 0.16 * (cloud - 0.5) + 0.05 * (fields.grain.texel(x, y) - 0.5);
        grey(value, 0.08 * (stain - 0.5))
    })
}

/// Slabs in courses on four metres of floor.
fn slabs(seed: u32) -> Masonry {
    Masonry::new(5, 4, 0.3, seed ^ 0xf1)
}

const SLAB_JOINT: f32 = 0.003;

fn paving(fields: &Fields, seed: u32) -> Texture {
    let slabs = slabs(seed);
    color("paving", 1024, |x, y| {
        let (slab, edge) = slabs.at(x as f32 / 1024.0, y as f32 / 1024.0);
        let (sx, sy) = (x + (hash(slab, 1, 0) % 512) as usize, y + (hash(slab, 2, 0) % 512) as usize);
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
    let slabs = slabs(seed);
    normals("paving normals", 1024, |x, y| {
        let (u, v) = (x as f32 / 1024.0, y as f32 / 1024.0);
        let (slab, edge) = slabs.at(u, v);
        // Worn slabs lie slightly tilted.
        let tilt = (u - 0.5) * (of(slab, 6) - 0.5) + (v - 0.5) * (of(slab, 7) - 0.5);
        3.0 * Masonry::relief(edge, SLAB_JOINT) + 2.5 * fields.clouds.texel(x, y) + 0.5 * fields.grain.texel(x, y) + 4.0 * tilt
    })
}

fn paving_surface(fields: &Fields, seed: u32) -> Texture {
    let slabs = slabs(seed);
    surface("paving roughness", 512, |x, y| {
        let (slab, edge) = slabs.at(x as f32 / 512.0, y as f32 / 512.0);
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

/// Boards with grain along v, four to the tile.
fn wood(fields: &Fields, seed: u32) -> Texture {
    color("wood", 512, |x, y| {
        let board = x / 128;
        let shift = (hash(board as u32, 9, seed) % 512) as usize;
        let edge = (x % 128).min(127 - x % 128) as f32;
        let bend = fields.stains.texel(x / 2 + shift, y / 4 + shift) * 9.0;
        let rings = (bend * 6.0 + x as f32 * 0.11).sin() * 0.5 + 0.5;
        let fibre = fields.clouds.texel(x * 3 + shift, y / 6);
        let tone = 0.8 + 0.3 * (unit(board as u32, 8, seed) - 0.5);
        let value = tone * (0.68 + 0.18 * rings + 0.34 * (fibre - 0.5)) * (0.5 + 0.5 * step(0.0, 2.0, edge));
        grey(value * 1.15, 0.1)
    })
}

/// A plain weave with uneven threads, nearly white.
fn weave(fields: &Fields, _seed: u32) -> Texture {
    color("weave", 256, |x, y| {
        let (warp, weft) = ((x as f32 * FRAC_PI_4).sin(), (y as f32 * FRAC_PI_4).sin());
        let over = if (x / 8 + y / 8) % 2 == 0 { warp } else { weft };
        let slub = fields.clouds.texel(x * 4, y / 2) + fields.clouds.texel(x / 2, y * 4) - 1.0;
        grey(0.86 + 0.07 * over + 0.16 * slub + 0.10 * (fields.stains.texel(x * 2, y * 2) - 0.5), 0.0)
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

/// A sprig of five pointed leaves. The same green with alpha 0 surrounds them, so that filtering adds no dark rim.
fn leaf(fields: &Fields, _seed: u32) -> Texture {
    const LEAVES: [(f32, f32, f32, f32); 5] =
        [(0.5, 0.06, 0.0, 0.50), (0.5, 0.30, 0.85, 0.46), (0.5, 0.34, -0.85, 0.46), (0.5, 0.62, 0.7, 0.42), (0.5, 0.60, -0.7, 0.42)];
    color("orange leaves", 256, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / 256.0, (y as f32 + 0.5) / 256.0);
        let mut alpha: f32 = if (u - 0.5).abs() < 0.012 && v > 0.3 { 1.0 } else { 0.0 };
        let (mut rib, mut tone): (f32, f32) = (0.0, 0.5);
        for (i, (foot, tip, lean, length)) in LEAVES.into_iter().enumerate() {
            // Coordinates along the leaf from its foot on the stem, and across it.
            let base = (foot, tip + length * lean.cos());
            let axis = (lean.sin(), -lean.cos());
            let (dx, dy) = (u - base.0, v - base.1);
            let along = (dx * axis.0 + dy * axis.1) / length;
            let across = (dx * axis.1 - dy * axis.0).abs();
            if (0.0..=1.0).contains(&along) {
                let half = 0.34 * length * (along.powf(0.7) * (1.0 - along)).max(0.0) * 1.9;
                if across < half {
                    alpha = 1.0;
                    rib = 1.0 - step(0.004, 0.012, across);
                    tone = unit(i as u32, 5, 17) * 0.6 + 0.4 * across / half.max(1e-3);
                }
            }
        }
        let shade = 0.8 + 0.5 * (fields.clouds.texel(x, y) - 0.5) + 0.35 * (tone - 0.5);
        [(0.13 + 0.10 * rib) * shade, (0.31 + 0.13 * rib) * shade, 0.055 * shade, alpha]
    })
}

/// Scuffed metal, shiny where it is worn.
fn metal(fields: &Fields, _seed: u32) -> Texture {
    surface("metal", 256, |x, y| {
        let worn = step(0.4, 0.65, fields.stains.texel(x * 2, y * 2));
        [0.75 - 0.35 * worn + 0.2 * (fields.clouds.texel(x * 2, y * 2) - 0.5), 1.0]
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
