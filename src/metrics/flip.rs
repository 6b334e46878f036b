//! FLIP, the difference seen when two pictures are flipped between (Andersson et al. 2020), and HDR-FLIP, its maximum over
//! exposures (Andersson et al. 2021).

use super::Image;
use crate::color::{linear_to_srgb8, luminance};
use rayon::prelude::*;
use serde::Serialize;

/// Rows per band. An image of any size takes the memory of a few bands.
const BAND: usize = 64;
/// Reach of FLIP's filters at 67 pixels a degree, pixels: the blue-yellow filter has the largest, 3 sqrt(0.04 / 2π²) of a
/// degree. Pixels farther from a band do not affect it.
const REACH: usize = 10;

/// Exposures of HDR-FLIP, in stops.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Exposures {
    /// Exposure that shows the reference's brightest pixel at 0.85 of white.
    pub start: f64,
    /// Exposure that shows the reference's median at 0.85 of white.
    pub stop: f64,
    /// Number of exposures, evenly spaced from `start` to `stop`.
    pub count: usize,
}

impl Exposures {
    /// The exposures for a reference. If more than half of it is black, the median is taken over the rest. A median more than
    /// 24 stops below the maximum is raised to 24 stops: neither case shows anything, and the paper's formula is undefined
    /// there. A black reference has exposure 0 alone.
    pub fn of(reference: &Image) -> Self {
        let mut luminances: Vec<f32> = reference.values().par_chunks_exact(3).map(|pixel| luminance(pixel) as f32).collect();
        let brightest = luminances.iter().copied().fold(0.0, f32::max);
        if brightest <= 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 1 };
        }
        let mut middle = median(&mut luminances);
        if middle <= 0.0 {
            luminances.retain(|&luminance| luminance > 0.0);
            middle = median(&mut luminances);
        }
        let brightest = f64::from(brightest);
        let middle = middle.max(brightest * 0.5_f64.powi(24));
        let [start, stop] = [brightest, middle].map(|luminance| (light_for(0.85) / luminance).log2());
        Self { start, stop, count: ((brightest / middle).log2().ceil() as usize).max(2) }
    }

    fn factors(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / (self.count.max(2) - 1) as f64;
        (0..self.count).map(move |i| (self.start + step * i as f64).exp2())
    }
}

/// Median; the mean of the two middle values of an even number.
fn median(values: &mut [f32]) -> f64 {
    let count = values.len();
    let (below, &mut upper, _) = values.select_nth_unstable_by(count / 2, f32::total_cmp);
    let lower = if count.is_multiple_of(2) { below.iter().copied().fold(f32::MIN, f32::max) } else { upper };
    (f64::from(lower) + f64::from(upper)) / 2.0
}

