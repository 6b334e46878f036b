//! The arguments of `manylight compare`.

use crate::metrics::LayerPair;
use clap::Args;
use std::path::PathBuf;

const MEASURES: &str = "\
Measures, t being the test's numbers and r the reference's:

  rmse    root of the mean of (t - r)^2, over pixels and channels
  mae     mean of |t - r|, over pixels and channels
  relmse  mean of (t - r)^2 / (r^2 + 0.01)
  energy  mean luminance of the test over that of the reference
  worst   99th percentile of the pixels' errors, each the largest |t - r| of its channels
  flip    mean FLIP at 67 pixels a degree: HDR-FLIP for an EXR's colours, at the exposures that the reference asks for

A PNG is taken for sRGB and made linear, except for FLIP. Layers that are no colours have no FLIP, vectors no energy. Of
several frames the last line gives rmse as the root of the mean of its squares, energy as the ratio of the mean luminances,
worst as the largest, and the mean of the others.";

#[derive(Debug, Clone, PartialEq, Args)]
#[command(after_help = MEASURES)]
pub struct CompareArgs {
    /// An EXR, a PNG, or a folder: a render's, or one of frames
    pub test: PathBuf,
    /// The reference, of the same kind. Frames are matched by name; of a frame that is there as EXR and as PNG the EXR is read
    pub reference: PathBuf,
    /// A layer, or a sum as in direct+indirect; TEST=REFERENCE where the names differ; may be repeated [default: RGB, the
    /// colours without a name]
    #[arg(long = "layer", value_name = "LAYER", value_parser = LayerPair::parse)]
    layers: Vec<LayerPair>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Write a PNG of the errors, from black to pale yellow: FLIP, or for layers without FLIP the error over the largest error.
    /// For several frames or layers, a folder with a PNG each
    #[arg(long, value_name = "FILE")]
    pub heatmap: Option<PathBuf>,
    /// Fail if a frame's rmse is over X
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_rmse: Option<f64>,
    /// Fail if a frame's mae is over X
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_mae: Option<f64>,
    /// Fail if a frame's relmse is over X
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_relmse: Option<f64>,
    /// Fail if a frame's flip is over X
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_flip: Option<f64>,
    /// Fail if a frame's worst is over X
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_worst: Option<f64>,
    /// Fail if a frame's energy is farther than X from 1
    #[arg(long, value_name = "X", value_parser = threshold)]
    pub max_energy_error: Option<f64>,
}

impl CompareArgs {
    /// The layers of `--layer`, or the colours without a name.
    pub fn layers(&self) -> Vec<LayerPair> {
        if self.layers.is_empty() { vec![LayerPair::radiance()] } else { self.layers.clone() }
    }
}

fn threshold(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|limit: &f64| limit.is_finite() && *limit >= 0.0).ok_or_else(|| "expects a number from 0".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Command, try_parse};

    fn compare(line: &str) -> CompareArgs {
        match try_parse(std::iter::once("manylight").chain(line.split_whitespace()).map(Into::into).collect()).unwrap().command {
            Command::Compare(compare) => compare,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn layers_are_names_sums_and_pairs() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let choice = |test: &[&str], reference: &[&str]| LayerPair { test: names(test), reference: names(reference) };
        assert_eq!(compare("compare a b").layers(), [choice(&["RGB"], &["RGB"])]);
        let several = compare("compare a b --layer direct+indirect=RGB --layer Z");
        assert_eq!(several.layers(), [choice(&["direct", "indirect"], &["RGB"]), choice(&["Z"], &["Z"])]);
        let dotted = compare("compare a b --layer indirect=indirect.bounce1+indirect.bounce2");
        assert_eq!(dotted.layers(), [choice(&["indirect"], &["indirect.bounce1", "indirect.bounce2"])]);
    }

    #[test]
    fn thresholds_are_off_until_they_are_given() {
        let plain = compare("compare a b");
        assert!(!plain.json && plain.heatmap.is_none() && plain.max_rmse.is_none() && plain.max_flip.is_none());
        let strict = compare("compare a b --max-energy-error 0 --max-worst 1e-3");
        assert_eq!((strict.max_energy_error, strict.max_worst), (Some(0.0), Some(1e-3)));
    }
}
