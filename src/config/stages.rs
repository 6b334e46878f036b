//! The sections that set the frame and its slots: one struct a section, one enum a choice of method.

use serde::{Deserialize, Serialize};

/// `[frame]`: how many pictures of which size, and how they are timed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FrameConfig {
    /// Width and height in pixels, each 1 to 16,384.
    pub size: [u32; 2],
    /// Measured frames, 1 and more.
    pub count: u32,
    /// Frames before them that are not measured. They show the first frame's time.
    pub warmup: u32,
    /// Frames a second of animation time: frame `i` shows the second `i / fps`.
    pub fps: f32,
    /// Seed of everything random in a frame.
    pub seed: u32,
    pub timing: TimingMode,
}

impl Default for FrameConfig {
    fn default() -> Self {
        Self { size: [960, 540], count: 5, warmup: 2, fps: 30.0, seed: 0, timing: TimingMode::Isolated }
    }
}

/// What the time of a pass means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimingMode {
    /// A full barrier around each pass: rows sum to the frame.
    #[default]
    Isolated,
    /// The derived barriers only: passes may overlap.
    Overlapped,
    /// Submit and wait for each pass, host clock: a cross-check.
    Serial,
}

/// `[materials]`: how surfaces reflect.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MaterialsConfig {
    pub dielectric: Dielectric,
}

/// How non-metals reflect.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dielectric {
    /// Diffuse only, as in the papers.
    #[default]
    Lambert,
    /// Diffuse under a GGX specular layer.
    Ggx,
}

/// `[rsm]`: the reflective shadow maps, one array layer a light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RsmConfig {
    /// Width and height in texels, each 1 to 8,192.
    pub size: [u32; 2],
    /// What directional lights' frusta are fitted to; the scene's bounds if absent. The key is `box`.
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub bounds: Option<BoxConfig>,
}

impl Default for RsmConfig {
    fn default() -> Self {
        Self { size: [512, 512], bounds: None }
    }
}

/// An axis-aligned box in the world, metres; `min` is less than `max` on every axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxConfig {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

/// `[vpls]`: which texels of the reflective shadow maps become virtual point lights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VplsConfig {
    pub sampler: VplSampler,
    /// Virtual point lights in all, 1 to 1,048,576; of every texel there are as many as texels.
    pub count: u32,
    pub importance: Importance,
    pub reflection: Reflection,
}

impl Default for VplsConfig {
    fn default() -> Self {
        Self { sampler: VplSampler::Regular, count: 1024, importance: Importance::None, reflection: Reflection::Diffuse }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VplSampler {
    /// A regular pattern over the map, shuffled by a fixed permutation.
    #[default]
    Regular,
    /// The points of a Hammersley set, shuffled likewise.
    Hammersley,
    /// All of them.
    EveryTexel,
}

/// Where texels are more likely to become virtual point lights, which are weaker for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Importance {
    /// Nowhere.
    #[default]
    None,
    /// By what they reflect, and how much of that the map shows to stay in the scene: not on a roof under the sky.
    PassedFlux,
}

/// What virtual point lights reflect.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reflection {
    #[default]
    Diffuse,
    /// By GGX alone.
    Glossy,
    Both,
}

/// `[bounce]`: how light goes on from the first virtual point lights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BounceConfig {
    /// Bounces of indirect light, 1 to 8: one is that of the virtual point lights from the reflective shadow map.
    pub count: u32,
    /// Clusters of a bounce's virtual point lights, 1 to 64.
    pub clusters: u32,
    pub representative: Representative,
    pub centers: Centers,
    /// Rounds of k-means a frame, 1 to 64; the first frame goes on until nothing changes.
    pub rounds: u32,
    /// What distance counts for between a light and its cluster, in scene's diagonals; 0 to 1,000.
    pub position_weight: f32,
    /// And the cosine between their normals; 0 to 1,000.
    pub normal_weight: f32,
    /// Side of a cluster's map, texels: 64, 128, 256, 512 or 1024.
    pub map_size: u32,
    pub layers: Layers,
    pub pattern: Pattern,
    pub shares: Shares,
    /// Virtual point lights of each bounce after the first, in all, 1 to 65,536.
    pub vpls: u32,
    pub visibility: BounceVisibility,
}

