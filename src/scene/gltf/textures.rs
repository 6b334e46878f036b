//! Textures: materials' references to them as images to decode and [`Map`]s.

use super::{File, label, refuse};
use crate::scene::{Filter, Map, Wrap};
use anyhow::{Context, Result};
use glam::{Mat2, Vec2};
use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::NormalTexture;
use gltf_json::texture::{Info, MagFilter, MinFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Image, Index};
use std::collections::HashMap;

/// Images that become the scene's textures, in order.
#[derive(Default)]
pub struct Textures {
    pub images: Vec<ImageUse>,
    /// Index in `images` by the image's index and whether it is colour.
    known: HashMap<(usize, bool), u32>,
}

/// An image used as colour or as data; one used as both becomes two textures.
#[derive(Clone, Copy)]
pub struct ImageUse {
    pub image: Index<Image>,
    pub srgb: bool,
}

/// A material's reference to a texture, of any kind.
pub struct Reference {
    /// The material's key of the reference.
    pub key: &'static str,
    index: Index<gltf_json::Texture>,
    tex_coord: u32,
    transform: Option<TextureTransform>,
    srgb: bool,
}

impl Reference {
    pub fn new(key: &'static str, info: &Info, srgb: bool) -> Self {
        let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.clone());
        Self { key, index: info.index, tex_coord: info.tex_coord, transform, srgb }
    }

    /// The reference of a normal map, whose extensions the JSON crate leaves unparsed.
    pub fn normal(normal: &NormalTexture) -> Result<Self> {
        let raw = normal.extensions.as_ref().and_then(|extensions| extensions.others.get("KHR_texture_transform"));
        let Ok(transform) = raw.map(|raw| serde_json::from_value(raw.clone())).transpose() else {
            refuse!("the KHR_texture_transform of its normalTexture is not as that extension has it");
        };
        Ok(Self { key: "normalTexture", index: normal.index, tex_coord: normal.tex_coord, transform, srgb: false })
    }

    /// Set of texture coordinates of the reference.
    pub fn uv_set(&self) -> u32 {
        self.transform.as_ref().and_then(|transform| transform.tex_coord).unwrap_or(self.tex_coord)
    }
}

impl Textures {
    /// The map of a texture reference.
    pub fn map(&mut self, file: &File<'_>, reference: &Reference) -> Result<Map> {
        let texture = file.get(reference.index, "texture")?;
        if texture.source.value() == u32::MAX as usize {
            refuse!("texture {} has no PNG or JPEG as its source", reference.index);
        }
        file.get(texture.source, "image").with_context(|| label("texture", reference.index.value(), texture.name.as_ref()))?;
        let position = *self.known.entry((texture.source.value(), reference.srgb)).or_insert_with(|| {
            self.images.push(ImageUse { image: texture.source, srgb: reference.srgb });
            self.images.len() as u32 - 1
        });
        let default = Sampler::default();
        let sampler = match texture.sampler {
            Some(index) => file.get(index, "sampler")?,
            None => &default,
        };
        let map = Map { wrap_u: wrap(sampler.wrap_s)?, wrap_v: wrap(sampler.wrap_t)?, filter: filter(sampler), ..Map::new(position) };
        let Some(transform) = &reference.transform else {
            return Ok(map);
        };
        // The extension's rotation looks counter-clockwise with v downwards: in (u, v), the matrix of a clockwise rotation.
        let (sin, cos) = transform.rotation.0.sin_cos();
        let matrix = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos)) * Mat2::from_diagonal(transform.scale.0.into());
        let offset = Vec2::from(transform.offset.0);
        if !(matrix.is_finite() && offset.is_finite()) {
            refuse!("its KHR_texture_transform is not finite");
        }
        Ok(Map { matrix, offset, ..map })
    }
}

fn wrap(mode: Checked<WrappingMode>) -> Result<Wrap> {
    Ok(match mode {
        Checked::Valid(WrappingMode::Repeat) => Wrap::Repeat,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Invalid => refuse!("its sampler's wrapS or wrapT is none of glTF's modes"),
    })
}

/// The magnification filter. If the sampler leaves it open, it follows the minification filter.
fn filter(sampler: &Sampler) -> Filter {
    match (sampler.mag_filter, sampler.min_filter) {
        (Some(Checked::Valid(MagFilter::Nearest)), _) => Filter::Nearest,
        (None, Some(Checked::Valid(MinFilter::Nearest | MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear))) => {
            Filter::Nearest
        }
        _ => Filter::Linear,
    }
}
