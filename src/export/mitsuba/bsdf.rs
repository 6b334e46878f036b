//! Materials as Mitsuba's BSDFs.
//!
//! Lambert is `diffuse`. A metal is `principled`, whose Schlick Fresnel, GGX and clamped alpha equal ours. Its Smith term is
//! the separable one, which is darker on rough surfaces: by 0.3 percent at roughness 0.3, 2 at 0.6 and 14 at 1, and by nothing
//! measurable below 0.15 (mean over all directions). `roughconductor`, whose Fresnel is another curve, is a median half percent
//! off for light metals and six for dark ones, at any roughness. A partly metallic material is a `blendbsdf` of `diffuse` and
//! `principled`.
//!
//! A viewer in front of the surface but behind its interpolated normal sees it reflect in ours, and black in Mitsuba: up to a
//! percent of the light that smooth coarse meshes bounce.

use super::super::Warnings;
use super::super::meshes::Kind;
use super::super::xml::Element;
use super::textures::{Content, Textures};
use crate::config::Dielectric;
use crate::scene::{Map, Material};
use anyhow::Result;

/// A number, or a map.
enum Value {
    Number(f32),
    Map(Map, Content),
}

impl Value {
    /// A factor times the channel of a map.
    fn new(factor: f32, map: Option<Map>, channel: usize, textures: &Textures<'_>) -> Self {
        match map {
            Some(map) if factor > 0.0 => match textures.constant(&map, channel) {
                Some(constant) => Self::Number(factor * constant),
                None => Self::Map(map, Content::Channel(channel, factor)),
            },
            _ => Self::Number(factor),
        }
    }

    fn element(&self, name: &str, textures: &mut Textures<'_>, warnings: &mut Warnings) -> Result<Element> {
        match self {
            Self::Number(number) => Ok(Element::value("float", name, number)),
            Self::Map(map, content) => textures.element(name, map, *content, warnings),
        }
    }
}

/// The BSDF of this kind's meshes; `None` if the material is entirely transparent.
pub fn surface(
    material: &Material,
    kind: Kind,
    dielectric: Dielectric,
    textures: &mut Textures<'_>,
    warnings: &mut Warnings,
) -> Result<Option<Element>> {
    if kind.colored && material.alpha_cutoff.is_some() {
        warnings.add(format!("material {:?}: the alpha of its vertex colours cuts nothing out in Mitsuba", material.name));
    }
    let opacity = match opacity(material, textures) {
        Opacity::Hole => return Ok(None),
        Opacity::Solid => None,
        Opacity::Masked(map, content) => Some(textures.element("opacity", &map, content, warnings)?),
    };
    let metallic = Value::new(material.metallic, material.metallic_roughness_map, 2, textures);
    let roughness = Value::new(material.roughness, material.metallic_roughness_map, 1, textures);
    let mut surface = Surface { material, kind, roughness, textures, warnings };
    let mut bsdf = match &metallic {
        Value::Number(0.0) => surface.dielectric(dielectric)?,
        Value::Number(1.0) => surface.metal()?,
        weight => {
            let weight = weight.element("weight", surface.textures, surface.warnings)?;
            Element::plugin("bsdf", "blendbsdf").child(weight).child(surface.dielectric(dielectric)?).child(surface.metal()?)
        }
    };
    if material.double_sided {
        bsdf = Element::plugin("bsdf", "twosided").child(bsdf);
    }
    // The normal map wraps both sides: seen from behind, a mapped normal is flipped as a whole.
    if let Some(map) = material.normal_map {
        let content = Content::Normals { scale: material.normal_scale, left_handed: kind.left_handed };
        let map = textures.element("normalmap", &map, content, warnings)?;
        // Ours has no shadowing function that softens grazing light at the geometric horizon.
        let soft = Element::value("boolean", "use_shadowing_function", false);
        bsdf = Element::plugin("bsdf", "normalmap").children([map, soft, bsdf]);
    }
    Ok(Some(match opacity {
        Some(opacity) => Element::plugin("bsdf", "mask").child(opacity).child(bsdf),
        None => bsdf,
    }))
}

