//! The street's textures, painted from noise.

use super::super::noise::{hash, step, unit};
use super::super::texels::{self, Fields, Masonry, color, normals};
use super::super::textures::{ashlar, ashlar_normal, grey, leaf, limestone, metal, of, plaster, slab_normals, weave, wood};
use crate::scene::Texture;
use std::f32::consts::{PI, TAU};

const COUNT: usize = 26;

/// Colours of the awnings' stripes, beside white.
const STRIPES: [[f32; 3]; 4] = [[0.62, 0.045, 0.04], [0.04, 0.30, 0.13], [0.04, 0.13, 0.50], [0.78, 0.48, 0.04]];

/// All textures, in the order of the materials' names for them.
pub fn all(fields: &Fields, seed: u32) -> [Texture; COUNT] {
    let makers: [fn(&Fields, u32) -> Texture; COUNT] = [
        limestone,
        ashlar,
        ashlar_normal,
        plaster,
        wood,
        weave,
        |fields, seed| Texture { name: "leaves".into(), ..leaf(fields, seed) },
        metal,
        brick,
        brick_normal,
        clay,
        clay_normal,
        slate,
        slate_normal,
        asphalt,
        lanes,
        crossing,
        slabs,
        slabs_normal,
        glazing,
        shops,
        posters,
        |fields, _| stripes("red stripes", fields, STRIPES[0]),
        |fields, _| stripes("green stripes", fields, STRIPES[1]),
        |fields, _| stripes("blue stripes", fields, STRIPES[2]),
        |fields, _| stripes("yellow stripes", fields, STRIPES[3]),
    ];
    texels::all(makers, fields, seed)
}

fn mix(from: [f32; 4], to: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * t)
}

/// Bricks of 24 x 8 cm in a running bond, on 1.92 m of wall; the material gives their colour.
fn bricks(seed: u32) -> Masonry {
    Masonry::new(24, 8, 0.0, seed ^ 0xb1)
}

const BRICK_JOINT: f32 = 0.0045;

fn brick(fields: &Fields, seed: u32) -> Texture {
    let bricks = bricks(seed);
    color("brick", 1024, |x, y| {
        let (brick, edge) = bricks.at(x, y, 1024);
        let relief = Masonry::relief(edge, BRICK_JOINT);
        let burnt = if of(brick, 5) > 0.86 { 0.22 } else { 0.0 };
        let value = 0.84 - burnt
            + 0.30 * (of(brick, 3) - 0.5)
            + 0.24 * (fields.clouds.texel(x, y) - 0.5)
            + 0.12 * (fields.grain.texel(x, y) - 0.5)
            + 0.16 * (fields.stains.texel(x / 2, y / 2) - 0.5);
        let warmth = 0.22 * (of(brick, 4) - 0.5);
        let clay = [value * (1.0 - 0.3 * warmth), value, value * (1.0 + warmth), 1.0];
        // Mortar is pale beside the bricks' own colour, which multiplies both.
        let mortar = [1.0, 1.25, 1.45, 1.0].map(|c| c * (0.66 + 0.14 * (fields.grain.texel(x, y) - 0.5)));
        mix(mortar, clay, relief)
    })
}

fn brick_normal(fields: &Fields, seed: u32) -> Texture {
    let bricks = bricks(seed);
    normals("brick normals", 1024, |x, y| {
        let (brick, edge) = bricks.at(x, y, 1024);
        let proud = 0.8 + 0.4 * of(brick, 6);
        2.6 * proud * Masonry::relief(edge, BRICK_JOINT) + 1.6 * fields.clouds.texel(x, y) + 1.0 * fields.grain.texel(x, y)
    })
}

/// Courses of overlapping tiles on a periodic square: the tile at a point, and how far down and across it the point is.
fn tiling(x: usize, y: usize, size: usize, courses: usize, columns: usize) -> (u32, f32, f32) {
    let v = y as f32 / size as f32 * courses as f32;
    let row = v as usize;
    let u = x as f32 / size as f32 * columns as f32 + 0.5 * (row % 2) as f32;
    let column = u as usize % columns;
    (hash(column as u32, row as u32, 0x711e), v - row as f32, u - (u as usize) as f32)
}

