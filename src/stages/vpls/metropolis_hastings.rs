//! Independent Metropolis-Hastings sampling: a chain a VPL (Barák, Bittner and Havran 2013, section 4.3).

use super::super::rsm::Rsm;
use super::importance::{AT_ONCE, TexelImportance};
use super::inverse_transform::Cumulative;
use super::points::{self, TexelParams};
use crate::config::{Acceptance, Evaluate, MetropolisHastingsConfig, Scan, VplsConfig, Weights};
use crate::graph::{Buffer, ComputePass, Graph, Image};

/// Importance that the chains look up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Proposed {
    importance: Source,
    /// Running sums of the maps' importance, for a weight that all chains share.
    maps: Option<Buffer>,
}

#[derive(Debug, Clone, Copy)]
enum Source {
    /// A float a proposal, step by step.
    Proposals(Buffer),
    Map(Image),
}

/// Works out the importance of the chains' proposals, or of all texels.
pub(super) fn propose(g: &mut Graph, importance: &TexelImportance, rsm: &Rsm, params: &TexelParams, config: &VplsConfig) -> Proposed {
    let chains = &config.metropolis_hastings;
    if chains.weights == Weights::None {
        let cumulative = Cumulative::of(g, importance, rsm, Scan::Blocked);
        return Proposed { importance: Source::Map(cumulative.importance), maps: Some(cumulative.maps) };
    }
    let source = match chains.evaluate {
        Evaluate::Map => Source::Map(importance.map(g, rsm)),
        Evaluate::Proposals => {
            let proposed = g.buffer::<f32>("vpls/proposed", params.count * chains.steps);
            importance
                .bind(g.compute("vpls/proposals"))
                .part("points", points::part(config))
                .writes("proposed", proposed)
                .params(params)
                .dispatch([params.count.div_ceil(AT_ONCE), chains.steps, 1]);
            Source::Proposals(proposed)
        }
    };
    Proposed { importance: source, maps: None }
}

impl Proposed {
    /// Binds what the chains read.
    pub(super) fn bind<'g>(&self, pass: ComputePass<'g>, config: &MetropolisHastingsConfig) -> ComputePass<'g> {
        let weights = match config.weights {
            Weights::Mean => 0,
            Weights::Single => 1,
            Weights::None => 2_u32,
        };
        let pass = pass
            .constant("STEPS", config.steps)
            .constant("RESERVOIR", config.acceptance == Acceptance::Reservoir)
            .constant("WEIGHTS", weights);
        let pass = match self.importance {
            Source::Proposals(proposed) => pass.part("proposed", "vpls/proposed-alone").reads("proposed", proposed),
            Source::Map(map) => pass.part("proposed", "vpls/proposed-map").reads("importance", map),
        };
        match self.maps {
            Some(maps) => pass.part("weight", "vpls/weight-common").reads("maps", maps),
            None => pass,
        }
    }
}