impl Default for BounceConfig {
    fn default() -> Self {
        Self {
            count: 1,
            clusters: 8,
            representative: Representative::NearestMember,
            centers: Centers::Kept,
            rounds: 5,
            position_weight: 0.6,
            normal_weight: 0.4,
            map_size: 256,
            layers: Layers::Instanced,
            pattern: Pattern::Disk,
            shares: Shares::Equal,
            vpls: 256,
            visibility: BounceVisibility::None,
        }
    }
}

/// Where a cluster's map is rendered from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Representative {
    /// The light that is nearest to the mean of the cluster's.
    #[default]
    NearestMember,
    /// The mean itself, which may float or lie in a wall.
    Mean,
}

/// Where a frame's clusters start from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Centers {
    /// Those of the frame before.
    #[default]
    Kept,
    /// Other ones in every frame.
    Reseeded,
}

/// How the maps of all clusters are filled.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layers {
    /// A geometry shader sends each triangle to every map.
    GeometryShader,
    /// An instance of the scene a map, which the vertex shader sends there.
    #[default]
    Instanced,
    /// A pass a map.
    PerLayer,
}

/// Where in a cluster's map light goes on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pattern {
    /// Evenly over the disk that the map's picture is.
    #[default]
    Disk,
    /// Evenly over the whole map, its empty corners too.
    Box,
}

/// How the virtual point lights of a bounce are shared out among the clusters that they come from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shares {
    /// Each gets as many.
    #[default]
    Equal,
    /// By the flux that each passes on; at least one.
    Flux,
}

/// What the virtual point lights of further bounces see: as in `[visibility]`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BounceVisibility {
    #[default]
    None,
    RayTraced,
    ImperfectShadowMaps,
}

/// `[visibility]`: what a virtual point light sees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VisibilityConfig {
    pub method: VisibilityMethod,
    /// Imperfect shadow maps that the lights of every texel share, at most, 1 to 65,536.
    pub shared_maps: u32,
    /// How points get into the imperfect shadow maps.
    pub renderer: IsmRenderer,
    pub collect: Collect,
    pub points: PointSet,
    /// About how many points stand for the scene, 1 to 67,108,864.
    pub point_count: u32,
    /// Leaves small triangles out by lot, so that all points stand for the same area; else every triangle makes a point at least.
    pub thin: bool,
    /// Points that a map's partition holds, 1 to 1,048,576; follows the others if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub capacity: Option<u32>,
    /// Side of a map, texels: 16, 32, 64, 128 or 256.
    pub map_size: u32,
    /// Maps that each point is considered for, 1 to 32; 16 for single pixels and 1 for splats if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub considered: Option<u32>,
    /// Maps that each point is drawn into, 1 to 16 and at most `considered`; 4 for single pixels and 1 for splats if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collected: Option<u32>,
    /// Whether points are as large as the paraboloid projection makes them.
    pub distortion: bool,
    /// Whether points and what is made of them stay in their own map.
    pub clamp: bool,
    /// Multiplies the points' radius, over 0 to 16; if absent 1 for single pixels, 1.1 where they
    /// are adaptive, 1.25 where normals are kept, and 0.9 for splats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub enlarge: Option<f32>,
    /// Whether a point's normal limits its size.
    pub normals: bool,
    pub lookup: Lookup,
    /// How far behind a map's surface a receiver still is lit, in units of what the map resolves there; 0 to 64.
    pub bias: f32,
}

impl Default for VisibilityConfig {
    fn default() -> Self {
        Self {
            method: VisibilityMethod::None,
            shared_maps: 1024,
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
            lookup: Lookup::Bilinear,
            bias: 0.75,
        }
    }
}

/// How receivers are compared with the imperfect shadow maps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lookup {
    /// With the texel that they lie in.
    Nearest,
    /// With the four texels around; the share of them that lets light through, bilinear (percentage-closer filtering).
    #[default]
    Bilinear,
}

