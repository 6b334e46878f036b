//! `[direct]`.

use super::Config;
use super::unused::Unused;
use super::values::Size;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Direct light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DirectConfig {
    pub shadows: Shadows,
    /// Distance that a surface is lifted along its normal before the shadow map is compared, metres. On slopes a texel's width is added.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub bias: f32,
    /// Filter radius of the shadow map, texels.
    #[schemars(range(max = 8))]
    pub blur: u32,
    /// Width and height of a light's shadow map, texels. It covers all of the scene, whatever `rsm.box` is. Without a size, reflective shadow
    /// maps are the shadow maps.
    #[schemars(with = "Size<8192>", extend("x-default" = "none"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub map_size: Option<[u32; 2]>,
}

impl Default for DirectConfig {
    fn default() -> Self {
        Self { shadows: Shadows::Variance, bias: 0.005, blur: 1, map_size: None }
    }
}

/// How direct light is shadowed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Shadows {
    /// Variance shadow maps (Donnelly and Lauritzen 2006).
    #[default]
    Variance,
    /// Several comparisons with the shadow map, averaged.
    PercentageCloser,
    /// A ray to the light: exact, with hard edges.
    RayTraced,
    /// No shadows.
    None,
}

impl Config {
    /// Size of the shadow maps that are apart from the reflective ones, if there are any.
    pub fn shadow_map_size(&self) -> Option<[u32; 2]> {
        self.direct.map_size.filter(|_| matches!(self.direct.shadows, Shadows::Variance | Shadows::PercentageCloser))
    }
}

impl DirectConfig {
    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        (matches!(config.direct.shadows, Shadows::RayTraced | Shadows::None))
            .then(|| Unused::new(&["direct.bias", "direct.blur", "direct.map_size"], &["direct.shadows"]))
            .into_iter()
            .collect()
    }
}
