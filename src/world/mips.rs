//! Mips of textures, made on the host: a driver's blits round each level anew, each driver in its own way. llvmpipe's made the atrium .7 %
//! too dark.

use crate::color::srgb_to_linear;
use rayon::prelude::*;

/// What a texture's texels are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Texels {
    /// Whether RGB is sRGB-encoded colour.
    pub srgb: bool,
    /// Whether alpha is the coverage of a mask: means of colours are weighted by it, since nobody sees the colours of holes.
    pub holes: bool,
}

/// Linear RGB and alpha. With holes: RGB times weight, and the weight.
type Texel = [f32; 4];

/// Weight of a whole hole: a cell with holes alone has a colour too.
const LEAST: f32 = 1.0 / 65536.0;

/// An RGBA8 image of `size` texels, row by row, with all of its mips behind it, each half the size of the one before, rounded down. A texel
/// of a mip is the mean of what it covers, in linear light; alpha is linear.
pub(super) fn with_mips(texels: &[u8], size: [u32; 2], of: Texels) -> Vec<u8> {
    let mut levels = texels.to_vec();
    let decoded: Vec<f32> = (0..=255_u8).map(|byte| decode(byte, of.srgb)).collect();
    let alphas: Vec<f32> = (0..=255_u8).map(|byte| decode(byte, false)).collect();
    let values = [&decoded, &decoded, &decoded, &alphas];

    let mut size = size.map(|side| side as usize);
    let mut level: Vec<Texel> = Vec::new();
    while size != [1, 1] {
        let half = size.map(|side| (side / 2).max(1));
        level = if level.is_empty() {
            let at = |i: usize| {
                let [r, g, b, a] = std::array::from_fn(|channel| values[channel][usize::from(texels[4 * i + channel])]);
                if !of.holes {
                    return [r, g, b, a];
                }
                let weight = a + LEAST;
                [r * weight, g * weight, b * weight, weight]
            };
            shrink(at, size, half)
        } else {
            shrink(|i| level[i], size, half)
        };
        // A row's remainders of rounding go on to the next texel, so that a level has as much light as the texture.
        levels.par_extend(level.par_chunks(half[0]).flat_map_iter(|row| {
            let mut rest = [0.0; 4];
            row.iter().flat_map(move |[r, g, b, a]| {
                let texel = if of.holes { [r / a, g / a, b / a, a - LEAST] } else { [*r, *g, *b, *a] };
                std::array::from_fn::<u8, 4, _>(|channel| {
                    let wanted = texel[channel] + rest[channel];
                    let byte = nearest(values[channel], wanted);
                    rest[channel] = wanted - values[channel][usize::from(byte)];
                    byte
                })
            })
        }));
        size = half;
    }
    levels
}

/// The byte whose value is nearest.
fn nearest(values: &[f32], wanted: f32) -> u8 {
    let over = values.partition_point(|value| *value < wanted).clamp(1, 255);
    (if wanted - values[over - 1] < values[over] - wanted { over - 1 } else { over }) as u8
}

fn decode(byte: u8, srgb: bool) -> f32 {
    let value = f32::from(byte) / 255.0;
    if srgb { srgb_to_linear(value) } else { value }
}

/// Means of an image of `from` texels over the cells of a grid of `to`.
fn shrink(at: impl Fn(usize) -> Texel + Sync, from: [usize; 2], to: [usize; 2]) -> Vec<Texel> {
    let [columns, rows] = [0, 1].map(|axis| (0..to[axis]).map(|cell| covered(cell, from[axis], to[axis])).collect::<Vec<_>>());
    rows.par_iter()
        .flat_map_iter(|row| {
            let (at, columns) = (&at, &columns);
            columns.iter().map(move |column| {
                let mut sum = [0.0; 4];
                for (y, down) in row {
                    for (x, along) in column {
                        let texel = at(y * from[0] + x);
                        for channel in 0..4 {
                            sum[channel] += down * along * texel[channel];
                        }
                    }
                }
                sum
            })
        })
        .collect()
}

