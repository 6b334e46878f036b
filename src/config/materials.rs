//! `[materials]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Surfaces: how they reflect.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MaterialsConfig {
    pub dielectric: Dielectric,
}

/// Reflection of non-metals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Dielectric {
    /// Diffuse only, as in the papers.
    #[default]
    Lambert,
    /// Diffuse under a GGX coat that reflects 0.04 along the normal.
    Ggx,
}
