//! Untyped values of a config, each with the file and line that it comes from: an error that is found after bases and overrides are
//! merged still names the right place.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::rc::Rc;
use toml::de::{DeTable, DeValue};

/// A file, or the `--set` options.
#[derive(Debug)]
pub struct Source {
    /// As the user knows it: a path, or `--set key=value`.
    pub name: String,
    /// Folder that relative paths start from.
    pub folder: PathBuf,
    /// Rises from the last base to the file that is loaded; the `--set` options share one above all files.
    pub layer: usize,
}

/// Origin of a value.
#[derive(Debug, Clone)]
pub struct Origin {
    pub source: Rc<Source>,
    /// Line number, from 1; 0 if there is none.
    pub line: usize,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => f.write_str(&self.source.name),
            line => write!(f, "{}:{line}", self.source.name),
        }
    }
}

/// A value with its origin; in a table that is the line of its key.
#[derive(Debug, Clone)]
pub struct Node {
    pub origin: Origin,
    pub value: Value,
}

#[derive(Debug, Clone)]
pub enum Value {
    Text(String),
    Whole(i64),
    Number(f64),
    Bool(bool),
    /// A date or a time, and whole numbers beyond 64 bits: no key takes them.
    Other(&'static str),
    List(Vec<Node>),
    Table(Table),
}

pub type Table = BTreeMap<String, Node>;

/// Turns byte offsets into line numbers.
pub struct Lines<'t> {
    pub source: Rc<Source>,
    text: &'t str,
    /// Where each line starts.
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub fn new(source: Rc<Source>, text: &'t str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { source, text, starts }
    }

    pub fn origin(&self, offset: usize) -> Origin {
        Origin { source: self.source.clone(), line: self.starts.partition_point(|&start| start <= offset) }
    }

    /// Column of an offset in characters, counted from 1.
    pub fn column(&self, offset: usize) -> usize {
        let start = self.starts[self.starts.partition_point(|&start| start <= offset) - 1];
        self.text.get(start..offset).map_or(0, |before| before.chars().count()) + 1
    }

    pub fn table(&self, table: &DeTable<'_>) -> Table {
        table.iter().map(|(key, value)| (key.get_ref().to_string(), self.node(key.span().start, value.get_ref()))).collect()
    }

    fn node(&self, offset: usize, value: &DeValue<'_>) -> Node {
        Node { origin: self.origin(offset), value: self.value(value) }
    }

    fn value(&self, value: &DeValue<'_>) -> Value {
        match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(whole) => {
                i64::from_str_radix(whole.as_str(), whole.radix()).map_or(Value::Other("a whole number beyond 64 bits"), Value::Whole)
            }
            DeValue::Float(number) => number.as_str().parse().map_or(Value::Other("a number that cannot be read"), Value::Number),
            DeValue::Boolean(value) => Value::Bool(*value),
            DeValue::Datetime(_) => Value::Other("a date or time"),
            DeValue::Array(items) => Value::List(items.iter().map(|item| self.node(item.span().start, item.get_ref())).collect()),
            DeValue::Table(table) => Value::Table(self.table(table)),
        }
    }
}

/// The value of a `--set` option: TOML, or else a bare string.
pub fn override_value(source: &Rc<Source>, text: &str) -> Node {
    let mut node = match DeValue::parse(text) {
        Ok(value) => Lines::new(source.clone(), text).node(0, value.get_ref()),
        Err(_) => Node { origin: Origin { source: source.clone(), line: 0 }, value: Value::Text(text.to_owned()) },
    };
    node.forget_lines();
    node
}

impl Node {
    /// Description of the value for error messages, short and on one line.
    pub fn found(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("a string {}", quoted(text)),
            Value::Whole(whole) => format!("the whole number {whole}"),
            Value::Number(number) => format!("the number {number:?}"),
            Value::Bool(value) => format!("the boolean {value}"),
            Value::Other(what) => (*what).to_owned(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        }
    }

    /// The same value from the same place, in another layer.
    pub fn in_layer(&self, layer: usize) -> Self {
        let source = Rc::new(Source { name: self.origin.source.name.clone(), folder: self.origin.source.folder.clone(), layer });
        self.from(&source)
    }

    fn from(&self, source: &Rc<Source>) -> Self {
        let value = match &self.value {
            Value::List(items) => Value::List(items.iter().map(|item| item.from(source)).collect()),
            Value::Table(table) => Value::Table(table.iter().map(|(key, node)| (key.clone(), node.from(source))).collect()),
            other => other.clone(),
        };
        Self { origin: Origin { source: source.clone(), line: self.origin.line }, value }
    }

    fn forget_lines(&mut self) {
        self.origin.line = 0;
        match &mut self.value {
            Value::List(items) => items.iter_mut().for_each(Node::forget_lines),
            Value::Table(table) => table.values_mut().for_each(Node::forget_lines),
            _ => {}
        }
    }

    pub fn into_toml(self) -> toml::Value {
        match self.value {
            Value::Text(text) => toml::Value::String(text),
            Value::Whole(whole) => toml::Value::Integer(whole),
            Value::Number(number) => toml::Value::Float(number),
            Value::Bool(value) => toml::Value::Boolean(value),
            Value::Other(what) => toml::Value::String(what.to_owned()),
            Value::List(items) => toml::Value::Array(items.into_iter().map(Node::into_toml).collect()),
            Value::Table(table) => toml::Value::Table(table.into_iter().map(|(key, node)| (key, node.into_toml())).collect()),
        }
    }
}

/// A string in quotes, shortened, without control characters.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{:?}...", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// A dotted key with one more part.
pub fn join(path: &str, key: &str) -> String {
    let bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    let key = if bare { key.to_owned() } else { quoted(key) };
    if path.is_empty() { key } else { format!("{path}.{key}") }
}

/// Lays a value over another: tables key by key, anything else whole. `path` names the place, with `N` for list indices.
pub fn overlay(base: &mut Node, over: Node, path: &str) {
    match (&mut base.value, over.value) {
        (Value::Table(base_table), Value::Table(over_table)) => {
            for (key, node) in over_table {
                insert(base_table, key, node, path);
            }
            base.origin = over.origin;
        }
        (_, value) => *base = Node { origin: over.origin, value },
    }
}

/// Puts a value into a table, over an older one, and removes keys of lower layers that it excludes.
pub fn insert(table: &mut Table, key: String, node: Node, path: &str) {
    let same = table.get(&key).is_some_and(|old| matches!((&old.value, &node.value), (Value::Text(old), Value::Text(new)) if old == new));
    if !same {
        for rival in displaced(path, &key) {
            if table.get(*rival).is_some_and(|old| old.origin.source.layer < node.origin.source.layer) {
                table.remove(*rival);
            }
        }
    }
    match table.get_mut(&key) {
        Some(old) => overlay(old, node, &join(path, &key)),
        None => {
            table.insert(key, node);
        }
    }
}

/// Keys of a base that a key laid over it excludes.
fn displaced(path: &str, key: &str) -> &'static [&'static str] {
    match (path, key) {
        ("scene", "file") => &["scene", "animation", "builtin", "triangles", "roughness", "seed"],
        ("scene", "builtin") => &["file", "scene", "animation", "triangles", "roughness", "seed"],
        ("camera", "node") => &["position", "target", "up", "keyframes"],
        ("camera", "position" | "target") => &["node", "keyframes"],
        ("camera", "keyframes") => &["node", "position", "target"],
        ("light.N", "direction") => &["target"],
        ("light.N", "target") => &["direction"],
        _ => &[],
    }
}
