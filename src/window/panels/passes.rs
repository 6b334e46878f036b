//! The passes of the frame, and how the chosen one's image is made visible.

use super::Panels;
use crate::graph::{Output, Rows};
use crate::window::PICTURE;
use crate::window::look::{Channel, Look};
use egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, Ui};

/// Lines above the list of passes: an image's name, its shape, layer, channel, range and the way in which it is shown.
const LOOK_ROWS: f32 = 6.0;

impl Panels {
    pub(super) fn passes(&mut self, ui: &mut Ui) {
        let Some(shown) = &self.shown else { return };
        if ui.button("Back to the picture").clicked() {
            (self.pass, self.image, self.look, self.is_stale) = (PICTURE.0, PICTURE.1.to_owned(), Look::default(), true);
        }
        let outputs = shown.outputs.clone();
        // The list below stays in place, whatever is chosen.
        let height = LOOK_ROWS * (ui.spacing().interact_size.y + ui.spacing().item_spacing.y);
        ui.allocate_ui(egui::vec2(ui.available_width(), height), |ui| {
            ui.set_min_height(height);
            match self.rows() {
                Some(rows) => {
                    ui.label(RichText::new(&self.image).strong());
                    ui.label(format!("a buffer of {} elements, {} columns", rows.len(), rows.columns.len()));
                }
                None => self.look_of_image(ui),
            }
        });
        ui.separator();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (pass, written) in outputs {
                ui.label(pass);
                ui.indent(pass, |ui| {
                    for Output { name, is_image } in written {
                        let chosen = self.pass == pass && self.image == name;
                        let text = if is_image { RichText::new(&name) } else { RichText::new(&name).weak() };
                        let hint = if is_image { "An image" } else { "A buffer, shown as a table" };
                        if ui.selectable_label(chosen, text).on_hover_text(hint).clicked() && !chosen {
                            (self.pass, self.image, self.look, self.is_stale) = (pass, name, Look::default(), true);
                        }
                    }
                });
            }
        });
    }

    /// The buffer that is chosen, of the last frame.
    fn rows(&self) -> Option<Rows<'_>> {
        let dumps = &self.shown.as_ref()?.dumps;
        Rows::of(&dumps.iter().find(|dump| dump.pass == self.pass && dump.resource == self.image)?.data)
    }

    /// Shows the chosen buffer as a table; returns whether a buffer is chosen.
    pub(super) fn buffer(&self, ui: &mut Ui) -> bool {
        let Some(rows) = self.rows() else { return false };
        ui.label(RichText::new(format!("{}: {} elements", self.image, rows.len())).strong());
        let widths: Vec<usize> = rows.columns.iter().map(|column| column.len().max(11)).collect();
        let line = |first: &str, cells: &[String]| {
            let cells: String = cells.iter().zip(&widths).map(|(cell, width)| format!(" {cell:>width$}")).collect();
            RichText::new(format!("{first:>8}{cells}")).monospace()
        };
        ScrollArea::horizontal().id_salt("columns").auto_shrink(false).show(ui, |ui| {
            ui.label(line("", &rows.columns).strong());
            let height = ui.text_style_height(&egui::TextStyle::Monospace);
            ScrollArea::vertical().id_salt("rows").auto_shrink(false).show_rows(ui, height, rows.len(), |ui, range| {
                range.for_each(|row| drop(ui.add(egui::Label::new(line(&row.to_string(), &rows.row(row))).extend())));
            });
        });
        true
    }

    fn look_of_image(&mut self, ui: &mut Ui) {
        let Some(texels) = self.texels() else { return };
        let (layers, channels, format, size) = (texels.layers, texels.format.channels(), texels.format, texels.size);
        ui.label(RichText::new(&self.image).strong());
        ui.label(format!("{} x {}, {layers} layer{}, {format:?}", size[0], size[1], if layers == 1 { "" } else { "s" }));
        let before = self.look.clone();
        let look = &mut self.look;
        Grid::new("look").num_columns(2).show(ui, |ui| {
            if layers > 1 {
                let label = ui.label("layer").id;
                ui.add(egui::Slider::new(&mut look.layer, 0..=layers - 1)).labelled_by(label);
                ui.end_row();
            }
            let label = ui.label("channel").id;
            let name = |channel: Channel| match channel {
                Channel::All => "all".to_owned(),
                Channel::One(channel) => "RGBA"[channel..=channel].to_owned(),
            };
            let names = ComboBox::from_id_salt("channel").selected_text(name(look.channel)).show_ui(ui, |ui| {
                for channel in [Channel::All].into_iter().chain((0..channels).map(Channel::One)) {
                    ui.selectable_value(&mut look.channel, channel, name(channel));
                }
            });
            names.response.labelled_by(label);
            ui.end_row();
            let label = ui.label("range").id;
            ui.horizontal(|ui| {
                let mut auto = look.range.is_none();
                if ui.checkbox(&mut auto, "auto").changed() {
                    look.range = (!auto).then_some(self.range);
                }
                let mut range = look.range.unwrap_or(self.range);
                let mut changed = false;
                for bound in &mut range {
                    let speed = f64::from(bound.abs() / 100.0).max(1e-3);
                    changed |= ui.add(DragValue::new(bound).speed(speed).max_decimals(5)).labelled_by(label).changed();
                }
                if changed {
                    look.range = Some(range);
                }
            });
            ui.end_row();
            ui.label("");
            ui.horizontal(|ui| {
                ui.checkbox(&mut look.log, "logarithm");
                ui.checkbox(&mut look.false_color, "false colours");
            });
            ui.end_row();
        });
        self.is_stale |= *look != before;
    }
}
