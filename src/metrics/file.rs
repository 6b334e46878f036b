//! Images from files.

use super::{Content, Image};
use crate::color::srgb_to_linear;
use crate::config::nearest;
use crate::fail;
use crate::output::{read_exr, read_png};
use anyhow::{Context, Result};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The layers of an EXR, or a PNG as the one layer `RGB`.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageFile {
    name: String,
    width: usize,
    /// Content of the colour layers.
    colors: Content,
    /// Channels by full name (`R`, `direct.R`).
    channels: BTreeMap<String, Vec<f32>>,
}

impl ImageFile {
    /// Reads an EXR or a PNG, told apart by the first bytes. A PNG is taken as sRGB and made linear.
    ///
    /// # Errors
    /// `BadInput` with the path and the fault of the file.
    pub fn open(path: &Path) -> Result<Self> {
        let name = path.display().to_string();
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| file.take(4).read_to_end(&mut start));
        read.map_err(|error| fail!(BadInput, "{name}: cannot be read ({error})"))?;
        match start.as_slice() {
            b"\x76\x2f\x31\x01" => {
                let exr = read_exr(path)?;
                let pixels = exr.width as usize * exr.height as usize;
                // EXR allows a channel stored only for every other pixel, and an empty image.
                if let Some((channel, _)) = exr.channels.iter().find(|(_, values)| values.is_empty() || values.len() != pixels) {
                    return Err(fail!(BadInput, "{name}: channel {channel} does not have one number for every pixel"));
                }
                Ok(Self { name, width: exr.width as usize, colors: Content::Radiance, channels: exr.channels })
            }
            b"\x89PNG" => {
                let png = read_png(path)?;
                let channel = |at: usize| png.values.par_iter().skip(at).step_by(3).map(|&value| srgb_to_linear(value)).collect();
                let channels = ["R", "G", "B"].iter().enumerate().map(|(at, name)| ((*name).to_owned(), channel(at)));
                Ok(Self { name, width: png.width as usize, colors: Content::Shown, channels: channels.collect() })
            }
            _ => Err(fail!(BadInput, "{name}: is neither an OpenEXR nor a PNG image")),
        }
    }

    /// Names for [`Self::layer`]: `RGB` for the colours without a name, the name of a layer of three channels, or that of a
    /// single channel.
    pub fn layers(&self) -> BTreeSet<String> {
        let layer_of = |channel: &String| {
            let (layer, own) = channel.rsplit_once('.').unwrap_or(("", channel));
            let letters = ["RGB", "XYZ"].into_iter().find(|letters| own.len() == 1 && letters.contains(own) && self.has(layer, letters));
            match letters {
                Some(letters) if layer.is_empty() => letters.to_owned(),
                Some(_) => layer.to_owned(),
                None => channel.clone(),
            }
        };
        self.channels.keys().map(layer_of).collect()
    }

    /// A layer by its name, or the sum of several.
    ///
    /// # Errors
    /// `BadInput` with the path: for a missing layer with the layers of the file, for layers that cannot be added, and for a
    /// number that is not finite.
    pub fn layer(&self, names: &[String]) -> Result<Image> {
        let found = names.iter().map(|name| self.find(name)).collect::<Result<Vec<Channels>>>()?;
        let [first, others @ ..] = found.as_slice() else { unreachable!("a layer has a name") };
        for (name, other) in names[1..].iter().zip(others) {
            if (other.content, &other.letters) != (first.content, &first.letters) {
                let (a, b) = (first.letters.concat(), other.letters.concat());
                return Err(fail!(BadInput, "{}: layers {} ({a}) and {name} ({b}) cannot be added", self.name, names[0]));
            }
        }
        let (stride, pixels) = (first.letters.len(), first.planes[0].len());
        let mut values = vec![0.0; pixels * stride];
        values.par_chunks_exact_mut(stride).enumerate().for_each(|(pixel, values)| {
            for (channel, value) in values.iter_mut().enumerate() {
                *value = found.iter().map(|layer| layer.planes[channel][pixel]).sum();
            }
        });
        Image::new(self.width, first.content, &first.letters, values).with_context(|| format!("{}: layer {}", self.name, names.join("+")))
    }

    fn has(&self, layer: &str, letters: &str) -> bool {
        letters.chars().all(|letter| self.channels.contains_key(&full_name(layer, letter)))
    }

    fn find(&self, name: &str) -> Result<Channels<'_>> {
        for (letters, content) in [("RGB", self.colors), ("XYZ", Content::Data)] {
            let layer = if name == letters { "" } else { name };
            if self.has(layer, letters) {
                let planes = letters.chars().map(|letter| self.channels[&full_name(layer, letter)].as_slice()).collect();
                return Ok(Channels { content, letters: letters.split("").filter(|letter| !letter.is_empty()).collect(), planes });
            }
        }
        if let Some((name, plane)) = self.channels.get_key_value(name) {
            return Ok(Channels { content: Content::Data, letters: vec![name.rsplit('.').next().unwrap_or(name)], planes: vec![plane] });
        }
        let layers = self.layers();
        let names: Vec<&str> = layers.iter().map(String::as_str).collect();
        let hint = match nearest(name, &names) {
            Some(near) => format!("did you mean {near}? There are {}", names.join(", ")),
            None => format!("there are {}", names.join(", ")),
        };
        Err(fail!(BadInput, "{}: has no layer {name}; {hint}", self.name))
    }
}

