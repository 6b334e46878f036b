//! Passes, and the builders that declare them.

use super::{Buffer, Element, Graph, Image, Part, Resource, ShaderStruct};
use crate::gpu::{Blend, BufferId, ImageId, Load, Sampler, ShaderAccess, VertexLayout};
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Size of a dispatch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// At least this many invocations; the workgroup's size comes from the shader.
    Invocations([u32; 3]),
    Groups([u32; 3]),
}

/// Declared use of a binding.
#[derive(Debug, Clone)]
pub(super) struct Use {
    pub binding: &'static str,
    pub resource: Resource,
    pub access: ShaderAccess,
    pub sampler: Sampler,
}

/// Indexed triangles, or points, that are drawn at once, with all state that differs from other lists.
#[derive(Debug, Clone)]
pub struct DrawList {
    /// Textures of this list alone: binding, image array, sampler.
    pub textures: Vec<(&'static str, ImageId, Sampler)>,
    /// Uniform blocks of this list alone.
    pub blocks: Vec<ListBlock>,
    pub constants: Vec<(&'static str, u32)>,
    pub cull_back: bool,
    /// Layout of the vertices in their buffer.
    pub vertex: VertexLayout,
    /// Vertices and 32-bit indices, imported or written by a pass. Without indices every vertex is a point.
    pub vertices: Buffer,
    pub indices: Option<Buffer>,
    /// Indirect commands (`VkDrawIndexedIndirectCommand`, `VkDrawIndirectCommand` for points), and the range of them to draw.
    pub arguments: Buffer,
    pub first: u32,
    pub count: u32,
}

impl DrawList {
    /// All commands of `arguments`, from both sides, without textures, blocks or constants. `geometry` is the vertices and the indices.
    pub fn new(vertex: VertexLayout, geometry: [Buffer; 2], arguments: Buffer) -> Self {
        let [vertices, indices] = geometry;
        Self { indices: Some(indices), ..Self::points(vertex, vertices, arguments) }
    }

    /// All commands of `arguments` over points, without textures, blocks or constants.
    pub fn points(vertex: VertexLayout, vertices: Buffer, arguments: Buffer) -> Self {
        let (textures, blocks, constants) = (Vec::new(), Vec::new(), Vec::new());
        Self { textures, blocks, constants, cull_back: false, vertex, vertices, indices: None, arguments, first: 0, count: arguments.count }
    }
}

/// A uniform block in a range of a buffer that outlives the frame.
#[derive(Debug, Clone, Copy)]
pub struct ListBlock {
    pub binding: &'static str,
    pub buffer: BufferId,
    /// Offset in bytes, a multiple of 256.
    pub offset: u64,
    pub(super) element: Element,
}

impl ListBlock {
    /// Element `index` of a buffer of `T`s, as a block.
    pub fn of<T: ShaderStruct>(binding: &'static str, buffer: BufferId, index: u32) -> Self {
        Self { binding, buffer, offset: u64::from(index) * size_of::<T>() as u64, element: Element::of::<T>() }
    }
}

#[derive(Debug, Clone)]
pub(super) struct ColorTarget {
    pub output: &'static str,
    pub image: Image,
    pub load: Load,
    pub blend: Blend,
}

#[derive(Debug, Clone)]
pub(super) enum Work {
    Compute(Extent),
    Raster { color: Vec<ColorTarget>, depth: Option<(Image, Load)>, conservative: bool, draws: Vec<DrawList> },
}

#[derive(Debug, Clone)]
pub(super) struct Pass {
    pub name: &'static str,
    /// Name of its shaders; the pass's name unless it was changed.
    pub shader: &'static str,
    pub parts: Vec<Part>,
    pub uses: Vec<Use>,
    pub constants: Vec<(&'static str, u32)>,
    pub params: Option<(Element, Vec<u8>)>,
    pub work: Work,
}

macro_rules! declarations {
    () => {
        /// Uses another shader than the one of the pass's name.
        pub fn shader(mut self, shader: &'static str) -> Self {
            self.pass.shader = shader;
            self
        }

        /// Fills a slot of the shaders (`#include "part/SLOT"`) with `glsl/PART.glsl`.
        pub fn part(mut self, slot: &'static str, part: &'static str) -> Self {
            self.pass.parts.push((slot, part));
            self
        }

        /// Reads a resource; a sampled image is read without filtering.
        pub fn reads(self, binding: &'static str, resource: impl Into<Resource>) -> Self {
            self.uses(binding, resource.into(), ShaderAccess::Read, Sampler::Nearest)
        }

        /// Reads an image through a filtering sampler.
        pub fn samples(self, binding: &'static str, image: Image, sampler: Sampler) -> Self {
            self.uses(binding, image.into(), ShaderAccess::Read, sampler)
        }

        /// Writes a resource without reading it.
        pub fn writes(self, binding: &'static str, resource: impl Into<Resource>) -> Self {
            self.uses(binding, resource.into(), ShaderAccess::Write, Sampler::Nearest)
        }

        /// Reads and writes a resource.
        pub fn updates(self, binding: &'static str, resource: impl Into<Resource>) -> Self {
            self.uses(binding, resource.into(), ShaderAccess::ReadWrite, Sampler::Nearest)
        }

        /// Sets a specialization constant by name. Every constant that the shaders declare must be set, here or by all draw lists.
        pub fn constant(mut self, name: &'static str, value: impl ConstantValue) -> Self {
            self.pass.constants.push((name, value.bits()));
            self
        }

        /// Sets the push constants: block `params` in the shader.
        pub fn params<T: ShaderStruct>(mut self, params: &T) -> Self {
            self.pass.params = Some((Element::of::<T>(), bytemuck::bytes_of(params).to_vec()));
            self
        }

        fn uses(mut self, binding: &'static str, resource: Resource, access: ShaderAccess, sampler: Sampler) -> Self {
            self.pass.uses.push(Use { binding, resource, access, sampler });
            self
        }
    };
}

/// Types of specialization constants.
pub trait ConstantValue {
    fn bits(self) -> u32;
}

impl ConstantValue for u32 {
    fn bits(self) -> u32 {
        self
    }
}

impl ConstantValue for bool {
    fn bits(self) -> u32 {
        u32::from(self)
    }
}

impl ConstantValue for f32 {
    fn bits(self) -> u32 {
        self.to_bits()
    }
}

/// Interned copy of a name; it is never freed, but there are few names of passes.
fn interned(name: String) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name.as_str()) {
        return known;
    }
    let name: &'static str = name.leak();
    names.insert(name);
    name
}

/// A compute pass in declaration; it ends with [`Self::dispatch`] or [`Self::dispatch_groups`].
#[must_use = "a pass does nothing until it is dispatched"]
pub struct ComputePass<'g> {
    graph: &'g mut Graph,
    pass: Pass,
}

