//! `manylight render CONFIG`: pictures, layers, times, and a record of the run.

use super::measure::{Frames, Pictures, check_validation, write_picture};
use super::no_frames;
use super::progress::Progress;
use super::setup::{On, Setup, begin_trace, end_trace};
use crate::cli::RenderArgs;
use crate::fail;
use crate::files::{prepare_folder, write_file};
use crate::gpu::Format;
use crate::graph::{Dump, DumpData};
use crate::output::exr::Precision;
use crate::output::{ExrLayer, FRAMES, Plane, frame_file, write_exr, write_png};
use crate::renderer::Rendered;
use crate::report::{RunReport, counts_table, memory_table, timing_table};
use crate::{stages, trace};
use anyhow::Result;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Renders and writes everything. Prints the picture's path and the time of each stage.
pub fn run(args: &RenderArgs) -> Result<()> {
    let setup = Setup::load(&args.config, &args.overrides())?;
    let (config, folder, sequence) = (&setup.config, args.output(), args.sequence);
    let frames: Vec<(u32, u32)> = sequence.frames(config.frame.count).map(|frame| (frame, frame)).collect();
    let Some((last_frame, _)) = frames.last().copied() else { return Err(no_frames(config)) };
    prepare_folder(&folder)?;
    let frames_folder = folder.join(FRAMES);
    if sequence.sequence {
        prepare_folder(&frames_folder)?;
    }
    begin_trace(args.trace.as_deref())?;
    let progress = Progress::new(args.quiet);
    let mut ready = setup.ready(On { device: args.device.as_ref(), validate: args.validate }, &args.dump, &progress)?;
    if sequence.shard.is_some() {
        stages::warnings_of_parts(config).into_iter().for_each(|warning| ready.warn(format!("--shard: {warning}"), &progress));
    }

    let pictures = if sequence.sequence { Pictures::All } else { Pictures::Last };
    let frames = Frames { warmup: config.frame.warmup, measured: &frames, pictures, dump: &args.dump, check_nan: args.check_nan };
    let from = &ready.from;
    let mut on_frame = |frame: u32, rendered: &Rendered| match rendered.picture.as_ref().filter(|_| sequence.sequence) {
        Some(picture) => {
            let [exr, png] = ["exr", "png"].map(|ending| frame_file(&frames_folder, frame, ending));
            write_picture(&exr, &png, picture, config, from)
        }
        None => Ok(()),
    };
    let measured = frames.run(&mut ready.renderer, config, &ready.execution, Some(&progress), &mut on_frame)?;
    measured.last.warnings().into_iter().for_each(|warning| ready.warn(warning, &progress));
    let (from, last) = (&ready.from, &measured.last);

    progress.say("writing");
    let writing = trace::span("writing");
    let image = folder.join("image.png");
    // The shard with a sequence's last frame writes it as image too, as the whole sequence does.
    let leaves_image = last_frame + 1 == config.frame.count;
    if leaves_image {
        write_picture(&folder.join("image.exr"), &image, measured.picture(), config, from)?;
    }
    measured.write_times(&folder.join(sequence.file_name("timings", "csv")), from)?;
    let dumped = last.dumps.iter().map(|dump| write_dump(&folder, dump)).collect::<Result<Vec<String>>>()?;
    let mut checks = BTreeMap::new();
    if args.check_nan {
        let found = last.non_finite.iter().map(|(pass, image, count)| (format!("{pass}: {image}"), json!(count)));
        checks.insert("check-nan".to_owned(), Value::Object(found.collect()));
    }
    if args.validate {
        checks.insert("validation".to_owned(), json!(ready.renderer.gpu().validation_messages()));
    }
    let report = measured.record(&ready.renderer, config, from, Some(ready.first_pass_ms), ready.warnings)?;
    RunReport { checks, ..report }.write(&folder.join(sequence.file_name("run", "json")))?;
    drop(writing);
    end_trace(args.trace.as_deref(), from)?;
    progress.end();

    if !args.quiet {
        print!("{}", timing_table(&measured.times, from, args.verbose));
    }
    if args.verbose {
        print!("\n{}\n{}\n", counts_table(&last.counts), memory_table(&last.memory));
    }
    println!("{}", if leaves_image { image.display() } else { frames_folder.display() });
    dumped.iter().for_each(|path| println!("{path}"));
    if let Some((pass, image, count)) = last.non_finite.first() {
        return Err(fail!(ComparisonFailed, "pass {pass}: {count} texels of {image} are not finite numbers"));
    }
    check_validation(&ready.renderer)
}

/// Writes a dumped resource to `DIR/dump/<pass>/`: an image as EXR with its array layers, an 8-bit picture as PNG, a buffer as
/// raw bytes.
fn write_dump(folder: &Path, dump: &Dump) -> Result<String> {
    let folder = folder.join("dump").join(dump.pass.replace('/', "."));
    prepare_folder(&folder)?;
    let name = dump.resource.replace('/', ".");
    let path = match &dump.data {
        DumpData::Image { format: Format::Rgba8Unorm, size, layers: 1, texels } => {
            let path = folder.join(format!("{name}.png"));
            write_png(&path, size[0], size[1], texels)?;
            path
        }
        DumpData::Image { format, size, layers, texels } => {
            let path = folder.join(format!("{name}.exr"));
            let plane = Plane::decode(*format, texels);
            let of_layer = (size[0] * size[1]) as usize * plane.channels;
            let channels = &"RGBA"[..plane.channels];
            let layers = plane.values.chunks_exact(of_layer).enumerate().map(|(i, values)| {
                let name = if *layers > 1 { format!("layer{i}") } else { String::new() };
                ExrLayer::interleaved(&name, channels, plane.channels, values, Precision::Float)
            });
            write_exr(&path, size[0], size[1], layers.collect(), &[])?;
            path
        }
        DumpData::Buffer { element, element_bytes, bytes, .. } => {
            let path = folder.join(format!("{name}.{element}.{element_bytes}-bytes.bin"));
            write_file(&path, bytes)?;
            path
        }
    };
    Ok(path.display().to_string())
}
