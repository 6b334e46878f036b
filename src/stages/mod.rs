//! The slots of the frame: a module each, named as its folder of shaders. A method that fills a slot is a function with typed
//! inputs and outputs; what a stage makes exists only as what it returns.

pub mod bounce;
pub mod compose;
pub mod direct;
pub mod filter;
pub mod gather;
pub mod gbuffer;
pub mod rsm;
pub mod ssao;
pub mod visibility;
pub mod vpls;

use crate::config::Config;
use crate::gpu::{Adapter, Feature};
use crate::scene::shells::CONSERVATIVE;
use std::collections::BTreeMap;

/// A way to fill a slot, by its name in the config, and what a device must have for it.
pub struct Method {
    pub slot: &'static str,
    pub name: &'static str,
    pub needs: &'static [Feature],
}

impl Method {
    /// What the device lacks for it; what is left to the program may be had by the extension instead.
    pub fn missing(&self, adapter: &Adapter) -> Vec<Feature> {
        let instead = self.name == "automatic" && adapter.missing(CONSERVATIVE).is_empty();
        if instead { Vec::new() } else { adapter.missing(self.needs) }
    }
}

/// Every method there is.
pub const METHODS: &[Method] = {
    use Feature::{
        BlendedRgba32Float, ClipDistance, FilteredRg32Float, FragmentStores, GeometryShader, LargePoints, LayerFromVertexShader,
        MultiDrawIndirect, ShaderDrawParameters, Snorm16Images, SubgroupBallot, TessellationShader, VertexPipelineStores,
    };
    const fn method(slot: &'static str, name: &'static str, needs: &'static [Feature]) -> Method {
        Method { slot, name, needs }
    }
    &[
        method("gbuffer", "draw", &[MultiDrawIndirect, ShaderDrawParameters, Snorm16Images]),
        method("rsm", "draw", &[MultiDrawIndirect, ShaderDrawParameters, LayerFromVertexShader, Snorm16Images]),
        method("vpls.sampler", "regular", &[]),
        method("vpls.sampler", "hammersley", &[]),
        method("vpls.sampler", "every-texel", &[]),
        method(
            "bounce.layers",
            "instanced",
            &[MultiDrawIndirect, ShaderDrawParameters, ClipDistance, LayerFromVertexShader, Snorm16Images],
        ),
        method("bounce.layers", "geometry-shader", &[MultiDrawIndirect, ShaderDrawParameters, ClipDistance, GeometryShader, Snorm16Images]),
        method(
            "bounce.layers",
            "per-layer",
            &[MultiDrawIndirect, ShaderDrawParameters, ClipDistance, LayerFromVertexShader, Snorm16Images],
        ),
        method("visibility.method", "none", &[]),
        method("visibility.method", "ray-traced", &[]),
        method("visibility.method", "imperfect-shadow-maps", &[]),
        method("visibility.method", "clusters", &[]),
        method("visibility.points", "uniform", &[]),
        method("visibility.points", "adaptive", &[]),
        method("visibility.collect", "compute", &[]),
        method("visibility.collect", "tessellation", &[TessellationShader, GeometryShader, VertexPipelineStores]),
        method("visibility.renderer", "single-pixel", &[]),
        method("visibility.renderer", "splat", &[TessellationShader, GeometryShader, LargePoints]),
        method("gather.method", "per-pixel", &[SubgroupBallot]),
        method("gather.culling", "none", &[]),
        method("gather.culling", "tiled", &[]),
        method("gather.culling", "clustered", &[]),
        method("gather.culling", "stochastic-tiled", &[]),
        method("gather.culling", "splatting", &[MultiDrawIndirect, ClipDistance, BlendedRgba32Float]),
        method("gather.culling", "conservative-clusters", &[MultiDrawIndirect, FragmentStores]),
        method("gather.rasterization", "automatic", &[GeometryShader]),
        method("gather.rasterization", "geometry-shader", &[GeometryShader]),
        method("gather.rasterization", "extension", CONSERVATIVE),
        method("filter.kind", "bilateral", &[]),
        method("filter.kind", "gaussian", &[]),
        method("filter.kind", "cross-bilateral", &[]),
        method("filter.kind", "none", &[]),
        method("direct.shadows", "variance", &[FilteredRg32Float]),
        method("direct.shadows", "percentage-closer", &[]),
        method("direct.shadows", "ray-traced", &[]),
        method("direct.shadows", "none", &[]),
        method("ssao.method", "none", &[]),
        method("ssao.method", "horizons", &[FilteredRg32Float]),
        method("compose", "sum", &[]),
        method("reference", "path", &[]),
    ]
};

/// Slots that are in use only where VPLs are put into clusters.
pub const OF_CLUSTERS: &[&str] = &["bounce.layers"];

/// Slots that are in use only where light lists of clusters are made by rasterization.
pub const OF_SHELLS: &[&str] = &["gather.rasterization"];

/// Slots that are in use only where VPLs have imperfect shadow maps.
pub const OF_MAPS: &[&str] = &["visibility.points", "visibility.collect", "visibility.renderer"];

/// The stages by name, in the frame's order: what stands before the slash in the name of a pass.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = METHODS.iter().map(|method| method.slot.split('.').next().unwrap_or(method.slot)).collect();
    names.dedup();
    names
}

/// What follows from what a frame's passes counted, by name: means a pixel, and shares.
pub fn means(counts: &BTreeMap<String, u64>) -> BTreeMap<String, f64> {
    gather::means(counts)
}

/// What a user should know who renders a config's sequence in parts.
pub fn warnings_of_parts(config: &Config) -> Vec<String> {
    bounce::warning_of_parts(config).into_iter().collect()
}
