//! The line below the picture: what happens, and the values under the cursor.

use super::Panels;
use egui::{RichText, Ui};
use std::time::Duration;

impl Panels {
    pub(super) fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let waits = self.doing.filter(|(_, since)| since.elapsed() > Duration::from_millis(200));
            if let Some((what, since)) = waits {
                ui.spinner();
                ui.label(format!("{what} ({:.1} s)", since.elapsed().as_secs_f32()));
            } else if self.doing.is_some() {
                ui.ctx().request_repaint_after(Duration::from_millis(200));
            }
            if let Some(failed) = &self.failed {
                ui.label(RichText::new(failed).color(ui.visuals().error_fg_color));
            } else if let Some(said) = &self.said {
                ui.label(RichText::new(said).weak());
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if let Some(shown) = &self.shown {
                    let [width, height] = [shown.view.width, shown.view.height];
                    ui.label(format!("{:.0} ms, {width} x {height}", shown.frame_ms));
                }
                if let Some(flight) = &self.flight {
                    ui.separator();
                    ui.label(format!("{:.2} m/s", flight.speed)).on_hover_text("Speed of flight; the wheel changes it over the picture");
                }
                let values = self.under_cursor.and_then(|[x, y]| {
                    let texels = self.texels()?;
                    let values = texels.at(x, y, self.look.layer)?;
                    let values: Vec<String> = values[..texels.format.channels()].iter().map(|value| format!("{value:.5}")).collect();
                    Some(format!("({x}, {y}) {}", values.join("  ")))
                });
                if let Some(values) = values {
                    ui.separator();
                    ui.label(RichText::new(values).monospace());
                }
            });
        });
    }
}
