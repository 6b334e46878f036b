//! Buffers and images that are filled at creation.

use super::device::Gpu;
use super::format::Format;
use super::memory::{BufferId, ImageDesc, ImageId};
use anyhow::{Context, Result};

impl Gpu {
    /// Creates a device buffer with `contents`.
    pub fn create_filled_buffer(&mut self, name: &str, contents: &[u8]) -> Result<BufferId> {
        /// Bytes staged at a time, so that a large scene is not in memory twice.
        const CHUNK: usize = 32 << 20;
        let id = self.create_buffer(name, contents.len() as u64)?;
        if contents.is_empty() {
            return Ok(id);
        }
        let staging = self.create_upload_buffer("staging", &contents[..contents.len().min(CHUNK)])?;
        for (i, chunk) in contents.chunks(CHUNK).enumerate() {
            self.write_upload_buffer(staging, chunk);
            let offset = (i * CHUNK) as u64;
            self.submit(name, |commands| commands.copy_buffer(staging, 0, id, offset, chunk.len() as u64))?;
        }
        self.free_buffer(staging);
        Ok(id)
    }

    /// Creates an image without mips, filled with `texels` row by row, layer by layer; the rest is undefined. Shaders may store to it if
    /// `storage`.
    pub fn create_filled_image(&mut self, name: &str, format: Format, size: [u32; 3], texels: &[u8], storage: bool) -> Result<ImageId> {
        /// Bytes staged at a time, as in [`Self::create_filled_buffer`].
        const CHUNK: usize = 32 << 20;
        let [width, height, layers] = size;
        let row = width as usize * format.texel_bytes();
        assert!(texels.len() <= row * height as usize * layers as usize, "{name}: more texels than {width}x{height}x{layers} hold");
        let desc = ImageDesc { format, width, height, layers, mips: 1, attachment: false, storage };
        let id = self.create_images(&[(name, desc)])?[0];
        let rows = (CHUNK / row).clamp(1, height as usize);
        let staging = self.create_upload_buffer("staging", &vec![0; rows * row])?;
        for (layer, texels) in texels.chunks(row * height as usize).enumerate() {
            for (i, chunk) in texels.chunks(rows * row).enumerate() {
                self.write_upload_buffer(staging, chunk);
                let (first, count) = ((i * rows) as u32, chunk.len().div_ceil(row) as u32);
                self.submit(name, |commands| commands.copy_buffer_to_image_rows(staging, id, layer as u32, first, count))?;
            }
        }
        self.free_buffer(staging);
        Ok(id)
    }

    /// Creates a sampled image array with all mips: one RGBA8 image a layer, all of the same size, its mips packed behind it, the largest
    /// first.
    pub fn create_texture_array(
        &mut self,
        name: &str,
        format: Format,
        size: [u32; 2],
        layers: impl ExactSizeIterator<Item = Vec<u8>>,
    ) -> Result<ImageId> {
        let [width, height] = size;
        let mips = width.max(height).ilog2() + 1;
        let desc = ImageDesc { format, width, height, layers: layers.len() as u32, mips, attachment: false, storage: false };
        let id = self.create_images(&[(name, desc)]).with_context(|| format!("{} textures of {width}x{height}", layers.len()))?[0];
        let mut staging = None;
        for (layer, texels) in layers.enumerate() {
            let staging = match staging {
                Some(staging) => {
                    self.write_upload_buffer(staging, &texels);
                    staging
                }
                None => *staging.insert(self.create_upload_buffer("staging", &texels)?),
            };
            self.submit(name, |commands| commands.copy_buffer_to_mips(staging, id, layer as u32))?;
        }
        if let Some(staging) = staging {
            self.free_buffer(staging);
        }
        Ok(id)
    }
}
