//! The config of a run: a TOML file as typed data, with a default for every key.
//!
//! Each slot of the frame has a file. Its types declare default, range, meaning and choices of each key; beside them stand the rules between
//! keys, and the keys that a choice leaves unused. Loading checks files by these. A [`Config`] built in code must keep the fields' ranges.

mod bounce;
mod camera;
pub(crate) mod check;
mod compose;
mod direct;
mod filter;
mod frame;
mod gather;
mod keys;
mod light;
mod load;
mod materials;
mod output;
mod overrides;
mod renamed;
mod rsm;
mod rules;
mod scene;
mod schema;
mod sky;
mod ssao;
pub(crate) mod tree;
mod unused;
mod values;
mod visibility;
mod vpls;

pub use bounce::*;
pub use camera::{CameraConfig, CameraKeyframe, Interpolation};
pub use check::nearest;
pub use compose::*;
pub use direct::*;
pub use filter::*;
pub use frame::*;
pub use gather::*;
pub use keys::{Choice, KeyInfo, Kind, Range, choices, keys, markdown};
pub use light::{LightConfig, LightKeyframe};
pub(crate) use load::{Base, document, read_text};
pub use load::{Loaded, load, parse, parse_preset, to_toml};
pub use materials::*;
pub use output::*;
pub use rsm::*;
pub use scene::{Builtin, SceneConfig, SceneSelector};
pub use schema::schema;
pub use sky::*;
pub use ssao::*;
pub use unused::is_unused;
pub use values::Block;
pub use visibility::*;
pub use vpls::*;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// All settings of a run. [`Config::default`] renders the built-in atrium.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    pub scene: SceneConfig,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraConfig>,
    /// Lights, one `[[light]]` table each. They replace the scene's own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("x-default" = "the scene's own lights"))]
    pub light: Vec<LightConfig>,
    pub frame: FrameConfig,
    pub materials: MaterialsConfig,
    pub rsm: RsmConfig,
    pub vpls: VplsConfig,
    pub bounce: BounceConfig,
    pub visibility: VisibilityConfig,
    pub gather: GatherConfig,
    pub filter: FilterConfig,
    pub sky: SkyConfig,
    pub direct: DirectConfig,
    pub ssao: SsaoConfig,
    pub compose: ComposeConfig,
    pub output: OutputConfig,
}
