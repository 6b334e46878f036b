//! `[camera]`.

use super::rules::{Broken, broken, rising};
use super::values::{Direction, Point};
use super::{Builtin, Config};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The camera: a place and a target, a path through keyframes, or a camera of the glTF file by its name.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    /// Place of the camera, metres. Goes with `target`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Point>", extend("x-default" = "the scene's first camera, else a view of all of it"))]
    pub position: Option<[f32; 3]>,
    /// A point straight ahead, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Point>", extend("x-default" = "as `position`"))]
    pub target: Option<[f32; 3]>,
    /// Direction that points up in the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Direction>", extend("x-default" = "[0, 1, 0]"))]
    pub up: Option<[f32; 3]>,
    /// Vertical field of view, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 170), extend("x-default" = "that of the scene's camera, else 60"))]
    pub fov_y_deg: Option<f32>,
    /// Name of a camera of the glTF file. Excludes `position`, `target`, `up` and `keyframes`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1), extend("x-default" = "none"))]
    pub node: Option<String>,
    pub interpolation: Interpolation,
    /// A path, in place of `position` and `target`. Before its first keyframe and after its last the camera stands still.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("x-default" = "none"))]
    pub keyframes: Vec<CameraKeyframe>,
}

/// The camera at one time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraKeyframe {
    /// Seconds. Times rise; frame i is at i / `frame.fps`.
    pub time: f32,
    /// Place, metres.
    #[schemars(with = "Point")]
    pub position: [f32; 3],
    /// A point straight ahead, metres.
    #[schemars(with = "Point")]
    pub target: [f32; 3],
    /// Vertical field of view, degrees. It runs between the keyframes that give it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 170), extend("x-default" = "`camera.fov_y_deg`"))]
    pub fov_y_deg: Option<f32>,
}

/// How a path runs between keyframes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Straight.
    #[default]
    Linear,
    /// Smooth through every keyframe. Times need not be even.
    CatmullRom,
}

impl CameraConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let Some(camera) = &config.camera else { return Ok(()) };
        if camera.node.is_some() && config.scene.file.is_none() {
            let builtin = match config.scene.builtin {
                Some(Builtin::Cornell) => "cornell",
                Some(Builtin::Caustics) => "caustics",
                Some(Builtin::Courtyard) => "courtyard",
                Some(Builtin::Street) => "street",
                Some(Builtin::Atrium) | None => "atrium",
            };
            let message = format!("only a glTF file has named cameras, and the scene is the built-in {builtin}; give position and target");
            return broken("camera.node", message);
        }
        if camera.node.is_some() {
            let rivals = [
                ("position", camera.position.is_some()),
                ("target", camera.target.is_some()),
                ("up", camera.up.is_some()),
                ("keyframes", !camera.keyframes.is_empty()),
            ];
            if let Some((key, _)) = rivals.iter().find(|(_, is_given)| *is_given) {
                return broken(format!("camera.{key}"), "excludes camera.node; give one of them");
            }
        }
        let placed = camera.position.is_some() || camera.target.is_some();
        if placed && !camera.keyframes.is_empty() {
            return broken("camera.keyframes", "excludes camera.position and camera.target; make them the first keyframe");
        }
        let up = camera.up.unwrap_or([0.0, 1.0, 0.0]);
        match (camera.position, camera.target) {
            (Some(position), Some(target)) => view(position, target, up, "camera")?,
            (Some(_), None) => return broken("camera.position", "needs camera.target"),
            (None, Some(_)) => return broken("camera.target", "needs camera.position"),
            (None, None) => {}
        }
        rising("camera", camera.keyframes.iter().map(|key| key.time))?;
        for (index, key) in camera.keyframes.iter().enumerate() {
            view(key.position, key.target, up, &format!("camera.keyframes.{index}"))?;
        }
        Ok(())
    }
}

/// A camera looks somewhere, and not along its own up.
fn view(position: [f32; 3], target: [f32; 3], up: [f32; 3], key: &str) -> Result<(), Broken> {
    let ahead = vector(target) - vector(position);
    if ahead == DVec3::ZERO {
        return broken(format!("{key}.target"), "is the camera's own position; give a point ahead of it");
    }
    if ahead.normalize().cross(vector(up).normalize()).length() < 1e-4 {
        return broken(format!("{key}.target"), "lies straight along camera.up; give another camera.up");
    }
    Ok(())
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}
