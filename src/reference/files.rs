//! Files of the path tracer's sums, and their picture.

use super::{Sum, Sums};
use crate::color::{linear_to_srgb8, luminance};
use crate::config::{ComposeConfig, Tonemap};
use crate::fail;
use crate::output::exr::Precision;
use crate::output::{ExrLayer, read_exr, write_exr};
use anyhow::Result;
use glam::Vec3;
use std::path::Path;

/// Saves sums with their identity, bit by bit, so that a resumed run equals one without interruption.
pub fn save_sums(path: &Path, identity: &str, sums: &Sums) -> Result<()> {
    let planes = sums.texels.chunks_exact(sums.pixels());
    let layer = |(name, plane): (String, &[[f32; 4]])| ExrLayer::interleaved(&name, "RGBA", 4, plane.as_flattened(), Precision::Float);
    let layers = names(sums.bounces).into_iter().zip(planes).map(layer).collect();
    let metadata = [("identity", identity.to_owned()), ("samples", sums.samples.to_string()), ("bounces", sums.bounces.to_string())];
    write_exr(path, sums.size[0], sums.size[1], layers, &metadata)
}

/// Names of the sums' planes in the file, in order.
fn names(bounces: u32) -> Vec<String> {
    let layers: Vec<String> = Sum::all(bounces).into_iter().map(|(name, _)| name).collect();
    let rests = layers.iter().map(|name| format!("{name}.rest"));
    layers.iter().cloned().chain(rests).collect()
}

/// Loads sums that [`save_sums`] saved.
///
/// # Errors
/// `BadInput` if there is no such file, or if its identity, size or number of bounces differs.
pub fn load_sums(path: &Path, identity: &str, size: [u32; 2], bounces: u32) -> Result<Sums> {
    let name = path.display();
    if !path.exists() {
        return Err(fail!(BadInput, "--resume: {name} is not there; leave --resume out to begin anew"));
    }
    let image = read_exr(path)?;
    let comment = |key: &str| image.comments.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(": ").map(str::to_owned));
    let number = |key: &str| comment(key).and_then(|text| text.parse::<u32>().ok());
    let (Some(of), Some(samples), Some(has)) = (comment("identity"), number("samples"), number("bounces")) else {
        return Err(fail!(BadInput, "--resume: {name} was not written by `manylight reference`"));
    };
    if has != bounces {
        return Err(fail!(
            BadInput,
            "--resume: {name} has {has} bounces, not {bounces}; give --bounces {has}, or leave --resume out to begin anew"
        ));
    }
    if of != identity || [image.width, image.height] != size {
        return Err(fail!(
            BadInput,
            "--resume: {name} is of another config, scene or seed; choose its own, or leave --resume out to begin anew"
        ));
    }
    let mut sums = Sums::new(size, bounces);
    sums.samples = samples;
    let pixels = sums.pixels();
    for (i, layer) in names(bounces).into_iter().enumerate() {
        for (k, channel) in "RGBA".chars().enumerate() {
            let Some(values) = image.channels.get(&format!("{layer}.{channel}")) else {
                return Err(fail!(BadInput, "--resume: {name} lacks {layer}.{channel}; it is damaged: leave --resume out to begin anew"));
            };
            for (texel, value) in sums.texels[i * pixels..][..pixels].iter_mut().zip(values) {
                texel[k] = *value;
            }
        }
    }
    Ok(sums)
}

/// Picture of the sums as `compose/sum` makes it: exposed, tone-mapped, sRGB-encoded RGBA bytes.
pub fn develop(sums: &Sums, config: &ComposeConfig) -> Vec<u8> {
    let pixel = |texel: [f32; 4]| {
        let empty = 1.0 - texel[3].clamp(0.0, 1.0);
        let mut shown = Vec3::new(texel[0], texel[1], texel[2]) * config.exposure + empty * Vec3::from(config.background);
        if config.tonemap == Tonemap::Reinhard {
            shown /= 1.0 + luminance(&shown.to_array()) as f32;
        }
        let [r, g, b] = shown.to_array().map(|light| linear_to_srgb8(light.into()));
        [r, g, b, 255]
    };
    sums.mean(Sum::Radiance).into_iter().flat_map(pixel).collect()
}
