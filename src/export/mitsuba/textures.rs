//! Textures, each written once in each form that materials need.

use super::super::xml::Element;
use super::super::{Names, Warnings};
use crate::gpu::Format;
use crate::output::exr::Precision;
use crate::output::{ExrLayer, write_exr, write_png};
use crate::scene::{Filter, Map, Scene, Texture, Wrap};
use anyhow::Result;
use std::path::Path;

/// Form of a written texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Content {
    /// Colours times a factor.
    Color([f32; 3]),
    /// One channel as data, times a factor.
    Channel(usize, f32),
    /// 1 where alpha times `factor` reaches the cutoff, else 0; sampled with the map's filter and wrapping.
    Opacity { factor: f32, cutoff: f32, wrap: [Wrap; 2], filter: Filter },
    /// Normals with x and y scaled, and y flipped for a mirrored map.
    Normals { scale: f32, left_handed: bool },
}

/// Writes textures into a folder, each once.
pub struct Textures<'a> {
    scene: &'a Scene,
    folder: &'a Path,
    names: Names,
    written: Vec<(u32, Content, Written)>,
}

#[derive(Clone)]
struct Written {
    file: String,
    /// Whether values are linear data, without an sRGB curve.
    raw: bool,
    /// Whether the texture must be sampled without interpolation.
    stepped: bool,
}

impl<'a> Textures<'a> {
    /// Folder of the textures in the scene's folder.
    pub const FOLDER: &'static str = "textures";

    pub fn new(scene: &'a Scene, folder: &'a Path) -> Self {
        Self { scene, folder, names: Names::default(), written: Vec::new() }
    }

    pub fn get(&self, map: &Map) -> &'a Texture {
        &self.scene.textures[map.texture as usize]
    }

    /// The value of a channel if it is constant over the texture.
    pub fn constant(&self, map: &Map, channel: usize) -> Option<f32> {
        let mut values = self.get(map).texels.chunks_exact(4).map(|texel| texel[channel]);
        let first = values.next()?;
        values.all(|value| value == first).then(|| f32::from(first) / 255.0)
    }

    /// The texture as the property `name`; writes its file at first use.
    pub fn element(&mut self, name: &str, map: &Map, content: Content, warnings: &mut Warnings) -> Result<Element> {
        let written = match self.written.iter().find(|(texture, form, _)| (*texture, *form) == (map.texture, content)) {
            Some((.., written)) => written.clone(),
            None => {
                let written = self.write(map, content)?;
                self.written.push((map.texture, content, written.clone()));
                written
            }
        };
        if map.wrap_u != map.wrap_v {
            let texture = &self.get(map).name;
            warnings.add(format!("texture {texture:?}: Mitsuba wraps both axes alike, v is wrapped as u"));
        }
        let wrap = match map.wrap_u {
            Wrap::Repeat => "repeat",
            Wrap::MirroredRepeat => "mirror",
            Wrap::ClampToEdge => "clamp",
        };
        let filter = if written.stepped || map.filter == Filter::Nearest { "nearest" } else { "bilinear" };
        let mut element = Element::plugin("texture", "bitmap").with("name", name).children([
            Element::value("string", "filename", format!("{}/{}", Self::FOLDER, written.file)),
            Element::value("string", "wrap_mode", wrap),
            Element::value("string", "filter_type", filter),
            Element::value("boolean", "raw", written.raw),
        ]);
        // (0, 0) is the upper left corner of the image for both renderers.
        let [a, b, c, d] = map.matrix.to_cols_array();
        if ([a, b, c, d], map.offset.to_array()) != ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0]) {
            let rows = format!("{a} {c} 0 {} {b} {d} 0 {} 0 0 1 0 0 0 0 1", map.offset.x, map.offset.y);
            element = element.child(Element::new("transform").with("name", "to_uv").child(Element::new("matrix").with("value", rows)));
        }
        Ok(element)
    }

    fn write(&mut self, map: &Map, content: Content) -> Result<Written> {
        let texture = self.get(map);
        let size = (texture.width, texture.height);
        let texels = || texture.texels.chunks_exact(4);
        let suffix = match content {
            Content::Color(_) => "",
            Content::Channel(..) => "-data",
            Content::Opacity { .. } => "-opacity",
            Content::Normals { .. } => "-normals",
        };
        let name = self.names.unique(&format!("{}{suffix}", if texture.name.is_empty() { "texture" } else { &texture.name }));
        let png = |raw, stepped| Written { file: format!("{name}.png"), raw, stepped };
        let path = |written: &Written| self.folder.join(&written.file);
        match content {
            // Content that 8 bits hold exactly is written as PNG, other content as floats.
            Content::Color([1.0, 1.0, 1.0]) => {
                let written = png(!texture.srgb, false);
                let rgb: Vec<u8> = texels().flat_map(|texel| [texel[0], texel[1], texel[2]]).collect();
                write_png(&path(&written), size.0, size.1, &rgb)?;
                Ok(written)
            }
            Content::Color(factor) => {
                let format = if texture.srgb { Format::Rgba8Srgb } else { Format::Rgba8Unorm };
                let linear = texels().flat_map(|texel| std::array::from_fn::<f32, 3, _>(|c| format.decode(texel)[c] * factor[c]));
                self.write_floats(&name, size, &linear.collect::<Vec<f32>>(), false)
            }
            Content::Channel(channel, 1.0) => {
                let written = png(true, false);
                write_png(&path(&written), size.0, size.1, &texels().map(|texel| texel[channel]).collect::<Vec<u8>>())?;
                Ok(written)
            }
            Content::Channel(channel, factor) => {
                let scaled = texels().flat_map(|texel| [f32::from(texel[channel]) / 255.0 * factor; 3]);
                self.write_floats(&name, size, &scaled.collect::<Vec<f32>>(), true)
            }
            Content::Opacity { factor, cutoff, wrap, filter } => {
                let written = png(true, true);
                let (width, height, pixels) = opacity(texture, wrap, filter, factor, cutoff);
                write_png(&path(&written), width, height, &pixels)?;
                Ok(written)
            }
            Content::Normals { scale, left_handed } => {
                // Only the direction matters: a large scale shrinks the other components instead, so that all stay in [0, 1].
                let most = scale.abs().max(1.0);
                let factors = [scale / most, if left_handed { -scale } else { scale } / most, 1.0 / most];
                let component = |(byte, factor): (&u8, f32)| (f32::from(*byte) / 255.0 * 2.0 - 1.0) * factor * 0.5 + 0.5;
                let normals = texels().flat_map(|texel| texel.iter().zip(factors).map(component));
                self.write_floats(&name, size, &normals.collect::<Vec<f32>>(), true)
            }
        }
    }

    fn write_floats(&self, name: &str, (width, height): (u32, u32), rgb: &[f32], raw: bool) -> Result<Written> {
        let written = Written { file: format!("{name}.exr"), raw, stepped: false };
        let layer = ExrLayer::interleaved("", "RGB", 3, rgb, Precision::Half);
        write_exr(&self.folder.join(&written.file), width, height, vec![layer], &[])?;
        Ok(written)
    }
}

