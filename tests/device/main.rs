//! Tests of the engine on the software driver, with the validation layer and its synchronization validation on.

mod animation;
mod bends;
mod bounce;
mod bvh;
mod chains;
mod common;
mod culling;
mod direct;
mod double_projection;
mod explain;
mod files;
mod filter;
mod flicker;
mod frames;
mod functions;
mod graph;
mod growth;
mod importance;
mod indirect;
mod ism;
mod lanes;
mod light_caches;
#[path = "../gltf/make.rs"]
#[allow(dead_code)] // The loader's tests use the rest.
mod make;
mod masks;
mod memory;
mod mixes;
mod points;
mod population;
mod pull_push;
mod reference;
mod repeat;
mod sampling;
mod sky;
mod ssao;
mod stochastic;
mod stored;
mod subgroups;
mod vertices;
mod vpls;
