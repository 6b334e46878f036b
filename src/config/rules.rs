//! Rules between keys: keys that exclude or need each other, keyframes in order. Each slot has its own.

use super::check::error;
use super::tree::{Node, Origin, Value};
use super::{CameraConfig, Config, GatherConfig, LightConfig, RsmConfig, SceneConfig, VisibilityConfig, VplsConfig};
use anyhow::Result;

/// A key, and what is wrong with it.
pub type Broken = (String, String);

pub fn broken<T>(key: impl Into<String>, message: impl Into<String>) -> Result<T, Broken> {
    Err((key.into(), message.into()))
}

/// A check of a whole config that belongs to one section: keys that exclude or need each other.
type Rule = fn(&Config) -> Result<(), Broken>;

const RULES: [Rule; 7] = [
    VisibilityConfig::rules,
    RsmConfig::rules,
    SceneConfig::rules,
    VplsConfig::rules,
    GatherConfig::rules,
    CameraConfig::rules,
    LightConfig::rules,
];

/// Refuses values that do not go together. `root` is the tree that they came from, for file and line.
pub fn check(config: &Config, root: &Node) -> Result<()> {
    RULES.iter().try_for_each(|rules| rules(config)).map_err(|(key, message)| error_at(root, &key, message))
}

/// An error at a key of the merged config.
pub fn error_at(root: &Node, path: &str, message: impl std::fmt::Display) -> anyhow::Error {
    error(locate(root, path), path, message)
}

/// Origin of a key, or of the nearest table around it if it is not given.
fn locate<'r>(root: &'r Node, path: &str) -> &'r Origin {
    let mut node = root;
    for part in path.split('.') {
        let inner = match &node.value {
            Value::Table(table) => table.get(part),
            Value::List(items) => part.parse::<usize>().ok().and_then(|index| items.get(index)),
            _ => None,
        };
        match inner {
            Some(inner) => node = inner,
            None => break,
        }
    }
    &node.origin
}

/// Refuses keyframes out of order; `at` is the table that has them.
pub fn rising(at: &str, times: impl Iterator<Item = f32>) -> Result<(), Broken> {
    let mut last = None;
    for (index, time) in times.enumerate() {
        if let Some(before) = last.filter(|&before| before >= time) {
            return broken(format!("{at}.keyframes.{index}.time"), format!("{time} is not after the keyframe before it, at {before}"));
        }
        last = Some(time);
    }
    Ok(())
}
