//! The frame graph: a frame is a list of passes in the order in which they run, declared by the names that their shaders use.
//!
//! A [`Graph`] is plain data, built anew each frame without a device. [`Engine::execute`] then checks every declaration against the
//! shaders' reflection, takes resources from a pool, puts the barriers of [`plan`] between the passes, records, submits and times them.
//! Passes are not reordered or merged, and memory is not aliased, so every resource can be inspected after the frame.

mod check;
mod engine;
#[cfg(test)]
mod exact;
mod library;
mod memory;
mod parts;
mod pass;
mod pipelines;
pub mod plan;
mod pool;
mod record;
mod reuse;
mod rows;
mod shader_struct;

pub use engine::{Dump, DumpData, Engine, Execution, FrameOutcome, Timing};
pub use library::{Library, VARIABLE as SHADERS};
pub use parts::{Part, Variant};
pub use pass::{ComputePass, DrawList, Extent, ListBlock, RasterPass};
pub use pool::Pool;
pub use reuse::Reuse;
pub use rows::Rows;
pub use shader_struct::{Member, ShaderStruct};

use crate::gpu::{BufferId, Format, ImageId};
use pass::Pass;

/// Handle of an image of the frame, with its properties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Image {
    index: u32,
    pub format: Format,
    pub size: [u32; 2],
    pub layers: u32,
}

/// Handle of a buffer of the frame: an array of `count` elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Buffer {
    index: u32,
    pub count: u32,
}

/// An image or a buffer.
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

/// Element type of a buffer, as shaders must declare it.
#[derive(Debug, Clone, Copy)]
struct Element {
    name: &'static str,
    members: &'static [Member],
    bytes: usize,
}

#[derive(Debug, Clone)]
enum Source {
    /// From the pool; undefined when the frame begins.
    Transient,
    /// Filled by the host before the frame begins.
    Uploaded(Vec<u8>),
    /// A word from the pool; 0 when the frame begins, and read back when it ends.
    Counted,
    /// From the pool; zeros when the frame begins.
    Zeroed,
    /// Contents of the frame before, or zeros.
    History,
    ImportedBuffer(BufferId),
    ImportedImage(ImageId),
    /// Outlives the frame; passes may write it.
    KeptBuffer(BufferId),
    KeptImage(ImageId),
}

#[derive(Debug, Clone)]
struct Slot {
    name: String,
    resource: Resource,
    element: Option<Element>,
    source: Source,
}

/// A frame in description.
#[derive(Debug, Default)]
pub struct Graph {
    slots: Vec<Slot>,
    passes: Vec<Pass>,
    read_backs: Vec<Resource>,
    /// Numbers of [`Self::tell`].
    told: Vec<(String, u64)>,
    warming_up: bool,
    /// Suffix of names, and depth of nested descriptions; see [`Self::again`].
    suffix: String,
    depth: u32,
}

/// A resource that a pass writes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    pub name: String,
    pub is_image: bool,
}

/// A resource that is read back after the frame; see [`FrameOutcome::bytes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadBack(usize);

impl Graph {
    pub fn new() -> Self {
        Self::default()
    }

    /// A warm-up frame: scenes draw a triangle of every kind, also of those that no view sees. No later frame has to make a pipeline, or is
    /// the first to use one, at which some drivers compile it.
    pub fn warming_up() -> Self {
        Self { warming_up: true, ..Self::default() }
    }

    /// Whether this is a warm-up frame.
    pub fn is_warming_up(&self) -> bool {
        self.warming_up
    }

    /// Describes repetition `time` (from 1) of a part of the frame. From the second on, names of passes and resources get the suffix
    /// `#time`, and repetitions nested in another one `-time`, so that all names stay unique.
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

    /// An image that a pass writes before others read it.
    pub fn image(&mut self, name: &str, format: Format, size: [u32; 2]) -> Image {
        self.layered_image(name, format, size, 1)
    }

