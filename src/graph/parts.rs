//! Parts of shaders: files that a pass includes in slots of its shaders.
//!
//! `#include "part/SLOT=DEFAULT"` is a slot: the part that the pass names for it ([`ComputePass::part`]) is included, or the default.
//! `#include "part/SLOT"` has no default. A part is a file below `glsl/`, and may have slots itself. Parts can change bindings, formats and
//! layouts, which specialization constants cannot.
//!
//! [`ComputePass::part`]: super::ComputePass::part

use std::fmt;

/// A slot, and the part that fills it: a file below `glsl/`, without its extension.
pub type Part = (&'static str, &'static str);

/// A shader with its parts.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Variant {
    /// Path below `glsl/`, with its extension.
    pub path: String,
    /// Parts that the pass names, even those for slots that this shader lacks: all stages of a raster pass get the same.
    pub parts: Vec<Part>,
}

impl From<&str> for Variant {
    /// A shader with the default parts in all slots.
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

/// Names in the `#include`s of a source.
pub(super) fn includes(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| line.trim_start().strip_prefix("#include")?.trim().strip_prefix('"')?.split('"').next())
}

/// Slot that an `#include` names, and its default.
pub(super) fn slot_of(name: &str) -> Option<(&str, Option<&str>)> {
    let slot = name.strip_prefix("part/")?;
    Some(slot.split_once('=').map_or((slot, None), |(slot, default)| (slot, Some(default))))
}

/// Path of an `#include`; the error names a slot that nothing fills.
pub(super) fn included(name: &str, parts: &[Part]) -> Result<String, String> {
    let Some((slot, default)) = slot_of(name) else { return Ok(name.to_owned()) };
    let named = parts.iter().find(|(known, _)| *known == slot).map(|(_, part)| *part);
    let part = named.or(default).ok_or_else(|| format!("its slot {slot:?} has no default, and no part is named for it"))?;
    Ok(format!("{part}.glsl"))
}
