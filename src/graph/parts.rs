//! Parts of shaders: what a pass has included in the slots that a shader leaves open.
//!
//! `#include "part/SLOT=DEFAULT"` is a slot: the part that the pass names for it is included there ([`ComputePass::part`]), or the default.
//! `#include "part/SLOT"` has no default. A part is a file below `glsl/` as any other, and may have slots itself. Parts give a shader
//! what specialization constants cannot: other bindings, formats and layouts.
//!
//! [`ComputePass::part`]: super::ComputePass::part

use std::fmt;

/// What fills a slot of a shader: the slot, and the part, a file below `glsl/` without its extension.
pub type Part = (&'static str, &'static str);

/// A shader as a pass wants it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Variant {
    /// Below `glsl/`, with its extension.
    pub path: String,
    /// What the pass fills slots with, whether the shader has these or not: a raster pass's stages get the same.
    pub parts: Vec<Part>,
}

impl From<&str> for Variant {
    /// With the defaults in all slots.
    fn from(path: &str) -> Self {
        Self { path: path.into(), parts: Vec::new() }
    }
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path)?;
        self.parts.iter().try_for_each(|(slot, part)| write!(f, " with {part} as {slot}"))
    }
}

/// The names in the `#include`s of a source.
pub(super) fn includes(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| line.trim_start().strip_prefix("#include")?.trim().strip_prefix('"')?.split('"').next())
}

/// The slot that an `#include` names, and its default.
pub(super) fn slot_of(name: &str) -> Option<(&str, Option<&str>)> {
    let slot = name.strip_prefix("part/")?;
    Some(slot.split_once('=').map_or((slot, None), |(slot, default)| (slot, Some(default))))
}

/// The path that an `#include` stands for; the error says which slot nothing fills.
pub(super) fn included(name: &str, parts: &[Part]) -> Result<String, String> {
    let Some((slot, default)) = slot_of(name) else { return Ok(name.to_owned()) };
    let named = parts.iter().find(|(known, _)| *known == slot).map(|(_, part)| *part);
    let part = named.or(default).ok_or_else(|| format!("its slot {slot:?} has no default, and no part is named for it"))?;
    Ok(format!("{part}.glsl"))
}
