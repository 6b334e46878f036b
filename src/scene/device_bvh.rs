//! A scene's bounding volume hierarchy on the device: images of four words a texel, and the grid that its boxes lie on.

use super::bvh::{Bvh, MOST_TRIANGLES};
use crate::fail;
use crate::gpu::{Format, Gpu, ImageId};
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;
use anyhow::Result;

shader_struct! {
    /// The grid of the boxes: `glsl/bvh/traverse.glsl`.
    pub struct BvhData {
        pub origin: [f32; 3],
        pub padding0: f32,
        pub cell: [f32; 3],
        pub padding1: f32,
    }
}

/// Texels of a row; a power of two, so that the shader divides by shifting. Every device has images so wide.
const COLUMNS: usize = 4096;

/// See the module's page. The device owns the images.
#[derive(Debug)]
pub struct DeviceBvh {
    data: BvhData,
    nodes: (ImageId, [u32; 2]),
    triangles: (ImageId, [u32; 2]),
    masks: (ImageId, [u32; 2]),
}

/// The hierarchy in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct BvhHandles {
    /// Uniform block `bvh`.
    pub data: Buffer,
    pub nodes: Image,
    pub triangles: Image,
    pub masks: Image,
}

impl DeviceBvh {
    /// Brings a hierarchy to the device; `name` is the scene's, for the error of one that does not fit.
    pub fn upload(gpu: &mut Gpu, name: &str, bvh: &Bvh) -> Result<Self> {
        let data = BvhData { origin: bvh.origin.into(), padding0: 0.0, cell: bvh.cell.into(), padding1: 0.0 };
        let nodes = upload(gpu, name, "scene/bvh-nodes", bytemuck::cast_slice(&bvh.nodes))?;
        let triangles = upload(gpu, name, "scene/bvh-triangles", bytemuck::cast_slice(&bvh.triangles))?;
        let masks = upload(gpu, name, "scene/bvh-masks", bytemuck::cast_slice(&bvh.masks))?;
        Ok(Self { data, nodes, triangles, masks })
    }

    /// The hierarchy as this frame's resources.
    pub fn import(&self, g: &mut Graph) -> BvhHandles {
        BvhHandles {
            data: g.upload("bvh", &[self.data]),
            nodes: g.import_image("scene/bvh-nodes", self.nodes.0, Format::Rgba32Uint, self.nodes.1, 1),
            triangles: g.import_image("scene/bvh-triangles", self.triangles.0, Format::Rgba32Uint, self.triangles.1, 1),
            masks: g.import_image("scene/bvh-masks", self.masks.0, Format::Rgba32Uint, self.masks.1, 1),
        }
    }
}

fn upload(gpu: &mut Gpu, scene: &str, name: &str, words: &[u32]) -> Result<(ImageId, [u32; 2])> {
    let rows = words.len().div_ceil(4 * COLUMNS).max(1);
    let limit = gpu.adapter.limits.image_size as usize;
    if rows > limit || (words.len() / 12) as u64 > MOST_TRIANGLES {
        return Err(fail!(
            BadInput,
            "{scene}: its bounding volume hierarchy takes {rows} rows of {name}, over the {limit} that {} allows; lower scene.triangles or take a smaller file",
            gpu.adapter.name
        ));
    }
    let mut padded = words.to_vec();
    padded.resize(rows * 4 * COLUMNS, 0);
    let size = [COLUMNS as u32, rows as u32];
    let id = gpu.create_filled_image(name, Format::Rgba32Uint, [size[0], size[1], 1], bytemuck::cast_slice(&padded), false)?;
    Ok((id, size))
}
