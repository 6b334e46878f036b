//! The arguments of `manylight report`.

use crate::metrics::LayerPair;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Clone, PartialEq, Args)]
pub struct ReportArgs {
    /// Folders that render, reference or reproduce wrote; a run is compared with the reference of the same scene, camera,
    /// lights, materials and size
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// The HTML file; it needs no other file
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    pub output: PathBuf,
    /// Layer to compare, or a sum as in direct+indirect; TEST=REFERENCE where the names differ; RGB are the colours without a
    /// name
    #[arg(long = "layer", value_name = "LAYER", default_value = "RGB", value_parser = LayerPair::parse)]
    pub layers: LayerPair,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Command, try_parse};

    fn report(line: &str) -> Result<ReportArgs, clap::Error> {
        let arguments = std::iter::once("manylight").chain(line.split_whitespace()).map(Into::into).collect();
        try_parse(arguments).map(|cli| match cli.command {
            Command::Report(report) => report,
            other => panic!("{other:?}"),
        })
    }

    #[test]
    fn a_report_takes_folders_and_has_a_name_for_its_file() {
        let plain = report("report out/a out/b").unwrap();
        assert_eq!((plain.folders, plain.output), (vec!["out/a".into(), "out/b".into()], "report.html".into()));
        assert_eq!(plain.layers.to_string(), "RGB");
        let all = report("report a -o b.html --layer indirect=indirect.bounce1").unwrap();
        assert_eq!((all.output, all.layers.to_string()), ("b.html".into(), "indirect=indirect.bounce1".to_owned()));
        for line in ["report", "report a --layer =x", "report a --layer x --layer y"] {
            assert_eq!(report(line).expect_err(line).exit_code(), 2, "{line}");
        }
    }
}
