//! The final picture: all light of a pixel, exposed and tone-mapped.

use super::gather::Indirect;
use super::gbuffer::GBuffer;
use super::methods::{Method, NOTHING};
use super::sky::sky_of;
use super::vpls::Vpls;
use crate::config::{ComposeConfig, Show, Tonemap};
use crate::gpu::Format;
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;
use crate::world::sky::FrameSky;

shader_struct! {
    struct SumParams {
        exposure: f32,
        background: [f32; 3],
    }

    /// `glsl/compose/marks.comp`.
    pub(super) struct MarksParams {
        pub(super) count: u32,
        pub(super) radius: i32,
    }
}

/// The picture, and the images behind it.
#[derive(Debug, Clone, Copy)]
pub struct Composed {
    /// Radiance of the indirect light, albedo included.
    pub indirect: Image,
    /// All radiance before exposure; alpha is 1 where there is a surface.
    pub radiance: Image,
    /// Tone-mapped and sRGB-encoded, 8 bits a channel.
    pub image: Image,
}

/// The slot's one method.
pub fn method() -> Method {
    Method::only("compose", "sum", NOTHING)
}

/// Light of the pixels, to be summed.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    /// Radiance of the direct light.
    pub direct: Image,
    pub indirect: Indirect,
    /// Share of the indirect light that ambient occlusion leaves, from 0 to 1.
    pub visible: Option<Image>,
}

/// Sums direct, indirect and emitted radiance; pixels without a surface show the sky. The config may have the image show the indirect light
/// or `vpls`, if there are any, instead.
pub fn sum(
    g: &mut Graph,
    gbuffer: &GBuffer,
    Light { direct, indirect, visible }: Light,
    vpls: Option<&Vpls>,
    sky: &FrameSky<'_>,
    config: &ComposeConfig,
) -> Composed {
    let composed = Composed {
        indirect: g.image("compose/indirect", Format::Rgba16Float, gbuffer.size),
        radiance: g.image("compose/radiance", Format::Rgba16Float, gbuffer.size),
        image: g.image("compose/image", Format::Rgba8Unorm, gbuffer.size),
    };
    let shown = vpls.filter(|_| config.show == Show::Vpls).map(|vpls| (marks(g, gbuffer, vpls), vpls));
    let pass = sky_of(g.compute("compose/sum"), sky);
    let pass = match (config.show, shown) {
        (Show::Indirect, _) => pass.part("shown", "compose/shown-indirect"),
        (_, Some((marks, vpls))) => pass.part("shown", "compose/shown-vpls").reads("marks", marks).reads("intensities", vpls.intensities),
        _ => pass,
    };
    let pass = match visible {
        None => pass,
        Some(visible) => pass.part("occlusion", "compose/occlusion-seen").reads("visible", visible),
    };
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("albedo", gbuffer.albedo)
        .reads("metallic_roughness", gbuffer.metallic_roughness)
        .reads("emission", gbuffer.emission)
        .reads("direct", direct)
        .reads("irradiance", indirect.irradiance)
        // Bound to keep the layout complete; `REFLECTION` is false, so it is not read.
        .reads("reflection", indirect.reflection.unwrap_or(direct))
        .writes("indirect", composed.indirect)
        .writes("radiance", composed.radiance)
        .writes("image", composed.image)
        .constant("REFLECTION", indirect.reflection.is_some())
        .constant("REINHARD", config.tonemap == Tonemap::Reinhard)
        .params(&SumParams { exposure: config.exposure, background: config.background })
        .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
    composed
}

/// Number, plus 1, of the VPL that each pixel is near to; 0 where there is none.
fn marks(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls) -> Buffer {
    let [width, height] = gbuffer.size;
    let marks = g.zeroed::<u32>("compose/marks", width * height);
    g.compute("compose/marks")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("places", vpls.places)
        .reads("areas", vpls.areas)
        .updates("marks", marks)
        .params(&MarksParams { count: vpls.count, radius: (height / 180).max(1) as i32 })
        .dispatch([vpls.count, 1, 1]);
    marks
}
