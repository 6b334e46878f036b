//! Painting textures: texels from functions, in parallel rows.

use super::noise::{Tile, hash, step, unit};
use crate::scene::Texture;
use rayon::prelude::*;

/// A colour texture; `paint` gives linear RGBA in [0, 1].
pub fn color(name: &str, size: usize, paint: impl Fn(usize, usize) -> [f32; 4] + Sync) -> Texture {
    let curve: Vec<u8> = (0..4096)
        .map(|i| {
            let c = i as f32 / 4095.0;
            let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
            (encoded * 255.0).round() as u8
        })
        .collect();
    let texels = rows(size, |x, y| {
        let [r, g, b, a] = paint(x, y);
        let encode = |c: f32| curve[(c.clamp(0.0, 1.0) * 4095.0) as usize];
        [encode(r), encode(g), encode(b), byte(a)]
    });
    Texture { name: name.into(), width: size as u32, height: size as u32, srgb: true, texels }
}

/// A texture of roughness (green) and metalness (blue).
pub fn surface(name: &str, size: usize, paint: impl Fn(usize, usize) -> [f32; 2] + Sync) -> Texture {
    let texels = rows(size, |x, y| {
        let [roughness, metallic] = paint(x, y);
        [255, byte(roughness), byte(metallic), 255]
    });
    Texture { name: name.into(), width: size as u32, height: size as u32, srgb: false, texels }
}

/// The normal map of a periodic height field; heights are in texels.
pub fn normals(name: &str, size: usize, height: impl Fn(usize, usize) -> f32 + Sync) -> Texture {
    let mut heights = vec![0.0f32; size * size];
    heights.par_chunks_mut(size).enumerate().for_each(|(y, row)| {
        for (x, h) in row.iter_mut().enumerate() {
            *h = height(x, y);
        }
    });
    let at = |x: usize, y: usize| heights[y * size + x];
    let before = |i: usize| if i == 0 { size - 1 } else { i - 1 };
    let after = |i: usize| if i + 1 == size { 0 } else { i + 1 };
    let texels = rows(size, |x, y| {
        let dx = at(after(x), y) - at(before(x), y);
        let dy = at(x, after(y)) - at(x, before(y));
        // Green points up in the image, as in glTF.
        let n = glam::Vec3::new(-dx, dy, 2.0).normalize();
        let [r, g, b] = [n.x, n.y, n.z].map(|c| byte(c * 0.5 + 0.5));
        [r, g, b, 255]
    });
    Texture { name: name.into(), width: size as u32, height: size as u32, srgb: false, texels }
}

/// Textures of these makers, in their order, painted at the same time.
pub fn all<const COUNT: usize>(makers: [fn(&Fields, u32) -> Texture; COUNT], fields: &Fields, seed: u32) -> [Texture; COUNT] {
    let mut made: Vec<Texture> = makers.par_iter().map(|make| make(fields, seed)).collect();
    std::array::from_fn(|i| {
        std::mem::replace(&mut made[i], Texture { name: String::new(), width: 0, height: 0, srgb: false, texels: vec![] })
    })
}

/// A number in [0, 1] as a byte. `round` is a call to a function without SSE 4.1, which a default build does not have.
fn byte(c: f32) -> u8 {
    (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn rows(size: usize, texel: impl Fn(usize, usize) -> [u8; 4] + Sync) -> Vec<u8> {
    let mut texels = vec![0u8; size * size * 4];
    texels.par_chunks_mut(size * 4).enumerate().for_each(|(y, row)| {
        for (x, out) in row.chunks_exact_mut(4).enumerate() {
            out.copy_from_slice(&texel(x, y));
        }
    });
    texels
}

/// Blocks laid in courses on a periodic square.
pub struct Masonry(Vec<Course>);

struct Course {
    /// Blocks from left to right: where they begin and end, and a random number of each. The block over the square's edge is there twice.
    blocks: Vec<(f32, f32, u32)>,
    /// The block at each of [`Masonry::COLUMNS`] columns: millions of texels ask for theirs.
    columns: Vec<u8>,
}

impl Masonry {
    /// Side of the largest texture.
    const COLUMNS: usize = 1024;

    /// `courses` rows of `blocks` blocks, or one more, of unequal lengths (`jitter` of a block).
    pub fn new(courses: usize, blocks: usize, jitter: f32, seed: u32) -> Self {
        let course = |row: u32| {
            let count = blocks as u32 + u32::from(jitter > 0.0 && hash(row, 3, seed).is_multiple_of(2));
            let shift = if jitter > 0.0 { unit(row, 4, seed) } else { 0.5 * (row % 2) as f32 };
            let mut ends: Vec<f32> =
                (0..count).map(|i| ((i as f32 + shift + jitter * (unit(i, row, seed) - 0.5)) / count as f32).rem_euclid(1.0)).collect();
            ends.sort_by(f32::total_cmp);
            let lefts = ends.last().map(|end| end - 1.0).into_iter().chain(ends.iter().copied());
            let rights = ends.iter().copied().chain(ends.first().map(|end| end + 1.0));
            let number = |block: usize| hash((block % ends.len()) as u32, row, seed ^ 0x51);
            let blocks = lefts.zip(rights).enumerate().map(|(block, (left, right))| (left, right, number(block))).collect();
            let column = |x: usize| ends.partition_point(|&end| end <= x as f32 / Self::COLUMNS as f32) as u8;
            Course { blocks, columns: (0..Self::COLUMNS).map(column).collect() }
        };
        Self((0..courses as u32).map(course).collect())
    }

    /// The block at a texel of a square of `size` texels, as a random number, and the distance to its edge, of the square.
    pub fn at(&self, x: usize, y: usize, size: usize) -> (u32, f32) {
        let (u, v) = (x as f32 / size as f32, y as f32 / size as f32);
        let rows = self.0.len() as f32;
        let row = ((v * rows) as usize).min(self.0.len() - 1);
        let course = &self.0[row];
        let (left, right, block) = course.blocks[course.columns[(u * Self::COLUMNS as f32) as usize] as usize];
        let bed = (v * rows - row as f32) / rows;
        (block, (u - left).min(right - u).min(bed).min(1.0 / rows - bed))
    }

    /// Where a block's noise is looked up for a texel: every block is cut from another part of the same texture.
    pub fn cut(block: u32, x: usize, y: usize) -> (usize, usize) {
        (x + (hash(block, 1, 0) % 512) as usize, y + (hash(block, 2, 0) % 512) as usize)
    }

    /// Relief of the blocks with joints `joint` wide (of the square): 0 in the joint, 1 on a block.
    pub fn relief(edge: f32, joint: f32) -> f32 {
        step(0.35 * joint, 1.3 * joint, edge)
    }
}

/// Noise fields shared by the textures.
pub struct Fields {
    /// Noise of low frequency (stains), middle frequency (clouds) and high frequency (grain).
    pub stains: Tile,
    pub clouds: Tile,
    pub grain: Tile,
}

impl Fields {
    pub fn new(seed: u32) -> Self {
        Self {
            stains: Tile::fractal(512, 3, 5, 0.5, seed ^ 0x11),
            clouds: Tile::fractal(512, 12, 5, 0.6, seed ^ 0x22),
            grain: Tile::fractal(512, 128, 2, 0.7, seed ^ 0x33),
        }
    }
}
