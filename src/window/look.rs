//! How an image of a pass is made visible: layer, channel, range, false colours.

use crate::color::linear_to_srgb8;
use crate::gpu::Format;
use crate::graph::DumpData;
use crate::metrics::heatmap;
use egui::{Color32, ColorImage};
use rayon::prelude::*;

/// Channels that are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channel {
    /// The first three as red, green and blue; one alone as grey.
    #[default]
    All,
    /// One of them.
    One(usize),
}

/// Settings of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    pub layer: u32,
    pub channel: Channel,
    /// Values that are shown as black and as white; found from the image if `None`.
    pub range: Option<[f32; 2]>,
    /// Whether the range is spread by the logarithm.
    pub log: bool,
    pub false_color: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { layer: 0, channel: Channel::All, range: None, log: false, false_color: false }
    }
}

/// An image of a pass on the host.
pub struct Texels<'d> {
    pub format: Format,
    pub size: [u32; 2],
    pub layers: u32,
    bytes: &'d [u8],
}

impl<'d> Texels<'d> {
    /// The image in a dump; `None` for a buffer.
    pub fn of(data: &'d DumpData) -> Option<Self> {
        match data {
            DumpData::Image { format, size, layers, texels } => Some(Self { format: *format, size: *size, layers: *layers, bytes: texels }),
            DumpData::Buffer { .. } => None,
        }
    }

    /// Values of a texel; `None` outside of the image.
    pub fn at(&self, x: u32, y: u32, layer: u32) -> Option<[f32; 4]> {
        let inside = x < self.size[0] && y < self.size[1] && layer < self.layers;
        let index = (layer as usize * self.size[1] as usize + y as usize) * self.size[0] as usize + x as usize;
        let bytes = self.format.texel_bytes();
        inside.then(|| self.format.decode(&self.bytes[index * bytes..][..bytes]))
    }

    /// Bytes of all layers.
    pub fn all(&self) -> &'d [u8] {
        self.bytes
    }

    fn layer(&self, layer: u32) -> &'d [u8] {
        let bytes = self.size[0] as usize * self.size[1] as usize * self.format.texel_bytes();
        &self.bytes[bytes * layer.min(self.layers - 1) as usize..][..bytes]
    }

    /// The layer as a picture, and the range that it shows.
    pub fn picture(&self, look: &Look) -> (ColorImage, [f32; 2]) {
        let (texel, bytes) = (self.format.texel_bytes(), self.layer(look.layer));
        let size = self.size.map(|side| side as usize);
        let encoded = matches!(self.format, Format::Rgba8Unorm) && self.layers == 1;
        if encoded && *look == Look::default() {
            let pixels = bytes.chunks_exact(4).map(|texel| Color32::from_rgb(texel[0], texel[1], texel[2])).collect();
            return (ColorImage::new(size, pixels), [0.0, 1.0]);
        }
        let channels = self.format.channels();
        let chosen = move |texel: [f32; 4]| match look.channel {
            Channel::One(channel) => [texel[channel]; 3],
            Channel::All if channels == 1 => [texel[0]; 3],
            Channel::All => [texel[0], texel[1], texel[2]],
        };
        let values: Vec<[f32; 3]> = bytes.par_chunks_exact(texel).map(|texel| chosen(self.format.decode(texel))).collect();
        let range = look.range.unwrap_or_else(|| found(&values));
        let [low, high] = if look.log { range.map(|bound| bound.max(1e-6).ln()) } else { range };
        let spread = |value: f32| {
            let value = if look.log { value.max(1e-6).ln() } else { value };
            ((value - low) / (high - low).max(1e-30)).clamp(0.0, 1.0)
        };
        let pixels: Vec<Color32> = if look.false_color {
            let luminance = |[r, g, b]: &[f32; 3]| spread(0.2126 * r + 0.7152 * g + 0.0722 * b);
            let shares: Vec<f32> = values.par_iter().map(luminance).collect();
            heatmap(&shares).chunks_exact(3).map(|color| Color32::from_rgb(color[0], color[1], color[2])).collect()
        } else {
            let byte = |value: f32| {
                let value = spread(value);
                if encoded { (value * 255.0).round() as u8 } else { linear_to_srgb8(f64::from(value)) }
            };
            // A value that is no number stands out.
            let color = |rgb: &[f32; 3]| match rgb.iter().all(|value| value.is_finite()) {
                true => Color32::from_rgb(byte(rgb[0]), byte(rgb[1]), byte(rgb[2])),
                false => Color32::from_rgb(255, 0, 255),
            };
            values.par_iter().map(color).collect()
        };
        (ColorImage::new(size, pixels), range)
    }
}

/// A range that shows nearly all of an image: from its least value, or 0, to the value that a two hundredth exceeds.
fn found(values: &[[f32; 3]]) -> [f32; 2] {
    let step = (values.len() / 65_536).max(1);
    let mut sample: Vec<f32> = values.iter().step_by(step).flatten().copied().filter(|value| value.is_finite()).collect();
    if sample.is_empty() {
        return [0.0, 1.0];
    }
    sample.sort_unstable_by(f32::total_cmp);
    let (low, high) = (sample[0].min(0.0), sample[(sample.len() - 1) * 199 / 200]);
    [low, if high > low { high } else { low + 1.0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dump(values: &[f32]) -> DumpData {
        let texels = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        DumpData::Image { format: Format::R32Float, size: [values.len() as u32 / 2, 1], layers: 2, texels }
    }

    #[test]
    fn a_layer_is_spread_over_its_range() {
        let data = dump(&[0.0, 1.0, 2.0, 4.0, 0.0, 8.0, 8.0, 8.0]);
        let texels = Texels::of(&data).unwrap();
        let (picture, range) = texels.picture(&Look::default());
        assert_eq!((picture.size, range), ([4, 1], [0.0, 4.0]));
        assert_eq!((picture.pixels[0], picture.pixels[3]), (Color32::BLACK, Color32::WHITE));
        let look = Look { layer: 1, range: Some([0.0, 16.0]), ..Look::default() };
        let half = linear_to_srgb8(0.5);
        assert_eq!(texels.picture(&look).0.pixels[1], Color32::from_gray(half));
        assert_eq!((texels.at(1, 0, 1), texels.at(4, 0, 0)), (Some([8.0, 0.0, 0.0, 0.0]), None));
    }

    #[test]
    fn what_is_no_number_stands_out() {
        let data = dump(&[f32::NAN, 1.0, 0.5, 0.5]);
        let (picture, _) = Texels::of(&data).unwrap().picture(&Look::default());
        assert_eq!(picture.pixels[0], Color32::from_rgb(255, 0, 255));
    }

    #[test]
    fn a_picture_is_shown_byte_by_byte() {
        let texels = vec![10, 20, 30, 255, 1, 2, 3, 0];
        let data = DumpData::Image { format: Format::Rgba8Unorm, size: [2, 1], layers: 1, texels };
        let (picture, _) = Texels::of(&data).unwrap().picture(&Look::default());
        assert_eq!(picture.pixels, [Color32::from_rgb(10, 20, 30), Color32::from_rgb(1, 2, 3)]);
    }
}
