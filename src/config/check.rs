//! Checks of a merged config, key by key against the schema: unknown keys, wrong types, values out of range. A tree that passes deserializes.

use super::keys::{Choice, KeyInfo, Kind, Range, choices, keys, listed};
use super::renamed;
use super::tree::{Node, Origin, Table, Value, join, quoted};
use crate::fail;
use anyhow::Result;

/// An error at a place: `file:line: key: message`.
pub fn error(origin: &Origin, path: &str, message: impl std::fmt::Display) -> anyhow::Error {
    fail!(BadInput, "{origin}: {path}: {message}")
}

/// Checks a table and all below it. `pattern` is its key in the list of keys, `path` its key with real indices.
pub fn table(table: &Table, pattern: &str, path: &str) -> Result<()> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(_, node)| (std::cmp::Reverse(node.origin.source.layer), node.origin.line));
    for (key, node) in entries {
        let path = join(path, key);
        let pattern = if pattern.is_empty() { key.clone() } else { format!("{pattern}.{key}") };
        if let Some(now) = renamed::now(&pattern, &node.value) {
            return Err(error(&node.origin, &path, format_args!("is now {now}")));
        }
        match find(&pattern).filter(|_| !key.contains('.')) {
            Some(info) => value(node, info, &path)?,
            None => return Err(error(&node.origin, &path, format_args!("unknown key{}", hint(key, &pattern)))),
        }
    }
    Ok(())
}

fn find(pattern: &str) -> Option<&'static KeyInfo> {
    keys().iter().find(|info| info.key == pattern)
}

/// The keys right below a table or in the tables of a list, by name.
fn below(pattern: &str) -> impl Iterator<Item = (&'static str, &'static KeyInfo)> {
    let inside = move |info: &'static KeyInfo| match pattern {
        "" => Some(info.key.as_str()),
        _ => info.key.strip_prefix(pattern)?.strip_prefix('.'),
    };
    keys().iter().filter_map(move |info| Some((inside(info)?, info))).filter(|(name, _)| !name.contains('.'))
}

/// Suggestion for an unknown key: a similar name in the same table, else the same name in another section.
fn hint(key: &str, pattern: &str) -> String {
    let parent = pattern.strip_suffix(key).unwrap_or("").trim_end_matches('.');
    let mut siblings: Vec<&str> = below(parent).map(|(name, _)| name).collect();
    siblings.dedup();
    if let Some(near) = nearest(key, &siblings) {
        return format!("; did you mean \"{near}\"?");
    }
    // In a section of this table, or else the same name anywhere.
    let deeper: Vec<&str> = keys().iter().filter_map(|info| info.key.strip_prefix(parent)?.strip_prefix('.')).collect();
    let names: Vec<&str> = deeper.iter().map(|path| path.rsplit('.').next().unwrap_or(path)).collect();
    let near = nearest(key, &names).and_then(|near| names.iter().position(|name| *name == near)).map(|i| deeper[i]);
    let same = || keys().iter().find(|info| !info.key.contains(".N.") && info.key.rsplit('.').next() == Some(key));
    match near.or_else(|| same().map(|info| info.key.as_str())) {
        Some(key) => format!("; did you mean \"{key}\"?"),
        None if siblings.is_empty() => String::new(),
        None => format!("; known here are {}", siblings.join(", ")),
    }
}

/// The name closest to `name`, if it is close enough to be meant.
pub fn nearest<'n>(name: &str, names: &[&'n str]) -> Option<&'n str> {
    // Edit distance is quadratic in the length, and no key is that long.
    if name.len() > 64 {
        return None;
    }
    let lower = name.to_lowercase().replace('_', "-");
    let distance = |other: &str| strsim::damerau_levenshtein(&lower, &other.replace('_', "-"));
    let best = names.iter().min_by_key(|other| distance(other))?;
    (distance(best) <= 1.max(name.chars().count().min(best.len()) / 3)).then_some(*best)
}

