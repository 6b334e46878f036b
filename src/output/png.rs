//! PNG images: tone-mapped pictures as sRGB bytes.

use crate::fail;
use crate::files::write_file;
use anyhow::{Context, Result};
use std::io::Cursor;
use std::path::Path;

/// Writes an sRGB image of 8 bits a channel, first row on top: `width * height` pixels of one (grey), three (RGB) or four
/// (RGBA) bytes. The same arguments give the same bytes.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason; no file is left then.
pub fn write_png(path: &Path, width: u32, height: u32, pixels: &[u8]) -> Result<()> {
    write_file(path, &png_bytes(width, height, pixels)?)
}

/// The bytes of the file that [`write_png`] writes.
pub fn png_bytes(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>> {
    encode(width, height, pixels).context("an image cannot be encoded")
}

fn encode(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let count = width as usize * height as usize;
    let color = match pixels.len() {
        bytes if bytes == count => png::ColorType::Grayscale,
        bytes if bytes == 3 * count => png::ColorType::Rgb,
        bytes if bytes == 4 * count => png::ColorType::Rgba,
        _ => unreachable!("{} bytes are no grey, RGB or RGBA image of {width}x{height}", pixels.len()),
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Limit of pixels of an image to read.
const MAX_PIXELS: u64 = 16_384 * 16_384;

/// A decoded image.
#[derive(Debug, Clone, PartialEq)]
pub struct Png {
    pub width: u32,
    pub height: u32,
    /// Red, green and blue of every pixel, row by row from the top, as encoded in the file: from 0 to 1.
    pub values: Vec<f32>,
}

/// Reads an opaque image of any depth; grey becomes RGB. The file's own colour space is ignored.
///
/// # Errors
/// `BadInput` with the path and the fault of the file. A pixel that is not opaque is one: it has no definite colour.
pub fn read_png(path: &Path) -> Result<Png> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| fail!(BadInput, "{name}: cannot be read ({error})"))?;
    let refuse = |error: png::DecodingError| fail!(BadInput, "{name}: is not a PNG image that can be read ({error})");
    let mut decoder = png::Decoder::new(Cursor::new(&bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(refuse)?;
    let (width, height) = reader.info().size();
    let size = reader.output_buffer_size().filter(|_| u64::from(width) * u64::from(height) <= MAX_PIXELS);
    let size = size.ok_or_else(|| fail!(BadInput, "{name}: is too large ({width} x {height} pixels)"))?;
    let mut decoded = vec![0; size];
    let info = reader.next_frame(&mut decoded).map_err(refuse)?;
    let bytes_each = if info.bit_depth == png::BitDepth::Sixteen { 2 } else { 1 };
    let (stride, color) = match info.color_type {
        png::ColorType::Grayscale => (1, [0; 3]),
        png::ColorType::GrayscaleAlpha => (2, [0; 3]),
        png::ColorType::Rgb => (3, [0, 1, 2]),
        png::ColorType::Rgba => (4, [0, 1, 2]),
        png::ColorType::Indexed => unreachable!("{name}: the decoder expands palettes"),
    };
    let pixels = decoded[..info.buffer_size()].chunks_exact(stride * bytes_each);
    let opaque = |pixel: &[u8]| stride % 2 == 1 || pixel[(stride - 1) * bytes_each..].iter().all(|&byte| byte == u8::MAX);
    if let Some(at) = pixels.clone().position(|pixel| !opaque(pixel)) {
        let (x, y) = (at % width as usize, at / width as usize);
        return Err(fail!(BadInput, "{name}: the pixel ({x}, {y}) is not opaque, so that its colour is unknown"));
    }
    let value = |pixel: &[u8], channel: usize| match pixel[channel * bytes_each..][..bytes_each] {
        [high, low] => f32::from(u16::from_be_bytes([high, low])) / 65_535.0,
        [byte, ..] => f32::from(byte) / 255.0,
        [] => unreachable!("a channel has a byte"),
    };
    let mut values = Vec::with_capacity(width as usize * height as usize * 3);
    values.extend(pixels.flat_map(|pixel| color.map(|channel| value(pixel, channel))));
    Ok(Png { width, height, values })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};

    #[test]
    fn grey_rgb_and_rgba_come_back_as_they_went() {
        let folder = tempfile::tempdir().unwrap();
        for (channels, color) in [(1, png::ColorType::Grayscale), (3, png::ColorType::Rgb), (4, png::ColorType::Rgba)] {
            let pixels: Vec<u8> = (0..13 * 7 * channels).map(|i| (i * 37 % 251) as u8).collect();
            let path = folder.path().join("image.png");
            write_png(&path, 13, 7, &pixels).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
            let mut read = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut read).unwrap();
            assert_eq!((info.width, info.height, info.color_type), (13, 7, color));
            assert_eq!(read, pixels);
            assert_eq!(encode(13, 7, &pixels).unwrap(), bytes);
        }
    }

    /// Writes a row of two pixels; the palette is grey.
    fn write_as(path: &Path, color: png::ColorType, depth: png::BitDepth, data: &[u8]) {
        let mut encoder = png::Encoder::new(std::fs::File::create(path).unwrap(), 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == png::ColorType::Indexed {
            encoder.set_palette(&[51, 51, 51, 255, 255, 255][..]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
    }

    #[test]
    fn every_kind_of_opaque_image_is_read_as_the_same_colours() {
        use png::{BitDepth, ColorType};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let gray = [0.2, 0.2, 0.2, 1.0, 1.0, 1.0];
        let cases: [(ColorType, BitDepth, &[u8]); 7] = [
            (ColorType::Grayscale, BitDepth::Eight, &[51, 255]),
            (ColorType::GrayscaleAlpha, BitDepth::Eight, &[51, 255, 255, 255]),
            (ColorType::Rgb, BitDepth::Eight, &[51, 51, 51, 255, 255, 255]),
            (ColorType::Rgba, BitDepth::Eight, &[51, 51, 51, 255, 255, 255, 255, 255]),
            (ColorType::Grayscale, BitDepth::Sixteen, &[0x33, 0x33, 255, 255]),
            (ColorType::Grayscale, BitDepth::Four, &[0x3f]),
            (ColorType::Indexed, BitDepth::One, &[0b0100_0000]),
        ];
        for (color, depth, data) in cases {
            write_as(&path, color, depth, data);
            assert_eq!(read_png(&path).unwrap(), Png { width: 2, height: 1, values: gray.to_vec() }, "{color:?} {depth:?}");
        }
        write_as(&path, ColorType::Rgb, BitDepth::Sixteen, &[0, 0, 128, 0, 255, 255, 0, 1, 0, 2, 0, 3]);
        let expected = [0, 0x8000, 0xffff, 1, 2, 3].map(|value: u16| f32::from(value) / 65_535.0);
        assert_eq!(read_png(&path).unwrap().values, expected);
    }

    #[test]
    fn what_is_no_opaque_image_is_refused_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        let refused = || {
            let error = read_png(&path).unwrap_err();
            assert_eq!(exit_code(&error), Exit::BadInput);
            let message = error.to_string();
            assert!(message.contains("image.png: "), "{message}");
            message
        };
        assert!(refused().contains("cannot be read"));
        let good = encode(13, 7, &[100; 13 * 7 * 3]).unwrap();
        for bytes in [&b""[..], b"no image", &good[..40], &good[..good.len() / 2]] {
            std::fs::write(&path, bytes).unwrap();
            assert!(refused().contains("is not a PNG image that can be read"));
        }
        write_png(&path, 2, 1, &[1, 2, 3, 255, 1, 2, 3, 254]).unwrap();
        assert!(refused().ends_with("the pixel (1, 0) is not opaque, so that its colour is unknown"));
    }
}
