//! `[gather]`.

use super::rules::{Broken, broken};
use super::{Config, VisibilityMethod};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Gathering: how the light of VPLs is summed at the pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GatherConfig {
    pub method: GatherMethod,
    /// Side of the block of pixels that share out the VPLs: each pixel sums one of `interleave`^2 subsets.
    #[schemars(extend("enum" = [1, 2, 4, 8]))]
    pub interleave: u32,
    pub culling: Culling,
    pub bounds: Bounds,
    pub rasterization: Rasterization,
    /// Nodes that the light lists of conservative clusters have room for, 8 bytes each. Nodes beyond are lost, and counted.
    // At most half of the paper's 256 MB, which is as large as every driver lets a buffer be.
    #[schemars(range(min = 1, max = 16_777_216))]
    pub nodes: u32,
    /// Irradiance E = I(w)/d^2 of a surface that faces the VPL, W/m^2, below which Russian roulette decides: the VPL is kept with
    /// probability p = E / `delta` and weighted by 1/p, so the mean is unchanged.
    #[schemars(range(max = 1_000_000), extend("exclusiveMinimum" = 0))]
    pub delta: f32,
    pub roulette: RouletteChoice,
    /// Counts the VPLs on a pixel's light lists and those that shine there. `--dump gather/statistics` pictures them.
    pub statistics: bool,
    pub receiver: Receiver,
    pub emitters: Emitters,
    /// Distance d_min below which a VPL gets no brighter, metres. 0 turns the bound off.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub min_distance: f32,
}

impl Default for GatherConfig {
    fn default() -> Self {
        Self {
            method: GatherMethod::PerPixel,
            interleave: 4,
            culling: Culling::Tiled,
            bounds: Bounds::Ellipsoid,
            rasterization: Rasterization::Automatic,
            nodes: 1 << 24,
            delta: 0.001,
            roulette: RouletteChoice::Fixed,
            statistics: false,
            receiver: Receiver::Diffuse,
            emitters: Emitters::Points,
            min_distance: 0.3,
        }
    }
}

/// How the light of VPLs is summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GatherMethod {
    /// Every pixel sums every VPL of its subset.
    #[default]
    PerPixel,
}

/// How VPLs that cannot shine on pixels are left out. The first three leave the picture as it is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Culling {
    /// Not at all.
    None,
    /// By what a workgroup's pixels span, in the gather itself.
    #[default]
    Tiled,
    /// By light lists of froxels: tiles of 128 pixels and 16 slices of depth.
    Clustered,
    /// By random ranges, tested for tiles of pixels of a subset.
    StochasticTiled,
    /// By random ranges. Each range's hull, 80 triangles, is rasterized and its light blended in (Dachsbacher and Stamminger 2006).
    Splatting,
    /// By random ranges and light lists of froxels, tiles of 16 pixels of a subset and 32 slices of depth. Hulls of 20 triangles are
    /// conservatively rasterized into them.
    ConservativeClusters,
}

impl Culling {
    /// Whether it leaves lights to chance.
    pub fn is_stochastic(self) -> bool {
        match self {
            Self::StochasticTiled | Self::Splatting | Self::ConservativeClusters => true,
            Self::None | Self::Tiled | Self::Clustered => false,
        }
    }
}

/// Bounds of a glossy VPL's random range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bounds {
    /// The spheroid of its lobe.
    #[default]
    Ellipsoid,
    /// A sphere around that spheroid.
    SphereEllipsoid,
    /// A sphere around the VPL.
    SphereVpl,
    /// No bounds: every tile lists every VPL, diffuse ones too.
    None,
}

/// How the tiles are found that a hull touches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Rasterization {
    /// By the extension where the device has it, else by the geometry shader.
    #[default]
    Automatic,
    /// By VK_EXT_conservative_rasterization.
    Extension,
    /// By a geometry shader that enlarges each triangle.
    GeometryShader,
}

impl Rasterization {
    /// The way taken on a device that has the extension or not.
    pub fn resolved(self, has_extension: bool) -> Self {
        match self {
            Self::Automatic if has_extension => Self::Extension,
            Self::Automatic => Self::GeometryShader,
            chosen => chosen,
        }
    }
}

/// Random numbers of Russian roulette.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RouletteChoice {
    /// The same in every frame.
    #[default]
    Fixed,
    /// New ones in every frame.
    PerFrame,
    /// None: light below `delta` is lost, as where ranges are clamped. The picture is too dark, and serves to be compared with.
    None,
}

/// Reflection of indirect light by what the camera sees. `"ggx"` needs stochastic tiles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Receiver {
    /// Diffuse reflection alone.
    #[default]
    Diffuse,
    /// GGX reflection too.
    Ggx,
}

/// Shape of VPLs, as surfaces nearby see it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Emitters {
    /// Points.
    #[default]
    Points,
    /// Disks that overlap their neighbours, so that the light of few VPLs is even: the fewer VPLs, the larger the disks. Light of a part that
    /// a wall cuts off comes from the rest.
    Disks,
}

impl GatherConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let gather = &config.gather;
        if matches!(gather.culling, Culling::Splatting | Culling::ConservativeClusters) {
            if config.visibility_methods().any(|method| method != VisibilityMethod::None) {
                return broken(
                    "gather.culling",
                    "splats and conservative clusters are there to be timed, and have no shadows; take visibility.method = \"none\"",
                );
            }
            if gather.statistics && gather.culling == Culling::Splatting {
                return broken("gather.statistics", "splats are on no list to be counted; take another gather.culling");
            }
            if gather.bounds == Bounds::None {
                return broken("gather.bounds", "\"none\" leaves nothing to draw; take another, or gather.culling = \"stochastic-tiled\"");
            }
        }
        if gather.receiver == Receiver::Ggx && gather.culling != Culling::StochasticTiled {
            return broken(
                "gather.receiver",
                "receivers are glossy with stochastic tiles alone; take gather.culling = \"stochastic-tiled\"",
            );
        }
        if gather.culling.is_stochastic() && gather.emitters == Emitters::Disks {
            return broken("gather.emitters", "stochastic culling bounds the range of points, not of disks; take emitters = \"points\"");
        }
        Ok(())
    }
}
