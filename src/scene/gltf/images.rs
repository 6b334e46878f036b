//! Images: lookup, limits, and parallel decoding.

use super::textures::ImageUse;
use super::{File, buffers, label, refuse};
use crate::scene::{Scene, Texture};
use anyhow::{Context, Result};
use gltf_json::Image;
use image::codecs::{jpeg::JpegDecoder, png::PngDecoder};
use image::{DynamicImage, ImageDecoder};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Cursor;
use std::sync::atomic::{AtomicU64, Ordering};

/// Limit of texels a side, the largest that common devices support.
const MAX_SIDE: u32 = 16_384;
/// Limit of a scene's decoded images together (4 GiB).
const MAX_BYTES: u64 = 4 << 30;
/// Limit of one image's file (1 GiB).
const MAX_ENCODED: u64 = 1 << 30;
/// Most decoded bytes per byte of a PNG (1032 by its compression, 8 by its one-bit texels) or of a JPEG.
const MAX_RATIO: u64 = 8 * 1032;

/// Decodes all images and appends them to the scene's textures, in order.
pub fn decode(file: &File<'_>, uses: &[ImageUse], scene: &mut Scene) -> Result<()> {
    // An image used both as colour and as data is decoded once and copied.
    let mut decoder_of = HashMap::new();
    for (position, wanted) in uses.iter().enumerate() {
        decoder_of.entry(wanted.image.value()).or_insert(position);
    }
    let decoded = AtomicU64::new(0);
    let textures = uses.par_iter().enumerate().map(|(position, wanted)| {
        if decoder_of[&wanted.image.value()] != position {
            return Ok(None);
        }
        let image = file.get(wanted.image, "image")?;
        let name = label("image", wanted.image.value(), image.name.as_ref().or(image.uri.as_ref().filter(|uri| !uri.starts_with("data:"))));
        let (width, height, texels) = texels(file, image, &decoded).with_context(|| name.clone())?;
        Ok(Some(Texture { name: image.name.clone().unwrap_or(name), width, height, srgb: wanted.srgb, texels }))
    });
    let textures: Vec<Option<Texture>> = textures.collect::<Result<_>>()?;
    let first = scene.textures.len();
    for (texture, wanted) in textures.into_iter().zip(uses) {
        let texture =
            texture.unwrap_or_else(|| Texture { srgb: wanted.srgb, ..scene.textures[first + decoder_of[&wanted.image.value()]].clone() });
        scene.add_texture(texture);
    }
    Ok(())
}

/// An image's width, height and RGBA texels. `decoded` sums the bytes of all images.
fn texels(file: &File<'_>, image: &Image, decoded: &AtomicU64) -> Result<(u32, u32, Vec<u8>)> {
    let encoded = encoded(file, image)?;
    if encoded.starts_with(b"\x89PNG\r\n\x1a\n") {
        finish(PngDecoder::new(Cursor::new(&*encoded)), encoded.len(), decoded)
    } else if encoded.starts_with(b"\xff\xd8") {
        finish(JpegDecoder::new(Cursor::new(&*encoded)), encoded.len(), decoded)
    } else {
        refuse!("it is neither a PNG nor a JPEG")
    }
}

fn finish(decoder: image::ImageResult<impl ImageDecoder>, encoded: usize, decoded: &AtomicU64) -> Result<(u32, u32, Vec<u8>)> {
    let decoder = match decoder {
        Ok(decoder) => decoder,
        Err(error) => refuse!("it does not decode: {}", one_line(&error)),
    };
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        refuse!("it has {width} x {height} texels, from 1 to {MAX_SIDE} a side are supported");
    }
    let bytes = u64::from(width) * u64::from(height) * 4;
    if decoder.total_bytes() / MAX_RATIO > encoded as u64 {
        refuse!("it says {width} x {height} texels, which cannot come out of its {encoded} bytes");
    }
    if decoded.fetch_add(bytes, Ordering::Relaxed) + bytes > MAX_BYTES {
        refuse!("with it, the images decode to more than the {MAX_BYTES} bytes that are supported");
    }
    match DynamicImage::from_decoder(decoder) {
        Ok(image) => Ok((width, height, image.into_rgba8().into_raw())),
        Err(error) => refuse!("it does not decode: {}", one_line(&error)),
    }
}

/// A decoder's message without line breaks.
fn one_line(error: &image::ImageError) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The encoded bytes of a PNG or JPEG.
fn encoded<'a>(file: &'a File<'_>, image: &Image) -> Result<Cow<'a, [u8]>> {
    match (image.buffer_view, &image.uri) {
        (Some(view), _) => Ok(Cow::Borrowed(file.view(view)?.bytes)),
        (None, Some(uri)) => Ok(Cow::Owned(buffers::fetch(uri, file.base, MAX_ENCODED)?)),
        (None, None) => refuse!("it has neither a bufferView nor a uri"),
    }
}
