//! Loading of a config: files and `--set` options to a checked config, and back to TOML.

use super::tree::{Lines, Node, Origin, Source, Table, Value, overlay};
use super::{Config, check, overrides, rules, scene, unused};
use crate::fail;
use crate::presets;
use anyhow::Result;
use serde::Deserialize;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use toml::de::DeTable;

/// Larger files are no configs, but pictures given by mistake.
const LARGEST_FILE: u64 = 1 << 20;
/// A chain of bases that is longer is a mistake.
const MOST_FILES: usize = 16;

/// A config, with warnings for its author.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    pub config: Config,
    /// One sentence for each given key that is not used, with file and line.
    pub warnings: Vec<String>,
}

/// Loads a config file with its bases, then applies `overrides` (`key=value`) in order.
///
/// Every error is one sentence with file, line and key, and ends the program with [`crate::error::Exit::BadInput`].
pub fn load(path: &Path, overrides: &[String]) -> Result<Loaded> {
    let (loaded, root) = resolve(&read(path)?, path, overrides)?;
    files_are_there(&loaded.config, &root)?;
    Ok(loaded)
}

/// Refuses a scene or an environment's map that is no file.
fn files_are_there(config: &Config, root: &Node) -> Result<()> {
    let scene = config.scene.file.as_deref().map(|file| ("scene.file".to_owned(), file));
    let Some((key, file)) = scene.into_iter().chain(config.sky_map()).find(|(_, file)| !file.is_file()) else { return Ok(()) };
    let what = if file.exists() { "is not a file" } else { "does not exist" };
    Err(rules::error_at(root, &key, format_args!("{} {what}", shown(file))))
}

/// Loads a text as if it were the file `origin`; reads no file but the bases.
pub fn parse(text: &str, origin: &Path, overrides: &[String]) -> Result<Loaded> {
    Ok(resolve(text, origin, overrides)?.0)
}

/// Loads a preset's text; reads no file. `origin` is its name in messages.
pub fn parse_preset(text: &str, origin: &Path, overrides: &[String]) -> Result<Loaded> {
    Ok(resolve_over(chain(text, origin, true)?, overrides)?.0)
}

/// The config as TOML that loads again to the same value. Keys that are not used are left out where they have their default.
pub fn to_toml(config: &Config) -> String {
    let text = toml::Table::try_from(config).and_then(|mut values| {
        unused::forget(config, &mut values);
        values.iter_mut().for_each(|(_, value)| shorten(value));
        toml::to_string(&values)
    });
    text.unwrap_or_else(|error| unreachable!("a config is tables of plain data: {error}"))
}

/// Numbers have 32 bits and need no more digits.
fn shorten(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) => *number = (*number as f32).to_string().parse().unwrap_or(*number),
        toml::Value::Array(items) => items.iter_mut().for_each(shorten),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| shorten(value)),
        _ => {}
    }
}

fn resolve(text: &str, path: &Path, overrides: &[String]) -> Result<(Loaded, Node)> {
    resolve_over(chain(text, path, false)?, overrides)
}

fn resolve_over(mut root: Node, overrides: &[String]) -> Result<(Loaded, Node)> {
    for text in overrides {
        overrides::apply(&mut root, text)?;
    }
    finish(root)
}

/// Checks and types a merged tree.
fn finish(mut root: Node) -> Result<(Loaded, Node)> {
    let Value::Table(table) = &mut root.value else { unreachable!("a document is a table") };
    check::table(table, "", "")?;
    scene::given(table)?;
    absolute_paths(table)?;
    let mut config = match Config::deserialize(root.clone().into_toml()) {
        Ok(config) => config,
        Err(error) => unreachable!("the schema lets through what the types refuse: {error}"),
    };
    if config.scene.file.is_some() {
        config.scene.builtin = None;
    }
    rules::check(&config, &root)?;
    let warnings = unused::warnings(&config, &root);
    Ok((Loaded { config, warnings }, root))
}

/// A config that others are derived from, as the cells of a table are.
pub(crate) struct Base(Node);

impl Base {
    /// The config at a path with its bases.
    pub fn load(path: &Path) -> Result<Self> {
        Self::parse(&read(path)?, path)
    }

    /// Parses a text as if it were the file `path`.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        Ok(Self(chain(text, path, false)?))
    }

    /// Parses a preset's text.
    pub fn parse_preset(text: &str, path: &Path) -> Result<Self> {
        Ok(Self(chain(text, path, true)?))
    }

    /// The config with some trees laid over it, each above the one before, then the `--set` options.
    pub fn with(&self, trees: &[&Node], overrides: &[String]) -> Result<Loaded> {
        let mut root = self.0.clone();
        for (i, tree) in trees.iter().enumerate() {
            overlay(&mut root, tree.in_layer(MOST_FILES + 1 + i), "");
        }
        for text in overrides {
            overrides::apply(&mut root, text)?;
        }
        let (loaded, root) = finish(root)?;
        files_are_there(&loaded.config, &root)?;
        Ok(loaded)
    }
}

/// A TOML file's tree, with the line of each value; for files that are no configs themselves.
pub(crate) fn document(text: &str, path: &Path) -> Result<Node> {
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let source = Rc::new(Source { name: shown(path), folder, layer: MOST_FILES });
    tree(text, source)
}

/// The text of a TOML file.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    read(path)
}

