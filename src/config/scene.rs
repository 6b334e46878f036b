//! `[scene]`, `[camera]` and `[[light]]`: what is seen, from where, and what lights it.

use serde::ser::{SerializeStruct, Serializer};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `[scene]`: a glTF file or a built-in scene. Exactly one of `file` and `builtin` is set in a loaded config.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneConfig {
    /// A .glb or .gltf file; the config's own folder is what a relative path starts from. Absolute once loaded.
    pub file: Option<PathBuf>,
    /// Which of the file's scenes; its default scene if absent.
    pub scene: Option<SceneSelector>,
    /// Which of the file's animations moves it, "none" for none; its first if absent.
    pub animation: Option<SceneSelector>,
    pub builtin: Option<Builtin>,
    /// About how many triangles the atrium is made of, and just how many the caustics are, 8,000 to 8,000,000.
    pub triangles: u32,
    /// GGX's alpha of the caustics' metal, 0.001 to 1: a glTF material's roughness is its root.
    pub roughness: f32,
    /// Seed of what is random in the atrium.
    pub seed: u32,
    /// Triangles are split until no edge is longer than this part of the scene's diagonal, 0.001 to 1; as they are if absent.
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
                Builtin::Atrium => table.serialize_field("seed", &self.seed)?,
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

/// One of a glTF file's scenes, or of its animations.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SceneSelector {
    Index(u32),
    Name(String),
}

/// The scenes that are made by code.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Builtin {
    /// A two-storey colonnaded court.
    #[default]
    Atrium,
    /// Rings, a bowl and a pipe of metal on a floor.
    Caustics,
    /// The classic box with two blocks.
    Cornell,
}

/// `[camera]`: position and target, a path through keyframes, or a camera of the glTF file by name.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    /// Metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<[f32; 3]>,
    /// A point straight ahead, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<[f32; 3]>,
    /// Need not be normalized; [0, 1, 0] if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<[f32; 3]>,
    /// Vertical field of view in degrees, 1 to 170; that of the named camera, else 60, if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fov_y_deg: Option<f32>,
    /// Name of a camera of the glTF file; excludes `position`, `target`, `up` and `keyframes`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// How the path runs between its keyframes.
    pub interpolation: Interpolation,
    /// Times rise; before the first and after the last the camera stands still.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub keyframes: Vec<CameraKeyframe>,
}

/// Where the camera is at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraKeyframe {
    /// Seconds; frame `i` is at `i / frame.fps`.
    pub time: f32,
    /// Metres.
    pub position: [f32; 3],
    /// Metres.
    pub target: [f32; 3],
    /// Degrees, 1 to 170; keyframes without it are skipped in the course of this value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fov_y_deg: Option<f32>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    #[default]
    Linear,
    /// Smooth through every keyframe, times need not be even.
    CatmullRom,
}

/// `[[light]]`: one light. Directions are those in which light travels and need not be normalized; a light is aimed by exactly
/// one of `direction` and `target`. Keyframes run linearly, and hold at both ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LightConfig {
    /// Parallel light.
    Directional {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f32; 3]>,
        /// With `target`: light travels from here to there. Metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        position: Option<[f32; 3]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        target: Option<[f32; 3]>,
        /// On a plane that faces the light, W/m^2, RGB.
        irradiance: [f32; 3],
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        keyframes: Vec<LightKeyframe>,
    },
    /// A cone that falls off linearly in angle from `inner_deg` to `outer_deg`.
    Spot {
        /// Metres.
        position: [f32; 3],
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f32; 3]>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        target: Option<[f32; 3]>,
        /// Radiant intensity on the axis, W/sr, RGB.
        intensity: [f32; 3],
        /// Half-angle of full intensity, degrees, 0 to `outer_deg`; three quarters of `outer_deg` if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        inner_deg: Option<f32>,
        /// Half-angle of no light, degrees, over 0.1 to 80.
        #[serde(default = "default_outer_deg")]
        outer_deg: f32,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        keyframes: Vec<LightKeyframe>,
    },
    /// The same in all directions.
    Point {
        /// Metres.
        position: [f32; 3],
        /// Radiant intensity, W/sr, RGB.
        intensity: [f32; 3],
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        keyframes: Vec<LightKeyframe>,
    },
    /// From everywhere.
    Environment {
        /// W/(m^2 sr), RGB.
        radiance: [f32; 3],
    },
}

fn default_outer_deg() -> f32 {
    40.0
}

/// What a light is at one time; a value that a keyframe leaves out runs between those keyframes that give it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightKeyframe {
    /// Seconds.
    pub time: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intensity: Option<[f32; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irradiance: Option<[f32; 3]>,
}
