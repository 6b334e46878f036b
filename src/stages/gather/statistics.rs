//! Light lists, counted and pictured: `gather.per_pixel.statistics` and `gather.stochastic.statistics`.

use crate::gpu::Format;
use crate::graph::{ComputePass, Graph, Image};
use crate::shader_struct;
use crate::stages::gbuffer::GBuffer;
use std::collections::BTreeMap;

shader_struct! {
    struct StatisticsParams {
        size: [i32; 2],
    }
}

/// Image of each pixel's numbers of VPLs: diffuse ones on its lists and shining, then glossy ones; `None` unless they are counted.
pub(super) fn numbers(g: &mut Graph, gbuffer: &GBuffer, are_counted: bool) -> Option<Image> {
    are_counted.then(|| g.image("gather/numbers", Format::Rgba32Float, gbuffer.size))
}

/// A gather's pass that stores the numbers, if there is an image of them.
pub(super) fn counting(pass: ComputePass<'_>, numbers: Option<Image>) -> ComputePass<'_> {
    match numbers {
        None => pass,
        Some(numbers) => pass.part("numbers", "gather/numbers-counted").writes("numbers", numbers),
    }
}

/// Draws the length of pixels' light lists and their false discovery rate (figures 9 and 10). Counts `gather/pixels`, and pairs of pixel
/// and VPL: `gather/diffuse-listed`, of which `gather/diffuse-lit` shine and `gather/diffuse-wrong` do not; the same for glossy VPLs. A
/// pixel's list is that of its half of the tile; a subgroup with pixels of both halves walks both.
pub(super) fn counted(g: &mut Graph, gbuffer: &GBuffer, numbers: Option<Image>) {
    let Some(numbers) = numbers else { return };
    let picture = g.image("gather/statistics", Format::Rgba8Unorm, gbuffer.size);
    let names = ["pixels", "diffuse-listed", "diffuse-lit", "diffuse-wrong", "glossy-listed", "glossy-lit", "glossy-wrong"];
    let [pixels, diffuse_listed, diffuse_lit, diffuse_wrong, glossy_listed, glossy_lit, glossy_wrong] =
        names.map(|name| g.count(&format!("gather/{name}")));
    g.compute("gather/statistics")
        .reads("depth", gbuffer.depth)
        .reads("numbers", numbers)
        .updates("pixels", pixels)
        .updates("diffuse_listed", diffuse_listed)
        .updates("diffuse_lit", diffuse_lit)
        .updates("diffuse_wrong", diffuse_wrong)
        .updates("glossy_listed", glossy_listed)
        .updates("glossy_lit", glossy_lit)
        .updates("glossy_wrong", glossy_wrong)
        .writes("picture", picture)
        .params(&StatisticsParams { size: gbuffer.size.map(|n| n as i32) })
        .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
}

/// Means a pixel, for diffuse and glossy VPLs: VPLs on its light lists, VPLs among these that shine there, and the share that does not (the
/// false discovery rate). Empty without counters.
pub fn means(counts: &BTreeMap<String, u64>) -> BTreeMap<String, f64> {
    let of = |name: &str| counts.get(name).map(|count| *count as f64);
    let mut means = BTreeMap::new();
    let Some(pixels) = of("gather/pixels").filter(|pixels| *pixels > 0.0) else { return means };
    for kind in ["diffuse", "glossy"] {
        let [listed, lit] = ["listed", "lit"].map(|what| format!("gather/{kind}-{what}"));
        if let (Some(on_list), Some(shining)) = (of(&listed), of(&lit)) {
            means.insert(listed, on_list / pixels);
            means.insert(lit, shining / pixels);
            means.insert(format!("gather/{kind}-false-discovery"), if on_list > 0.0 { 1.0 - shining / on_list } else { 0.0 });
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_there_where_lights_were_counted() {
        assert!(means(&[("vpls/count".to_owned(), 7)].into()).is_empty());
        let counts = [("pixels", 4), ("diffuse-listed", 0), ("diffuse-lit", 0), ("glossy-listed", 10), ("glossy-lit", 4)];
        let means = means(&counts.map(|(name, count)| (format!("gather/{name}"), count)).into());
        assert_eq!((means["gather/glossy-listed"], means["gather/glossy-lit"], means["gather/diffuse-false-discovery"]), (2.5, 1.0, 0.0));
        assert!((means["gather/glossy-false-discovery"] - 0.6).abs() < 1e-12);
    }
}
