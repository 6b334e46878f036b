//! A scene on the device: one vertex and one index buffer, draws and materials in storage buffers, textures in arrays.
//!
//! Textures of one size and kind share an image array. Draws of one material form a [`Bucket`]: one indirect draw, with the material's
//! constants and maps bound once and the shader specialised to its features. Constants and maps are thus uniform in the shader, which saves
//! a fifth of a map's time on a software driver.

use super::bent::{DeviceBending, FrameBending};
use super::buckets::{Bucket, BucketKey, Motion, PlacedDraw, fill_buckets, material_data, upload_textures};
use super::masks::{FrameMasks, Masks};
use crate::fail;
use crate::gpu::{BufferId, Format, Gpu, ImageId, Sampler, VertexLayout, Wrapping};
use crate::graph::{Buffer, DrawList, Graph, ListBlock, Member, ShaderStruct};
use crate::scene::{Aabb, Draw, Filter, Scene, Vertex, Wrap};
use crate::{shader_struct, vertex_layout};
use anyhow::Result;

/// Vertex layout of a scene's buffer, and the types that shaders read.
pub const VERTEX: VertexLayout = vertex_layout!(Vertex { position: Float3, normal: Snorm16x2, uv: Float2, color: Unorm8x4, tangent: Uint });

shader_struct! {
    /// A draw: `glsl/lib/scene.glsl`.
    pub struct DrawData {
        /// Three axes and the translation, column by column.
        pub transform: [[f32; 3]; 4],
        pub material: u32,
        /// Whether the material is double-sided.
        pub double_sided: u32,
    }

    /// `VkDrawIndexedIndirectCommand`; the first instance is the draw's number.
    pub struct DrawArguments {
        pub index_count: u32,
        pub instance_count: u32,
        pub first_index: u32,
        pub vertex_offset: i32,
        pub first_instance: u32,
    }

    /// A part of a draw: `glsl/lib/scene.glsl`.
    pub struct PartData {
        /// World-space bounding box.
        pub box_min: [f32; 3],
        pub draw: u32,
        pub box_max: [f32; 3],
    }

    /// A material: `glsl/lib/scene.glsl`.
    pub struct MaterialData {
        pub base_color: [f32; 4],
        pub emission: [f32; 3],
        pub metallic: f32,
        pub roughness: f32,
        pub alpha_cutoff: f32,
        pub normal_scale: f32,
        pub double_sided: u32,
        /// Base colour, metallic-roughness, emission and normal map: matrix columns, offset, layer.
        pub base_color_map: [f32; 7],
        pub metallic_roughness_map: [f32; 7],
        pub emission_map: [f32; 7],
        pub normal_map: [f32; 7],
        /// Mean roughness with its map.
        pub mean_roughness: f32,
        /// Padding to 256 bytes, so that every device can bind one element as a uniform block.
        pub padding: [u32; 23],
    }
}

const _: () = assert!(size_of::<MaterialData>() == 256);

/// Layout for passes that make vertices; the host's own type is plain data.
impl ShaderStruct for Vertex {
    const NAME: &'static str = "Vertex";
    const MEMBERS: &'static [Member] = {
        use std::mem::offset_of;
        &[
            Member { name: "position", kind: "[f32; 3]", offset: offset_of!(Vertex, position), bytes: 12 },
            Member { name: "normal", kind: "u32", offset: offset_of!(Vertex, normal), bytes: 4 },
            Member { name: "uv", kind: "[f32; 2]", offset: offset_of!(Vertex, uv), bytes: 8 },
            Member { name: "color", kind: "u32", offset: offset_of!(Vertex, color), bytes: 4 },
            Member { name: "tangent", kind: "u32", offset: offset_of!(Vertex, tangent), bytes: 4 },
        ]
    };
}

/// Bindings of a material's maps in the shaders, and constants that switch them on.
const MAPS: [(&str, &str); 4] = [
    ("base_color_map", "BASE_COLOR_MAP"),
    ("metallic_roughness_map", "METALLIC_ROUGHNESS_MAP"),
    ("emission_map", "EMISSION_MAP"),
    ("normal_map", "NORMAL_MAP"),
];

/// Maps of a material that a pass's shaders use: the first, two or all four of base colour, metallic-roughness, emission, normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Maps {
    /// For holes in what the camera sees.
    Mask,
    /// For holes in what a light sees.
    Shadow,
    Reflection,
    All,
}

