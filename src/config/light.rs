//! `[[light]]`.

use super::Config;
use super::rules::{Broken, broken, rising};
use super::values::{Color, Direction, Point};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Kind of the light.
// Directions are those in which light travels and need not be normalized; a light is aimed by exactly one of `direction` and `target`.
// Keyframes run linearly, and hold at both ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum LightConfig {
    /// Parallel light.
    Directional {
        /// Direction in which the light travels.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Direction>", extend("x-default" = "this or `target`"))]
        direction: Option<[f32; 3]>,
        /// Place that the light comes from, metres. Goes with `target`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Point>", extend("x-default" = "none"))]
        position: Option<[f32; 3]>,
        /// A point that the light is aimed at, metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Point>", extend("x-default" = "this or `direction`"))]
        target: Option<[f32; 3]>,
        /// Irradiance on a plane that faces the light, W/m^2.
        #[schemars(with = "Color")]
        irradiance: [f32; 3],
        /// The light over time. A value runs linearly between the keyframes that give it.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[schemars(extend("x-default" = "none"))]
        keyframes: Vec<LightKeyframe>,
    },
    /// A cone that falls off linearly in angle from `inner_deg` to `outer_deg`.
    Spot {
        /// Place, metres.
        #[schemars(with = "Point")]
        position: [f32; 3],
        /// Direction in which the light travels.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Direction>", extend("x-default" = "this or `target`"))]
        direction: Option<[f32; 3]>,
        /// A point that the light is aimed at, metres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "Option<Point>", extend("x-default" = "this or `direction`"))]
        target: Option<[f32; 3]>,
        /// Radiant intensity, for a spot light on its axis, W/sr.
        #[schemars(with = "Color")]
        intensity: [f32; 3],
        /// Half-angle of full intensity, degrees.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0, max = 80), extend("x-default" = "3/4 of `outer_deg`"))]
        inner_deg: Option<f32>,
        /// Half-angle at which the light ends, degrees.
        #[serde(default = "default_outer_deg")]
        #[schemars(range(max = 80), extend("exclusiveMinimum" = 0.1))]
        outer_deg: f32,
        /// The light over time. A value runs linearly between the keyframes that give it.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[schemars(extend("x-default" = "none"))]
        keyframes: Vec<LightKeyframe>,
    },
    /// The same in all directions.
    Point {
        /// Place, metres.
        #[schemars(with = "Point")]
        position: [f32; 3],
        /// Radiant intensity, for a spot light on its axis, W/sr.
        #[schemars(with = "Color")]
        intensity: [f32; 3],
        /// The light over time. A value runs linearly between the keyframes that give it.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[schemars(extend("x-default" = "none"))]
        keyframes: Vec<LightKeyframe>,
    },
    /// Light from infinitely far away: the same from all directions, or a map of all directions. The camera sees it.
    Environment {
        /// Radiance, W/(m^2 sr); with a map a factor of the map's.
        #[schemars(with = "Color")]
        radiance: [f32; 3],
        /// An OpenEXR or Radiance HDR picture in latitude and longitude, up to 4096x2048: up is its first row, +Z its middle, +X a quarter
        /// from its left edge. A relative path starts from the folder of the config that says it.
        // Absolute once loaded.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(length(min = 1), extend("x-default" = "none"))]
        map: Option<PathBuf>,
        /// Turn of the map about +Y, counter-clockwise seen from above, degrees.
        #[serde(default)]
        #[schemars(range(min = -360, max = 360))]
        rotation_deg: f32,
    },
}

fn default_outer_deg() -> f32 {
    40.0
}

/// A light at one time. A value that a keyframe leaves out runs between the keyframes that give it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LightKeyframe {
    /// Seconds. Times rise.
    pub time: f32,
    /// Place, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Point>", extend("x-default" = "`position`"))]
    pub position: Option<[f32; 3]>,
    /// Direction in which the light travels, if it is aimed by `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Direction>", extend("x-default" = "`direction`", "x-lights" = ["directional", "spot"]))]
    pub direction: Option<[f32; 3]>,
    /// A point that the light is aimed at, metres, if it is aimed by `target`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Point>", extend("x-default" = "`target`", "x-lights" = ["directional", "spot"]))]
    pub target: Option<[f32; 3]>,
    /// Radiant intensity, W/sr.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Color>", extend("x-default" = "`intensity`", "x-lights" = ["spot", "point"]))]
    pub intensity: Option<[f32; 3]>,
    /// Irradiance on a plane that faces the light, W/m^2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Color>", extend("x-default" = "`irradiance`", "x-lights" = ["directional"]))]
    pub irradiance: Option<[f32; 3]>,
}

