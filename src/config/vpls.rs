//! `[vpls]`.

use super::rules::{Broken, broken};
use super::unused::Unused;
use super::{Config, GatherMethod};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Virtual point lights (VPLs): which texels of the reflective shadow maps become one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VplsConfig {
    pub sampler: VplSampler,
    /// VPLs in all. `"every-texel"` has as many as there are texels.
    #[schemars(range(min = 1, max = 1_048_576))]
    pub count: u32,
    pub importance: Importance,
    pub reflection: Reflection,
}

impl Default for VplsConfig {
    fn default() -> Self {
        Self { sampler: VplSampler::Regular, count: 1024, importance: Importance::None, reflection: Reflection::Diffuse }
    }
}

/// How texels are chosen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VplSampler {
    /// A regular pattern over the maps, shuffled by a fixed permutation.
    #[default]
    Regular,
    /// A Hammersley point set, shuffled by a fixed permutation.
    Hammersley,
    /// Halton points over light, column and row: a light's share of the VPLs is left to chance.
    Uniform,
    /// All texels.
    EveryTexel,
}

/// Density with which the `"hammersley"` sampler draws texels. A VPL where it is high carries less flux, so the mean is unchanged.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Importance {
    /// The same everywhere.
    #[default]
    None,
    /// Reflected flux times the share of it that stays in the scene, by horizons in the map: low on a roof under the sky.
    PassedFlux,
}

/// Reflection that VPLs stand for. Glossy VPLs need `gather.method = "stochastic"`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Reflection {
    /// Diffuse reflection alone.
    #[default]
    Diffuse,
    /// GGX reflection alone.
    Glossy,
    /// Both, as two VPLs a texel.
    Both,
}

impl Config {
    /// VPLs of the first bounce, where the reflective shadow map has so many layers.
    pub fn vpl_count(&self, layers: u32) -> u32 {
        match self.vpls.sampler {
            VplSampler::Regular | VplSampler::Hammersley | VplSampler::Uniform => self.vpls.count,
            VplSampler::EveryTexel => self.rsm.size[0].saturating_mul(self.rsm.size[1]).saturating_mul(layers),
        }
    }
}

impl VplsConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        if config.vpls.importance != Importance::None && config.vpls.sampler != VplSampler::Hammersley {
            return broken("vpls.importance", "only Hammersley's points are drawn by importance; take vpls.sampler = \"hammersley\"");
        }
        if config.vpls.reflection != Reflection::Diffuse && config.gather.method != GatherMethod::Stochastic {
            return broken(
                "vpls.reflection",
                "glossy virtual point lights are summed by stochastic culling alone; take gather.method = \"stochastic\"",
            );
        }
        Ok(())
    }

    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        (config.vpls.sampler == VplSampler::EveryTexel).then(|| Unused::new(&["vpls.count"], &["vpls.sampler"])).into_iter().collect()
    }
}
