//! Materials and the textures that they use.

use super::nodes::PlacedMesh;
use super::{File, Warning, Warnings, label, refuse};
use crate::scene::{Filter, Map, Material, Scene, Wrap};
use anyhow::{Context, Result};
use glam::{Mat2, Vec2};
use gltf_json::extensions::texture::TextureTransform;
use gltf_json::material::AlphaMode;
use gltf_json::texture::{MagFilter, MinFilter, Sampler, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Image, Index};
use std::collections::HashMap;

/// The materials that the scene uses, and the images to decode for them.
#[derive(Default)]
pub struct Materials {
    used: HashMap<Option<usize>, Used>,
    pub images: Vec<ImageUse>,
    /// Where in `images` an image is, by its index and whether it is colour.
    known_images: HashMap<(usize, bool), u32>,
}

/// A material of the scene, and what its triangles must bring along.
#[derive(Clone, Copy)]
pub struct Used {
    /// Index into [`Scene::materials`].
    pub index: u32,
    /// The set of texture coordinates that its maps use; 0 where it has none.
    pub uv_set: u32,
    pub has_maps: bool,
    pub has_normal_map: bool,
}

/// An image that becomes the scene's texture of the same position; as colour and as data makes two.
#[derive(Clone, Copy)]
pub struct ImageUse {
    pub image: Index<Image>,
    pub srgb: bool,
}

/// What the kinds of texture reference have in common.
struct Reference<'a> {
    key: &'static str,
    index: Index<gltf_json::Texture>,
    tex_coord: u32,
    transform: Option<&'a TextureTransform>,
    srgb: bool,
}

impl Materials {
    /// The material of a primitive. All that [`read`] has seen are there.
    pub fn get(&self, index: Option<Index<gltf_json::Material>>) -> Used {
        self.used[&index.map(|index| index.value())]
    }
}

/// Reads every material of the meshes that are placed, in the order of their first use.
pub fn read(file: &File<'_>, meshes: &[PlacedMesh], scene: &mut Scene, warnings: &mut Warnings) -> Result<Materials> {
    let mut materials = Materials::default();
    let mut seen = vec![false; file.root.meshes.len()];
    for placed in meshes {
        let mesh = file.get(placed.mesh, "mesh").with_context(|| format!("node {}", placed.node))?;
        if std::mem::replace(&mut seen[placed.mesh.value()], true) {
            continue;
        }
        for index in mesh.primitives.iter().map(|primitive| primitive.material) {
            let key = index.map(|index| index.value());
            if materials.used.contains_key(&key) {
                continue;
            }
            let default = gltf_json::Material::default();
            let (source, name) = match index {
                Some(index) => {
                    let source = file.get(index, "material").with_context(|| label("mesh", placed.mesh.value(), mesh.name.as_ref()))?;
                    (source, label("material", index.value(), source.name.as_ref()))
                }
                None => (&default, "default".to_string()),
            };
            let used = materials.material(file, source, &name, scene, warnings).with_context(|| name.clone())?;
            materials.used.insert(key, used);
        }
    }
    Ok(materials)
}

