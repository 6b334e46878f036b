//! `[gather]`.

use super::rules::{Broken, broken};
use super::unused::Unused;
use super::values::Block;
use super::{Config, FilterKind, VisibilityMethod};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Gathering: how the light of VPLs is summed at the pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GatherConfig {
    pub method: GatherMethod,
    /// Block of pixels that share out the VPLs: its side, or its width and height as in `[4, 2]`. Each pixel of a block sums another subset
    /// of the VPLs.
    pub interleave: Block,
    /// Distance d_min below which a VPL gets no brighter, metres. 0 turns the bound off.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub min_distance: f32,
    pub per_pixel: PerPixelConfig,
    pub stochastic: StochasticConfig,
    pub conservative_clusters: ConservativeClustersConfig,
    pub light_caches: LightCachesConfig,
}

impl Default for GatherConfig {
    fn default() -> Self {
        Self {
            method: GatherMethod::PerPixel,
            interleave: Block([4, 4]),
            min_distance: 0.3,
            per_pixel: PerPixelConfig::default(),
            stochastic: StochasticConfig::default(),
            conservative_clusters: ConservativeClustersConfig::default(),
            light_caches: LightCachesConfig::default(),
        }
    }
}

/// How the light of VPLs is summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum GatherMethod {
    /// Every pixel sums every VPL of its subset that can shine on it.
    #[default]
    PerPixel,
    /// Every VPL has a random range, beyond which Russian roulette has decided against it (Tokuyoshi and Harada 2017).
    Stochastic,
    /// All VPLs, as area lights, shine on sparse caches on the models, and pixels interpolate between these (Bischoff, Schwandt and Broll
    /// 2017). Each bounce's VPLs shine on them. Caches have shadows of their own: `gather.light_caches.occlusion`.
    LightCaches,
}

/// The method `"per-pixel"`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PerPixelConfig {
    pub culling: Culling,
    pub tile: Tile,
    pub emitters: Emitters,
    /// Counts the VPLs on a pixel's light lists and those that shine there. `--dump gather/statistics` pictures them.
    pub statistics: bool,
}

/// The method `"stochastic"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StochasticConfig {
    pub culling: StochasticCulling,
    pub bounds: Bounds,
    /// Irradiance E = I(w)/d^2 of a surface that faces the VPL, W/m^2, below which Russian roulette decides: the VPL is kept with
    /// probability p = E / `delta` and weighted by 1/p, so the mean is unchanged.
    #[schemars(range(max = 1_000_000), extend("exclusiveMinimum" = 0))]
    pub delta: f32,
    pub roulette: RouletteChoice,
    /// Counts the VPLs on a pixel's light lists and those that shine there. `--dump gather/statistics` pictures them.
    pub statistics: bool,
    /// `"ggx"` needs the culling `"tiled"`.
    pub receiver: Receiver,
}

impl Default for StochasticConfig {
    fn default() -> Self {
        Self {
            culling: StochasticCulling::Tiled,
            bounds: Bounds::Ellipsoid,
            delta: 0.001,
            roulette: RouletteChoice::Fixed,
            statistics: false,
            receiver: Receiver::Diffuse,
        }
    }
}

/// The culling `"conservative-clusters"` of the method `"stochastic"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ConservativeClustersConfig {
    pub rasterization: Rasterization,
    /// Nodes that the light lists have room for, 8 bytes each. Nodes beyond are lost, and counted.
    // At most half of the paper's 256 MB, which is as large as every driver lets a buffer be.
    #[schemars(range(min = 1, max = 16_777_216))]
    pub nodes: u32,
}

impl Default for ConservativeClustersConfig {
    fn default() -> Self {
        Self { rasterization: Rasterization::Automatic, nodes: 1 << 24 }
    }
}

/// The method `"light-caches"`. `run.json` counts the caches (`light-caches/count`), those that no light reaches (`gather/dark-caches`), those
/// in the sphere of their own proxy light (`gather/caches-within`), and vertices around which no cache has weight, so that the nearest one
/// counts (`gather/lone-vertices`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LightCachesConfig {
    /// Distance d_eps between a cache and the surface that it stands for, at most, metres. Triangles' edges should be no longer:
    /// `scene.split`.
    #[schemars(range(min = 0.001, max = 10_000))]
    pub distance: f32,
    /// Angle theta_eps between the normals of a surface that one cache stands for and their middle, degrees, about. Surface that bends more
    /// has several caches.
    #[schemars(range(min = 1, max = 90))]
    pub angle_deg: f32,
    pub snapping: Snapping,
    pub occlusion: CacheOcclusion,
    pub proxy_weights: ProxyWeights,
    pub proxy_bound: ProxyBound,
    pub neighbour_weights: NeighbourWeights,
    /// `"ggx"` gives each cache a second proxy light, for the light that its surface reflects towards the camera. Lobes are cosine lobes about
    /// the mirror direction, and no narrower than that of roughness 0.2.
    pub receiver: Receiver,
    /// Draws the caches as disks in the light that reaches them, and their proxy lights as spots: `--dump gather/cache-viewer`.
    pub viewer: bool,
    pub double_projection: DoubleProjectionConfig,
}

