//! `[ssao]`.

use super::Config;
use super::unused::Unused;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Ambient occlusion in screen space, which darkens indirect light where surfaces nearby stand in its way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SsaoConfig {
    pub method: SsaoMethod,
    /// Distance in which occluders are looked for, metres.
    #[schemars(range(max = 1000), extend("exclusiveMinimum" = 0))]
    pub radius: f32,
    /// Samples of the depth to each of two sides.
    #[schemars(range(min = 1, max = 32))]
    pub samples: u32,
    pub resolution: SsaoResolution,
    /// Share of the occlusion that is applied.
    #[schemars(range(min = 0, max = 1))]
    pub strength: f32,
}

impl Default for SsaoConfig {
    fn default() -> Self {
        Self { method: SsaoMethod::None, radius: 0.6, samples: 4, resolution: SsaoResolution::Half, strength: 1.0 }
    }
}

/// How occlusion is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SsaoMethod {
    /// No ambient occlusion.
    #[default]
    None,
    /// By the horizons of the depth around a pixel (Jimenez et al. 2016).
    Horizons,
}

/// Pixels that occlusion is found for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SsaoResolution {
    /// Every pixel.
    Full,
    /// Every second pixel of every second row.
    #[default]
    Half,
}

impl SsaoConfig {
    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        (config.ssao.method == SsaoMethod::None).then(|| Unused::new(&["ssao"], &["ssao.method"])).into_iter().collect()
    }
}
