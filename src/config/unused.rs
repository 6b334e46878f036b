//! Warnings of keys that a config gives and its frames do not use.

use super::tree::{Node, Value, join};
use super::{BounceConfig, Config, DirectConfig, FilterConfig, GatherConfig, SsaoConfig, VisibilityConfig, VplsConfig};

/// Keys and sections that are not used, and the keys whose values are the reason.
pub struct Unused {
    keys: Vec<&'static str>,
    since: Vec<&'static str>,
}

impl Unused {
    pub fn new(keys: &[&'static str], since: &[&'static str]) -> Self {
        Self { keys: keys.to_vec(), since: since.to_vec() }
    }

    /// Whether a key is one of these, or in a section of these.
    fn has(&self, path: &str) -> bool {
        let inside = |key: &&str| path.strip_prefix(*key).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        self.keys.iter().any(inside) && !self.since.contains(&path)
    }
}

/// Unused keys of each slot.
const UNUSED: [fn(&Config) -> Vec<Unused>; 7] = [
    VplsConfig::unused,
    BounceConfig::unused,
    VisibilityConfig::unused,
    GatherConfig::unused,
    FilterConfig::unused,
    DirectConfig::unused,
    SsaoConfig::unused,
];

fn all(config: &Config) -> Vec<Unused> {
    UNUSED.iter().flat_map(|unused| unused(config)).collect()
}

/// Whether frames of a config do not use a key or a section, whatever its value.
pub fn is_unused(config: &Config, key: &str) -> bool {
    all(config).iter().any(|unused| unused.has(key))
}

/// Warnings of given keys that are not used, with file and line. A key of a base does not warn if a layer above it chose the method that
/// makes it unused: a table's column that changes the method inherits the base's keys.
pub fn warnings(config: &Config, root: &Node) -> Vec<String> {
    let values = toml::Value::try_from(config).unwrap_or_else(|error| unreachable!("a config is plain data: {error}"));
    let mut said: Vec<(&Node, String)> = Vec::new();
    for unused in all(config) {
        let chosen = unused.since.iter().filter_map(|key| at(root, key)).map(|node| node.origin.source.layer).max().unwrap_or(0);
        let value =
            |key: &&str| key.split('.').try_fold(&values, |value, part| value.get(part)).map_or_else(String::new, ToString::to_string);
        let since: Vec<String> = unused.since.iter().map(|key| format!("{key} is {}", value(key))).collect();
        leaves(root, "", &mut |node, path| {
            if unused.has(path) && node.origin.source.layer >= chosen {
                said.push((node, format!("{}: {path}: is not used, since {}", node.origin, since.join(" and "))));
            }
        });
    }
    said.sort_by_key(|(node, _)| (node.origin.source.layer, node.origin.line));
    said.into_iter().map(|(_, warning)| warning).collect()
}

fn at<'n>(root: &'n Node, key: &str) -> Option<&'n Node> {
    key.split('.').try_fold(root, |node, part| match &node.value {
        Value::Table(table) => table.get(part),
        _ => None,
    })
}

fn leaves<'n>(node: &'n Node, path: &str, each: &mut impl FnMut(&'n Node, &str)) {
    match &node.value {
        Value::Table(table) => table.iter().for_each(|(key, node)| leaves(node, &join(path, key), each)),
        _ => each(node, path),
    }
}

/// Removes unused keys that have their default, so that a config that is written and read again does not warn of them.
pub fn forget(config: &Config, values: &mut toml::Table) {
    let defaults = toml::Table::try_from(Config::default()).unwrap_or_else(|error| unreachable!("a config is plain data: {error}"));
    let unused = all(config);
    forget_below(values, &defaults, "", &|path| unused.iter().any(|unused| unused.has(path)));
}

fn forget_below(values: &mut toml::Table, defaults: &toml::Table, path: &str, is_unused: &impl Fn(&str) -> bool) {
    values.retain(|key, value| {
        let path = join(path, key);
        match (value, defaults.get(key)) {
            (toml::Value::Table(values), Some(toml::Value::Table(defaults))) => {
                forget_below(values, defaults, &path, is_unused);
                !values.is_empty()
            }
            (value, default) => !(is_unused(&path) && default == Some(&*value)),
        }
    });
}
