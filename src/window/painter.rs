//! The window's pictures: egui's triangles, drawn by one pass of a graph and shown on the window's surface.

use crate::gpu::{self, DeviceChoice, Format, Gpu, ImageDesc, ImageId, Options, Presented, Sampler, VertexLayout};
use crate::graph::{DrawList, Engine, Execution, Graph, Library, Pool, Timing};
use crate::world::device::DrawArguments;
use crate::{shader_struct, vertex_layout};
use anyhow::Result;
use egui::epaint::{ImageDelta, Primitive};
use egui::{ClippedPrimitive, Color32, ImageData, TextureFilter, TextureId, TexturesDelta};
use std::collections::HashMap;
use std::sync::Arc;
use winit::window::Window;

shader_struct! {
    /// A corner of a triangle: `glsl/window/ui.vert`. Places are pixels.
    struct UiVertex {
        position: [f32; 2],
        uv: [f32; 2],
        /// sRGB-encoded, and multiplied by its alpha.
        color: [u8; 4],
        clip_from: [f32; 2],
        clip_to: [f32; 2],
    }

    /// Push constants of `window/ui`.
    struct UiParams {
        size: [f32; 2],
    }
}

const VERTEX: VertexLayout = vertex_layout!(UiVertex { position: Float2, uv: Float2, color: Unorm8x4, clip_from: Float2, clip_to: Float2 });

/// A texture of egui's. Its pixels stay on the host, since egui changes parts of them.
struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
    linear: bool,
    image: Option<ImageId>,
}

/// A window's device, with the textures of its widgets. It is another device object than the one that renders, so that the window answers
/// while a frame takes its time.
pub struct Painter {
    engine: Engine,
    pool: Pool,
    textures: HashMap<TextureId, Texture>,
    /// What the window shows, and its size in pixels.
    picture: Option<(ImageId, [u32; 2])>,
}

impl Painter {
    /// Opens a device that shows pictures in a window.
    ///
    /// # Errors
    /// `NoDevice` without one.
    pub fn open(window: Arc<Window>, device: Option<&DeviceChoice>, validate: bool) -> Result<Self> {
        let display = gpu::surface::extensions(&window)?;
        let mut gpu = Gpu::new(&Options { device: device.cloned().unwrap_or_default(), validate, display })?;
        let size = window.inner_size();
        gpu.open_surface(window, [size.width, size.height])?;
        Ok(Self { engine: Engine::new(gpu, Library::new()?), pool: Pool::default(), textures: HashMap::new(), picture: None })
    }

    /// Tells the window's size in pixels, and whether pictures wait for the display's refresh.
    pub fn resize(&mut self, size: [u32; 2], waits_for_display: bool) {
        self.engine.gpu.resize_surface(size, waits_for_display);
    }

    /// Longest side of a texture, texels.
    pub fn largest_texture(&self) -> usize {
        self.engine.gpu.adapter.limits.image_size as usize
    }

    /// Messages of the validation layer so far.
    pub fn validation_messages(&self) -> Vec<String> {
        self.engine.gpu.validation_messages()
    }

    /// Draws triangles and shows them. `scale` is the pixels of a point.
    ///
    /// # Errors
    /// The device's own.
    pub fn paint(&mut self, triangles: &[ClippedPrimitive], mut textures: TexturesDelta, scale: f32, size: [u32; 2]) -> Result<Presented> {
        for (id, deltas) in &textures.set {
            deltas.iter().for_each(|delta| self.change(*id, delta));
        }
        let unused: Vec<TextureId> = textures.free.iter().copied().collect();
        textures.clear();
        if size[0] == 0 || size[1] == 0 {
            return Ok(Presented::No);
        }
        let (vertices, indices, runs) = merged(triangles, scale);
        for (id, _) in &runs {
            self.bring(*id)?;
        }
        let picture = self.picture_of(size)?;
        let mut g = Graph::new();
        let target = g.keep_image("window/picture", picture, Format::Rgba8Unorm, size, 1);
        let arguments: Vec<DrawArguments> = runs
            .iter()
            .map(|(_, run)| DrawArguments {
                index_count: run.len() as u32,
                instance_count: 1,
                first_index: run.start as u32,
                vertex_offset: 0,
                first_instance: 0,
            })
            .collect();
        let geometry = [g.upload("window/vertices", &padded(vertices)), g.upload("window/indices", &padded(indices))];
        let arguments = g.upload("window/arguments", &padded(arguments));
        let lists = runs.iter().enumerate().filter_map(|(i, (id, _))| {
            let texture = self.textures.get(id)?;
            let sampler = if texture.linear { Sampler::Linear } else { Sampler::Nearest };
            let mut list = DrawList::new(VERTEX, geometry, arguments);
            (list.first, list.count) = (i as u32, 1);
            list.textures = vec![("colors", texture.image?, sampler)];
            Some(list)
        });
        g.raster("window/ui")
            .color_blend("picture", target, [0.0, 0.0, 0.0, 1.0])
            .params(&UiParams { size: size.map(|side| side as f32) })
            .draw(lists.collect());
        self.engine.run(&mut self.pool, &g, &Execution { timing: Timing::Overlapped, ..Execution::default() })?;
        let shown = self.engine.gpu.present(picture)?;
        for id in unused {
            if let Some(image) = self.textures.remove(&id).and_then(|texture| texture.image) {
                self.engine.gpu.free_image(image);
            }
        }
        Ok(shown)
    }

