//! Alpha masks on the device, for what looks masked surfaces up at points: `glsl/visibility/masks.glsl`. The alpha of all masked
//! materials' base colour maps is in one image, a byte a texel, since a pass over points of all materials cannot bind a texture for each.

use super::traced::texel_map;
use crate::fail;
use crate::gpu::{BufferId, Format, Gpu, ImageId};
use crate::graph::{Buffer, Graph, Image};
use crate::scene::{Map, Material, Scene};
use crate::shader_struct;
use anyhow::Result;

shader_struct! {
    /// Mask of a material: `glsl/visibility/masks.glsl`.
    pub struct PointMask {
        pub matrix: [f32; 4],
        pub offset: [f32; 2],
        pub alpha: f32,
        /// 0 where a material has no mask.
        pub cutoff: f32,
        /// Location of the map's texels: [`texel_map`].
        pub first: u32,
        pub size: u32,
        pub how: u32,
    }
}

/// Width of the image of all texels and, if it has several layers, its height; the shader divides by it.
const SIDE: usize = 4096;

/// Masks of all materials. The device owns the buffers and the image.
pub struct Masks {
    materials: (BufferId, u32),
    corners: (BufferId, u32),
    texels: (ImageId, [u32; 3]),
}

/// The masks in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct FrameMasks {
    /// [`PointMask`] of each material.
    pub materials: Buffer,
    /// Texture coordinates and alpha of each vertex.
    pub corners: Buffer,
    /// Alpha of the maps, one after the other, row by row.
    pub texels: Image,
}

impl Masks {
    /// Uploads the masks of a scene, whose textures are there; `None` if no material has one.
    ///
    /// # Errors
    /// `BadInput` if the maps have more texels than the device's images hold.
    pub fn upload(gpu: &mut Gpu, scene: &Scene) -> Result<Option<Self>> {
        let is_masked = |material: &&Material| material.alpha_cutoff.is_some();
        if !scene.materials.iter().any(|material| is_masked(&material)) {
            return Ok(None);
        }
        let mut used: Vec<u32> = scene.materials.iter().filter(is_masked).filter_map(|m| Some(m.base_color_map?.texture)).collect();
        used.sort_unstable();
        used.dedup();
        let mut first = vec![0; scene.textures.len()];
        let mut texels: Vec<u8> = Vec::new();
        for texture in used {
            first[texture as usize] = texels.len() as u32;
            texels.extend(scene.textures[texture as usize].texels.chunks_exact(4).map(|texel| texel[3]));
        }
        let rows = texels.len().div_ceil(SIDE).max(1);
        let layers = rows.div_ceil(SIDE);
        if layers > (gpu.adapter.limits.image_layers as usize).min(256) {
            return Err(fail!(
                BadInput,
                "{}: the {} million texels of its alpha masks are more than {} takes; scale the textures down",
                scene.name,
                texels.len() / 1_000_000,
                gpu.adapter.name
            ));
        }
        let size = [SIDE as u32, rows.min(SIDE) as u32, layers as u32];
        let materials: Vec<PointMask> = scene.materials.iter().map(|material| mask(material, scene, &first)).collect();
        let corners: Vec<[f32; 3]> =
            scene.vertices.iter().map(|vertex| [vertex.uv[0], vertex.uv[1], (vertex.color >> 24) as f32 / 255.0]).collect();
        Ok(Some(Self {
            materials: (gpu.create_filled_buffer("scene/masks", bytemuck::cast_slice(&materials))?, materials.len() as u32),
            corners: (gpu.create_filled_buffer("scene/mask-corners", bytemuck::cast_slice(&corners))?, corners.len() as u32),
            texels: (gpu.create_filled_image("scene/mask-texels", Format::R8Unorm, size, &texels, false)?, size),
        }))
    }

    /// Imports the masks into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameMasks {
        let (texels, [width, height, layers]) = self.texels;
        FrameMasks {
            materials: g.import_buffer::<PointMask>("scene/masks", self.materials.0, self.materials.1),
            corners: g.import_buffer::<[f32; 3]>("scene/mask-corners", self.corners.0, self.corners.1),
            texels: g.import_image("scene/mask-texels", texels, Format::R8Unorm, [width, height], layers),
        }
    }
}

fn mask(material: &Material, scene: &Scene, first: &[u32]) -> PointMask {
    let Some(cutoff) = material.alpha_cutoff else { return bytemuck::Zeroable::zeroed() };
    let place = material.base_color_map.unwrap_or_else(|| Map::new(0));
    let [first, size, how] = texel_map(material.base_color_map, scene, first);
    PointMask {
        matrix: place.matrix.to_cols_array(),
        offset: place.offset.to_array(),
        alpha: material.base_color[3],
        cutoff,
        first,
        size,
        how,
    }
}
