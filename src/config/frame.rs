//! `[frame]`.

use super::values::Size;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Pictures: how many, of which size, and how their passes are timed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FrameConfig {
    /// Width and height of the picture, pixels.
    #[schemars(with = "Size<16_384>")]
    pub size: [u32; 2],
    /// Frames that are measured. The last one is the picture.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub count: u32,
    /// Frames before them that are not measured. They show frame 0.
    #[schemars(range(max = 1_000_000))]
    pub warmup: u32,
    /// Frames per second of animation. Frame i shows the second i / `fps`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub fps: f32,
    /// Seed of all random numbers: a reference's paths, the points that VPLs are sampled at, the points of imperfect shadow maps, the start of
    /// k-means, Russian roulette. 0 leaves patterns of points as their papers have them; another seed rotates them.
    pub seed: u32,
    pub timing: TimingMode,
}

impl Default for FrameConfig {
    fn default() -> Self {
        Self { size: [960, 540], count: 5, warmup: 2, fps: 30.0, seed: 0, timing: TimingMode::Isolated }
    }
}

/// How passes are timed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TimingMode {
    /// A full barrier around each pass: the passes' times sum to the frame's.
    #[default]
    Isolated,
    /// Only the barriers that hazards need: passes may overlap.
    Overlapped,
    /// One submission a pass, timed by the host's clock: a cross-check.
    Serial,
}
