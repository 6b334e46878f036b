//! Images of words: what shaders read in fours, and what may be larger than a storage buffer.

use crate::fail;
use crate::gpu::{Format, Gpu, ImageId};
use crate::graph::{Graph, Image};
use anyhow::Result;

/// Texels of a row: a power of two, so that the shader divides by shifting. Every device supports images of this width.
const COLUMNS: usize = 4096;

/// An image of words, four a texel, in rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct WordImage {
    name: &'static str,
    id: ImageId,
    size: [u32; 2],
}

impl WordImage {
    /// Uploads words; `scene` is the scene's name, for errors.
    pub fn upload(gpu: &mut Gpu, scene: &str, name: &'static str, words: &[u32]) -> Result<Self> {
        let rows = words.len().div_ceil(4 * COLUMNS).max(1);
        let limit = gpu.adapter.limits.image_size as usize;
        if rows > limit {
            return Err(fail!(
                BadInput,
                "{scene}: {name} takes {rows} rows, over the {limit} that {} allows; lower scene.triangles or take a smaller file",
                gpu.adapter.name
            ));
        }
        let size = [COLUMNS as u32, rows as u32];
        let id = gpu.create_filled_image(name, Format::Rgba32Uint, [size[0], size[1], 1], bytemuck::cast_slice(words), true)?;
        Ok(Self { name, id, size })
    }

    pub fn free(&self, gpu: &mut Gpu) {
        gpu.free_image(self.id);
    }

    pub fn import(&self, g: &mut Graph) -> Image {
        g.import_image(self.name, self.id, Format::Rgba32Uint, self.size, 1)
    }
}
