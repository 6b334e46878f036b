//! The glTF loader: real scenes, every feature by a small file made here, and files that lie.

mod animations;
mod geometry;
mod hostile;
mod hostile_keys;
mod make;
mod materials;
mod places;
mod scenes;
