//! `manylight report`: runs, tables and their errors as one HTML file.

use crate::cli::ReportArgs;
use crate::files::{prepare_folder, write_file};
use crate::report::html;
use anyhow::Result;

/// Writes the page and prints its path.
pub fn run(args: &ReportArgs) -> Result<()> {
    // The folder is made before any picture is compared.
    args.output.parent().filter(|folder| !folder.as_os_str().is_empty()).map_or(Ok(()), prepare_folder)?;
    let page = html::report(&args.folders, &args.layers)?;
    write_file(&args.output, page.as_bytes())?;
    println!("{}", args.output.display());
    Ok(())
}
