//! Reflective shadow maps (Dachsbacher and Stamminger 2005): the surfaces that each light sees, and the flux that arrives at each texel.

use super::facts::Facts;
use super::methods::Method;
use super::wants::Wants;
use crate::config::{Config, Dielectric, RsmAlbedo, RsmConfig};
use crate::fail;
use crate::gpu::{Feature, Format};
use crate::graph::{Buffer, Graph, Image};
use crate::scene::Light;
use crate::shader_struct;
use crate::world::device::{FrameScene, Maps};
use crate::world::projection::Projector;
use anyhow::Result;
use bytemuck::Zeroable;

/// Reflective shadow maps as layers of the same images. A texel without a surface has depth 0 and no flux.
#[derive(Debug, Clone, Copy)]
pub struct Rsm {
    /// The projectors, one a layer.
    pub lights: Buffer,
    pub layers: u32,
    /// The lights' common kind as in [`Projector::kind`], or [`Projector::MIXED`].
    pub kind: u32,
    pub size: [u32; 2],
    /// Whether directional lights' maps cover all of the scene.
    pub covers_all: bool,
    pub depth: Image,
    /// Geometric normal, octahedral, flipped to face the light.
    pub normal: Image,
    /// Incident flux of the texel, W.
    pub flux: Image,
    /// Diffuse albedo, averaged over a VPL's footprint; 0 on the back of a single-sided surface.
    pub albedo: Image,
    /// Inputs of glossy VPLs; there if [`Wants::glossy`] says so.
    pub glossy: Option<GlossyRsm>,
}

/// GGX reflectance of the texels.
#[derive(Debug, Clone, Copy)]
pub struct GlossyRsm {
    /// Fresnel reflectance at normal incidence (RGB) and at grazing incidence (alpha), times the glossy share of the surface.
    pub specular: Image,
    /// Interpolated normal, octahedral, and alpha.
    pub lobe: Image,
}

shader_struct! {
    struct RsmParams {
        texel_size: [f32; 2],
        albedo_lod: f32,
    }

    struct FluxParams {
        size: [u32; 3],
    }
}

/// The slot's one method, with the features it needs.
pub fn method() -> Method {
    use Feature::{LayerFromVertexShader, MultiDrawIndirect, ShaderDrawParameters, Snorm16Images};
    Method::only("rsm", "draw", &[&[MultiDrawIndirect, ShaderDrawParameters, LayerFromVertexShader, Snorm16Images]])
}

/// Refuses maps larger than the device's limits.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    check_size("rsm.size", config.rsm.size, facts)
}

/// Refuses a size of maps, the value of a key, that is larger than the device's limits.
pub fn check_size(key: &str, [width, height]: [u32; 2], facts: &Facts) -> Result<()> {
    let limits = &facts.adapter.limits;
    let [max_width, max_height] = limits.framebuffer_size.map(|n| n.min(limits.image_size));
    if width > max_width || height > max_height {
        return Err(fail!(BadInput, "{key}: {width}x{height} is over the {max_width}x{max_height} that {} allows", facts.adapter.name));
    }
    Ok(())
}

/// Lights as the shaders' uniform block has them.
pub fn block(lights: &[Projector]) -> Vec<Projector> {
    let mut block = vec![Projector::zeroed(); Projector::MAX];
    block[..lights.len()].copy_from_slice(lights);
    block
}

/// Warnings about light that the maps leave out.
pub fn warnings(lights: &[Light]) -> Vec<String> {
    let wide = |light: &Light| matches!(light, Light::Spot { outer, .. } if *outer > Projector::WIDEST_SPOT);
    let warning = "light: a spot light is wider than 80 degrees to each side; beyond them it lights nothing";
    lights.iter().any(wide).then(|| warning.to_owned()).into_iter().collect()
}

/// Rasterizes the scene once for all lights, with one instance a layer; the vertex shader selects the layer. Without lights there is no
/// layer, and the images stand for nothing.
pub fn draw(g: &mut Graph, scene: FrameScene<'_>, lights: &[Projector], wants: &Wants, config: &RsmConfig) -> Rsm {
    let layers = lights.len() as u32;
    let size = if layers == 0 { [1, 1] } else { config.size };
    let image_layers = layers.max(1);
    let rsm = Rsm {
        lights: g.upload("rsm/lights", &block(lights)),
        layers,
        kind: Projector::common_kind(lights),
        size,
        covers_all: config.bounds.is_none(),
        depth: g.layered_image("rsm/depth", Format::Depth32, size, image_layers),
        normal: g.layered_image("rsm/normal", Format::Rg16Snorm, size, image_layers),
        flux: g.layered_image("rsm/flux", Format::Rgba32Float, size, image_layers),
        albedo: g.layered_image("rsm/albedo", Format::Rgba16Float, size, image_layers),
        glossy: wants.glossy.then(|| GlossyRsm {
            specular: g.layered_image("rsm/specular", Format::Rgba16Float, size, image_layers),
            lobe: g.layered_image("rsm/lobe", Format::Rgba32Float, size, image_layers),
        }),
    };
    if layers == 0 {
        return rsm;
    }
    let lists = scene.draw_lists(g, "rsm", Maps::Reflection, layers, |bounds| {
        lights.iter().filter(|light| light.sees(bounds)).map(|light| light.distance(bounds)).reduce(f32::min)
    });
    let mut pass = g
        .raster("rsm/draw")
        .reads("lights", rsm.lights)
        .reads("draws", scene.draws)
        .constant("SEVERAL_LIGHTS", layers > 1)
        .constant("LIGHT_KIND", rsm.kind)
        .constant("WHOLE_MAPS", config.albedo == RsmAlbedo::Material)
        .params(&RsmParams {
            texel_size: [2.0 / size[0] as f32, 2.0 / size[1] as f32],
            albedo_lod: (0.5 * wants.texels_per_vpl.log2()).max(0.0) as f32,
        })
        .color("normal", rsm.normal, [0.0; 4])
        .color("albedo", rsm.albedo, [0.0; 4])
        .depth(rsm.depth);
    if let Some(glossy) = rsm.glossy {
        pass = pass
            .shader("rsm/draw-glossy")
            .constant("GLOSSY_DIELECTRIC", wants.dielectric == Dielectric::Ggx)
            .color("specular", glossy.specular, [0.0; 4])
            .color("lobe", glossy.lobe, [0.0; 4]);
    }
    pass.draw(lists);
    g.compute("rsm/flux")
        .reads("lights", rsm.lights)
        .reads("rsm_depth", rsm.depth)
        .writes("flux", rsm.flux)
        .constant("LIGHT_KIND", rsm.kind)
        .params(&FluxParams { size: [size[0], size[1], layers] })
        .dispatch([size[0], size[1], layers]);
    rsm
}
