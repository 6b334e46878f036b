//! `manylight export mitsuba CONFIG`: a frame's scene for another renderer.

use super::setup::Setup;
use crate::cli::{ExportFormat, MitsubaArgs};
use crate::export::mitsuba::{self, Shot};
use crate::files::prepare_folder;
use crate::scene::source::load_scene;
use crate::world::view;
use anyhow::Result;

/// Writes the scene in the given format. Prints its path, and to stderr the differences from our own picture.
pub fn run(format: &ExportFormat) -> Result<()> {
    match format {
        ExportFormat::Mitsuba(args) => to_mitsuba(args),
    }
}

fn to_mitsuba(args: &MitsubaArgs) -> Result<()> {
    let Setup { config, warnings: of_config, .. } = Setup::load(&args.config, &args.overrides())?;
    let folder = args.output();
    prepare_folder(&folder)?;
    let (mut scene, of_scene) = load_scene(&config.scene)?;
    let mut warnings = [of_config, of_scene].concat();
    // A render keeps its last frame.
    let frame = args.frame.unwrap_or(config.frame.count - 1);
    let camera = view::camera(&config, &scene, scene.bounds(), frame)?;
    let lights = view::lights(&config, &scene, frame);
    scene.set_time(view::seconds(&config, frame));
    let shot = Shot { scene: &scene, camera: &camera, lights: &lights, size: config.frame.size, dielectric: config.materials.dielectric };
    let (path, differs) = mitsuba::write(&folder, &shot)?;
    warnings.extend(differs);
    if config.rsm.bounds.is_some() {
        warnings.push("rsm.box: Mitsuba's directional lights reach all of the scene".to_owned());
    }
    warnings.iter().for_each(|warning| eprintln!("manylight: warning: {warning}"));
    println!("{}", path.display());
    Ok(())
}
