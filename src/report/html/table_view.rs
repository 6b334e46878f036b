//! A table in the form that the template takes: the comparable figures of ours and the paper's, with notes.

use super::folders::Run;
use super::numbers;
use super::table::TableFile;
use crate::report::percent;
use serde::Serialize;
use std::collections::BTreeSet;

/// A table in the form that the template takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableView {
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
    /// Reasons for empty cells, without repetitions.
    pub whys: Vec<String>,
    /// Whether there are ratios to the table's base.
    pub has_relative: bool,
    /// Whether there are shares of the table's whole.
    pub has_shares: bool,
    /// Whether there are published times.
    pub has_published_times: bool,
    /// `median of 5 frames` for tables with times.
    pub frames: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    pub name: String,
    /// Unit of all its cells; empty if they differ.
    pub unit: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub name: String,
    pub cells: Vec<CellView>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct CellView {
    /// The measure in words.
    pub measure: String,
    pub ours: Option<String>,
    /// Unit, if the column has none.
    pub unit: String,
    pub range: Option<String>,
    pub paper: Option<String>,
    pub share: Option<String>,
    pub paper_share: Option<String>,
    pub relative: Option<String>,
    pub paper_relative: Option<String>,
    /// Index of the reason in [`TableView::whys`], from 1.
    pub why: Option<usize>,
    /// Key of the figure's run.
    pub run: Option<String>,
}

/// Lays out a table.
pub fn view(table: &TableFile) -> TableView {
    let column = |at: usize| table.cells.iter().map(move |row| &row[at]);
    let label = |unit: &str| match unit {
        "ms" => format!("ms, {}", table.device.kind),
        "x" => "×".to_owned(),
        // Each figure in bytes has its own unit.
        "bytes" => String::new(),
        unit => unit.to_owned(),
    };
    let mut columns = Vec::new();
    let mut rows: Vec<Row> = table.rows.iter().map(|name| Row { name: name.clone(), cells: Vec::new() }).collect();
    let mut whys: Vec<String> = Vec::new();
    for (at, name) in table.columns.iter().enumerate() {
        let mut units = column(at).map(|cell| cell.unit.as_str());
        let first = units.next().unwrap_or_default();
        let uniform = units.all(|unit| unit == first);
        columns.push(Column { name: name.clone(), unit: if uniform { label(first) } else { String::new() } });
        // Our figures have the same decimals, so that they line up, and the paper's those that it prints.
        let figures: Vec<Option<f64>> = column(at).flat_map(|cell| [cell.value, cell.p5, cell.p95]).collect();
        let aligned = if uniform && first == "ms" { Some(numbers::column(&figures)) } else { None };
        for (row, cell) in column(at).enumerate() {
            let text = |part: usize, figure: Option<f64>| match &aligned {
                Some(texts) => texts[row * 3 + part].clone(),
                None => figure.map(|figure| if cell.unit == "bytes" { numbers::bytes(figure) } else { numbers::short(figure) }),
            };
            let why = cell.why.as_ref().filter(|_| cell.value.is_none()).map(|why| {
                whys.iter().position(|known| known == why).unwrap_or_else(|| {
                    whys.push(why.clone());
                    whys.len() - 1
                }) + 1
            });
            rows[row].cells.push(CellView {
                measure: cell.measure.clone(),
                ours: text(0, cell.value),
                unit: if uniform { String::new() } else { label(&cell.unit) },
                range: match cell.spread {
                    Some(spread) => Some(format!("±{}", numbers::short(spread))),
                    None => text(1, cell.p5).zip(text(2, cell.p95)).map(|(low, high)| format!("{low}–{high}")),
                },
                paper: cell.published.map(|figure| if cell.unit == "bytes" { numbers::bytes(figure) } else { figure.to_string() }),
                share: cell.share.map(percent),
                paper_share: cell.published_share.map(percent),
                relative: cell.relative.map(numbers::short),
                paper_relative: cell.published_relative.map(numbers::short),
                why,
                run: cell.run.clone(),
            });
        }
    }
    let cells = || table.cells.iter().flatten();
    TableView {
        has_relative: cells().any(|cell| cell.relative.is_some() || cell.published_relative.is_some()),
        has_shares: cells().any(|cell| cell.share.is_some() || cell.published_share.is_some()),
        has_published_times: cells().any(|cell| cell.unit == "ms" && cell.published.is_some()),
        frames: frames(cells().filter(|cell| cell.spread.is_none()).filter_map(|cell| cell.n)),
        columns,
        rows,
        whys,
    }
}

