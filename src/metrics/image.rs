//! Images with finite numbers, ready to be compared.

use crate::color::luminance;
use crate::fail;
use anyhow::Result;
use rayon::prelude::*;

/// Content of an image, on which the possible measures depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Linear colours without an upper bound, as in an EXR.
    Radiance,
    /// Linear colours from 0 to 1, as in a PNG.
    Shown,
    /// Data that are no colours: depths, normals, positions.
    Data,
}

/// Finite numbers, `channels` per pixel, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: usize,
    content: Content,
    channels: usize,
    values: Vec<f32>,
}

impl Image {
    /// An image from `values`, with a channel for each name. Colours have three channels.
    ///
    /// # Errors
    /// `BadInput` with the channel and the pixel of a number that is not finite: every measure would be meaningless.
    pub fn new(width: usize, content: Content, channels: &[&str], values: Vec<f32>) -> Result<Self> {
        let row = width * channels.len();
        assert!(!values.is_empty() && values.len().is_multiple_of(row), "{} numbers are no rows of {width} pixels", values.len());
        assert!(content == Content::Data || channels.len() == 3, "colours have three channels");
        if let Some(at) = values.par_iter().position_first(|value| !value.is_finite()) {
            let what = if values[at].is_nan() { "not a number" } else { "infinite" };
            let pixel = at / channels.len();
            let (x, y, channel) = (pixel % width, pixel / width, channels[at % channels.len()]);
            return Err(fail!(BadInput, "channel {channel} is {what} at pixel ({x}, {y})"));
        }
        Ok(Self { width, content, channels: channels.len(), values })
    }

    pub fn width(&self) -> usize {
        self.width
    }

    /// Width and height.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.values.len() / (self.width * self.channels)]
    }

    pub fn content(&self) -> Content {
        self.content
    }

    /// Numbers per pixel.
    pub fn channels(&self) -> usize {
        self.channels
    }

    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Luminance of each pixel of an image of colours.
    pub fn luminances(&self) -> Vec<f32> {
        assert_eq!(self.channels, 3, "colours have a luminance");
        self.values.par_chunks_exact(3).map(|color| luminance(color) as f32).collect()
    }

    pub(super) fn rows(&self) -> impl IndexedParallelIterator<Item = &[f32]> {
        self.values.par_chunks_exact(self.width * self.channels)
    }

    /// The content in words.
    pub fn describe(&self) -> String {
        match (self.content, self.channels) {
            (Content::Radiance, _) => "radiance".to_owned(),
            (Content::Shown, _) => "tone-mapped colours".to_owned(),
            (Content::Data, 1) => "one number a pixel".to_owned(),
            (Content::Data, channels) => format!("{channels} numbers a pixel"),
        }
    }
}
