//! Further bounces from VPLs (Aranha, Macedo and Apolinario, "Screen-space VPL propagation"): k-means puts VPLs into clusters, a paraboloid
//! map is rendered for each cluster, and samples of the maps become the VPLs of the next bounce.

use super::facts::{Facts, planned_turns};
use super::methods::{Choice, Needs};
use super::vpls::{VplPlace, Vpls, points};
use super::wants::Wants;
use crate::config::{BounceConfig, Centers, Config, Layers, Pattern, Representative, Shares, VisibilityMethod};
use crate::fail;
use crate::gpu::{Feature, Format};
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;
use crate::world::device::{FrameScene, Maps, Parts};
use anyhow::Result;

shader_struct! {
    /// `glsl/bounce/vpl-cluster.glsl`.
    pub struct VplCluster {
        pub position: [f32; 3],
        /// Octahedral, two signed normalized 16-bit numbers.
        pub normal: u32,
        /// Flux of its VPLs, W: the sum of flux_i * kept_i / kept_representative, where kept is the share of a VPL's light that stays in
        /// the scene, 1 if unknown.
        pub flux: [f32; 3],
        pub members: u32,
        /// Mean squared distance of its members from the cluster's mean, m^2, weighted by kept.
        pub spread: f32,
    }

    /// State of a cluster that k-means keeps from frame to frame.
    struct Centre {
        position: [f32; 3],
        normal: [f32; 3],
    }

    struct KMeansParams {
        count: u32,
        clusters: u32,
        rounds: u32,
        first_rounds: u32,
        place_weight: f32,
        normal_weight: f32,
        seed: u32,
    }

    struct CullParams {
        parts: u32,
        first: u32,
        clusters: u32,
        far: f32,
        all: u32,
    }

    struct DrawParams {
        far: f32,
        texel_size: f32,
        albedo_lod: f32,
        layer: u32,
        layers: u32,
    }

    struct SharesParams {
        count: u32,
        clusters: u32,
        size: i32,
    }

    struct SampleParams {
        count: u32,
        size: i32,
        far: f32,
        shift: [f32; 2],
    }
}

/// VPLs of one bounce, and their clusters if a later stage needs them.
#[derive(Debug, Clone, Copy)]
pub struct Bounce {
    pub vpls: Vpls,
    pub clusters: Option<VplClusters>,
}

/// VPL clusters, with one paraboloid map a cluster: layer i of the images is the map of cluster i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VplClusters {
    pub count: u32,
    pub clusters: Buffer,
    /// Cluster of each VPL; all bits set for a VPL without light.
    pub labels: Buffer,
    /// Distance over `far`; 1 where the map sees no surface.
    pub distances: Image,
    /// Geometric normals, octahedral, flipped to face the cluster's representative.
    pub normals: Image,
    /// Diffuse albedo, averaged over a VPL's footprint; 0 on the back of a single-sided surface.
    pub albedos: Image,
    /// Side of a map, texels.
    pub size: u32,
    /// The scene's diagonal, metres.
    pub far: f32,
}

/// Loop turns of an invocation that k-means plans with.
const MOST_TURNS: u64 = planned_turns(50_000);

/// Loop turns of one round of k-means.
fn turns_a_round(vpls: u32, clusters: u32) -> u64 {
    let (vpls, clusters) = (u64::from(vpls), u64::from(clusters));
    let parts = 256 / clusters;
    vpls.div_ceil(256) * (clusters + 1) + vpls.div_ceil(parts) + parts + 256 + clusters
}

/// Rounds of k-means that fit into a frame with this many VPLs and clusters, at most 64.
pub fn most_rounds(vpls: u32, clusters: u32) -> u32 {
    let first_centres = u64::from(clusters) * (u64::from(vpls).div_ceil(256) + 257);
    // One more loop over the VPLs ends it.
    (MOST_TURNS.saturating_sub(first_centres) / turns_a_round(vpls, clusters)).saturating_sub(1).min(64) as u32
}

