//! Reading a [`Table`] from TOML. Every mistake is refused with file, line and key before anything is rendered.

use super::measures::{self, Names, check_measures, place};
use super::nodes::{items, optional_text, section, text_of, texts};
use super::{Line, Published, ReferenceGoal, Table};
use crate::config::check::error;
use crate::config::tree::{Node, Origin, Table as Tree, Value, join, quoted};
use crate::config::{Base, document, nearest};
use crate::presets;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Reads a table whose file is `path`; relative bases and scenes start from there. A stand-in scene is replaced by its original
/// if the folder `scenes` has the file. The deviations name the stand-ins that stay. Times may be of `stages`, of their passes
/// or of the frame.
///
/// # Errors
/// `BadInput` with file, line and key: unknown keys, presets and measures; cells without a measure; rows, columns and figures
/// that do not match.
pub fn table(text: &str, path: &Path, scenes: Option<&Path>, stages: &[&str]) -> Result<Table> {
    let root = document(text, path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let keys = [
        "title",
        "source",
        "about",
        "base",
        "set",
        "instead_of",
        "measure",
        "share_of",
        "relative_to",
        "reference",
        "published",
        "deviations",
        "sheet",
        "row",
        "column",
    ];
    let tree = section(&root, "", &keys)?;
    let mut stand_ins = Vec::new();
    let original = match tree.get("instead_of") {
        Some(node) => original(node, "instead_of", "The base's scene", scenes)?.map_err(|absent| stand_ins.push(absent)).ok(),
        None => None,
    }
    .map(|(_, config)| config);
    let rows = lines(tree, "row", &root.origin, scenes, &mut stand_ins)?;
    let columns = lines(tree, "column", &root.origin, scenes, &mut stand_ins)?;
    let names = Names {
        rows: rows.iter().map(|l| l.0.written.clone()).collect(),
        columns: columns.iter().map(|l| l.0.written.clone()).collect(),
        stages,
    };
    let finish = |lines: Vec<(Line, Option<&Node>)>, path: &str| -> Result<Vec<Line>> {
        let with_measure = |(i, (line, measure)): (usize, (Line, Option<&Node>))| {
            let measure = measure.map(|node| measures::measure(node, &format!("{path}.{i}.measure"), &names)).transpose()?;
            Ok(Line { measure, ..line })
        };
        lines.into_iter().enumerate().map(with_measure).collect()
    };
    let (rows, columns) = (finish(rows, "row")?, finish(columns, "column")?);
    let measure = tree.get("measure").map(|node| measures::measure(node, "measure", &names)).transpose()?;
    let share_of = tree.get("share_of").map(|node| place(node, "share_of", &names)).transpose()?;
    let relative_to = tree.get("relative_to").map(|node| place(node, "relative_to", &names)).transpose()?;
    let published = tree.get("published").map(|node| published(node, &rows, &columns)).transpose()?;
    let table = Table {
        title: match tree.get("title") {
            Some(node) => text_of(node, "title")?.to_owned(),
            None => return Err(error(&root.origin, "title", "is missing; say in a few words what the table shows")),
        },
        source: optional_text(tree, "source")?,
        about: optional_text(tree, "about")?,
        deviations: tree
            .get("deviations")
            .map(|node| texts(node, "deviations"))
            .transpose()?
            .into_iter()
            .flatten()
            .chain(stand_ins)
            .collect(),
        reference: tree.get("reference").map_or(Ok(ReferenceGoal::default()), reference)?,
        sheet: match tree.get("sheet") {
            None => false,
            Some(Node { value: Value::Bool(sheet), .. }) => *sheet,
            Some(node) => return Err(error(&node.origin, "sheet", format_args!("expects true or false, found {}", node.found()))),
        },
        base: base(tree, &root.origin, path)?,
        set: tree.get("set").map(|node| partial(node, "set")).transpose()?,
        original,
        name,
        published,
        rows,
        columns,
        measure,
        share_of,
        relative_to,
    };
    check_measures(&table)?;
    Ok(table)
}

/// Part of a config. Its keys are checked when it is merged with the base.
fn partial(node: &Node, path: &str) -> Result<Node> {
    match &node.value {
        Value::Table(tree) if tree.contains_key("base") => {
            Err(error(&tree["base"].origin, path, "cannot set base; the table has one for all cells"))
        }
        Value::Table(_) => Ok(node.clone()),
        _ => Err(error(&node.origin, path, format_args!("expects a table of config keys, found {}", node.found()))),
    }
}

/// The base: a preset by name, or a config by its path from the table's folder.
fn base(tree: &Tree, origin: &Origin, path: &Path) -> Result<Base> {
    let Some(node) = tree.get("base") else {
        return Err(error(origin, "base", "is missing; name a preset or a config that the cells start from"));
    };
    let name = text_of(node, "base")?;
    let file = path.parent().unwrap_or(Path::new("")).join(name);
    let preset = name.strip_suffix(".toml").unwrap_or(name);
    let loaded = match presets::find_unless(preset, &file) {
        Some(text) => return Base::parse_preset(text, &PathBuf::from(format!("{preset}.toml"))),
        _ if file.is_file() => Base::load(&file),
        _ => {
            let names: Vec<&str> = presets::all().iter().map(|(name, _)| *name).collect();
            let hint = nearest(name, &names)
                .map_or_else(|| format!("presets are {}", names.join(", ")), |near| format!("did you mean \"{near}\"?"));
            return Err(error(&node.origin, "base", format_args!("{} is neither a preset nor a file; {hint}", quoted(name))));
        }
    };
    loaded.map_err(|cause| error(&node.origin, "base", cause))
}

/// The rows or the columns, each with its measure's node, which can only be read when all names are known.
fn lines<'n>(
    tree: &'n Tree,
    key: &str,
    root: &Origin,
    scenes: Option<&Path>,
    stand_ins: &mut Vec<String>,
) -> Result<Vec<(Line, Option<&'n Node>)>> {
    let Some(node) = tree.get(key) else {
        return Err(error(root, key, format_args!("is missing; a table has [[{key}]] tables with a name each")));
    };
    let mut lines: Vec<(Line, Option<&Node>)> = Vec::new();
    for (i, item) in items(node, key)?.iter().enumerate() {
        let path = format!("{key}.{i}");
        let tree = section(item, &path, &["name", "set", "instead_of", "measure", "own", "sum"])?;
        let Some(name) = tree.get("name") else { return Err(error(&item.origin, &path, "needs a name")) };
        let written = text_of(name, &join(&path, "name"))?.to_owned();
        let mut text = written.clone();
        if lines.iter().any(|(line, _)| line.written == text) {
            return Err(error(&name.origin, &join(&path, "name"), format_args!("{} is there twice", quoted(&text))));
        }
        let flag = |key: &str| match tree.get(key) {
            None => Ok(false),
            Some(Node { value: Value::Bool(flag), .. }) => Ok(*flag),
            Some(node) => Err(error(&node.origin, &join(&path, key), format_args!("expects true or false, found {}", node.found()))),
        };
        let (own, sum) = (flag("own")?, flag("sum")?);
        let mut set = tree.get("set").map(|node| partial(node, &join(&path, "set"))).transpose()?;
        if let Some(node) = tree.get("instead_of") {
            match original(node, &join(&path, "instead_of"), &text, scenes)? {
                Ok((name, config)) => (text, set) = (name, Some(config)),
                Err(absent) => stand_ins.push(absent),
            }
        }
        lines.push((Line { name: text, written, set, measure: None, own, sum, origin: item.origin.clone() }, tree.get("measure")));
    }
    if lines.is_empty() {
        return Err(error(&node.origin, key, "is empty"));
    }
    Ok(lines)
}

