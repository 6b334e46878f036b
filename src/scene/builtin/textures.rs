//! Textures of materials that several scenes have, painted from noise.

use super::noise::{hash, step, unit};
use super::texels::{Fields, Masonry, color, normals, surface};
use crate::scene::Texture;
use std::f32::consts::FRAC_PI_4;

/// Random number in [0, 1) of a block; `which` picks one of several.
pub fn of(block: u32, which: u32) -> f32 {
    unit(block, which, 0x7e)
}

pub fn grey(value: f32, warmth: f32) -> [f32; 4] {
    [value * (1.0 + 0.5 * warmth), value, value * (1.0 - warmth), 1.0]
}

/// Pale stone with faint bedding and pores.
pub fn limestone(fields: &Fields, _seed: u32) -> Texture {
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

pub fn ashlar(fields: &Fields, seed: u32) -> Texture {
    let masonry = ashlar_masonry(seed);
    color("ashlar", 1024, |x, y| {
        let (block, edge) = masonry.at(x, y, 1024);
        let (sx, sy) = Masonry::cut(block, x, y);
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

pub fn ashlar_normal(fields: &Fields, seed: u32) -> Texture {
    let masonry = ashlar_masonry(seed);
    normals("ashlar normals", 1024, |x, y| {
        let (block, edge) = masonry.at(x, y, 1024);
        let (sx, sy) = Masonry::cut(block, x, y);
        4.0 * Masonry::relief(edge, ASHLAR_JOINT) + 5.0 * fields.clouds.texel(sx, sy) + 1.6 * fields.grain.texel(x, y)
    })
}

/// Normals of slabs with joints `joint` wide; the weights are those of the joints, of noise of middle and high frequency, and of the tilt of
/// worn slabs.
pub fn slab_normals(name: &str, fields: &Fields, slabs: &Masonry, joint: f32, weights: [f32; 4]) -> Texture {
    let [relief, clouds, grain, tilt] = weights;
    normals(name, 1024, |x, y| {
        let (slab, edge) = slabs.at(x, y, 1024);
        let (u, v) = (x as f32 / 1024.0, y as f32 / 1024.0);
        let lean = (u - 0.5) * (of(slab, 6) - 0.5) + (v - 0.5) * (of(slab, 7) - 0.5);
        relief * Masonry::relief(edge, joint) + clouds * fields.clouds.texel(x, y) + grain * fields.grain.texel(x, y) + tilt * lean
    })
}

/// Smoothed lime plaster, nearly white: the material gives its colour.
pub fn plaster(fields: &Fields, _seed: u32) -> Texture {
    color("plaster", 512, |x, y| {
        let stain = fields.stains.texel(x, y);
        let patch = step(0.56, 0.62, fields.stains.texel(x * 2 + 100, y * 2 + 300));
        let cloud = fields.clouds.texel(x / 2, y / 2);
        let value = 0.87 + 0.30 * (stain - 0.5) - 0.05 * patch + 0.16 * (cloud - 0.5) + 0.05 * (fields.grain.texel(x, y) - 0.5);
        grey(value, 0.08 * (stain - 0.5))
    })
}

/// Boards with grain along v, four to the tile.
pub fn wood(fields: &Fields, seed: u32) -> Texture {
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
pub fn weave(fields: &Fields, _seed: u32) -> Texture {
    color("weave", 256, |x, y| {
        let (warp, weft) = ((x as f32 * FRAC_PI_4).sin(), (y as f32 * FRAC_PI_4).sin());
        let over = if (x / 8 + y / 8) % 2 == 0 { warp } else { weft };
        let slub = fields.clouds.texel(x * 4, y / 2) + fields.clouds.texel(x / 2, y * 4) - 1.0;
        grey(0.86 + 0.07 * over + 0.16 * slub + 0.10 * (fields.stains.texel(x * 2, y * 2) - 0.5), 0.0)
    })
}

/// A sprig of five pointed leaves. The same green with alpha 0 surrounds them, so that filtering adds no dark rim.
pub fn leaf(fields: &Fields, _seed: u32) -> Texture {
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
pub fn metal(fields: &Fields, _seed: u32) -> Texture {
    surface("metal", 256, |x, y| {
        let worn = step(0.4, 0.65, fields.stains.texel(x * 2, y * 2));
        [0.75 - 0.35 * worn + 0.2 * (fields.clouds.texel(x * 2, y * 2) - 0.5), 1.0]
    })
}
