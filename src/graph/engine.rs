//! Runs frames: resolves the names of passes to pipelines and resources, and hands them to [`super::record`].

use super::check;
use super::library::Library;
use super::parts::Part;
use super::pass::{DrawList, Pass, Work};
use super::pipelines::PipelineKey;
use super::plan::plan;
use super::pool::{BufferKind, Pool};
use super::record::{Placed, Ready, Step, accesses};
use super::reuse::{self, Reuse};
use super::{Graph, Member, ReadBack, Resource, Source, Variant};
use crate::gpu::{BindingKind, Bound, BufferId, Format, Gpu, ImageDesc, PipelineId, Sampler};
use crate::trace;
use anyhow::{Result, bail};
use std::collections::{BTreeSet, HashMap, HashSet};

/// Timing mode of passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Timing {
    /// A full barrier around each pass; the times of the passes sum to the frame's.
    #[default]
    Isolated,
    /// Only barriers that hazards need: passes may overlap, and a timestamp follows each.
    Overlapped,
    /// One submission a pass, timed by the host.
    Serial,
}

/// Options of a run.
#[derive(Debug, Clone, Default)]
pub struct Execution {
    pub timing: Timing,
    /// Names of passes whose outputs are copied out directly after them.
    pub dump: Vec<String>,
    /// Counts texels that are not finite, after every pass.
    pub check_nan: bool,
    /// Whether results of the frame before are taken over.
    pub reuse: Reuse,
}

