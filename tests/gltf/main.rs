//! The glTF loader: real scenes, every feature by a small file made here, and files that lie.

mod scenes;
