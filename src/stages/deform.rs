//! Meshes that bend: their vertices are bent ahead of all that sees them.

use super::methods::{Method, NOTHING};
use super::residents::FrameResidents;
use crate::gpu::Format;
use crate::graph::Graph;
use crate::world::bent::POSE_COLUMNS;
use crate::world::device::FrameScene;

/// Workgroups of a row of the dispatch, at most: `glsl/deform/vertices.comp`.
const ROW: u32 = 32_768;

/// The slot's one method, with the features it needs.
pub fn method() -> Method {
    Method::only("deform", "vertices", NOTHING)
}

/// Bends the scene's meshes, by skins and morph targets, to the pose of the frame. The scene that it returns has the bent vertices, and
/// the residents the bent positions. Without a mesh that bends it does nothing.
pub fn vertices<'f>(g: &mut Graph, scene: FrameScene<'f>, residents: &FrameResidents<'_>) -> FrameScene<'f> {
    let Some(bending) = scene.bending else { return scene };
    let pose = g.image("deform/pose", Format::Rgba32Uint, [POSE_COLUMNS, bending.pose.count / POSE_COLUMNS]);
    g.compute("deform/pose").reads("words", bending.pose).writes("pose", pose).dispatch([pose.size[0], pose.size[1], 1]);
    let positions = residents.positions();
    let mut pass = g
        .compute("deform/vertices")
        .reads("runs", bending.runs)
        .reads("rest", bending.rest)
        .reads("influences", bending.influences)
        .reads("deltas", bending.deltas)
        .reads("pose", pose)
        .writes("vertices", scene.vertices);
    if let Some(positions) = positions {
        pass = pass.part("positions", "deform/positions-kept").writes("positions", positions);
    }
    pass.dispatch_groups([bending.runs.count.min(ROW), bending.runs.count.div_ceil(ROW), 1]);
    scene
}
