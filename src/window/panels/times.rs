//! Times of the passes over the last frames, memory and warnings.

use super::Panels;
use crate::config::TimingMode;
use egui::{Color32, ComboBox, Grid, Rect, RichText, ScrollArea, Sense, Ui, Vec2};

impl Panels {
    pub(super) fn times(&mut self, ui: &mut Ui) {
        let Some(shown) = &self.shown else { return };
        let stages: Vec<&str> = unique(shown.times.iter().map(|(pass, _)| stage(pass)));
        self.graph(ui, &stages);
        let frame: f64 = shown.times.iter().map(|(_, ms)| ms).sum();
        ui.label(format!("passes {frame:.1} ms; request to frame {:.1} ms", shown.frame_ms));
        ui.label(RichText::new(&shown.device).weak());
        let now = timing_name(shown.config.frame.timing);
        ui.horizontal(|ui| {
            let label = ui.label("timing").id;
            let list = ComboBox::from_id_salt("timing").selected_text(now).show_ui(ui, |ui| {
                for (name, hint) in TIMINGS {
                    if ui.selectable_label(name == now, name).on_hover_text(hint).clicked() && name != now {
                        self.project.set("frame.timing", format!("{name:?}"));
                        self.times.clear();
                    }
                }
            });
            list.response.labelled_by(label);
        });
        let Some(shown) = &self.shown else { return };
        ui.separator();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.label(RichText::new(format!("Median of the last {} frames, ms", self.times.len())).strong());
            Grid::new("times").num_columns(2).striped(true).show(ui, |ui| {
                for (i, name) in stages.iter().enumerate() {
                    ui.label(RichText::new(*name).strong().color(color(i)));
                    ui.label(RichText::new(format!("{:.2}", self.median(|pass| stage(pass) == *name))).strong());
                    ui.end_row();
                    for (pass, _) in shown.times.iter().filter(|(pass, _)| stage(pass) == *name) {
                        ui.label(format!("   {pass}"));
                        ui.label(format!("{:.2}", self.median(|known| known == *pass)));
                        ui.end_row();
                    }
                }
            });
            ui.separator();
            let total: u64 = shown.memory.iter().map(|(_, bytes)| bytes).sum();
            ui.label(RichText::new(format!("Memory of the frame: {:.1} MB", total as f64 / 1e6)).strong());
            let mut memory: Vec<&(String, u64)> = shown.memory.iter().collect();
            memory.sort_by_key(|(_, bytes)| std::cmp::Reverse(*bytes));
            Grid::new("memory").num_columns(2).striped(true).show(ui, |ui| {
                for (name, bytes) in memory.into_iter().take(40) {
                    ui.label(name);
                    ui.label(format!("{:.2} MB", *bytes as f64 / 1e6));
                    ui.end_row();
                }
            });
            ui.separator();
            ui.label(RichText::new("Counts").strong());
            Grid::new("counts").num_columns(2).striped(true).show(ui, |ui| {
                for (name, count) in &shown.counts {
                    ui.label(name);
                    ui.label(count.to_string());
                    ui.end_row();
                }
            });
        });
    }

    pub(super) fn warnings(&mut self, ui: &mut Ui) {
        let Some(shown) = &self.shown else { return };
        if shown.warnings.is_empty() {
            ui.label("None.");
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for warning in &shown.warnings {
                ui.label(warning);
                ui.separator();
            }
        });
    }

    /// Times of the stages, stacked, a column a frame.
    fn graph(&self, ui: &mut Ui, stages: &[&str]) {
        let (area, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 90.0), Sense::hover());
        let painter = ui.painter_at(area);
        painter.rect_filled(area, 2.0, ui.visuals().extreme_bg_color);
        let total = |frame: &Vec<(&str, f64)>| frame.iter().map(|(_, ms)| ms).sum::<f64>();
        let most = self.times.iter().map(total).fold(1e-3, f64::max);
        let width = area.width() / super::FRAMES as f32;
        for (i, frame) in self.times.iter().enumerate() {
            let mut bottom = area.bottom();
            for (number, name) in stages.iter().enumerate() {
                let ms: f64 = frame.iter().filter(|(pass, _)| stage(pass) == *name).map(|(_, ms)| ms).sum();
                let height = (ms / most) as f32 * area.height();
                let left = area.left() + i as f32 * width;
                let bar = Rect::from_min_max(egui::pos2(left, bottom - height), egui::pos2(left + width, bottom));
                painter.rect_filled(bar, 0.0, color(number));
                bottom -= height;
            }
        }
        response.on_hover_text(format!("Times of the stages over the last {} frames; the highest is {most:.1} ms", super::FRAMES));
    }

    /// Median over the frames of the sum of some passes, ms.
    fn median(&self, is_of: impl Fn(&str) -> bool) -> f64 {
        let of = |frame: &Vec<(&'static str, f64)>| frame.iter().filter(|(pass, _)| is_of(pass)).map(|(_, ms)| ms).sum::<f64>();
        let mut sums: Vec<f64> = self.times.iter().map(of).collect();
        sums.sort_unstable_by(f64::total_cmp);
        sums.get(sums.len() / 2).copied().unwrap_or(0.0)
    }
}

const TIMINGS: [(&str, &str); 3] = [
    ("isolated", "A full barrier around each pass: passes sum to the frame"),
    ("overlapped", "Only the barriers that hazards need"),
    ("serial", "Pass by pass, by the host's clock"),
];

fn timing_name(timing: TimingMode) -> &'static str {
    match timing {
        TimingMode::Isolated => TIMINGS[0].0,
        TimingMode::Overlapped => TIMINGS[1].0,
        TimingMode::Serial => TIMINGS[2].0,
    }
}

/// The stage of a pass: the part of its name before the slash.
fn stage(pass: &str) -> &str {
    pass.split('/').next().unwrap_or(pass)
}

fn unique<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut known: Vec<&str> = Vec::new();
    names.for_each(|name| {
        if !known.contains(&name) {
            known.push(name);
        }
    });
    known
}

/// Colours that neighbours in a stack tell apart.
fn color(number: usize) -> Color32 {
    const COLORS: [[u8; 3]; 8] =
        [[78, 121, 167], [242, 142, 43], [89, 161, 79], [225, 87, 89], [118, 183, 178], [237, 201, 72], [176, 122, 161], [156, 117, 95]];
    let [r, g, b] = COLORS[number % COLORS.len()];
    Color32::from_rgb(r, g, b)
}