    /// The image that the window shows.
    fn picture_of(&mut self, size: [u32; 2]) -> Result<ImageId> {
        match self.picture {
            Some((image, known)) if known == size => Ok(image),
            old => {
                let [width, height] = size;
                let desc = ImageDesc { format: Format::Rgba8Unorm, width, height, layers: 1, mips: 1, attachment: true, storage: false };
                let image = self.engine.gpu.create_images(&[("window/picture", desc)])?[0];
                old.iter().for_each(|(old, _)| self.engine.gpu.free_image(*old));
                self.picture = Some((image, size));
                Ok(image)
            }
        }
    }

    /// Takes over a change of a texture's pixels.
    fn change(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        let linear = delta.options.magnification == TextureFilter::Linear;
        let stale = match (delta.pos, self.textures.get_mut(&id)) {
            (Some([x, y]), Some(texture)) => {
                for (row, pixels) in image.pixels.chunks_exact(width.max(1)).enumerate() {
                    let start = (y + row) * texture.size[0] + x;
                    texture.pixels[start..start + width].copy_from_slice(pixels);
                }
                texture.image.take()
            }
            _ => {
                let texture = Texture { size: [width, height], pixels: image.pixels.clone(), linear, image: None };
                self.textures.insert(id, texture).and_then(|old| old.image)
            }
        };
        stale.iter().for_each(|image| self.engine.gpu.free_image(*image));
    }

    /// Uploads a texture that has changed.
    fn bring(&mut self, id: TextureId) -> Result<()> {
        let Some(texture) = self.textures.get_mut(&id).filter(|texture| texture.image.is_none()) else { return Ok(()) };
        let size = [texture.size[0] as u32, texture.size[1] as u32, 1];
        let bytes: Vec<u8> = texture.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        texture.image = Some(self.engine.gpu.create_filled_image("window/texture", Format::Rgba8Unorm, size, &bytes, false)?);
        Ok(())
    }
}

/// Vertices, indices, and the range of indices of each run of triangles with the same texture.
type Merged = (Vec<UiVertex>, Vec<u32>, Vec<(TextureId, std::ops::Range<usize>)>);

fn merged(triangles: &[ClippedPrimitive], scale: f32) -> Merged {
    let (mut vertices, mut indices, mut runs): Merged = Default::default();
    for ClippedPrimitive { clip_rect, primitive } in triangles {
        // There are no callbacks: nothing here makes them.
        let Primitive::Mesh(mesh) = primitive else { continue };
        let (first, start) = (vertices.len() as u32, indices.len());
        let clip = [clip_rect.min, clip_rect.max].map(|corner| [corner.x, corner.y].map(|side| (side * scale).round()));
        vertices.extend(mesh.vertices.iter().map(|vertex| UiVertex {
            position: [vertex.pos.x * scale, vertex.pos.y * scale],
            uv: [vertex.uv.x, vertex.uv.y],
            color: vertex.color.to_array(),
            clip_from: clip[0],
            clip_to: clip[1],
        }));
        indices.extend(mesh.indices.iter().map(|index| first + index));
        match runs.last_mut() {
            Some((id, run)) if *id == mesh.texture_id => run.end = indices.len(),
            _ => runs.push((mesh.texture_id, start..indices.len())),
        }
    }
    (vertices, indices, runs)
}

/// Elements up to a power of two, so that buffers keep their sizes while widgets come and go.
fn padded<T: bytemuck::Zeroable + Clone>(mut elements: Vec<T>) -> Vec<T> {
    let count = elements.len().next_power_of_two().max(64);
    elements.resize(count, T::zeroed());
    elements
}