/// The view that a stand-in replaces, as its title and settings: of several the first whose scene the folder has. Or a sentence for the
/// user if it has none.
fn original(node: &Node, path: &str, stand_in: &str, scenes: Option<&Path>) -> Result<Result<(String, Node), String>> {
    let names = match &node.value {
        Value::List(names) => names.as_slice(),
        _ => std::slice::from_ref(node),
    };
    let mut absent = Err(error(&node.origin, path, "is empty; name a view of configs/views"));
    for name in names {
        match view(name, path, stand_in, scenes)? {
            Ok(found) => return Ok(Ok(found)),
            Err(why) => absent = Ok(Err(why)),
        }
    }
    absent
}

/// A view as its title and settings, or a sentence for the user if the folder lacks its scene.
fn view(node: &Node, path: &str, stand_in: &str, scenes: Option<&Path>) -> Result<Result<(String, Node), String>> {
    let name = text_of(node, path)?;
    let views = presets::views();
    let Some((_, text)) = views.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = views.iter().map(|(name, _)| *name).collect();
        let hint =
            nearest(name, &names).map_or_else(|| format!("views are {}", names.join(", ")), |near| format!("did you mean \"{near}\"?"));
        return Err(error(&node.origin, path, format_args!("there is no view {}; {hint}", quoted(name))));
    };
    // The view is read as if it were in the folder, beside its scene.
    let view = document(text, &scenes.unwrap_or(Path::new("")).join(name).with_extension("toml"))?;
    let file = match &view.value {
        Value::Table(tree) => match tree.get("scene").map(|scene| &scene.value) {
            Some(Value::Table(scene)) => text_of(&scene["file"], "scene.file")?.to_owned(),
            _ => unreachable!("a view has a scene"),
        },
        _ => unreachable!("a document is a table"),
    };
    let title = presets::title(text).to_owned();
    Ok(match scenes {
        None => Err(format!("{stand_in} is rendered in place of {title}; --scenes takes a folder that has {file}.")),
        Some(folder) if !folder.join(&file).is_file() => {
            Err(format!("{stand_in} is rendered in place of {title}: {} is not there.", folder.join(&file).display()))
        }
        Some(_) => Ok((title, view)),
    })
}

