//! Materials in use by the scene.

use super::nodes::PlacedMesh;
use super::textures::{Reference, Textures};
use super::{File, Warning, Warnings, label, refuse};
use crate::scene::{Material, Scene};
use anyhow::{Context, Result};
use gltf_json::Index;
use gltf_json::material::AlphaMode;
use gltf_json::validation::Checked;
use std::collections::HashMap;

/// Materials in use, and their textures.
#[derive(Default)]
pub struct Materials {
    used: HashMap<Option<usize>, Used>,
    pub textures: Textures,
}

/// A material of the scene, and its requirements on vertices.
#[derive(Clone, Copy)]
pub struct Used {
    /// Index into [`Scene::materials`].
    pub index: u32,
    /// Set of texture coordinates that its maps use; 0 without maps.
    pub uv_set: u32,
    pub has_maps: bool,
    pub has_normal_map: bool,
}

impl Materials {
    /// Material of a primitive that [`read`] has seen.
    pub fn get(&self, index: Option<Index<gltf_json::Material>>) -> Used {
        self.used[&index.map(|index| index.value())]
    }
}

/// Reads the materials of all placed meshes, in the order of their first use.
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
        let references = [
            pbr.base_color_texture.as_ref().map(|info| Reference::new("baseColorTexture", info, true)),
            pbr.metallic_roughness_texture.as_ref().map(|info| Reference::new("metallicRoughnessTexture", info, false)),
            source.emissive_texture.as_ref().map(|info| Reference::new("emissiveTexture", info, true)),
            source.normal_texture.as_ref().map(Reference::normal).transpose()?,
        ];
        let (mut maps, mut uv_set) = ([None; 4], None);
        for (map, reference) in maps.iter_mut().zip(references) {
            let Some(reference) = reference else { continue };
            *map = Some(self.textures.map(file, &reference).with_context(|| reference.key)?);
            let first = *uv_set.get_or_insert(reference.uv_set());
            if first != reference.uv_set() {
                let sentence = format!("{name} mixes sets of texture coordinates: all its textures use the first one's, TEXCOORD_{first}");
                warnings.add(Warning::UvSets, sentence);
            }
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
}
