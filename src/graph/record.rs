//! Recording, submission and timing of a frame's passes.

use super::Resource;
use super::engine::Timing;
use super::pass::{Extent, Pass, Work};
use super::plan::Access;
use crate::error::{Exit, exit_code};
use crate::gpu::{Accesses, Attachment, Barrier, Bound, BufferId, Commands, Gpu, ImageId, PipelineId, Sampler, ShaderAccess, Stages};
use anyhow::{Context, Result};
use std::collections::HashMap;
use std::time::Instant;

/// A pass with pipelines and resources resolved.
pub(super) struct Ready<'g> {
    pub pass: &'g Pass,
    pub barrier: Option<Barrier>,
    /// One for a dispatch; one a draw list for a raster pass.
    pub steps: Vec<Step>,
    pub dump: Vec<(Resource, BufferId)>,
    /// Images to check, with their sizes and the slots of their counts.
    pub check: Vec<(ImageId, [u32; 3], u32)>,
}

pub(super) struct Step {
    pub pipeline: PipelineId,
    pub bound: Vec<(u32, Bound)>,
}

/// Resources of the frame on the device.
pub(super) struct Placed {
    pub images: HashMap<usize, ImageId>,
    pub buffers: HashMap<usize, BufferId>,
    /// Buffers that are zeroed when the frame begins.
    pub zeroed: Vec<BufferId>,
}

