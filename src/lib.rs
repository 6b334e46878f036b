//! manylight: real-time many-light global illumination on raw Vulkan.
#![deny(unsafe_code)]

pub mod cli;
pub mod config;
pub mod error;
pub mod scene;