/// Narkowicz' fit of the ACES curve without its exposure of 0.6, as in HDR-FLIP: (a x² + b x) / (c x² + d x + e).
const ACES: [f64; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

/// Inverse of the curve: the positive root of (a - c t) x² + (b - d t) x - e t, with t the shown value.
fn light_for(shown: f64) -> f64 {
    let [a, b, c, d, e] = ACES;
    let half = (b - d * shown) / (a - c * shown) / 2.0;
    (half * half + e * shown / (a - c * shown)).sqrt() - half
}

/// The curve for positive light. Other light is black: the curve would raise values far below zero again.
fn tone_map(light: f64) -> f64 {
    let [a, b, c, d, e] = ACES;
    let x = light.max(0.0);
    x * (a * x + b) / (x * (c * x + d) + e)
}

/// HDR-FLIP, a pixel's largest FLIP over the exposures. The crate works on 8-bit pictures, while the authors' program does not
/// round: differences within an 8-bit step at every exposure are missed, and means differ from theirs by up to about 0.001.
pub(super) fn hdr(test: &Image, reference: &Image, exposures: Exposures) -> Vec<f32> {
    let factors: Vec<f64> = exposures.factors().collect();
    maximum(test, reference, |factor, value| linear_to_srgb8(tone_map(f64::from(value) * factor)), &factors)
}

/// FLIP of two pictures without exposure or tone mapping.
pub(super) fn ldr(test: &Image, reference: &Image) -> Vec<f32> {
    maximum(test, reference, |_, value| linear_to_srgb8(value.into()), &[1.0])
}

/// A pixel's largest FLIP over the factors; `shown` makes a byte of a factor and a value.
fn maximum(test: &Image, reference: &Image, shown: impl Fn(f64, f32) -> u8 + Sync, factors: &[f64]) -> Vec<f32> {
    let [width, height] = test.size();
    let mut map = vec![0.0_f32; width * height];
    map.par_chunks_mut(width * BAND).enumerate().for_each(|(band, errors)| {
        let top = (band * BAND).saturating_sub(REACH);
        let bottom = (band * BAND + BAND + REACH).min(height);
        let rows = top * width * 3..bottom * width * 3;
        for &factor in factors {
            let show = |image: &Image| image.values()[rows.clone()].iter().map(|&value| shown(factor, value)).collect::<Vec<u8>>();
            let (test, reference) = (show(test), show(reference));
            if test == reference {
                continue; // Equal bands have no difference, and skipping them saves FLIP's time.
            }
            let picture = |bytes: &[u8]| nv_flip::FlipImageRgb8::with_data(width as u32, (bottom - top) as u32, bytes);
            let found = nv_flip::flip(picture(&reference), picture(&test), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
            for (error, &found) in errors.iter_mut().zip(&found[(band * BAND - top) * width..]) {
                *error = error.max(found.clamp(0.0, 1.0));
            }
        }
    });
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Content;

    fn image(width: usize, values: Vec<f32>) -> Image {
        Image::new(width, Content::Radiance, &["R", "G", "B"], values).unwrap()
    }

    fn grey(width: usize, luminances: impl IntoIterator<Item = f32>) -> Image {
        image(width, luminances.into_iter().flat_map(|value| [value; 3]).collect())
    }

    /// Waves and steps; the height is no multiple of a band.
    fn waves(width: usize, height: usize, phase: f32) -> Image {
        let value = |i: usize| {
            let (x, y) = ((i / 3 % width) as f32, (i / 3 / width) as f32);
            1.0 + (x * 0.3 + phase).sin() * (y * 0.2 + (i % 3) as f32).cos() + if (x + y) % 17.0 < 2.0 { 3.0 } else { 0.0 }
        };
        image(width, (0..width * height * 3).map(value).collect())
    }

    #[test]
    fn the_curve_reaches_what_it_is_asked_for() {
        for shown in [0.1, 0.5, 0.85] {
            assert!((tone_map(light_for(shown)) - shown).abs() < 1e-12);
        }
        // Narkowicz' curve at its exposure of 0.6.
        let x: f64 = 0.6 * 1.7;
        assert!((tone_map(1.7) - (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).abs() < 1e-12);
        assert_eq!(tone_map(-100.0), 0.0);
    }

    #[test]
    fn exposures_run_from_the_brightest_pixel_to_the_median_a_stop_apart_at_most() {
        let at_white = light_for(0.85);
        let cases: [(&[f32], f64, f64, usize); 6] = [
            (&[1.0, 2.0, 16.0], 16.0, 2.0, 3),
            (&[1.0, 1.0, 3.0, 1000.0], 1000.0, 2.0, 9),
            (&[2.0, 2.0, 2.0], 2.0, 2.0, 2),
            // Black pixels are left out of the median.
            (&[0.0, 0.0, 0.0, 0.0, 1.0, 4.0, 64.0], 64.0, 4.0, 4),
            (&[1e-30, 1e-30, 1.0], 1.0, 0.5_f64.powi(24), 24),
            (&[1.0], 1.0, 1.0, 2),
        ];
        for (luminances, brightest, middle, count) in cases {
            let exposures = Exposures::of(&grey(luminances.len(), luminances.iter().copied()));
            assert_eq!(exposures.count, count, "{luminances:?}");
            assert!((exposures.start - (at_white / brightest).log2()).abs() < 1e-6, "{exposures:?} {luminances:?}");
            assert!((exposures.stop - (at_white / middle).log2()).abs() < 1e-6, "{exposures:?} {luminances:?}");
            let factors: Vec<f64> = exposures.factors().collect();
            assert_eq!(factors.len(), count);
            assert!((factors[0] - exposures.start.exp2()).abs() < 1e-9 && (factors[count - 1] / exposures.stop.exp2() - 1.0).abs() < 1e-9);
        }
        let black = Exposures::of(&grey(2, [0.0, 0.0]));
        assert_eq!((black, black.factors().collect::<Vec<f64>>()), (Exposures { start: 0.0, stop: 0.0, count: 1 }, vec![1.0]));
    }

    #[test]
    fn bands_meet_as_if_there_were_none() {
        let (width, height) = (37, 3 * BAND + 5);
        let [test, reference] = [0.0, 0.4].map(|phase| waves(width, height, phase));
        let picture = |image: &Image| {
            let bytes: Vec<u8> = image.values().iter().map(|&value| linear_to_srgb8(value.into())).collect();
            nv_flip::FlipImageRgb8::with_data(width as u32, height as u32, &bytes)
        };
        let whole = nv_flip::flip(picture(&reference), picture(&test), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
        assert!(whole.iter().all(|error| (0.0..=1.0).contains(error)) && whole.iter().any(|&error| error > 0.1));
        assert_eq!(ldr(&test, &reference), whole);
    }

    #[test]
    fn without_the_short_cut_the_same_picture_has_no_error_either() {
        let picture = || nv_flip::FlipImageRgb8::with_data(16, 16, &(0..16 * 16 * 3).map(|i| (i * 7 % 256) as u8).collect::<Vec<u8>>());
        let errors = nv_flip::flip(picture(), picture(), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
        assert!(errors.iter().all(|&error| error == 0.0));
    }

    #[test]
    fn every_exposure_counts_and_none_lowers_the_error() {
        let [test, reference] = [0.0, 0.1].map(|phase| waves(32, 32, phase));
        let exposures = Exposures::of(&reference);
        let one = |at: f64| hdr(&test, &reference, Exposures { start: at, stop: at, count: 1 });
        let step = (exposures.stop - exposures.start) / (exposures.count - 1) as f64;
        let all: Vec<Vec<f32>> = (0..exposures.count).map(|i| one(exposures.start + step * i as f64)).collect();
        let largest: Vec<f32> = (0..32 * 32).map(|pixel| all.iter().map(|errors| errors[pixel]).fold(0.0, f32::max)).collect();
        assert_eq!(hdr(&test, &reference, exposures), largest);
    }

    #[test]
    fn a_highlight_far_above_1_is_seen_where_a_picture_would_clip_it() {
        let highlight = |value: f32| grey(32, (0..32 * 32).map(|i| if (300..304).contains(&i) { value } else { 0.2 }));
        let (test, reference) = (highlight(60.0), highlight(120.0));
        assert!(ldr(&test, &reference).iter().all(|&error| error == 0.0));
        let found = hdr(&test, &reference, Exposures::of(&reference));
        assert!(found[301] > 0.1, "{}", found[301]);
        assert_eq!(found[31 * 32], 0.0);
    }

    #[test]
    fn the_largest_finite_numbers_are_compared_as_any_others() {
        let bright = |value: f32| grey(16, (0..16 * 16).map(|i| if i % 7 == 0 { value } else { 1e-30 }));
        let (test, reference) = (bright(f32::MAX), bright(f32::MAX / 2.0));
        assert!(hdr(&test, &reference, Exposures::of(&reference)).iter().all(|error| (0.0..=1.0).contains(error)));
    }
}