/// The file's tree, or the preset's, over that of its base, and so on down.
fn chain(text: &str, path: &Path, is_preset: bool) -> Result<Node> {
    let mut files = vec![path.to_path_buf()];
    let (mut root, mut base) = config_document(text, path, MOST_FILES, is_preset)?;
    while let Some((origin, Below { path: base_path, preset })) = base {
        let names = || files.iter().chain([&base_path]).map(|file| shown(file)).collect::<Vec<_>>().join(" -> ");
        let same = |file: &PathBuf| match (file.canonicalize(), base_path.canonicalize()) {
            (Ok(file), Ok(base)) => file == base,
            _ => file == &base_path,
        };
        // A preset is no file, even if one has its name.
        if preset.is_none() && files.iter().any(same) {
            return Err(check::error(&origin, "base", format_args!("the chain of bases is a circle: {}", names())));
        }
        if files.len() == MOST_FILES {
            return Err(check::error(&origin, "base", format_args!("the chain of bases is longer than {MOST_FILES} files")));
        }
        let text = match preset {
            Some(text) => text.to_owned(),
            None => read(&base_path).map_err(|error| check::error(&origin, "base", error))?,
        };
        let (mut below, next) = config_document(&text, &base_path, MOST_FILES - files.len(), preset.is_some())?;
        files.push(base_path);
        overlay(&mut below, root, "");
        root = below;
        base = next;
    }
    Ok(root)
}

/// What a file starts from.
struct Below {
    path: PathBuf,
    /// Text of the preset of this name, where there is no such file.
    preset: Option<&'static str>,
}

impl Below {
    /// A file by its path from a folder, or a preset by its name or file name. A preset starts from presets, whatever files of their names
    /// stand in the folder.
    fn named(name: &str, folder: &Path, in_preset: bool) -> Self {
        let path = folder.join(name);
        let preset = name.strip_suffix(".toml").unwrap_or(name);
        match if in_preset { presets::find(preset) } else { presets::find_unless(preset, &path) } {
            Some(text) => Self { path: Path::new(name).with_extension("toml"), preset: Some(text) },
            None => Self { path, preset: None },
        }
    }
}

/// One file's tree and, apart from it, the base that it names.
fn config_document(text: &str, path: &Path, layer: usize, is_preset: bool) -> Result<(Node, Option<(Origin, Below)>)> {
    let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let source = Rc::new(Source { name: shown(path), folder: folder.clone(), layer });
    let mut root = tree(text, source)?;
    let Value::Table(table) = &mut root.value else { unreachable!("a document is a table") };
    let base = match table.remove("base") {
        None => None,
        Some(Node { origin, value: Value::Text(base) }) if !base.is_empty() => Some((origin, Below::named(&base, &folder, is_preset))),
        Some(node) => return Err(check::error(&node.origin, "base", format_args!("expects the path of a config, found {}", node.found()))),
    };
    Ok((root, base))
}

fn tree(text: &str, source: Rc<Source>) -> Result<Node> {
    let lines = Lines::new(source.clone(), text);
    let table = DeTable::parse(text).map_err(|error| {
        let start = error.span().map_or(text.len(), |span| span.start);
        let message = error.message().replace('\n', ", ");
        fail!(BadInput, "{}, column {}: not valid TOML: {message}", lines.origin(start), lines.column(start))
    })?;
    Ok(Node { origin: Origin { source, line: 0 }, value: Value::Table(lines.table(table.get_ref())) })
}

/// A path on one line, with control characters escaped.
fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    if text.contains(char::is_control) { text.escape_debug().to_string() } else { text }
}

fn read(path: &Path) -> Result<String> {
    let shown = shown(path);
    let metadata = path.metadata().map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => fail!(BadInput, "{shown}: there is no such file"),
        _ => fail!(BadInput, "{shown}: cannot be read: {error}"),
    })?;
    if !metadata.is_file() {
        return Err(fail!(BadInput, "{shown}: is not a file"));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes))
        .map_err(|error| fail!(BadInput, "{shown}: cannot be read: {error}"))?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(fail!(BadInput, "{shown}: is larger than 1 MiB, which no config is"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
        fail!(BadInput, "{shown}:{line}: is not UTF-8 text")
    })
}

/// Makes `scene.file` and the maps of lights absolute, each relative to the folder of the file that gives it.
fn absolute_paths(root: &mut Table) -> Result<()> {
    if let Some(Node { value: Value::Table(scene), .. }) = root.get_mut("scene") {
        absolute_path(scene.get_mut("file"), "scene.file")?;
    }
    if let Some(Node { value: Value::List(lights), .. }) = root.get_mut("light") {
        for (index, light) in lights.iter_mut().enumerate() {
            let Value::Table(light) = &mut light.value else { continue };
            absolute_path(light.get_mut("map"), &format!("light.{index}.map"))?;
        }
    }
    Ok(())
}

fn absolute_path(file: Option<&mut Node>, key: &str) -> Result<()> {
    let Some(Node { value: Value::Text(file), origin }) = file else { return Ok(()) };
    let full = std::path::absolute(origin.source.folder.join(&*file))
        .map_err(|error| check::error(origin, key, format_args!("cannot be made a full path: {error}")))?;
    match full.into_os_string().into_string() {
        Ok(full) => *file = full,
        Err(_) => return Err(check::error(origin, key, "lies in a folder whose name is not UTF-8; rename it")),
    }
    Ok(())
}
