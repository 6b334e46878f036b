//! One-line measurements for bug reports.

use super::{Provenance, Timings};

/// The provenance, the number of frames, and the medians of the whole and of each stage, ms. `changes` are config keys set on
/// the command line.
pub fn paste_line(timings: &Timings, from: &Provenance, changes: &[String]) -> String {
    let preset = std::iter::once(from.preset.as_str()).chain(changes.iter().map(String::as_str)).collect::<Vec<_>>().join(" ");
    let mut parts = vec![
        format!("manylight {}", from.version),
        preset,
        format!("{}x{}", from.width, from.height),
        from.device.label(),
        from.device.driver_label(),
        from.timing_mode.clone(),
        format!("n={}", timings.total.map_or(0, |total| total.n)),
    ];
    parts.extend(timings.total.map(|total| format!("total {} ms", milliseconds(total.median))));
    parts.extend(timings.stages.iter().map(|stage| format!("{} {}", stage.name, milliseconds(stage.ms.median))));
    parts.join(" · ")
}

/// About three digits: a fast device's stages take hundredths of a millisecond.
fn milliseconds(ms: f64) -> String {
    match ms {
        ms if ms >= 10.0 => format!("{ms:.1}"),
        ms if ms >= 1.0 => format!("{ms:.2}"),
        ms => format!("{ms:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::{provenance, times};

    #[test]
    fn the_line_says_what_ran_where_and_how_long() {
        let timings = Timings::of(&times(&[
            (0, "gbuffer/draw", 100.04),
            (0, "filter/x", 1.234),
            (1, "gbuffer/draw", 100.04),
            (1, "filter/x", 1.234),
        ]));
        assert_eq!(
            paste_line(&timings, &provenance(), &["vpls.count=64".to_owned()]),
            "manylight 0.1.0 · first-light vpls.count=64 · 960x540 · llvmpipe (LLVM 15.0.6, 256 bits) [cpu] · llvmpipe Mesa 22.3.6 · isolated · n=2 · total 101.3 ms · gbuffer 100.0 · filter 1.23"
        );
        let fast = Timings::of(&times(&[(0, "gbuffer/draw", 0.0312)]));
        assert!(paste_line(&fast, &provenance(), &[]).ends_with(" · first-light · 960x540 · llvmpipe (LLVM 15.0.6, 256 bits) [cpu] · llvmpipe Mesa 22.3.6 · isolated · n=1 · total 0.031 ms · gbuffer 0.031"));
    }
}
