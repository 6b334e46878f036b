//! Maps of the sky: radiance from all directions, as a picture in latitude and longitude.
//!
//! A direction w is at u = atan2(w.x, -w.z) / 2 pi across and v = acos(w.y) / pi down, which is Mitsuba's convention for `envmap`. Texel
//! centres are at halves, radiance between them is bilinear, and rows end at the poles. `glsl/sky/radiance-map.glsl` does the same.

use crate::color::luminance;
use crate::fail;
use crate::output::read_exr;
use anyhow::Result;
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::io::Cursor;
use std::path::Path;

/// A map, with the distribution of its light.
pub struct SkyMap {
    pub size: [u32; 2],
    /// Radiance, RGB, and the share of the row's light in its texels up to and with this one, which is 1 for the last. Row by row from the
    /// top.
    pub texels: Vec<[f32; 4]>,
    /// Share of the light in the rows up to and with each: the last one is 1.
    pub rows: Vec<f32>,
    /// Hash of the texels.
    pub digest: String,
}

/// A direction that stands for a part of the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drawn {
    /// Unit vector towards the sky.
    pub direction: DVec3,
    /// Radiance over probability density, W/m^2: the mean over all draws is the integral of radiance over the sphere.
    pub irradiance: DVec3,
}

impl SkyMap {
    /// Largest width and height, which every device takes.
    pub const LARGEST: [u32; 2] = [4096, 2048];
    /// Largest radiance, as of a colour in a config.
    const BRIGHTEST: f32 = 1e9;
    /// Larger files are no maps of this size.
    const LARGEST_FILE: u64 = 1 << 28;

    /// Reads an OpenEXR or a Radiance HDR file.
    ///
    /// # Errors
    /// `BadInput` with the path and the fault of the file.
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.display();
        let unreadable = |error: std::io::Error| fail!(BadInput, "{name}: cannot be read ({error})");
        if std::fs::metadata(path).map_err(unreadable)?.len() > Self::LARGEST_FILE {
            return Err(fail!(BadInput, "{name}: is over {} MB, which no map of the sky is; scale it down", Self::LARGEST_FILE >> 20));
        }
        let bytes = std::fs::read(path).map_err(unreadable)?;
        let (size, colors) = match bytes.as_slice() {
            [0x76, 0x2f, 0x31, 0x01, ..] => exr(path)?,
            [b'#', b'?', ..] => hdr(path, &bytes)?,
            _ => return Err(fail!(BadInput, "{name}: is neither an OpenEXR nor a Radiance HDR picture")),
        };
        let sound = |color: &[f32; 3]| color.iter().all(|value| *value <= Self::BRIGHTEST);
        if let Some(texel) = colors.iter().position(|color| !sound(color)) {
            let (x, y) = (texel % size[0] as usize, texel / size[0] as usize);
            return Err(fail!(BadInput, "{name}: the texel at {x}, {y} is no radiance from 0 to 1e9; repair the picture"));
        }
        // Resampling leaves small negative numbers beside bright lamps.
        Ok(Self::new(size, colors.into_iter().map(|color| color.map(|value| value.max(0.0))).collect()))
    }

    /// A map of `size[0] * size[1]` colours, row by row from the top; finite, and none below 0.
    ///
    /// # Panics
    /// If there are more or fewer colours.
    pub fn new(size: [u32; 2], colors: Vec<[f32; 3]>) -> Self {
        let [width, height] = size.map(|n| n as usize);
        assert!(width > 0 && colors.len() == width * height, "{} colours are no picture of {width}x{height}", colors.len());
        let digest = blake3::Hasher::new().update(bytemuck::cast_slice(&size)).update(bytemuck::cast_slice(&colors)).finalize();
        let texels = colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect();
        let mut map = Self { size, texels, rows: Vec::new(), digest: digest.to_hex().to_string() };
        let mut rows = Vec::with_capacity(height);
        for y in 0..height {
            let lights: Vec<f64> = (0..width).map(|x| luminance(&map.mean(x, y).as_vec3().to_array())).collect();
            let (shares, total) = running_shares(&lights);
            rows.push(total * map.solid_angle(y));
            map.texels[y * width..].iter_mut().zip(shares).for_each(|(texel, share)| texel[3] = share);
        }
        map.rows = running_shares(&rows).0;
        map
    }

    /// Radiance from the direction `w`.
    pub fn radiance(&self, w: Vec3) -> Vec3 {
        let w = w.as_dvec3().normalize();
        let across = if w.x == 0.0 && w.z == 0.0 { 0.0 } else { w.x.atan2(-w.z) / TAU };
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        let at = DVec2::new(across.rem_euclid(1.0), w.y.clamp(-1.0, 1.0).acos() / PI) * size - 0.5;
        let (low, part) = (at.floor(), at - at.floor());
        let texel = |dx: f64, dy: f64| self.texel(low.x as i64 + dx as i64, low.y as i64 + dy as i64);
        let row = |dy| texel(0.0, dy).lerp(texel(1.0, dy), part.x);
        row(0.0).lerp(row(1.0), part.y).as_vec3()
    }

    /// Draws a direction by luminance, from two numbers in [0, 1). Within a texel directions are uniform.
    pub fn draw(&self, u: DVec2) -> Drawn {
        let [width, height] = self.size.map(|n| n as usize);
        let row = |y| &self.texels[y * width..(y + 1) * width];
        let (y, v, of_rows) = found(&self.rows, |share| *share, u.y);
        let (x, u, of_row) = found(row(y), |texel| texel[3], u.x);
        let across = TAU * (x as f64 + u) / width as f64;
        let (top, bottom) = edges(y, height);
        let cosine = top + (bottom - top) * v;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let direction = DVec3::new(across.sin() * sine, cosine, -across.cos() * sine);
        Drawn { direction, irradiance: self.mean(x, y) * (self.solid_angle(y) / (of_rows * of_row).max(1e-30)) }
    }

    /// Mean radiance of a texel: the integral of bilinear radiance over it.
    fn mean(&self, x: usize, y: usize) -> DVec3 {
        let (x, y) = (x as i64, y as i64);
        let row = |y| (self.texel(x - 1, y) + 6.0 * self.texel(x, y) + self.texel(x + 1, y)) / 8.0;
        (row(y - 1) + 6.0 * row(y) + row(y + 1)) / 8.0
    }

    fn texel(&self, x: i64, y: i64) -> DVec3 {
        let [width, height] = self.size.map(i64::from);
        let [r, g, b, _] = self.texels[(y.clamp(0, height - 1) * width + x.rem_euclid(width)) as usize];
        Vec3::new(r, g, b).as_dvec3()
    }

    /// Solid angle of a texel of a row, sr.
    fn solid_angle(&self, y: usize) -> f64 {
        let (top, bottom) = edges(y, self.size[1] as usize);
        TAU / f64::from(self.size[0]) * (top - bottom)
    }
}

