//! manylight: real-time many-light global illumination on raw Vulkan.
//!
//! The spine runs one way: `commands -> renderer -> frame -> stages -> world -> graph -> gpu`.
//!
//! - [`config`] reads a TOML file into typed data. Every key is declared once, in the file of its slot.
//! - [`scene`] holds scenes as plain data of the host, from glTF files and from code. [`world`] is a scene on a device: moved by its
//!   animation, and seen through the camera of a [`Shot`](world::Shot).
//! - [`frame`] is the pipeline, one slot a line. [`stages`] are the slots; `src/stages/README.md` says how to add a method.
//! - [`renderer`] runs a config's frames in [`Lane`](renderer::Lane)s, which keep state from frame to frame.
//! - [`graph`] is the frame graph: passes declared by the binding names of their shaders, barriers, pooled resources, timing. [`gpu`]
//!   holds every Vulkan call and all unsafe code.
//! - [`reference`] path traces the same scene for ground truth. [`metrics`] measure a picture's error against it. [`walk`] renders
//!   frames in sequence and measures their flicker.
//! - [`tables`] are sweeps: read, planned, and measured from the folders of their runs. [`presets`] are the configs and tables in
//!   the binary.
//! - [`output`] and [`files`] write pictures and records, whole or not at all. [`report`] makes statistics, tables of text and the
//!   HTML page. [`export`] writes scenes for other renderers.
//! - [`window`] shows frames and takes requests, while the command that opened it renders them. [`inspection`] answers questions about a
//!   frame: why a pixel is lit, and where the VPLs are.
//! - [`cli`] parses the command line, [`commands`] has a file for each command. [`cache`] is the user's cache folder, [`trace`]
//!   records timelines, [`error`] has the exit codes.
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
pub mod inspection;
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
pub mod window;
pub mod world;
