//! The engine's pipelines: made once for each combination of shader, parts, constants and targets, and checked against every pass that uses
//! them.

use super::check;
use super::engine::Engine;
use super::pass::{DrawList, Pass, Work};
use super::{Graph, Part, Variant};
use crate::gpu::{Blend, PipelineId, RasterState, Shader, ShaderStage};
use crate::trace;
use anyhow::{Result, bail};
use std::collections::BTreeSet;

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct PipelineKey {
    pub shader: &'static str,
    pub parts: Vec<Part>,
    pub constants: Vec<(&'static str, u32)>,
    pub raster: Option<RasterState>,
}

impl Engine {
    /// Shaders of a pass, one a stage.
    fn variants(&self, pass: &Pass) -> Vec<Variant> {
        let paths = match pass.work {
            Work::Compute(_) => vec![format!("{}.comp", pass.shader)],
            Work::Raster { .. } => self.library.raster_paths(pass.shader),
        };
        paths.into_iter().map(|path| Variant { path, parts: pass.parts.clone() }).collect()
    }

    /// Compiles the graph's shaders with the parts of its passes.
    pub(super) fn compile(&mut self, graph: &Graph) -> Result<()> {
        let mut wanted = BTreeSet::new();
        for pass in &graph.passes {
            let variants = self.variants(pass);
            if !variants.iter().all(|variant| self.library.is_prepared(variant)) {
                check::parts(pass, &variants, &self.library)?;
            }
            wanted.extend(variants);
        }
        self.library.prepare(&wanted)
    }

    /// Pipeline of a pass, or of one of its draw lists, checked against the pass's declaration.
    pub(super) fn pipeline(&mut self, graph: &Graph, pass: &Pass, list: Option<&DrawList>) -> Result<PipelineId> {
        let raster = match (&pass.work, list) {
            (Work::Compute(_), _) => None,
            (Work::Raster { .. }, None) => unreachable!("a raster pass has a pipeline for each of its lists"),
            (Work::Raster { color, depth, conservative, .. }, Some(list)) => Some(RasterState {
                vertex: list.vertex,
                color: color.iter().map(|target| target.image.format).collect(),
                depth: depth.map(|(image, _)| image.format),
                cull_back: list.cull_back,
                blend: color.iter().map(|target| target.blend).find(|blend| *blend != Blend::Replace).unwrap_or_default(),
                conservative: *conservative,
                points: list.indices.is_none(),
            }),
        };
        let mut constants = pass.constants.clone();
        constants.extend(list.iter().flat_map(|list| list.constants.iter().copied()));
        let key = PipelineKey { shader: pass.shader, parts: pass.parts.clone(), constants, raster };
        let variants = self.variants(pass);
        let id = match self.pipelines.get(&key) {
            Some(id) => *id,
            None => {
                let id = self.make_pipeline(pass, &variants, &key)?;
                self.pipelines.insert(key, id);
                id
            }
        };
        // Checked each time: another pass, or another frame, may use the same pipeline with another declaration.
        check::bindings(graph, pass, list, self.gpu.bindings(id))?;
        let shaders: Vec<&Shader> = variants.iter().map(|variant| self.library.get(variant)).collect();
        check::params(pass, &shaders.iter().map(|shader| shader.push_constants.as_ref()).collect::<Vec<_>>())?;
        if let Work::Raster { color, .. } = &pass.work {
            let fragment = shaders.iter().find(|shader| shader.stage == ShaderStage::Fragment);
            let mut outputs = fragment.map_or_else(Vec::new, |shader| shader.outputs.clone());
            outputs.sort_by_key(|(_, location)| *location);
            let outputs: Vec<&str> = outputs.iter().map(|(name, _)| name.as_str()).collect();
            let declared: Vec<&str> = color.iter().map(|target| target.output).collect();
            if outputs != declared {
                bail!("pass {}: renders to {declared:?}, the shader's outputs are {outputs:?}", pass.name);
            }
        }
        Ok(id)
    }

    fn make_pipeline(&mut self, pass: &Pass, variants: &[Variant], key: &PipelineKey) -> Result<PipelineId> {
        let _span = trace::span(format_args!("pipeline of {}", pass.name));
        let shaders: Vec<&Shader> = variants.iter().map(|variant| self.library.get(variant)).collect();
        check::constants(pass, &key.constants, &shaders)?;
        let ids = |shader: &Shader| -> Vec<(u32, u32)> {
            let id = |name: &str| shader.constants.iter().find(|(known, _)| known == name).map(|(_, id)| *id);
            key.constants.iter().filter_map(|(name, value)| Some((id(name)?, *value))).collect()
        };
        let shaders: Vec<_> = shaders.into_iter().map(|shader| (shader, ids(shader))).collect();
        match &key.raster {
            None => self.gpu.create_compute_pipeline(pass.name, shaders[0].0, &shaders[0].1),
            Some(state) => self.gpu.create_raster_pipeline(pass.name, &shaders, state),
        }
    }
}
