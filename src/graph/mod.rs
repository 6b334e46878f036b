//! The frame graph: a frame is a list of passes in the order in which they run, declared by the names that their shaders use.
//!
//! A [`Graph`] is plain data, built anew each frame without a device. [`Engine::execute`] then holds every declaration against
//! the shaders' reflection, takes resources from a pool, puts the barriers of [`plan`] between the passes, records, submits
//! and times them. Nothing is reordered, merged or aliased: what was written is there to look at.

mod check;
mod engine;
mod library;
mod memory;
mod parts;
mod pass;
mod pipelines;
pub mod plan;
mod pool;
mod record;
mod shader_struct;

pub use engine::{Dump, DumpData, Engine, Execution, FrameOutcome, Timing};
pub use library::Library;
pub use parts::{Part, Variant};
pub use pass::{ComputePass, DrawList, Extent, ListBlock, RasterPass};
pub use pool::Pool;
pub use shader_struct::{Member, ShaderStruct};

use crate::gpu::{BufferId, Format, ImageId};
use pass::Pass;

/// An image of the frame: a handle, with what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    index: u32,
    pub format: Format,
    pub size: [u32; 2],
    pub layers: u32,
}

/// A buffer of the frame: an array of `count` elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Buffer {
    index: u32,
    pub count: u32,
}

/// Either kind, where a pass takes both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resource {
    Image(Image),
    Buffer(Buffer),
}

impl From<Image> for Resource {
    fn from(image: Image) -> Self {
        Self::Image(image)
    }
}

impl From<Buffer> for Resource {
    fn from(buffer: Buffer) -> Self {
        Self::Buffer(buffer)
    }
}

impl Resource {
    fn index(self) -> usize {
        match self {
            Self::Image(image) => image.index as usize,
            Self::Buffer(buffer) => buffer.index as usize,
        }
    }
}

/// The elements of a buffer, as the shaders must declare them.
#[derive(Debug, Clone, Copy)]
struct Element {
    name: &'static str,
    members: &'static [Member],
    bytes: usize,
}

#[derive(Debug, Clone)]
enum Source {
    /// From the pool, undefined when the frame begins.
    Transient,
    /// Filled by the host before the frame begins.
    Uploaded(Vec<u8>),
    /// A word from the pool, 0 when the frame begins and read back when it ends.
    Counted,
    /// From the pool, zeros when the frame begins.
    Zeroed,
    /// What the frame before left in it, or zeros.
    History,
    ImportedBuffer(BufferId),
    ImportedImage(ImageId),
    /// Outlives the frame, and passes may write it.
    KeptImage(ImageId),
}

#[derive(Debug, Clone)]
struct Slot {
    name: String,
    resource: Resource,
    element: Option<Element>,
    source: Source,
}

/// A frame being described. See the module's page.
#[derive(Debug, Default)]
pub struct Graph {
    slots: Vec<Slot>,
    passes: Vec<Pass>,
    read_backs: Vec<Resource>,
    warming_up: bool,
    /// Appended to the names of what is described, and how many descriptions that is inside of; see [`Self::again`].
    suffix: String,
    depth: u32,
}

/// A resource that the host gets after the frame; see [`FrameOutcome::bytes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadBack(usize);

impl Graph {
    pub fn new() -> Self {
        Self::default()
    }

    /// A frame to warm up with: scenes draw a triangle of every kind that no view sees, so that no later frame of a path has to make
    /// a pipeline, or is the first to use one, which is when some drivers compile it.
    pub fn warming_up() -> Self {
        Self { warming_up: true, ..Self::default() }
    }

    /// Whether the frame is one to warm up with.
    pub fn is_warming_up(&self) -> bool {
        self.warming_up
    }

    /// Describes for the `time`th time what a frame has several times: from the second time on, all passes and resources are named
    /// with `#` and the time behind, and so keep apart; what is described several times within that, with `-`.
    pub fn again<R>(&mut self, time: u32, describe: impl FnOnce(&mut Self) -> R) -> R {
        let outer = self.suffix.len();
        if time > 1 {
            self.suffix += &format!("{}{time}", if self.depth == 0 { '#' } else { '-' });
        }
        self.depth += 1;
        let described = describe(self);
        self.depth -= 1;
        self.suffix.truncate(outer);
        described
    }

    fn add(&mut self, name: &str, resource: Resource, element: Option<Element>, source: Source) {
        self.slots.push(Slot { name: format!("{name}{}", self.suffix), resource, element, source });
    }

