//! The G-buffer: surfaces seen by the camera.

use super::facts::Facts;
use super::methods::Method;
use crate::config::Config;
use crate::fail;
use crate::gpu::{Feature, Format};
use crate::graph::{Buffer, Graph, Image};
use crate::world::device::{FrameScene, Maps};
use crate::world::projection::View;
use anyhow::Result;

/// Images of the picture's size, one a property. A pixel without a surface has depth 0.
#[derive(Debug, Clone, Copy)]
pub struct GBuffer {
    /// Uniform block of the view, by which positions are reconstructed from depth.
    pub view: Buffer,
    pub size: [u32; 2],
    /// Reversed depth with an infinite far plane: the near plane's distance over the pixel's.
    pub depth: Image,
    /// World-space shading normal, octahedral, flipped to face the viewer.
    pub normal: Image,
    /// Base colour, linear.
    pub albedo: Image,
    pub metallic_roughness: Image,
    /// Emitted radiance.
    pub emission: Image,
}

/// The slot's one method, with the features it needs.
pub fn method() -> Method {
    Method::only("gbuffer", "draw", &[&[Feature::MultiDrawIndirect, Feature::ShaderDrawParameters, Feature::Snorm16Images]])
}

/// Refuses a picture larger than the device's limits.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    let [width, height] = config.frame.size;
    let limits = &facts.adapter.limits;
    let [max_width, max_height] = limits.framebuffer_size.map(|n| n.min(limits.image_size));
    if width > max_width || height > max_height {
        return Err(fail!(
            BadInput,
            "frame.size: {width}x{height} is over the {max_width}x{max_height} that {} allows",
            facts.adapter.name
        ));
    }
    Ok(())
}

/// Rasterizes the scene.
pub fn draw(g: &mut Graph, scene: FrameScene<'_>, view: &View) -> GBuffer {
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
        .reads("draws", scene.draws)
        .color("normal", gbuffer.normal, [0.0; 4])
        .color("albedo", gbuffer.albedo, [0.0; 4])
        .color("metallic_roughness", gbuffer.metallic_roughness, [0.0; 4])
        .color("emission", gbuffer.emission, [0.0; 4])
        .depth(gbuffer.depth)
        .draw(lists);
    gbuffer
}