/// Cosines to +Y of a row's edges.
fn edges(y: usize, height: usize) -> (f64, f64) {
    let cosine = |edge: usize| (PI * edge as f64 / height as f64).cos();
    (cosine(y), cosine(y + 1))
}

/// Running sums of weights over their total, with the total. Equal shares where all weights are 0.
fn running_shares(weights: &[f64]) -> (Vec<f32>, f64) {
    let total: f64 = weights.iter().sum();
    let (equal, over) = if total > 0.0 { (0.0, 1.0 / total) } else { (1.0, 1.0 / weights.len() as f64) };
    let mut sum = 0.0;
    let running = weights.iter().map(|weight| {
        sum += (weight + equal) * over;
        sum.min(1.0) as f32
    });
    let mut shares: Vec<f32> = running.collect();
    // Rounding must leave no room above the last that has any.
    let last = shares.last().copied().unwrap_or(1.0);
    shares.iter_mut().rev().take_while(|share| **share == last).for_each(|share| *share = 1.0);
    (shares, total)
}

/// Element of running sums that a number in [0, 1) falls into, the number's place within in [0, 1], and the element's share.
fn found<T>(elements: &[T], sum: impl Fn(&T) -> f32, u: f64) -> (usize, f64, f64) {
    let i = elements.partition_point(|element| f64::from(sum(element)) <= u).min(elements.len() - 1);
    let before = if i > 0 { f64::from(sum(&elements[i - 1])) } else { 0.0 };
    let share = f64::from(sum(&elements[i])) - before;
    (i, ((u - before) / share.max(1e-30)).clamp(0.0, 1.0), share)
}

fn in_range(name: &str, width: u64, height: u64) -> Result<[u32; 2]> {
    let [most_across, most_down] = SkyMap::LARGEST;
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width @ 1..), Ok(height @ 1..)) if width <= most_across && height <= most_down => Ok([width, height]),
        _ => Err(fail!(BadInput, "{name}: has {width}x{height} texels, over the {most_across}x{most_down} of a map; scale it down")),
    }
}

