//! manylight: real-time many-light global illumination on raw Vulkan.
#![deny(unsafe_code)]

pub mod error;
pub mod gpu;
pub mod scene;
