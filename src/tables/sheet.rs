//! The pictures of a table's cells side by side.

use super::folders::{is_done, reference_folder, run_folder};
use super::{Plan, Table};
use crate::fail;
use crate::output::{read_png, write_png};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Gap between two pictures, pixels.
const GAP: usize = 4;

/// Writes `sheet.png`, with a picture at the place of each cell, if all runs are done. A row or a column whose pictures are those of an earlier
/// one is left out. References come last: in a row if the cells of each column share one, in a column if those of each row do. Returns its path.
///
/// # Errors
/// `BadInput` for a picture that cannot be read or differs in size from the first, `OutputNotWritten` for the sheet.
pub fn write(table: &Table, plan: &Plan, folder: &Path) -> Result<Option<PathBuf>> {
    if !table.places().all(|(row, column)| is_done(folder, plan.run(row, column))) {
        return Ok(None);
    }
    let path = |row, column| run_folder(folder, plan.run(row, column)).join("image.png");
    let first = read_png(&path(0, 0))?;
    let (width, height) = (first.width as usize, first.height as usize);
    let key = |row: usize, column: usize| plan.run(row, column).key.as_str();
    let all = [table.rows.len(), table.columns.len()];
    let rows = distinct(all[0], |row| (0..all[1]).map(|column| key(row, column)).collect());
    let columns = distinct(all[1], |column| (0..all[0]).map(|row| key(row, column)).collect());
    let mut paths: Vec<Vec<PathBuf>> = rows.iter().map(|row| columns.iter().map(|column| path(*row, *column)).collect()).collect();
    let truth = |(row, column): (usize, usize)| {
        let run = plan.run(row, column);
        run.needs_reference.then(|| reference_folder(folder, &run.reference_key(table)).join("image.png"))
    };
    let of_column = |column: &usize| shared(rows.iter().map(|row| truth((*row, *column))));
    let of_row = |row: &usize| shared(columns.iter().map(|column| truth((*row, *column))));
    if let Some(truths) = columns.iter().map(of_column).collect::<Option<Vec<_>>>() {
        paths.push(truths);
    } else if let Some(truths) = rows.iter().map(of_row).collect::<Option<Vec<_>>>() {
        paths.iter_mut().zip(truths).for_each(|(row, truth)| row.push(truth));
    }
    let across = |count: usize, side: usize| count * (side + GAP) - GAP;
    let size = [across(paths[0].len(), width), across(paths.len(), height)];
    let mut pixels = vec![255u8; 3 * size[0] * size[1]];
    for (at_row, row) in paths.iter().enumerate() {
        for (at_column, path) in row.iter().enumerate() {
            let picture = read_png(path)?;
            if (picture.width, picture.height) != (first.width, first.height) {
                return Err(fail!(
                    BadInput,
                    "{}: has {}x{} pixels, the sheet's first picture {width}x{height}; give all cells of {} one frame.size",
                    path.display(),
                    picture.width,
                    picture.height,
                    table.name
                ));
            }
            for (y, line) in picture.values.chunks_exact(3 * width).enumerate() {
                let at = 3 * ((at_row * (height + GAP) + y) * size[0] + at_column * (width + GAP));
                let bytes = line.iter().map(|value| (value * 255.0).round() as u8);
                pixels[at..at + 3 * width].iter_mut().zip(bytes).for_each(|(pixel, byte)| *pixel = byte);
            }
        }
    }
    let sheet = folder.join("sheet.png");
    write_png(&sheet, size[0] as u32, size[1] as u32, &pixels)?;
    Ok(Some(sheet))
}

/// What all that have one share.
fn shared(mut truths: impl Iterator<Item = Option<PathBuf>>) -> Option<PathBuf> {
    let first = truths.find_map(|truth| truth)?;
    truths.flatten().all(|truth| truth == first).then_some(first)
}

/// Numbers of the lines that are like none before them.
fn distinct<'k>(count: usize, line: impl Fn(usize) -> Vec<&'k str>) -> Vec<usize> {
    let mut seen = std::collections::BTreeSet::new();
    (0..count).filter(|number| seen.insert(line(*number))).collect()
}

#[cfg(test)]
mod tests {
    use super::{distinct, shared};
    use std::path::PathBuf;

    #[test]
    fn one_reference_stands_for_all_that_have_it_and_none_for_several() {
        let of = |names: &[&str]| shared(names.iter().map(|name| (!name.is_empty()).then(|| PathBuf::from(name))));
        assert_eq!(of(&["", "a", "", "a"]), Some("a".into()));
        assert_eq!((of(&["a", "b"]), of(&["", ""])), (None, None));
    }

    #[test]
    fn a_line_with_the_pictures_of_an_earlier_one_is_left_out() {
        let lines = [vec!["a", "b"], vec!["a", "c"], vec!["a", "b"], vec!["b", "a"], vec!["a", "c"]];
        assert_eq!(distinct(5, |number| lines[number].clone()), [0, 1, 3]);
    }
}
