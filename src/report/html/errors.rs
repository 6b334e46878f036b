//! Pictures and errors of runs: read, measured, and encoded for the page.

use super::folders::Run;
use crate::metrics::{self, Image, ImageFile, LayerPair, Measures, heatmap};
use crate::output::{png_bytes, read_png};
use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A PNG embedded in the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picture {
    /// The data: URI.
    pub uri: String,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

impl Picture {
    fn new(png: &[u8], width: u32, height: u32) -> Self {
        Self { uri: format!("data:image/png;base64,{}", STANDARD.encode(png)), width, height }
    }

    /// Embeds a PNG file unchanged.
    ///
    /// # Errors
    /// `BadInput` with the path and the fault of the file.
    pub fn read(path: &Path) -> Result<Self> {
        // The file is decoded only to check it.
        let png = read_png(path)?;
        let bytes = std::fs::read(path).map_err(|error| crate::fail!(BadInput, "{}: cannot be read ({error})", path.display()))?;
        Ok(Self::new(&bytes, png.width, png.height))
    }

    fn of_errors(map: &[f32], width: usize) -> Result<Self> {
        let (width, height) = (width as u32, (map.len() / width) as u32);
        Ok(Self::new(&png_bytes(width, height, &heatmap(map))?, width, height))
    }

    /// The heatmaps' colours from 0 to 1, from left to right.
    pub fn ramp() -> Result<Self> {
        let ramp: Vec<f32> = (0..128).map(|i| i as f32 / 127.0).collect();
        Self::of_errors(&ramp, ramp.len())
    }
}

/// Measures of a run against its reference, and a heatmap of its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    pub measures: Measures,
    pub heatmap: Picture,
}

/// Measures runs. The layers of a reference are read once.
pub struct Measurer<'l> {
    layers: &'l LayerPair,
    references: BTreeMap<PathBuf, Image>,
}

impl<'l> Measurer<'l> {
    pub fn new(layers: &'l LayerPair) -> Self {
        Self { layers, references: BTreeMap::new() }
    }

    /// Errors of a run against a reference; `None` if one of the two has no layers.
    ///
    /// # Errors
    /// `BadInput` with the file, for a missing layer or a number that is not finite.
    pub fn errors(&mut self, run: &Run, reference: &Run) -> Result<Option<Errors>> {
        let (Some(test), Some(truth)) = (run.layers(), reference.layers()) else { return Ok(None) };
        if !self.references.contains_key(&truth) {
            let image = ImageFile::open(&truth)?.layer(&self.layers.reference)?;
            self.references.insert(truth.clone(), image);
        }
        let image = ImageFile::open(&test)?.layer(&self.layers.test)?;
        let context = || format!("{} and {}: layer {}", test.display(), truth.display(), self.layers);
        let comparison = metrics::compare(&image, &self.references[&truth]).with_context(context)?;
        let heatmap = Picture::of_errors(&comparison.map, image.width())?;
        Ok(Some(Errors { measures: comparison.measures, heatmap }))
    }
}
