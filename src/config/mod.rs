//! What a run does: a TOML file, as typed data with a default for every key.
//!
//! One section a slot of the frame. Paths, enums and ranges are checked when a file is loaded; whoever builds a [`Config`]
//! in code keeps the ranges that the fields name.

pub(crate) mod check;
mod keys;
mod load;
mod rules;
mod scene;
mod stages;
pub(crate) mod tree;

pub use check::nearest;
pub use keys::{KeyInfo, Kind, Range, choices, keys, markdown_table};
pub(crate) use load::{Base, document, read_text};
pub use load::{load, parse, to_toml};
pub use scene::{Builtin, CameraConfig, CameraKeyframe, Interpolation, LightConfig, LightKeyframe, SceneConfig, SceneSelector};
pub use stages::{
    BounceConfig, BounceVisibility, Bounds, BoxConfig, Centers, Collect, ComposeConfig, Culling, Dielectric, DirectConfig, Emitters,
    FilterConfig, FilterKind, FrameConfig, GatherConfig, GatherMethod, Importance, IsmRenderer, Layer, Layers, Lookup, MaterialsConfig,
    OutputConfig, Pattern, PointSet, Rasterization, Receiver, Reflection, Representative, RouletteChoice, RsmConfig, Shadows, Shares,
    SsaoConfig, SsaoMethod, SsaoResolution, TimingMode, Tonemap, VisibilityConfig, VisibilityMethod, VplSampler, VplsConfig,
};

use serde::{Deserialize, Serialize};

/// Everything that a run is told. [`Config::default`] renders the built-in atrium.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    pub scene: SceneConfig,
    /// The view; without it the scene's first camera, or one that frames the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraConfig>,
    /// Replace the scene's own lights if there are any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub light: Vec<LightConfig>,
    pub frame: FrameConfig,
    pub materials: MaterialsConfig,
    pub rsm: RsmConfig,
    pub vpls: VplsConfig,
    pub bounce: BounceConfig,
    pub visibility: VisibilityConfig,
    pub gather: GatherConfig,
    pub filter: FilterConfig,
    pub direct: DirectConfig,
    pub ssao: SsaoConfig,
    pub compose: ComposeConfig,
    pub output: OutputConfig,
}

impl Config {
    /// How many imperfect shadow maps the first virtual point lights share, where they do.
    pub fn shared_maps(&self) -> Option<u32> {
        let shared = self.visibility.method == VisibilityMethod::ImperfectShadowMaps && self.vpls.sampler == VplSampler::EveryTexel;
        shared.then_some(self.visibility.shared_maps)
    }

    /// Virtual point lights of the first bounce, where the reflective shadow map has so many layers.
    pub fn vpl_count(&self, layers: u32) -> u32 {
        match self.vpls.sampler {
            VplSampler::Regular | VplSampler::Hammersley => self.vpls.count,
            VplSampler::EveryTexel => self.rsm.size[0].saturating_mul(self.rsm.size[1]).saturating_mul(layers),
        }
    }

    /// How the virtual point lights of the first bounce are shadowed, and those of further ones.
    pub fn visibility_of_bounces(&self) -> [VisibilityMethod; 2] {
        let further = match self.bounce.visibility {
            BounceVisibility::None => VisibilityMethod::None,
            BounceVisibility::RayTraced => VisibilityMethod::RayTraced,
            BounceVisibility::ImperfectShadowMaps => VisibilityMethod::ImperfectShadowMaps,
        };
        [self.visibility.method, further]
    }

    /// How the virtual point lights of each bounce are shadowed.
    pub fn visibility_methods(&self) -> impl Iterator<Item = VisibilityMethod> {
        let [first, further] = self.visibility_of_bounces();
        std::iter::once(first).chain(std::iter::repeat_n(further, self.bounce.count as usize - 1))
    }
}
