//! The command line: its arguments and their parsing.

mod bench;
mod compare;
mod export;
mod flicker;
mod reference;
mod render;
mod report;
mod reproduce;
mod sequence;
mod view;

pub use bench::BenchArgs;
pub use compare::CompareArgs;
pub use export::{ExportFormat, MitsubaArgs};
pub use flicker::FlickerArgs;
pub use reference::ReferenceArgs;
pub use render::RenderArgs;
pub use report::ReportArgs;
pub use reproduce::ReproduceArgs;
pub use sequence::{SequenceArgs, Shard};
pub use view::ViewArgs;

use crate::gpu::DeviceChoice;
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::path::Path;

/// Real-time many-light global illumination on raw Vulkan.
#[derive(Debug, Clone, PartialEq, Parser)]
#[command(name = "manylight", version, about, long_about = None, propagate_version = true)]
#[command(after_help = "A config alone renders: manylight configs/first-light.toml")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum Command {
    /// Render a config: a picture, its EXR layers and the time of every pass
    Render(RenderArgs),
    /// Open a window: fly through a config's scene, turn its keys, see every pass
    View(ViewArgs),
    /// Path trace a config's scene: the reference that renders are compared with
    Reference(ReferenceArgs),
    /// Write a config's scene for another renderer, to check ours against
    Export {
        #[command(subcommand)]
        format: ExportFormat,
    },
    /// Print the errors of pictures against their references
    Compare(CompareArgs),
    /// Run a table, of a paper or your own, and print it beside the published figures
    Reproduce(ReproduceArgs),
    /// Write one HTML file that shows runs beside their references, with errors, times and tables
    Report(ReportArgs),
    /// Render a config's camera path and print how much surfaces in sight flicker
    Flicker(FlickerArgs),
    /// Measure a config's frames, pass by pass, and print a line to paste into a bug report
    Bench(BenchArgs),
    /// List devices, the methods that run on each, and the features that the others lack
    Doctor,
    /// List devices, stages, methods and presets
    List,
    /// Print the JSON Schema of configs, with which an editor completes and checks them
    Schema,
}

/// Parses the program's arguments. Help, the version or an error is printed, and ends the program.
pub fn parse() -> Cli {
    Cli::parse_from(with_command(std::env::args_os().collect()))
}

/// [`parse`] for given arguments, the program's name first. Errors end with code 2 through [`clap::Error::exit`].
pub fn try_parse(arguments: Vec<OsString>) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(with_command(arguments))
}

/// Completes the short form: a config as the first argument means `render`. A file with a command's name is given as ./NAME.
fn with_command(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let commands = Cli::command();
    let is_command = |first: &OsString| first == "help" || commands.find_subcommand(first).is_some();
    let short = arguments.get(1).is_some_and(|first| {
        let path = Path::new(first);
        let plain = !first.to_string_lossy().starts_with('-') && !is_command(first);
        plain && (path.extension().is_some_and(|extension| extension == "toml") || path.exists())
    });
    if short {
        arguments.insert(1, "render".into());
    }
    arguments
}

fn key_value(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expects key=value, as in gather.interleave=2".to_owned()),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=16_384).contains(side));
    text.split_once(['x', 'X'])
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| "expects WIDTHxHEIGHT, as in 960x540, each 1 to 16384".to_owned())
}