/// Flat clay tiles, eight courses on 2.4 m of roof.
fn clay(fields: &Fields, _seed: u32) -> Texture {
    const CLAYS: [[f32; 3]; 4] = [[0.50, 0.20, 0.11], [0.57, 0.26, 0.14], [0.43, 0.17, 0.10], [0.53, 0.29, 0.18]];
    color("clay tiles", 512, |x, y| {
        let (tile, down, across) = tiling(x, y, 512, 8, 10);
        let gap = step(0.0, 0.06, across.min(1.0 - across));
        // The course above lies over a tile's upper end, and shades it.
        let lit = (0.35 + 0.65 * step(0.0, 0.16, down)) * (0.55 + 0.45 * gap);
        let moss = step(0.62, 0.75, fields.stains.texel(x, y)) * 0.45;
        let shade = lit * (0.95 + 0.35 * (fields.clouds.texel(x * 2, y * 2) - 0.5) + 0.25 * (fields.grain.texel(x, y) - 0.5));
        let [r, g, b] = CLAYS[(of(tile, 1) * 4.0) as usize % 4];
        mix([r * shade, g * shade, b * shade, 1.0], [0.20 * shade, 0.19 * shade, 0.11 * shade, 1.0], moss)
    })
}

fn clay_normal(fields: &Fields, _seed: u32) -> Texture {
    normals("clay tile normals", 512, |x, y| {
        let (tile, down, across) = tiling(x, y, 512, 8, 10);
        let round = (PI * across).sin();
        9.0 * down * (0.85 + 0.3 * of(tile, 2)) + 5.0 * round + 1.5 * fields.grain.texel(x, y)
    })
}

/// Slates, ten courses on two metres of roof.
fn slate(fields: &Fields, _seed: u32) -> Texture {
    color("slates", 512, |x, y| {
        let (tile, down, across) = tiling(x, y, 512, 10, 8);
        let gap = step(0.0, 0.04, across.min(1.0 - across));
        let value = (0.15 + 0.08 * (of(tile, 1) - 0.5) + 0.06 * (fields.clouds.texel(x, y * 2) - 0.5))
            * (0.5 + 0.5 * step(0.0, 0.12, down))
            * (0.6 + 0.4 * gap);
        [value * 0.92, value, value * (1.14 + 0.2 * of(tile, 2)), 1.0]
    })
}

fn slate_normal(fields: &Fields, _seed: u32) -> Texture {
    normals("slate normals", 512, |x, y| {
        let (tile, down, across) = tiling(x, y, 512, 10, 8);
        let gap = step(0.0, 0.05, across.min(1.0 - across));
        6.0 * down * (0.8 + 0.4 * of(tile, 3)) + 1.5 * gap + 2.0 * fields.clouds.texel(x, y)
    })
}

/// Worn asphalt: stones in bitumen, stains, and a few cracks sealed with tar.
fn tarmac(fields: &Fields, x: usize, y: usize) -> f32 {
    let stone = step(0.58, 0.80, fields.grain.texel(x, y));
    let crack = 1.0 - step(0.0, 0.012, (fields.stains.texel(x + 57, y + 91) - 0.47).abs());
    0.165 + 0.10 * (fields.stains.texel(x / 2, y / 2) - 0.5) + 0.06 * (fields.clouds.texel(x, y) - 0.5) + 0.075 * stone - 0.055 * crack
}

/// Plain asphalt on four metres of road.
fn asphalt(fields: &Fields, _seed: u32) -> Texture {
    color("asphalt", 512, |x, y| grey(tarmac(fields, x, y), 0.04))
}

/// White paint on the road, worn by tyres.
fn paint(fields: &Fields, x: usize, y: usize) -> f32 {
    let worn = step(0.52, 0.70, fields.clouds.texel(x * 2, y * 2)) * 0.55 + 0.25 * step(0.5, 0.8, fields.grain.texel(x, y));
    (1.0 - worn).clamp(0.0, 1.0)
}

/// Distance from the edge of a band to the point, as coverage: 1 inside.
fn band(at: f32, half: f32, soft: f32, x: f32) -> f32 {
    1.0 - step(half - soft, half + soft, (x - at).abs())
}

/// The whole width of the carriageway, 9.6 m, and twelve metres of its length: a broken centre line, lines beside the parked cars and the
/// ends of their bays, tracks of tyres, and dirt in the gutters.
fn lanes(fields: &Fields, _seed: u32) -> Texture {
    color("lanes", 1024, |x, y| {
        let along = 12.0 * (x as f32 + 0.5) / 1024.0;
        let z = 9.6 * ((y as f32 + 0.5) / 1024.0 - 0.5);
        let dash = band(3.0, 1.5, 0.02, along.rem_euclid(6.0));
        let side = z.abs();
        let mut white = band(0.0, 0.06, 0.012, z) * dash;
        white = white.max(0.85 * band(2.75, 0.05, 0.012, side));
        if side > 2.75 {
            white = white.max(0.85 * band(3.0, 0.05, 0.012, along.rem_euclid(6.0)));
        }
        let tracks = band(0.75, 0.22, 0.2, side).max(band(2.1, 0.22, 0.2, side));
        let gutter = step(4.3, 4.8, side);
        let base = tarmac(fields, x, y) * (1.0 - 0.16 * tracks) * (1.0 - 0.4 * gutter) + 0.012 * step(2.8, 3.4, side);
        mix(grey(base, 0.05), grey(0.62, 0.03), white * paint(fields, x, y))
    })
}

