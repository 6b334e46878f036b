//! From a TOML file to a [`Table`]. Every mistake is refused by file, line and key before anything is rendered.

use super::{Against, Figure, Line, Measure, Place, Published, ReferenceGoal, Table, What};
use crate::config::check::error;
use crate::config::tree::{Node, Origin, Table as Tree, Value, join, quoted};
use crate::config::{Base, document, nearest};
use crate::metrics::{Intensity, LayerPair};
use crate::presets;
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Reads a table that would be at `path`, which relative bases and scenes start from. What stands for a scene is replaced by it where the
/// folder `scenes` has its file; the deviations say which did not. Times are of `stages`, of their passes or of the frame.
///
/// # Errors
/// `BadInput` with file, line and key: unknown keys, presets and measures; cells without a measure; rows, columns and figures that
/// do not fit each other.
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
        rows: rows.iter().map(|l| l.0.name.clone()).collect(),
        columns: columns.iter().map(|l| l.0.name.clone()).collect(),
        stages,
    };
    let finish = |lines: Vec<(Line, Option<&Node>)>, path: &str| -> Result<Vec<Line>> {
        let with_measure = |(i, (line, measure)): (usize, (Line, Option<&Node>))| {
            let measure = measure.map(|node| self::measure(node, &format!("{path}.{i}.measure"), &names)).transpose()?;
            Ok(Line { measure, ..line })
        };
        lines.into_iter().enumerate().map(with_measure).collect()
    };
    let (rows, columns) = (finish(rows, "row")?, finish(columns, "column")?);
    let measure = tree.get("measure").map(|node| measure(node, "measure", &names)).transpose()?;
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
        relative_to,
    };
    check_measures(&table)?;
    Ok(table)
}

/// What measures may name.
struct Names<'s> {
    rows: Vec<String>,
    columns: Vec<String>,
    stages: &'s [&'s str],
}

/// A table's entries, none of them but those known.
fn section<'n>(node: &'n Node, path: &str, known: &[&str]) -> Result<&'n Tree> {
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

fn text_of<'n>(node: &'n Node, path: &str) -> Result<&'n str> {
    match &node.value {
        Value::Text(text) if !text.trim().is_empty() => Ok(text),
        _ => Err(error(&node.origin, path, format_args!("expects a text, found {}", node.found()))),
    }
}

fn optional_text(tree: &Tree, key: &str) -> Result<Option<String>> {
    tree.get(key).map(|node| text_of(node, key).map(|text| text.trim().to_owned())).transpose()
}

fn items<'n>(node: &'n Node, path: &str) -> Result<&'n [Node]> {
    match &node.value {
        Value::List(items) => Ok(items),
        _ => Err(error(&node.origin, path, format_args!("expects a list, found {}", node.found()))),
    }
}

fn texts(node: &Node, path: &str) -> Result<Vec<String>> {
    items(node, path)?.iter().map(|item| text_of(item, path).map(str::to_owned)).collect()
}

/// A part of a config; whether its keys are right is seen when it is laid over the base.
fn partial(node: &Node, path: &str) -> Result<Node> {
    match &node.value {
        Value::Table(tree) if tree.contains_key("base") => {
            Err(error(&tree["base"].origin, path, "cannot set base; the table has one for all cells"))
        }
        Value::Table(_) => Ok(node.clone()),
        _ => Err(error(&node.origin, path, format_args!("expects a table of config keys, found {}", node.found()))),
    }
}

/// A preset by its name, or a config by its path from the table's folder.
fn base(tree: &Tree, origin: &Origin, path: &Path) -> Result<Base> {
    let Some(node) = tree.get("base") else {
        return Err(error(origin, "base", "is missing; name a preset or a config that the cells start from"));
    };
    let name = text_of(node, "base")?;
    let file = path.parent().unwrap_or(Path::new("")).join(name);
    let loaded = match presets::find(name) {
        Some(text) if !file.is_file() => return Base::parse(text, &PathBuf::from(format!("{name}.toml"))),
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

/// The rows or the columns, each with what it measures, which can only be read once all names are known.
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
        let tree = section(item, &path, &["name", "set", "instead_of", "measure", "own"])?;
        let Some(name) = tree.get("name") else { return Err(error(&item.origin, &path, "needs a name")) };
        let mut text = text_of(name, &join(&path, "name"))?.to_owned();
        if lines.iter().any(|(line, _)| line.name == text) {
            return Err(error(&name.origin, &join(&path, "name"), format_args!("{} is there twice", quoted(&text))));
        }
        let own = match tree.get("own") {
            None => false,
            Some(Node { value: Value::Bool(own), .. }) => *own,
            Some(node) => {
                return Err(error(&node.origin, &join(&path, "own"), format_args!("expects true or false, found {}", node.found())));
            }
        };
        let mut set = tree.get("set").map(|node| partial(node, &join(&path, "set"))).transpose()?;
        if let Some(node) = tree.get("instead_of") {
            match original(node, &join(&path, "instead_of"), &text, scenes)? {
                Ok((name, config)) => (text, set) = (name, Some(config)),
                Err(absent) => stand_ins.push(absent),
            }
        }
        lines.push((Line { name: text, set, measure: None, own, origin: item.origin.clone() }, tree.get("measure")));
    }
    if lines.is_empty() {
        return Err(error(&node.origin, key, "is empty"));
    }
    Ok(lines)
}

