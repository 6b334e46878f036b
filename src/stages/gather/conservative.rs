//! Conservative clusters, a rival of tiled stochastic light culling (Tokuyoshi and Harada 2017, table 2): the same VPLs, ranges and sums,
//! with light lists of froxels that the hulls of the VPLs' ranges are rasterized into.

use super::shells::Shell;
use super::statistics::{counted, counting, numbers};
use super::stochastic::{Ranges, Roulette, StochasticParams, bounds, is_coated, ranges};
use super::{Indirect, Visibility, explain};
use crate::config::{GatherConfig, Rasterization};
use crate::gpu::Format;
use crate::graph::Graph;
use crate::shader_struct;
use crate::stages::interleave::Interleave;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    struct ShellListsParams {
        count: u32,
        capacity: u32,
    }
}

/// Pixels along a tile's side, and depth slices of a tile: `glsl/gather/shell-froxel.glsl`.
const TILE: u32 = 16;
const SLICES: u32 = 32;

/// Bytes of the buffer that [`conservative_clusters`] keeps for one kind of VPLs: two words a VPL and tile of its sample set.
pub(super) fn shell_bytes(size: [u32; 2], interleave: Interleave, vpls: u32) -> u64 {
    let [across, down] = interleave.pixels_of_set(size).map(|side| u64::from(side.div_ceil(TILE)));
    8 * across * down * u64::from(vpls)
}

/// Light lists of froxels, by conservative rasterization of the VPLs' hulls of 20 triangles (Oertegren and Persson 2016). Counts
/// `gather/nodes` of the lists, and `gather/lost`: nodes beyond the capacity, whose light is missing.
pub(super) fn conservative_clusters(
    g: &mut Graph,
    around: Surroundings<'_>,
    vpls: &Vpls,
    roulette: Roulette,
    config: &GatherConfig,
) -> Indirect {
    let (gbuffer, shells, interleave) = (around.gbuffer, around.residents.shells(), around.wants.interleave);
    let ranges = ranges(g, gbuffer, vpls, roulette, config);
    let Ranges { spheres, spheroids, chances, lobes } = ranges;
    let tiles = interleave.pixels_of_set(gbuffer.size).map(|side| side.div_ceil(TILE));
    let in_set = tiles[0] * tiles[1];
    let touched = g.image("gather/touched", Format::R32Float, interleave.of_all_sets(tiles));
    let shells_of = |there: bool| if there { vpls.count * in_set } else { 1 };
    let diffuse_shells = g.zeroed::<[u32; 2]>("gather/diffuse-shells", shells_of(vpls.diffuse));
    let glossy_shells = g.zeroed::<[u32; 2]>("gather/glossy-shells", shells_of(vpls.lobes.is_some()));
    let by_extension = config.conservative_clusters.rasterization.resolved(shells.conservative()) == Rasterization::Extension;
    let lists = bounds(g, shells, vpls, if by_extension { Shell::Corners } else { Shell::Twenty }, false);
    let pass = match by_extension {
        true => {
            let corners = shells.corners(g, "gather/corners");
            g.raster("gather/shells").shader("gather/shells-extension").reads("corners", corners).conservatively()
        }
        false => g.raster("gather/shells"),
    };
    pass.reads("view", gbuffer.view)
        .reads("spheres", spheres)
        .reads("spheroids", spheroids)
        .updates("diffuse_shells", diffuse_shells)
        .updates("glossy_shells", glossy_shells)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .color("touched", touched, [0.0; 4])
        .draw(lists);
    let heads = g.buffer::<[u32; 2]>("gather/heads", interleave.sets() * in_set * SLICES);
    let nodes = g.buffer::<[u32; 2]>("gather/list-nodes", config.conservative_clusters.nodes);
    let (used, lost) = (g.count("gather/nodes"), g.count("gather/lost"));
    g.compute("gather/shell-lists")
        .reads("view", gbuffer.view)
        .reads("diffuse_shells", diffuse_shells)
        .reads("glossy_shells", glossy_shells)
        .writes("heads", heads)
        .writes("nodes", nodes)
        .updates("used", used)
        .updates("lost", lost)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .constant("DIFFUSE", vpls.diffuse)
        .constant("LOBES", vpls.lobes.is_some())
        .params(&ShellListsParams { count: vpls.count, capacity: config.conservative_clusters.nodes })
        .dispatch_groups([tiles[0], tiles[1], interleave.sets()]);
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let numbers = numbers(g, gbuffer, config.stochastic.statistics);
    let groups = interleave.groups(gbuffer.size, [8, 8]);
    counting(g.compute("gather/conservative-clusters"), numbers)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("lobes", lobes)
        .reads("chances", chances)
        .reads("heads", heads)
        .reads("nodes", nodes)
        .writes("irradiance", irradiance)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .constant("COATED", is_coated(vpls, around.wants.dielectric))
        .params(&StochasticParams::of(vpls, config))
        .dispatch_groups([groups[0], groups[1], 1]);
    counted(g, gbuffer, numbers);
    let shares = explain::roulette_shares(g, around, vpls, Visibility::None, &ranges, config);
    Indirect { irradiance, reflection: None, pattern: interleave, shares }
}
