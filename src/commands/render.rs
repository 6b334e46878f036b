//! `manylight render CONFIG`: pictures, layers, times, and a record of how they came about.

use super::progress::Progress;
use super::{counts, load_config, means, no_frames, open, prepare_trace, provenance};
use crate::cli::RenderArgs;
use crate::config::{Centers, Layer as LayerName};
use crate::fail;
use crate::gpu::Format;
use crate::graph::{Dump, DumpData, Execution};
use crate::output::exr::Precision;
use crate::output::{FRAMES, Layer, Picture, Plane, RunReport, frame_file, prepare_folder, write_exr, write_file, write_png};
use crate::renderer::{Renderer, needs, timing};
use crate::report::{Memory, PassTime, Timings, counts_table, memory_table, peak_memory_bytes, timing_table, timings_csv};
use crate::stages::bounce::has_clusters;
use crate::trace;
use anyhow::{Context, Result};
use std::path::Path;
use std::time::Instant;

/// Renders and writes everything; prints where it is and how long each stage took.
pub fn run(args: &RenderArgs) -> Result<()> {
    let started = Instant::now();
    let config = load_config(&args.config, &args.overrides())?;
    let folder = args.output();
    let frames: Vec<u32> = args.sequence.frames(config.frame.count).collect();
    let Some(last_frame) = frames.last().copied() else { return Err(no_frames(&config)) };
    prepare_folder(&folder)?;
    let frames_folder = folder.join(FRAMES);
    if args.sequence.sequence {
        prepare_folder(&frames_folder)?;
    }
    prepare_trace(args.trace.as_deref())?;
    let progress = Progress::new(args.quiet);

    progress.say("loading the scene");
    let (gpu, scene, mut warnings) = open(&config, args.device.as_ref(), args.validate)?;
    progress.say("bringing the scene to the device");
    let mut renderer = Renderer::new(gpu, scene, needs(&config))?;
    renderer.check(&config)?;
    warnings.extend(renderer.warnings(&config));
    if args.sequence.shard.is_some() && has_clusters(&config) && config.bounce.centers == Centers::Kept {
        warnings.push("--shard: clusters go on from frame to frame (bounce.centers), and parts of a sequence start anew: where lights move, pictures are not those of the whole sequence".to_owned());
    }
    warnings.iter().for_each(|warning| progress.warn(warning));

    let mut execution = Execution { timing: timing(&config, &renderer.gpu().adapter), ..Execution::default() };
    progress.say("preparing the shaders");
    renderer.prepare(&config, &args.dump)?;
    let first_pass_ms = started.elapsed().as_millis() as u64;
    for i in 0..config.frame.warmup {
        let _span = trace::span(format_args!("warm-up frame {i}"));
        renderer.warm_up(&config, &execution)?;
        progress.say(&format!("warm-up frame {} of {}", i + 1, config.frame.warmup));
    }
    let mut times = Vec::new();
    let mut last = None;
    let from = provenance(&args.config, &config, &renderer);
    let write = |exr: &Path, png: &Path, picture: &Picture| -> Result<()> {
        let [width, height] = picture.size;
        let metadata = [("version", from.version.clone()), ("preset", from.preset.clone()), ("device", from.device.name.clone())];
        write_png(png, width, height, &picture.image)?;
        write_exr(exr, width, height, layers(picture, &config.output.layers), &metadata)
    };
    for (done, frame) in frames.iter().copied().enumerate() {
        progress.frame(done as u32, frames.len() as u32);
        let _span = trace::span(format_args!("frame {frame}"));
        let is_last = frame == last_frame;
        if is_last {
            execution.dump = args.dump.clone();
            execution.check_nan = args.check_nan;
        }
        let rendered = renderer.render(&config, frame, is_last || args.sequence.sequence, &execution)?;
        times.extend(rendered.times.iter().map(|(pass, ms)| PassTime { frame, pass: (*pass).to_owned(), ms: *ms }));
        if let Some(picture) = rendered.picture.as_ref().filter(|_| args.sequence.sequence) {
            write(&frame_file(&frames_folder, frame, "exr"), &frame_file(&frames_folder, frame, "png"), picture)?;
        }
        last = is_last.then_some(rendered);
    }
    let Some(rendered) = last else { unreachable!("there is a frame") };
    rendered.warnings().into_iter().for_each(|warning| {
        progress.warn(&warning);
        warnings.push(warning);
    });
    let Some(picture) = &rendered.picture else { unreachable!("the last frame is brought back") };

    progress.say("writing");
    let writing = trace::span("writing");
    let image = folder.join("image.png");
    // Of a sequence in parts, the part with the last frame leaves it as a whole sequence does.
    let leaves_image = last_frame + 1 == config.frame.count;
    if leaves_image {
        write(&folder.join("image.exr"), &image, picture)?;
    }
    write_file(&folder.join(args.sequence.file_name("timings", "csv")), &timings_csv(&times, &from)?)?;
    let dumped = rendered.dumps.iter().map(|dump| write_dump(&folder, dump)).collect::<Result<Vec<String>>>()?;
    let mut checks = std::collections::BTreeMap::new();
    if args.check_nan {
        let found = rendered.non_finite.iter().map(|(pass, image, count)| (format!("{pass}: {image}"), serde_json::json!(count)));
        checks.insert("check-nan".to_owned(), serde_json::Value::Object(found.collect()));
    }
    let messages = renderer.gpu().validation_messages();
    if args.validate {
        checks.insert("validation".to_owned(), serde_json::json!(messages));
    }
    let counted = counts(&renderer, &config, Some(first_pass_ms), &rendered.counts);
    let report = RunReport {
        from: from.clone(),
        seed: u64::from(config.frame.seed),
        frames: frames.len() as u32,
        warmup: config.frame.warmup,
        choices: renderer.choices(&config),
        timings: Timings::of(&times),
        means: means(&counted),
        counts: counted,
        memory: Memory::of(&rendered.memory),
        checks,
        warnings,
        peak_memory_bytes: peak_memory_bytes(),
        config: serde_json::to_value(&config).context("the config cannot be written as JSON")?,
    };
    report.write(&folder.join(args.sequence.file_name("run", "json")))?;
    drop(writing);
    if let Some(path) = &args.trace {
        trace::finish(path, &from)?;
    }
    progress.end();

    if !args.quiet {
        print!("{}", timing_table(&times, &from, args.verbose));
    }
    if args.verbose {
        print!("\n{}\n{}\n", counts_table(&rendered.counts), memory_table(&rendered.memory));
    }
    println!("{}", if leaves_image { image.display() } else { frames_folder.display() });
    dumped.iter().for_each(|path| println!("{path}"));
    if let Some((pass, image, count)) = rendered.non_finite.first() {
        return Err(fail!(ComparisonFailed, "pass {pass}: {count} texels of {image} are not finite numbers"));
    }
    if let Some(first) = messages.first() {
        return Err(fail!(ComparisonFailed, "the validation layer has {} messages, the first: {first}", messages.len()));
    }
    Ok(())
}