impl Choice for Layers {
    const KEY: &'static str = "bounce.clusters.layers";

    fn needs(self) -> Needs {
        use Feature::{ClipDistance, GeometryShader, LayerFromVertexShader, MultiDrawIndirect, ShaderDrawParameters, Snorm16Images};
        match self {
            Self::Instanced | Self::PerLayer => {
                &[&[MultiDrawIndirect, ShaderDrawParameters, ClipDistance, LayerFromVertexShader, Snorm16Images]]
            }
            Self::GeometryShader => &[&[MultiDrawIndirect, ShaderDrawParameters, ClipDistance, GeometryShader, Snorm16Images]],
        }
    }
}

/// Whether frames of a config cluster VPLs: for further bounces, or for visibility.
pub fn has_clusters(config: &Config) -> bool {
    config.bounce.count > 1 || config.visibility.method == VisibilityMethod::Clusters
}

/// Refuses counts of VPLs that leave k-means less than one round within `MOST_TURNS`.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    if !has_clusters(config) {
        return Ok(());
    }
    let counts = [("vpls.count", facts.vpls), ("bounce.vpls", config.bounce.vpls)];
    for (key, count) in &counts[..if config.bounce.count > 2 { 2 } else { 1 }] {
        if most_rounds(*count, config.bounce.clusters.count) == 0 {
            return Err(fail!(
                BadInput,
                "{key}: {count} VPLs are too many to be put into {} clusters on every driver; lower either",
                config.bounce.clusters.count
            ));
        }
    }
    Ok(())
}

/// Warnings about a config's clusters: large triangles, and fewer rounds of k-means than asked for.
pub fn warnings(config: &Config, vpls: u32) -> Vec<String> {
    if !has_clusters(config) {
        return Vec::new();
    }
    let bent = "scene.split: is not set, and the maps of clusters bend the edges of large triangles; 0.02 is a good value";
    let slow =
        "bounce.clusters.rounds: so many VPLs and clusters have fewer rounds of k-means a frame; clusters may be unsettled for some frames";
    let few = most_rounds(vpls, config.bounce.clusters.count) < config.bounce.clusters.rounds;
    let warnings = [config.scene.split.is_none().then_some(bent), few.then_some(slow)];
    warnings.into_iter().flatten().map(str::to_owned).collect()
}

/// All bounces of the config, from the VPLs of the first one; none without these.
pub fn propagate(g: &mut Graph, scene: FrameScene<'_>, first: Option<Vpls>, wants: &Wants, config: &BounceConfig) -> Vec<Bounce> {
    let Some(first) = first else { return Vec::new() };
    let mut bounces = vec![Bounce { vpls: first, clusters: None }];
    for next in 2..=config.count {
        let last = &mut bounces[next as usize - 2];
        let vpls = g.again(next - 1, |g| {
            let clusters = clusters(g, scene, &last.vpls, wants.seed, config);
            last.clusters = Some(clusters);
            sample(g, &clusters, wants.seed, config)
        });
        bounces.push(Bounce { vpls, clusters: None });
    }
    if config.count == 1 && wants.clusters {
        bounces[0].clusters = Some(clusters(g, scene, &first, wants.seed, config));
    }
    bounces
}

/// Clusters VPLs and renders the clusters' maps.
fn clusters(g: &mut Graph, scene: FrameScene<'_>, vpls: &Vpls, seed: u32, config: &BounceConfig) -> VplClusters {
    let (count, map_size) = (config.clusters.count, config.clusters.map_size);
    let far = scene.bounds().size().length();
    let size = [map_size; 2];
    let clusters = VplClusters {
        count,
        clusters: g.buffer::<VplCluster>("bounce/clusters", count),
        labels: g.zeroed::<u32>("bounce/labels", vpls.count),
        distances: g.layered_image("bounce/distances", Format::R32Float, size, count),
        normals: g.layered_image("bounce/normals", Format::Rg16Snorm, size, count),
        albedos: g.layered_image("bounce/albedos", Format::Rgba16Float, size, count),
        size: map_size,
        far,
    };
    k_means(g, vpls, &clusters, config, seed);
    draw(g, scene, &clusters, config);
    clusters
}

