//! `[visibility]`.

use super::rules::{Broken, broken};
use super::unused::Unused;
use super::{BounceVisibility, Config, SkyVisibility, StochasticCulling, VplSampler};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Shadows of VPLs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct VisibilityConfig {
    pub method: VisibilityMethod,
    /// Distance behind a map's surface that is still lit, in units of what the map resolves there.
    #[schemars(range(min = 0, max = 64))]
    pub bias: f32,
    pub lookup: Lookup,
    pub ism: IsmConfig,
}

impl Default for VisibilityConfig {
    fn default() -> Self {
        Self { method: VisibilityMethod::None, bias: 0.75, lookup: Lookup::Bilinear, ism: IsmConfig::default() }
    }
}

/// Imperfect shadow maps: small paraboloid maps of points that the scene's triangles are turned into.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct IsmConfig {
    pub renderer: IsmRenderer,
    pub collect: Collect,
    pub points: PointSet,
    /// Points of the scene's surfaces, about; `visibility/made-points` is their number. Points in the holes of masked surfaces are among them,
    /// and are left out of the maps.
    #[schemars(range(min = 1, max = 67_108_864))]
    pub point_count: u32,
    /// Leaves out small triangles at random, so that every point stands for the same area. Otherwise every triangle has a point at least.
    pub thin: bool,
    /// Points that a map's partition has room for. Points beyond are dropped, and counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 1_048_576), extend("x-default" = "from the number of points"))]
    pub capacity: Option<u32>,
    /// Side of a map, texels.
    #[schemars(extend("enum" = [16, 32, 64, 128, 256]))]
    pub map_size: u32,
    /// Maps that each point is considered for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 32), extend("x-default" = "16, 1 for splats"))]
    pub considered: Option<u32>,
    /// Maps that each point is drawn into, at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 16), extend("x-default" = "4, 1 for splats"))]
    pub collected: Option<u32>,
    /// Scales points by the distortion of the paraboloid projection.
    pub distortion: bool,
    /// Keeps points, and what pull and push make of them, inside their own map.
    pub clamp: bool,
    /// Factor of the points' radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(max = 16), extend("exclusiveMinimum" = 0, "x-default" = "1, 1.1 if adaptive, 1.25 with normals, 0.9 for splats; 1.5 of a sky, 1.3 for splats"))]
    pub enlarge: Option<f32>,
    /// Limits a point's size by its normal.
    pub normals: bool,
    pub splat_depth: SplatDepth,
    /// Side of a splat, texels, at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 256), extend("x-default" = "that of a map"))]
    pub largest_splat: Option<u32>,
    /// Imperfect shadow maps that the VPLs of `"every-texel"` share, at most. Neighbouring VPLs see nearly the same.
    #[schemars(range(min = 1, max = 65_536))]
    pub shared_maps: u32,
    pub pull_push: PullPushConfig,
}

impl Default for IsmConfig {
    fn default() -> Self {
        Self {
            renderer: IsmRenderer::SinglePixel,
            collect: Collect::Compute,
            points: PointSet::Uniform,
            point_count: 326_000,
            thin: false,
            capacity: None,
            map_size: 64,
            considered: None,
            collected: None,
            distortion: true,
            clamp: true,
            enlarge: None,
            normals: false,
            splat_depth: SplatDepth::Center,
            largest_splat: None,
            shared_maps: 1024,
            pull_push: PullPushConfig::default(),
        }
    }
}

/// What fills the holes between single pixels (Marroquim et al. 2007). The thesis of Linke has `grow = 0`, `interval = 1` and `spread = 0`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PullPushConfig {
    pub weights: PullWeights,
    /// Radius added to a point's in quadrature, texels. A point's place within its texel is not known.
    #[schemars(range(min = 0, max = 4))]
    pub grow: f32,
    /// Depth behind a point that counts as its surface, in diameters of the point in the world. It is one without `distortion`,
    /// and of no use with `normals` and for a sky.
    #[schemars(range(min = 0, max = 16))]
    pub interval: f32,
    /// Share of the points' variance about their middle that a pull adds to their squared radius. Points that lie apart then leave no hole.
    #[schemars(range(min = 0, max = 4))]
    pub spread: f32,
}

impl Default for PullPushConfig {
    fn default() -> Self {
        Self { weights: PullWeights::Even, grow: 0.75, interval: 1.5, spread: 1.0 }
    }
}

/// Weights of the texels that a pull or push averages.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PullWeights {
    /// By the texels' places: equal in a pull, bilinear in a push.
    #[default]
    Even,
    /// By the distance of the points' places from the texel that is written, as a Gaussian of half a texel of the coarser level (after
    /// Marroquim et al. 2008, which the thesis names and leaves out).
    Gaussian,
}

/// How VPLs are shadowed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum VisibilityMethod {
    /// Not at all: indirect light passes through walls.
    #[default]
    None,
    /// By a ray for each pair of pixel and VPL: exact.
    RayTraced,
    /// By imperfect shadow maps: one small paraboloid map of points per VPL (Ritschel et al. 2008).
    ImperfectShadowMaps,
    /// By one paraboloid map per cluster of VPLs, as set in `[bounce.clusters]`.
    Clusters,
}

/// Comparison of receivers with imperfect shadow maps and clusters' maps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Lookup {
    /// One texel.
    Nearest,
    /// Four texels around, bilinear (percentage-closer filtering).
    #[default]
    Bilinear,
}

/// How points get into imperfect shadow maps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum IsmRenderer {
    /// As single texels. Pull and push fill the holes between them.
    #[default]
    SinglePixel,
    /// As squares of their size.
    Splat,
}

