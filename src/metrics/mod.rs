//! Errors of a picture against its reference: figures and a map.
//!
//! Numbers in, numbers out. Sums have 64 bits and a fixed order: the same images give the same figures to the last bit, on any
//! number of cores.

mod file;
pub mod flicker;
mod flip;
mod heatmap;
mod image;
mod layers;

pub use file::ImageFile;
pub use flip::Exposures;
pub use heatmap::heatmap;
pub use image::{Content, Image};
pub use layers::{Intensity, LayerPair};

use crate::color::luminance;
use crate::fail;
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;

/// Constant added to the reference's square in [`Measures::relmse`], so that black pixels do not divide by zero: that of
/// Rousselle et al. 2011 and of most later papers on rendering. Its unit is the image's squared, and it is the square of a
/// radiance of 0.1: errors in much darker pixels count as absolute ones.
pub const RELMSE_EPSILON: f64 = 0.01;

/// The figures of a comparison of the test's numbers t and the reference's r.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Square root of the mean of (t - r)² over pixels and channels.
    pub rmse: f64,
    /// Mean of |t - r| over pixels and channels.
    pub mae: f64,
    /// Mean of (t - r)² / (r² + [`RELMSE_EPSILON`]) over pixels and channels.
    pub relmse: f64,
    /// The test's mean over the reference's: 1 if both are 0; infinite, and `null` in JSON, if only the reference's is 0.
    pub energy: Option<f64>,
    /// 99th percentile of the pixels' errors, a pixel's error being the largest |t - r| of its channels: 99 % of the pixels,
    /// rounded up to a whole one, have at most this error.
    pub worst: f64,
    /// Mean of FLIP over the pixels, from 0 to 1; only for colours.
    pub flip: Option<f64>,
    /// The means whose ratio is `energy`.
    pub mean: Option<Means>,
    /// The exposures of HDR-FLIP; only for colours without an upper bound.
    pub exposures: Option<Exposures>,
}

/// Mean luminance of colours, or mean of single numbers. Vectors have no mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Means {
    pub test: f64,
    pub reference: f64,
}

impl Means {
    fn ratio(self) -> f64 {
        if self.test == self.reference { 1.0 } else { self.test / self.reference }
    }
}

/// The figures of a comparison, and the map of errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    pub measures: Measures,
    /// Errors from 0 to 1, one per pixel, row by row from the top: FLIP for colours, otherwise the error over the largest one.
    pub map: Vec<f32>,
}

/// Compares `test` with `reference`.
///
/// # Errors
/// `BadInput` if the images' sizes or kinds differ.
pub fn compare(test: &Image, reference: &Image) -> Result<Comparison> {
    check_alike(test, reference)?;
    let sums = sums(test, reference);
    let count = test.values().len() as f64;
    let pixels = count / test.channels() as f64;
    let mean = sums.means.map(|[test, reference]| Means { test: test / pixels, reference: reference / pixels });
    let mut errors = errors(test, reference);
    let (map, exposures) = match test.content() {
        Content::Radiance => {
            let exposures = Exposures::of(reference);
            (Some(flip::hdr(test, reference, exposures)), Some(exposures))
        }
        Content::Shown => (Some(flip::ldr(test, reference)), None),
        Content::Data => (None, None),
    };
    let flip = map.as_ref().map(|map| map.par_chunks(test.width()).map(sum).collect::<Vec<f64>>().iter().sum::<f64>() / pixels);
    let map = map.unwrap_or_else(|| relative_to_the_largest(&errors));
    let measures = Measures {
        rmse: (sums.squares / count).sqrt(),
        mae: sums.absolutes / count,
        relmse: sums.relative_squares / count,
        energy: mean.map(Means::ratio),
        worst: percentile_99(&mut errors),
        flip,
        mean,
        exposures,
    };
    Ok(Comparison { measures, map })
}

/// [`Measures::rmse`] alone.
///
/// # Errors
/// See [`compare`].
pub fn rmse(test: &Image, reference: &Image) -> Result<f64> {
    check_alike(test, reference)?;
    Ok((sums(test, reference).squares / test.values().len() as f64).sqrt())
}