/// k-means over position and normal (section III-B). Counts `bounce/rounds`, and `bounce/unsettled`: 1 if the last round still moved a VPL
/// to another cluster.
fn k_means(g: &mut Graph, vpls: &Vpls, clusters: &VplClusters, config: &BounceConfig, seed: u32) {
    let centres = g.history::<Centre>("bounce/centres", clusters.count);
    // As long as the centres, so that both are zeros where the number of clusters changes; the first number counts.
    let frames = g.history::<u32>("bounce/frames", clusters.count);
    let (rounds, unsettled) = (g.count("bounce/rounds"), g.count("bounce/unsettled"));
    let most = most_rounds(vpls.count, clusters.count);
    let pass = g.compute("bounce/k-means");
    let pass = match vpls.kept {
        Some(kept) => pass.part("kept", "bounce/kept-shares").reads("kept_shares", kept),
        None => pass,
    };
    pass.reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .updates("centres", centres)
        .updates("frames", frames)
        .updates("labels", clusters.labels)
        .writes("clusters", clusters.clusters)
        .updates("rounds", rounds)
        .updates("unsettled", unsettled)
        .constant("RESEED", config.clusters.centers == Centers::Reseeded)
        .constant("NEAREST_MEMBER", config.clusters.representative == Representative::NearestMember)
        .params(&KMeansParams {
            count: vpls.count,
            clusters: clusters.count,
            rounds: config.clusters.rounds.min(most),
            first_rounds: most,
            place_weight: config.clusters.position_weight / clusters.far,
            normal_weight: config.clusters.normal_weight,
            seed,
        })
        .dispatch_groups([1, 1, 1]);
}

/// Maps of all clusters (section III-C); `bounce.clusters.layers` says how layers are reached.
fn draw(g: &mut Graph, scene: FrameScene<'_>, clusters: &VplClusters, config: &BounceConfig) {
    let count = clusters.count;
    let depth = g.layered_image("bounce/depth", Format::Depth32, [clusters.size; 2], count);
    let texels = f64::from(clusters.size).powi(2) * std::f64::consts::FRAC_PI_4 * f64::from(count);
    let params = |layer| DrawParams {
        far: clusters.far,
        texel_size: 2.0 / clusters.size as f32,
        albedo_lod: (0.5 * (texels / f64::from(config.vpls)).log2()).max(0.0) as f32,
        layer,
        layers: count,
    };
    let (shader, group) = match config.clusters.layers {
        Layers::GeometryShader => ("bounce/draw-geometry", 8),
        Layers::Instanced => ("bounce/draw", 1),
        Layers::PerLayer => {
            for layer in 0..count {
                g.again(layer + 1, |g| {
                    let (parts, _) = seen_parts(g, scene, clusters, [layer, 1], 1);
                    let pass = g
                        .raster("bounce/draw")
                        .part("layer", "bounce/layer-pass")
                        .reads("draws", scene.draws)
                        .reads("parts", parts.parts)
                        .reads("clusters", clusters.clusters)
                        .params(&params(layer));
                    let pass = match layer {
                        0 => pass
                            .color("distances", clusters.distances, [1.0; 4])
                            .color("normal", clusters.normals, [0.0; 4])
                            .color("albedo", clusters.albedos, [0.0; 4])
                            .depth(depth),
                        _ => pass
                            .color_over("distances", clusters.distances)
                            .color_over("normal", clusters.normals)
                            .color_over("albedo", clusters.albedos)
                            .depth_over(depth),
                    };
                    pass.draw(parts.lists);
                });
            }
            return;
        }
    };
    let (parts, layers) = seen_parts(g, scene, clusters, [0, count], group);
    g.raster("bounce/draw")
        .shader(shader)
        .reads("draws", scene.draws)
        .reads("parts", parts.parts)
        .reads("layers", layers)
        .reads("clusters", clusters.clusters)
        .params(&params(0))
        .color("distances", clusters.distances, [1.0; 4])
        .color("normal", clusters.normals, [0.0; 4])
        .color("albedo", clusters.albedos, [0.0; 4])
        .depth(depth)
        .draw(parts.lists);
}