    /// An image that some pass writes before others read it.
    pub fn image(&mut self, name: &str, format: Format, size: [u32; 2]) -> Image {
        self.layered_image(name, format, size, 1)
    }

    /// An image of several layers.
    pub fn layered_image(&mut self, name: &str, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::Transient);
        image
    }

    /// A buffer of `count` structs that some pass writes before others read it.
    pub fn buffer<T: ShaderStruct>(&mut self, name: &str, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Transient);
        buffer
    }

    /// A buffer that holds `elements` when the frame begins.
    pub fn upload<T: ShaderStruct>(&mut self, name: &str, elements: &[T]) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count: elements.len() as u32 };
        let bytes = bytemuck::cast_slice(elements).to_vec();
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Uploaded(bytes));
        buffer
    }

    /// A number that is 0 when the frame begins and that passes add to, whole numbers by atomics, so that their order changes
    /// nothing; a shader's block has it as its one `uint`, and the pass [`updates`](ComputePass::updates) it. It comes back in
    /// [`FrameOutcome::counts`].
    pub fn count(&mut self, name: &str) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count: 1 };
        self.add(name, buffer.into(), Some(Element::of::<u32>()), Source::Counted);
        buffer
    }

    /// A buffer of `count` structs, all zeros when the frame begins, that passes add to.
    pub fn zeroed<T: ShaderStruct>(&mut self, name: &str, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Zeroed);
        buffer
    }

    /// A buffer of `count` structs that holds what the frame before left in it, which had one of this name and size; zeros in the
    /// first frame, and after [`Pool::cut`].
    pub fn history<T: ShaderStruct>(&mut self, name: &str, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::History);
        buffer
    }

    /// A buffer that outlives the frame; passes may only read it.
    pub fn import_buffer<T: ShaderStruct>(&mut self, name: &str, id: BufferId, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::ImportedBuffer(id));
        buffer
    }

    /// An image that outlives the frame; passes may only read it.
    pub fn import_image(&mut self, name: &str, id: ImageId, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::ImportedImage(id));
        image
    }

    /// An image that outlives the frame, and that passes add to: it holds what the frame before left in it.
    pub fn keep_image(&mut self, name: &str, id: ImageId, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::KeptImage(id));
        image
    }

    /// Brings a resource back to the host once the frame is done.
    pub fn read_back(&mut self, resource: impl Into<Resource>) -> ReadBack {
        self.read_backs.push(resource.into());
        ReadBack(self.read_backs.len() - 1)
    }

    /// Begins a compute pass. Its name is its label, its row of timings, and its shader: `glsl/<name>.comp`.
    pub fn compute(&mut self, name: &'static str) -> ComputePass<'_> {
        ComputePass::new(self, name)
    }

    /// Begins a raster pass over the whole of its attachments. Its shaders are `glsl/<name>.vert` and `glsl/<name>.frag`.
    pub fn raster(&mut self, name: &'static str) -> RasterPass<'_> {
        RasterPass::new(self, name)
    }

    /// The passes' names, in order.
    pub fn pass_names(&self) -> impl Iterator<Item = &'static str> {
        self.passes.iter().map(|pass| pass.name)
    }

    fn is_count(&self, resource: Resource) -> bool {
        matches!(self.slots[resource.index()].source, Source::Counted)
    }

    fn name(&self, resource: Resource) -> &str {
        &self.slots[resource.index()].name
    }
}

/// What passes counted under a name, in all descriptions of it ([`Graph::again`]).
pub fn counted<'c>(counts: &'c [(String, u64)], name: &'c str) -> impl Iterator<Item = u64> + 'c {
    let is_of = move |of: &str| of.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['#', '-']));
    counts.iter().filter(move |(of, _)| is_of(of)).map(|(_, count)| *count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_described_again_has_names_of_its_own_at_every_depth() {
        let mut g = Graph::new();
        for bounce in 1..=2 {
            g.again(bounce, |g| {
                for layer in 1..=2 {
                    g.again(layer, |g| {
                        g.count("lit");
                        g.compute("draw").dispatch([1, 1, 1]);
                    });
                }
            });
        }
        assert_eq!(g.pass_names().collect::<Vec<_>>(), ["draw", "draw-2", "draw#2", "draw#2-2"]);
        assert_eq!(g.memory().iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["lit", "lit-2", "lit#2", "lit#2-2"]);
    }
}
