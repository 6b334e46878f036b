//! Images: a frame's picture, OpenEXR and PNG files.
//!
//! Every file appears whole or not at all ([`crate::files`]). The same content gives the same bytes.

pub mod exr;
pub mod picture;
pub mod png;

pub use self::exr::{Exr, ExrLayer, Samples, read_exr, write_exr};
pub use self::picture::{Picture, Plane};
pub use self::png::{Png, png_bytes, read_png, write_png};

use std::path::{Path, PathBuf};

/// Folder of a sequence's frames, in the run's folder.
pub const FRAMES: &str = "frames";

/// File of a frame in the folder of its sequence: `0007.exr`.
pub fn frame_file(folder: &Path, frame: u32, ending: &str) -> PathBuf {
    folder.join(format!("{frame:04}.{ending}"))
}
