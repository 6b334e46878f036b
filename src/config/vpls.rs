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
    pub numbers: Numbers,
    pub view_importance: ViewImportanceConfig,
    pub inverse_transform: InverseTransformConfig,
    pub metropolis_hastings: MetropolisHastingsConfig,
}

impl Default for VplsConfig {
    fn default() -> Self {
        Self {
            sampler: VplSampler::Regular,
            count: 1024,
            importance: Importance::None,
            reflection: Reflection::Diffuse,
            numbers: Numbers::Halton,
            view_importance: ViewImportanceConfig::default(),
            inverse_transform: InverseTransformConfig::default(),
            metropolis_hastings: MetropolisHastingsConfig::default(),
        }
    }
}

/// The importance `"view"` (Barák, Bittner and Havran 2013, section 4.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ViewImportanceConfig {
    /// View samples: surfaces at pixels of the picture, to which texels are held. A pixel without a surface is not replaced.
    #[schemars(range(min = 1, max = 16_384))]
    pub samples: u32,
    /// Distance below which a view sample finds a texel no more important, metres. 0 turns the bound off, as in the paper.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1_000_000), extend("x-default" = "`gather.min_distance`"))]
    pub min_distance: Option<f32>,
    /// Approximate share of the VPLs that are drawn by power, whether a view sample needs them or not. Without it, light of texels that no
    /// view sample needs is lost, and texels that matter only to pixels between the samples become few VPLs that are far too bright. 0.1 is a
    /// good value; the paper has 0.
    #[schemars(range(min = 0, max = 0.99))]
    pub defensive: f32,
    pub light: ViewLight,
}

/// Light by which a texel is important to the view.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ViewLight {
    /// The light that view samples reflect to the camera (Barák, Bittner and Havran 2013, equations 1 and 2).
    #[default]
    Reflected,
    /// The light that arrives at view samples, whatever their material (Bischoff, Schwandt and Broll 2017, equations 10 and 11).
    Arriving,
}

impl Default for ViewImportanceConfig {
    fn default() -> Self {
        Self { samples: 256, min_distance: None, defensive: 0.0, light: ViewLight::Reflected }
    }
}

/// The sampler `"inverse-transform"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct InverseTransformConfig {
    /// Numbers of a point: 3 for light, row and column, or 2. Then the number that selects the light, stretched to the unit interval again,
    /// selects the row too.
    #[schemars(extend("enum" = [2, 3]))]
    pub dimensions: u32,
    pub scan: Scan,
}

impl Default for InverseTransformConfig {
    fn default() -> Self {
        Self { dimensions: 3, scan: Scan::Blocked }
    }
}

/// How running sums of importance are made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scan {
    /// By a workgroup a row, in one pass; no sum is less than the one before it.
    #[default]
    Blocked,
    /// By steps over all texels, which double what each has summed (Hensley et al. 2005): a pass a step. Rounding lets some sums fall, so that
    /// texels without importance become dark VPLs.
    Doubling,
}

/// The sampler `"metropolis-hastings"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MetropolisHastingsConfig {
    /// Texels that a chain proposes, the first one included. With 1 the sampler is `"uniform"`, unless `weights = "none"`.
    #[schemars(range(min = 1, max = 1024))]
    pub steps: u32,
    pub weights: Weights,
    pub acceptance: Acceptance,
    pub evaluate: Evaluate,
}

impl Default for MetropolisHastingsConfig {
    fn default() -> Self {
        Self { steps: 5, weights: Weights::Mean, acceptance: Acceptance::Metropolis, evaluate: Evaluate::Proposals }
    }
}

/// Weight of a chain's VPL, which is divided by the importance of its texel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Weights {
    /// The mean importance of the chain's proposals, as in the paper. It is biased where importance is not in proportion to light, by a
    /// few percent a pixel, unless `acceptance = "reservoir"`.
    #[default]
    Mean,
    /// The importance of the chain's first proposal (Veach and Guibas 1997). It is unbiased where numbers are independent, and varies more.
    Single,
    /// The mean importance of all texels, for all chains. It is biased until the chains are long. It works out the importance of all texels.
    None,
}