fn reference(node: &Node) -> Result<ReferenceGoal> {
    let tree = section(node, "reference", &["bounces", "error", "samples", "min_distance", "centers"])?;
    let mut goal = ReferenceGoal::default();
    for (key, node) in tree {
        let path = join("reference", key);
        let wrong = |what: &str| error(&node.origin, &path, format_args!("expects {what}, found {}", node.found()));
        match (key.as_str(), &node.value) {
            ("bounces", Value::Whole(n)) if (0..=i64::from(crate::reference::MOST_BOUNCES)).contains(n) => goal.bounces = *n as u32,
            ("bounces", _) => return Err(wrong(&format!("a whole number from 0 to {}", crate::reference::MOST_BOUNCES))),
            ("samples", Value::Whole(n)) if (16..=16_000_000).contains(n) => goal.samples = *n as u32,
            ("samples", _) => return Err(wrong("a whole number from 16 to 16000000")),
            ("error", Value::Number(x)) if *x > 0.0 && x.is_finite() => goal.error = *x,
            ("error", _) => return Err(wrong("a number over 0, such as 0.01")),
            ("min_distance", Value::Bool(value)) => goal.min_distance = *value,
            ("centers", Value::Bool(value)) => goal.centers = *value,
            _ => return Err(wrong("true or false")),
        }
    }
    Ok(goal)
}

fn published(node: &Node, rows: &[Line], columns: &[Line]) -> Result<Published> {
    let tree = section(node, "published", &["hardware", "scene", "settings", "figures"])?;
    let text = |key: &str| tree.get(key).map(|node| text_of(node, &join("published", key)).map(str::to_owned)).transpose();
    let Some(node) = tree.get("figures") else {
        return Err(error(&node.origin, "published", "needs figures: a list for each row, a figure for each column"));
    };
    let path = "published.figures";
    let names: Vec<&str> = rows.iter().filter(|row| !row.own).map(|row| row.written.as_str()).collect();
    let by_row = section(node, path, &names)?;
    let wanted: Vec<&Line> = columns.iter().filter(|column| !column.own).collect();
    let mut figures = vec![vec![None; columns.len()]; rows.len()];
    for (row, line) in rows.iter().enumerate().filter(|(_, line)| !line.own) {
        let Some(list) = by_row.get(&line.written) else {
            return Err(error(&node.origin, &join(path, &line.written), "is missing; a row that is not in the paper says own = true"));
        };
        let path = join(path, &line.written);
        let values = items(list, &path)?;
        if values.len() != wanted.len() {
            let message = format_args!(
                "has {} figures for {} columns; a cell without one says \"-\", a column that is not in the paper own = true",
                values.len(),
                wanted.len()
            )
            .to_string();
            return Err(error(&list.origin, &path, message));
        }
        let places = (0..columns.len()).filter(|column| !columns[*column].own);
        for (column, value) in places.zip(values) {
            figures[row][column] = match &value.value {
                Value::Number(x) if x.is_finite() => Some(*x),
                Value::Whole(n) => Some(*n as f64),
                Value::Text(dash) if dash == "-" => None,
                _ => return Err(error(&value.origin, &path, format_args!("expects numbers or \"-\", found {}", value.found()))),
            };
        }
    }
    Ok(Published { hardware: text("hardware")?, scene: text("scene")?, settings: text("settings")?, figures })
}
