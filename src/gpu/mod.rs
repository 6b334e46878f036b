//! Vulkan, and all that is unsafe about it. What leaves this module is plain: ids, formats, sizes, bytes.
//!
//! - [`adapter`]: which devices there are, and what each can and lacks
//! - [`Gpu`]: a device in use: memory, pipelines, submission; it owns every object, and ids name them
//! - [`Commands`]: recording; a pass is bind, push, dispatch or draw, with barriers and labels around it
//! - [`Shader`]: a compiled shader and what reflection says of it
//! - [`fault`]: errors injected for tests, since the software driver never refuses anything
//!
//! Images stay in the layout GENERAL from their first moment. Descriptors are push descriptors in set 0.
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
mod types;
mod upload;
mod vertex;

pub use adapter::{Adapter, DeviceChoice, Feature};
pub use commands::{Attachment, Commands, Load};
pub use device::{Gpu, Options};
pub use format::Format;
pub use memory::{BufferId, ImageDesc, ImageId};
pub use pipeline::{PipelineId, RasterState};
pub use shader::{Binding, BindingKind, Block, BlockMember, Input, Shader, ShaderAccess, ShaderStage};
pub use types::{Accesses, Barrier, Bound, Sampler, Stages, Wrapping};
pub use vertex::{VertexAttribute, VertexFormat, VertexLayout};
