//! Typed entries of a table's file. Every mistake is refused with file, line and key.

use crate::config::check::error;
use crate::config::nearest;
use crate::config::tree::{Node, Table as Tree, Value, join};
use anyhow::Result;

/// Entries of a TOML table; unknown keys are refused.
pub fn section<'n>(node: &'n Node, path: &str, known: &[&str]) -> Result<&'n Tree> {
    let Value::Table(tree) = &node.value else {
        return Err(error(&node.origin, path, format_args!("expects a table, found {}", node.found())));
    };
    for (key, node) in tree {
        if !known.contains(&key.as_str()) {
            let hint = nearest(key, known)
                .map_or_else(|| format!("known here are {}", known.join(", ")), |near| format!("did you mean \"{near}\"?"));
            return Err(error(&node.origin, &join(path, key), format_args!("unknown key; {hint}")));
        }
    }
    Ok(tree)
}

pub fn text_of<'n>(node: &'n Node, path: &str) -> Result<&'n str> {
    match &node.value {
        Value::Text(text) if !text.trim().is_empty() => Ok(text),
        _ => Err(error(&node.origin, path, format_args!("expects a text, found {}", node.found()))),
    }
}

pub fn optional_text(tree: &Tree, key: &str) -> Result<Option<String>> {
    tree.get(key).map(|node| text_of(node, key).map(|text| text.trim().to_owned())).transpose()
}

pub fn items<'n>(node: &'n Node, path: &str) -> Result<&'n [Node]> {
    match &node.value {
        Value::List(items) => Ok(items),
        _ => Err(error(&node.origin, path, format_args!("expects a list, found {}", node.found()))),
    }
}

pub fn texts(node: &Node, path: &str) -> Result<Vec<String>> {
    items(node, path)?.iter().map(|item| text_of(item, path).map(str::to_owned)).collect()
}