/// The view that something stands for, as its name and what it sets; or else, where its scene is not in the folder, a sentence that says so.
fn original(node: &Node, path: &str, stand_in: &str, scenes: Option<&Path>) -> Result<Result<(String, Node), String>> {
    let name = text_of(node, path)?;
    let views = presets::views();
    let Some((_, text)) = views.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = views.iter().map(|(name, _)| *name).collect();
        let hint =
            nearest(name, &names).map_or_else(|| format!("views are {}", names.join(", ")), |near| format!("did you mean \"{near}\"?"));
        return Err(error(&node.origin, path, format_args!("there is no view {}; {hint}", quoted(name))));
    };
    // As if it lay in the folder, where its scene is.
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
        None => Err(format!("{stand_in} stands for {title}; --scenes takes a folder that has {file}.")),
        Some(folder) if !folder.join(&file).is_file() => {
            Err(format!("{stand_in} stands for {title}: {} is not there.", folder.join(&file).display()))
        }
        Some(_) => Ok((title, view)),
    })
}

const MEASURES: [&str; 6] = ["time", "ratio", "error", "flicker", "count", "memory"];

fn measure(node: &Node, path: &str, names: &Names) -> Result<Measure> {
    let Value::Table(tree) = &node.value else {
        return Err(error(&node.origin, path, format_args!("expects a table such as {{ time = \"gather\" }}, found {}", node.found())));
    };
    let kinds: Vec<&str> = MEASURES.into_iter().filter(|kind| tree.contains_key(*kind)).collect();
    let what = match kinds.as_slice() {
        ["time"] => What::Time { of: only_text(node, path, "time")? },
        ["count"] => What::Count { of: only_text(node, path, "count")? },
        ["memory"] => What::Memory { of: only_text(node, path, "memory")? },
        ["flicker"] => {
            let name = only_text(node, path, "flicker")?;
            What::Flicker { layer: Intensity::parse(&name).map_err(|cause| error(&node.origin, path, cause))? }
        }
        ["ratio"] => {
            section(node, path, &["ratio"])?;
            let path = join(path, "ratio");
            let tree = section(&tree["ratio"], &path, &["of", "over"])?;
            let get = |key: &str| match tree.get(key) {
                Some(node) => place(node, &join(&path, key), names),
                None => Err(error(&node.origin, &path, format_args!("needs {key}: the cell that the ratio is {key}"))),
            };
            What::Ratio { of: get("of")?, over: get("over")? }
        }
        ["error"] => error_measure(node, path, names)?,
        [] => {
            let key = tree.iter().next();
            let hint =
                key.and_then(|(key, _)| nearest(key, &MEASURES)).map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
            let origin = key.map_or(&node.origin, |(_, node)| &node.origin);
            return Err(error(origin, path, format_args!("expects one of {}{hint}", MEASURES.join(", "))));
        }
        several => return Err(error(&node.origin, path, format_args!("measures {} at once; give one", several.join(" and ")))),
    };
    if let What::Time { of } = &what {
        of.split('+').try_for_each(|part| check_timed(part, names.stages, &node.origin, path))?;
    }
    Ok(Measure { what, origin: node.origin.clone() })
}

/// The value of a measure that is a name alone.
fn only_text(node: &Node, path: &str, key: &str) -> Result<String> {
    let tree = section(node, path, &[key])?;
    text_of(&tree[key], &join(path, key)).map(str::to_owned)
}

fn error_measure(node: &Node, path: &str, names: &Names) -> Result<What> {
    let tree = section(node, path, &["error", "layer", "against"])?;
    let figures = Figure::ALL.map(|(name, _)| name);
    let name = text_of(&tree["error"], &join(path, "error"))?;
    let Some((_, figure)) = Figure::ALL.into_iter().find(|(known, _)| *known == name) else {
        let hint = nearest(name, &figures).map_or_else(String::new, |near| format!("; did you mean \"{near}\"?"));
        return Err(error(
            &tree["error"].origin,
            &join(path, "error"),
            format_args!("expects one of {}, found {}{hint}", figures.join(", "), quoted(name)),
        ));
    };
    let layer = match tree.get("layer") {
        None => LayerPair::radiance(),
        Some(node) => layer(node, &join(path, "layer"))?,
    };
    let against = match tree.get("against") {
        None => Against::Reference,
        Some(Node { value: Value::Text(name), .. }) if name == "reference" => Against::Reference,
        Some(node) if matches!(node.value, Value::Table(_)) => Against::Cell(place(node, &join(path, "against"), names)?),
        Some(node) => {
            let found = format_args!("expects \"reference\" or a cell such as {{ row = \"...\" }}, found {}", node.found()).to_string();
            return Err(error(&node.origin, &join(path, "against"), found));
        }
    };
    Ok(What::Error { figure, layer, against })
}