/// When a chain accepts a proposal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Acceptance {
    /// With the ratio of its importance to that of the texel that the chain is at, as in the paper.
    #[default]
    Metropolis,
    /// With its share of the importance of all proposals so far. The last texel is then one of all proposals, drawn by importance, and
    /// the weight `"mean"` is unbiased for every number of steps, if the numbers of a chain are independent. Not in the paper.
    Reservoir,
}

/// For which texels importance is worked out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Evaluate {
    /// For the proposals alone.
    #[default]
    Proposals,
    /// For all texels: a map that the chains look up. The VPLs are the same, but for rounding.
    Map,
}

/// Numbers of the samplers `"uniform"`, `"inverse-transform"` and `"metropolis-hastings"`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Numbers {
    /// Halton points, as in the paper. A seed goes on where another ends. A chain's steps are correlated.
    #[default]
    Halton,
    /// Halton points, rotated anew for each step of the chains, so that steps are independent.
    ShiftedHalton,
    /// Independent random numbers.
    Random,
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
    /// Points over light, column and row: a light's share of the VPLs is left to chance.
    Uniform,
    /// Texels by importance, by three searches in its running sums: for the light, the row and the column.
    InverseTransform,
    /// A Markov chain a VPL, which accepts texels by importance. VPLs move less from frame to frame than with `"inverse-transform"`.
    MetropolisHastings,
    /// All texels.
    EveryTexel,
}

/// Density with which texels are drawn. A VPL where it is high carries less flux, so the mean is unchanged.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Importance {
    /// The same everywhere.
    #[default]
    None,
    /// Reflected flux times the share of it that stays in the scene, by horizons in the map: low on a roof under the sky. For the sampler
    /// `"hammersley"`.
    PassedFlux,
    /// Light that the camera would see of it, without shadows, by samples of the picture. For all samplers but `"uniform"` and
    /// `"every-texel"`.
    View,
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
            VplSampler::Regular
            | VplSampler::Hammersley
            | VplSampler::Uniform
            | VplSampler::InverseTransform
            | VplSampler::MetropolisHastings => self.vpls.count,
            VplSampler::EveryTexel => self.rsm.size[0].saturating_mul(self.rsm.size[1]).saturating_mul(layers),
        }
    }
}

impl VplsConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let vpls = &config.vpls;
        if vpls.importance == Importance::PassedFlux && vpls.sampler != VplSampler::Hammersley {
            return broken("vpls.importance", "\"passed-flux\" goes with Hammersley's points alone; take vpls.sampler = \"hammersley\"");
        }
        if vpls.importance != Importance::None && matches!(vpls.sampler, VplSampler::Uniform | VplSampler::EveryTexel) {
            let message = "this sampler draws all texels alike; take importance = \"none\", or another vpls.sampler";
            return broken("vpls.importance", message);
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
        use VplSampler::{EveryTexel, InverseTransform, MetropolisHastings, Uniform};
        let vpls = &config.vpls;
        let by_points = matches!(vpls.sampler, Uniform | InverseTransform | MetropolisHastings);
        let by_view = vpls.importance == Importance::View;
        let lazily = vpls.sampler == MetropolisHastings && vpls.metropolis_hastings.weights != Weights::None;
        [
            (vpls.sampler == EveryTexel).then(|| Unused::new(&["vpls.count"], &["vpls.sampler"])),
            (!by_points).then(|| Unused::new(&["vpls.numbers"], &["vpls.sampler"])),
            (!by_view).then(|| Unused::new(&["vpls.view_importance"], &["vpls.importance"])),
            (vpls.sampler != InverseTransform).then(|| Unused::new(&["vpls.inverse_transform"], &["vpls.sampler"])),
            (vpls.sampler != MetropolisHastings).then(|| Unused::new(&["vpls.metropolis_hastings"], &["vpls.sampler"])),
            (vpls.sampler == MetropolisHastings && !lazily)
                .then(|| Unused::new(&["vpls.metropolis_hastings.evaluate"], &["vpls.metropolis_hastings.weights"])),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
