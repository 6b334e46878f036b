//! Vulkan, and all unsafe code. The interface of this module is plain values: ids, formats, sizes, bytes.
//!
//! - [`adapter`]: devices, their features and limits
//! - [`Gpu`]: an open device with memory, pipelines and submission; it owns every object, and ids name them
//! - [`Commands`]: recording; a pass is bind, push, dispatch or draw, with barriers and labels around it
//! - [`Shader`]: a compiled shader and its reflection
//! - [`surface`]: a window that pictures are shown in
//! - [`fault`]: errors injected for tests, since the software driver never fails
//!
//! Images are in the layout GENERAL from creation on. Descriptors are push descriptors in set 0.
#![allow(unsafe_code)]

pub mod adapter;
mod commands;
mod device;
pub mod fault;
mod format;
mod memory;
mod pipeline;
mod shader;
mod slots;
pub mod surface;
mod types;
mod upload;
mod vertex;

pub use adapter::{Adapter, DeviceChoice, Feature};
pub use commands::{Attachment, Commands, Load};
pub use device::{Gpu, Options};
pub use format::Format;
pub use memory::{BufferId, ImageDesc, ImageId};
pub use pipeline::{Blend, PipelineId, RasterState};
pub use shader::{Binding, BindingKind, Block, BlockMember, Input, Shader, ShaderAccess, ShaderStage};
pub use surface::Presented;
pub use types::{Accesses, Barrier, Bound, Sampler, Stages, Wrapping};
pub use vertex::{VertexAttribute, VertexFormat, VertexLayout};