impl Maps {
    /// Number of the maps, from the first of [`MAPS`] on.
    fn count(self) -> usize {
        match self {
            Self::Mask | Self::Shadow => 1,
            Self::Reflection => 2,
            Self::All => 4,
        }
    }

    /// Whether back faces of single-sided surfaces are left out. They stop light even where the camera does not see them.
    fn cull_back(self) -> bool {
        match self {
            Self::Mask | Self::All => true,
            Self::Shadow | Self::Reflection => false,
        }
    }
}

/// Transforms and materials of the draws.
enum Draws {
    /// On the device, uploaded once.
    Still(BufferId, u32),
    /// On the host, uploaded every frame, because the scene's animation moves some.
    Moving(Vec<DrawData>),
}

/// A scene on the device, which owns all of its resources.
pub struct DeviceScene {
    /// Bounds over the whole animation: [`Scene::bounds`].
    pub bounds: Aabb,
    pub triangles: u64,
    /// Whether any material is metallic, by its factor or possibly by a map.
    pub has_metals: bool,
    vertices: (BufferId, u32),
    indices: (BufferId, u32),
    draws: Draws,
    materials: (BufferId, u32),
    arrays: Vec<ImageId>,
    /// A white texel, bound in place of missing maps.
    blank: ImageId,
    buckets: Vec<Bucket>,
    /// Alpha masks for points; `None` without masked materials.
    masks: Option<Masks>,
    bending: Option<DeviceBending>,
}

/// All of a scene, in parts that a pass can cull.
pub struct Parts {
    pub lists: Vec<DrawList>,
    /// [`PartData`] of each part.
    pub parts: Buffer,
    /// Draw arguments of each part: its number as the first instance, and initially no instances.
    pub arguments: Buffer,
    pub count: u32,
}

/// A scene in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameScene<'f> {
    scene: &'f DeviceScene,
    /// [`DrawData`].
    pub draws: Buffer,
    /// [`Vertex`].
    pub vertices: Buffer,
    /// Indices, three a triangle.
    pub indices: Buffer,
    /// [`MaterialData`].
    pub materials: Buffer,
    /// Alpha masks for points; `None` without masked materials.
    pub masks: Option<FrameMasks>,
    /// Meshes that bend.
    pub bending: Option<FrameBending>,
}

impl DeviceScene {
    /// Uploads a scene to the device.
    ///
    /// # Errors
    /// `BadInput` if the scene is over a limit of the device; the error names the limit and the key.
    pub fn upload(gpu: &mut Gpu, scene: &Scene) -> Result<Self> {
        let limits = gpu.adapter.limits;
        let check = |what: &str, bytes: usize, limit: u64| -> Result<()> {
            if bytes as u64 > limit {
                return Err(fail!(
                    BadInput,
                    "{}: its {} triangles need {} MB of {what}, over the {} MB that {} allows; lower scene.triangles or take a smaller file",
                    scene.name,
                    scene.triangle_count(),
                    bytes >> 20,
                    limit >> 20,
                    gpu.adapter.name
                ));
            }
            Ok(())
        };
        check("vertices", size_of_val(scene.vertices.as_slice()), limits.buffer_bytes)?;
        check("indices", size_of_val(scene.indices.as_slice()), limits.buffer_bytes)?;
        check("draws", scene.draws.len() * size_of::<DrawData>(), limits.storage_buffer_bytes)?;
        check("materials", scene.materials.len() * size_of::<MaterialData>(), limits.storage_buffer_bytes)?;

        let (arrays, placed) = upload_textures(gpu, scene)?;
        let materials: Vec<MaterialData> = scene.materials.iter().map(|material| material_data(material, &placed)).collect();
        let data = draw_data(scene);
        let draws = match &scene.animation {
            None => Draws::Still(gpu.create_filled_buffer("scene/draws", bytemuck::cast_slice(&data))?, data.len() as u32),
            Some(_) => Draws::Moving(data),
        };
        let (buckets, bounds) = fill_buckets(scene, &placed);
        let bending = scene.bending.as_ref().map(|bending| DeviceBending::upload(gpu, scene, bending)).transpose()?;
        Ok(Self {
            bounds: if scene.animation.is_some() { scene.bounds() } else { bounds },
            triangles: scene.triangle_count(),
            has_metals: scene.materials.iter().any(|material| material.metallic > 0.0),
            vertices: (gpu.create_filled_buffer("scene/vertices", bytemuck::cast_slice(&scene.vertices))?, scene.vertices.len() as u32),
            indices: (gpu.create_filled_buffer("scene/indices", bytemuck::cast_slice(&scene.indices))?, scene.indices.len() as u32),
            draws,
            materials: (gpu.create_filled_buffer("scene/materials", bytemuck::cast_slice(&materials))?, materials.len() as u32),
            arrays,
            blank: gpu.create_texture_array("scene/blank", Format::Rgba8Unorm, [1, 1], std::iter::once(vec![255; 4]))?,
            buckets,
            masks: Masks::upload(gpu, scene)?,
            bending,
        })
    }

