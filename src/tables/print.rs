//! Output of tables as text, Markdown and CSV.

use super::cells::{Cell, Results};
use crate::report::percent;
use anyhow::{Context, Result};
use std::fmt::Write;

/// The table as text for a terminal.
pub fn text(results: &Results) -> String {
    let rows = lines(results);
    let columns = results.columns.len() + 1;
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = format!("{}\n", heading(results));
    for row in &rows {
        let _ = write!(text, "{:<width$}", row[0], width = widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(text, "  {cell:>width$}");
        }
        text.push('\n');
    }
    for note in notes(results) {
        let _ = writeln!(text, "{note}");
    }
    text
}

/// The table as Markdown, with a heading.
pub fn markdown(results: &Results) -> String {
    let escape = |text: &str| text.replace('|', "\\|").replace('\n', " ");
    let mut text = format!("### {}\n\n", escape(&heading(results)));
    if let Some(about) = &results.about {
        let _ = writeln!(text, "{about}\n");
    }
    for (i, row) in lines(results).iter().enumerate() {
        // Lines under a row stand out by their slant, since Markdown knows no indentation.
        let name = match row[0].strip_prefix(INDENT) {
            Some(name) => format!("*{}*", escape(name)),
            None => escape(&row[0]),
        };
        let cells: Vec<String> = std::iter::once(name).chain(row[1..].iter().map(|cell| escape(cell))).collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
        if i == 0 {
            let _ = writeln!(text, "|---|{}", "---:|".repeat(results.columns.len()));
        }
    }
    text.push('\n');
    for note in notes(results) {
        let _ = writeln!(text, "{}  ", escape(&note));
    }
    text
}

/// The table as CSV, one cell per line, figures in full precision.
pub fn csv(results: &Results) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let put =
        |writer: &mut csv::Writer<Vec<u8>>, record: Vec<String>| writer.write_record(record).context("table.csv cannot be put together");
    let head = [
        "table",
        "row",
        "column",
        "measure",
        "unit",
        "value",
        "p5",
        "p95",
        "spread",
        "n",
        "published",
        "share",
        "published_share",
        "relative",
        "published_relative",
        "run",
        "reference",
        "why",
        "scale",
        "quick",
        "mode",
        "device",
        "driver",
        "version",
    ];
    put(&mut writer, head.map(str::to_owned).to_vec())?;
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let (device, driver) = results.device.as_ref().map_or_else(Default::default, |device| (device.label(), device.driver_label()));
    for (row, cells) in results.rows.iter().zip(&results.cells) {
        for (column, cell) in results.columns.iter().zip(cells) {
            let own = [results.name.clone(), row.clone(), column.clone(), cell.measure.clone(), cell.unit.to_owned()];
            let numbers = [
                number(cell.value),
                number(cell.p5),
                number(cell.p95),
                number(cell.spread),
                number(cell.n.map(|n| n as f64)),
                number(cell.published),
            ];
            let ratios = [cell.share, cell.published_share, cell.relative, cell.published_relative].map(number);
            let [run, reference, why] = [&cell.run, &cell.reference, &cell.why].map(|text| text.clone().unwrap_or_default());
            let from = [results.scale.to_string(), results.quick.to_string(), results.timing_mode.clone().unwrap_or_default()];
            let record = own.into_iter().chain(numbers).chain(ratios).chain([run, reference, why]).chain(from);
            put(&mut writer, record.chain([device.clone(), driver.clone(), results.version.clone()]).collect())?;
        }
    }
    writer.into_inner().context("table.csv cannot be put together")
}

fn heading(results: &Results) -> String {
    match &results.source {
        Some(source) => format!("{} ({source})", results.title),
        None => results.title.clone(),
    }
}

/// What stands before the name of a line that belongs to the row above.
const INDENT: &str = "  ";