impl LightConfig {
    /// The light over time; none of one that stands still.
    pub fn keyframes(&self) -> &[LightKeyframe] {
        match self {
            Self::Directional { keyframes, .. } | Self::Spot { keyframes, .. } | Self::Point { keyframes, .. } => keyframes,
            Self::Environment { .. } => &[],
        }
    }

    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        config.light.iter().enumerate().try_for_each(|(index, light)| check(light, &format!("light.{index}")))?;
        let is_environment = |light: &&LightConfig| matches!(light, LightConfig::Environment { .. });
        match config.sky_map() {
            Some((key, _)) if config.light.iter().filter(is_environment).count() > 1 => {
                broken(key, "a map is the only environment; remove the other lights of this kind")
            }
            _ => Ok(()),
        }
    }
}

fn check(light: &LightConfig, at: &str) -> Result<(), Broken> {
    match light {
        LightConfig::Directional { direction, position, target, keyframes, .. } => {
            aimed(*direction, *target, keyframes, at)?;
            if target.is_some() && position.is_none() {
                return broken(format!("{at}.target"), "needs position, where the light comes from; or give direction");
            }
            if target.is_none() && position.is_some() {
                return broken(format!("{at}.position"), "a directional light has a position only together with target; remove it");
            }
            if let (None, Some(index)) = (target, keyframes.iter().position(|key| key.position.is_some())) {
                let message = "a directional light has a position only together with target; remove it";
                return broken(format!("{at}.keyframes.{index}.position"), message);
            }
            apart(*position, *target, keyframes, at)
        }
        LightConfig::Spot { position, direction, target, inner_deg, outer_deg, keyframes, .. } => {
            if let Some(inner) = inner_deg.filter(|inner| inner > outer_deg) {
                return broken(format!("{at}.inner_deg"), format!("{inner} is more than outer_deg, {outer_deg}"));
            }
            aimed(*direction, *target, keyframes, at)?;
            apart(Some(*position), *target, keyframes, at)
        }
        LightConfig::Point { keyframes, .. } => rising(at, keyframes.iter().map(|key| key.time)),
        LightConfig::Environment { map: None, rotation_deg, .. } if *rotation_deg != 0.0 => {
            broken(format!("{at}.rotation_deg"), "turns a map; give map too")
        }
        LightConfig::Environment { .. } => Ok(()),
    }
}

/// A light is aimed one way, in its keyframes too.
fn aimed(direction: Option<[f32; 3]>, target: Option<[f32; 3]>, keyframes: &[LightKeyframe], at: &str) -> Result<(), Broken> {
    match (direction, target) {
        (Some(_), Some(_)) => return broken(format!("{at}.target"), "excludes direction; give one of them"),
        (None, None) => return broken(at, "needs direction or target"),
        _ => {}
    }
    rising(at, keyframes.iter().map(|key| key.time))?;
    for (index, key) in keyframes.iter().enumerate() {
        if direction.is_some() && key.target.is_some() {
            return broken(format!("{at}.keyframes.{index}.target"), "the light is aimed by direction; give direction here too");
        }
        if target.is_some() && key.direction.is_some() {
            return broken(format!("{at}.keyframes.{index}.direction"), "the light is aimed by target; give target here too");
        }
    }
    Ok(())
}

/// A light that is aimed at a point is not there itself.
fn apart(position: Option<[f32; 3]>, target: Option<[f32; 3]>, keyframes: &[LightKeyframe], at: &str) -> Result<(), Broken> {
    let own = "is the light's own position; give a point ahead of it";
    if target.is_some() && target == position {
        return broken(format!("{at}.target"), own);
    }
    match keyframes.iter().position(|key| key.target.is_some() && key.target == key.position) {
        Some(index) => broken(format!("{at}.keyframes.{index}.target"), own),
        None => Ok(()),
    }
}
