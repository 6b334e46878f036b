//! `manylight bench CONFIG`: how long frames take, pass by pass.

use super::progress::Progress;
use super::{counts, load_config, means, open, prepare_trace, provenance};
use crate::cli::BenchArgs;
use crate::output::{RunReport, prepare_folder, write_file};
use crate::renderer::{Renderer, needs, timing};
use crate::report::{Memory, PassTime, Timings, counts_table, memory_table, paste_line, peak_memory_bytes, timing_table, timings_csv};
use crate::trace;
use crate::{config::Config, graph::Execution};
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::time::Instant;

/// Warms up, measures, and prints a table and one line.
pub fn run(args: &BenchArgs) -> Result<()> {
    let started = Instant::now();
    let config = load_config(&args.config, &args.overrides())?;
    if let Some(folder) = &args.output {
        prepare_folder(folder)?;
    }
    prepare_trace(args.trace.as_deref())?;
    let progress = Progress::new(args.quiet || args.json);

    progress.say("loading the scene");
    let (gpu, scene, mut warnings) = open(&config, args.device.as_ref(), false)?;
    progress.say("bringing the scene to the device");
    let mut renderer = Renderer::new(gpu, scene, needs(&config))?;
    renderer.check(&config)?;
    warnings.extend(renderer.warnings(&config));
    warnings.iter().for_each(|warning| progress.warn(warning));
    progress.say("preparing the shaders");
    renderer.prepare(&config, &[])?;
    let first_pass_ms = started.elapsed().as_millis() as u64;

    let warmup = args.warmup.unwrap_or_else(|| config.frame.warmup.max(2));
    let execution = Execution { timing: timing(&config, &renderer.gpu().adapter), ..Execution::default() };
    for i in 0..warmup {
        progress.say(&format!("warm-up frame {} of {warmup}", i + 1));
        let _span = trace::span(format_args!("warm-up frame {i}"));
        renderer.warm_up(&config, &execution)?;
    }
    let mut times = Vec::new();
    let mut last = None;
    for i in 0..args.runs {
        progress.frame(i, args.runs);
        let _span = trace::span(format_args!("frame {i}"));
        let rendered = renderer.render(&config, animated(&config, i), false, &execution)?;
        times.extend(rendered.times.iter().map(|(pass, ms)| PassTime { frame: i, pass: (*pass).to_owned(), ms: *ms }));
        last = Some(rendered);
    }
    let Some(rendered) = last else { unreachable!("at least one frame is measured") };
    rendered.warnings().into_iter().for_each(|warning| {
        progress.warn(&warning);
        warnings.push(warning);
    });

    let from = provenance(&args.config, &config, &renderer);
    let counted = counts(&renderer, &config, Some(first_pass_ms), &rendered.counts);
    let report = RunReport {
        from: from.clone(),
        seed: u64::from(config.frame.seed),
        frames: args.runs,
        warmup,
        choices: renderer.choices(&config),
        timings: Timings::of(&times),
        means: means(&counted),
        counts: counted,
        memory: Memory::of(&rendered.memory),
        checks: BTreeMap::new(),
        warnings,
        peak_memory_bytes: peak_memory_bytes(),
        config: serde_json::to_value(&config).context("the config cannot be written as JSON")?,
    };
    if let Some(folder) = &args.output {
        write_file(&folder.join("timings.csv"), &timings_csv(&times, &from)?)?;
        report.write(&folder.join("run.json"))?;
    }
    if let Some(path) = &args.trace {
        trace::finish(path, &from)?;
    }
    progress.end();

    if args.json {
        print!("{}", report.json()?);
        return Ok(());
    }
    if !args.quiet {
        print!("{}", timing_table(&times, &from, true));
    }
    if args.verbose {
        print!("\n{}\n{}", counts_table(&rendered.counts), memory_table(&rendered.memory));
    }
    if !args.quiet {
        println!();
    }
    println!("{}", paste_line(&report.timings, &from, &args.sets));
    Ok(())
}

/// The frame of the config's animation that is the i-th to be measured.
fn animated(config: &Config, i: u32) -> u32 {
    i % config.frame.count
}