/// How triangles are turned into points. Splats come from the tessellator unless points are stored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Collect {
    /// By a compute pass.
    #[default]
    Compute,
    /// By the tessellator.
    Tessellation,
    /// Once, when the scene is brought to the device: exactly `point_count` places in triangles, which move with these.
    Stored,
}

/// Depth of a splat.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SplatDepth {
    /// That of its middle: a square that faces the VPL.
    #[default]
    Center,
    /// That of its point's plane, in each texel (Linke 2016, section 5.4.1).
    Plane,
}

/// Which points a map gets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PointSet {
    /// Random ones, by area.
    #[default]
    Uniform,
    /// By the solid angle under which its VPL sees them: more of those nearby.
    Adaptive,
}

impl Config {
    /// How many imperfect shadow maps the VPLs of every texel share, where they do.
    pub fn shared_maps(&self) -> Option<u32> {
        let shared = self.visibility.method == VisibilityMethod::ImperfectShadowMaps && self.vpls.sampler == VplSampler::EveryTexel;
        shared.then_some(self.visibility.ism.shared_maps)
    }

    /// How the VPLs of the first bounce are shadowed, and those of further ones.
    pub fn visibility_of_bounces(&self) -> [VisibilityMethod; 2] {
        let further = match self.bounce.visibility {
            BounceVisibility::None => VisibilityMethod::None,
            BounceVisibility::RayTraced => VisibilityMethod::RayTraced,
            BounceVisibility::ImperfectShadowMaps => VisibilityMethod::ImperfectShadowMaps,
        };
        [self.visibility.method, further]
    }

    /// How the VPLs of each bounce are shadowed.
    pub fn visibility_methods(&self) -> impl Iterator<Item = VisibilityMethod> {
        let [first, further] = self.visibility_of_bounces();
        std::iter::once(first).chain(std::iter::repeat_n(further, self.bounce.count as usize - 1))
    }
}

impl VisibilityConfig {
    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let ism = &config.visibility.ism;
        let splat = ism.renderer == IsmRenderer::Splat;
        if ism.points == PointSet::Adaptive {
            if splat {
                return broken(
                    "visibility.ism.points",
                    "\"adaptive\" chooses from points that a buffer holds, and splats come from no buffer; take renderer = \"single-pixel\"",
                );
            }
            if ism.collect != Collect::Compute {
                return broken(
                    "visibility.ism.points",
                    "\"adaptive\" needs its points in the order of their triangles, which the tessellator and stored points do not have; take collect = \"compute\"",
                );
            }
        }
        if ism.normals && splat {
            return broken(
                "visibility.ism.normals",
                "are kept for what fills the holes between single pixels, and splats have none of it; take renderer = \"single-pixel\"",
            );
        }
        if let (Some(considered), Some(collected)) = (ism.considered, ism.collected)
            && collected > considered
        {
            return broken(
                "visibility.ism.collected",
                format!(
                    "{collected} is over visibility.ism.considered, {considered}: a point is drawn into maps that it was considered for"
                ),
            );
        }
        if config.shared_maps().is_some() && config.gather.stochastic_culling() != Some(StochasticCulling::Tiled) {
            return broken(
                "visibility.method",
                "imperfect shadow maps are shared with stochastic tiles alone; take gather.method = \"stochastic\" with gather.stochastic.culling = \"tiled\", or another vpls.sampler",
            );
        }
        Ok(())
    }

    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        let further = if config.bounce.count == 1 { "bounce.count" } else { "bounce.visibility" };
        let all = || config.visibility_methods();
        let of_sky = config.sky_visibility() == Some(SkyVisibility::ImperfectShadowMaps);
        if of_sky || all().any(|method| method == VisibilityMethod::ImperfectShadowMaps) {
            let alone =
                if config.visibility.method == VisibilityMethod::ImperfectShadowMaps { "vpls.sampler" } else { "visibility.method" };
            let unshared = || Unused::new(&["visibility.ism.shared_maps"], &[alone]);
            let mut unused: Vec<Unused> = config.shared_maps().is_none().then(unshared).into_iter().collect();
            let ism = &config.visibility.ism;
            let of_vpls = all().any(|method| method == VisibilityMethod::ImperfectShadowMaps);
            if ism.renderer == IsmRenderer::Splat {
                unused.push(Unused::new(&["visibility.ism.pull_push"], &["visibility.ism.renderer"]));
            } else {
                unused.push(Unused::new(&["visibility.ism.splat_depth", "visibility.ism.largest_splat"], &["visibility.ism.renderer"]));
                // Points with normals have ellipses and their planes' depths, and those of a sky's maps an interval of their own.
                if !of_vpls || ism.normals || !ism.distortion {
                    let because: &[&'static str] = if !of_vpls {
                        &["visibility.method"]
                    } else if ism.normals {
                        &["visibility.ism.normals"]
                    } else {
                        &["visibility.ism.distortion"]
                    };
                    unused.push(Unused::new(&["visibility.ism.pull_push.interval"], because));
                }
                if ism.normals && !of_sky {
                    unused.push(Unused::new(&["visibility.ism.pull_push.spread"], &["visibility.ism.normals"]));
                }
            }
            if config.visibility.ism.collect == Collect::Stored {
                // Their number is known, and so is each partition's.
                unused.push(Unused::new(&["visibility.ism.capacity"], &["visibility.ism.collect"]));
            }
            return unused;
        }
        let mut keys = vec!["visibility.ism"];
        if all().all(|method| method != VisibilityMethod::Clusters) {
            keys.extend(["visibility.bias", "visibility.lookup"]);
        }
        vec![Unused::new(&keys, &["visibility.method", further])]
    }
}