/// Times of the passes.
pub(super) struct Timed {
    /// Time of each pass, milliseconds.
    pub times: Vec<(&'static str, f64)>,
    /// Begin of each pass, milliseconds after the first.
    pub begins: Vec<f64>,
    /// Host time of submission of the first pass, which is just before it began.
    pub submitted: Instant,
}

crate::shader_struct! {
    /// Push constants of `check/non-finite`.
    struct CheckParams {
        size: [u32; 3],
        slot: u32,
    }
}

/// Runs passes and waits for them.
pub(super) fn run(
    gpu: &mut Gpu,
    ready: &[Ready<'_>],
    timing: Timing,
    placed: &Placed,
    checker: Option<(PipelineId, BufferId)>,
    crumbs: BufferId,
    read_backs: &[(Resource, BufferId)],
) -> Result<Timed> {
    // Looked up first, since the recorder borrows the device.
    let local_sizes: Vec<[u32; 3]> = ready.iter().map(|r| r.steps.first().map_or([1; 3], |step| gpu.local_size(step.pipeline))).collect();
    gpu.write_upload_buffer(crumbs, &vec![0; 4 * ready.len()]);
    let record_pass = |commands: &mut Commands<'_>, i: usize| record(commands, &ready[i], local_sizes[i], placed);
    let after_pass = |commands: &mut Commands<'_>, i: usize| {
        commands.fill_word(crumbs, 4 * i as u64, 1);
        watch(commands, &ready[i], placed, checker);
    };
    let prologue = |commands: &mut Commands<'_>| {
        let counts = ready.iter().map(|r| r.check.len()).sum::<usize>();
        checker.iter().for_each(|(_, buffer)| (0..counts).for_each(|i| commands.fill_word(*buffer, 4 * i as u64, 0)));
        placed.zeroed.iter().for_each(|buffer| commands.fill_zeros(*buffer));
        commands.barrier(&Barrier::FULL);
    };
    let epilogue = |commands: &mut Commands<'_>| {
        commands.barrier(&Barrier::FULL);
        for (resource, buffer) in read_backs {
            copy_out(commands, *resource, *buffer, placed);
        }
        commands.barrier_to_host();
    };
    let result = match timing {
        Timing::Isolated | Timing::Overlapped => gpu.submit("a frame", |commands| {
            prologue(commands);
            if !ready.is_empty() {
                commands.expect_stamps(4 * ready.len() as u32);
            }
            let boundary = |commands: &mut Commands<'_>| {
                if timing == Timing::Isolated {
                    commands.barrier(&Barrier::FULL);
                }
                // Stamped twice: on a software driver a timestamp takes effect only at the next flush, which the second one causes.
                commands.stamp();
                commands.stamp();
            };
            for (i, pass) in ready.iter().enumerate() {
                boundary(commands);
                if timing == Timing::Overlapped
                    && let Some(barrier) = &pass.barrier
                {
                    commands.barrier(barrier);
                }
                record_pass(commands, i);
                boundary(commands);
                after_pass(commands, i);
            }
            epilogue(commands);
        }),
        Timing::Serial => Ok(()),
    };
    // Begin and time of each pass, and host time of the first submission.
    let serial = |gpu: &mut Gpu| -> Result<(Vec<[f64; 2]>, Instant)> {
        gpu.submit("a frame", prologue)?;
        let first = Instant::now();
        let mut times = Vec::with_capacity(ready.len());
        for (i, pass) in ready.iter().enumerate() {
            let start = Instant::now();
            gpu.submit(pass.pass.name, |commands| {
                record_pass(commands, i);
                commands.barrier(&Barrier::FULL);
            })?;
            times.push([start.duration_since(first), start.elapsed()].map(|time| time.as_secs_f64() * 1e3));
            gpu.submit(pass.pass.name, |commands| after_pass(commands, i))?;
        }
        gpu.submit("a frame", epilogue)?;
        Ok((times, first))
    };
    let timed = result.and_then(|()| match timing {
        Timing::Serial => serial(gpu),
        // A graph may consist of read-backs alone.
        _ if ready.is_empty() => Ok((Vec::new(), gpu.submitted())),
        _ => {
            let stamps = gpu.timestamps(4 * ready.len() as u32)?;
            let times = (0..ready.len()).map(|i| [stamps[4 * i], stamps[4 * i + 2] - stamps[4 * i]]);
            Ok((times.collect(), gpu.submitted()))
        }
    });
    let (times, submitted) = match timed {
        // If passes overlap, the last one that left its mark may not be the last that ran.
        Err(error) if exit_code(&error) == Exit::DeviceLost && timing == Timing::Overlapped => {
            return Err(error).context("rendering (--timing serial would tell which pass was the last)");
        }
        Err(error) if exit_code(&error) == Exit::DeviceLost => {
            let ended = gpu.read_buffer(crumbs).chunks_exact(4).take(ready.len()).take_while(|word| word[0] == 1).count();
            let last = ended.checked_sub(1).map_or("none", |i| ready[i].pass.name);
            return Err(error).with_context(|| format!("rendering (the last pass known to have ended: {last})"));
        }
        other => other?,
    };
    Ok(Timed {
        times: ready.iter().zip(&times).map(|(ready, [_, ms])| (ready.pass.name, *ms)).collect(),
        begins: times.iter().map(|[begin, _]| *begin).collect(),
        submitted,
    })
}

/// Accesses of a pass, for the plan.
pub(super) fn accesses(pass: &Pass) -> Vec<Access> {
    let stages = match pass.work {
        Work::Compute(_) => Stages::COMPUTE,
        Work::Raster { .. } => Stages::PRE_RASTER | Stages::FRAGMENT,
    };
    let mut all: Vec<Access> = Vec::new();
    let mut add = |resource: usize, stages, accesses| match all.iter_mut().find(|known| known.resource == resource) {
        Some(known) => {
            known.stages |= stages;
            known.accesses |= accesses;
        }
        None => all.push(Access { resource, stages, accesses }),
    };
    for used in &pass.uses {
        let kinds = match used.access {
            ShaderAccess::Read => Accesses::SHADER_READ,
            ShaderAccess::Write => Accesses::SHADER_WRITE,
            ShaderAccess::ReadWrite => Accesses::SHADER_READ | Accesses::SHADER_WRITE,
        };
        add(used.resource.index(), stages, kinds);
    }
    if let Work::Raster { color, depth, draws, .. } = &pass.work {
        let both = Accesses::ATTACHMENT_READ | Accesses::ATTACHMENT_WRITE;
        color.iter().for_each(|target| add(target.image.index as usize, Stages::ATTACHMENT, both));
        depth.iter().for_each(|(image, _)| add(image.index as usize, Stages::ATTACHMENT, both));
        for list in draws {
            add(list.arguments.index as usize, Stages::INDIRECT, Accesses::INDIRECT_READ);
            for geometry in [list.vertices].into_iter().chain(list.indices) {
                add(geometry.index as usize, Stages::VERTEX_INPUT, Accesses::VERTEX_READ);
            }
        }
    }
    all
}