/// The EXR's layers: the picture's radiance without a name, and those that the config asks for.
pub(super) fn layers(picture: &Picture, wanted: &[LayerName]) -> Vec<Layer> {
    let color = |name: &str, plane: &Plane| Layer::interleaved(name, "RGB", plane.channels, &plane.values, Precision::Half);
    let radiance = &picture.radiance;
    let mut layers = vec![Layer::interleaved("", "RGBA", radiance.channels, &radiance.values, Precision::Half)];
    let vectors = |name: &str, vectors: Vec<glam::Vec3>| {
        let values: Vec<f32> = vectors.iter().flat_map(|v| v.to_array()).collect();
        Layer::interleaved(name, "XYZ", 3, &values, Precision::Float)
    };
    layers.extend(wanted.iter().map(|layer| match layer {
        LayerName::Direct => color("direct", &picture.direct),
        LayerName::Indirect => color("indirect", &picture.indirect),
        LayerName::Irradiance => color("irradiance", &picture.irradiance),
        LayerName::Albedo => color("albedo", &picture.albedo),
        LayerName::Normal => vectors("N", picture.normals()),
        LayerName::Position => vectors("P", picture.positions()),
        LayerName::Depth => Layer::interleaved("", "Z", 1, &picture.distances(), Precision::Float),
    }));
    layers
}

/// Writes a dumped resource below `DIR/dump/<pass>/`: an image as EXR, its layers as such, a picture of 8 bits as PNG;
/// a buffer as its bytes.
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
                Layer::interleaved(&name, channels, plane.channels, values, Precision::Float)
            });
            write_exr(&path, size[0], size[1], layers.collect(), &[])?;
            path
        }
        DumpData::Buffer { element, element_bytes, bytes } => {
            let path = folder.join(format!("{name}.{element}.{element_bytes}-bytes.bin"));
            write_file(&path, bytes)?;
            path
        }
    };
    Ok(path.display().to_string())
}