/// Names and cells, row by row; the first row holds the columns' names. Under a row stand its shares and ratios, and the paper's figures with
/// theirs.
fn lines(results: &Results) -> Vec<Vec<String>> {
    let mut lines = vec![std::iter::once(String::new()).chain(results.columns.iter().cloned()).collect::<Vec<_>>()];
    for (name, cells) in results.rows.iter().zip(&results.cells) {
        lines.push(std::iter::once(name.clone()).chain(cells.iter().map(ours)).collect());
        let mut under = |name: String, figure: &dyn Fn(&Cell) -> Option<String>| {
            let figures: Vec<Option<String>> = cells.iter().map(figure).collect();
            if figures.iter().any(Option::is_some) {
                let figures = figures.into_iter().map(Option::unwrap_or_default);
                lines.push(std::iter::once(format!("{INDENT}{name}")).chain(figures).collect());
            }
        };
        let share = results.share_of.as_ref().map_or_else(String::new, |whole| format!("share of {whole}"));
        let over = results.relative_to.as_ref().map_or_else(String::new, |base| format!("over {base}"));
        // A line of wholes over themselves says nothing.
        let says = |of: fn(&Cell) -> Option<f64>| cells.iter().filter_map(of).any(|ratio| ratio != 1.0);
        if says(|cell| cell.share) {
            under(share.clone(), &|cell| cell.share.map(percent));
        }
        if says(|cell| cell.relative) {
            under(over.clone(), &|cell| cell.relative.map(|ratio| figure(ratio, "x")));
        }
        under("paper".to_owned(), &|cell| cell.published.map(|value| as_published(value, cell.unit)));
        if says(|cell| cell.published_share) {
            under(format!("paper, {share}"), &|cell| cell.published_share.map(percent));
        }
        if says(|cell| cell.published_relative) {
            under(format!("paper, {over}"), &|cell| cell.published_relative.map(|ratio| figure(ratio, "x")));
        }
    }
    lines
}

impl Results {
    /// Sizes of the runs' pictures, from the largest on: `1920x1080`.
    fn sizes(&self) -> Vec<String> {
        let size = |run: &serde_json::Value| Some([run["width"].as_u64()?, run["height"].as_u64()?]);
        let mut sizes: Vec<[u64; 2]> = self.runs.values().filter_map(size).collect();
        sizes.sort_unstable_by_key(|[width, height]| std::cmp::Reverse(width * height));
        sizes.dedup();
        sizes.into_iter().map(|[width, height]| format!("{width}x{height}")).collect()
    }

    /// What our times are: their mode, the number of frames, and how these spread.
    fn times(&self) -> Option<String> {
        let timed: Vec<&Cell> = self.cells.iter().flatten().filter(|cell| cell.unit == "ms" && cell.value.is_some()).collect();
        let frames: std::collections::BTreeSet<u64> = timed.iter().filter_map(|cell| cell.n).collect();
        let frames: Vec<String> = frames.iter().map(u64::to_string).collect();
        let half = |cell: &&Cell| Some(0.5 * (cell.p95? - cell.p5?) / cell.value.filter(|value| *value > 0.0)?);
        let mut spreads: Vec<f64> = timed.iter().filter_map(half).collect();
        spreads.sort_unstable_by(f64::total_cmp);
        let (middle, worst) = (spreads.get(spreads.len() / 2)?, spreads.last()?);
        let mode = match self.timing_mode.as_deref() {
            Some("isolated") => "each pass by itself, between barriers",
            Some("overlapped") => "passes overlap",
            _ => "each pass in a submission of its own",
        };
        Some(format!(
            "times: medians of {} frames, {mode}; nine frames of ten are within ±{:.0} % of theirs, ±{:.0} % at worst",
            frames.join(" or "),
            100.0 * middle,
            100.0 * worst
        ))
    }
}

/// Our figure of a cell.
fn ours(cell: &Cell) -> String {
    let Some(value) = cell.value else { return "-".to_owned() };
    let mut text = figure(value, cell.unit);
    if let Some(spread) = cell.spread {
        let _ = write!(text, " ±{}", figure(spread, cell.unit));
    }
    text
}

/// Bytes of a MiB, which papers write as MB.
const MIB: f64 = 1_048_576.0;

/// A paper's figure with all of its digits, and its unit.
fn as_published(value: f64, unit: &str) -> String {
    match unit {
        "bytes" => format!("{} MiB", value / MIB),
        "" => format!("{value}"),
        "x" => format!("{value}x"),
        unit => format!("{value} {unit}"),
    }
}

/// A figure of three digits, at least one after the point, with its unit.
fn figure(value: f64, unit: &str) -> String {
    if unit == "bytes" {
        return format!("{} MiB", digits(value / MIB));
    }
    match unit {
        "" => digits(value),
        "x" => format!("{}x", digits(value)),
        unit => format!("{} {unit}", digits(value)),
    }
}