/// Notes on a table: how it ran, the setup of the published figures, and the differences of ours.
pub fn notes(table: &TableFile, view: &TableView, runs: &[Run]) -> Vec<String> {
    let mut how = Vec::new();
    if !table.complete {
        how.push("Incomplete: some cells were not run.".to_owned());
    }
    if table.quick {
        how.push("A quick run, which is less exact than a whole one.".to_owned());
    }
    if table.scale != 1.0 {
        how.push(format!("Run at {} of the published size.", numbers::short(table.scale)));
    }
    how.extend(view.frames.as_ref().map(|frames| format!("Times are the {frames}.")));
    let of = |base: &Option<String>| base.as_deref().unwrap_or("the table's base").to_owned();
    if view.has_shares {
        how.push(format!("n % is a time's share of {}.", of(&table.share_of)));
    }
    if view.has_relative {
        how.push(format!("n× is a figure over that of {}.", of(&table.relative_to)));
    }
    let published = table.published.as_ref();
    let facts = published.map(|published| [&published.hardware, &published.scene, &published.settings]);
    let facts: Vec<&str> = facts.into_iter().flatten().flatten().map(String::as_str).collect();
    let mut paper = Vec::new();
    if !facts.is_empty() {
        paper.push(format!("The paper's figures are of {}.", facts.join("; ")));
    }
    if view.has_published_times {
        paper.push("Times of ours and of the paper are of different hardware: compare shares and ratios.".to_owned());
    }
    let sentence = |text: &String| if text.ends_with(['.', '?', '!']) { text.clone() } else { format!("{text}.") };
    let deviations = match table.deviations.as_slice() {
        [] => String::new(),
        texts => format!("Ours differs: {}", texts.iter().map(sentence).collect::<Vec<_>>().join(" ")),
    };
    let warnings = match table.warnings.as_slice() {
        [] => String::new(),
        texts => format!("Warnings: {}", texts.iter().map(sentence).collect::<Vec<_>>().join(" ")),
    };
    let notes = [origin(table, runs), how.join(" "), paper.join(" "), warnings, deviations];
    notes.into_iter().filter(|note| !note.is_empty()).collect()
}

/// Scenes, device, driver and timing mode of a table, and the resolutions and presets of its runs.
fn origin(table: &TableFile, runs: &[Run]) -> String {
    let device = format!("{}, {}", table.device.label(), table.device.driver_label());
    let mut all = table.scenes.clone();
    all.extend([device, format!("{} timing", table.timing_mode)]);
    let distinct = |part: fn(&Run) -> String| runs.iter().map(part).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(", ");
    if !runs.is_empty() {
        all.push(format!("{} pixels", distinct(|run| format!("{} × {}", run.record.from.width, run.record.from.height))));
        all.push(format!("preset {}", distinct(|run| run.record.from.preset.clone())));
    }
    all.push(format!("manylight {}", table.version));
    format!("{}.", all.join("; "))
}

