//! Runs frames: pipelines, resources, barriers, recording, timing.

use super::check;
use super::library::Library;
use super::pass::{DrawList, Extent, Pass, Work};
use super::plan::{Access, plan};
use super::pool::{BufferKind, Pool};
use super::{Graph, ReadBack, Resource, Source};
use crate::error::{Exit, exit_code};
use crate::gpu::{
    Accesses, Attachment, Barrier, BindingKind, Bound, BufferId, Commands, Format, Gpu, ImageDesc, ImageId, PipelineId, RasterState,
    Sampler, ShaderAccess, Stages,
};
use anyhow::{Context, Result, bail};
use std::collections::{BTreeSet, HashMap};
use std::time::Instant;

/// How passes are timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Timing {
    /// A full barrier around each pass: the times of the passes sum to the frame's.
    #[default]
    Isolated,
    /// Only the barriers that the hazards need: passes may overlap, a stamp follows each.
    Overlapped,
    /// A submission for each pass, by the host's clock.
    Serial,
}

/// What to do beside running the passes.
#[derive(Debug, Clone, Default)]
pub struct Execution {
    pub timing: Timing,
    /// Names of passes whose written resources are copied out right after them.
    pub dump: Vec<String>,
    /// Counts texels that are not finite after every pass.
    pub check_nan: bool,
}