enum Opacity {
    Solid,
    Hole,
    Masked(Map, Content),
}

/// Opacity by a material's alpha.
fn opacity(material: &Material, textures: &Textures<'_>) -> Opacity {
    let Some(cutoff) = material.alpha_cutoff else { return Opacity::Solid };
    let factor = material.base_color[3];
    let whole = |alpha: f32| if alpha * factor < cutoff { Opacity::Hole } else { Opacity::Solid };
    let Some(map) = material.base_color_map else { return whole(1.0) };
    match textures.constant(&map, 3) {
        Some(alpha) => whole(alpha),
        None => Opacity::Masked(map, Content::Opacity { factor, cutoff, wrap: [map.wrap_u, map.wrap_v], filter: map.filter }),
    }
}

/// Inputs of a surface's parts. Textures are only written for parts in use.
struct Surface<'a, 's> {
    material: &'a Material,
    kind: Kind,
    roughness: Value,
    textures: &'a mut Textures<'s>,
    warnings: &'a mut Warnings,
}

impl Surface<'_, '_> {
    fn metal(&mut self) -> Result<Element> {
        self.principled(1.0)
    }

    fn dielectric(&mut self, how: Dielectric) -> Result<Element> {
        match how {
            Dielectric::Lambert => self.lambert(),
            Dielectric::Ggx => {
                self.warnings.add(
                    "materials.dielectric: Mitsuba has no GGX coat over Lambert; the nearest that it has reflects up to a tenth more or less",
                );
                self.coated()
            }
        }
    }

    fn lambert(&mut self) -> Result<Element> {
        Ok(Element::plugin("bsdf", "diffuse").child(self.color("reflectance")?))
    }

    /// GGX of F0 = 0.04 over Lambert. `principled` has the Fresnel, but its diffuse lobe is retroreflective on rough surfaces
    /// (17 percent brighter at roughness 1). There, a fixed share of 0.04 is closer.
    fn coated(&mut self) -> Result<Element> {
        const FIXED_FROM: f32 = 0.7;
        if !matches!(self.roughness, Value::Number(roughness) if roughness >= FIXED_FROM) {
            return self.principled(0.0);
        }
        let mirror = Element::plugin("bsdf", "principled").children([
            Element::rgb("base_color", [1.0; 3]),
            Element::value("float", "metallic", 1.0f32),
            self.roughness.element("roughness", self.textures, self.warnings)?,
        ]);
        let share = Element::value("float", "weight", 0.04f32);
        Ok(Element::plugin("bsdf", "blendbsdf").child(share).child(self.lambert()?).child(mirror))
    }

    fn principled(&mut self, metallic: f32) -> Result<Element> {
        Ok(Element::plugin("bsdf", "principled").children([
            self.color("base_color")?,
            Element::value("float", "metallic", metallic),
            self.roughness.element("roughness", self.textures, self.warnings)?,
        ]))
    }

    /// The base colour as the property `name`.
    fn color(&mut self, name: &str) -> Result<Element> {
        let [r, g, b, _] = self.material.base_color;
        match self.material.base_color_map {
            Some(map) => {
                if self.kind.colored {
                    let material = &self.material.name;
                    self.warnings.add(format!(
                        "material {material:?}: Mitsuba has a texture or vertex colours, not both; the texture alone is written"
                    ));
                }
                self.textures.element(name, &map, Content::Color([r, g, b]), self.warnings)
            }
            // The vertex colours contain the factor already.
            None if self.kind.colored => {
                let attribute = Element::plugin("texture", "mesh_attribute").with("name", name);
                Ok(attribute.child(Element::value("string", "name", "vertex_color")))
            }
            None => Ok(Element::rgb(name, [r, g, b])),
        }
    }
}
