//! Tests of the glTF loader: real scenes, a small file for every feature, and hostile files.

mod animations;
mod bends;
mod geometry;
mod hostile;
mod hostile_bends;
mod hostile_keys;
mod make;
mod materials;
mod places;
mod scenes;
