//! Plain values shared by the graph and the recorder.

use super::memory::{BufferId, ImageId};
use ash::vk;

bitflags::bitflags! {
    /// Pipeline stages, as coarse as this engine's hazards.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub struct Stages: u32 {
        /// Indirect draw arguments.
        const INDIRECT = 1;
        /// Vertex, tessellation and geometry shaders.
        const PRE_RASTER = 2;
        const FRAGMENT = 4;
        /// Colour and depth attachments.
        const ATTACHMENT = 8;
        const COMPUTE = 16;
        const TRANSFER = 32;
        /// Vertices and indices of draws.
        const VERTEX_INPUT = 64;
    }
}

bitflags::bitflags! {
    /// Kinds of memory access.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub struct Accesses: u32 {
        const INDIRECT_READ = 1;
        const SHADER_READ = 2;
        const SHADER_WRITE = 4;
        const ATTACHMENT_READ = 8;
        const ATTACHMENT_WRITE = 16;
        const TRANSFER_READ = 32;
        const TRANSFER_WRITE = 64;
        /// Vertices and indices.
        const VERTEX_READ = 128;
    }
}

impl Accesses {
    /// All writing accesses.
    pub const WRITES: Self = Self::SHADER_WRITE.union(Self::ATTACHMENT_WRITE).union(Self::TRANSFER_WRITE);
}

/// One global memory barrier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Barrier {
    pub from: Stages,
    /// Writes to make available; empty for an execution dependency alone.
    pub written: Accesses,
    pub to: Stages,
    /// Accesses to make the writes visible to.
    pub needed: Accesses,
}

impl Barrier {
    /// Full barrier: everything before has completed and is visible to everything after.
    pub const FULL: Self = Self { from: Stages::all(), written: Accesses::WRITES, to: Stages::all(), needed: Accesses::all() };
}

/// Addressing of a texture outside of [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrapping {
    Repeat,
    MirroredRepeat,
    ClampToEdge,
}

/// Sampler state; samplers are created once and kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sampler {
    /// Nearest texel, clamped to edges.
    Nearest,
    /// Bilinear, clamped to edges.
    Linear,
    /// A material's texture: trilinear or nearest, with its own wrapping.
    Material { u: Wrapping, v: Wrapping, linear: bool },
}

/// Resource bound to a shader's binding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    UniformBuffer(BufferId),
    /// A range of a buffer; the offset is a multiple of 256, which every device accepts.
    UniformRange {
        buffer: BufferId,
        offset: u64,
        bytes: u64,
    },
    StorageBuffer(BufferId),
    /// All mips; all layers if `array`, else the first.
    SampledImage {
        image: ImageId,
        array: bool,
        sampler: Sampler,
    },
    /// Mip 0; all layers if `array`, else the first.
    StorageImage {
        image: ImageId,
        array: bool,
    },
}

pub(super) fn stages(stages: Stages) -> vk::PipelineStageFlags2 {
    use vk::PipelineStageFlags2 as Vk;
    let table = [
        (Stages::INDIRECT, Vk::DRAW_INDIRECT),
        (Stages::PRE_RASTER, Vk::PRE_RASTERIZATION_SHADERS),
        (Stages::FRAGMENT, Vk::FRAGMENT_SHADER),
        (Stages::ATTACHMENT, Vk::COLOR_ATTACHMENT_OUTPUT | Vk::EARLY_FRAGMENT_TESTS | Vk::LATE_FRAGMENT_TESTS),
        (Stages::COMPUTE, Vk::COMPUTE_SHADER),
        (Stages::TRANSFER, Vk::ALL_TRANSFER),
        (Stages::VERTEX_INPUT, Vk::VERTEX_INPUT),
    ];
    table.into_iter().filter(|(ours, _)| stages.contains(*ours)).fold(Vk::NONE, |all, (_, theirs)| all | theirs)
}

pub(super) fn accesses(accesses: Accesses) -> vk::AccessFlags2 {
    use vk::AccessFlags2 as Vk;
    let table = [
        (Accesses::INDIRECT_READ, Vk::INDIRECT_COMMAND_READ),
        (Accesses::SHADER_READ, Vk::SHADER_READ | Vk::UNIFORM_READ),
        (Accesses::SHADER_WRITE, Vk::SHADER_WRITE),
        (Accesses::ATTACHMENT_READ, Vk::COLOR_ATTACHMENT_READ | Vk::DEPTH_STENCIL_ATTACHMENT_READ),
        (Accesses::ATTACHMENT_WRITE, Vk::COLOR_ATTACHMENT_WRITE | Vk::DEPTH_STENCIL_ATTACHMENT_WRITE),
        (Accesses::TRANSFER_READ, Vk::TRANSFER_READ),
        (Accesses::TRANSFER_WRITE, Vk::TRANSFER_WRITE),
        (Accesses::VERTEX_READ, Vk::VERTEX_ATTRIBUTE_READ | Vk::INDEX_READ),
    ];
    table.into_iter().filter(|(ours, _)| accesses.contains(*ours)).fold(Vk::NONE, |all, (_, theirs)| all | theirs)
}
