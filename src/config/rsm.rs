//! `[rsm]`.

use super::Config;
use super::rules::{Broken, broken};
use super::values::{Point, Size};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Reflective shadow maps: what each light sees, one array layer a light, six for a point light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RsmConfig {
    /// Width and height of a light's map, texels. Direct light is shadowed by this map too, unless `direct.map_size` gives it one of its own or
    /// `direct.shadows` is `"ray-traced"` or `"none"`.
    #[schemars(with = "Size<8192>")]
    pub size: [u32; 2],
    pub albedo: RsmAlbedo,
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub bounds: Option<BoxConfig>,
}

impl Default for RsmConfig {
    fn default() -> Self {
        Self { size: [512, 512], albedo: RsmAlbedo::Footprint, bounds: None }
    }
}

/// Colour of a texel, and of VPLs on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RsmAlbedo {
    /// Mean of the textures over the area that a VPL stands for: their mip of that size.
    #[default]
    Footprint,
    /// Mean of the whole textures, as in Linke 2016, section 4.3.
    Material,
}

/// Box that the maps of directional lights cover: the scene's bounds if it is absent. `min` is less than `max` on every axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxConfig {
    /// Lower corner, metres.
    #[schemars(with = "Point", extend("x-default" = "the scene's bounds"))]
    pub min: [f32; 3],
    /// Upper corner, metres.
    #[schemars(with = "Point", extend("x-default" = "the scene's bounds"))]
    pub max: [f32; 3],
}

impl RsmConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        match config.rsm.bounds {
            Some(bounds) if (0..3).any(|axis| bounds.min[axis] >= bounds.max[axis]) => {
                broken("rsm.box", "min must be less than max on every axis")
            }
            _ => Ok(()),
        }
    }
}
