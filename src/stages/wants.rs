//! What later stages want of earlier ones: a value, so that no stage reads another's keys.

use super::interleave::Interleave;
use crate::config::{Config, Dielectric, Reflection, VisibilityMethod};

/// See the module's page; worked out once a frame.
#[derive(Debug, Clone, Copy)]
pub struct Wants {
    /// Glossy VPLs, which the RSM must have texels for.
    pub glossy: bool,
    /// Texels of the RSM that a VPL stands for, over which its albedo is averaged.
    pub texels_per_vpl: f64,
    /// Clusters of VPLs, and their maps, even where no further bounce starts from them.
    pub clusters: bool,
    /// What the first bounce's VPLs, and those of further ones, are shadowed by.
    pub visibility: [VisibilityMethod; 2],
    /// Imperfect shadow maps that the first bounce's VPLs share; each has one of its own where this is `None`.
    pub shared_maps: Option<u32>,
    /// The pattern of the gather's sample sets.
    pub interleave: Interleave,
    /// How surfaces that are no metals reflect.
    pub dielectric: Dielectric,
    /// The seed of what is random.
    pub seed: u32,
}

impl Wants {
    /// What a config's stages want, where the RSM has so many layers.
    pub fn of(config: &Config, layers: u32) -> Self {
        let [width, height] = config.rsm.size;
        Self {
            glossy: config.vpls.reflection != Reflection::Diffuse,
            texels_per_vpl: f64::from(width) * f64::from(height) * f64::from(layers) / f64::from(config.vpl_count(layers)),
            clusters: config.visibility.method == VisibilityMethod::Clusters,
            visibility: config.visibility_of_bounces(),
            shared_maps: config.shared_maps(),
            interleave: Interleave::square(config.gather.interleave),
            dielectric: config.materials.dielectric,
            seed: config.frame.seed,
        }
    }

    /// What the VPLs of a bounce are shadowed by; the first is 1.
    pub fn visibility_of(&self, bounce: u32) -> VisibilityMethod {
        self.visibility[usize::from(bounce > 1)]
    }
}