/// How points get into the imperfect shadow maps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IsmRenderer {
    /// A texel each; pull and push fill the holes between them.
    #[default]
    SinglePixel,
    /// As squares of their size.
    Splat,
}

/// How points are made from triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Collect {
    /// By a compute pass.
    #[default]
    Compute,
    /// By the tessellator.
    Tessellation,
}

/// Which points a map gets.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointSet {
    /// At random, by area.
    #[default]
    Uniform,
    /// More of those near its light, by solid angle.
    Adaptive,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VisibilityMethod {
    /// Everything: indirect light has no shadows.
    #[default]
    None,
    /// What a ray reaches: exact.
    RayTraced,
    /// Small shadow maps of points, one a light.
    ImperfectShadowMaps,
    /// Shadow maps of clusters of lights; see [`BounceConfig`].
    Clusters,
}

/// `[gather]`: how the virtual point lights' light is summed at the pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GatherConfig {
    pub method: GatherMethod,
    /// Each pixel of a block of this side length sums another subset of the lights: 1, 2, 4 or 8.
    pub interleave: u32,
    pub culling: Culling,
    pub bounds: Bounds,
    pub rasterization: Rasterization,
    /// Nodes that the light lists of conservative clusters have room for, 8 bytes each; what more there would be is lost, and counted. 1 to
    /// 2^24: half of the paper's 256 MB, which is as large as every driver lets a buffer be.
    pub nodes: u32,
    /// The irradiance that a light brings to a surface facing it, W/m^2, below which stochastic culling leaves it to chance; over 0.
    pub delta: f32,
    pub roulette: RouletteChoice,
    /// Counts lights a pixel, on lists and lit, for stochastic culling.
    pub statistics: bool,
    pub receiver: Receiver,
    pub emitters: Emitters,
    /// The distance d_min, in metres, below which a light does not get brighter; 0 turns it off. At most 1,000,000.
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

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GatherMethod {
    /// Every pixel sums every light of its subset.
    #[default]
    PerPixel,
}

/// How virtual point lights are left out that cannot shine on pixels. Of the first three none changes the picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Culling {
    None,
    /// By what a workgroup's pixels span, in the gather itself.
    #[default]
    Tiled,
    /// By light lists of clusters: tiles of 128 pixels and 16 slices of depth.
    Clustered,
    /// Those that shine little by chance, so that nothing is lost on average; then by tiles and bounds of their ranges.
    StochasticTiled,
    /// Likewise, and then by drawing each range's bounds of 80 triangles, and adding up.
    Splatting,
    /// Likewise, and then by light lists of clusters: tiles of 16 pixels of a subset and 32 slices of depth, which bounds of 20 triangles are
    /// conservatively rasterized into.
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

/// What bounds a glossy light's random range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bounds {
    /// The spheroid of its lobe.
    #[default]
    Ellipsoid,
    /// A sphere around that.
    SphereEllipsoid,
    /// A sphere around the light.
    SphereVpl,
    /// Nothing: every tile lists every light, diffuse ones too.
    None,
}

/// How the tiles are found that bounds touch, for light lists of clusters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rasterization {
    /// By the extension where the device has it, else by the geometry shader.
    #[default]
    Automatic,
    /// VK_EXT_conservative_rasterization.
    Extension,
    /// Which grows each triangle.
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

/// The random numbers of stochastic culling.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RouletteChoice {
    /// The same in every frame.
    #[default]
    Fixed,
    PerFrame,
    /// None: what would be left to chance is lost, as where ranges are clamped. Too dark, and there to be compared with.
    None,
}

/// How surfaces that the camera sees reflect indirect light.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Receiver {
    /// By their diffuse part alone.
    #[default]
    Diffuse,
    /// By GGX too.
    Ggx,
}

/// What virtual point lights shine as on what is near them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Emitters {
    #[default]
    Points,
    /// Disks that reach over their neighbours, so that their light is even: the fewer lights, the softer they are. What walls cut off
    /// shines on from the rest.
    Disks,
}

