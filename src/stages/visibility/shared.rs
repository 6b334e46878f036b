//! Imperfect shadow maps that neighbouring VPLs share. 65,536 maps, one a VPL, would take a gigabyte, and VPLs of adjoining texels see
//! nearly the same. The cost is bias: a VPL is shadowed from its neighbour's place.

use super::{Visibility, VisibilityConfig, ism};
use crate::graph::Graph;
use crate::shader_struct;
use crate::stages::facts::planned_turns;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::{VplPlace, Vpls};

shader_struct! {
    struct ProxiesParams {
        size: [u32; 2],
        blocks: [u32; 2],
        count: u32,
        proxies: u32,
    }
}

/// Texels whose VPLs share a map, at most: `glsl/visibility/proxies.comp` takes about nine loop turns for each.
pub const MOST_TEXELS_A_MAP: u64 = planned_turns(36_864) / 9;

/// Blocks across and down a layer, nearly square, of which all layers together have at most `maps`.
fn blocks(size: [u32; 2], layers: u32, maps: u32) -> [u32; 2] {
    let each = (maps / layers).max(1);
    let columns = (f64::from(each) * f64::from(size[0]) / f64::from(size[1])).sqrt() as u32;
    let columns = columns.clamp(1, size[0].min(each));
    [columns, (each / columns).clamp(1, size[1])]
}

/// A map for each block of texels, seen from the lit VPL nearest to the block's middle. `vpls` must have one VPL a texel.
pub(super) fn render(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, maps: u32, config: &VisibilityConfig) -> Visibility {
    let blocks = blocks(around.rsm.size, around.rsm.layers, maps);
    let count = blocks[0] * blocks[1] * around.rsm.layers;
    let proxies = Vpls {
        count,
        places: g.buffer::<VplPlace>("visibility/proxies", count),
        areas: g.buffer::<f32>("visibility/proxy-areas", count),
        ..*vpls
    };
    let labels = g.buffer::<u32>("visibility/labels", vpls.count);
    g.compute("visibility/proxies")
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .writes("proxy_places", proxies.places)
        .writes("proxy_areas", proxies.areas)
        .writes("labels", labels)
        .params(&ProxiesParams { size: around.rsm.size, blocks, count: vpls.count, proxies: count })
        .dispatch([count, 1, 1]);
    match ism::render(g, around, &proxies, config) {
        Visibility::Ism(ism) => Visibility::SharedIsm { ism, labels, proxies: proxies.places },
        other => unreachable!("imperfect shadow maps are no {other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_square_and_no_more_than_maps() {
        assert_eq!(blocks([256, 256], 1, 1024), [32, 32]);
        assert_eq!(blocks([512, 128], 1, 1024), [64, 16]);
        assert_eq!(blocks([256, 256], 6, 1024), [13, 13]);
        assert_eq!(blocks([4, 4], 2, 1), [1, 1]);
        assert_eq!(blocks([2, 2], 1, 1000), [2, 2]);
    }
}
