//! Requirements of later stages on earlier ones: a value, so that no stage reads another's keys.

use super::interleave::Interleave;
use crate::config::{Config, Dielectric, GatherMethod, Importance, Reflection, VisibilityMethod, VplSampler};

/// Requirements of later stages; computed once a frame.
#[derive(Debug, Clone, Copy)]
pub struct Wants {
    /// Glossy VPLs, for which the RSM stores GGX reflectance.
    pub glossy: bool,
    /// GGX at what the camera sees.
    pub glossy_receivers: bool,
    /// Texels of the RSM a VPL: the footprint over which albedo is averaged. 1 for samplers whose VPLs stand for no neighbourhood.
    pub texels_per_vpl: f64,
    /// Areas of the VPLs' texels, for which VPLs are area lights.
    pub disks: bool,
    /// Clusters of VPLs with their maps, even if no further bounce starts from them.
    pub clusters: bool,
    /// Visibility of the first bounce's VPLs, and of further ones.
    pub visibility: [VisibilityMethod; 2],
    /// Number of imperfect shadow maps that the first bounce's VPLs share; `None`: one for each VPL.
    pub shared_maps: Option<u32>,
    /// The pattern of the gather's sample sets.
    pub interleave: Interleave,
    /// Reflection model of dielectrics.
    pub dielectric: Dielectric,
    /// Distance below which a VPL gets no brighter, metres.
    pub min_distance: f32,
    /// Seed of all random numbers.
    pub seed: u32,
}

impl Wants {
    /// Requirements of a config's stages on an RSM of `layers` layers.
    pub fn of(config: &Config, layers: u32) -> Self {
        let [width, height] = config.rsm.size;
        Self {
            glossy: config.vpls.reflection != Reflection::Diffuse,
            glossy_receivers: config.gather.has_glossy_receivers(),
            texels_per_vpl: match (config.vpls.sampler, config.vpls.importance) {
                (VplSampler::Regular | VplSampler::Hammersley, Importance::None | Importance::PassedFlux) => {
                    f64::from(width) * f64::from(height) * f64::from(layers) / f64::from(config.vpl_count(layers))
                }
                _ => 1.0,
            },
            disks: config.gather.method == GatherMethod::LightCaches,
            clusters: config.visibility.method == VisibilityMethod::Clusters,
            visibility: config.visibility_of_bounces(),
            shared_maps: config.shared_maps(),
            interleave: Interleave::of(config.gather.interleave),
            dielectric: config.materials.dielectric,
            min_distance: config.gather.min_distance,
            seed: config.frame.seed,
        }
    }

    /// Visibility method of a bounce; the first is 1.
    pub fn visibility_of(&self, bounce: u32) -> VisibilityMethod {
        self.visibility[usize::from(bounce > 1)]
    }
}