fn check_alike(test: &Image, reference: &Image) -> Result<()> {
    if test.size() != reference.size() {
        let ([width, height], [reference_width, reference_height]) = (test.size(), reference.size());
        return Err(fail!(
            BadInput,
            "the sizes differ: {width} x {height} pixels in the test, {reference_width} x {reference_height} in the reference"
        ));
    }
    if (test.content(), test.channels()) != (reference.content(), reference.channels()) {
        return Err(fail!(BadInput, "the test holds {}, the reference {}", test.describe(), reference.describe()));
    }
    Ok(())
}

impl Measures {
    /// Figures of several frames together: `rmse` is the root of the mean square; `mae`, `relmse`, `flip` and the means are averaged;
    /// `energy` is the ratio of the averaged means; `worst` is the largest. `None` without frames.
    pub fn over_frames(frames: &[Self]) -> Option<Self> {
        let count = frames.len() as f64;
        let average = |figure: &dyn Fn(&Self) -> Option<f64>| frames.iter().map(figure).sum::<Option<f64>>().map(|sum| sum / count);
        let mean = |figure: fn(&Means) -> f64| average(&|frame| frame.mean.as_ref().map(figure));
        let mean = mean(|mean| mean.test).zip(mean(|mean| mean.reference)).map(|(test, reference)| Means { test, reference });
        Some(Self {
            rmse: average(&|frame| Some(frame.rmse * frame.rmse))?.sqrt(),
            mae: average(&|frame| Some(frame.mae))?,
            relmse: average(&|frame| Some(frame.relmse))?,
            energy: mean.map(Means::ratio),
            worst: frames.iter().map(|frame| frame.worst).reduce(f64::max)?,
            flip: average(&|frame| frame.flip),
            mean,
            exposures: None,
        })
    }
}

/// Sums over an image or one of its rows.
#[derive(Default)]
struct Sums {
    squares: f64,
    absolutes: f64,
    relative_squares: f64,
    /// Sums of the test and of the reference; `None` for vectors.
    means: Option<[f64; 2]>,
}

/// Sums rows on all cores, then adds them in order.
fn sums(test: &Image, reference: &Image) -> Sums {
    let rows: Vec<Sums> = test.rows().zip(reference.rows()).map(|(t, r)| row_sums(t, r, test)).collect();
    rows.into_iter().reduce(add).unwrap_or_default()
}

fn row_sums(test: &[f32], reference: &[f32], image: &Image) -> Sums {
    let mut sums = Sums::default();
    for (&t, &r) in test.iter().zip(reference) {
        let (r, square) = (f64::from(r), (f64::from(t) - f64::from(r)).powi(2));
        sums.squares += square;
        sums.absolutes += (f64::from(t) - r).abs();
        sums.relative_squares += square / (r * r + RELMSE_EPSILON);
    }
    sums.means = match (image.content(), image.channels()) {
        (Content::Radiance | Content::Shown, _) => {
            let mean = |row: &[f32]| row.chunks_exact(3).map(luminance).sum();
            Some([mean(test), mean(reference)])
        }
        (Content::Data, 1) => Some([sum(test), sum(reference)]),
        (Content::Data, _) => None,
    };
    sums
}

fn add(a: Sums, b: Sums) -> Sums {
    Sums {
        squares: a.squares + b.squares,
        absolutes: a.absolutes + b.absolutes,
        relative_squares: a.relative_squares + b.relative_squares,
        means: a.means.zip(b.means).map(|(a, b)| [a[0] + b[0], a[1] + b[1]]),
    }
}

fn sum(values: &[f32]) -> f64 {
    values.iter().map(|&value| f64::from(value)).sum()
}

/// A pixel's largest |t - r|.
fn errors(test: &Image, reference: &Image) -> Vec<f32> {
    let channels = test.channels();
    let pixels = test.values().par_chunks_exact(channels).zip(reference.values().par_chunks_exact(channels));
    pixels.map(|(t, r)| t.iter().zip(r).map(|(t, r)| (t - r).abs()).fold(0.0, f32::max)).collect()
}

/// Nearest-rank percentile; reorders the errors.
fn percentile_99(errors: &mut [f32]) -> f64 {
    // The nearest rank: the 99th of 100 errors.
    let rank = (errors.len() * 99).div_ceil(100);
    let (_, &mut error, _) = errors.select_nth_unstable_by(rank.saturating_sub(1), f32::total_cmp);
    f64::from(error)
}

fn relative_to_the_largest(errors: &[f32]) -> Vec<f32> {
    let largest = errors.iter().copied().fold(0.0, f32::max);
    errors.iter().map(|&error| if largest > 0.0 { error / largest } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests;
