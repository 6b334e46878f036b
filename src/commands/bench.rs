//! `manylight bench CONFIG`: the times of frames, pass by pass.

use super::measure::{Frames, Pictures};
use super::progress::Progress;
use super::setup::{On, Setup, begin_trace, end_trace};
use crate::cli::BenchArgs;
use crate::files::prepare_folder;
use crate::report::{counts_table, memory_table, paste_line, timing_table};
use anyhow::Result;

/// Warms up, measures, and prints a table and a line for bug reports.
pub fn run(args: &BenchArgs) -> Result<()> {
    let setup = Setup::load(&args.config, &args.overrides())?;
    let config = &setup.config;
    if let Some(folder) = &args.output {
        prepare_folder(folder)?;
    }
    begin_trace(args.trace.as_deref())?;
    let progress = Progress::new(args.quiet || args.json);
    let mut ready = setup.ready(On { device: args.device.as_ref(), validate: false }, &[], &progress)?;

    // The animation repeats when it ends.
    let frames: Vec<(u32, u32)> = (0..args.runs).map(|i| (i, i % config.frame.count)).collect();
    let warmup = args.warmup.unwrap_or_else(|| config.frame.warmup.max(2));
    let frames = Frames { warmup, measured: &frames, pictures: Pictures::None, dump: &[], check_nan: false };
    let measured = frames.run(&mut ready.renderer, config, &ready.execution, Some(&progress), &mut |_, _| Ok(()))?;
    measured.last.warnings().into_iter().for_each(|warning| ready.warn(warning, &progress));

    let report = measured.record(&ready.renderer, config, &ready.from, Some(ready.first_pass_ms), ready.warnings)?;
    if let Some(folder) = &args.output {
        measured.write_times(&folder.join("timings.csv"), &ready.from)?;
        report.write(&folder.join("run.json"))?;
    }
    end_trace(args.trace.as_deref(), &ready.from)?;
    progress.end();

    if args.json {
        print!("{}", report.json()?);
        return Ok(());
    }
    if !args.quiet {
        print!("{}", timing_table(&measured.times, &ready.from, true));
    }
    if args.verbose {
        print!("\n{}\n{}", counts_table(&measured.last.counts), memory_table(&measured.last.memory));
    }
    if !args.quiet {
        println!();
    }
    println!("{}", paste_line(&report.timings, &ready.from, &args.sets));
    Ok(())
}
