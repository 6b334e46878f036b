//! A scene's bounding volume hierarchy on the device: images of four words a texel, and the grid that its boxes are quantized to.

use super::bvh::{Bvh, MOST_TRIANGLES, STACK};
use crate::fail;
use crate::gpu::{Format, Gpu, ImageId};
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;
use anyhow::Result;

shader_struct! {
    /// Grid of the boxes: `glsl/bvh/traverse.glsl`.
    pub struct BvhData {
        pub origin: [f32; 3],
        pub padding0: f32,
        pub cell: [f32; 3],
        pub padding1: f32,
    }
}

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

/// A hierarchy on the device, which owns the images.
#[derive(Debug)]
pub struct DeviceBvh {
    data: BvhData,
    nodes: WordImage,
    triangles: WordImage,
    masks: WordImage,
    corners: WordImage,
    colors: WordImage,
}

/// The hierarchy in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct BvhHandles {
    /// Uniform block `bvh`.
    pub data: Buffer,
    pub nodes: Image,
    pub triangles: Image,
    pub masks: Image,
    pub corners: Image,
    pub colors: Image,
}

impl DeviceBvh {
    /// Uploads a hierarchy, one array at a time, so that no more than one is in memory twice. `scene` is the scene's name, for errors.
    pub fn upload(gpu: &mut Gpu, scene: &str, mut bvh: Bvh) -> Result<Self> {
        if bvh.triangles.len() as u64 > MOST_TRIANGLES {
            return Err(fail!(
                BadInput,
                "{scene}: {} triangles are over the {MOST_TRIANGLES} that rays can tell apart",
                bvh.triangles.len()
            ));
        }
        if bvh.depth > STACK {
            return Err(fail!(
                BadInput,
                "{scene}: its bounding volume hierarchy is {} levels deep, over the {STACK} that rays can keep track of; its triangles' sizes differ too much",
                bvh.depth
            ));
        }
        let data = BvhData { origin: bvh.origin.into(), padding0: 0.0, cell: bvh.cell.into(), padding1: 0.0 };
        let nodes = WordImage::upload(gpu, scene, "scene/bvh-nodes", std::mem::take(&mut bvh.nodes).as_flattened())?;
        let triangles = WordImage::upload(gpu, scene, "scene/bvh-triangles", std::mem::take(&mut bvh.triangles).as_flattened())?;
        let masks = WordImage::upload(gpu, scene, "scene/bvh-masks", std::mem::take(&mut bvh.masks).as_flattened())?;
        let corners = WordImage::upload(gpu, scene, "scene/bvh-corners", std::mem::take(&mut bvh.corners).as_flattened())?;
        let colors = WordImage::upload(gpu, scene, "scene/bvh-colors", bvh.colors.as_flattened())?;
        Ok(Self { data, nodes, triangles, masks, corners, colors })
    }

    /// Frees its images.
    pub fn free(&self, gpu: &mut Gpu) {
        [self.nodes, self.triangles, self.masks, self.corners, self.colors].iter().for_each(|image| image.free(gpu));
    }

    /// Imports the hierarchy into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> BvhHandles {
        BvhHandles {
            data: g.upload("scene/bvh", &[self.data]),
            nodes: self.nodes.import(g),
            triangles: self.triangles.import(g),
            masks: self.masks.import(g),
            corners: self.corners.import(g),
            colors: self.colors.import(g),
        }
    }
}
