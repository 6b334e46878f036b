//! Memory of a frame's resources, each and by stage.

use super::stage;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Bytes by name, of each resource and of each stage.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Memory {
    pub resources: BTreeMap<String, u64>,
    pub stages: BTreeMap<String, u64>,
}

impl Memory {
    /// Sums resources (`stage/resource` and bytes) by name and by stage.
    pub fn of(resources: &[(String, u64)]) -> Self {
        let mut memory = Self::default();
        for (name, bytes) in resources {
            *memory.resources.entry(name.clone()).or_default() += bytes;
            *memory.stages.entry(stage(name).to_owned()).or_default() += bytes;
        }
        memory
    }
}

/// The resources as a text table, grouped under their stages' sums in the order of first appearance, with a total.
pub fn memory_table(resources: &[(String, u64)]) -> String {
    let mut stages: Vec<&str> = Vec::new();
    for (name, _) in resources {
        if !stages.contains(&stage(name)) {
            stages.push(stage(name));
        }
    }
    let mut rows = Vec::new();
    for name in stages {
        let own = || resources.iter().filter(|(resource, _)| stage(resource) == name);
        rows.push((name.to_owned(), own().map(|(_, bytes)| bytes).sum()));
        rows.extend(own().map(|(resource, bytes)| (format!("  {resource}"), *bytes)));
    }
    rows.push(("total".to_owned(), resources.iter().map(|(_, bytes)| bytes).sum()));
    numbers("memory of a frame", "bytes", &rows)
}

/// Counts of passes as a text table.
pub fn counts_table(counts: &[(String, u64)]) -> String {
    numbers("counts", "last frame", counts)
}

/// A text table of names on the left and whole numbers on the right.
fn numbers(name: &str, unit: &str, rows: &[(String, u64)]) -> String {
    let mut cells = vec![(name.to_owned(), unit.to_owned())];
    cells.extend(rows.iter().map(|(name, number)| (name.clone(), number.to_string())));
    let left = cells.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let right = cells.iter().map(|(_, number)| number.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, number) in cells {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:<left$}  {number:>right$}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resources() -> Vec<(String, u64)> {
        [("rsm/depth", 400), ("gbuffer/depth", 16), ("rsm/flux", 1600), ("rsm/flux", 1)]
            .map(|(name, bytes)| (name.to_owned(), bytes))
            .into()
    }

    #[test]
    fn resources_are_summed_by_name_and_by_stage() {
        let memory = Memory::of(&resources());
        let owned = |map: &BTreeMap<String, u64>| map.iter().map(|(name, bytes)| (name.clone(), *bytes)).collect::<Vec<_>>();
        let expected = |list: &[(&str, u64)]| list.iter().map(|(name, bytes)| ((*name).to_owned(), *bytes)).collect::<Vec<_>>();
        assert_eq!(owned(&memory.resources), expected(&[("gbuffer/depth", 16), ("rsm/depth", 400), ("rsm/flux", 1601)]));
        assert_eq!(owned(&memory.stages), expected(&[("gbuffer", 16), ("rsm", 2001)]));
    }

    #[test]
    fn the_table_lists_resources_under_their_stage_and_ends_with_the_total() {
        let expected = "\
memory of a frame  bytes
rsm                 2001
  rsm/depth          400
  rsm/flux          1600
  rsm/flux             1
gbuffer               16
  gbuffer/depth       16
total               2017
";
        assert_eq!(memory_table(&resources()), expected);
        assert_eq!(counts_table(&[("vpls/lit".to_owned(), 1000)]), "counts    last frame\nvpls/lit        1000\n");
    }
}