impl<'g> ComputePass<'g> {
    pub(super) fn new(graph: &'g mut Graph, name: &'static str) -> Self {
        let pass = Pass::new(graph, name, Work::Compute(Extent::Groups([0; 3])));
        Self { graph, pass }
    }

    declarations!();

    /// Runs at least this many invocations; shaders check their bounds.
    pub fn dispatch(self, invocations: [u32; 3]) {
        self.run(Extent::Invocations(invocations));
    }

    /// Runs this many workgroups.
    pub fn dispatch_groups(self, groups: [u32; 3]) {
        self.run(Extent::Groups(groups));
    }

    fn run(mut self, extent: Extent) {
        self.pass.work = Work::Compute(extent);
        self.graph.passes.push(self.pass);
    }
}

/// A raster pass in declaration; it ends with [`Self::draw`].
#[must_use = "a pass does nothing until it is drawn"]
pub struct RasterPass<'g> {
    graph: &'g mut Graph,
    pass: Pass,
    color: Vec<ColorTarget>,
    depth: Option<(Image, Load)>,
    conservative: bool,
}

impl<'g> RasterPass<'g> {
    pub(super) fn new(graph: &'g mut Graph, name: &'static str) -> Self {
        let pass = Pass::new(graph, name, Work::Raster { color: Vec::new(), depth: None, conservative: false, draws: Vec::new() });
        Self { graph, pass, color: Vec::new(), depth: None, conservative: false }
    }