/// The texels that a cell covers along an axis, and their shares of it.
fn covered(cell: usize, from: usize, to: usize) -> Vec<(usize, f32)> {
    // In parts of a texel, of which it has `to`.
    let (first, end) = (cell * from, (cell + 1) * from);
    (first / to..end.div_ceil(to)).map(|texel| (texel, (end.min((texel + 1) * to) - first.max(texel * to)) as f32 / from as f32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLORS: Texels = Texels { srgb: true, holes: false };
    const DATA: Texels = Texels { srgb: false, holes: false };

    fn last(texels: &[u8], size: [u32; 2], of: Texels) -> [u8; 4] {
        with_mips(texels, size, of).last_chunk().copied().unwrap()
    }

    #[test]
    fn colours_of_holes_are_not_seen() {
        let leaf = |i: usize| if i.is_multiple_of(3) { [20, 90, 10, 255] } else { [250, 240, 255, 0] };
        let texels: Vec<u8> = (0..36).flat_map(leaf).collect();
        let holes = Texels { srgb: true, holes: true };
        assert_eq!(last(&texels, [6, 6], holes), [20, 90, 10, 85]);
        assert_eq!(last(&[250, 240, 255, 0].repeat(36), [6, 6], holes), [250, 240, 255, 0]);
        assert!(last(&texels, [6, 6], COLORS)[0] > 200, "elsewhere alpha says nothing of the colours");
    }

    #[test]
    fn a_checkerboard_of_black_and_white_is_half_as_bright() {
        let checkerboard = |white: u8| (0..64).flat_map(|i| [if (i + i / 8) % 2 == 0 { white } else { 0 }; 4]).collect::<Vec<u8>>();
        assert_eq!(last(&checkerboard(254), [8, 8], COLORS), [187, 187, 187, 127]);
        assert_eq!(last(&checkerboard(254), [8, 8], DATA), [127; 4]);
    }

    #[test]
    fn every_texel_of_an_odd_image_has_the_same_share() {
        for size in [[7, 5], [1, 9], [6, 1], [31, 33]] {
            let area = size[0] * size[1];
            for lit in [0, area / 2, area - 1] {
                let mut level: Vec<Texel> = vec![[0.0; 4]; area];
                level[lit] = [area as f32; 4];
                let mut size: [usize; 2] = size;
                while size != [1, 1] {
                    let half = size.map(|side| (side / 2).max(1));
                    level = shrink(|i| level[i], size, half);
                    size = half;
                }
                assert!((level[0][0] - 1.0).abs() < 1e-5, "{size:?}, texel {lit}: {}", level[0][0]);
            }
        }
    }

    #[test]
    fn a_row_of_a_mip_has_its_light_to_half_a_step_of_its_last_byte() {
        let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8;
        for brightest in [8, 30, 90, 255_u16] {
            let texels: Vec<u8> = (0..4 * 256 * 256).map(|i| (u16::from(noise(i)) * brightest / 255) as u8).collect();
            let levels = with_mips(&texels, [256, 256], COLORS);
            let mean =
                |level: &[u8]| level.iter().step_by(4).map(|byte| f64::from(decode(*byte, true))).sum::<f64>() / (level.len() / 4) as f64;
            let step = decode(brightest as u8, true) - decode(brightest as u8 - 1, true);
            let (mut start, mut side, truth) = (0, 256, mean(&texels));
            while side >= 1 {
                let level = &levels[start..start + 4 * side * side];
                assert!(
                    (mean(level) - truth).abs() < 0.5 * f64::from(step) / f64::from(side as u32) + 1e-6,
                    "{side} texels up to {brightest}: {} of {truth}",
                    mean(level)
                );
                (start, side) = (start + 4 * side * side, side / 2);
            }
        }
    }

    #[test]
    fn mips_end_with_one_texel() {
        assert_eq!(with_mips(&[9; 4], [1, 1], COLORS), [9; 4]);
        assert_eq!(with_mips(&[200; 4 * 5 * 3], [5, 3], DATA), [200; 4 * (15 + 2 + 1)]);
    }
}