/// Channels of a layer, in the order of their letters.
struct Channels<'f> {
    content: Content,
    letters: Vec<&'f str>,
    planes: Vec<&'f [f32]>,
}

fn full_name(layer: &str, letter: char) -> String {
    if layer.is_empty() { letter.to_string() } else { format!("{layer}.{letter}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};
    use crate::output::exr::Precision;
    use crate::output::{ExrLayer, write_exr, write_png};
    use std::path::PathBuf;

    const PIXELS: usize = 6;

    fn layer(name: &str, letters: &str, first: f32) -> ExrLayer {
        let values: Vec<f32> = (0..PIXELS * letters.len()).map(|i| first + i as f32).collect();
        ExrLayer::interleaved(name, letters, letters.len(), &values, Precision::Float)
    }

    fn write(folder: &tempfile::TempDir, layers: Vec<ExrLayer>) -> PathBuf {
        let path = folder.path().join("image.exr");
        write_exr(&path, 3, 2, layers, &[]).unwrap();
        path
    }

    fn sample(folder: &tempfile::TempDir) -> ImageFile {
        let layers = [
            ("", "RGBA", 0.0),
            ("", "Z", 0.5),
            ("direct", "RGB", 100.0),
            ("indirect.bounce1", "RGB", 1000.0),
            ("N", "XYZ", 5.0),
            ("mask", "Y", 7.0),
        ];
        ImageFile::open(&write(folder, layers.map(|(name, letters, first)| layer(name, letters, first)).into())).unwrap()
    }

    fn names(sum: &str) -> Vec<String> {
        sum.split('+').map(str::to_owned).collect()
    }

    #[test]
    fn layers_go_by_their_names_and_single_channels_by_theirs() {
        let folder = tempfile::tempdir().unwrap();
        let file = sample(&folder);
        let layers: Vec<String> = file.layers().into_iter().collect();
        assert_eq!(layers, ["A", "N", "RGB", "Z", "direct", "indirect.bounce1", "mask.Y"]);
        let cases = [
            ("RGB", Content::Radiance, 3, [0.0, 1.0, 2.0, 4.0]),
            ("direct", Content::Radiance, 3, [100.0, 101.0, 102.0, 103.0]),
            ("N", Content::Data, 3, [5.0, 6.0, 7.0, 8.0]),
            ("Z", Content::Data, 1, [0.5, 1.5, 2.5, 3.5]),
            ("mask.Y", Content::Data, 1, [7.0, 8.0, 9.0, 10.0]),
            ("direct.G", Content::Data, 1, [101.0, 104.0, 107.0, 110.0]),
            ("direct+indirect.bounce1", Content::Radiance, 3, [1100.0, 1102.0, 1104.0, 1106.0]),
            ("Z+Z+Z", Content::Data, 1, [1.5, 4.5, 7.5, 10.5]),
        ];
        for (name, content, channels, start) in cases {
            let image = file.layer(&names(name)).unwrap();
            assert_eq!((image.content(), image.channels(), image.size()), (content, channels, [3, 2]), "{name}");
            assert_eq!(image.values()[..4], start, "{name}");
        }
    }

    #[test]
    fn a_missing_layer_is_refused_with_those_that_there_are() {
        let folder = tempfile::tempdir().unwrap();
        let file = sample(&folder);
        let cases = [
            ("diretc", "image.exr: has no layer diretc; did you mean direct? There are A, N, RGB, Z, direct, indirect.bounce1, mask.Y"),
            ("direct+irradiance", "image.exr: has no layer irradiance; there are A, N, RGB, Z, direct, indirect.bounce1, mask.Y"),
            ("direct+N", "image.exr: layers direct (RGB) and N (XYZ) cannot be added"),
            ("Z+direct", "image.exr: layers Z (Z) and direct (RGB) cannot be added"),
        ];
        for (name, says) in cases {
            let error = file.layer(&names(name)).unwrap_err();
            assert!(error.to_string().ends_with(says), "{error}");
            assert_eq!(exit_code(&error), Exit::BadInput);
        }
    }

    #[test]
    fn a_number_that_is_none_is_named_with_its_file_and_layer() {
        let folder = tempfile::tempdir().unwrap();
        let mut values = vec![1.0; PIXELS * 3];
        values[4 * 3 + 2] = f32::NAN;
        let layer = ExrLayer::interleaved("direct", "RGB", 3, &values, Precision::Half);
        let file = ImageFile::open(&write(&folder, vec![layer])).unwrap();
        let error = format!("{:#}", file.layer(&names("direct")).unwrap_err());
        assert!(error.ends_with("image.exr: layer direct: channel B is not a number at pixel (1, 1)"), "{error}");
        // A sum that overflows is not finite either.
        let far = ExrLayer::interleaved("far", "Z", 1, &[f32::MAX; PIXELS], Precision::Float);
        let error = format!("{:#}", ImageFile::open(&write(&folder, vec![far])).unwrap().layer(&names("far.Z+far.Z")).unwrap_err());
        assert!(error.ends_with("image.exr: layer far.Z+far.Z: channel Z is infinite at pixel (0, 0)"), "{error}");
    }

    #[test]
    fn a_png_is_made_linear_whatever_its_name_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        write_png(&path, 1, 2, &[0, 128, 255, 255, 0, 10]).unwrap();
        let image = ImageFile::open(&path).unwrap().layer(&names("RGB")).unwrap();
        assert_eq!((image.content(), image.size()), (Content::Shown, [1, 2]));
        let expected = [0.0, srgb_to_linear(128.0 / 255.0), 1.0, 1.0, 0.0, srgb_to_linear(10.0 / 255.0)];
        assert_eq!(image.values(), expected);
        let error = ImageFile::open(&path).unwrap().layer(&names("direct")).unwrap_err();
        assert!(error.to_string().ends_with("has no layer direct; there are RGB"), "{error}");
    }

    #[test]
    fn what_is_no_image_is_refused_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        for (bytes, says) in [
            (None, "cannot be read"),
            (Some(&b""[..]), "is neither an OpenEXR nor a PNG image"),
            (Some(b"some text"), "is neither an OpenEXR nor a PNG image"),
            (Some(b"\x76\x2f\x31\x01 and no more"), "is not an OpenEXR image that can be read"),
            (Some(b"\x89PNG\r\n\x1a\nand no more"), "is not a PNG image that can be read"),
        ] {
            if let Some(bytes) = bytes {
                std::fs::write(&path, bytes).unwrap();
            }
            let error = ImageFile::open(&path).unwrap_err();
            assert!(error.to_string().contains(&format!("image.exr: {says}")), "{error}");
            assert_eq!(exit_code(&error), Exit::BadInput);
        }
        assert!(ImageFile::open(folder.path()).is_err());
    }
}
