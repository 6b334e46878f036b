//! Which VPLs a point sees.

use super::vpls::Vpls;
use crate::config::{VisibilityConfig, VisibilityMethod};
use crate::graph::Graph;

/// What the gather tests a VPL's visibility with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Nothing hides anything.
    None,
}

/// Fills the slot with the config's method.
pub fn render(_g: &mut Graph, _vpls: &Vpls, config: &VisibilityConfig) -> Visibility {
    match config.method {
        VisibilityMethod::None => Visibility::None,
    }
}