    declarations!();

    /// Clears an image to a value and renders the fragment shader's output of this name into it.
    pub fn color(mut self, output: &'static str, image: Image, clear: [f32; 4]) -> Self {
        self.color.push(ColorTarget { output, image, load: Load::Clear(clear), blend: Blend::Replace });
        self
    }

    /// Renders the fragment shader's output of this name over the image's contents.
    pub fn color_over(mut self, output: &'static str, image: Image) -> Self {
        self.color.push(ColorTarget { output, image, load: Load::Keep, blend: Blend::Replace });
        self
    }

    /// Clears an image to 0 and blends the fragment shader's output of this name additively, in the triangles' order.
    pub fn color_sum(mut self, output: &'static str, image: Image) -> Self {
        self.color.push(ColorTarget { output, image, load: Load::Clear([0.0; 4]), blend: Blend::Add });
        self
    }

    /// Clears an image to a value and lays the fragment shader's output of this name over it, in the triangles' order. Its colours are
    /// multiplied by its alpha.
    pub fn color_blend(mut self, output: &'static str, image: Image, clear: [f32; 4]) -> Self {
        self.color.push(ColorTarget { output, image, load: Load::Clear(clear), blend: Blend::Over });
        self
    }

    /// Tests against the contents of a depth image; see [`Self::depth`].
    pub fn depth_over(mut self, image: Image) -> Self {
        self.depth = Some((image, Load::Keep));
        self
    }

    /// Clears a depth image to 0, which is infinitely far, and tests against it: a greater depth is nearer.
    pub fn depth(mut self, image: Image) -> Self {
        self.depth = Some((image, Load::Clear([0.0; 4])));
        self
    }

    /// Rasterizes conservatively, into every pixel that a triangle touches. The device needs
    /// [`ConservativeRasterization`](crate::gpu::Feature::ConservativeRasterization).
    pub fn conservatively(mut self) -> Self {
        self.conservative = true;
        self
    }

    /// Draws these lists in order.
    pub fn draw(mut self, draws: Vec<DrawList>) {
        self.pass.work = Work::Raster { color: self.color, depth: self.depth, conservative: self.conservative, draws };
        self.graph.passes.push(self.pass);
    }
}

impl Pass {
    fn new(graph: &Graph, name: &'static str, work: Work) -> Self {
        let shader = name;
        let name = if graph.suffix.is_empty() { name } else { interned(format!("{name}{}", graph.suffix)) };
        Self { name, shader, parts: Vec::new(), uses: Vec::new(), constants: Vec::new(), params: None, work }
    }

    /// All resources that the pass writes, attachments included.
    pub fn written(&self) -> Vec<Resource> {
        let mut written: Vec<Resource> = self.uses.iter().filter(|u| u.access != ShaderAccess::Read).map(|u| u.resource).collect();
        if let Work::Raster { color, depth, .. } = &self.work {
            written.extend(color.iter().map(|target| Resource::from(target.image)));
            written.extend(depth.iter().map(|(image, _)| Resource::from(*image)));
        }
        written
    }
}

impl Pass {
    /// Attachments that the pass renders over without clearing them.
    pub fn kept(&self) -> impl Iterator<Item = Resource> {
        let (color, depth) = match &self.work {
            Work::Raster { color, depth, .. } => (color.as_slice(), *depth),
            Work::Compute(_) => (&[][..], None),
        };
        let targets = color.iter().map(|target| (target.image, target.load)).chain(depth);
        targets.filter(|(_, load)| matches!(load, Load::Keep)).map(|(image, _)| image.into())
    }
}

impl Graph {
    /// Bytes of a buffer.
    pub(super) fn buffer_bytes(&self, buffer: Buffer) -> u64 {
        let bytes = self.slots[buffer.index as usize].element.map_or(1, |element| element.bytes);
        u64::from(buffer.count) * bytes as u64
    }
}
