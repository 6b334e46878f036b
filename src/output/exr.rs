//! OpenEXR images: one part, layers distinguished by the channels' names.

use crate::fail;
use crate::files::write_file;
use ::exr::prelude::{self as e, ReadChannels, ReadLayers, WritableImage};
use anyhow::{Result, anyhow};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

pub use ::exr::prelude::f16;

/// Samples of a channel in their stored precision, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 16 bits, for colours.
    Half(Vec<f16>),
    /// 32 bits, for depth and positions.
    Float(Vec<f32>),
}

impl Samples {
    /// Rounds to half. A finite number beyond half's range is clamped: a bright highlight must not become infinite.
    pub fn half(values: impl IntoIterator<Item = f32>) -> Self {
        let round = |v: f32| f16::from_f32(if v.is_finite() { v.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()) } else { v });
        Self::Half(values.into_iter().map(round).collect())
    }

    pub fn len(&self) -> usize {
        match self {
            Self::Half(values) => values.len(),
            Self::Float(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Precision of a layer's stored samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    Half,
    Float,
}

/// A layer of an image: `direct` with the channels `R`, `G`, `B` is stored as `direct.R`, `direct.G`, `direct.B`.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrLayer {
    /// Empty for the channels without prefix (`R`, `G`, `B`, `A`, `Z`).
    pub name: String,
    /// The channels' own names (`R`, `X`, ...) and their samples, `width * height` each.
    pub channels: Vec<(String, Samples)>,
}

impl ExrLayer {
    /// A layer from interleaved pixels: `stride` numbers per pixel, the first of which become the channels in `names`, one
    /// letter each (`"RGB"`, `"XYZ"`, `"Z"`).
    pub fn interleaved(name: &str, names: &str, stride: usize, values: &[f32], precision: Precision) -> Self {
        assert!(names.len() <= stride && values.len().is_multiple_of(stride), "layer {name:?}: {stride} numbers a pixel do not fit");
        let channels = names.chars().enumerate().map(|(i, channel)| {
            let samples = values.iter().skip(i).step_by(stride).copied();
            let samples = match precision {
                Precision::Half => Samples::half(samples),
                Precision::Float => Samples::Float(samples.collect()),
            };
            (channel.to_string(), samples)
        });
        Self { name: name.to_owned(), channels: channels.collect() }
    }
}

/// Writes an image, losslessly compressed (ZIP). The same arguments give the same bytes.
///
/// `metadata` becomes the standard `comments` attribute, a line `key: value` each: the `exr` crate writes custom attributes in
/// random order, and no two files would be the same.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason; no file is left then.
pub fn write_exr(path: &Path, width: u32, height: u32, layers: Vec<ExrLayer>, metadata: &[(&str, String)]) -> Result<()> {
    write_file(path, &encode(width, height, layers, metadata)?)
}

fn encode(width: u32, height: u32, layers: Vec<ExrLayer>, metadata: &[(&str, String)]) -> Result<Vec<u8>> {
    let pixels = width as usize * height as usize;
    let mut list = e::SmallVec::new();
    for ExrLayer { name: layer, channels } in layers {
        for (channel, samples) in channels {
            let name = if layer.is_empty() { channel } else { format!("{layer}.{channel}") };
            assert_eq!(samples.len(), pixels, "channel {name} does not fit an image of {width}x{height}");
            let samples = match samples {
                Samples::Half(values) => e::FlatSamples::F16(values),
                Samples::Float(values) => e::FlatSamples::F32(values),
            };
            list.push(e::AnyChannel::new(name.as_str(), samples));
        }
    }
    let comments: Vec<_> = metadata.iter().map(|(key, value)| format!("{key}: {value}")).collect();
    let attributes = e::LayerAttributes {
        software_name: Some(e::Text::from(concat!("manylight ", env!("CARGO_PKG_VERSION")))),
        comments: (!comments.is_empty()).then(|| e::Text::from_slice_unchecked(comments.join("\n").as_bytes())),
        ..Default::default()
    };
    let encoding = e::Encoding { compression: e::Compression::ZIP16, blocks: e::Blocks::ScanLines, line_order: e::LineOrder::Increasing };
    let size = (width as usize, height as usize);
    let image = e::Image::from_layer(e::Layer::new(size, attributes, encoding, e::AnyChannels::sort(list)));
    let mut bytes = Cursor::new(Vec::new());
    // The bytes go to memory, so a failure here is the image's and not the disk's.
    image.write().to_buffered(&mut bytes).map_err(|error| anyhow!("an image cannot be encoded: {error}"))?;
    Ok(bytes.into_inner())
}

/// Limit of decoded bytes of an image to read: 16,384 x 16,384 pixels of four channels fit.
pub const MAX_DECODED_BYTES: u128 = 4 << 30;

/// A decoded image: all channels of its first part as 32-bit numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Exr {
    pub width: u32,
    pub height: u32,
    /// Channels by full name (`R`, `direct.R`); `width * height` samples each, row by row from the top.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// The `comments` attribute; empty if the file has none.
    pub comments: String,
}