/// The whole width of the carriageway and four metres of its length, with the bars of a crossing.
fn crossing(fields: &Fields, _seed: u32) -> Texture {
    color("crossing", 1024, |x, y| {
        let (u, z) = ((x as f32 + 0.5) / 1024.0, 9.6 * ((y as f32 + 0.5) / 1024.0 - 0.5));
        let bar = band(0.5, 0.25, 0.012, (z + 0.5).rem_euclid(1.0)) * band(0.5, 0.375, 0.006, u);
        let bar = if z.abs() < 4.5 { bar } else { 0.0 };
        mix(grey(tarmac(fields, x, y), 0.05), grey(0.66, 0.02), bar * paint(fields, x, y))
    })
}

/// Concrete slabs in a running bond on three metres of pavement.
fn flags(seed: u32) -> Masonry {
    Masonry::new(6, 4, 0.0, seed ^ 0x51ab)
}

const FLAG_JOINT: f32 = 0.0035;

fn slabs(fields: &Fields, seed: u32) -> Texture {
    let flags = flags(seed);
    color("slabs", 1024, |x, y| {
        let (flag, edge) = flags.at(x, y, 1024);
        let (sx, sy) = Masonry::cut(flag, x, y);
        let gum = step(0.83, 0.86, fields.clouds.texel(x * 2 + 77, y * 2 + 11)) * 0.10;
        let value = 0.47
            + 0.13 * (of(flag, 3) - 0.5)
            + 0.12 * (fields.stains.texel(sx, sy) - 0.5)
            + 0.10 * (fields.clouds.texel(x, y) - 0.5)
            + 0.09 * (fields.grain.texel(x, y) - 0.5)
            - gum;
        mix(grey(0.20, 0.05), grey(value * (0.88 + 0.12 * step(0.0, 0.012, edge)), 0.10), Masonry::relief(edge, FLAG_JOINT))
    })
}

fn slabs_normal(fields: &Fields, seed: u32) -> Texture {
    slab_normals("slab normals", fields, &flags(seed), FLAG_JOINT, [2.6, 1.5, 0.7, 3.0])
}

/// Four windows side by side and one above the other: their frames, and what is seen of the rooms through the glass.
fn glazing(fields: &Fields, _seed: u32) -> Texture {
    color("glazing", 512, |x, y| {
        let which = x / 256 + 2 * (y / 256);
        let (a, b) = (((x % 256) as f32 + 0.5) / 256.0, ((y % 256) as f32 + 0.5) / 256.0);
        let cloud = fields.clouds.texel(x, y) - 0.5;
        // Glass mirrors the sky above and the street below.
        let sky = step(0.75, 0.1, b + 0.35 * (a - 0.5));
        let mut shade = [0.035 + 0.05 * sky, 0.045 + 0.075 * sky, 0.055 + 0.12 * sky, 1.0];
        let folds = |pitch: f32| 0.8 + 0.2 * (TAU * a * pitch + 3.0 * cloud).sin();
        let cloth = |tone: f32| [0.55 * tone, 0.52 * tone, 0.46 * tone, 1.0];
        let side = (a - 0.5).abs();
        match which {
            // Curtains drawn back.
            0 => shade = mix(shade, cloth(folds(16.0)), 0.75 * step(0.27, 0.29, side + 0.06 * (b - 0.5))),
            // A blind, half let down.
            1 => {
                let slat = 0.8 + 0.2 * (TAU * b * 24.0).sin();
                shade = mix(shade, cloth(1.05 * slat), 0.85 * (1.0 - step(0.47, 0.48, b)));
            }
            // A lamp's warm corner deep in the room.
            2 => {
                let glow = (-((a - 0.7).powi(2) + (b - 0.6).powi(2)) / 0.03).exp();
                shade = mix(shade, [0.42, 0.27, 0.12, 1.0], 0.5 * glow);
            }
            // Net curtains, and a sill with plants.
            _ => {
                shade = mix(shade, cloth(folds(22.0)), 0.40 * step(0.40, 0.42, b));
                let plant = step(0.80, 0.84, b + 0.5 * cloud);
                shade = mix(shade, [0.07, 0.15, 0.04, 1.0], 0.8 * plant);
            }
        }
        let frame =
            band(0.5, 0.03, 0.006, a).max(band(0.34, 0.02, 0.006, b)).max(step(0.43, 0.44, side)).max(step(0.455, 0.465, (b - 0.5).abs()));
        mix(shade, grey(0.66 + 0.1 * cloud, 0.03), frame)
    })
}

