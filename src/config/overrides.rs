//! `--set key=value`: a value laid over all files.

use super::tree::{Node, Origin, Source, Table, Value, insert, overlay, override_value, quoted};
use super::{check, renamed};
use crate::fail;
use anyhow::Result;
use std::path::PathBuf;
use std::rc::Rc;

/// Applies one `--set key=value`.
pub fn apply(root: &mut Node, text: &str) -> Result<()> {
    let source = Rc::new(Source { name: format!("--set {}", text.escape_debug()), folder: PathBuf::new(), layer: usize::MAX });
    let origin = Origin { source: source.clone(), line: 0 };
    let Some((key, value)) = text.split_once('=') else {
        return Err(fail!(BadInput, "--set {}: expects key=value, as in --set gather.interleave=2", quoted(text)));
    };
    let key = key.trim();
    if key == "base" {
        return Err(check::error(&origin, key, "only a file has a base; write a small config that names it"));
    }
    let parts: Vec<&str> = key.split('.').map(str::trim).collect();
    if parts.iter().any(|part| part.is_empty()) || parts.len() > 8 {
        return Err(fail!(BadInput, "{origin}: expects a dotted key such as gather.interleave before the ="));
    }
    let Some((last, parents)) = parts.split_last() else { unreachable!("split gives at least one part") };
    let value = override_value(&source, value.trim());
    let mut node = root;
    let (mut path, mut pattern) = (String::new(), String::new());
    let extend = |path: &mut String, part: &str| {
        if !path.is_empty() {
            path.push('.');
        }
        path.push_str(part);
    };
    for part in parents {
        let Node { origin: said, value: inside } = node;
        node = match inside {
            Value::Table(table) => {
                extend(&mut pattern, part);
                let empty = || Node { origin: origin.clone(), value: Value::Table(Table::new()) };
                table.entry((*part).to_owned()).or_insert_with(empty)
            }
            Value::List(items) => {
                extend(&mut pattern, "N");
                item(items, part, &path, &origin)?
            }
            other => return Err(no_table(said, other, &path, part, &origin)),
        };
        extend(&mut path, part);
    }
    let Node { origin: said, value: inside } = node;
    match inside {
        Value::Table(table) => insert(table, (*last).to_owned(), value, &pattern),
        Value::List(items) => {
            extend(&mut pattern, "N");
            overlay(item(items, last, &path, &origin)?, value, &pattern);
        }
        other => return Err(no_table(said, other, &path, last, &origin)),
    }
    Ok(())
}

/// Error for an option whose key goes through a value that is no table; it may be an old name of a key.
fn no_table(said: &Origin, value: &Value, path: &str, part: &str, origin: &Origin) -> anyhow::Error {
    match renamed::now(path, value) {
        Some(now) => check::error(said, path, format_args!("is now {now}")),
        None => check::error(origin, path, format_args!("is no table, it has no key {}", quoted(part))),
    }
}

fn item<'l>(items: &'l mut [Node], part: &str, path: &str, origin: &Origin) -> Result<&'l mut Node> {
    let count = items.len();
    part.parse::<usize>().ok().and_then(|index| items.get_mut(index)).ok_or_else(|| {
        let has = match count {
            0 => "is an empty list".to_owned(),
            1 => "has one entry, 0".to_owned(),
            count => format!("has {count} entries, 0 to {}", count - 1),
        };
        check::error(origin, path, format_args!("{has}, and none called {}", quoted(part)))
    })
}