fn value(node: &Node, info: &KeyInfo, path: &str) -> Result<()> {
    let wrong = || error(&node.origin, path, format_args!("expects {}, found {}", info.kind.expects(), node.found()));
    let out =
        |what: &dyn std::fmt::Display| error(&node.origin, path, format_args!("{what} is out of range, expected {}", info.kind.range()));
    match (&info.kind, &node.value) {
        (Kind::Table, Value::Table(inner)) => {
            table(inner, &info.key, path)?;
            needs(node, inner, &info.key, path, None)?;
        }
        (Kind::Tables, Value::Table(_)) => {
            let message = format_args!("expects {}, found {}; each begins with [[{path}]]", info.kind.expects(), node.found());
            return Err(error(&node.origin, path, message));
        }
        (Kind::Text, Value::Text(text)) => {
            if text.is_empty() {
                return Err(error(&node.origin, path, "is empty"));
            }
        }
        (Kind::Choice(names), Value::Text(text)) => choice(node, text, names, path)?,
        (Kind::Choices(names), Value::List(items)) => {
            for (index, item) in items.iter().enumerate() {
                let path = join(path, &index.to_string());
                let Value::Text(text) = &item.value else {
                    return Err(error(&item.origin, &path, format_args!("expects a name, found {}", item.found())));
                };
                choice(item, text, names, &path)?;
                if items[..index].iter().any(|other| matches!(&other.value, Value::Text(other) if other == text)) {
                    return Err(error(&item.origin, &path, format_args!("\"{text}\" is there twice")));
                }
            }
        }
        (Kind::IndexOrName, Value::Text(text)) if !text.is_empty() => {}
        (Kind::Flag, Value::Bool(_)) => {}
        (Kind::IndexOrName, Value::Whole(whole)) => {
            if u32::try_from(*whole).is_err() {
                return Err(out(whole));
            }
        }
        (Kind::Whole { min, max }, Value::Whole(whole)) => {
            if whole < min || whole > max {
                return Err(out(whole));
            }
        }
        (Kind::Block(values), Value::List(sides)) => {
            if sides.len() != 2 {
                return Err(wrong());
            }
            for side in sides {
                match side.value {
                    Value::Whole(whole) if values.contains(&whole) => {}
                    Value::Whole(whole) => return Err(error(&side.origin, path, out_of_range(&whole, info))),
                    _ => return Err(wrong()),
                }
            }
        }
        (Kind::OneOf(values) | Kind::Block(values), Value::Whole(whole)) => {
            if !values.contains(whole) {
                return Err(out(whole));
            }
        }
        (Kind::Number(range), Value::Whole(_) | Value::Number(_)) => {
            number(node, *range, path)?;
        }
        (Kind::Size { max }, Value::List(items)) => {
            if items.len() != 2 {
                return Err(wrong());
            }
            for item in items {
                match item.value {
                    Value::Whole(side) if (1..=*max).contains(&side) => {}
                    Value::Whole(side) => return Err(error(&item.origin, path, out_of_range(&side, info))),
                    _ => {
                        return Err(error(
                            &item.origin,
                            path,
                            format_args!("expects {}, found {} in it", info.kind.expects(), item.found()),
                        ));
                    }
                }
            }
        }
        (Kind::Point(range) | Kind::Color(range), Value::List(items)) => {
            three(items, *range, path).unwrap_or_else(|| Err(wrong()))?;
        }
        (Kind::Direction, Value::List(items)) => {
            if three(items, Range::FINITE, path).unwrap_or_else(|| Err(wrong()))? == [0.0; 3] {
                return Err(error(&node.origin, path, "[0, 0, 0] has no direction"));
            }
        }
        (Kind::Tables, Value::List(items)) => {
            for (index, item) in items.iter().enumerate() {
                element(item, info, &join(path, &index.to_string()))?;
            }
        }
        _ => return Err(wrong()),
    }
    Ok(())
}

fn out_of_range(value: &i64, info: &KeyInfo) -> String {
    format!("{value} is out of range, expected {}", info.kind.range())
}

fn choice(node: &Node, text: &str, choices: &[Choice], path: &str) -> Result<()> {
    let names: Vec<&str> = choices.iter().map(|choice| choice.name.as_str()).collect();
    if names.contains(&text) {
        return Ok(());
    }
    let near = nearest(text, &names).map(|near| format!("; did you mean \"{near}\"?")).unwrap_or_default();
    let expected = if names.len() == 1 { "expected" } else { "expected one of" };
    Err(error(&node.origin, path, format_args!("unknown value {}, {expected} {}{near}", quoted(text), listed(&names))))
}

