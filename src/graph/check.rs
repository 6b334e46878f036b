//! Checks of a pass's declarations against its shaders.

use super::pass::{DrawList, Pass, Use, Work};
use super::{Graph, Library, Resource, Source, Variant};
use crate::gpu::{Binding, BindingKind, Block, Shader, ShaderAccess};
use anyhow::{Context, Result, bail};
use std::collections::{BTreeMap, BTreeSet, HashSet};

fn verb(access: ShaderAccess) -> &'static str {
    match access {
        ShaderAccess::Read => "Read",
        ShaderAccess::Write => "Write",
        ShaderAccess::ReadWrite => "ReadWrite",
    }
}

/// Compares a pass's uses with the bindings of one of its pipelines.
pub(super) fn bindings(graph: &Graph, pass: &Pass, list: Option<&DrawList>, bindings: &BTreeMap<String, (u32, Binding)>) -> Result<()> {
    for (i, used) in pass.uses.iter().enumerate() {
        if pass.uses[..i].iter().any(|other| other.binding == used.binding) {
            bail!("pass {}: {:?} is declared twice", pass.name, used.binding);
        }
        let Some((_, binding)) = bindings.get(used.binding) else {
            bail!("pass {}: {:?} is declared {}, the shader does not use it", pass.name, used.binding, verb(used.access));
        };
        if used.access != binding.access {
            bail!("pass {}: {:?} declared {}, shader does {}", pass.name, used.binding, verb(used.access), verb(binding.access));
        }
        kind(graph, used, binding).with_context(|| format!("pass {}: {:?}", pass.name, used.binding))?;
    }
    for block in list.iter().flat_map(|list| &list.blocks) {
        if let Some((_, Binding { kind: BindingKind::UniformBlock(layout), .. })) = bindings.get(block.binding) {
            block.element.check(layout).with_context(|| format!("pass {}: {:?}", pass.name, block.binding))?;
        }
    }
    for name in bindings.keys() {
        let declared = pass.uses.iter().any(|used| used.binding == name);
        let textured = list.is_some_and(|list| list.textures.iter().any(|(binding, ..)| binding == name));
        let listed = list.is_some_and(|list| list.blocks.iter().any(|block| block.binding == name));
        if !declared && !textured && !listed {
            bail!("pass {}: the shader uses {name:?}, the pass does not declare it", pass.name);
        }
    }
    Ok(())
}

fn kind(graph: &Graph, used: &Use, binding: &Binding) -> Result<()> {
    match (&binding.kind, used.resource) {
        (BindingKind::UniformBlock(block) | BindingKind::StorageBlock(block), Resource::Buffer(buffer)) => {
            match graph.slots[buffer.index as usize].element {
                Some(element) => element.check(block),
                None => Ok(()),
            }
        }
        (BindingKind::Sampled { array } | BindingKind::StorageImage { array }, Resource::Image(image)) => {
            if image.layers > 1 && !array {
                bail!("{} has {} layers, the shader sees one", graph.name(used.resource), image.layers);
            }
            Ok(())
        }
        (_, resource) => bail!(
            "{} is {}, the shader has the other kind",
            graph.name(resource),
            if matches!(resource, Resource::Image(_)) { "an image" } else { "a buffer" }
        ),
    }
}

/// Compares a pass's push constants with its shaders' blocks.
pub(super) fn params(pass: &Pass, blocks: &[Option<&Block>]) -> Result<()> {
    let mut blocks = blocks.iter().flatten().peekable();
    match (&pass.params, blocks.peek().is_some()) {
        (Some((element, _)), true) => {
            blocks.try_for_each(|block| element.check(block)).with_context(|| format!("pass {}: params", pass.name))
        }
        (Some(_), false) => bail!("pass {}: params are given, the shader has none", pass.name),
        (None, true) => bail!("pass {}: the shader has params, none are given", pass.name),
        (None, false) => Ok(()),
    }
}

