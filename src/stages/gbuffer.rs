//! What the camera sees: surfaces by pixel.

use crate::gpu::Format;
use crate::graph::{Buffer, Graph, Image};
use crate::scene::device::{DeviceScene, Maps, SceneHandles};
use crate::scene::projection::View;

/// One image a property, each of the picture's size. A pixel without a surface has depth 0.
#[derive(Debug, Clone, Copy)]
pub struct GBuffer {
    /// The view's uniform block, from which positions are rebuilt.
    pub view: Buffer,
    pub size: [u32; 2],
    /// Reversed and infinite: the near plane's distance over the pixel's.
    pub depth: Image,
    /// Shading normal in the world, turned to the viewer; octahedral.
    pub normal: Image,
    /// Base colour, linear.
    pub albedo: Image,
    pub metallic_roughness: Image,
    /// Emitted radiance.
    pub emission: Image,
}

/// Rasterizes the scene.
pub fn draw(g: &mut Graph, scene: &DeviceScene, handles: SceneHandles, view: &View) -> GBuffer {
    let size = [view.width, view.height];
    let gbuffer = GBuffer {
        view: g.upload("gbuffer/view", &[*view]),
        size,
        depth: g.image("gbuffer/depth", Format::Depth32, size),
        normal: g.image("gbuffer/normal", Format::Rg16Snorm, size),
        albedo: g.image("gbuffer/albedo", Format::Rgba16Float, size),
        metallic_roughness: g.image("gbuffer/metallic-roughness", Format::Rg8Unorm, size),
        emission: g.image("gbuffer/emission", Format::Rgba16Float, size),
    };
    let lists = scene.draw_lists(g, "gbuffer", Maps::All, 1, |bounds| view.sees(bounds).then(|| view.distance(bounds)));
    g.raster("gbuffer/draw")
        .reads("view", gbuffer.view)
        .reads("draws", handles.draws)
        .color("normal", gbuffer.normal, [0.0; 4])
        .color("albedo", gbuffer.albedo, [0.0; 4])
        .color("metallic_roughness", gbuffer.metallic_roughness, [0.0; 4])
        .color("emission", gbuffer.emission, [0.0; 4])
        .depth(gbuffer.depth)
        .draw(lists);
    gbuffer
}
