//! `[compose]`.

use super::values::Color;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The picture: how `image.png` is made from linear radiance. The EXR stays as it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ComposeConfig {
    /// Factor of the radiance.
    #[schemars(range(max = 1_000_000_000), extend("exclusiveMinimum" = 0))]
    pub exposure: f32,
    /// Radiance that is shown where there is no surface, added to that of an environment. It lights nothing.
    #[schemars(with = "Color")]
    pub background: [f32; 3],
    pub tonemap: Tonemap,
    pub show: Show,
}

impl Default for ComposeConfig {
    fn default() -> Self {
        Self { exposure: 1.0, background: [0.0; 3], tonemap: Tonemap::Reinhard, show: Show::Picture }
    }
}

/// How radiance becomes values from 0 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Tonemap {
    /// Divided by 1 + luminance (Reinhard et al. 2002).
    #[default]
    Reinhard,
    /// Clamped.
    None,
}

/// What `image.png` shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Show {
    /// The picture.
    #[default]
    Picture,
    /// The indirect light's intensity in false colour, from blue to red.
    Indirect,
    /// The VPLs of the first bounce over the darkened picture, in false colour by their radiant intensity.
    Vpls,
}