fn digits(value: f64) -> String {
    let size = value.abs();
    if value.fract() == 0.0 && size < 1e15 {
        return format!("{value}");
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    let decimals = (2 - size.log10().floor() as i32).max(1);
    format!("{value:.*}", decimals as usize)
}

/// Warnings of runs that a page shows.
const MOST_WARNINGS: usize = 3;

/// Provenance of the figures, and notes for readers.
fn notes(results: &Results) -> Vec<String> {
    let mut notes = Vec::new();
    match &results.device {
        Some(device) => {
            let scenes = results.scenes.iter().map(|scene| format!("{scene}; ")).collect::<String>();
            let no_gpu = if device.kind == "cpu" { " (a processor, no GPU)" } else { "" };
            notes.push(format!(
                "ours: {scenes}{}; {}, {}{no_gpu}; manylight {}",
                results.sizes().join(", "),
                device.label(),
                device.driver_label(),
                results.version
            ));
            notes.extend(results.times());
        }
        None => notes.push("ours: nothing has been run".to_owned()),
    }
    let counts: std::collections::BTreeSet<u64> =
        results.cells.iter().flatten().filter(|cell| cell.spread.is_some()).filter_map(|cell| cell.n).collect();
    if !counts.is_empty() {
        let counts: Vec<String> = counts.iter().map(u64::to_string).collect();
        notes.push(format!("±: mean and standard deviation of {} seeds", counts.join(" or ")));
    }
    if !results.published.is_null() {
        let said = ["hardware", "scene", "settings"].iter().filter_map(|key| results.published[key].as_str()).collect::<Vec<_>>();
        notes.push(format!("paper: {}", said.join("; ")));
        if results.cells.iter().flatten().any(|cell| cell.unit == "ms" && cell.published.is_some()) {
            notes.push("times of ours and of the paper are of different hardware: compare shares and ratios".to_owned());
        }
    }
    if let Some([error, asked]) = results.reference_error {
        notes.push(format!(
            "reference: its standard error is {:.1} % of the mean radiance a pixel, over the {:.1} % that the table asks for; it ended after its last sample",
            100.0 * error,
            100.0 * asked
        ));
    }
    if results.scale != 1.0 {
        notes.push(format!("scaled: pictures are {} times as wide and high as the table says", results.scale));
    }
    if results.quick {
        notes.push("quick: few frames each".to_owned());
    }
    if !results.sets.is_empty() {
        notes.push(format!("changed in every cell: {}", results.sets.join(", ")));
    }
    let of_row = |(row, cells): (&String, &Vec<Cell>)| {
        let named = results.columns.iter().zip(cells);
        named.filter_map(|(column, cell)| Some(format!("{row}, {column}: {}", cell.why.as_deref()?))).collect::<Vec<_>>()
    };
    let missing: Vec<String> = results.rows.iter().zip(&results.cells).flat_map(of_row).collect();
    if let Some(first) = missing.first() {
        notes.push(format!("{} of {} cells have no figure ({first})", missing.len(), results.cells.iter().flatten().count()));
    }
    // A sweep can have one warning with another number in every run.
    notes.extend(results.warnings.iter().take(MOST_WARNINGS).map(|warning| format!("warning: {warning}")));
    if results.warnings.len() > MOST_WARNINGS {
        notes.push(format!("{} more warnings are in the runs' run.json", results.warnings.len() - MOST_WARNINGS));
    }
    notes.extend(results.deviations.iter().map(|deviation| format!("note: {deviation}")));
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits_or_one_after_the_point() {
        let cases = [
            (0.0, "", "0"),
            (12.0, "", "12"),
            (40.237, "ms", "40.2 ms"),
            (3.256, "x", "3.26x"),
            (123.456, "ms", "123.5 ms"),
            (0.02499, "", "0.0250"),
            (0.00012345, "", "1.23e-4"),
            (82_837_504.0, "bytes", "79 MiB"),
        ];
        for (value, unit, expected) in cases {
            assert_eq!(figure(value, unit), expected);
        }
        for (value, unit, expected) in
            [(10.44, "ms", "10.44 ms"), (8.7, "", "8.7"), (15.42, "x", "15.42x"), (82_837_504.0, "bytes", "79 MiB")]
        {
            assert_eq!(as_published(value, unit), expected);
        }
    }
}
