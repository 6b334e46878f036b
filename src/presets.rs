//! The configs in the binary: `configs/*.toml`, embedded, so that they render by name from any folder.

use include_dir::{Dir, include_dir};
use std::path::Path;

static CONFIGS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/configs");

/// Name and text of every preset, sorted by name.
pub fn all() -> Vec<(&'static str, &'static str)> {
    texts(&CONFIGS)
}

/// Name and text of every table (`configs/tables/*.toml`), sorted by name.
pub fn tables() -> Vec<(&'static str, &'static str)> {
    CONFIGS.get_dir("tables").map(texts).unwrap_or_default()
}

/// Name and text of every view (`configs/views/*.toml`), sorted by name. A view has a scene that does not come with the
/// program, a camera and its light.
pub fn views() -> Vec<(&'static str, &'static str)> {
    CONFIGS.get_dir("views").map(texts).unwrap_or_default()
}

fn texts(folder: &'static Dir<'static>) -> Vec<(&'static str, &'static str)> {
    let mut presets: Vec<_> = folder
        .files()
        .filter(|file| file.path().extension().is_some_and(|extension| extension == "toml"))
        .filter_map(|file| Some((file.path().file_stem()?.to_str()?, file.contents_utf8()?)))
        .collect();
    presets.sort_unstable();
    presets
}

/// Text of a preset.
pub fn find(name: &str) -> Option<&'static str> {
    all().into_iter().find(|(known, _)| *known == name).map(|(_, text)| text)
}

/// Text of a preset, unless a file has taken its place. A folder of its name has not.
pub fn find_unless(name: &str, file: &Path) -> Option<&'static str> {
    find(name).filter(|_| !file.exists() || file.is_dir())
}

/// Title of a preset: its first comment.
pub fn title(text: &str) -> &str {
    text.lines().next().and_then(|line| line.strip_prefix('#')).map_or("", str::trim)
}