    /// An image of several layers.
    pub fn layered_image(&mut self, name: &str, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::Transient);
        image
    }

    /// A buffer of `count` structs that a pass writes before others read it.
    pub fn buffer<T: ShaderStruct>(&mut self, name: &str, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Transient);
        buffer
    }

    /// A buffer filled with `elements` when the frame begins.
    pub fn upload<T: ShaderStruct>(&mut self, name: &str, elements: &[T]) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count: elements.len() as u32 };
        let bytes = bytemuck::cast_slice(elements).to_vec();
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Uploaded(bytes));
        buffer
    }

    /// A counter: 0 when the frame begins, and returned in [`FrameOutcome::counts`]. Passes add to it by integer atomics, whose order does
    /// not matter. A shader's block has it as its one `uint`, and the pass [`updates`](ComputePass::updates) it.
    pub fn count(&mut self, name: &str) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count: 1 };
        self.add(name, buffer.into(), Some(Element::of::<u32>()), Source::Counted);
        buffer
    }

    /// A number that the host knows, returned among the counters.
    pub fn tell(&mut self, name: &str, number: u64) {
        self.told.push((format!("{name}{}", self.suffix), number));
    }

    /// Names of the numbers that the host told.
    pub fn told_names(&self) -> impl Iterator<Item = &str> {
        self.told.iter().map(|(name, _)| name.as_str())
    }

    /// A buffer of `count` structs, zeroed when the frame begins.
    pub fn zeroed<T: ShaderStruct>(&mut self, name: &str, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::Zeroed);
        buffer
    }

    /// A buffer of `count` structs with the contents that the frame before left in the buffer of this name and size. It is zeroed in the
    /// first frame, after [`Pool::cut`], and after a frame without it.
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

    /// A buffer that outlives the frame and that passes may write; it holds the contents of the frame before.
    pub fn keep_buffer<T: ShaderStruct>(&mut self, name: &str, id: BufferId, count: u32) -> Buffer {
        let buffer = Buffer { index: self.slots.len() as u32, count };
        self.add(name, buffer.into(), Some(Element::of::<T>()), Source::KeptBuffer(id));
        buffer
    }

    /// An image that outlives the frame; passes may only read it.
    pub fn import_image(&mut self, name: &str, id: ImageId, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::ImportedImage(id));
        image
    }

    /// An image that outlives the frame and that passes may write; it holds the contents of the frame before.
    pub fn keep_image(&mut self, name: &str, id: ImageId, format: Format, size: [u32; 2], layers: u32) -> Image {
        let image = Image { index: self.slots.len() as u32, format, size, layers };
        self.add(name, image.into(), None, Source::KeptImage(id));
        image
    }

    /// Reads a resource back to the host after the frame.
    pub fn read_back(&mut self, resource: impl Into<Resource>) -> ReadBack {
        self.read_backs.push(resource.into());
        ReadBack(self.read_backs.len() - 1)
    }

    /// Begins a compute pass. Its name is its label, its row of timings, and its shader: `glsl/<name>.comp`.
    pub fn compute(&mut self, name: &'static str) -> ComputePass<'_> {
        ComputePass::new(self, name)
    }

    /// Begins a raster pass over all of its attachments. Its shaders are `glsl/<name>.vert` and `glsl/<name>.frag`.
    pub fn raster(&mut self, name: &'static str) -> RasterPass<'_> {
        RasterPass::new(self, name)
    }

    /// Names of the passes, in order.
    pub fn pass_names(&self) -> impl Iterator<Item = &'static str> {
        self.passes.iter().map(|pass| pass.name)
    }

    /// Images and buffers that each pass writes.
    pub fn outputs(&self) -> Vec<(&'static str, Vec<Output>)> {
        let output = |resource| Output { name: self.name(resource).to_owned(), is_image: matches!(resource, Resource::Image(_)) };
        let written = |pass: &Pass| pass.written().into_iter().map(output).collect();
        self.passes.iter().map(|pass| (pass.name, written(pass))).collect()
    }

    fn is_count(&self, resource: Resource) -> bool {
        matches!(self.slots[resource.index()].source, Source::Counted)
    }

    fn name(&self, resource: Resource) -> &str {
        &self.slots[resource.index()].name
    }
}

/// Values of a counter in all its repetitions ([`Graph::again`]).
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
