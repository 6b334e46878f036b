//! Surfaces from single pixels (Marroquim et al. 2007; Linke 2016, section 4.4.4). The pull phase averages four texels into one of the next
//! coarser level. The push phase fills empty and hidden texels from the coarser level.

use super::VisibilityConfig;
use super::ism::Projection;
use crate::config::{PullPushConfig, PullWeights};
use crate::gpu::Format;
use crate::graph::{Graph, Image};
use crate::shader_struct;

shader_struct! {
    struct PullParams {
        size: [i32; 2],
        /// Width of a texel of the coarser level, in texels of the finest.
        texel: f32,
    }

    struct PushParams {
        size: [i32; 2],
        tile: i32,
        /// Texels of the finer level along one of the finest level.
        scale: f32,
    }
}

const PULL: [&str; 8] = [
    "visibility/pull-1",
    "visibility/pull-2",
    "visibility/pull-3",
    "visibility/pull-4",
    "visibility/pull-5",
    "visibility/pull-6",
    "visibility/pull-7",
    "visibility/pull-8",
];
const PUSH: [&str; 8] = [
    "visibility/push-0",
    "visibility/push-1",
    "visibility/push-2",
    "visibility/push-3",
    "visibility/push-4",
    "visibility/push-5",
    "visibility/push-6",
    "visibility/push-7",
];

/// Fills the holes in maps of single pixels; passes are named by the level that they write. `tilts` are given if normals are kept.
pub(super) fn fill(g: &mut Graph, pixels: Image, tilts: Option<Image>, projection: Projection, config: &VisibilityConfig) -> Image {
    // The coarsest level has one texel a map.
    let levels = config.ism.map_size.ilog2() as usize;
    let size = |level: usize| pixels.size.map(|n| n >> level);
    let signed = |level: usize| size(level).map(|n| n as i32);
    let (format, disk) = match tilts {
        None => (Format::Rg32Uint, "visibility/disk-facing"),
        Some(_) => (Format::Rgba32Uint, "visibility/disk-tilted"),
    };
    let PullPushConfig { weights, grow, interval, spread } = config.ism.pull_push;
    let gaussian = weights == PullWeights::Gaussian;
    // The ellipses of points with normals close gaps well enough.
    let spread = if tilts.is_some() { 0.0 } else { spread };
    let pulled: Vec<Image> = (1..=levels).map(|level| g.image(&format!("visibility/pulled-{level}"), format, size(level))).collect();
    for level in 1..=levels {
        let mut pass = g.compute(PULL[level - 1]).part("disk", disk).constant("SPREAD", spread).constant("GAUSSIAN", gaussian);
        if tilts.is_some() {
            pass = pass.constant("GROWN", grow);
        }
        pass = if level == 1 {
            let first = pass.shader("visibility/pull-first").reads("finer", pixels);
            first.constant("MAP_SIZE", config.ism.map_size).constant("DISTORTION", config.ism.distortion)
        } else {
            pass.shader("visibility/pull").reads("finer", pulled[level - 2])
        };
        pass = match (level, tilts, projection) {
            (1, Some(tilts), _) => pass.part("extent", "visibility/extent-tilted").reads("tilts", tilts),
            (1, None, Projection::Orthographic(frames)) => pass.part("extent", "visibility/extent-orthographic").reads("frames", frames),
            (1, None, Projection::Paraboloid) => pass.constant("INTERVAL", interval),
            _ => pass,
        };
        pass.writes("coarser", pulled[level - 1]).params(&PullParams { size: signed(level), texel: (1u32 << level) as f32 }).dispatch([
            size(level)[0],
            size(level)[1],
            1,
        ]);
    }
    let maps = g.image("visibility/maps", Format::R32Float, pixels.size);
    for level in (0..levels).rev() {
        let mut pass = g.compute(PUSH[level]).part("disk", disk).constant("GAUSSIAN", gaussian);
        if tilts.is_some() {
            pass = pass.constant("GROWN", grow);
        }
        let pass = if level == 0 {
            pass.shader("visibility/push-last").reads("finer", pixels).writes("maps", maps)
        } else {
            pass.shader("visibility/push").updates("finer", pulled[level - 1])
        };
        // An invocation fills the four texels around a corner of a coarser texel.
        pass.reads("coarser", pulled[level])
            .constant("CLAMP", config.ism.clamp)
            .params(&PushParams { size: signed(level), tile: (config.ism.map_size >> level) as i32, scale: 1.0 / (1u32 << level) as f32 })
            .dispatch([size(level + 1)[0] + 1, size(level + 1)[1] + 1, 1]);
    }
    maps
}
