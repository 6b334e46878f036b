//! Flicker: changes of visible surfaces from frame to frame.
//!
//! The temporal image difference of Barák, Bittner and Havran 2013, section 6.2: each pixel of a frame is looked up in the next
//! frame by its world position. The figure is the root mean square of the differences of intensity over the matched pixels. An
//! intensity is the luminance of a colour, in the colour's unit.
//!
//! A pixel is compared with the **nearest** pixel of the next frame, not with a blend of four. A blend averages noise away, by
//! an amount that depends on the camera's motion within a pixel: noise of variance s² would give a flicker from √(5/4) s to √2
//! s. With the nearest pixel it is √2 s for any motion, and 0 without motion. The price is an error of up to half a pixel's
//! gradient, in any lighting. A reference sequence compared by the same matches shows how large it is.

use super::heatmap;
use crate::world::projection::View;
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

/// Cosine of 20 degrees: surfaces turned farther are taken as different, or as another side.
const SAME_NORMAL: f32 = 0.939_692_6;

/// Allowed distance of a point from the tangent plane of its match, in pixel footprints. On one surface, curvature and the
/// difference between shading normal and tangent plane cause such distances.
const OFF_PLANE: f64 = 1.0;

/// Allowed distance of a point along its match's plane, in pixel footprints stretched by the surface's slant. The nearest
/// pixel's centre is at most 0.71 away; the rest is for shading normals less slanted than their surface.
const ALONG_PLANE: f64 = 2.0;

/// Least cosine of the slant: beyond about 84 degrees footprints stretch no more.
const MOST_SLANTED: f64 = 0.1;

/// Surfaces seen by a frame's pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Surfaces {
    pub view: View,
    /// World positions, m.
    pub positions: Vec<Vec3>,
    /// World normals of length 1; zero for pixels without surface.
    pub normals: Vec<Vec3>,
}

/// Match of a pixel in the next frame, or the reason for its lack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// Index of the next frame's pixel that shows the same surface.
    Matched(u32),
    /// The pixel shows no surface.
    Empty,
    /// The surface left the picture.
    Outside,
    /// Another surface is there, or none.
    Hidden,
    /// The surface there faces another way.
    Turned,
}

/// Fate of each pixel of a frame in the next frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Matches(Vec<Fate>);

/// The flicker between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pair {
    /// Root mean square of the matched pixels' differences of intensity; `None` without a match.
    pub flicker: Option<f64>,
    /// Mean intensity of the matched pixels in both frames, to compare `flicker` with.
    pub mean: Option<f64>,
    /// Pixels of the first frame with a match in the next.
    pub matched: u64,
    /// Pixels with a surface: the sum of `matched`, `outside`, `hidden` and `turned`.
    pub surfaces: u64,
    /// Pixels whose surface left the picture.
    pub outside: u64,
    /// Pixels at whose place another surface is seen.
    pub hidden: u64,
    /// Pixels at whose place the surface faces another way.
    pub turned: u64,
    /// All pixels.
    pub pixels: u64,
}

/// The flicker over a camera path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flicker {
    /// Root mean square over the matched pixels of all pairs together; a pair is weighted by its matched pixels.
    pub flicker: f64,
    /// Mean of the pairs' flicker, equally weighted.
    pub mean_of_pairs: f64,
    /// Flicker of the worst pair.
    pub largest: f64,
    /// Mean intensity of the matched pixels.
    pub mean: f64,
    /// Matched pixels over pixels with a surface, of all pairs.
    pub matched_share: f64,
}

/// Matches each pixel of a frame in the next one. Their sizes may differ.
///
/// A pixel's world position is projected into the next view. The pixel there is the match, unless its surface is elsewhere:
/// farther than a pixel's footprint off the tangent plane, farther along it than the nearest pixel can be, or turned by more
/// than 20 degrees.
pub fn matches(previous: &Surfaces, next: &Surfaces) -> Matches {
    previous.check();
    next.check();
    let pixels = previous.positions.par_iter().zip(&previous.normals);
    Matches(pixels.map(|(position, normal)| next.fate(*position, *normal)).collect())
}

impl Surfaces {
    fn check(&self) {
        let pixels = self.view.width as usize * self.view.height as usize;
        assert!(self.positions.len() == pixels && self.normals.len() == pixels, "a position and a normal for each of {pixels} pixels");
    }