/// `[filter]`: how the indirect irradiance is smoothed over the pixels' subsets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilterConfig {
    pub kind: FilterKind,
    /// Pixels to each side, 1 to 32; if absent `gather.interleave`, or twice that for a Gaussian.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<u32>,
    /// Pixels whose normals differ by more are kept apart, or by a cross bilateral filter count for e^-2 there and less beyond; degrees, over 0 to 90.
    pub normal_threshold_deg: f32,
    /// Pixels farther than this from the pixel's tangent plane likewise; in units of its view depth, over 0.
    pub plane_distance: f32,
}

impl Default for FilterConfig {
    fn default() -> Self {
        Self { kind: FilterKind::Bilateral, radius: None, normal_threshold_deg: 25.0, plane_distance: 0.02 }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilterKind {
    /// Separable, depth- and normal-aware.
    #[default]
    Bilateral,
    /// Likewise, and its weights are a Gaussian's.
    Gaussian,
    /// Likewise, and neighbours count less the more their place and normal differ.
    CrossBilateral,
    None,
}

/// `[direct]`: direct light and its shadows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DirectConfig {
    pub shadows: Shadows,
    /// How far a surface is moved towards the light before it is compared, metres, 0 and more.
    pub bias: f32,
    /// Filter radius in texels of the shadow map, 0 to 8.
    pub blur: u32,
}

impl Default for DirectConfig {
    fn default() -> Self {
        Self { shadows: Shadows::Variance, bias: 0.005, blur: 1 }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shadows {
    /// Variance shadow maps.
    #[default]
    Variance,
    /// Several comparisons, averaged.
    PercentageCloser,
    /// A ray to the light: exact, with hard edges.
    RayTraced,
    None,
}

/// `[ssao]`: screen-space ambient occlusion, which darkens the indirect light where surfaces nearby stand in its way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SsaoConfig {
    pub method: SsaoMethod,
    /// How far occluders are looked for, metres, over 0 to 1,000.
    pub radius: f32,
    /// Looks at the depth to each of both sides, 1 to 32.
    pub samples: u32,
    pub resolution: SsaoResolution,
    /// How much of it is applied, 0 to 1.
    pub strength: f32,
}

impl Default for SsaoConfig {
    fn default() -> Self {
        Self { method: SsaoMethod::None, radius: 0.6, samples: 4, resolution: SsaoResolution::Half, strength: 1.0 }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SsaoMethod {
    #[default]
    None,
    /// By how high the depth rises around a pixel.
    Horizons,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SsaoResolution {
    Full,
    /// Every second pixel of every second row.
    #[default]
    Half,
}

/// `[compose]`: from linear radiance to the picture. Touches `image.png` only, never the EXR.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ComposeConfig {
    /// Multiplies the radiance, over 0.
    pub exposure: f32,
    /// Radiance shown where there is no surface; in the picture alone.
    pub background: [f32; 3],
    pub tonemap: Tonemap,
}

impl Default for ComposeConfig {
    fn default() -> Self {
        Self { exposure: 1.0, background: [0.0; 3], tonemap: Tonemap::Reinhard }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tonemap {
    #[default]
    Reinhard,
    /// Clamps to [0, 1].
    None,
}

/// `[output]`: what is written beside the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OutputConfig {
    /// Layers of the EXR beside the final radiance; each at most once.
    pub layers: Vec<Layer>,
}

impl Default for OutputConfig {
    fn default() -> Self {
        use Layer::*;
        Self { layers: vec![Direct, Indirect, Irradiance, Albedo, Normal, Position, Depth] }
    }
}

/// A layer of the EXR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layer {
    /// Outgoing radiance of the direct light, albedo included.
    Direct,
    /// Outgoing radiance of the indirect light, albedo included.
    Indirect,
    /// Indirect irradiance after filtering.
    Irradiance,
    Albedo,
    /// World-space shading normals, `N.X/Y/Z`.
    Normal,
    /// World-space positions, `P.X/Y/Z`, metres.
    Position,
    /// View depth, `Z`, metres.
    Depth,
}
