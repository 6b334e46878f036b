//! Mitsuba 3: `scene.xml` with PLY meshes and textures beside it.
//!
//! The integrator is `path`, or `volpath` if there are masks: `path` takes holes as opaque for light.

mod bsdf;
mod lights;
mod textures;

use super::xml::Element;
use super::{Names, Warnings, behind, meshes, ply};
use crate::config::Dielectric;
use crate::files::{prepare_folder, write_file};
use crate::scene::{Aabb, Camera, Light, Material, Scene};
use crate::world::projection::View;
use anyhow::Result;
use std::path::{Path, PathBuf};
use textures::{Content, Textures};

/// A frame to export.
pub struct Shot<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub lights: &'a [Light],
    /// Size of the picture, pixels.
    pub size: [u32; 2],
    pub dielectric: Dielectric,
}

/// Writes a frame's scene into a folder. Returns the path of `scene.xml`, and differences from our own picture.
pub fn write(folder: &Path, shot: &Shot<'_>) -> Result<(PathBuf, Vec<String>)> {
    for part in [MESHES, Textures::FOLDER] {
        prepare_folder(&folder.join(part))?;
    }
    let mut warnings = Warnings::default();
    let bounds = shot.scene.bounds();
    let view = View::new(shot.camera, shot.size, bounds);
    let emitters = lights::emitters(shot.lights, folder, &mut warnings)?;
    let shapes = shapes(folder, shot, bounds, &mut warnings)?;
    let masked = shapes.iter().any(|element| element.is_plugin("bsdf", "mask"));
    let share = 100.0 * behind::seen_through(shot.scene, &view);
    if share > 0.0 {
        warnings.add(format!(
            "{share:.2} percent of the picture is seen through the back of single-sided surfaces, which are black and solid in Mitsuba"
        ));
    }
    if emitters.is_empty() && !shot.scene.materials.iter().any(glows) {
        warnings.add(format!("light: {} has none; Mitsuba's picture is black", shot.scene.name));
    }
    let scene =
        Element::new("scene")
            .with("version", "3.0.0")
            .children([
                parameter("spp", 64),
                // Paths of our frames have three segments: light to surface, surface to surface, surface to camera.
                parameter("max_depth", 3),
                parameter("integrator", if masked { "volpath" } else { "path" }),
                Element::plugin("integrator", "$integrator")
                    .child(Element::value("integer", "max_depth", "$max_depth"))
                    .child(Element::value("boolean", "hide_emitters", false)),
                sensor(shot, &view, bounds),
            ])
            .children(emitters)
            .children(shapes);
    let path = folder.join("scene.xml");
    write_file(&path, format!("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n{scene}").as_bytes())?;
    Ok((path, warnings.sentences()))
}

/// Folder of the meshes in the scene's folder.
const MESHES: &str = "meshes";

/// A parameter that `-D` on Mitsuba's command line sets.
fn parameter(name: &str, value: impl std::fmt::Display) -> Element {
    Element::value("default", name, value)
}

fn sensor(shot: &Shot<'_>, view: &View, bounds: Aabb) -> Element {
    let Camera { position, target, up, fov_y_deg, .. } = *shot.camera;
    let farthest = bounds.corners().map(|corner| corner.distance(position)).into_iter().fold(view.near, f32::max);
    let film = Element::plugin("film", "hdrfilm").children([
        Element::value("integer", "width", shot.size[0]),
        Element::value("integer", "height", shot.size[1]),
        Element::value("string", "pixel_format", "rgb"),
        Element::value("string", "component_format", "float32"),
        Element::plugin("rfilter", "box"),
    ]);
    Element::plugin("sensor", "perspective").children([
        Element::look_at(position, target, up),
        Element::value("string", "fov_axis", "y"),
        Element::value("float", "fov", fov_y_deg),
        Element::value("float", "near_clip", view.near),
        Element::value("float", "far_clip", 2.0 * farthest),
        Element::plugin("sampler", "independent").child(Element::value("integer", "sample_count", "$spp")),
        film,
    ])
}

fn glows(material: &Material) -> bool {
    material.emission.iter().any(|value| *value > 0.0)
}

/// The elements of materials and meshes; writes the meshes' files.
fn shapes(folder: &Path, shot: &Shot<'_>, bounds: Aabb, warnings: &mut Warnings) -> Result<Vec<Element>> {
    let texture_folder = folder.join(Textures::FOLDER);
    let mut textures = Textures::new(shot.scene, &texture_folder);
    let mut names = Names::default();
    let (mut bsdfs, mut shapes) = (Vec::new(), Vec::new());
    for (kind, mesh) in meshes::merge(shot.scene) {
        let material = &shot.scene.materials[kind.material as usize];
        let Some(bsdf) = bsdf::surface(material, kind, shot.dielectric, &mut textures, warnings)? else { continue };
        let name = names.unique(&material.name);
        // Ids get prefixes, since meshes and materials have equal names.
        let id = format!("material-{name}");
        bsdfs.push(bsdf.with("id", &id));
        let mut faces = vec![(name.clone(), None)];
        if glows(material) {
            warnings.add("a surface that glows lights the scene in Mitsuba, and in a rasterized frame of ours nothing");
            if material.alpha_cutoff.is_some() {
                warnings.add(format!("material {:?}: its holes glow in Mitsuba", material.name));
            }
            // An area light shines only from its front.
            if material.double_sided {
                faces.push((names.unique(&format!("{name}-back")), Some(mesh.back(1e-5 * bounds.size().length()))));
            }
        }
        for (name, back) in faces {
            let file = format!("{MESHES}/{name}.ply");
            write_file(&folder.join(&file), &ply::encode(back.as_ref().unwrap_or(&mesh), kind.colored))?;
            let mut shape = Element::plugin("shape", "ply")
                .with("id", format!("mesh-{name}"))
                .child(Element::value("string", "filename", file))
                .child(Element::new("ref").with("id", &id));
            if glows(material) {
                let radiance = match material.emission_map {
                    Some(map) => textures.element("radiance", &map, Content::Color(material.emission), warnings)?,
                    None => Element::rgb("radiance", material.emission),
                };
                shape = shape.child(Element::plugin("emitter", "area").child(radiance));
            }
            shapes.push(shape);
        }
    }
    bsdfs.append(&mut shapes);
    Ok(bsdfs)
}
