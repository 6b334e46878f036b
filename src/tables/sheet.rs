//! The pictures of a table's cells side by side.

use super::folders::{is_done, run_folder};
use super::{Plan, Table};
use crate::fail;
use crate::output::{read_png, write_png};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Gap between two pictures, pixels.
const GAP: usize = 4;

/// Writes `sheet.png`, with a picture at the place of each cell, if all runs are done. A row or a column whose pictures are those of an earlier
/// one is left out. Returns its path.
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
    let across = |count: usize, side: usize| count * (side + GAP) - GAP;
    let size = [across(columns.len(), width), across(rows.len(), height)];
    let mut pixels = vec![255u8; 3 * size[0] * size[1]];
    for (at_row, at_column) in (0..rows.len()).flat_map(|row| (0..columns.len()).map(move |column| (row, column))) {
        let path = path(rows[at_row], columns[at_column]);
        let picture = read_png(&path)?;
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
    let sheet = folder.join("sheet.png");
    write_png(&sheet, size[0] as u32, size[1] as u32, &pixels)?;
    Ok(Some(sheet))
}

/// Numbers of the lines that are like none before them.
fn distinct<'k>(count: usize, line: impl Fn(usize) -> Vec<&'k str>) -> Vec<usize> {
    let mut seen = std::collections::BTreeSet::new();
    (0..count).filter(|number| seen.insert(line(*number))).collect()
}

#[cfg(test)]
mod tests {
    use super::distinct;

    #[test]
    fn a_line_with_the_pictures_of_an_earlier_one_is_left_out() {
        let lines = [vec!["a", "b"], vec!["a", "c"], vec!["a", "b"], vec!["b", "a"], vec!["a", "c"]];
        assert_eq!(distinct(5, |number| lines[number].clone()), [0, 1, 3]);
    }
}
