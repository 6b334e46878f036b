//! `flicker.csv`: the flicker of a camera path, one frame per line.

use super::Provenance;
use crate::metrics::flicker::Pair;
use anyhow::{Context, Result};

/// Figures of one frame of the path.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FlickerLine {
    pub frame: u32,
    /// Pair of the frame before and this one.
    pub pair: Option<Pair>,
    /// The reference's own flicker over the same matches.
    pub reference: Option<f64>,
    /// `pair`'s flicker beyond `reference`.
    pub excess: Option<f64>,
    /// Error of the frame against its reference.
    pub rmse: Option<f64>,
}

/// Content of `flicker.csv`. Missing figures are empty, and every line has the provenance.
pub fn flicker_csv(lines: &[FlickerLine], layer: &str, from: &Provenance) -> Result<Vec<u8>> {
    table(lines, layer, from).context("flicker.csv cannot be put together")
}

const HEADER: [&str; 18] = [
    "frame",
    "layer",
    "flicker",
    "mean",
    "matched",
    "surfaces",
    "outside",
    "hidden",
    "turned",
    "reference",
    "excess",
    "rmse",
    "device",
    "driver",
    "width",
    "height",
    "preset",
    "version",
];

fn table(lines: &[FlickerLine], layer: &str, from: &Provenance) -> Result<Vec<u8>> {
    let mut csv = ::csv::Writer::from_writer(Vec::new());
    csv.write_record(HEADER)?;
    // The timing mode is left out, since flicker does not depend on it.
    let [_, known @ ..] = from.known();
    // The shortest text that parses to the same number.
    let figure = |figure: Option<f64>| figure.map(|figure| figure.to_string()).unwrap_or_default();
    for line in lines {
        let pair = line.pair;
        let count = |of: fn(&Pair) -> u64| pair.as_ref().map(|pair| of(pair).to_string()).unwrap_or_default();
        let cells = [
            line.frame.to_string(),
            layer.to_owned(),
            figure(pair.and_then(|pair| pair.flicker)),
            figure(pair.and_then(|pair| pair.mean)),
            count(|pair| pair.matched),
            count(|pair| pair.surfaces),
            count(|pair| pair.outside),
            count(|pair| pair.hidden),
            count(|pair| pair.turned),
            figure(line.reference),
            figure(line.excess),
            figure(line.rmse),
        ];
        csv.write_record(cells.iter().chain(known.iter().map(|(_, what)| what)))?;
    }
    Ok(csv.into_inner()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::provenance;

    #[test]
    fn every_frame_has_a_line_and_what_is_not_known_is_empty() {
        let pair = Pair { flicker: Some(0.25), mean: Some(2.0), matched: 90, surfaces: 97, outside: 4, hidden: 2, turned: 1, pixels: 100 };
        let lines = [
            FlickerLine { frame: 0, rmse: Some(0.5), ..FlickerLine::default() },
            FlickerLine { frame: 1, pair: Some(pair), reference: Some(0.1), excess: Some(0.15), rmse: None },
        ];
        let bytes = flicker_csv(&lines, "irradiance", &provenance()).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        let origin = "\"llvmpipe (LLVM 15.0.6, 256 bits) [cpu]\",llvmpipe Mesa 22.3.6,960,540,first-light,0.1.0";
        assert_eq!(rows[0], HEADER.join(","));
        assert_eq!(rows[1], format!("0,irradiance,,,,,,,,,,0.5,{origin}"));
        assert_eq!(rows[2], format!("1,irradiance,0.25,2,90,97,4,2,1,0.1,0.15,,{origin}"));
        assert_eq!(rows.len(), 3);
    }
}
