//! PNG images: what is shown, after tone mapping, as sRGB bytes.

use super::file::write_file;
use anyhow::{Context, Result};
use std::path::Path;

/// Writes an sRGB image of 8 bits a channel, first row on top: `width * height` pixels of one (grey), three (RGB) or four (RGBA)
/// bytes.
/// The same arguments give the same bytes.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason; no file is left then.
pub fn write_png(path: &Path, width: u32, height: u32, pixels: &[u8]) -> Result<()> {
    write_file(path, &encode(width, height, pixels).context("an image cannot be encoded")?)
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

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
}