/// Compares a pass's parts with the slots of its shaders, before these are compiled.
pub(super) fn parts(pass: &Pass, variants: &[Variant], library: &Library) -> Result<()> {
    let mut slots = BTreeSet::new();
    for variant in variants {
        slots.extend(library.slots(variant).with_context(|| format!("pass {}", pass.name))?);
    }
    for (i, (slot, part)) in pass.parts.iter().enumerate() {
        if pass.parts[..i].iter().any(|(other, _)| other == slot) {
            bail!("pass {}: two parts are named for {slot:?}", pass.name);
        }
        if !slots.contains(slot) {
            bail!("pass {}: {part} is named for {slot:?}, the shader has no such slot", pass.name);
        }
    }
    Ok(())
}

/// Compares a pass's and a draw list's specialization constants with the shaders' declared ones. Unused constants count, since unoptimised
/// SPIR-V keeps them all.
pub(super) fn constants(pass: &Pass, given: &[(&str, u32)], shaders: &[&Shader]) -> Result<()> {
    let declared = || shaders.iter().flat_map(|shader| shader.constants.iter().map(|(name, _)| name.as_str()));
    if let Some((name, _)) = given.iter().find(|(name, _)| declared().all(|known| known != *name)) {
        bail!("pass {}: the shader has no specialization constant {name}", pass.name);
    }
    match declared().find(|name| given.iter().all(|(known, _)| known != name)) {
        Some(name) => bail!("pass {}: the shader has a specialization constant {name}, the pass does not set it", pass.name),
        None => Ok(()),
    }
}

/// Checks the order of passes: names are unique, nothing is read before it is written, imports are only read, and no pass uses a resource
/// in two ways.
pub(super) fn order(graph: &Graph) -> Result<()> {
    let mut names = HashSet::new();
    let mut written: BTreeSet<usize> = (0..graph.slots.len()).filter(|i| !matches!(graph.slots[*i].source, Source::Transient)).collect();
    for pass in &graph.passes {
        if !names.insert(pass.name) {
            bail!("pass {}: two passes of a frame have this name", pass.name);
        }
        let writes = pass.written();
        for used in pass.uses.iter().filter(|used| used.access != ShaderAccess::Write) {
            if !written.contains(&used.resource.index()) {
                bail!("pass {}: reads {} before any pass writes it", pass.name, graph.name(used.resource));
            }
        }
        if let Some(resource) = pass.kept().find(|resource| !written.contains(&resource.index())) {
            bail!("pass {}: renders over {} before any pass writes it", pass.name, graph.name(resource));
        }
        for resource in &writes {
            if matches!(graph.slots[resource.index()].source, Source::ImportedBuffer(_) | Source::ImportedImage(_)) {
                bail!("pass {}: writes {}, which is not the frame's own", pass.name, graph.name(*resource));
            }
            let uses = pass.uses.iter().filter(|used| used.resource.index() == resource.index()).count();
            let targets = writes.iter().filter(|other| other.index() == resource.index()).count();
            if uses > 1 || targets > 1 || (uses == 1 && matches!(pass.work, Work::Raster { .. }) && is_target(pass, *resource)) {
                bail!("pass {}: uses {} in two ways at once", pass.name, graph.name(*resource));
            }
        }
        if let Work::Raster { draws, .. } = &pass.work {
            for list in draws {
                let mut read = vec![("arguments", list.arguments), ("vertices", list.vertices)];
                read.extend(list.indices.map(|indices| ("indices", indices)));
                if let Some((what, _)) = read.iter().find(|(_, buffer)| !written.contains(&(buffer.index as usize))) {
                    bail!("pass {}: its draw {what} are read before any pass writes them", pass.name);
                }
            }
        }
        written.extend(writes.iter().map(|resource| resource.index()));
    }
    Ok(())
}

fn is_target(pass: &Pass, resource: Resource) -> bool {
    let Work::Raster { color, depth, .. } = &pass.work else { return false };
    color.iter().any(|target| target.image.index as usize == resource.index())
        || depth.iter().any(|(image, _)| image.index as usize == resource.index())
}
