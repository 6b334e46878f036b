//! The engine's pipelines: made once for each shader, constants and targets, and held against every pass that uses them.

use super::Graph;
use super::check;
use super::engine::Engine;
use super::pass::{DrawList, Pass, Work};
use crate::gpu::{PipelineId, RasterState, Shader};
use crate::trace;
use anyhow::{Result, bail};

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct PipelineKey {
    pub shader: &'static str,
    pub constants: Vec<(&'static str, u32)>,
    pub raster: Option<RasterState>,
}

impl Engine {
    /// The pipeline of a pass, or of one of its draw lists, checked against what the pass declares.
    pub(super) fn pipeline(&mut self, graph: &Graph, pass: &Pass, list: Option<&DrawList>) -> Result<PipelineId> {
        let raster = match (&pass.work, list) {
            (Work::Compute(_), _) => None,
            (Work::Raster { .. }, None) => unreachable!("a raster pass has a pipeline for each of its lists"),
            (Work::Raster { color, depth, conservative, .. }, Some(list)) => Some(RasterState {
                vertex: list.vertex,
                color: color.iter().map(|target| target.image.format).collect(),
                depth: depth.map(|(image, _)| image.format),
                cull_back: list.cull_back,
                additive: color.iter().any(|target| target.additive),
                conservative: *conservative,
            }),
        };
        let mut constants = pass.constants.clone();
        constants.extend(list.iter().flat_map(|list| list.constants.iter().copied()));
        let key = PipelineKey { shader: pass.shader, constants, raster };
        let id = match self.pipelines.get(&key) {
            Some(id) => *id,
            None => {
                let id = self.make_pipeline(pass, &key)?;
                self.pipelines.insert(key.clone(), id);
                id
            }
        };
        // Another pass, or another frame, may declare itself differently over the same pipeline.
        check::bindings(graph, pass, list, self.gpu.bindings(id))?;
        let paths = match key.raster {
            Some(_) => self.library.raster_paths(pass.shader),
            None => vec![format!("{}.comp", pass.shader)],
        };
        let shaders = paths.iter().map(|path| self.library.get(path));
        check::params(pass, &shaders.map(|shader| shader.push_constants.as_ref()).collect::<Vec<_>>())?;
        if let Work::Raster { color, .. } = &pass.work {
            let fragment = paths.iter().find(|path| path.ends_with(".frag"));
            let mut outputs = fragment.map_or_else(Vec::new, |path| self.library.get(path).outputs.clone());
            outputs.sort_by_key(|(_, location)| *location);
            let outputs: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
            let declared: Vec<&str> = color.iter().map(|target| target.output).collect();
            if outputs != declared {
                bail!("pass {}: renders to {declared:?}, the shader's outputs are {outputs:?}", pass.name);
            }
        }
        Ok(id)
    }

    fn make_pipeline(&mut self, pass: &Pass, key: &PipelineKey) -> Result<PipelineId> {
        let _span = trace::span(format_args!("pipeline of {}", pass.name));
        let ids = |shader: &Shader| -> Vec<(u32, u32)> {
            let id = |name: &str| shader.constants.iter().find(|(known, _)| known == name).map(|(_, id)| *id);
            key.constants.iter().filter_map(|(name, value)| Some((id(name)?, *value))).collect()
        };
        let known = |name: &str, shaders: &[&Shader]| shaders.iter().any(|s| s.constants.iter().any(|(n, _)| n == name));
        let unknown = |shaders: &[&Shader]| key.constants.iter().map(|(name, _)| *name).find(|name| !known(name, shaders));
        match &key.raster {
            None => {
                let shader = self.library.get(&format!("{}.comp", pass.shader));
                if let Some(name) = unknown(&[shader]) {
                    bail!("pass {}: the shader has no specialization constant {name}", pass.name);
                }
                self.gpu.create_compute_pipeline(pass.name, shader, &ids(shader))
            }
            Some(state) => {
                let paths = self.library.raster_paths(pass.shader);
                let shaders: Vec<&Shader> = paths.iter().map(|path| self.library.get(path)).collect();
                if let Some(name) = unknown(&shaders) {
                    bail!("pass {}: the shaders have no specialization constant {name}", pass.name);
                }
                let shaders: Vec<_> = shaders.into_iter().map(|shader| (shader, ids(shader))).collect();
                self.gpu.create_raster_pipeline(pass.name, &shaders, state)
            }
        }
    }
}
