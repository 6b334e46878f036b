//! `[sky]`.

use super::{Config, LightConfig};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Light of an environment: virtual point lights that are directions, infinitely far away. It is direct light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SkyConfig {
    /// Directions, drawn by the environment's luminance. Pixels share them out as `gather.interleave` says, and their number is rounded up
    /// to give each pixel of the block as many.
    #[schemars(range(min = 1, max = 4096))]
    pub count: u32,
    pub visibility: SkyVisibility,
    /// Side of a direction's imperfect shadow map, texels. It shows all of the scene, and there are fewer of them than of other VPLs' maps.
    #[schemars(extend("enum" = [16, 32, 64, 128, 256]))]
    pub map_size: u32,
}

impl Default for SkyConfig {
    fn default() -> Self {
        Self { count: 256, visibility: SkyVisibility::RayTraced, map_size: 128 }
    }
}

/// How the environment is shadowed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SkyVisibility {
    /// Not at all.
    None,
    /// By a ray for each pair of pixel and direction: exact. Scenes that move rebuild their acceleration structure in each frame.
    #[default]
    RayTraced,
    /// By one small orthographic map of all of the scene per direction, of uniform points with equal areas, else as `[visibility.ism]`,
    /// `visibility.bias` and `visibility.lookup` say. For objects in the open: rooms leak and courts are too dark, since a map's few points
    /// stand for large squares.
    ImperfectShadowMaps,
}

impl Config {
    /// Whether an environment lights the scene.
    pub fn has_sky(&self) -> bool {
        self.light.iter().any(|light| matches!(light, LightConfig::Environment { radiance, .. } if *radiance != [0.0; 3]))
    }

    /// How the environment is shadowed, if there is one.
    pub fn sky_visibility(&self) -> Option<SkyVisibility> {
        self.has_sky().then_some(self.sky.visibility)
    }

    /// The environment's map, with the key that names it.
    pub fn sky_map(&self) -> Option<(String, &Path)> {
        self.light.iter().enumerate().find_map(|(index, light)| match light {
            LightConfig::Environment { map: Some(map), .. } => Some((format!("light.{index}.map"), map.as_path())),
            _ => None,
        })
    }
}
