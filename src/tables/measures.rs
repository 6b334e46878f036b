//! Reading the measures of cells from a table's file.

use super::nodes::{section, text_of};
use super::{Against, Figure, Measure, Place, Table, What};
use crate::config::check::error;
use crate::config::nearest;
use crate::config::tree::{Node, Origin, Table as Tree, Value, join, quoted};
use crate::metrics::{Intensity, LayerPair};
use anyhow::Result;

/// Names that measures may refer to.
pub struct Names<'s> {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    pub stages: &'s [&'s str],
}

const MEASURES: [&str; 6] = ["time", "ratio", "error", "flicker", "count", "memory"];

pub fn measure(node: &Node, path: &str, names: &Names) -> Result<Measure> {
    let Value::Table(tree) = &node.value else {
        return Err(error(&node.origin, path, format_args!("expects a table such as {{ time = \"gather\" }}, found {}", node.found())));
    };
    let kinds: Vec<&str> = MEASURES.into_iter().filter(|kind| tree.contains_key(*kind)).collect();
    let mut seeds = 1;
    let what = match kinds.as_slice() {
        ["time"] => What::Time { of: only_text(node, path, "time")? },
        ["count"] => What::Count { of: only_text(node, path, "count")? },
        ["memory"] => What::Memory { of: only_text(node, path, "memory")? },
        ["flicker"] => {
            let tree = section(node, path, &["flicker", "seeds"])?;
            seeds = seeds_of(tree, path)?;
            let name = text_of(&tree["flicker"], &join(path, "flicker"))?;
            What::Flicker { layer: Intensity::parse(name).map_err(|cause| error(&node.origin, path, cause))? }
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
        ["error"] => {
            seeds = seeds_of(tree, path)?;
            error_measure(node, path, names)?
        }
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
        of.split('+').try_for_each(|part| check_timed(part.trim_end_matches('?'), names.stages, &node.origin, path))?;
    }
    Ok(Measure { what, seeds, origin: node.origin.clone() })
}

/// The value of a measure that is only a name.
fn only_text(node: &Node, path: &str, key: &str) -> Result<String> {
    let tree = section(node, path, &[key])?;
    text_of(&tree[key], &join(path, key)).map(str::to_owned)
}

/// Number of seeds whose mean a cell shows.
fn seeds_of(tree: &Tree, path: &str) -> Result<u32> {
    match tree.get("seeds") {
        None => Ok(1),
        Some(Node { value: Value::Whole(n), .. }) if (2..=1024).contains(n) => Ok(*n as u32),
        Some(node) => {
            let found = format_args!("expects a whole number from 2 to 1024, found {}", node.found()).to_string();
            Err(error(&node.origin, &join(path, "seeds"), found))
        }
    }
}

fn error_measure(node: &Node, path: &str, names: &Names) -> Result<What> {
    let tree = section(node, path, &["error", "layer", "against", "seeds"])?;
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

pub fn place(node: &Node, path: &str, names: &Names) -> Result<Place> {
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
    let place = Place { row: number("row", &names.rows)?, column: number("column", &names.columns)? };
    if place == (Place { row: None, column: None }) {
        return Err(error(&node.origin, path, "names neither a row nor a column"));
    }
    Ok(place)
}

/// Checks the stage of a timed name. Passes are only known to a described frame.
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

/// Checks that every cell has exactly one measure, and that no ratio refers to itself.
pub fn check_measures(table: &Table) -> Result<()> {
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
    // A ratio is settled when both of its cells are.
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