fn frames(counts: impl Iterator<Item = usize> + Clone) -> Option<String> {
    let (least, most) = (counts.clone().min()?, counts.max()?);
    let range = if least == most { format!("{most}") } else { format!("{least}–{most}") };
    Some(format!("median, 5th to 95th percentile of {range} {}", if most == 1 { "frame" } else { "frames" }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::samples::run;
    use crate::report::html::table::Published;
    use serde_json::json;

    fn table(kind: &str) -> TableFile {
        serde_json::from_value(json!({
            "name": "t", "title": "T", "version": "0.1.0", "timing_mode": "isolated",
            "device": { "name": "d", "kind": kind, "driver": "e", "driver_version": "1" },
            "rows": ["1x1", "4x4"], "columns": ["gather", "speed-up", "memory"],
            "cells": [
                [
                    { "unit": "ms", "value": 412.04, "p5": 400, "p95": 431.96, "n": 5, "published": 40.24, "share": 0.5, "published_share": 0.25, "relative": 1, "published_relative": 1 },
                    { "unit": "x", "value": 1.0, "published": 1.0 },
                    { "unit": "bytes", "value": 1048576, "published": 2097152 },
                ],
                [
                    { "unit": "ms", "value": null, "published": 20.12, "published_relative": 0.5, "why": "too long" },
                    { "unit": "x", "value": null, "published": 2.0, "why": "too long" },
                    { "unit": "", "value": 7 },
                ],
            ],
        }))
        .unwrap()
    }

    #[test]
    fn every_device_has_the_papers_figures_beside_its_own_with_shares_and_ratios_of_both() {
        for kind in ["cpu", "gpu"] {
            let view = view(&table(kind));
            let papers = |row: usize| view.rows[row].cells.iter().map(|cell| cell.paper.as_deref()).collect::<Vec<_>>();
            assert_eq!(papers(0), [Some("40.24"), Some("1"), Some("2.00 MiB")]);
            assert_eq!(papers(1), [Some("20.12"), Some("2"), None]);
            let [first, second] = [&view.rows[0].cells[0], &view.rows[1].cells[0]];
            assert_eq!((first.share.as_deref(), first.paper_share.as_deref()), (Some("50.0 %"), Some("25.0 %")));
            assert_eq!((second.relative.as_deref(), second.paper_relative.as_deref()), (None, Some("0.500")));
            assert_eq!(view.columns[0].unit, format!("ms, {kind}"));
            assert!(view.has_published_times && view.has_shares && view.has_relative);
        }
    }

    #[test]
    fn a_cell_has_its_range_its_unit_or_the_reason_why_it_is_empty() {
        let view = view(&table("cpu"));
        let [time, ratio, memory] = view.rows[0].cells.as_slice() else { panic!() };
        assert_eq!((time.ours.as_deref(), time.range.as_deref(), time.unit.as_str()), (Some("412.0"), Some("400.0–432.0"), ""));
        assert_eq!((ratio.ours.as_deref(), ratio.range.as_deref()), (Some("1.00"), None));
        assert_eq!((memory.ours.as_deref(), view.columns[2].unit.as_str()), (Some("1.00 MiB"), ""));
        assert_eq!(view.whys, ["too long"]);
        assert!(view.rows[1].cells[..2].iter().all(|cell| cell.ours.is_none() && cell.why == Some(1)));
        assert_eq!(view.frames.as_deref(), Some("median, 5th to 95th percentile of 5 frames"));
    }

    #[test]
    fn a_table_says_how_it_was_run_and_what_it_is_held_against() {
        let mut table = table("cpu");
        (table.scenes, table.warnings) = (vec!["a room (12 triangles)".to_owned()], vec!["it is dark".to_owned()]);
        table.deviations = vec!["another scene".to_owned(), "Another light.".to_owned()];
        table.published = Some(Published { hardware: Some("a GPU".to_owned()), scene: None, settings: Some("1024 VPLs".to_owned()) });
        (table.scale, table.quick, table.complete) = (0.5, true, false);
        (table.share_of, table.relative_to) = (Some("the frame".to_owned()), Some("1x1".to_owned()));
        let notes = notes(&table, &view(&table), &[run("a"), run("b")]);
        assert_eq!(
            notes[0],
            "a room (12 triangles); d [cpu], e 1; isolated timing; 960 × 540 pixels; preset first-light; manylight 0.1.0."
        );
        let text = notes.join("\n");
        for part in [
            "Incomplete",
            "A quick run",
            "0.500 of the published size",
            "5 frames",
            "a GPU; 1024 VPLs",
            "different hardware",
            "share of the frame",
            "over that of 1x1",
            "Warnings: it is dark.",
            "Ours differs: another scene. Another light.",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