/// Draw lists of the scene's parts, culled by the clusters `first..first + count`: a part gets one instance a group of `group` clusters if
/// it reaches into the hemisphere of one of them. The buffer says which cluster or group each instance belongs to.
fn seen_parts(g: &mut Graph, scene: FrameScene<'_>, clusters: &VplClusters, [first, count]: [u32; 2], group: u32) -> (Parts, Buffer) {
    let parts = scene.parts(g, "bounce", Maps::Reflection);
    let layers = g.buffer::<u32>("bounce/layers", parts.count.max(1) * count);
    let all = u32::from(g.is_warming_up());
    g.compute("bounce/cull")
        .reads("clusters", clusters.clusters)
        .reads("parts", parts.parts)
        .updates("arguments", parts.arguments)
        .writes("layers", layers)
        .constant("GROUP", group)
        .params(&CullParams { parts: parts.count, first, clusters: count, far: clusters.far, all })
        .dispatch([parts.count, 1, 1]);
    (parts, layers)
}

/// VPLs of the next bounce: samples of the clusters' maps (section III-C), with the flux that the cluster sends there. Counts
/// `bounce/wasted`, samples outside of a map's disk, and `bounce/lit`, VPLs with flux.
fn sample(g: &mut Graph, clusters: &VplClusters, seed: u32, config: &BounceConfig) -> Vpls {
    let count = config.vpls;
    let [across, down, ..] = points::shift(seed);
    let vpls = Vpls {
        count,
        places: g.buffer::<VplPlace>("bounce/places", count),
        intensities: g.buffer::<[f32; 3]>("bounce/intensities", count),
        areas: g.buffer::<f32>("bounce/areas", count),
        disks: None,
        kept: None,
        lobes: None,
        diffuse: true,
    };
    let (wasted, lit) = (g.count("bounce/wasted"), g.count("bounce/lit"));
    let starts = g.buffer::<u32>("bounce/starts", clusters.count + 1);
    let size = clusters.size as i32;
    g.compute("bounce/shares")
        .reads("clusters", clusters.clusters)
        .reads("distances", clusters.distances)
        .reads("albedos", clusters.albedos)
        .writes("starts", starts)
        .constant("BY_FLUX", config.shares == Shares::Flux)
        .params(&SharesParams { count, clusters: clusters.count, size })
        .dispatch_groups([1, 1, 1]);
    g.compute("bounce/sample")
        .reads("clusters", clusters.clusters)
        .reads("starts", starts)
        .reads("distances", clusters.distances)
        .reads("normals", clusters.normals)
        .reads("albedos", clusters.albedos)
        .writes("places", vpls.places)
        .writes("intensities", vpls.intensities)
        .writes("areas", vpls.areas)
        .updates("wasted", wasted)
        .updates("lit", lit)
        .constant("DISK", config.pattern == Pattern::Disk)
        .params(&SampleParams { count, size, far: clusters.far, shift: [across, down] })
        .dispatch([count, 1, 1]);
    vpls
}

/// Warning for a sequence that is rendered in parts: clusters that are kept over frames start anew in each part.
pub fn warning_of_parts(config: &Config) -> Option<String> {
    let warning = "clusters go on from frame to frame (bounce.clusters.centers), and parts of a sequence start anew: where lights move, pictures are not those of the whole sequence";
    (has_clusters(config) && config.bounce.clusters.centers == Centers::Kept).then(|| warning.to_owned())
}
