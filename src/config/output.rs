//! `[output]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Files beside the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputConfig {
    /// Layers of the EXR beside the final radiance, each at most once.
    #[schemars(extend("uniqueItems" = true))]
    pub layers: Vec<Layer>,
}

impl Default for OutputConfig {
    fn default() -> Self {
        use Layer::*;
        Self { layers: vec![Direct, Indirect, Irradiance, Albedo, Normal, Position, Depth] }
    }
}

/// A layer of the EXR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Layer {
    /// Outgoing radiance of the direct light, albedo included: `direct.R/G/B`.
    Direct,
    /// Outgoing radiance of the indirect light, albedo included: `indirect.R/G/B`.
    Indirect,
    /// Indirect irradiance after the filter: `irradiance.R/G/B`.
    Irradiance,
    /// Albedo: `albedo.R/G/B`.
    Albedo,
    /// Shading normals in the world: `N.X/Y/Z`.
    Normal,
    /// Positions in the world, metres: `P.X/Y/Z`.
    Position,
    /// View depth, metres: `Z`.
    Depth,
}