/// Reads an OpenEXR image.
///
/// # Errors
/// `BadInput` with the path and the fault of the file.
pub fn read_exr(path: &Path) -> Result<Exr> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| fail!(BadInput, "{name}: cannot be read ({error})"))?;
    let refuse = |error: ::exr::error::Error| fail!(BadInput, "{name}: is not an OpenEXR image that can be read ({error})");
    let meta = e::MetaData::read_from_buffered(Cursor::new(&bytes), false).map_err(refuse)?;
    for header in &meta.headers {
        // Not even a black image compresses this well: such a header is damaged, and allocating by it could take all memory.
        let limit = (bytes.len() as u128 * 16_384).min(MAX_DECODED_BYTES);
        let pixels = header.layer_size.width() as u128 * header.layer_size.height() as u128;
        if pixels * header.channels.list.len() as u128 * 4 > limit {
            return Err(fail!(
                BadInput,
                "{name}: is damaged or too large ({} x {} pixels in {} bytes)",
                header.layer_size.width(),
                header.layer_size.height(),
                bytes.len()
            ));
        }
    }
    let read = e::read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = read.from_buffered(Cursor::new(&bytes)).map_err(refuse)?;
    let layer = image.layer_data;
    let dimension = |n: usize| u32::try_from(n).map_err(|_| fail!(BadInput, "{name}: {n} pixels a side are too many"));
    let comments = layer.attributes.comments.as_ref().map(|text| String::from_utf8_lossy(text.bytes()).into_owned());
    let channels = layer.channel_data.list.iter().map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect()));
    Ok(Exr {
        width: dimension(layer.size.width())?,
        height: dimension(layer.size.height())?,
        channels: channels.collect(),
        comments: comments.unwrap_or_default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};

    const WIDTH: u32 = 37;
    const HEIGHT: u32 = 41;

    /// Depths, positions and colours that use the full mantissa.
    fn layers() -> Vec<ExrLayer> {
        let values: Vec<f32> = (0..WIDTH * HEIGHT * 4).map(|i| (i as f32 * 0.37).sin() * 3.0 + 0.1).collect();
        vec![
            ExrLayer::interleaved("", "RGBA", 4, &values, Precision::Half),
            ExrLayer::interleaved("", "Z", 4, &values, Precision::Float),
            ExrLayer::interleaved("direct", "RGB", 4, &values, Precision::Half),
            ExrLayer::interleaved("P", "XYZ", 4, &values, Precision::Float),
        ]
    }

    fn metadata() -> Vec<(&'static str, String)> {
        vec![("preset", "first-light".into()), ("scene", "café.glb".into()), ("seed", "1".into())]
    }

    #[test]
    fn what_is_written_is_read_back_under_the_layers_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        write_exr(&path, WIDTH, HEIGHT, layers(), &metadata()).unwrap();
        let read = read_exr(&path).unwrap();
        assert_eq!((read.width, read.height), (WIDTH, HEIGHT));
        let names: Vec<_> = read.channels.keys().map(String::as_str).collect();
        assert_eq!(names, ["A", "B", "G", "P.X", "P.Y", "P.Z", "R", "Z", "direct.B", "direct.G", "direct.R"]);
        for layer in layers() {
            for (channel, samples) in layer.channels {
                let name = if layer.name.is_empty() { channel } else { format!("{}.{channel}", layer.name) };
                let expected = match samples {
                    Samples::Half(values) => values.iter().map(|v| v.to_f32()).collect(),
                    Samples::Float(values) => values,
                };
                assert_eq!(read.channels[&name], expected, "{name}");
            }
        }
        assert_eq!(read.comments, "preset: first-light\nscene: café.glb\nseed: 1");
    }

    #[test]
    fn the_same_image_is_the_same_bytes() {
        let first = encode(WIDTH, HEIGHT, layers(), &metadata()).unwrap();
        for _ in 0..8 {
            assert_eq!(encode(WIDTH, HEIGHT, layers(), &metadata()).unwrap(), first);
        }
    }

    #[test]
    fn half_keeps_bright_numbers_finite_and_shows_what_is_not() {
        let Samples::Half(values) = Samples::half([1e9, -1e9, 0.5, f32::INFINITY, f32::NAN]) else { unreachable!("half makes halves") };
        assert_eq!(values[..4], [f16::MAX, f16::MIN, f16::from_f32(0.5), f16::INFINITY]);
        assert!(values[4].is_nan());
    }

    #[test]
    fn a_file_that_is_no_image_is_refused_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let good = encode(WIDTH, HEIGHT, layers(), &[]).unwrap();
        let cases: [(&str, Option<&[u8]>); 5] = [
            ("missing.exr", None),
            ("empty.exr", Some(b"")),
            ("text.exr", Some(b"this is no image at all, but it has some length")),
            ("cut.exr", Some(&good[..good.len() / 2])),
            ("header.exr", Some(&good[..40])),
        ];
        for (name, bytes) in cases {
            let path = folder.path().join(name);
            if let Some(bytes) = bytes {
                std::fs::write(&path, bytes).unwrap();
            }
            let error = read_exr(&path).unwrap_err();
            assert_eq!(exit_code(&error), Exit::BadInput);
            assert!(error.to_string().contains(name), "{error}");
        }
    }

    #[test]
    fn a_black_image_is_not_taken_for_a_lie() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("black.exr");
        let black = ExrLayer { name: String::new(), channels: vec![("R".into(), Samples::half(vec![0.0; 4096 * 1024]))] };
        write_exr(&path, 4096, 1024, vec![black], &[]).unwrap();
        assert!(read_exr(&path).unwrap().channels["R"].iter().all(|&v| v == 0.0));
    }

    #[test]
    fn a_header_that_promises_terabytes_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lie.exr");
        let mut bytes = encode(WIDTH, HEIGHT, layers(), &[]).unwrap();
        for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
            let at = bytes.windows(window.len()).position(|bytes| bytes == window).unwrap() + window.len() + 4;
            bytes[at + 8..at + 12].copy_from_slice(&1_000_000_i32.to_le_bytes());
            bytes[at + 12..at + 16].copy_from_slice(&1_000_000_i32.to_le_bytes());
        }
        std::fs::write(&path, bytes).unwrap();
        let error = read_exr(&path).unwrap_err();
        assert!(error.to_string().contains("lie.exr: is damaged or too large (1000001 x 1000001 pixels"), "{error}");
    }

    #[test]
    fn a_flipped_bit_anywhere_ends_in_an_image_or_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flipped.exr");
        let good = encode(8, 8, vec![ExrLayer::interleaved("", "R", 1, &[0.5; 64], Precision::Half)], &[("a", "b".into())]).unwrap();
        let mut refused = 0;
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 0x11;
            std::fs::write(&path, bytes).unwrap();
            refused += usize::from(read_exr(&path).is_err());
        }
        assert!(refused > 0 && refused < good.len(), "{refused} of {} refused", good.len());
    }

    #[test]
    fn an_image_that_cannot_be_written_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("file"), "").unwrap();
        let error = write_exr(&folder.path().join("file/image.exr"), WIDTH, HEIGHT, layers(), &[]).unwrap_err();
        assert_eq!(exit_code(&error), Exit::OutputNotWritten);
    }
}
