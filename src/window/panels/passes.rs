//! The passes of the frame, and how the chosen one's image is made visible.

use super::Panels;
use crate::window::PICTURE;
use crate::window::look::{Channel, Look};
use egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, Ui};

impl Panels {
    pub(super) fn passes(&mut self, ui: &mut Ui) {
        let Some(shown) = &self.shown else { return };
        if ui.button("Back to the picture").clicked() {
            (self.pass, self.image, self.look, self.is_stale) = (PICTURE.0, PICTURE.1.to_owned(), Look::default(), true);
        }
        let outputs = shown.outputs.clone();
        self.look_of_image(ui);
        ui.separator();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for (pass, images) in outputs {
                if images.is_empty() {
                    ui.label(RichText::new(pass).weak()).on_hover_text("It writes buffers alone");
                    continue;
                }
                ui.label(pass);
                ui.indent(pass, |ui| {
                    for image in images {
                        let chosen = self.pass == pass && self.image == image;
                        if ui.selectable_label(chosen, &image).clicked() && !chosen {
                            (self.pass, self.image, self.look, self.is_stale) = (pass, image, Look::default(), true);
                        }
                    }
                });
            }
        });
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
