//! The timing table printed at the end of a run.

use super::{PassTime, Provenance, Row, Timings, percent};
use std::fmt::Write;

/// The timing table as text: a caption, a row for each stage, the total. With `verbose` each stage is followed by its passes.
pub fn timing_table(times: &[PassTime], from: &Provenance, verbose: bool) -> String {
    let timings = Timings::of(times);
    let frames = timings.total.map_or(0, |total| total.n);
    let mut rows = vec![["stage", "median", "p5", "p95", "share"].map(str::to_owned)];
    for stage in &timings.stages {
        rows.push(cells(&stage.name, stage));
        if verbose {
            let passes = timings.passes.iter().filter(|pass| super::stage(&pass.name) == stage.name);
            rows.extend(passes.map(|pass| cells(&format!("  {}", pass.name), pass)));
        }
    }
    if let Some(ms) = timings.total {
        rows.push(cells("total", &Row { name: String::new(), ms, share: 1.0 }));
    }
    let mut text = caption(from, frames);
    let widths: [usize; 5] = std::array::from_fn(|column| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0));
    for row in &rows {
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "\n{:<name$}  {:>median$}  {:>p5$}  {:>p95$}  {:>share$}",
            row[0],
            row[1],
            row[2],
            row[3],
            row[4],
            name = widths[0],
            median = widths[1],
            p5 = widths[2],
            p95 = widths[3],
            share = widths[4]
        );
    }
    text.push('\n');
    text
}

fn cells(name: &str, row: &Row) -> [String; 5] {
    let [median, p5, p95] = [row.ms.median, row.ms.p5, row.ms.p95].map(|ms| format!("{ms:.3}"));
    [name.to_owned(), median, p5, p95, percent(row.share)]
}

fn caption(from: &Provenance, frames: usize) -> String {
    format!(
        "ms a frame, {} timing, {frames} {} of {}x{}, {}, manylight {}\n{}, {}",
        from.timing_mode,
        if frames == 1 { "frame" } else { "frames" },
        from.width,
        from.height,
        from.preset,
        from.version,
        from.device.label(),
        from.device.driver_label(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::{provenance, times};

    fn sample() -> Vec<PassTime> {
        times(&[
            (0, "gbuffer/draw", 100.0),
            (0, "filter/bilateral-x", 4.0),
            (0, "filter/bilateral-y", 6.0),
            (1, "gbuffer/draw", 120.0),
            (1, "filter/bilateral-x", 4.0),
            (1, "filter/bilateral-y", 16.0),
        ])
    }

    #[test]
    fn the_table_names_its_origin_and_lines_up() {
        let expected = "\
ms a frame, isolated timing, 2 frames of 960x540, first-light, manylight 0.1.0
llvmpipe (LLVM 15.0.6, 256 bits) [cpu], llvmpipe Mesa 22.3.6
stage     median       p5      p95    share
gbuffer  110.000  101.000  119.000   88.0 %
filter    15.000   10.500   19.500   12.0 %
total    125.000  111.500  138.500  100.0 %
";
        assert_eq!(timing_table(&sample(), &provenance(), false), expected);
    }

    #[test]
    fn the_verbose_table_lists_passes_under_their_stage() {
        let text = timing_table(&sample(), &provenance(), true);
        let names: Vec<_> = text.lines().skip(2).map(|line| line.split("  ").find(|part| !part.is_empty()).unwrap()).collect();
        assert_eq!(names, ["stage", "gbuffer", "gbuffer/draw", "filter", "filter/bilateral-x", "filter/bilateral-y", "total"]);
        let lengths: Vec<_> = text.lines().skip(2).map(str::len).collect();
        assert!(lengths.iter().all(|&length| length == lengths[0]), "{text}");
    }

    #[test]
    fn a_run_without_times_still_says_what_it_was() {
        let text = timing_table(&[], &provenance(), false);
        assert!(text.contains("0 frames of 960x540"), "{text}");
        assert_eq!(text.lines().count(), 3);
    }
}