fn device(text: &str) -> Result<DeviceChoice, String> {
    match text.trim() {
        "" => Err("expects a part of the device's name, its index, or cpu".to_owned()),
        text => Ok(DeviceChoice::parse(text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::TimingMode;
    use clap::error::ErrorKind;

    fn arguments(line: &str) -> Result<Cli, clap::Error> {
        try_parse(std::iter::once("manylight").chain(line.split_whitespace()).map(OsString::from).collect())
    }

    fn render(line: &str) -> RenderArgs {
        match arguments(line).unwrap().command {
            Command::Render(render) => render,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_definition_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_config_alone_renders() {
        assert_eq!(render("first.toml -q --frames 3"), render("render first.toml -q --frames 3"));
        assert_eq!(render("Cargo.toml"), render("render Cargo.toml"));
        // An existing file needs no ending; a name that is neither a file nor a command is a mistake.
        assert_eq!(render("./src/cli.rs").config, Path::new("./src/cli.rs"));
        assert_eq!(arguments("frist-light").unwrap_err().kind(), ErrorKind::InvalidSubcommand);
    }

    #[test]
    fn options_become_overrides_after_those_of_set() {
        let options = "--timing serial --set vpls.count=64 --size 64x32 --frames 2 --set gather.method=per-pixel";
        let render = render(&format!("render c.toml {options}"));
        assert_eq!(
            render.overrides(),
            ["vpls.count=64", "gather.method=per-pixel", "frame.count=2", "frame.size=[64, 32]", "frame.timing=serial"]
        );
        let config = crate::config::parse("", Path::new("c.toml"), &render.overrides()).unwrap().config;
        assert_eq!((config.frame.size, config.frame.count, config.frame.timing), ([64, 32], 2, TimingMode::Serial));
    }

    #[test]
    fn the_results_go_to_a_folder_named_after_the_config() {
        assert_eq!(render("configs/first-light.toml").output(), Path::new("out/first-light"));
        assert_eq!(render("c.toml -o there").output(), Path::new("there"));
    }

    #[test]
    fn a_device_is_a_name_an_index_or_cpu() {
        let device = |line: &str| render(line).device;
        assert_eq!(device("c.toml"), None);
        assert_eq!(device("c.toml --device cpu"), Some(DeviceChoice::Cpu));
        assert_eq!(device("c.toml --device 1"), Some(DeviceChoice::Index(1)));
        assert_eq!(device("c.toml --device llvmpipe"), Some(DeviceChoice::Name("llvmpipe".to_owned())));
    }

    #[test]
    fn flags_are_off_until_they_are_given() {
        let plain = render("c.toml");
        assert!(!plain.validate && !plain.check_nan && !plain.quiet && plain.dump.is_empty() && plain.overrides().is_empty());
        let all = render("c.toml --validate --check-nan --quiet --dump rsm/draw --dump gather/per-pixel");
        assert!(all.validate && all.check_nan && all.quiet);
        assert_eq!(all.dump, ["rsm/draw", "gather/per-pixel"]);
    }

    #[test]
    fn mistakes_end_with_code_2_and_help_with_0() {
        let mistakes = [
            "",
            "render",
            "c.toml --size 0x5",
            "c.toml --size 64",
            "c.toml --size 64x99999",
            "c.toml --frames 0",
            "c.toml --frames many",
            "c.toml --timing fast",
            "c.toml --set vpls.count",
            "c.toml --set =3",
            "c.toml --unknown",
            "c.toml d.toml",
            "doctor now",
            "bench",
            "bench c.toml --runs 0",
            "bench c.toml --timing fast",
            "bench c.toml --json --quiet",
            "bench c.toml --frames 3",
            "c.toml --quiet --verbose",
            "reference",
            "reference c.toml --spp 0",
            "reference c.toml --bounces 99",
            "reference c.toml --time 0",
            "reference c.toml --target-error nan",
            "reference c.toml --sequence --frame 2",
            "render c.toml --shard 1/2",
            "render c.toml --sequence --shard 3/2",
            "flicker",
            "flicker c.toml --frames 0",
            "flicker c.toml --reference-layer direct",
            "export",
            "export mitsuba",
            "export povray c.toml",
            "export mitsuba c.toml --frame -1",
            "compare a",
            "compare a b c",
            "compare a b --layer direct+",
            "compare a b --layer =direct",
            "compare a b --layer a=b=c",
            "compare a b --max-rmse -1",
            "compare a b --max-rmse nan",
            "compare a b --max-flip much",
        ];
        for line in mistakes {
            assert_eq!(arguments(line).expect_err(line).exit_code(), 2, "{line}");
        }
        assert!(arguments("c.toml --size 64").unwrap_err().to_string().contains("expects WIDTHxHEIGHT, as in 960x540"));
        for line in ["--help", "--version", "render --help", "help"] {
            assert_eq!(arguments(line).expect_err(line).exit_code(), 0, "{line}");
        }
        assert_eq!(arguments("--version").unwrap_err().to_string(), format!("manylight {}\n", env!("CARGO_PKG_VERSION")));
    }

    #[test]
    fn an_export_takes_a_format_a_config_and_what_changes_it() {
        let export = |line: &str| match arguments(line).unwrap().command {
            Command::Export { format: ExportFormat::Mitsuba(export) } => export,
            other => panic!("{other:?}"),
        };
        let plain = export("export mitsuba configs/cornell.toml");
        assert_eq!((plain.output(), plain.frame), (Path::new("out/cornell/mitsuba").to_owned(), None));
        let all = export("export mitsuba c.toml -o there --set scene.seed=3 --size 64x32 --frame 7");
        assert_eq!((all.output(), all.frame), (Path::new("there").to_owned(), Some(7)));
        assert_eq!(all.overrides(), ["scene.seed=3", "frame.size=[64, 32]"]);
    }

    #[test]
    fn a_reference_has_defaults_and_takes_what_changes_them() {
        let reference = |line: &str| match arguments(line).unwrap().command {
            Command::Reference(reference) => reference,
            other => panic!("{other:?}"),
        };
        let plain = reference("reference configs/cornell.toml");
        assert_eq!((plain.spp, plain.bounces, plain.output()), (256, 4, Path::new("out/cornell/reference").to_owned()));
        assert!(!plain.resume && !plain.min_distance && !plain.centers && plain.time.is_none() && plain.target_error.is_none());
        let all =
            reference("reference c.toml -o there --spp 16 --bounces 0 --time 1.5 --target-error 0.01 --resume --size 64x32 --frame 3");
        assert_eq!((all.spp, all.bounces, all.time, all.target_error, all.frame), (16, 0, Some(1.5), Some(0.01), Some(3)));
        assert_eq!(all.overrides(), ["frame.size=[64, 32]"]);
    }

    #[test]
    fn flicker_takes_a_config_and_what_changes_it() {
        let flicker = |line: &str| match arguments(line).unwrap().command {
            Command::Flicker(flicker) => flicker,
            other => panic!("{other:?}"),
        };
        let plain = flicker("flicker configs/cornell.toml");
        assert_eq!((plain.layer.as_str(), plain.output()), ("RGB", Path::new("out/cornell/flicker").to_owned()));
        assert!(!plain.heatmap && !plain.json && plain.reference.is_none() && plain.overrides().is_empty());
        let all = flicker("flicker c.toml -o there --layer irradiance --set vpls.count=64 --frames 8 --size 64x32 --reference truth");
        assert_eq!(all.overrides(), ["vpls.count=64", "frame.count=8", "frame.size=[64, 32]"]);
        assert_eq!(all.reference, Some("truth".into()));
    }

    #[test]
    fn a_bench_measures_30_frames_until_told_otherwise() {
        let bench = |line: &str| match arguments(line).unwrap().command {
            Command::Bench(bench) => bench,
            other => panic!("{other:?}"),
        };
        let plain = bench("bench configs/cornell.toml");
        assert_eq!((plain.runs, plain.warmup, &plain.output, &plain.trace), (30, None, &None, &None));
        assert!(!plain.json && !plain.verbose && !plain.quiet && plain.overrides().is_empty());
        let all = bench("bench c.toml --runs 5 --warmup 0 -o there --trace t.json --set vpls.count=64 --size 64x32 --timing serial -v");
        assert_eq!((all.runs, all.warmup, all.verbose), (5, Some(0), true));
        assert_eq!((all.output.as_deref(), all.trace.as_deref()), (Some(Path::new("there")), Some(Path::new("t.json"))));
        assert_eq!(all.overrides(), ["vpls.count=64", "frame.size=[64, 32]", "frame.timing=serial"]);
    }

    #[test]
    fn doctor_list_and_schema_take_nothing() {
        assert_eq!(arguments("doctor").unwrap().command, Command::Doctor);
        assert_eq!(arguments("list").unwrap().command, Command::List);
        assert_eq!(arguments("schema").unwrap().command, Command::Schema);
    }
}