impl Materials {
    fn material(
        &mut self,
        file: &File<'_>,
        source: &gltf_json::Material,
        name: &str,
        scene: &mut Scene,
        warnings: &mut Warnings,
    ) -> Result<Used> {
        let pbr = &source.pbr_metallic_roughness;
        let info = |key, info: &Option<gltf_json::texture::Info>, srgb| {
            info.as_ref()
                .map(|info| (key, info.index, info.tex_coord, info.extensions.as_ref().and_then(|e| e.texture_transform.clone()), srgb))
        };
        let normal = match &source.normal_texture {
            Some(normal) => {
                // This reference's extensions come as they stand in the file.
                let raw = normal.extensions.as_ref().and_then(|extensions| extensions.others.get("KHR_texture_transform"));
                let transform = raw.map(|raw| serde_json::from_value(raw.clone())).transpose();
                let Ok(transform) = transform else {
                    refuse!("the KHR_texture_transform of its normalTexture is not as that extension has it");
                };
                Some(("normalTexture", normal.index, normal.tex_coord, transform, false))
            }
            None => None,
        };
        let references = [
            info("baseColorTexture", &pbr.base_color_texture, true),
            info("metallicRoughnessTexture", &pbr.metallic_roughness_texture, false),
            info("emissiveTexture", &source.emissive_texture, true),
            normal,
        ];
        let (mut maps, mut uv_set) = ([None; 4], None);
        for (map, reference) in maps.iter_mut().zip(&references) {
            let Some((key, index, tex_coord, transform, srgb)) = reference else {
                continue;
            };
            let reference = Reference { key, index: *index, tex_coord: *tex_coord, transform: transform.as_ref(), srgb: *srgb };
            let (read, set) = self.map(file, &reference).with_context(|| *key)?;
            if *uv_set.get_or_insert(set) != set {
                warnings.add(
                    Warning::UvSets,
                    format!(
                        "{name} mixes sets of texture coordinates: all its textures use the first one's, TEXCOORD_{}",
                        uv_set.unwrap_or(set)
                    ),
                );
            }
            *map = Some(read);
        }
        let [base_color_map, metallic_roughness_map, emission_map, normal_map] = maps;

        let cutoff = source.alpha_cutoff.unwrap_or_default().0;
        let alpha_cutoff = match source.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => None,
            Checked::Valid(AlphaMode::Mask) => Some(cutoff),
            Checked::Valid(AlphaMode::Blend) => {
                warnings.add(
                    Warning::Blending,
                    "blended materials are not supported: what is less than half opaque is left out, the rest is solid",
                );
                Some(0.5)
            }
            Checked::Invalid => refuse!("its alphaMode is none of OPAQUE, MASK and BLEND"),
        };
        let strength = source.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |e| e.emissive_strength.0);
        let unit = |key: &str, value: f32| match value {
            value if value.is_finite() => Ok(value.clamp(0.0, 1.0)),
            _ => refuse!("its {key} is not finite"),
        };
        let mut base_color = pbr.base_color_factor.0;
        for value in &mut base_color {
            *value = unit("baseColorFactor", *value)?;
        }
        let emission = source.emissive_factor.0.map(|value| value.max(0.0) * strength);
        if !emission.iter().all(|value| value.is_finite() && *value >= 0.0) {
            refuse!("its emissiveFactor times its emissiveStrength is negative or not finite");
        }
        let normal_scale = source.normal_texture.as_ref().map_or(1.0, |normal| normal.scale);
        if !(normal_scale.is_finite() && cutoff.is_finite()) {
            refuse!("its normalTexture's scale or its alphaCutoff is not finite");
        }
        let index = scene.add_material(Material {
            name: source.name.clone().unwrap_or_else(|| name.to_string()),
            base_color,
            base_color_map,
            metallic: unit("metallicFactor", pbr.metallic_factor.0)?,
            roughness: unit("roughnessFactor", pbr.roughness_factor.0)?,
            metallic_roughness_map,
            emission,
            emission_map,
            normal_map,
            normal_scale,
            alpha_cutoff,
            double_sided: source.double_sided,
        });
        let has_maps = maps.iter().any(Option::is_some);
        Ok(Used { index, uv_set: uv_set.unwrap_or(0), has_maps, has_normal_map: normal_map.is_some() })
    }

    /// A texture reference as a map, and the set of texture coordinates that it names.
    fn map(&mut self, file: &File<'_>, reference: &Reference<'_>) -> Result<(Map, u32)> {
        let texture = file.get(reference.index, "texture")?;
        if texture.source.value() == u32::MAX as usize {
            refuse!("texture {} has no PNG or JPEG as its source", reference.index);
        }
        file.get(texture.source, "image").with_context(|| label("texture", reference.index.value(), texture.name.as_ref()))?;
        let position = *self.known_images.entry((texture.source.value(), reference.srgb)).or_insert_with(|| {
            self.images.push(ImageUse { image: texture.source, srgb: reference.srgb });
            self.images.len() as u32 - 1
        });
        let default = Sampler::default();
        let sampler = match texture.sampler {
            Some(index) => file.get(index, "sampler")?,
            None => &default,
        };
        let map = Map { wrap_u: wrap(sampler.wrap_s)?, wrap_v: wrap(sampler.wrap_t)?, filter: filter(sampler), ..Map::new(position) };
        let Some(transform) = reference.transform else {
            return Ok((map, reference.tex_coord));
        };
        // The extension's rotation is counter-clockwise as one sees it, with v downwards: the matrix of a clockwise one.
        let (sin, cos) = transform.rotation.0.sin_cos();
        let matrix = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos)) * Mat2::from_diagonal(transform.scale.0.into());
        let offset = Vec2::from(transform.offset.0);
        if !(matrix.is_finite() && offset.is_finite()) {
            refuse!("the KHR_texture_transform of {} is not finite", reference.key);
        }
        Ok((Map { matrix, offset, ..map }, transform.tex_coord.unwrap_or(reference.tex_coord)))
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

/// The magnification filter, or where the sampler leaves it open, what goes with its minification filter.
fn filter(sampler: &Sampler) -> Filter {
    match (sampler.mag_filter, sampler.min_filter) {
        (Some(Checked::Valid(MagFilter::Nearest)), _) => Filter::Nearest,
        (None, Some(Checked::Valid(MinFilter::Nearest | MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear))) => {
            Filter::Nearest
        }
        _ => Filter::Linear,
    }
}