impl Default for LightCachesConfig {
    fn default() -> Self {
        Self {
            distance: 1.0,
            angle_deg: 30.0,
            snapping: Snapping::default(),
            occlusion: CacheOcclusion::DoubleProjection,
            proxy_weights: ProxyWeights::FormFactor,
            proxy_bound: ProxyBound::Extent,
            neighbour_weights: NeighbourWeights::Distance,
            receiver: Receiver::Diffuse,
            viewer: false,
            double_projection: DoubleProjectionConfig::default(),
        }
    }
}

/// Where a cache is put on the surface that is averaged for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Snapping {
    /// At what is nearest to the middle. In a body of several layers, as a car with its seats or a tree's crown, that is inside, where no light
    /// arrives.
    Middle,
    /// At a place near the middle that little surface stands before. Not in the paper.
    #[default]
    Open,
}

/// The occlusion `"double-projection"`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DoubleProjectionConfig {
    pub before: Before,
    pub radius: ProxyRadius,
    pub sides: OccluderSides,
    pub occluders: Occluders,
}

/// Which caches are before a proxy light and shadow it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Before {
    /// Those that are nearer than its middle.
    #[default]
    Center,
    /// Those that are nearer than all of its sphere. A light whose sphere the cache is in has no shadow then, and that is most of the light of
    /// a street.
    Sphere,
}

/// Radius of a proxy light's sphere, from the largest standard deviation of its VALs' places along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProxyRadius {
    /// The standard deviation: half the side of the paper's box.
    #[default]
    Sigma,
    /// Twice the standard deviation: the side of the paper's box.
    TwoSigma,
}

/// Which sides of a cache's surface shadow proxy lights. Surfaces with two sides have caches on both, each of which shadows what is before it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OccluderSides {
    /// Both: sheets with one side stop light from behind, and closed bodies count twice.
    Both,
    /// The front: closed bodies count once, and sheets with one side let light through from behind. It is nearer to rays in the Cornell box,
    /// in a street and in Sponza.
    #[default]
    Front,
}

/// What a cache is to proxy lights that it shadows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Occluders {
    /// A disk of its surface's area. Leaves and reveals that stand apart become one sheet, as large as all of them.
    Areas,
    /// The silhouette of its surface, along its normal: what is spread over more than its area lets light through, and what stands behind each
    /// other counts once. Not in the paper.
    #[default]
    Silhouettes,
}

/// What gives a cache nearby its weight at a vertex, beside its normal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NeighbourWeights {
    /// Its distance (equation 8): caches behind a thin wall that face the same side count as well.
    #[default]
    Distance,
    /// Its distance, and the vertex's from its tangent plane, which is at most half of `distance` (after Ward, Rubinstein and Clear 1988). Not
    /// in the paper.
    TangentPlane,
}

/// How proxy lights are shadowed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CacheOcclusion {
    /// Not at all.
    None,
    /// By the other caches' disks and the proxy's sphere, projected to the unit disk around a cache and compared as squares.
    #[default]
    DoubleProjection,
    /// By a ray for each pair of a cache and a VAL: exact at the caches, and slow.
    RayTraced,
}

/// What draws a proxy light towards a VAL.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProxyWeights {
    /// Its form factor, as in the paper: dark VALs nearby draw as much as bright ones.
    #[default]
    FormFactor,
    /// The light that it gives the cache. Not in the paper.
    Flux,
}

/// What bounds a proxy light near its place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProxyBound {
    /// Its extent: squared distances grow by the variance of its VALs' places, and a part of it stands above a surface that its middle is
    /// behind. Diffuse light at the cache is the same. Glossy proxies off their lobe are bounded by the lobe's mean. Not in the paper.
    #[default]
    Extent,
    /// Nothing, as in the paper: surfaces that come close to a moved proxy are far too bright, and those that it is behind are black.
    None,
}

/// How VPLs that cannot shine on pixels are left out. The picture stays as it is.
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
}

/// Pixels of a sample set that the culling `"tiled"` bounds together, across and down. 4x4 interleaving has 16 times as many in the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Tile {
    /// 16x8: 64x32 pixels of the picture with 4x4 interleaving.
    #[default]
    #[serde(rename = "16x8")]
    Wide,
    /// 8x8: 32x32 pixels of the picture with 4x4 interleaving. Culls more, by workgroups of half as many invocations.
    #[serde(rename = "8x8")]
    Square,
}

