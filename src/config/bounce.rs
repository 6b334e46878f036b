//! `[bounce]`.

use super::unused::Unused;
use super::{Config, VisibilityMethod};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Further bounces: VPLs are put into clusters, and samples of what each cluster sees are the VPLs of the next bounce.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BounceConfig {
    /// Bounces of indirect light. 1 is the light of the reflective shadow maps' VPLs alone.
    #[schemars(range(min = 1, max = 8))]
    pub count: u32,
    /// VPLs of each bounce after the first, in all.
    #[schemars(range(min = 1, max = 65_536))]
    pub vpls: u32,
    pub pattern: Pattern,
    pub shares: Shares,
    pub visibility: BounceVisibility,
    pub clusters: ClustersConfig,
}

impl Default for BounceConfig {
    fn default() -> Self {
        Self {
            count: 1,
            vpls: 256,
            pattern: Pattern::Disk,
            shares: Shares::Equal,
            visibility: BounceVisibility::None,
            clusters: ClustersConfig::default(),
        }
    }
}

/// Clusters of VPLs, each with a paraboloid map of what it sees: for further bounces, and for `visibility.method = "clusters"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ClustersConfig {
    /// Clusters of a bounce's VPLs.
    #[schemars(range(min = 1, max = 64))]
    pub count: u32,
    pub representative: Representative,
    pub centers: Centers,
    /// Rounds of k-means per frame. The first frame goes on until nothing changes.
    #[schemars(range(min = 1, max = 64))]
    pub rounds: u32,
    /// Weight of the distance between a VPL and its cluster in k-means. Distances are in units of the scene's diagonal.
    #[schemars(range(min = 0, max = 1000))]
    pub position_weight: f32,
    /// Weight of 1 - cos of the angle between their normals in k-means.
    #[schemars(range(min = 0, max = 1000))]
    pub normal_weight: f32,
    /// Side of a cluster's map, texels.
    #[schemars(extend("enum" = [64, 128, 256, 512, 1024]))]
    pub map_size: u32,
    pub layers: Layers,
}

impl Default for ClustersConfig {
    fn default() -> Self {
        Self {
            count: 8,
            representative: Representative::NearestMember,
            centers: Centers::Kept,
            rounds: 5,
            position_weight: 0.6,
            normal_weight: 0.4,
            map_size: 256,
            layers: Layers::Instanced,
        }
    }
}

/// Place that a cluster's map is rendered from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Representative {
    /// The VPL nearest to the cluster's mean.
    #[default]
    NearestMember,
    /// The mean itself, which may float in the air or lie in a wall.
    Mean,
}

/// Centres that k-means starts from in a frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Centers {
    /// Those of the frame before.
    #[default]
    Kept,
    /// New ones in every frame.
    Reseeded,
}

/// How the maps of all clusters are filled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Layers {
    /// A geometry shader sends each triangle to every map.
    GeometryShader,
    /// One instance of the scene per map, which the vertex shader sends there.
    #[default]
    Instanced,
    /// One pass per map.
    PerLayer,
}

/// Where the next bounce's samples lie in a cluster's map.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Pattern {
    /// Evenly over the paraboloid's disk.
    #[default]
    Disk,
    /// Evenly over the square around the disk, whose corners are empty.
    Box,
}

/// How `bounce.vpls` are shared out among clusters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Shares {
    /// Equally.
    #[default]
    Equal,
    /// In proportion to the flux that each sends on, and at least one.
    Flux,
}

/// How the VPLs of further bounces are shadowed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BounceVisibility {
    /// Not at all: their light passes through walls.
    #[default]
    None,
    /// By a ray for each pair of pixel and VPL: exact.
    RayTraced,
    /// By imperfect shadow maps, as set in `[visibility.ism]`.
    ImperfectShadowMaps,
}

impl BounceConfig {
    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        let single = config.bounce.count == 1;
        let without_clusters = single && config.visibility.method != VisibilityMethod::Clusters;
        [
            single.then(|| Unused::new(&["bounce.vpls", "bounce.pattern", "bounce.shares", "bounce.visibility"], &["bounce.count"])),
            without_clusters.then(|| Unused::new(&["bounce.clusters"], &["bounce.count", "visibility.method"])),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
