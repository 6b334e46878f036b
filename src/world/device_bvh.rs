//! A scene's bounding volume hierarchy on the device: images of four words a texel, and the grid that its boxes are quantized to.

use super::bvh::{Bvh, MOST_TRIANGLES, STACK};
use super::word_image::WordImage;
use crate::fail;
use crate::gpu::Gpu;
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
