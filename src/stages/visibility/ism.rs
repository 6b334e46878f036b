//! Imperfect shadow maps (Ritschel et al. 2008; Linke 2016, sections 3.3 and 4.4): a small paraboloid map for every VPL, splatted from
//! points of the scene's triangles. Each map gets other points.

use super::points::{self, Points};
use super::{Visibility, VisibilityConfig, adaptive, pull_push, splat};
use crate::config::{IsmConfig, IsmRenderer, Lookup, PointSet};
use crate::gpu::Format;
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::shader_struct;
use crate::stages::facts::planned_turns;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    /// `glsl/visibility/sky-frame.glsl`: of a direction's orthographic map.
    pub struct SkyFrame {
        /// Vector of which the dot product with that from the VPL to a point is the point's place across, in [-1, 1].
        pub right: [f32; 3],
        /// Mean length of `right` and `up`, 1/m.
        pub scale: f32,
        /// The same for the place down.
        pub up: [f32; 3],
        /// 1 / (scale * far).
        pub extent: f32,
    }

    pub(super) struct ClearParams {
        pub size: [i32; 2],
    }

    struct SinglePixelParams {
        count: u32,
        first: u32,
        shares: u32,
        considered: u32,
        collected: u32,
        columns: u32,
        far: f32,
        diagonal: f32,
        enlarge: f32,
    }
}

/// Default growth of radii. The pull phase closes the holes that disks of a surface's area leave in it; it closes fewer where points are
/// few or small, and where normals are kept.
const SINGLE_PIXEL_ENLARGE: f32 = 1.0;
const ADAPTIVE_ENLARGE: f32 = 1.1;
const TILTED_ENLARGE: f32 = 1.25;
/// The same for orthographic maps of all of the scene. A ray that finds a hole in an outer wall lights a room.
const SKY_ENLARGE: f32 = 1.5;
const SKY_SPLAT_ENLARGE: f32 = 1.3;

/// Points that a workgroup draws, at most: each takes a lane up to 65 loop turns.
const POINTS_A_GROUP: u32 = 64 * (planned_turns(16_640) / 65) as u32;

/// How a map projects the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Projection {
    /// The hemisphere that a VPL faces.
    Paraboloid,
    /// All of the scene, from infinitely far away: a [`SkyFrame`] a map.
    Orthographic(Buffer),
}

/// Maps of all VPLs, tiled in one image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ism {
    /// Distance over `far`; 1 where a map sees no surface.
    pub maps: Image,
    /// Side of a map, texels; a power of two.
    pub size: u32,
    /// Maps side by side; VPL i has column `i % columns`, row `i / columns`.
    pub columns: u32,
    /// The scene's diagonal, metres.
    pub far: f32,
    /// Depth bias, widths of a texel.
    pub bias: f32,
    pub lookup: Lookup,
}

/// Columns and rows of the tiling of `count` maps: nearly a square, rows filled first.
pub(super) fn layout(count: u32) -> [u32; 2] {
    let columns = f64::from(count).sqrt().ceil() as u32;
    [columns, count.div_ceil(columns)]
}

/// Capacity of a partition, points: from the config, or the mean plus ten standard deviations, so that overflow is practically impossible.
pub fn partition_capacity(config: &VisibilityConfig, points: f64, partitions: u32) -> u32 {
    let mean = points / f64::from(partitions);
    let enough = mean + 10.0 * mean.sqrt() + 32.0;
    config.ism.capacity.unwrap_or((enough as u32).next_multiple_of(64))
}

/// Renders the maps with the config's renderer.
pub(super) fn render(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, config: &VisibilityConfig) -> Visibility {
    Visibility::Ism(projected(g, around, vpls, Projection::Paraboloid, config))
}

/// Renders orthographic maps of all of the scene for VPLs that are directions, from points of equal area without normals. Walls would get
/// hardly a point in a scene of fine meshes if each triangle had one. There is a [`SkyFrame`] for each VPL.
pub fn of_directions(
    g: &mut Graph,
    around: Surroundings<'_>,
    vpls: &Vpls,
    frames: Buffer,
    map_size: u32,
    config: &VisibilityConfig,
) -> Ism {
    let enlarge = if config.ism.renderer == IsmRenderer::Splat { SKY_SPLAT_ENLARGE } else { SKY_ENLARGE };
    let enlarge = Some(config.ism.enlarge.unwrap_or(enlarge));
    let ism = IsmConfig { points: PointSet::Uniform, normals: false, thin: true, map_size, enlarge, ..config.ism.clone() };
    projected(g, around, vpls, Projection::Orthographic(frames), &VisibilityConfig { ism, ..config.clone() })
}

fn projected(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, projection: Projection, config: &VisibilityConfig) -> Ism {
    let maps = match config.ism.renderer {
        IsmRenderer::SinglePixel => single_pixel(g, around, vpls, projection, config),
        IsmRenderer::Splat => splat::render(g, around, vpls, projection, config),
    };
    Ism {
        maps,
        size: config.ism.map_size,
        columns: layout(vpls.count)[0],
        far: around.scene.bounds().size().length(),
        bias: bias(config, vpls.count),
        lookup: config.lookup,
    }
}

