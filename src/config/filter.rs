//! `[filter]`.

use super::Config;
use super::unused::Unused;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Filter of the indirect light over the pixels' subsets of VPLs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FilterConfig {
    pub kind: FilterKind,
    /// Distance at which a neighbour's weight reaches 0, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 32), extend("x-default" = "`gather.interleave`, twice that for a Gaussian"))]
    pub radius: Option<u32>,
    /// Angle between normals beyond which pixels are not mixed, degrees. A cross bilateral filter mixes them by e^-2 there, and less beyond.
    #[schemars(range(max = 90), extend("exclusiveMinimum" = 0))]
    pub normal_threshold_deg: f32,
    /// Distance from the pixel's tangent plane beyond which points are not mixed, in units of its view depth. A cross bilateral filter
    /// mixes them by e^-2 there, and less beyond.
    #[schemars(range(max = 1_000_000), extend("exclusiveMinimum" = 0))]
    pub plane_distance: f32,
}

impl Default for FilterConfig {
    fn default() -> Self {
        Self { kind: FilterKind::Bilateral, radius: None, normal_threshold_deg: 25.0, plane_distance: 0.02 }
    }
}

/// How the indirect light is smoothed. Every filter is separable and keeps edges of depth and normal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FilterKind {
    /// Weights that fall with the distance in the picture (Laine et al. 2007).
    #[default]
    Bilateral,
    /// Weights of a Gaussian.
    Gaussian,
    /// Weights that also fall with the difference of place and normal.
    CrossBilateral,
    /// No filter.
    None,
}

impl FilterConfig {
    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        (config.filter.kind == FilterKind::None).then(|| Unused::new(&["filter"], &["filter.kind"])).into_iter().collect()
    }
}
