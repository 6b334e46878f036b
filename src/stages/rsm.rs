//! Reflective shadow maps (Dachsbacher and Stamminger 2005): what each light sees, and how much of its flux arrives there.

use crate::config::{Config, Dielectric, Reflection};
use crate::gpu::Format;
use crate::graph::{Buffer, Graph, Image};
use crate::scene::device::{DeviceScene, Maps, SceneHandles};
use crate::scene::projection::Projector;
use crate::shader_struct;
use bytemuck::Zeroable;

/// A map a light, as layers of the same images. A texel without a surface has depth 0 and no flux.
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
    /// Geometric normal, turned to the light; octahedral.
    pub normal: Image,
    /// Incident flux of the texel, W.
    pub flux: Image,
    /// Diffuse albedo, averaged over the area that a VPL stands for; 0 on the back of a single-sided surface.
    pub albedo: Image,
    /// What makes glossy VPLs; there where they are wanted.
    pub glossy: Option<GlossyRsm>,
}

/// What a texel reflects by GGX.
#[derive(Debug, Clone, Copy)]
pub struct GlossyRsm {
    /// Fresnel reflectance along the normal, RGB, and at grazing angles, times how much of the surface is glossy.
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

/// Rasterizes the scene once for all lights: an instance each, which the vertex shader sends to its layer. The config
/// says how many texels a VPL stands for, and whether some are glossy.
pub fn draw(g: &mut Graph, scene: &DeviceScene, handles: SceneHandles, lights: &[Projector], config: &Config) -> Rsm {
    let size = config.rsm.size;
    let layers = lights.len() as u32;
    let mut block = vec![Projector::zeroed(); Projector::MAX];
    block[..lights.len()].copy_from_slice(lights);
    let rsm = Rsm {
        lights: g.upload("rsm/lights", &block),
        layers,
        kind: Projector::common_kind(lights),
        size,
        covers_all: config.rsm.bounds.is_none(),
        depth: g.layered_image("rsm/depth", Format::Depth32, size, layers),
        normal: g.layered_image("rsm/normal", Format::Rg16Snorm, size, layers),
        flux: g.layered_image("rsm/flux", Format::Rgba32Float, size, layers),
        albedo: g.layered_image("rsm/albedo", Format::Rgba16Float, size, layers),
        glossy: (config.vpls.reflection != Reflection::Diffuse).then(|| GlossyRsm {
            specular: g.layered_image("rsm/specular", Format::Rgba16Float, size, layers),
            lobe: g.layered_image("rsm/lobe", Format::Rgba32Float, size, layers),
        }),
    };
    let lists = scene.draw_lists(g, "rsm", Maps::Reflection, layers, |bounds| {
        lights.iter().filter(|light| light.sees(bounds)).map(|light| light.distance(bounds)).reduce(f32::min)
    });
    let texels_per_vpl = f64::from(size[0]) * f64::from(size[1]) * f64::from(layers) / f64::from(config.vpl_count(layers));
    let mut pass = g
        .raster("rsm/draw")
        .reads("lights", rsm.lights)
        .reads("draws", handles.draws)
        .constant("SEVERAL_LIGHTS", layers > 1)
        .constant("LIGHT_KIND", rsm.kind)
        .params(&RsmParams {
            texel_size: [2.0 / size[0] as f32, 2.0 / size[1] as f32],
            albedo_lod: (0.5 * texels_per_vpl.log2()).max(0.0) as f32,
        })
        .color("normal", rsm.normal, [0.0; 4])
        .color("albedo", rsm.albedo, [0.0; 4])
        .depth(rsm.depth);
    if let Some(glossy) = rsm.glossy {
        pass = pass
            .shader("rsm/draw-glossy")
            .constant("GLOSSY_DIELECTRIC", config.materials.dielectric == Dielectric::Ggx)
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
