//! What follows from what `gather.stochastic.statistics` counts.

use std::collections::BTreeMap;

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
