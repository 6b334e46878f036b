//! Tests of the program and the library from the outside: commands, configs, exports, the README.

mod animated;
mod bench;
mod cli;
mod commands;
mod compare;
mod config;
mod export;
#[path = "../gltf/make.rs"]
#[allow(dead_code)] // The loader's tests use the rest.
mod make;
mod place;
mod readme;
mod reference;
mod report;
mod reproduce;
mod schema;
mod walks;
mod window;
