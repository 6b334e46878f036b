//! manylight: real-time many-light global illumination on raw Vulkan.
//!
//! The spine runs one way: `commands -> renderer -> frame -> stages -> world -> graph -> gpu`.
//!
//! - [`config`] reads a TOML file into typed data. Every key is declared once, in the file of its slot.
//! - [`scene`] is what is rendered, as plain data of the host: glTF files and scenes made by code. [`world`] is that scene on a device, moved by its
//!   animation, and seen from where a [`Shot`](world::Shot) shows it.
//! - [`frame`] is the pipeline, one slot a line. [`stages`] are the slots; `src/stages/README.md` says how to add a method.
//! - [`renderer`] runs frames of a config, in [`Lane`](renderer::Lane)s that keep what goes on from frame to frame.
//! - [`graph`] is the frame graph: passes declared by the binding names of their shaders, barriers, pooled resources, timing. [`gpu`] holds every Vulkan
//!   call and all unsafe code.
//! - [`reference`] traces paths on the same scene for the truth. [`metrics`] say how far a picture is from it. [`walk`] renders frames in sequence and
//!   measures their flicker.
//! - [`tables`] are sweeps: read, planned, and measured from the folders of their runs. [`presets`] are the configs and tables in the binary.
//! - [`output`] and [`files`] write pictures and records, whole or not at all. [`report`] makes statistics, tables of text and the HTML page.
//!   [`export`] writes scenes for other renderers.
//! - [`cli`] parses the command line, [`commands`] has a file for each command. [`cache`] is the user's cache folder, [`trace`] records what ran when,
//!   [`error`] has the exit codes.
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
