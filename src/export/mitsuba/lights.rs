//! Lights as Mitsuba's emitters.

use super::super::Warnings;
use super::super::xml::Element;
use super::textures::Textures;
use crate::output::exr::Precision;
use crate::output::{ExrLayer, write_exr};
use crate::scene::sky::SkyMap;
use crate::scene::{Light, SpotFalloff};
use crate::world::projection::Projector;
use anyhow::Result;
use glam::Vec3;
use std::path::Path;

/// The emitters of these lights. `folder` is the scene's.
pub fn emitters(lights: &[Light], folder: &Path, warnings: &mut Warnings) -> Result<Vec<Element>> {
    lights.iter().enumerate().map(|(number, light)| emitter(light, number, folder, warnings)).collect()
}

fn emitter(light: &Light, number: usize, folder: &Path, warnings: &mut Warnings) -> Result<Element> {
    Ok(match light.clone() {
        Light::Directional { direction, irradiance } => Element::plugin("emitter", "directional")
            .child(Element::point("vector", "direction", direction.into()))
            .child(Element::rgb("irradiance", irradiance.into())),
        Light::Point { position, intensity } => Element::plugin("emitter", "point")
            .child(Element::point("point", "position", position.into()))
            .child(Element::rgb("intensity", intensity.into())),
        Light::Environment { radiance, map: None, .. } => {
            warnings.add(SKY);
            Element::plugin("emitter", "constant").child(Element::rgb("radiance", radiance.into()))
        }
        Light::Environment { radiance, map: Some(map), rotation } => {
            warnings.add(SKY);
            // The picture has the factor in it: Mitsuba's is one number for all colours.
            let file = format!("{}/sky-{number}.exr", Textures::FOLDER);
            let map = SkyMap::read(&map)?;
            let colors = map.texels.iter().flat_map(|[r, g, b, _]| (Vec3::new(*r, *g, *b) * radiance).to_array());
            let picture = ExrLayer::interleaved("", "RGB", 3, &colors.collect::<Vec<f32>>(), Precision::Float);
            write_exr(&folder.join(&file), map.size[0], map.size[1], vec![picture], &[])?;
            Element::plugin("emitter", "envmap")
                .child(Element::value("string", "filename", file))
                .child(Element::rotation_y(rotation.to_degrees()))
        }
        Light::Spot { position, direction, intensity, inner, outer, falloff } => {
            let widest = outer.min(Projector::WIDEST_SPOT);
            if widest < outer {
                warnings.add("light: a spot light is wider than 80 degrees to each side; beyond them it lights nothing, as in our frames");
            }
            let up = if direction.cross(Vec3::Y).length() > 1e-3 { Vec3::Y } else { Vec3::X };
            let mut spot = Element::plugin("emitter", "spot")
                .child(Element::look_at(position, position + direction, up))
                .child(Element::rgb("intensity", intensity.into()))
                .child(Element::value("float", "cutoff_angle", widest.to_degrees()));
            if falloff == SpotFalloff::CosineSquared && inner < outer {
                // Mitsuba's falloff is linear in angle. The beam is as wide as the light instead, and a texture holds the
                // falloff.
                let file = format!("{}/spot-{number}.exr", Textures::FOLDER);
                write_exr(&folder.join(&file), FALLOFF_SIZE, FALLOFF_SIZE, vec![falloff_picture(inner, outer, widest)], &[])?;
                spot = spot.child(Element::value("float", "beam_width", widest.to_degrees()));
                spot = spot.child(Element::plugin("texture", "bitmap").with("name", "texture").children([
                    Element::value("string", "filename", file),
                    Element::value("string", "wrap_mode", "clamp"),
                    Element::value("boolean", "raw", true),
                ]));
            } else {
                spot = spot.child(Element::value("float", "beam_width", inner.min(widest).to_degrees()));
            }
            spot
        }
    })
}

const SKY: &str = "light: an environment's light is reflected by all surfaces in Mitsuba, and by those that it reaches directly in a rasterized frame of ours";

/// Side of the texture of a spot light's falloff, texels.
const FALLOFF_SIZE: u32 = 1024;

/// The falloff of KHR_lights_punctual on the plane at distance 1, out to the tangent of `widest`.
fn falloff_picture(inner: f32, outer: f32, widest: f32) -> ExrLayer {
    let tangent = widest.tan();
    let at = |i: u32| ((i as f32 + 0.5) / FALLOFF_SIZE as f32 * 2.0 - 1.0) * tangent;
    let falloff = |x: f32, y: f32| {
        let cosine = 1.0 / (1.0 + x * x + y * y).sqrt();
        ((cosine - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0).powi(2)
    };
    let texels = (0..FALLOFF_SIZE).flat_map(|y| (0..FALLOFF_SIZE).map(move |x| (x, y))).flat_map(|(x, y)| [falloff(at(x), at(y)); 3]);
    ExrLayer::interleaved("", "RGB", 3, &texels.collect::<Vec<f32>>(), Precision::Half)
}
