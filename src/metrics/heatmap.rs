//! Heatmaps of errors.

use rayon::prelude::*;

/// Errors from 0 to 1 as sRGB bytes, three per pixel, by the magma map: black for 0, through purple and orange, to pale yellow
/// for 1.
pub fn heatmap(errors: &[f32]) -> Vec<u8> {
    let magma = nv_flip::magma_lut().to_vec();
    let colors: Vec<&[u8]> = magma.chunks_exact(3).collect();
    let last = colors.len() - 1;
    errors.par_iter().flat_map_iter(|error| colors[(error.clamp(0.0, 1.0) * last as f32).round() as usize].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_error_is_black_and_a_larger_one_is_brighter() {
        let brightness: Vec<u32> =
            heatmap(&[-1.0, 0.0, 0.25, 0.5, 1.0, 7.0]).chunks(3).map(|c| c.iter().map(|&v| u32::from(v)).sum()).collect();
        assert!(brightness[1] < 10, "{brightness:?}");
        assert!(brightness.is_sorted() && brightness[1] < brightness[2] && brightness[3] < brightness[4], "{brightness:?}");
        assert_eq!((brightness[0], brightness[5]), (brightness[1], brightness[4]));
    }
}