    /// Copies the draws' transforms and the pose from the host's scene, whose time was set ([`Scene::pose`]).
    pub fn follow(&mut self, scene: &Scene) {
        let Draws::Moving(draws) = &mut self.draws else { return };
        *draws = draw_data(scene);
        for draw in self.buckets.iter_mut().flat_map(|bucket| &mut bucket.draws) {
            let transform = &scene.draws[draw.arguments.first_instance as usize].transform;
            match (&draw.motion, &scene.bending) {
                (Motion::Moves(own), _) => draw.bounds = own.transformed(transform),
                (Motion::Bends(reach), Some(bending)) => draw.bounds = reach.bounds(&bending.pose, transform),
                _ => {}
            }
        }
        if let (Some(device), Some(bending)) = (&mut self.bending, &scene.bending) {
            device.follow(&bending.pose);
        }
    }

    /// Imports the scene into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameScene<'_> {
        let draws = match &self.draws {
            Draws::Still(id, count) => g.import_buffer::<DrawData>("scene/draws", *id, *count),
            Draws::Moving(draws) => g.upload("scene/draws", draws),
        };
        let (id, count) = self.vertices;
        FrameScene {
            scene: self,
            draws,
            vertices: match self.bending {
                Some(_) => g.keep_buffer::<Vertex>("scene/vertices", id, count),
                None => g.import_buffer::<Vertex>("scene/vertices", id, count),
            },
            bending: self.bending.as_ref().map(|bending| bending.import(g)),
            indices: g.import_buffer::<u32>("scene/indices", self.indices.0, self.indices.1),
            materials: g.import_buffer::<MaterialData>("scene/materials", self.materials.0, self.materials.1),
            masks: self.masks.as_ref().map(|masks| masks.import(g)),
        }
    }
}