/// Four shop windows, two by two: lit shelves of goods behind glass.
fn shops(fields: &Fields, seed: u32) -> Texture {
    color("shop windows", 512, |x, y| {
        let which = (x / 256 + 2 * (y / 256)) as u32;
        let (a, b) = (((x % 256) as f32 + 0.5) / 256.0, ((y % 256) as f32 + 0.5) / 256.0);
        let cloud = fields.clouds.texel(x, y) - 0.5;
        let depth = 1.0 - 1.3 * (a - 0.5).abs() * (a - 0.5).abs();
        let mut shade = [0.15 * depth, 0.115 * depth, 0.08 * depth, 1.0];
        let shelves = 4.0 + (which % 2) as f32;
        let (row, down) = ((b * shelves) as u32, (b * shelves).fract());
        let columns = [9.0, 6.0, 12.0, 7.0][which as usize];
        let (column, across) = ((a * columns) as u32, (a * columns).fract());
        let goods = hash(column, row, seed ^ which ^ 0x90);
        let height = 0.35 + 0.45 * of(goods, 1);
        if row > 0 && of(goods, 2) > 0.18 && down > 0.94 - height && down < 0.94 && band(0.5, 0.34, 0.03, across) > 0.5 {
            let hue = TAU * of(goods, 3);
            let tone = 0.10 + 0.22 * of(goods, 4);
            let channel = |turn: f32| tone * (1.0 + 0.6 * (hue + turn).cos());
            shade = [channel(0.0), channel(-TAU / 3.0), channel(TAU / 3.0), 1.0];
        }
        if down > 0.94 {
            shade = [0.22, 0.17, 0.11, 1.0];
        }
        let sky = 0.10 * step(0.62, 0.0, b + 0.4 * a) + 0.04 * cloud;
        [shade[0] + 0.45 * sky, shade[1] + 0.7 * sky, shade[2] + sky, 1.0]
    })
}

/// Posters in rows, four to a row: a ground, a shape and lines of type.
fn posters(fields: &Fields, seed: u32) -> Texture {
    const INKS: [[f32; 3]; 6] =
        [[0.66, 0.06, 0.05], [0.05, 0.16, 0.52], [0.80, 0.52, 0.05], [0.05, 0.34, 0.15], [0.72, 0.68, 0.58], [0.07, 0.07, 0.08]];
    color("posters", 512, |x, y| {
        let (column, row) = (x / 128, y / 256);
        let (a, b) = (((x % 128) as f32 + 0.5) / 128.0, ((y % 256) as f32 + 0.5) / 256.0);
        let poster = hash(column as u32, row as u32, seed ^ 0x905);
        let ground = ((of(poster, 1) * 6.0) as usize + column) % 6;
        let ink = (ground + 1 + (of(poster, 2) * 5.0) as usize % 5) % 6;
        let disc = ((a - 0.5).powi(2) + (2.0 * (b - 0.36)).powi(2)).sqrt();
        let shape = 1.0 - step(0.30, 0.315, disc);
        let line = (b * 22.0) as u32;
        let lettering = b > 0.68 && b < 0.93 && (b * 22.0).fract() < 0.6 && (a - 0.5).abs() < 0.20 + 0.2 * unit(line, poster, 3);
        let covered = if lettering { 1.0 } else { shape };
        let paper = band(0.5, 0.47, 0.01, a) * band(0.5, 0.48, 0.005, b);
        let shade = 0.95 + 0.25 * (fields.clouds.texel(x, y) - 0.5);
        let picture: [f32; 4] =
            std::array::from_fn(|i| if i == 3 { 1.0 } else { (INKS[ground][i] + (INKS[ink][i] - INKS[ground][i]) * covered) * shade });
        mix(grey(0.45, 0.02), picture, paper)
    })
}

/// Awning cloth: stripes of a colour and white, four of each on two metres.
fn stripes(name: &str, fields: &Fields, [r, g, b]: [f32; 3]) -> Texture {
    color(name, 256, |x, y| {
        let thread = 0.93 + 0.05 * ((x as f32 * 1.57).sin() * (y as f32 * 1.57).sin()) + 0.16 * (fields.clouds.texel(x, y * 2) - 0.5);
        let base = if (x / 32).is_multiple_of(2) { [r, g, b] } else { [0.74, 0.72, 0.66] };
        [base[0] * thread, base[1] * thread, base[2] * thread, 1.0]
    })
}