fn record(commands: &mut Commands<'_>, ready: &Ready<'_>, local_size: [u32; 3], placed: &Placed) {
    let pass = ready.pass;
    commands.begin_label(pass.name);
    let bind = |commands: &mut Commands<'_>, step: &Step| {
        commands.bind(step.pipeline);
        commands.push_descriptors(step.pipeline, &step.bound);
        if let Some((_, bytes)) = &pass.params {
            commands.push_constants(step.pipeline, bytes);
        }
    };
    match &pass.work {
        Work::Compute(extent) => {
            let groups = match *extent {
                Extent::Groups(groups) => groups,
                Extent::Invocations(n) => std::array::from_fn(|axis| n[axis].div_ceil(local_size[axis])),
            };
            bind(commands, &ready.steps[0]);
            commands.dispatch(groups);
        }
        Work::Raster { color, depth, draws, .. } => {
            let attachment = |image: super::Image, load| Attachment { image: placed.images[&(image.index as usize)], load };
            let size =
                color.iter().map(|target| target.image.size).chain(depth.iter().map(|(image, _)| image.size)).next().unwrap_or([1, 1]);
            let color: Vec<Attachment> = color.iter().map(|target| attachment(target.image, target.load)).collect();
            commands.begin_rendering(size, &color, depth.map(|(image, load)| attachment(image, load)));
            for (list, step) in draws.iter().zip(&ready.steps) {
                bind(commands, step);
                let id = |buffer: super::Buffer| placed.buffers[&(buffer.index as usize)];
                commands.bind_geometry(id(list.vertices), list.indices.map(id));
                match list.indices {
                    Some(_) => commands.draw_indexed_indirect(id(list.arguments), list.first, list.count),
                    None => commands.draw_indirect(id(list.arguments), list.first, list.count),
                }
            }
            commands.end_rendering();
        }
    }
    commands.end_label();
}

/// Copies and checks the outputs of a pass, outside of its time.
fn watch(commands: &mut Commands<'_>, ready: &Ready<'_>, placed: &Placed, checker: Option<(PipelineId, BufferId)>) {
    if ready.dump.is_empty() && ready.check.is_empty() {
        return;
    }
    commands.barrier(&Barrier::FULL);
    for (resource, buffer) in &ready.dump {
        copy_out(commands, *resource, *buffer, placed);
    }
    if let Some((pipeline, counts)) = checker {
        for (image, size, slot) in &ready.check {
            let sampled = Bound::SampledImage { image: *image, array: true, sampler: Sampler::Nearest };
            commands.bind(pipeline);
            // Bindings are in the order of the shader's names: counts, image.
            commands.push_descriptors(pipeline, &[(0, Bound::StorageBuffer(counts)), (1, sampled)]);
            commands.push_constants(pipeline, bytemuck::bytes_of(&CheckParams { size: *size, slot: *slot }));
            commands.dispatch([size[0].div_ceil(8), size[1].div_ceil(8), size[2]]);
        }
    }
    commands.barrier(&Barrier::FULL);
}

fn copy_out(commands: &mut Commands<'_>, resource: Resource, buffer: BufferId, placed: &Placed) {
    match resource {
        Resource::Image(image) => commands.copy_image_to_buffer(placed.images[&(image.index as usize)], buffer),
        Resource::Buffer(from) => {
            let from = placed.buffers[&(from.index as usize)];
            commands.copy_whole_buffer(from, buffer);
        }
    }
}