impl FrameScene<'_> {
    /// Bounds over the whole animation: [`Scene::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.scene.bounds
    }

    /// Whether any material is metallic, by its factor or possibly by a map.
    pub fn has_metals(&self) -> bool {
        self.scene.has_metals
    }

    /// Draw lists of a raster pass, with `instances` instances a draw. Parts without a `distance` are left out. Nearer parts come first as
    /// far as buckets allow, which saves the shading of hidden surfaces. A frame that warms up ([`Graph::warming_up`]) gets a triangle of
    /// every bucket that has no visible part.
    pub fn draw_lists(
        &self,
        g: &mut Graph,
        name: &str,
        maps: Maps,
        instances: u32,
        distance: impl Fn(Aabb) -> Option<f32>,
    ) -> Vec<DrawList> {
        let mut drawn = Vec::new();
        for bucket in &self.scene.buckets {
            let part = |draw: &PlacedDraw| Some((distance(draw.bounds)?, DrawArguments { instance_count: instances, ..draw.arguments }));
            let mut parts: Vec<(f32, DrawArguments)> = bucket.draws.iter().filter_map(part).collect();
            if parts.is_empty() && g.is_warming_up() {
                // A prepared pipeline is not enough: drivers that compile at first use do so again for another texture's format.
                let triangle = |draw: &PlacedDraw| DrawArguments { index_count: 3, instance_count: instances, ..draw.arguments };
                parts.extend(bucket.draws.first().map(|draw| (f32::INFINITY, triangle(draw))));
            }
            parts.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((nearest, _)) = parts.first() {
                drawn.push((*nearest, bucket, parts));
            }
        }
        // Masked surfaces come last, since their holes are known only after shading.
        drawn.sort_by(|a, b| a.1.key.masked.cmp(&b.1.key.masked).then(a.0.total_cmp(&b.0)));
        let mut arguments: Vec<DrawArguments> = Vec::new();
        let mut ranges = Vec::new();
        for (_, bucket, parts) in &drawn {
            ranges.push((*bucket, arguments.len() as u32, parts.len() as u32));
            arguments.extend(parts.iter().map(|(_, arguments)| arguments));
        }
        if arguments.is_empty() {
            // Buffers are never empty; no list refers to this element.
            arguments.push(bytemuck::Zeroable::zeroed());
        }
        let arguments = g.upload(&format!("{name}/arguments"), &arguments);
        ranges.into_iter().map(|(bucket, first, count)| self.draw_list(&bucket.key, arguments, first, count, maps)).collect()
    }

    /// Draw lists of everything in parts; a pass on the device fills in their instance counts.
    pub fn parts(&self, g: &mut Graph, name: &str, maps: Maps) -> Parts {
        let placed = self.scene.buckets.iter().flat_map(|bucket| &bucket.draws);
        let data: Vec<PartData> = placed
            .clone()
            .map(|draw| PartData { box_min: draw.bounds.min.into(), draw: draw.arguments.first_instance, box_max: draw.bounds.max.into() })
            .collect();
        let arguments: Vec<DrawArguments> =
            placed.zip(0..).map(|(draw, number)| DrawArguments { instance_count: 0, first_instance: number, ..draw.arguments }).collect();
        let count = data.len() as u32;
        // Buffers are never empty.
        let pad = usize::from(data.is_empty());
        let data: Vec<PartData> = data.into_iter().chain(std::iter::repeat_n(bytemuck::Zeroable::zeroed(), pad)).collect();
        let arguments: Vec<DrawArguments> = arguments.into_iter().chain(std::iter::repeat_n(bytemuck::Zeroable::zeroed(), pad)).collect();
        let parts = g.upload(&format!("{name}/parts"), &data);
        let arguments = g.upload(&format!("{name}/arguments"), &arguments);
        let mut first = 0;
        let lists = self.scene.buckets.iter().map(|bucket| {
            let count = bucket.draws.len() as u32;
            first += count;
            self.draw_list(&bucket.key, arguments, first - count, count, maps)
        });
        Parts { lists: lists.collect(), parts, arguments, count }
    }

    fn draw_list(&self, key: &BucketKey, arguments: Buffer, first: u32, count: u32, maps: Maps) -> DrawList {
        let mut constants = vec![("MASKED", u32::from(key.masked)), ("VERTEX_COLOR", u32::from(key.colored))];
        let mut textures = Vec::new();
        for (map, (binding, constant)) in key.maps.iter().zip(MAPS).take(maps.count()) {
            constants.push((constant, u32::from(map.is_some())));
            textures.push(match map {
                Some(key) => {
                    let sampler = Sampler::Material { u: wrapping(key.u), v: wrapping(key.v), linear: key.filter == Filter::Linear };
                    (binding, self.scene.arrays[key.array], sampler)
                }
                None => (binding, self.scene.blank, Sampler::Nearest),
            });
        }
        DrawList {
            textures,
            blocks: vec![ListBlock::of::<MaterialData>("material_block", self.scene.materials.0, key.material)],
            constants,
            cull_back: !key.double_sided && maps.cull_back(),
            vertex: VERTEX,
            vertices: self.vertices,
            indices: Some(self.indices),
            arguments,
            first,
            count,
        }
    }
}

fn draw_data(scene: &Scene) -> Vec<DrawData> {
    let data = |draw: &Draw| DrawData {
        transform: draw.transform.to_cols_array_2d(),
        material: draw.material,
        double_sided: u32::from(scene.materials[draw.material as usize].double_sided),
    };
    scene.draws.iter().map(data).collect()
}

fn wrapping(wrap: Wrap) -> Wrapping {
    match wrap {
        Wrap::Repeat => Wrapping::Repeat,
        Wrap::MirroredRepeat => Wrapping::MirroredRepeat,
        Wrap::ClampToEdge => Wrapping::ClampToEdge,
    }
}
