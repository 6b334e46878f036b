//! manylight: real-time many-light global illumination on raw Vulkan.
#![deny(unsafe_code)]

pub mod cache;
pub mod cli;
pub mod color;
pub mod commands;
pub mod config;
pub mod error;
pub mod export;
pub mod files;
pub mod frame;
pub mod gpu;
pub mod graph;
pub mod metrics;
pub mod output;
pub mod presets;
pub mod reference;
pub mod renderer;
pub mod report;
pub mod scene;
pub mod stages;
pub mod tables;
pub mod trace;
pub mod walk;
pub mod world;
