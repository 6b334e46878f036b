//! The container: the chunks of a .glb, the JSON, its version and its extensions.

use super::{Warning, Warnings, refuse};
use anyhow::Result;
use gltf_json::Root;

/// The extensions that the loader implements.
const KNOWN_EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization", "KHR_texture_transform"];

/// The parts of a file: its JSON, and the binary chunk of a .glb that has one.
pub struct Container<'a> {
    pub json: &'a [u8],
    pub bin: Option<&'a [u8]>,
}

/// Splits a file. Bytes that do not begin as a .glb are taken as the JSON of a .gltf.
pub fn split(bytes: &[u8]) -> Result<Container<'_>> {
    if !bytes.starts_with(b"glTF") {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if !json.trim_ascii_start().starts_with(b"{") {
            refuse!("it is not a glTF file: it begins neither as a .glb nor as JSON");
        }
        return Ok(Container { json, bin: None });
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        refuse!("it ends within the header of a .glb");
    };
    if version != 2 {
        refuse!("it is a .glb of version {version}, only version 2 is supported");
    }
    let Some(mut rest) = bytes.get(12..length as usize) else {
        refuse!("its header says {length} bytes, but it has {}: it is truncated or damaged", bytes.len());
    };
    let (mut json, mut bin) = (None, None);
    while let (Some(length), Some(kind)) = (word(rest, 0), rest.get(4..8)) {
        let Some(chunk) = rest[8..].get(..length as usize) else {
            refuse!("its chunk {:?} says {length} bytes, but only {} are left", String::from_utf8_lossy(kind), rest.len() - 8);
        };
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if bin.is_none() && json.is_some() => bin = Some(chunk),
            // Chunks of other kinds belong to extensions.
            _ => {}
        }
        rest = &rest[8 + chunk.len()..];
    }
    let Some(json) = json else {
        refuse!("it is a .glb without a JSON chunk");
    };
    Ok(Container { json, bin })
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// Parses the JSON, and checks the version and the required extensions.
pub fn parse(json: &[u8], warnings: &mut Warnings) -> Result<Root> {
    let root = match Root::from_slice(json) {
        Ok(root) => root,
        Err(error) => refuse!("its JSON is not that of a glTF 2.0 file: {error}"),
    };
    let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if version != "2.0" && (root.asset.min_version.is_some() || !version.starts_with("2.")) {
        refuse!("it needs glTF {version}, only glTF 2.0 is supported");
    }
    let unknown = |name: &&String| !KNOWN_EXTENSIONS.contains(&name.as_str());
    let required: Vec<_> = root.extensions_required.iter().filter(unknown).map(String::as_str).collect();
    if !required.is_empty() {
        refuse!("it requires the extension {}, which is not supported", required.join(", "));
    }
    let mut used: Vec<_> = root.extensions_used.iter().filter(unknown).map(String::as_str).collect();
    used.sort_unstable();
    used.dedup();
    if !used.is_empty() {
        warnings.add(Warning::Extension, format!("what these extensions add is left out, they are not supported: {}", used.join(", ")));
    }
    Ok(root)
}