/// What a frame gave.
#[derive(Debug, Clone, Default)]
pub struct FrameOutcome {
    /// Each pass's time in milliseconds, in order.
    pub times: Vec<(&'static str, f64)>,
    pub dumps: Vec<Dump>,
    /// Pass, image, and how many of its texels are not finite; only those with some.
    pub non_finite: Vec<(&'static str, String, u32)>,
    read: Vec<Vec<u8>>,
}

impl FrameOutcome {
    /// The bytes of a resource that was read back: texels of all layers, or elements.
    pub fn bytes(&self, read_back: ReadBack) -> &[u8] {
        &self.read[read_back.0]
    }
}

/// A resource as it was right after a pass.
#[derive(Debug, Clone)]
pub struct Dump {
    pub pass: &'static str,
    pub resource: String,
    pub data: DumpData,
}

#[derive(Debug, Clone)]
pub enum DumpData {
    Image { format: Format, size: [u32; 2], layers: u32, texels: Vec<u8> },
    Buffer { element: &'static str, element_bytes: usize, bytes: Vec<u8> },
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct PipelineKey {
    shader: &'static str,
    constants: Vec<(&'static str, u32)>,
    raster: Option<RasterState>,
}

/// A device with its shaders, pipelines and pooled resources: what stays from frame to frame.
pub struct Engine {
    pub gpu: Gpu,
    library: Library,
    pipelines: HashMap<PipelineKey, PipelineId>,
    pool: Pool,
}

/// A pass with everything looked up.
struct Ready<'g> {
    pass: &'g Pass,
    barrier: Option<Barrier>,
    /// One for a dispatch, one a draw list for a raster pass.
    steps: Vec<Step>,
    dump: Vec<(Resource, BufferId)>,
    /// Images to check, and where their counts go.
    check: Vec<(ImageId, [u32; 3], u32)>,
}

struct Step {
    pipeline: PipelineId,
    bound: Vec<(u32, Bound)>,
}

/// The frame's resources on the device.
struct Placed {
    images: HashMap<usize, ImageId>,
    buffers: HashMap<usize, BufferId>,
}

crate::shader_struct! {
    /// Push constants of `check/non-finite`.
    struct CheckParams {
        size: [u32; 3],
        slot: u32,
    }
}

const CHECK: &str = "check/non-finite";

impl Engine {
    pub fn new(gpu: Gpu, library: Library) -> Self {
        Self { gpu, library, pipelines: HashMap::new(), pool: Pool::default() }
    }

    /// Compiles the graph's shaders and makes its pipelines, so that no frame has to.
    pub fn prepare(&mut self, graph: &Graph) -> Result<()> {
        check::order(graph)?;
        let mut paths = BTreeSet::new();
        for pass in &graph.passes {
            match pass.work {
                Work::Compute(_) => paths.extend([format!("{}.comp", pass.shader)]),
                Work::Raster { .. } => paths.extend([format!("{}.vert", pass.shader), format!("{}.frag", pass.shader)]),
            }
        }
        self.library.prepare(&paths)?;
        for pass in &graph.passes {
            match &pass.work {
                Work::Compute(_) => {
                    self.pipeline(graph, pass, None)?;
                }
                Work::Raster { draws, .. } => {
                    for list in draws {
                        self.pipeline(graph, pass, Some(list))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn pipeline(&mut self, graph: &Graph, pass: &Pass, list: Option<&DrawList>) -> Result<PipelineId> {
        let raster = match &pass.work {
            Work::Compute(_) => None,
            Work::Raster { color, depth, .. } => Some(RasterState {
                color: color.iter().map(|target| target.image.format).collect(),
                depth: depth.map(|(image, _)| image.format),
                cull_back: list.is_some_and(|list| list.cull_back),
            }),
        };
        let mut constants = pass.constants.clone();
        constants.extend(list.iter().flat_map(|list| list.constants.iter().copied()));
        let key = PipelineKey { shader: pass.shader, constants, raster };
        let id = match self.pipelines.get(&key) {
            Some(id) => *id,
            None => {
                let id = self.make_pipeline(pass, &key)?;
                self.pipelines.insert(key.clone(), id);
                id
            }
        };
        // Another pass, or another frame, may declare itself differently over the same pipeline.
        check::bindings(graph, pass, list, self.gpu.bindings(id))?;
        let extensions: &[&str] = if key.raster.is_some() { &["vert", "frag"] } else { &["comp"] };
        let shaders = extensions.iter().map(|e| self.library.get(&format!("{}.{e}", pass.shader)));
        check::params(pass, &shaders.map(|shader| shader.push_constants.as_ref()).collect::<Vec<_>>())?;
        Ok(id)
    }

    fn make_pipeline(&mut self, pass: &Pass, key: &PipelineKey) -> Result<PipelineId> {
        let ids = |shader: &crate::gpu::Shader| -> Vec<(u32, u32)> {
            let id = |name: &str| shader.constants.iter().find(|(known, _)| known == name).map(|(_, id)| *id);
            key.constants.iter().filter_map(|(name, value)| Some((id(name)?, *value))).collect()
        };
        let known = |name: &str, shaders: &[&crate::gpu::Shader]| shaders.iter().any(|s| s.constants.iter().any(|(n, _)| n == name));
        let unknown = |shaders: &[&crate::gpu::Shader]| key.constants.iter().map(|(name, _)| *name).find(|name| !known(name, shaders));
        match &key.raster {
            None => {
                let shader = self.library.get(&format!("{}.comp", pass.shader));
                if let Some(name) = unknown(&[shader]) {
                    bail!("pass {}: the shader has no specialization constant {name}", pass.name);
                }
                self.gpu.create_compute_pipeline(pass.name, shader, &ids(shader))
            }
            Some(state) => {
                let vertex = self.library.get(&format!("{}.vert", pass.shader));
                let fragment = self.library.get(&format!("{}.frag", pass.shader));
                if let Some(name) = unknown(&[vertex, fragment]) {
                    bail!("pass {}: the shaders have no specialization constant {name}", pass.name);
                }
                if let Work::Raster { color, .. } = &pass.work {
                    let mut outputs = fragment.outputs.clone();
                    outputs.sort_by_key(|(_, location)| *location);
                    let outputs: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
                    let declared: Vec<&str> = color.iter().map(|target| target.output).collect();
                    if outputs != declared {
                        bail!("pass {}: renders to {declared:?}, the shader's outputs are {outputs:?}", pass.name);
                    }
                }
                self.gpu.create_raster_pipeline(pass.name, [vertex, fragment], [&ids(vertex), &ids(fragment)], state)
            }
        }
    }

    /// Runs a frame and waits for it.
    pub fn execute(&mut self, graph: &Graph, execution: &Execution) -> Result<FrameOutcome> {
        self.prepare(graph)?;
        self.pool.begin();
        let placed = self.place(graph)?;
        let barriers = plan(&graph.passes.iter().map(accesses).collect::<Vec<_>>());
        let mut ready = Vec::with_capacity(graph.passes.len());
        let mut checked: Vec<(&'static str, String)> = Vec::new();
        for (pass, barrier) in graph.passes.iter().zip(barriers) {
            let steps = match &pass.work {
                Work::Compute(_) => vec![self.step(graph, &placed, pass, None)?],
                Work::Raster { draws, .. } => {
                    draws.iter().map(|list| self.step(graph, &placed, pass, Some(list))).collect::<Result<_>>()?
                }
            };
            let mut dump = Vec::new();
            if execution.dump.iter().any(|name| name == pass.name) {
                for resource in pass.written() {
                    let name = format!("dump {} {}", pass.name, graph.name(resource));
                    dump.push((resource, self.read_back_buffer(graph, resource, &name)?));
                }
            }
            let mut check = Vec::new();
            if execution.check_nan {
                for resource in pass.written() {
                    let Resource::Image(image) = resource else { continue };
                    if image.format.is_float() {
                        let size = [image.size[0], image.size[1], image.layers];
                        check.push((placed.images[&resource.index()], size, checked.len() as u32));
                        checked.push((pass.name, graph.name(resource).to_owned()));
                    }
                }
            }
            ready.push(Ready { pass, barrier, steps, dump, check });
        }
        let checker = if execution.check_nan { Some(self.checker(checked.len())?) } else { None };
        let mut read_backs = Vec::new();
        for (i, resource) in graph.read_backs.iter().enumerate() {
            read_backs.push((*resource, self.read_back_buffer(graph, *resource, &format!("read back {i}"))?));
        }
        let crumbs = self.pool.buffer(&mut self.gpu, "breadcrumbs", 4 * graph.passes.len().max(1) as u64, BufferKind::ReadBack)?;
        let times = self.run(&ready, execution.timing, &placed, checker, crumbs, &read_backs)?;

        let mut outcome = FrameOutcome { times, ..FrameOutcome::default() };
        for ready in &ready {
            for (resource, buffer) in &ready.dump {
                let bytes = self.gpu.read_buffer(*buffer).to_vec();
                let data = match *resource {
                    Resource::Image(i) => DumpData::Image { format: i.format, size: i.size, layers: i.layers, texels: bytes },
                    Resource::Buffer(b) => {
                        let element = graph.slots[b.index as usize].element;
                        let (element, element_bytes) = element.map_or(("bytes", 1), |element| (element.name, element.bytes));
                        DumpData::Buffer { element, element_bytes, bytes }
                    }
                };
                outcome.dumps.push(Dump { pass: ready.pass.name, resource: graph.name(*resource).to_owned(), data });
            }
        }
        if let Some((_, counts)) = checker {
            let words = self.gpu.read_buffer(counts).chunks_exact(4).map(|w| u32::from_ne_bytes([w[0], w[1], w[2], w[3]]));
            let found = checked.into_iter().zip(words).filter(|(_, count)| *count > 0);
            outcome.non_finite = found.map(|((pass, image), count)| (pass, image, count)).collect();
        }
        outcome.read = read_backs.iter().map(|(_, buffer)| self.gpu.read_buffer(*buffer).to_vec()).collect();
        self.pool.trim(&mut self.gpu);
        Ok(outcome)
    }

    /// Lends every resource of the graph its memory; usage flags come from how the passes use it.
    fn place(&mut self, graph: &Graph) -> Result<Placed> {
        let mut placed = Placed { images: HashMap::new(), buffers: HashMap::new() };
        let (mut indices, mut wanted) = (Vec::new(), Vec::new());
        for (index, slot) in graph.slots.iter().enumerate() {
            match (slot.resource, &slot.source) {
                (_, Source::ImportedBuffer(id)) => {
                    placed.buffers.insert(index, *id);
                }
                (_, Source::ImportedImage(id)) => {
                    placed.images.insert(index, *id);
                }
                (Resource::Buffer(buffer), Source::Transient) => {
                    let bytes = graph.buffer_bytes(buffer);
                    let limit = self.gpu.adapter.limits.storage_buffer_bytes;
                    if bytes > limit {
                        bail!(
                            "{}: {bytes} bytes are over the {limit} that {} lets a shader see; lower the counts in the config",
                            slot.name,
                            self.gpu.adapter.name
                        );
                    }
                    placed.buffers.insert(index, self.pool.buffer(&mut self.gpu, &slot.name, bytes, BufferKind::Device)?);
                }
                (_, Source::Uploaded(bytes)) => {
                    let id = self.pool.buffer(&mut self.gpu, &slot.name, bytes.len() as u64, BufferKind::Upload)?;
                    self.gpu.write_upload_buffer(id, bytes);
                    placed.buffers.insert(index, id);
                }
                (Resource::Image(image), Source::Transient) => {
                    let stored = |pass: &Pass| pass.uses.iter().any(|u| u.resource.index() == index && u.access != ShaderAccess::Read);
                    let rendered = |pass: &Pass| match &pass.work {
                        Work::Raster { color, depth, .. } => {
                            color.iter().any(|target| target.image.index as usize == index)
                                || depth.iter().any(|(image, _)| image.index as usize == index)
                        }
                        Work::Compute(_) => false,
                    };
                    let desc = ImageDesc {
                        format: image.format,
                        width: image.size[0],
                        height: image.size[1],
                        layers: image.layers,
                        mips: 1,
                        attachment: graph.passes.iter().any(rendered),
                        storage: graph.passes.iter().any(stored),
                    };
                    indices.push(index);
                    wanted.push((slot.name.clone(), desc));
                }
            }
        }
        let ids = self.pool.images(&mut self.gpu, &wanted)?;
        placed.images.extend(indices.into_iter().zip(ids));
        Ok(placed)
    }

    fn step(&mut self, graph: &Graph, placed: &Placed, pass: &Pass, list: Option<&DrawList>) -> Result<Step> {
        let pipeline = self.pipeline(graph, pass, list)?;
        let samplers = pass.uses.iter().map(|u| u.sampler);
        let samplers: Vec<Sampler> = samplers.chain(list.iter().flat_map(|list| list.textures.iter().map(|t| t.2))).collect();
        for sampler in samplers {
            self.gpu.prepare_sampler(sampler)?;
        }
        let bindings = self.gpu.bindings(pipeline);
        let mut bound = Vec::with_capacity(bindings.len());
        for used in &pass.uses {
            let (number, binding) = &bindings[used.binding];
            let index = used.resource.index();
            bound.push((
                *number,
                match binding.kind {
                    BindingKind::UniformBlock(_) => Bound::UniformBuffer(placed.buffers[&index]),
                    BindingKind::StorageBlock(_) => Bound::StorageBuffer(placed.buffers[&index]),
                    BindingKind::Sampled { array } => Bound::SampledImage { image: placed.images[&index], array, sampler: used.sampler },
                    BindingKind::StorageImage { array } => Bound::StorageImage { image: placed.images[&index], array },
                },
            ));
        }
        for (name, image, sampler) in list.iter().flat_map(|list| &list.textures) {
            // A list may bring textures that its constants switch off in the shader.
            if let Some((number, _)) = bindings.get(*name) {
                bound.push((*number, Bound::SampledImage { image: *image, array: true, sampler: *sampler }));
            }
        }
        for block in list.iter().flat_map(|list| &list.blocks) {
            if let Some((number, _)) = bindings.get(block.binding) {
                let bytes = block.element.bytes as u64;
                bound.push((*number, Bound::UniformRange { buffer: block.buffer, offset: block.offset, bytes }));
            }
        }
        Ok(Step { pipeline, bound })
    }

    fn read_back_buffer(&mut self, graph: &Graph, resource: Resource, name: &str) -> Result<BufferId> {
        let bytes = match resource {
            Resource::Image(image) => {
                image.size[0] as u64 * u64::from(image.size[1]) * u64::from(image.layers) * image.format.texel_bytes() as u64
            }
            Resource::Buffer(buffer) => graph.buffer_bytes(buffer),
        };
        self.pool.buffer(&mut self.gpu, name, bytes, BufferKind::ReadBack)
    }

    /// The pipeline that counts texels which are not finite, and where it counts them.
    fn checker(&mut self, count: usize) -> Result<(PipelineId, BufferId)> {
        self.library.prepare(&BTreeSet::from([format!("{CHECK}.comp")]))?;
        self.gpu.prepare_sampler(Sampler::Nearest)?;
        let key = PipelineKey { shader: CHECK, constants: Vec::new(), raster: None };
        let id = match self.pipelines.get(&key) {
            Some(id) => *id,
            None => self.gpu.create_compute_pipeline(CHECK, self.library.get(&format!("{CHECK}.comp")), &[])?,
        };
        self.pipelines.insert(key, id);
        let counts = self.pool.buffer(&mut self.gpu, "non-finite counts", 4 * count.max(1) as u64, BufferKind::ReadBack)?;
        Ok((id, counts))
    }

    fn run(
        &mut self,
        ready: &[Ready<'_>],
        timing: Timing,
        placed: &Placed,
        checker: Option<(PipelineId, BufferId)>,
        crumbs: BufferId,
        read_backs: &[(Resource, BufferId)],
    ) -> Result<Vec<(&'static str, f64)>> {
        let gpu = &mut self.gpu;
        // The recorder borrows the device, so what it looks up there is looked up first.
        let local_sizes: Vec<[u32; 3]> =
            ready.iter().map(|r| r.steps.first().map_or([1; 3], |step| gpu.local_size(step.pipeline))).collect();
        let record_pass = |commands: &mut Commands<'_>, i: usize| record(commands, &ready[i], local_sizes[i], placed);
        let after_pass = |commands: &mut Commands<'_>, i: usize| {
            commands.fill_word(crumbs, 4 * i as u64, 1);
            watch(commands, &ready[i], placed, checker);
        };
        let prologue = |commands: &mut Commands<'_>| {
            (0..ready.len()).for_each(|i| commands.fill_word(crumbs, 4 * i as u64, 0));
            let counts = ready.iter().map(|r| r.check.len()).sum::<usize>();
            checker.iter().for_each(|(_, buffer)| (0..counts).for_each(|i| commands.fill_word(*buffer, 4 * i as u64, 0)));
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
                let boundary = |commands: &mut Commands<'_>| {
                    if timing == Timing::Isolated {
                        commands.barrier(&Barrier::FULL);
                    }
                    // On a software driver a timestamp only takes effect at the next flush, which the second one brings.
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
        let serial = |gpu: &mut Gpu| -> Result<Vec<f64>> {
            gpu.submit("a frame", prologue)?;
            let mut times = Vec::with_capacity(ready.len());
            for (i, pass) in ready.iter().enumerate() {
                let start = Instant::now();
                gpu.submit(pass.pass.name, |commands| {
                    record_pass(commands, i);
                    commands.barrier(&Barrier::FULL);
                })?;
                times.push(start.elapsed().as_secs_f64() * 1e3);
                gpu.submit(pass.pass.name, |commands| after_pass(commands, i))?;
            }
            gpu.submit("a frame", epilogue)?;
            Ok(times)
        };
        let times = result.and_then(|()| match timing {
            Timing::Serial => serial(gpu),
            _ => {
                let stamps = gpu.timestamps(4 * ready.len() as u32)?;
                Ok((0..ready.len()).map(|i| stamps[4 * i + 2] - stamps[4 * i]).collect())
            }
        });
        let times = match times {
            Err(error) if exit_code(&error) == Exit::DeviceLost => {
                let ended = gpu.read_buffer(crumbs).chunks_exact(4).take(ready.len()).take_while(|word| word[0] == 1).count();
                let last = ended.checked_sub(1).map_or("none", |i| ready[i].pass.name);
                return Err(error).with_context(|| format!("rendering (the last pass known to have ended: {last})"));
            }
            other => other?,
        };
        Ok(ready.iter().map(|r| r.pass.name).zip(times).collect())
    }
}

/// What a pass touches, for the plan.
fn accesses(pass: &Pass) -> Vec<Access> {
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
    if let Work::Raster { color, depth, draws } = &pass.work {
        let both = Accesses::ATTACHMENT_READ | Accesses::ATTACHMENT_WRITE;
        color.iter().for_each(|target| add(target.image.index as usize, Stages::ATTACHMENT, both));
        depth.iter().for_each(|(image, _)| add(image.index as usize, Stages::ATTACHMENT, both));
        draws.iter().for_each(|list| add(list.arguments.index as usize, Stages::INDIRECT, Accesses::INDIRECT_READ));
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
        Work::Raster { color, depth, draws } => {
            let attachment = |image: super::Image, load| Attachment { image: placed.images[&(image.index as usize)], load };
            let size =
                color.iter().map(|target| target.image.size).chain(depth.iter().map(|(image, _)| image.size)).next().unwrap_or([1, 1]);
            let color: Vec<Attachment> = color.iter().map(|target| attachment(target.image, target.load)).collect();
            commands.begin_rendering(size, &color, depth.map(|(image, load)| attachment(image, load)));
            for (list, step) in draws.iter().zip(&ready.steps) {
                bind(commands, step);
                commands.bind_geometry(list.vertices, list.indices);
                commands.draw_indexed_indirect(placed.buffers[&(list.arguments.index as usize)], list.first, list.count);
            }
            commands.end_rendering();
        }
    }
    commands.end_label();
}

/// Copies and counts what a pass has written, outside its time.
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
            // In the order of the shader's names: counts, image.
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