/// Bias of the lookup, in texels: it grows with the coarseness of the map, by its texels and by the distances between its points.
fn bias(config: &VisibilityConfig, count: u32) -> f32 {
    let points = config.ism.point_count as f32 * collected(config, count) as f32 / count as f32;
    let texels = config.ism.map_size as f32;
    config.bias * (1.0 + texels * texels / (4.0 * points)).sqrt()
}

/// VPLs that a point is tested against.
pub(super) fn considered(config: &VisibilityConfig, count: u32) -> u32 {
    let default = if config.ism.renderer == IsmRenderer::Splat { 1 } else { 16 };
    config.ism.considered.unwrap_or(default).min(count)
}

/// Maps that a point is drawn into, at most.
pub(super) fn collected(config: &VisibilityConfig, count: u32) -> u32 {
    let default = if config.ism.renderer == IsmRenderer::Splat { 1 } else { 4 };
    config.ism.collected.unwrap_or(default).min(considered(config, count))
}

/// Points as single pixels, with a pull-push pass that fills the holes between them (sections 4.4.3 and 4.4.4).
fn single_pixel(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, projection: Projection, config: &VisibilityConfig) -> Image {
    let points = match config.ism.points {
        PointSet::Uniform => points::collect(g, around, vpls.count, config),
        PointSet::Adaptive => {
            vec![adaptive::choose(g, around, vpls, config.ism.point_count, collected(config, vpls.count), config.ism.thin)]
        }
    };
    let [columns, rows] = layout(vpls.count);
    let size = [columns * config.ism.map_size, rows * config.ism.map_size];
    let target = g.image("visibility/single-pixels", Format::R32Uint, size);
    clear(g, "visibility/clear", target);
    let drawing = Drawing { around, vpls, projection, columns, config };
    let counts = [g.count("visibility/dropped-points"), g.count("visibility/drawn-points")];
    for (number, points) in (1..).zip(&points) {
        g.again(number, |g| {
            let pass = g.compute("visibility/single-pixel").updates("target", target);
            drawing.dispatch(points, pass.updates("dropped", counts[0]).updates("drawn", counts[1]));
        });
    }
    let tilts = config.ism.normals.then(|| {
        let tilts = g.image("visibility/tilts", Format::R32Uint, size);
        clear(g, "visibility/clear-tilts", tilts);
        for (number, points) in (1..).zip(&points) {
            g.again(number, |g| {
                let pass = g.compute("visibility/single-pixel-normals").reads("target", target);
                drawing.dispatch(points, pass.updates("tilts", tilts));
            });
        }
        tilts
    });
    pull_push::fill(g, target, tilts, projection, config)
}

fn clear(g: &mut Graph, name: &'static str, target: Image) {
    let params = ClearParams { size: target.size.map(|n| n as i32) };
    g.compute(name).shader("visibility/clear").writes("target", target).params(&params).dispatch([
        target.size[0].div_ceil(4),
        target.size[1],
        1,
    ]);
}

/// Bindings and parameters that passes over all points share.
struct Drawing<'f> {
    around: Surroundings<'f>,
    vpls: &'f Vpls,
    projection: Projection,
    columns: u32,
    config: &'f VisibilityConfig,
}

impl Drawing<'_> {
    fn dispatch(&self, points: &Points, pass: ComputePass<'_>) {
        let Self { around, vpls, projection, columns, config } = self;
        let own = config.ism.points == PointSet::Adaptive;
        let diagonal = around.scene.bounds().size().length();
        let pass = match projection {
            Projection::Paraboloid => pass,
            Projection::Orthographic(frames) => pass.part("projection", "visibility/projection-orthographic").reads("frames", *frames),
        };
        pass.reads("points", points.points)
            .reads("begins", points.begins)
            .reads("fill", points.fill)
            .reads("places", vpls.places)
            .constant("MAP_SIZE", config.ism.map_size)
            .constant("DISTORTION", config.ism.distortion)
            .constant("ROUND", !config.ism.normals)
            .constant("GAPS", points.gaps)
            .constant("GROWN", config.ism.pull_push.grow)
            .params(&SinglePixelParams {
                count: vpls.count,
                first: points.first,
                shares: if own { 1 } else { vpls.count },
                considered: if own { 1 } else { considered(config, vpls.count) },
                collected: if own { 1 } else { collected(config, vpls.count) },
                columns: *columns,
                far: diagonal,
                diagonal,
                enlarge: config.ism.enlarge.unwrap_or(match config.ism.points {
                    _ if config.ism.normals => TILTED_ENLARGE,
                    PointSet::Adaptive => ADAPTIVE_ENLARGE,
                    PointSet::Uniform => SINGLE_PIXEL_ENLARGE,
                }),
            })
            .dispatch_groups([points.partitions, points.each.div_ceil(POINTS_A_GROUP).max(1), 1]);
    }
}
