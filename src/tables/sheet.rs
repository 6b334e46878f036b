//! The pictures of a table's cells side by side.

use super::folders::{is_done, run_folder};
use super::{Plan, Table};
use crate::fail;
use crate::output::{read_png, write_png};
use anyhow::Result;
use std::path::{Path, PathBuf};

/// Gap between two pictures, pixels.
const GAP: usize = 4;

/// Writes `sheet.png`, with a picture at the place of each cell, if all runs are done. Returns its path.
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
    let across = |count: usize, side: usize| count * (side + GAP) - GAP;
    let size = [across(table.columns.len(), width), across(table.rows.len(), height)];
    let mut pixels = vec![255u8; 3 * size[0] * size[1]];
    for (row, column) in table.places() {
        let path = path(row, column);
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
            let at = 3 * ((row * (height + GAP) + y) * size[0] + column * (width + GAP));
            let bytes = line.iter().map(|value| (value * 255.0).round() as u8);
            pixels[at..at + 3 * width].iter_mut().zip(bytes).for_each(|(pixel, byte)| *pixel = byte);
        }
    }
    let sheet = folder.join("sheet.png");
    write_png(&sheet, size[0] as u32, size[1] as u32, &pixels)?;
    Ok(Some(sheet))
}