/// A number rounded to 32 bits, as it will be stored, so that a number that rounds to zero counts as zero.
fn number(node: &Node, range: Range, path: &str) -> Result<f32> {
    let (value, shown) = match node.value {
        Value::Whole(whole) => (whole as f32, whole.to_string()),
        Value::Number(number) => (number as f32, format!("{number:?}")),
        _ => return Err(error(&node.origin, path, format_args!("expects a number, found {}", node.found()))),
    };
    if range.contains(value) {
        return Ok(value);
    }
    Err(error(&node.origin, path, format_args!("{shown} is out of range, expected {}", range.text())))
}

/// Three numbers; `None` if there are not three.
fn three(items: &[Node], range: Range, path: &str) -> Option<Result<[f32; 3]>> {
    let items: &[Node; 3] = items.try_into().ok()?;
    let mut values = [0.0; 3];
    for (value, item) in values.iter_mut().zip(items) {
        match number(item, range, path) {
            Ok(number) => *value = number,
            Err(error) => return Some(Err(error)),
        }
    }
    Some(Ok(values))
}

/// Checks one table of a list: required keys are there, and a light has only keys of its kind.
fn element(item: &Node, list: &KeyInfo, path: &str) -> Result<()> {
    let Value::Table(table) = &item.value else {
        return Err(error(&item.origin, path, format_args!("expects a table, found {}", item.found())));
    };
    let pattern = format!("{}.N", list.key);
    let light = if list.key == "light" { Some(light_kind(item, table, path)?) } else { None };
    if let Some(light) = light {
        only_for(table, &pattern, path, light)?;
    }
    self::table(table, &pattern, path)?;
    needs(item, table, &pattern, path, light)
}

/// Refuses a table that lacks a required key.
fn needs(node: &Node, table: &Table, pattern: &str, path: &str, light: Option<&str>) -> Result<()> {
    for (name, info) in below(pattern).filter(|(name, info)| info.required && !table.contains_key(*name)) {
        match light {
            None => return Err(error(&node.origin, path, format_args!("needs {name}"))),
            Some(light) if is_for(info, light) => {
                return Err(error(&node.origin, path, format_args!("{} light needs {name}", with_article(light))));
            }
            Some(_) => {}
        }
    }
    Ok(())
}

fn is_for(info: &KeyInfo, light: &str) -> bool {
    info.lights.iter().any(|kind| kind == light)
}

fn light_kind(item: &Node, table: &Table, path: &str) -> Result<&'static str> {
    let Some(kind) = table.get("kind") else {
        return Err(error(&item.origin, path, format_args!("needs kind, one of {}", listed(choices("light.N.kind")))));
    };
    find("light.N.kind").map_or(Ok(()), |info| value(kind, info, &join(path, "kind")))?;
    let name = choices("light.N.kind").find(|name| matches!(&kind.value, Value::Text(text) if text == name));
    name.ok_or_else(|| unreachable!("the kind was checked against the same list"))
}

/// Refuses keys that only other kinds of light have, in a light and in its keyframes.
fn only_for(table: &Table, pattern: &str, path: &str, light: &str) -> Result<()> {
    for (key, node) in table {
        let infos: Vec<&KeyInfo> = below(pattern).filter(|(name, _)| name == key).map(|(_, info)| info).collect();
        if !infos.is_empty() && !infos.iter().any(|info| is_for(info, light)) {
            let units = ["irradiance", "intensity", "radiance"];
            let own = below("light.N").find(|(name, info)| units.contains(name) && is_for(info, light));
            let instead = own.filter(|_| units.contains(&key.as_str())).map(|(own, _)| format!("; give {own}")).unwrap_or_default();
            return Err(error(&node.origin, &join(path, key), format_args!("{} light has no {key}{instead}", with_article(light))));
        }
        if let (Some(KeyInfo { kind: Kind::Tables, key: list, .. }), Value::List(items)) = (infos.first(), &node.value) {
            for (index, item) in items.iter().enumerate() {
                if let Value::Table(inner) = &item.value {
                    only_for(inner, &format!("{list}.N"), &join(&join(path, key), &index.to_string()), light)?;
                }
            }
        }
    }
    Ok(())
}

fn with_article(light: &str) -> String {
    if light.starts_with('e') { format!("an {light}") } else { format!("a {light}") }
}
