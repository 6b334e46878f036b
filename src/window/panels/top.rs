//! The bar above the picture: preset, files, what is shown.

use super::Panels;
use crate::config::{self, Config};
use crate::presets;
use egui::{Button, ComboBox, Key, Modifiers, Theme, Ui};
use std::path::{Path, PathBuf};

impl Panels {
    pub(super) fn top(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            self.preset(ui);
            ui.separator();
            let shown = self.shown.is_some();
            let hint = "Write the config as it stands, with all changes, as TOML that render takes";
            if ui.add_enabled(shown, Button::new("Save config")).on_hover_text(hint).clicked() {
                self.save_config();
            }
            let wants_picture = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::S));
            let wants_line = ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::K));
            let hint = "Copy the command line that makes this picture, byte by byte (Ctrl+K)";
            if ui.button("Copy command").on_hover_text(hint).clicked() || wants_line {
                ui.ctx().copy_text(self.project.command(self.frame));
                self.said = Some("the command line is in the clipboard".to_owned());
            }
            let hint = "Write the picture as PNG, all layers as EXR, as render does, and the config beside them (Ctrl+S)";
            if ui.add_enabled(shown, Button::new("Save picture")).on_hover_text(hint).clicked() || (wants_picture && shown) {
                self.save = Some(self.folder());
            }
            let hint = "Take back every change that was made here";
            if ui.add_enabled(self.project.has_changes(), Button::new("Reset all")).on_hover_text(hint).clicked() {
                self.project.reset_all();
            }
            ui.separator();
            self.time(ui);
            ui.separator();
            ui.checkbox(&mut self.fits, "fit").on_hover_text("Scale the picture to the window; else a pixel is a pixel (1)");
            if ui.checkbox(&mut self.smooth, "smooth").on_hover_text("Filter the picture where it is scaled").changed() {
                self.is_stale = true;
            }
            ui.checkbox(&mut self.waits_for_display, "vsync").on_hover_text("Wait for the display's refresh (V)");
            ui.checkbox(&mut self.overlay.shows, "VPLs")
                .on_hover_text("Draw the VPLs over what is shown; point at one to see its shadow map");
            ui.checkbox(&mut self.has_handles, "lights").on_hover_text("Handles of the config's lights: drag places, turn directions");
            let mut light = !ui.visuals().dark_mode;
            if ui.checkbox(&mut light, "bright").on_hover_text("Bright panels").changed() {
                ui.ctx().set_theme(if light { Theme::Light } else { Theme::Dark });
            }
        });
    }

    fn preset(&mut self, ui: &mut Ui) {
        let name = self.project.config.to_string_lossy().into_owned();
        let label = ui.label("preset").id;
        let names = ComboBox::from_id_salt("preset").height(420.0).selected_text(short(&name)).show_ui(ui, |ui| {
            for (preset, text) in presets::all() {
                let chosen = ui.selectable_label(preset == name, preset).on_hover_text(presets::title(text));
                if chosen.clicked() && preset != name {
                    self.switch(preset);
                }
            }
        });
        names.response.labelled_by(label);
    }

    /// Shows the scene by another preset.
    fn switch(&mut self, preset: &str) {
        match self.whole_config() {
            Ok(config) => self.project = self.project.by_preset(preset, &config),
            Err(error) => self.failed = Some(format!("{error:#}")),
        }
    }

    fn time(&mut self, ui: &mut Ui) {
        let count = self.shown.as_ref().map_or(1, |shown| shown.last_frame + 1);
        let label = ui.label("frame").id;
        let slider = egui::Slider::new(&mut self.frame, 0..=count - 1);
        ui.add_enabled(count > 1, slider).labelled_by(label).on_hover_text("Frame of the config's animation, or of the scene's");
        let text = if self.is_playing { "Pause" } else { "Play" };
        if ui.add_enabled(count > 1, Button::new(text)).clicked() {
            self.is_playing = !self.is_playing;
            if self.is_playing {
                self.frame = (self.frame + 1) % count;
            }
        }
        let (text, hint) = match &self.recording {
            None => ("Record", "Record the flight as keyframes of the camera"),
            Some(_) => ("Stop", "End the flight, and make it the camera's path"),
        };
        if ui.add_enabled(self.flight.is_some(), Button::new(text)).on_hover_text(hint).clicked() {
            self.toggle_recording();
        }
        let left = !self.recorded.is_empty() && !self.project.is_changed("camera.keyframes") && self.recording.is_none();
        if left && ui.button("Fly it again").on_hover_text("Make the recorded flight the camera's path").clicked() {
            self.show_flight();
        }
    }

    /// Name of the config, which what is saved has, too: figures are listed under it.
    fn name(&self) -> String {
        self.project.config.file_stem().map_or("view".into(), |name| name.to_string_lossy().into_owned())
    }

    /// Folder of what is saved.
    fn folder(&self) -> PathBuf {
        Path::new("out").join(format!("{}-view", self.name()))
    }

    /// The config as it stands, whatever the last frame was rendered by.
    pub(super) fn whole_config(&self) -> anyhow::Result<Config> {
        let (path, overrides) = (&self.project.config, self.project.overrides());
        let loaded = match presets::find_unless(&path.to_string_lossy(), path) {
            Some(text) => config::parse_preset(text, &path.with_extension("toml"), &overrides),
            None => config::load(path, &overrides),
        };
        Ok(loaded?.config)
    }

    /// Writes the config as it stands.
    pub(super) fn save_config(&mut self) {
        let path = self.folder().join(self.name()).with_extension("toml");
        let written = self.whole_config().and_then(|config| {
            crate::files::prepare_folder(&self.folder())?;
            crate::files::write_file(&path, config::to_toml(&config).as_bytes())
        });
        match written {
            Ok(()) => self.said = Some(format!("written: {}", path.display())),
            Err(error) => self.failed = Some(format!("{error:#}")),
        }
    }
}

/// The end of a path.
fn short(name: &str) -> String {
    Path::new(name).file_name().map_or_else(|| name.to_owned(), |name| name.to_string_lossy().into_owned())
}