    /// Fate in this frame of a point of the frame before.
    fn fate(&self, position: Vec3, normal: Vec3) -> Fate {
        if normal == Vec3::ZERO {
            return Fate::Empty;
        }
        let inside = |at: f64, size: u32| (at >= 0.0 && at < f64::from(size)).then_some(at as usize);
        let Some((at, _)) = self.view.pixel_of(position) else { return Fate::Outside };
        let (Some(x), Some(y)) = (inside(at.x, self.view.width), inside(at.y, self.view.height)) else { return Fate::Outside };
        let pixel = y * self.view.width as usize + x;
        let there = self.normals[pixel];
        if there == Vec3::ZERO {
            return Fate::Hidden;
        }
        let seen = self.positions[pixel].as_dvec3();
        let plane = there.as_dvec3();
        let eye = seen - Vec3::from(self.view.position).as_dvec3();
        let footprint = self.view.pixel_size() * eye.dot(Vec3::from(self.view.forward).as_dvec3());
        let slant = (eye.normalize_or_zero().dot(plane)).abs().max(MOST_SLANTED);
        let apart = position.as_dvec3() - seen;
        let off = apart.dot(plane);
        let along = (apart - off * plane).length();
        if off.abs() > OFF_PLANE * footprint || along > ALONG_PLANE * footprint / slant {
            return Fate::Hidden;
        }
        if normal.dot(there) < SAME_NORMAL { Fate::Turned } else { Fate::Matched(pixel as u32) }
    }
}

impl Matches {
    /// The pixels' fates, row by row from the top of the first frame.
    pub fn fates(&self) -> &[Fate] {
        &self.0
    }

    /// Intensity of the next frame minus the first one's, for each pixel of the first; `None` without a match.
    pub fn differences(&self, previous: &[f32], next: &[f32]) -> Vec<Option<f64>> {
        assert_eq!(previous.len(), self.0.len(), "an intensity a pixel");
        let difference = |(fate, was): (&Fate, &f32)| match fate {
            Fate::Matched(pixel) => Some(f64::from(next[*pixel as usize]) - f64::from(*was)),
            _ => None,
        };
        self.0.iter().zip(previous).map(difference).collect()
    }

    /// The flicker between two frames of these intensities.
    pub fn pair(&self, previous: &[f32], next: &[f32]) -> Pair {
        assert_eq!(previous.len(), self.0.len(), "an intensity a pixel");
        let (mut squares, mut sum) = (0.0, 0.0);
        let mut pair =
            Pair { flicker: None, mean: None, matched: 0, surfaces: 0, outside: 0, hidden: 0, turned: 0, pixels: self.0.len() as u64 };
        for (fate, was) in self.0.iter().zip(previous) {
            match fate {
                Fate::Matched(pixel) => {
                    let (was, is) = (f64::from(*was), f64::from(next[*pixel as usize]));
                    squares += (is - was) * (is - was);
                    sum += 0.5 * (is + was);
                    pair.matched += 1;
                }
                Fate::Empty => continue,
                Fate::Outside => pair.outside += 1,
                Fate::Hidden => pair.hidden += 1,
                Fate::Turned => pair.turned += 1,
            }
            pair.surfaces += 1;
        }
        if pair.matched > 0 {
            let count = pair.matched as f64;
            pair.flicker = Some((squares / count).sqrt());
            pair.mean = Some(sum / count);
        }
        pair
    }
}

impl Flicker {
    /// The flicker over a path's pairs; `None` if no pixel of any pair has a match.
    pub fn over(pairs: &[Pair]) -> Option<Self> {
        let matched: u64 = pairs.iter().map(|pair| pair.matched).sum();
        let surfaces: u64 = pairs.iter().map(|pair| pair.surfaces).sum();
        let weighted = |figure: &dyn Fn(&Pair) -> Option<f64>| -> f64 {
            let sums = pairs.iter().filter_map(|pair| Some(figure(pair)? * pair.matched as f64));
            sums.sum::<f64>() / matched as f64
        };
        let flickers: Vec<f64> = pairs.iter().filter_map(|pair| pair.flicker).collect();
        Some(Self {
            largest: flickers.iter().copied().reduce(f64::max)?,
            mean_of_pairs: flickers.iter().sum::<f64>() / flickers.len() as f64,
            flicker: weighted(&|pair| pair.flicker.map(|flicker| flicker * flicker)).sqrt(),
            mean: weighted(&|pair| pair.mean),
            matched_share: matched as f64 / surfaces as f64,
        })
    }
}

/// Colour of pixels without a match, outside the heatmap's colours.
const UNMATCHED: [u8; 3] = [0, 70, 80];

/// Difference shown brightest by [`difference_map`], as a part of the mean intensity.
const BRIGHTEST: f64 = 0.5;

/// Differences as sRGB bytes, three per pixel: from black for none, through purple and orange, to pale yellow for half of
/// `mean`. Pixels without a match are dark teal.
pub fn difference_map(differences: &[Option<f64>], mean: f64) -> Vec<u8> {
    let scale = if mean > 0.0 { 1.0 / (BRIGHTEST * mean) } else { 0.0 };
    let errors: Vec<f32> = differences.iter().map(|difference| (difference.unwrap_or(0.0).abs() * scale) as f32).collect();
    let mut colors = heatmap(&errors);
    for (color, _) in colors.chunks_exact_mut(3).zip(differences).filter(|(_, difference)| difference.is_none()) {
        color.copy_from_slice(&UNMATCHED);
    }
    colors
}

#[cfg(test)]
mod tests;