/// Opacity filtered first and thresholded then, as in our shaders, at several points per texel. A renderer that filtered
/// thresholded texels would make edges half transparent.
fn opacity(texture: &Texture, [wrap_u, wrap_v]: [Wrap; 2], filter: Filter, factor: f32, cutoff: f32) -> (u32, u32, Vec<u8>) {
    const LARGEST: u32 = 4096;
    let points = match filter {
        Filter::Linear => (LARGEST / texture.width.max(texture.height)).clamp(1, 4),
        Filter::Nearest => 1,
    };
    let (width, height) = (texture.width * points, texture.height * points);
    let wrapped = |at: i64, side: u32, wrap: Wrap| {
        let side = i64::from(side);
        let at = match wrap {
            Wrap::Repeat => at.rem_euclid(side),
            Wrap::ClampToEdge => at.clamp(0, side - 1),
            Wrap::MirroredRepeat => at.rem_euclid(2 * side).min(2 * side - 1 - at.rem_euclid(2 * side)),
        };
        at as usize
    };
    let alpha = |x: i64, y: i64| {
        let (x, y) = (wrapped(x, texture.width, wrap_u), wrapped(y, texture.height, wrap_v));
        f32::from(texture.texels[(y * texture.width as usize + x) * 4 + 3]) / 255.0
    };
    let place = |i: u32| {
        let at = (i as f32 + 0.5) / points as f32 - 0.5;
        (at.floor() as i64, at - at.floor())
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let pixel = |x: u32, y: u32| {
        let ((x, s), (y, t)) = (place(x), place(y));
        let row = |y| mix(alpha(x, y), alpha(x + 1, y), s);
        if mix(row(y), row(y + 1), t) * factor < cutoff { 0 } else { 255 }
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    (width, height, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opacity_is_cut_off_between_texels_where_filtering_has_it() {
        // Alpha 0 and 1 side by side, repeated: the filtered alpha crosses one half between the texels and at the texture's
        // border.
        let texture = Texture { name: "a".into(), width: 2, height: 1, srgb: true, texels: vec![9, 9, 9, 0, 9, 9, 9, 255] };
        let cut = |wrap_u, filter, cutoff| opacity(&texture, [wrap_u, Wrap::Repeat], filter, 1.0, cutoff);
        let (width, height, pixels) = cut(Wrap::Repeat, Filter::Linear, 0.5);
        assert_eq!((width, height), (8, 4));
        assert_eq!(pixels[..8], [0, 0, 0, 0, 255, 255, 255, 255]);
        assert_eq!(cut(Wrap::Repeat, Filter::Linear, 0.8).2[..8], [0, 0, 0, 0, 0, 255, 255, 0]);
        assert_eq!(cut(Wrap::ClampToEdge, Filter::Linear, 0.8).2[..8], [0, 0, 0, 0, 0, 255, 255, 255]);
        assert_eq!(cut(Wrap::Repeat, Filter::Nearest, 0.8), (2, 1, vec![0, 255]));
        assert_eq!(opacity(&texture, [Wrap::Repeat; 2], Filter::Linear, 0.4, 0.5).2, [0; 32], "the factor counts");
    }
}
