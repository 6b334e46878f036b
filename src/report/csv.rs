//! `timings.csv`: every raw time, one per line.

use super::{PassTime, Provenance};
use anyhow::{Context, Result};

/// Content of `timings.csv`: `frame,pass,stage,ms` and, in every line, the provenance.
pub fn timings_csv(times: &[PassTime], from: &Provenance) -> Result<Vec<u8>> {
    table(times, from).context("timings.csv cannot be put together")
}

fn table(times: &[PassTime], from: &Provenance) -> Result<Vec<u8>> {
    let mut csv = ::csv::Writer::from_writer(Vec::new());
    csv.write_record(["frame", "pass", "stage", "ms", "mode", "device", "driver", "width", "height", "preset", "version"])?;
    let known = from.known();
    for time in times {
        // Six decimals: timestamps count nanoseconds at best.
        let (frame, ms) = (time.frame.to_string(), format!("{:.6}", time.ms));
        let figure = [frame.as_str(), &time.pass, time.stage(), &ms];
        csv.write_record(figure.into_iter().chain(known.iter().map(|(_, what)| what.as_str())))?;
    }
    Ok(csv.into_inner()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::{provenance, times};

    #[test]
    fn every_line_holds_a_figure_and_where_it_comes_from() {
        let mut from = provenance();
        from.preset = "my \"best\", so far".into();
        let bytes = timings_csv(&times(&[(0, "gbuffer/draw", 1.5), (1, "gather/per-pixel", 0.25)]), &from).unwrap();
        let text = String::from_utf8(bytes.clone()).unwrap();
        assert_eq!(text.lines().next(), Some("frame,pass,stage,ms,mode,device,driver,width,height,preset,version"));
        let mut reader = ::csv::Reader::from_reader(bytes.as_slice());
        let lines: Vec<Vec<String>> = reader.records().map(|line| line.unwrap().iter().map(str::to_owned).collect()).collect();
        let constant =
            ["isolated", "llvmpipe (LLVM 15.0.6, 256 bits) [cpu]", "llvmpipe Mesa 22.3.6", "960", "540", "my \"best\", so far", "0.1.0"];
        let expected = [["0", "gbuffer/draw", "gbuffer", "1.500000"], ["1", "gather/per-pixel", "gather", "0.250000"]];
        assert_eq!(lines, expected.map(|figure| [&figure[..], &constant[..]].concat()));
    }

    #[test]
    fn without_figures_the_header_stands_alone() {
        assert_eq!(timings_csv(&[], &provenance()).unwrap().iter().filter(|&&byte| byte == b'\n').count(), 1);
    }
}