fn exr(path: &Path) -> Result<([u32; 2], Vec<[f32; 3]>)> {
    let name = path.display().to_string();
    let mut image = read_exr(path)?;
    let size = in_range(&name, image.width.into(), image.height.into())?;
    let mut channel = |wanted: &str| image.channels.remove(wanted);
    let (Some(red), Some(green), Some(blue)) = (channel("R"), channel("G"), channel("B")) else {
        return Err(fail!(BadInput, "{name}: lacks a channel R, G or B"));
    };
    Ok((size, red.into_iter().zip(green).zip(blue).map(|((r, g), b)| [r, g, b]).collect()))
}

fn hdr(path: &Path, bytes: &[u8]) -> Result<([u32; 2], Vec<[f32; 3]>)> {
    let name = path.display().to_string();
    let refuse = |error: image::ImageError| {
        let error = error.to_string().replace(['\n', '\r'], " ");
        fail!(BadInput, "{name}: is not a Radiance HDR picture that can be read ({error})")
    };
    // Not strictly: many programs begin the file with "#?RGBE".
    let decoder = image::codecs::hdr::HdrDecoder::with_strictness(Cursor::new(bytes), false).map_err(refuse)?;
    let header = decoder.metadata();
    let size = in_range(&name, header.width.into(), header.height.into())?;
    let image = image::DynamicImage::from_decoder(decoder).map_err(refuse)?.into_rgb32f();
    Ok((size, image.pixels().map(|pixel| pixel.0).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};
    use crate::output::exr::Precision;
    use crate::output::{ExrLayer, write_exr};

    /// A map with a gradient, a lamp of one texel, and a black row.
    fn uneven() -> SkyMap {
        let color = |x: usize, y: usize| match (x, y) {
            (5, 2) => [60.0, 30.0, 10.0],
            (_, 6) => [0.0; 3],
            _ => [0.1 * x as f32, 0.05 * y as f32, 1.0],
        };
        SkyMap::new([16, 8], (0..8).flat_map(|y| (0..16).map(move |x| color(x, y))).collect())
    }

    #[test]
    fn directions_are_where_they_should_be_and_texels_join_at_the_seam() {
        // A quarter of the map each: -Z at the edge, then +X, +Z in the middle, -X.
        let map = SkyMap::new([4, 1], vec![[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
        let from = |x: f32, z: f32| map.radiance(Vec3::new(x, 0.3, z)).x;
        for (found, expected) in [(from(1.0, 0.0), 1.5), (from(0.0, 1.0), 2.5), (from(-1.0, 0.0), 3.5), (from(0.0, -1.0), 2.5)] {
            assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
        }
        let map = SkyMap::new([1, 2], vec![[1.0; 3], [3.0; 3]]);
        assert_eq!([Vec3::Y, Vec3::NEG_Y, Vec3::X].map(|w| map.radiance(w).x), [1.0, 3.0, 2.0]);
    }

    /// The integral by a fine grid of the sphere, against the mean of draws.
    #[test]
    fn draws_integrate_the_map_and_all_have_its_luminance() {
        let map = uneven();
        let n = 512;
        let grid = (0..n).flat_map(|i| (0..2 * n).map(move |k| (i, k))).map(|(i, k)| {
            let (theta, phi) = (PI * (i as f64 + 0.5) / n as f64, PI * (k as f64 + 0.5) / n as f64);
            let w = DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin());
            map.radiance(w.as_vec3()).as_dvec3() * theta.sin() * (PI / n as f64).powi(2)
        });
        let exact: DVec3 = grid.sum();
        let drawn: Vec<Drawn> = (0..4096).map(|i| map.draw(DVec2::new(f64::from(i % 64) + 0.5, f64::from(i / 64) + 0.5) / 64.0)).collect();
        let mean = drawn.iter().map(|d| d.irradiance).sum::<DVec3>() / drawn.len() as f64;
        println!("{mean} by draws, {exact} by a grid");
        assert!(((mean - exact) / exact).abs().max_element() < 0.02, "{mean} instead of {exact}");
        let lum = |d: &Drawn| luminance(&d.irradiance.as_vec3().to_array());
        let first = lum(&drawn[0]);
        assert!(drawn.iter().all(|d| (lum(d) / first - 1.0).abs() < 1e-3), "draws by luminance have the same luminance");
        assert!(drawn.iter().all(|d| d.direction.is_normalized()));
    }

    #[test]
    fn a_black_map_gives_black_directions() {
        let map = SkyMap::new([3, 2], vec![[0.0; 3]; 6]);
        for u in [0.0, 0.4, 0.999_999] {
            let drawn = map.draw(DVec2::splat(u));
            assert!(drawn.irradiance == DVec3::ZERO && drawn.direction.is_normalized(), "{drawn:?}");
        }
    }

    #[test]
    fn both_formats_are_read_and_negative_numbers_are_black() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        let colors = [0.5, 1.0, -0.25, 2.0, 4.0, 8.0];
        write_exr(&path, 2, 1, vec![ExrLayer::interleaved("", "RGB", 3, &colors, Precision::Float)], &[]).unwrap();
        let map = SkyMap::read(&path).unwrap();
        let colors: Vec<[f32; 3]> = map.texels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
        assert_eq!((map.size, &colors[..]), ([2, 1], &[[0.5, 1.0, 0.0], [2.0, 4.0, 8.0]][..]));
        for signature in ["RADIANCE", "RGBE"] {
            let path = folder.path().join("sky.hdr");
            let header = format!("#?{signature}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
            std::fs::write(&path, [header.as_bytes(), b"\x80\x40\x20\x81\x80\x80\x80\x82"].concat()).unwrap();
            let map = SkyMap::read(&path).unwrap();
            assert_eq!(map.size, [2, 1]);
            let colors = map.texels.iter().flat_map(|texel| &texel[..3]);
            for (found, expected) in colors.zip([1.0, 0.5, 0.25, 2.0, 2.0, 2.0]) {
                assert!((found - expected).abs() < 0.02, "{signature}: {:?}", map.texels);
            }
        }
    }

    #[test]
    fn hostile_files_end_in_one_sentence_with_their_name() {
        let folder = tempfile::tempdir().unwrap();
        let exr = |name: &str, size: [u32; 2], channels: &str, value: f32| {
            let values = vec![value; (size[0] * size[1]) as usize * channels.len()];
            let layer = ExrLayer::interleaved("", channels, channels.len(), &values, Precision::Float);
            write_exr(&folder.path().join(name), size[0], size[1], vec![layer], &[]).unwrap();
        };
        exr("nan.exr", [2, 2], "RGB", f32::NAN);
        exr("infinite.exr", [2, 2], "RGB", f32::INFINITY);
        exr("bright.exr", [2, 2], "RGB", 2e9);
        exr("grey.exr", [2, 2], "Y", 1.0);
        exr("wide.exr", [4097, 1], "RGB", 1.0);
        exr("good.exr", [64, 32], "RGB", 1.0);
        let good = std::fs::read(folder.path().join("good.exr")).unwrap();
        let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
        write("cut.exr", &good[..good.len() / 2]);
        write("empty.exr", b"");
        write("text.hdr", b"no picture at all");
        write("cut.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n\x02\x02\x00\x40");
        write("huge.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n");
        let cases = [
            ("nan.exr", "the texel at 0, 0 is no radiance from 0 to 1e9"),
            ("infinite.exr", "the texel at 0, 0 is no radiance from 0 to 1e9"),
            ("bright.exr", "the texel at 0, 0 is no radiance from 0 to 1e9"),
            ("grey.exr", "lacks a channel R, G or B"),
            ("wide.exr", "has 4097x1 texels, over the 4096x2048 of a map"),
            ("cut.exr", "cannot be read"),
            ("empty.exr", "is neither an OpenEXR nor a Radiance HDR picture"),
            ("text.hdr", "is neither an OpenEXR nor a Radiance HDR picture"),
            ("cut.hdr", "is not a Radiance HDR picture that can be read"),
            ("huge.hdr", "has 2000000000x2000000000 texels"),
            ("missing.hdr", "cannot be read"),
        ];
        for (name, says) in cases {
            let error = SkyMap::read(&folder.path().join(name)).err().unwrap_or_else(|| panic!("{name} is no map"));
            let sentence = format!("{error:#}");
            assert_eq!(exit_code(&error), Exit::BadInput);
            assert!(sentence.contains(name) && !sentence.contains('\n'), "{sentence}");
            assert!(sentence.contains(says) || name == "cut.exr", "{sentence}");
        }
    }
}