/// How VPLs are left out whose random range does not reach pixels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StochasticCulling {
    /// By tiles of 16 x 16 pixels of a subset, in the gather itself.
    #[default]
    Tiled,
    /// By rasterizing each range's hull, 80 triangles, and blending its light in (Dachsbacher and Stamminger 2006). Has no shadows.
    Splatting,
    /// By light lists of froxels, tiles of 16 pixels of a subset and 32 slices of depth, into which hulls of 20 triangles are
    /// conservatively rasterized. Has no shadows.
    ConservativeClusters,
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

/// Reflection of indirect light by what the camera sees.
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
    /// Whether what the camera sees reflects indirect light as GGX says.
    pub fn has_glossy_receivers(&self) -> bool {
        match self.method {
            GatherMethod::PerPixel => false,
            GatherMethod::Stochastic => self.stochastic.receiver == Receiver::Ggx,
            GatherMethod::LightCaches => self.light_caches.receiver == Receiver::Ggx,
        }
    }

    /// The culling of the method `"stochastic"`, where that is the method.
    pub fn stochastic_culling(&self) -> Option<StochasticCulling> {
        match self.method {
            GatherMethod::PerPixel | GatherMethod::LightCaches => None,
            GatherMethod::Stochastic => Some(self.stochastic.culling),
        }
    }

    /// Keys that exclude or need each other.
    pub(super) fn rules(config: &Config) -> Result<(), Broken> {
        let (gather, stochastic) = (&config.gather, &config.gather.stochastic);
        let culling = gather.stochastic_culling();
        if matches!(culling, Some(StochasticCulling::Splatting | StochasticCulling::ConservativeClusters)) {
            if config.visibility_methods().any(|method| method != VisibilityMethod::None) {
                return broken(
                    "gather.stochastic.culling",
                    "splats and conservative clusters are there to be timed, and have no shadows; take visibility.method = \"none\"",
                );
            }
            if stochastic.statistics && culling == Some(StochasticCulling::Splatting) {
                let message = "splats are on no list to be counted; take another gather.stochastic.culling";
                return broken("gather.stochastic.statistics", message);
            }
            if stochastic.bounds == Bounds::None {
                let message = "\"none\" leaves nothing to draw; take another, or gather.stochastic.culling = \"tiled\"";
                return broken("gather.stochastic.bounds", message);
            }
        }
        if gather.method == GatherMethod::LightCaches && config.visibility_methods().any(|method| method != VisibilityMethod::None) {
            let message = "light caches have shadows of their own (gather.light_caches.occlusion); take visibility.method = \"none\"";
            return broken("gather.method", message);
        }
        if stochastic.receiver == Receiver::Ggx && culling != Some(StochasticCulling::Tiled) {
            return broken(
                "gather.stochastic.receiver",
                "receivers are glossy with stochastic tiles alone; take gather.method = \"stochastic\" and gather.stochastic.culling = \"tiled\"",
            );
        }
        if culling.is_some() && gather.per_pixel.emitters == Emitters::Disks {
            let message = "stochastic culling bounds the range of points, not of disks; take emitters = \"points\"";
            return broken("gather.per_pixel.emitters", message);
        }
        Ok(())
    }

    /// Keys that are not used.
    pub(super) fn unused(config: &Config) -> Vec<Unused> {
        let of_method = |keys: &'static [&'static str]| Unused::new(keys, &["gather.method"]);
        match (config.gather.method, config.gather.stochastic_culling()) {
            (GatherMethod::LightCaches, _) => {
                let caches = of_method(&["gather.per_pixel", "gather.stochastic", "gather.conservative_clusters"]);
                let occlusion = Unused::new(&["gather.light_caches.double_projection"], &["gather.light_caches.occlusion"]);
                let has = config.gather.light_caches.occlusion == CacheOcclusion::DoubleProjection;
                // Pixels have no subsets of VPLs; of a sky's directions they have.
                let is_given = config.filter.kind != FilterKind::None && !config.has_sky();
                let filter = is_given.then(|| of_method(&["filter"]));
                std::iter::once(caches).chain((!has).then_some(occlusion)).chain(filter).collect()
            }
            (_, None) => {
                let tile = Unused::new(&["gather.per_pixel.tile"], &["gather.per_pixel.culling"]);
                let tile = (config.gather.per_pixel.culling != Culling::Tiled).then_some(tile);
                let others = of_method(&["gather.stochastic", "gather.conservative_clusters", "gather.light_caches"]);
                std::iter::once(others).chain(tile).collect()
            }
            (_, Some(culling)) => {
                let tiles = Unused::new(&["gather.conservative_clusters"], &["gather.stochastic.culling"]);
                let tiles = (culling != StochasticCulling::ConservativeClusters).then_some(tiles);
                std::iter::once(of_method(&["gather.per_pixel", "gather.light_caches"])).chain(tiles).collect()
            }
        }
    }
}
