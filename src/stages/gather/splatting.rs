//! Splatting, a rival of tiled stochastic light culling (Tokuyoshi and Harada 2017, table 2): the same VPLs, ranges and sums, by
//! rasterizing the hull of every VPL's range over the picture.

use super::shells::Shell;
use super::stochastic::{Ranges, Roulette, StochasticParams, bounds, is_coated, ranges};
use super::{Indirect, Visibility, explain};
use crate::config::GatherConfig;
use crate::gpu::Format;
use crate::graph::Graph;
use crate::shader_struct;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    struct ReorderParams {
        size: [i32; 2],
    }
}

/// Rasterizes every VPL's hull of 80 triangles and blends its light into the pixels covered (Dachsbacher and Stamminger 2006).
pub(super) fn splatting(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, roulette: Roulette, config: &GatherConfig) -> Indirect {
    let (gbuffer, shells, interleave) = (around.gbuffer, around.residents.shells(), around.wants.interleave);
    let ranges = ranges(g, gbuffer, vpls, roulette, config);
    let Ranges { spheres, spheroids, chances, lobes } = ranges;
    let sorted = g.image("gather/sorted", Format::Rgba32Float, interleave.of_all_sets(interleave.pixels_of_set(gbuffer.size)));
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let lists = bounds(g, shells, vpls, Shell::Eighty, true);
    g.raster("gather/splatting")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("lobes", lobes)
        .reads("spheres", spheres)
        .reads("spheroids", spheroids)
        .reads("chances", chances)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .constant("COATED", is_coated(vpls, around.wants.dielectric))
        .params(&StochasticParams::of(vpls, config))
        .color_sum("sum", sorted)
        .draw(lists);
    g.compute("gather/reorder")
        .reads("sorted", sorted)
        .writes("irradiance", irradiance)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .params(&ReorderParams { size: gbuffer.size.map(|side| side as i32) })
        .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    let shares = explain::roulette_shares(g, around, vpls, Visibility::None, &ranges, config);
    Indirect { irradiance, reflection: None, pattern: interleave, shares }
}
