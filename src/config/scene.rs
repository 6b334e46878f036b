//! `[scene]`.

use super::Config;
use super::check::error;
use super::rules::{Broken, broken};
use super::tree::{Node, Table, Value};
use anyhow::Result;
use schemars::JsonSchema;
use serde::ser::{SerializeStruct, Serializer};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The scene: a glTF file, or one that is made by code. A loaded config has exactly one of `file` and `builtin`.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SceneConfig {
    /// A .glb or .gltf file, in place of `scene.builtin`. A relative path starts from the folder of the config that says it.
    // Absolute once loaded.
    #[schemars(length(min = 1), extend("x-default" = "none"))]
    pub file: Option<PathBuf>,
    /// Which of the file's scenes.
    #[schemars(extend("x-default" = "the file's default"))]
    pub scene: Option<SceneSelector>,
    /// Which of the file's animations moves the scene, in a loop. `"none"` holds it still.
    #[schemars(extend("x-default" = "the file's first"))]
    pub animation: Option<SceneSelector>,
    pub builtin: Option<Builtin>,
    /// Triangles of the built-in scene: about so many of the atrium, which has 10,000 to 8,000,000, of the courtyard, which has 100,000 at
    /// least, and of the street, which has 20,000 to 2,000,000, and exactly so many of the caustics, which have 8,000,000 at most.
    #[schemars(range(min = 8_000, max = 10_000_000))]
    pub triangles: u32,
    /// GGX's alpha of the caustics' metal. It is the square of a glTF material's roughness.
    #[schemars(range(min = 0.001, max = 1), extend("x-default" = "0.05 of the caustics"))]
    pub roughness: f32,
    /// Seed of the atrium's, the courtyard's or the street's random numbers.
    pub seed: u32,
    /// Length of the longest edge after triangles are split, in units of the scene's diagonal. Maps of clusters bend long edges.
    /// Meshes with skins or morph targets are not split.
    #[schemars(range(min = 0.001, max = 1), extend("x-default" = "none"))]
    pub split: Option<f32>,
}

impl Default for SceneConfig {
    fn default() -> Self {
        Self {
            file: None,
            scene: None,
            animation: None,
            builtin: Some(Builtin::Atrium),
            triangles: 260_000,
            roughness: 0.05,
            seed: 0,
            split: None,
        }
    }
}

impl Serialize for SceneConfig {
    /// Writes the keys that mean something for this scene only, so that what is written can be read again.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut table = serializer.serialize_struct("SceneConfig", 3)?;
        if let Some(file) = &self.file {
            table.serialize_field("file", file)?;
            if let Some(scene) = &self.scene {
                table.serialize_field("scene", scene)?;
            }
            if let Some(animation) = &self.animation {
                table.serialize_field("animation", animation)?;
            }
        } else {
            let builtin = self.builtin.unwrap_or_default();
            table.serialize_field("builtin", &builtin)?;
            if builtin != Builtin::Cornell {
                table.serialize_field("triangles", &self.triangles)?;
            }
            match builtin {
                Builtin::Atrium | Builtin::Courtyard | Builtin::Street => table.serialize_field("seed", &self.seed)?,
                Builtin::Caustics => table.serialize_field("roughness", &self.roughness)?,
                Builtin::Cornell => {}
            }
        }
        if let Some(split) = &self.split {
            table.serialize_field("split", split)?;
        }
        table.end()
    }
}

/// One of a glTF file's scenes or animations, by index or by name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SceneSelector {
    Index(u32),
    Name(#[schemars(length(min = 1))] String),
}

/// A scene that is made by code.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Builtin {
    /// A two-storey colonnaded court.
    #[default]
    Atrium,
    /// Rings, a bowl and a pipe of metal on a floor.
    Caustics,
    /// The classic box with two blocks.
    Cornell,
    /// The atrium, planted: trees and shrubs of single leaves, ivy, ferns, and laid tables. Made for millions of triangles.
    Courtyard,
    /// A street of houses and shops, with cars, trees, and coloured panels in the sun.
    Street,
}

/// Rules on keys that are there or not, before defaults fill them in.
pub(super) fn given(root: &Table) -> Result<()> {
    let Some(Node { value: Value::Table(scene), .. }) = root.get("scene") else { return Ok(()) };
    if let (Some(file), Some(_)) = (scene.get("file"), scene.get("builtin")) {
        return Err(error(&file.origin, "scene.file", "excludes scene.builtin; give one of them"));
    }
    for (key, several) in [("scene", "scenes"), ("animation", "animations")] {
        if let (None, Some(node)) = (scene.get("file"), scene.get(key)) {
            let message = format_args!("only a glTF file has {several} to choose from; give scene.file");
            return Err(error(&node.origin, &format!("scene.{key}"), message));
        }
    }
    let builtin = match scene.get("builtin") {
        _ if scene.contains_key("file") => "",
        Some(Node { value: Value::Text(name), .. }) => name.as_str(),
        _ => "atrium",
    };
    let knobs: [(&str, &[&str], &str); 3] = [
        ("triangles", &["atrium", "caustics", "courtyard", "street"], "atrium, caustics, courtyard and street have"),
        ("seed", &["atrium", "courtyard", "street"], "atrium, courtyard and street have"),
        ("roughness", &["caustics"], "caustics has"),
    ];
    for (knob, scenes, have) in knobs {
        if let (false, Some(node)) = (scenes.contains(&builtin), scene.get(knob)) {
            let message = format_args!("of the built-in scenes only {have} this knob; remove it");
            return Err(error(&node.origin, &format!("scene.{knob}"), message));
        }
    }
    Ok(())
}

impl SceneConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let (name, least, most) = match config.scene.builtin {
            Some(Builtin::Atrium) => ("atrium", 10_000, 8_000_000),
            Some(Builtin::Street) => ("street", 20_000, 2_000_000),
            Some(Builtin::Courtyard) => ("courtyard", 100_000, 10_000_000),
            Some(Builtin::Caustics) => ("caustics", 8_000, 8_000_000),
            Some(Builtin::Cornell) | None => return Ok(()),
        };
        let triangles = config.scene.triangles;
        if !(least..=most).contains(&triangles) {
            let amount = if triangles < least { "few" } else { "many" };
            return broken("scene.triangles", format!("{triangles} is too {amount} for the {name}, expected {least} to {most}"));
        }
        Ok(())
    }
}