/// Results of a frame.
#[derive(Debug, Clone, Default)]
pub struct FrameOutcome {
    /// Time of each pass in order, milliseconds.
    pub times: Vec<(&'static str, f64)>,
    /// Begin of each pass, milliseconds after the first pass's.
    pub begins: Vec<f64>,
    /// Counters of the passes ([`Graph::count`]), by name.
    pub counts: Vec<(String, u64)>,
    pub dumps: Vec<Dump>,
    /// Pass, image, and number of texels that are not finite; only images with some.
    pub non_finite: Vec<(&'static str, String, u32)>,
    read: Vec<Vec<u8>>,
}

impl FrameOutcome {
    /// Bytes of a resource that was read back: texels of all layers, or elements.
    pub fn bytes(&self, read_back: ReadBack) -> &[u8] {
        &self.read[read_back.0]
    }
}

/// Copy of a resource directly after a pass.
#[derive(Debug, Clone)]
pub struct Dump {
    pub pass: &'static str,
    pub resource: String,
    pub data: DumpData,
}

#[derive(Debug, Clone)]
pub enum DumpData {
    Image { format: Format, size: [u32; 2], layers: u32, texels: Vec<u8> },
    Buffer { element: &'static str, members: &'static [Member], element_bytes: usize, bytes: Vec<u8> },
}

/// A device with its shaders and pipelines, shared by all sequences of frames.
pub struct Engine {
    pub gpu: Gpu,
    pub(super) library: Library,
    pub(super) pipelines: HashMap<PipelineKey, PipelineId>,
    /// Pool of frames that belong to no sequence.
    pool: Pool,
}

const CHECK: &str = "check/non-finite";

impl Engine {
    pub fn new(gpu: Gpu, library: Library) -> Self {
        Self { gpu, library, pipelines: HashMap::new(), pool: Pool::default() }
    }

    /// Hash of a shader's source, with these parts in its slots and default ones in the others, and of the compiler.
    pub fn shader_key(&self, path: &str, parts: &[Part]) -> Result<blake3::Hash> {
        self.library.key(path, parts)
    }

    /// Hash of all shaders' sources and of the compiler.
    pub fn shaders_key(&self) -> blake3::Hash {
        self.library.key_of_all()
    }

    /// Reads the shaders again, and keeps them if `prepare` succeeds with them; else the ones before stay. Returns whether they had changed.
    ///
    /// # Errors
    /// Those of the folder that `MANYLIGHT_GLSL` names, and those of `prepare`: the compiler's words, with file and line.
    pub fn reload(&mut self, prepare: impl FnOnce(&mut Self) -> Result<()>) -> Result<bool> {
        let fresh = Library::new()?;
        if fresh.key_of_all() == self.library.key_of_all() {
            return Ok(false);
        }
        let (library, pipelines) = (std::mem::replace(&mut self.library, fresh), std::mem::take(&mut self.pipelines));
        let prepared = prepare(self);
        let stale = match &prepared {
            Ok(()) => pipelines,
            Err(_) => {
                self.library = library;
                std::mem::replace(&mut self.pipelines, pipelines)
            }
        };
        stale.into_values().for_each(|id| self.gpu.free_pipeline(id));
        prepared.map(|()| true)
    }

    /// Number of pipelines made so far.
    pub fn pipelines_made(&self) -> usize {
        self.pipelines.len()
    }

    /// Compiles the graph's shaders and creates its pipelines, so that no frame has to.
    pub fn prepare(&mut self, graph: &Graph) -> Result<()> {
        check::order(graph)?;
        self.compile(graph)?;
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

    /// Runs a frame that belongs to no sequence, in the engine's own pool, and waits for it.
    pub fn execute(&mut self, graph: &Graph, execution: &Execution) -> Result<FrameOutcome> {
        let mut pool = std::mem::take(&mut self.pool);
        let outcome = self.run(&mut pool, graph, execution);
        self.pool = pool;
        outcome
    }

    /// Runs a frame as the next one of a sequence and waits for it.
    ///
    /// # Errors
    /// A pass whose declaration differs from its shader, and the device's own errors. The sequence's history is then zeroed in its next
    /// frame.
    pub fn run(&mut self, pool: &mut Pool, graph: &Graph, execution: &Execution) -> Result<FrameOutcome> {
        let preparing = trace::span("preparing");
        self.prepare(graph)?;
        pool.begin();
        let mut placed = self.place(pool, graph)?;
        let (runs, memory) = reuse::plan(graph, &placed, execution.reuse, pool.memory.take().as_ref(), &execution.dump);
        let passes: Vec<&Pass> = graph.passes.iter().zip(&runs).filter(|(_, runs)| **runs).map(|(pass, _)| pass).collect();
        if passes.len() < graph.passes.len() {
            let written: HashSet<usize> = passes.iter().flat_map(|pass| pass.written()).map(Resource::index).collect();
            let anew = |(index, id): (&usize, &BufferId)| written.contains(index).then_some(*id);
            let anew: HashSet<BufferId> = placed.buffers.iter().filter_map(anew).collect();
            placed.zeroed.retain(|id| anew.contains(id));
        }
        let barriers = plan(&passes.iter().map(|pass| accesses(pass)).collect::<Vec<_>>());
        let mut ready = Vec::with_capacity(passes.len());
        let mut checked: Vec<(&'static str, String)> = Vec::new();
        for (pass, barrier) in passes.into_iter().zip(barriers) {
            let steps = match &pass.work {
                Work::Compute(_) => vec![self.step(graph, &placed, pass, None)?],
                Work::Raster { draws, .. } => {
                    draws.iter().map(|list| self.step(graph, &placed, pass, Some(list))).collect::<Result<_>>()?
                }
            };
            let mut dump = Vec::new();
            if execution.dump.iter().any(|name| name == pass.name) {
                // Counters are in the outcome anyway.
                for resource in pass.written().into_iter().filter(|resource| !graph.is_count(*resource)) {
                    let name = format!("dump {} {}", pass.name, graph.name(resource));
                    dump.push((resource, self.read_back_buffer(pool, graph, resource, &name)?));
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
        let checker = if execution.check_nan { Some(self.checker(pool, checked.len())?) } else { None };
        let mut read_backs = Vec::new();
        for (i, resource) in graph.read_backs.iter().enumerate() {
            read_backs.push((*resource, self.read_back_buffer(pool, graph, *resource, &format!("read back {i}"))?));
        }
        let counts: Vec<Resource> = graph.slots.iter().map(|slot| slot.resource).filter(|resource| graph.is_count(*resource)).collect();
        for resource in &counts {
            let name = format!("read back {}", graph.name(*resource));
            read_backs.push((*resource, self.read_back_buffer(pool, graph, *resource, &name)?));
        }
        let crumbs = pool.buffer(&mut self.gpu, "breadcrumbs", 4 * graph.passes.len().max(1) as u64, BufferKind::ReadBack)?;
        drop(preparing);
        let timed = super::record::run(&mut self.gpu, &ready, execution.timing, &placed, checker, crumbs, &read_backs)?;
        for ((pass, ms), begin) in timed.times.iter().zip(&timed.begins) {
            trace::pass(pass, timed.submitted, *begin, *ms);
        }

        let _span = trace::span("reading back");
        let mut outcome = FrameOutcome { times: timed.times, begins: timed.begins, ..FrameOutcome::default() };
        for ready in &ready {
            for (resource, buffer) in &ready.dump {
                let bytes = self.gpu.read_buffer(*buffer).to_vec();
                let data = match *resource {
                    Resource::Image(i) => DumpData::Image { format: i.format, size: i.size, layers: i.layers, texels: bytes },
                    Resource::Buffer(b) => {
                        let element = graph.slots[b.index as usize].element;
                        let (element, members, element_bytes) =
                            element.map_or(("bytes", &[][..], 1), |element| (element.name, element.members, element.bytes));
                        DumpData::Buffer { element, members, element_bytes, bytes }
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
        let (read_backs, counted) = read_backs.split_at(graph.read_backs.len());
        outcome.read = read_backs.iter().map(|(_, buffer)| self.gpu.read_buffer(*buffer).to_vec()).collect();
        for (resource, buffer) in counted {
            let count: u32 = bytemuck::pod_read_unaligned(&self.gpu.read_buffer(*buffer)[..4]);
            outcome.counts.push((graph.name(*resource).to_owned(), u64::from(count)));
        }
        outcome.counts.extend(graph.told.iter().cloned());
        pool.end(&mut self.gpu);
        pool.memory = memory;
        Ok(outcome)
    }

    /// Gives every resource of the graph its memory. Usage flags follow from the passes' uses.
    fn place(&mut self, pool: &mut Pool, graph: &Graph) -> Result<Placed> {
        let stored = self.storage_images(graph)?;
        let mut placed = Placed { images: HashMap::new(), buffers: HashMap::new(), zeroed: Vec::new() };
        let (mut indices, mut wanted) = (Vec::new(), Vec::new());
        for (index, slot) in graph.slots.iter().enumerate() {
            match (slot.resource, &slot.source) {
                (_, Source::ImportedBuffer(id) | Source::KeptBuffer(id)) => {
                    placed.buffers.insert(index, *id);
                }
                (_, Source::ImportedImage(id) | Source::KeptImage(id)) => {
                    placed.images.insert(index, *id);
                }
                (resource, Source::Counted | Source::Zeroed) => {
                    let id = pool.buffer(&mut self.gpu, &slot.name, graph.bytes(resource), BufferKind::Device)?;
                    placed.zeroed.push(id);
                    placed.buffers.insert(index, id);
                }
                (resource, Source::History) => {
                    let (id, new) = pool.history(&mut self.gpu, &slot.name, graph.bytes(resource))?;
                    placed.zeroed.extend(new.then_some(id));
                    placed.buffers.insert(index, id);
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
                    placed.buffers.insert(index, pool.buffer(&mut self.gpu, &slot.name, bytes, BufferKind::Device)?);
                }
                (_, Source::Uploaded(bytes)) => {
                    let id = pool.buffer(&mut self.gpu, &slot.name, bytes.len() as u64, BufferKind::Upload)?;
                    self.gpu.write_upload_buffer(id, bytes);
                    placed.buffers.insert(index, id);
                }
                (Resource::Image(image), Source::Transient) => {
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
                        storage: stored.contains(&index),
                    };
                    indices.push(index);
                    wanted.push((slot.name.clone(), desc));
                }
            }
        }
        let ids = pool.images(&mut self.gpu, &wanted)?;
        placed.images.extend(indices.into_iter().zip(ids));
        Ok(placed)
    }

    /// Indices of images that shaders use as storage images.
    fn storage_images(&mut self, graph: &Graph) -> Result<HashSet<usize>> {
        let mut stored = HashSet::new();
        for pass in &graph.passes {
            let list = match &pass.work {
                Work::Compute(_) => None,
                Work::Raster { draws, .. } if draws.is_empty() => continue,
                Work::Raster { draws, .. } => draws.first(),
            };
            let pipeline = self.pipeline(graph, pass, list)?;
            let bindings = self.gpu.bindings(pipeline);
            let uses = pass.uses.iter().filter(|used| matches!(bindings[used.binding].1.kind, BindingKind::StorageImage { .. }));
            stored.extend(uses.map(|used| used.resource.index()));
        }
        Ok(stored)
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

    fn read_back_buffer(&mut self, pool: &mut Pool, graph: &Graph, resource: Resource, name: &str) -> Result<BufferId> {
        pool.buffer(&mut self.gpu, name, graph.bytes(resource), BufferKind::ReadBack)
    }

    /// Pipeline that counts texels that are not finite, and the buffer of its counts.
    fn checker(&mut self, pool: &mut Pool, count: usize) -> Result<(PipelineId, BufferId)> {
        let shader = Variant { path: format!("{CHECK}.comp"), parts: Vec::new() };
        self.library.prepare(&BTreeSet::from([shader.clone()]))?;
        self.gpu.prepare_sampler(Sampler::Nearest)?;
        let key = PipelineKey { shader: CHECK, parts: Vec::new(), constants: Vec::new(), raster: None };
        let id = match self.pipelines.get(&key) {
            Some(id) => *id,
            None => self.gpu.create_compute_pipeline(CHECK, self.library.get(&shader), &[])?,
        };
        self.pipelines.insert(key, id);
        let counts = pool.buffer(&mut self.gpu, "non-finite counts", 4 * count.max(1) as u64, BufferKind::ReadBack)?;
        Ok((id, counts))
    }
}