fn layer(node: &Node, path: &str) -> Result<LayerPair> {
    LayerPair::parse(text_of(node, path)?).map_err(|expected| error(&node.origin, path, expected))
}

fn place(node: &Node, path: &str, names: &Names) -> Result<Place> {
    let tree = section(node, path, &["row", "column"])?;
    let number = |key: &str, names: &[String]| -> Result<Option<usize>> {
        let Some(node) = tree.get(key) else { return Ok(None) };
        let path = join(path, key);
        let name = text_of(node, &path)?;
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        match names.iter().position(|known| *known == name) {
            Some(number) => Ok(Some(number)),
            None => {
                let hint = nearest(name, &names)
                    .map_or_else(|| format!("there are {}", names.join(", ")), |near| format!("did you mean \"{near}\"?"));
                Err(error(&node.origin, &path, format_args!("there is no {key} {}; {hint}", quoted(name))))
            }
        }
    };
    Ok(Place { row: number("row", &names.rows)?, column: number("column", &names.columns)? })
}

/// A stage is known by its name; a pass only to the frame that has it.
fn check_timed(of: &str, stages: &[&str], origin: &Origin, path: &str) -> Result<()> {
    let stages = [stages, &["frame"]].concat();
    let stage = of.split('/').next().unwrap_or(of);
    if stages.contains(&stage) {
        return Ok(());
    }
    let hint =
        nearest(stage, &stages).map_or_else(|| format!("stages are {}", stages.join(", ")), |near| format!("did you mean \"{near}\"?"));
    Err(error(origin, path, format_args!("there is no stage {}; {hint}", quoted(stage))))
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
    let names: Vec<&str> = rows.iter().filter(|row| !row.own).map(|row| row.name.as_str()).collect();
    let by_row = section(node, path, &names)?;
    let wanted: Vec<&Line> = columns.iter().filter(|column| !column.own).collect();
    let mut figures = vec![vec![None; columns.len()]; rows.len()];
    for (row, line) in rows.iter().enumerate().filter(|(_, line)| !line.own) {
        let Some(list) = by_row.get(&line.name) else {
            return Err(error(&node.origin, &join(path, &line.name), "is missing; a row that is not in the paper says own = true"));
        };
        let path = join(path, &line.name);
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

/// Every cell measures something, and no ratio is one of itself.
fn check_measures(table: &Table) -> Result<()> {
    for (row, column) in table.places() {
        let (of_row, of_column) = (&table.rows[row], &table.columns[column]);
        if of_row.measure.is_some() && of_column.measure.is_some() {
            let message =
                format_args!("row {} and column {} both say what their cell measures", quoted(&of_row.name), quoted(&of_column.name))
                    .to_string();
            return Err(error(&of_column.origin, &format!("column.{column}.measure"), message));
        }
        if of_row.measure.is_none() && of_column.measure.is_none() && table.measure.is_none() {
            return Err(error(
                &of_column.origin,
                &format!("column.{column}"),
                "its cells measure nothing; give a measure to it, to the rows or to the table",
            ));
        }
    }
    // Ratios are settled once the cells that they are of are.
    let mut settled = vec![vec![false; table.columns.len()]; table.rows.len()];
    loop {
        let is_ready = |(row, column): &(usize, usize)| match &table.measure(*row, *column).what {
            What::Ratio { of, over } => {
                [of, over].map(|place| place.from(*row, *column)).iter().all(|(row, column)| settled[*row][*column])
            }
            _ => true,
        };
        let open: Vec<(usize, usize)> = table.places().filter(|(row, column)| !settled[*row][*column]).collect();
        let ready: Vec<(usize, usize)> = open.iter().copied().filter(is_ready).collect();
        match (open.first(), ready.is_empty()) {
            (None, _) => return Ok(()),
            (Some(&(row, column)), true) => {
                let (row_name, column_name) = (quoted(&table.rows[row].name), quoted(&table.columns[column].name));
                let message = format!("the ratio in row {row_name}, column {column_name} comes back to itself");
                return Err(error(&table.measure(row, column).origin, "measure.ratio", message));
            }
            _ => ready.iter().for_each(|(row, column)| settled[*row][*column] = true),
        }
    }
}
