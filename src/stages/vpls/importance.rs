//! Importance of the maps' texels to the view (Barák, Bittner and Havran 2013, section 4.1).

use super::super::gbuffer::GBuffer;
use super::super::rsm::Rsm;
use super::super::wants::Wants;
use super::points;
use crate::config::{Dielectric, Importance, Reflection, ViewLight, VplsConfig};
use crate::gpu::Format;
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::shader_struct;

shader_struct! {
    /// `glsl/vpls/view-sample.glsl`: a surface that the camera sees.
    pub struct ViewSample {
        pub position: [f32; 3],
        /// Luminance of the diffuse albedo, or of the base colour of a glossy receiver; -1 where there is no surface.
        pub albedo: f32,
        pub normal: [f32; 3],
    }

    /// `glsl/vpls/view-sample.glsl`: what the reflection of a glossy receiver needs besides.
    pub struct ViewSampleLobe {
        /// Direction to the camera.
        pub to_viewer: [f32; 3],
        pub roughness: f32,
        pub metallic: f32,
    }

    struct ViewSamplesParams {
        shift: [f32; 2],
        count: u32,
    }

    struct ViewImportanceBlock {
        samples: u32,
        squared_min_distance: f32,
    }

    struct FloorParams {
        size: [u32; 2],
        lights: u32,
        share: f32,
    }

    struct MapParams {
        size: [u32; 2],
    }
}

/// View samples that a uniform block holds on every device: `glsl/vpls/samples-uniform.glsl`.
const UNIFORM_SAMPLES: u32 = 512;

/// Texels whose importance an invocation works out at once: `glsl/vpls/at-once.glsl`.
pub(super) const AT_ONCE: u32 = 16;

/// Importance of texels, as a pass works it out.
#[derive(Debug, Clone, Copy)]
pub(super) enum TexelImportance {
    /// The same of all.
    Same,
    View(ViewImportance),
}

/// Importance to the view: what `glsl/vpls/importance-view.glsl` reads.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewImportance {
    block: Buffer,
    /// [`ViewSample`]s.
    samples: Buffer,
    /// Their [`ViewSampleLobe`]s.
    lobes: Buffer,
    /// Whether they are few enough for uniform blocks.
    few: bool,
    /// Importance of a texel for each unit of its power: a float.
    floor: Option<Buffer>,
    rsm: Rsm,
    glossy_receivers: bool,
    glossy_dielectric: bool,
    diffuse: bool,
}

impl TexelImportance {
    /// Importance by the config, with the view samples of this frame.
    pub(super) fn of(g: &mut Graph, rsm: &Rsm, gbuffer: &GBuffer, wants: &Wants, config: &VplsConfig) -> Self {
        match config.importance {
            Importance::View => Self::View(view(g, rsm, gbuffer, wants, config)),
            Importance::None | Importance::PassedFlux => Self::Same,
        }
    }

    /// Binds what the part "importance" of a pass reads.
    pub(super) fn bind<'g>(&self, pass: ComputePass<'g>) -> ComputePass<'g> {
        match self {
            Self::Same => pass.part("importance", "vpls/importance-none"),
            Self::View(view) => view.bind(pass.part("importance", "vpls/importance-view")),
        }
    }

    /// The importance map: a layered image of [`Format::R32Float`], a layer a map of the RSM.
    pub(super) fn map(&self, g: &mut Graph, rsm: &Rsm) -> Image {
        let map = g.layered_image("vpls/importance-map", Format::R32Float, rsm.size, rsm.layers);
        // A workgroup of 8 x 8 invocations has 4 x 4 texels for each.
        let groups = rsm.size.map(|n| n.div_ceil(32));
        self.bind(g.compute("vpls/importance-map"))
            .writes("importance", map)
            .params(&MapParams { size: rsm.size })
            .dispatch_groups([groups[0], groups[1], rsm.layers]);
        map
    }
}

impl ViewImportance {
    /// Binds what `glsl/vpls/importance-view.glsl` reads.
    fn bind<'g>(&self, pass: ComputePass<'g>) -> ComputePass<'g> {
        let pass = pass
            .reads("view_importance", self.block)
            .part("samples", if self.few { "vpls/samples-uniform" } else { "vpls/samples-storage" })
            .reads("view_samples", self.samples)
            .reads("view_lobes", self.lobes)
            .reads("lights", self.rsm.lights)
            .reads("rsm_depth", self.rsm.depth)
            .reads("rsm_normal", self.rsm.normal)
            .reads("rsm_flux", self.rsm.flux)
            .reads("rsm_albedo", self.rsm.albedo)
            .constant("GLOSSY_RECEIVERS", self.glossy_receivers)
            .constant("GLOSSY_DIELECTRIC", self.glossy_dielectric)
            .constant("DIFFUSE_VPLS", self.diffuse);
        let pass = match self.rsm.glossy {
            Some(glossy) => pass.part("gloss", "vpls/gloss-lobe").reads("rsm_specular", glossy.specular).reads("rsm_lobe", glossy.lobe),
            None => pass,
        };
        match self.floor {
            Some(floor) => pass.part("floor", "vpls/floor-power").reads("least", floor),
            None => pass,
        }
    }
}

/// Draws the view samples, and finds the floor of importance if a share of the VPLs goes by power.
fn view(g: &mut Graph, rsm: &Rsm, gbuffer: &GBuffer, wants: &Wants, config: &VplsConfig) -> ViewImportance {
    let importance = &config.view_importance;
    let (count, arriving) = (importance.samples, importance.light == ViewLight::Arriving);
    // They are read by twos.
    let even = count.next_multiple_of(2);
    // A uniform block has a fixed length.
    let length = even.max(UNIFORM_SAMPLES);
    let glossy_receivers = wants.glossy_receivers && !arriving;
    let samples = g.buffer::<ViewSample>("vpls/view-samples", length);
    let lobes = g.buffer::<ViewSampleLobe>("vpls/view-sample-lobes", length);
    // Not the axes that points are drawn along, so that samples and points are independent.
    let [_, _, across, down] = points::shift(wants.seed);
    g.compute("vpls/view-samples")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("albedo", gbuffer.albedo)
        .reads("metallic_roughness", gbuffer.metallic_roughness)
        .writes("view_samples", samples)
        .writes("view_lobes", lobes)
        .constant("WHITE", arriving)
        .constant("GLOSSY_RECEIVERS", glossy_receivers)
        .params(&ViewSamplesParams { shift: [across, down], count })
        .dispatch([even, 1, 1]);
    let min_distance = importance.min_distance.unwrap_or(wants.min_distance);
    let block = ViewImportanceBlock { samples: count, squared_min_distance: min_distance * min_distance };
    let view = ViewImportance {
        block: g.upload("vpls/view-importance", &[block]),
        samples,
        lobes,
        few: count <= UNIFORM_SAMPLES,
        floor: None,
        rsm: *rsm,
        glossy_receivers,
        glossy_dielectric: wants.dielectric == Dielectric::Ggx,
        diffuse: config.reflection != Reflection::Glossy,
    };
    if importance.defensive == 0.0 {
        return view;
    }
    let floor = g.buffer::<f32>("vpls/floor", 1);
    view.bind(g.compute("vpls/floor"))
        .writes("found", floor)
        .params(&FloorParams { size: rsm.size, lights: rsm.layers, share: importance.defensive })
        .dispatch_groups([1, 1, 1]);
    ViewImportance { floor: Some(floor), ..view }
}
