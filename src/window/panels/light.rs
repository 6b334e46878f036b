//! Why a pixel is lit: the VPLs that light it, with lines to them, and the way from their light to the picture and to the reference.

use super::vpls::Tells;
use super::{Panels, Tab};
use crate::color::luminance;
use crate::inspection::{Explanation, Lighting};
use crate::window::mailbox::{Shown, Truth};
use crate::world::projection::View;
use egui::{Color32, ComboBox, DragValue, Grid, Painter, Pos2, Rect, RichText, ScrollArea, Ui, pos2};
use glam::Vec3;

/// State of the question.
pub struct Question {
    /// The pixel that is asked about, of the whole picture.
    pub pixel: Option<[u32; 2]>,
    /// Lines that are drawn, to the brightest VPLs.
    lines: usize,
    only: Only,
    /// Bounce and number of the VPL under the cursor in the list.
    pointed: Option<(usize, usize)>,
    /// The reference at a pixel, and the number of the request that it is for.
    truth: Option<Truth>,
}

impl Default for Question {
    fn default() -> Self {
        Self { pixel: None, lines: 50, only: Only::All, pointed: None, truth: None }
    }
}

/// VPLs that are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Only {
    All,
    /// The gather sums light that rays do not let through.
    Leaks,
    /// Rays let light through that the visibility holds back.
    Lost,
}

/// How a VPL's visibility and rays agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Agreement {
    Lit,
    Leak,
    Lost,
    Dark,
}

/// Difference of the shares that counts as one.
const APART: f32 = 0.25;

fn agreement(light: &Lighting<'_>) -> Agreement {
    let by_rays = light.share.by_rays;
    // Where the visibility says nothing, rays alone do.
    let seen = if light.share.seen < 0.0 { by_rays } else { light.share.seen };
    match (seen - by_rays > APART, by_rays - seen > APART) {
        (true, _) => Agreement::Leak,
        (_, true) => Agreement::Lost,
        _ if by_rays > 0.0 => Agreement::Lit,
        _ => Agreement::Dark,
    }
}

impl Agreement {
    fn color(self) -> Color32 {
        match self {
            Self::Lit => Color32::from_rgb(255, 214, 90),
            Self::Leak => Color32::from_rgb(240, 80, 80),
            Self::Lost => Color32::from_rgb(90, 160, 255),
            Self::Dark => Color32::from_gray(120),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Lit => "lit",
            Self::Leak => "leak",
            Self::Lost => "lost",
            Self::Dark => "hidden",
        }
    }
}

impl Question {
    /// Whether a VPL is listed.
    fn lists(&self, light: &Lighting<'_>) -> bool {
        match self.only {
            Only::All => true,
            Only::Leaks => agreement(light) == Agreement::Leak,
            Only::Lost => agreement(light) == Agreement::Lost,
        }
    }

    /// Takes over what the reference has at the pixel.
    pub fn take(&mut self, truth: Option<Truth>) {
        self.truth = truth;
    }
}

impl Panels {
    /// The pixel that is asked about, if its tab is open.
    pub(super) fn asked_pixel(&self) -> Option<[u32; 2]> {
        self.question.pixel.filter(|_| self.tab == Tab::Light)
    }

    /// The explanation of the shown frame.
    fn explanation(&self) -> Option<&Explanation> {
        let explanation = self.shown.as_ref()?.inspected.explanation.as_ref()?;
        (self.asked_pixel() == Some(explanation.pixel)).then_some(explanation)
    }

    pub(super) fn light(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.checkbox(&mut self.overlay.shows, "VPLs over the picture");
            let label = ui.label("by").id;
            let list = ComboBox::from_id_salt("tells").selected_text(self.overlay.tells.name()).show_ui(ui, |ui| {
                for tells in [Tells::Light, Tells::Bounce, Tells::Map] {
                    ui.selectable_value(&mut self.overlay.tells, tells, tells.name());
                }
            });
            list.response.labelled_by(label);
        });
        ui.separator();
        let Some([x, y]) = self.question.pixel else {
            ui.label("Click on a pixel of the picture, and see which VPLs light it.");
            return;
        };
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("Pixel {x}, {y}")).strong());
            if ui.button("forget").clicked() {
                self.question.pixel = None;
            }
        });
        let Some(explanation) = self.explanation().cloned() else {
            // A moving camera's picture may be smaller than the one at rest.
            let is_outside = |shown: &Shown| shown.request.scale == 1.0 && (x >= shown.view.width || y >= shown.view.height);
            if !self.shown.as_deref().is_some_and(is_outside) {
                ui.spinner();
            } else {
                ui.label("The pixel is outside of this picture.");
            }
            return;
        };
        let Some((position, normal)) = explanation.surface else {
            ui.label("There is no surface: the pixel shows the sky.");
            return;
        };
        let spelled = |v: Vec3| format!("{:.3}, {:.3}, {:.3}", v.x, v.y, v.z);
        ui.label(format!("at {} m", spelled(position)));
        ui.label(format!("normal {}, albedo {}", spelled(normal), spelled(explanation.albedo)));
        ui.separator();
        let truth = self.question.truth.clone().filter(|truth| Some(truth.pixel) == self.question.pixel);
        // In both directions: a panel that grew with its table would move the picture under the pointer.
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            way(ui, &explanation, truth.as_ref());
            ui.separator();
            self.list(ui, &explanation);
        });
    }

    fn list(&mut self, ui: &mut Ui, explanation: &Explanation) {
        let all = explanation.lighting();
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.question.only, Only::All, "all VPLs")
                .on_hover_text("Those that bring light, or would if nothing shadowed them");
            ui.selectable_value(&mut self.question.only, Only::Leaks, "leaks")
                .on_hover_text("The visibility lets light through that rays stop");
            ui.selectable_value(&mut self.question.only, Only::Lost, "lost")
                .on_hover_text("The visibility stops light that rays let through");
        });
        let listed: Vec<&Lighting<'_>> = all.iter().filter(|light| self.question.lists(light)).collect();
        ui.horizontal(|ui| {
            let label = ui.label("lines to the first").id;
            ui.add(DragValue::new(&mut self.question.lines).range(0..=4096)).labelled_by(label);
            ui.label(format!("of {}", listed.len()));
            if ui.button("Copy as CSV").on_hover_text("All VPLs of the list, with all values").clicked() {
                ui.ctx().copy_text(csv(&listed));
            }
        });
        let sum = luminance(&explanation.sums().light.to_array());
        let mut pointed = None;
        Grid::new("vpls").striped(true).spacing([8.0, 2.0]).show(ui, |ui| {
            let heads = [
                ("VPL", "Number of the VPL, and its bounce if that is not the first"),
                ("W/m²", "Luminance of the irradiance that the gather sums of it, times the number of sample sets"),
                ("%", "Share of the gather's sum"),
                ("W/sr", "Luminance of its radiant intensity towards the pixel"),
                ("m", "Distance"),
                ("cos", "Cosine at the VPL"),
                ("cos", "Cosine at the surface"),
                ("seen", "Share that the config's visibility leaves"),
                ("rays", "Whether a ray reaches the VPL"),
                ("", "Where the two agree, and where they do not"),
            ];
            for (head, hint) in heads {
                ui.label(RichText::new(head).weak()).on_hover_text(hint);
            }
            ui.end_row();
            for light in listed.iter().take(MOST_ROWS) {
                let share = light.share;
                let brings = luminance(&share.light);
                let number = if light.bounce == 1 { light.index.to_string() } else { format!("{}#{}", light.index, light.bounce) };
                let color = agreement(light).color();
                let response = ui.label(RichText::new(number).monospace().color(color)).on_hover_text(agreement(light).name());
                let text = |ui: &mut Ui, text: String| drop(ui.label(RichText::new(text).monospace()));
                text(ui, format!("{brings:.4}"));
                text(ui, if sum > 0.0 { format!("{:.1}", 100.0 * brings / sum) } else { "-".to_owned() });
                text(ui, format!("{:.3}", luminance(&share.intensity)));
                text(ui, format!("{:.2}", light.distance));
                text(ui, format!("{:.2}", light.from));
                text(ui, format!("{:.2}", light.to));
                text(ui, if share.seen < 0.0 { "?".to_owned() } else { format!("{:.2}", share.seen) });
                text(ui, format!("{:.0}", share.by_rays));
                let last = ui.label(RichText::new(agreement(light).name()).color(color));
                let row = response.rect.union(last.rect);
                if ui.rect_contains_pointer(row) {
                    pointed = Some((light.bounce, light.index));
                }
                ui.end_row();
            }
        });
        if listed.len() > MOST_ROWS {
            ui.label(RichText::new(format!("and {} more; the CSV has them", listed.len() - MOST_ROWS)).weak());
        }
        self.question.pointed = pointed;
    }

    /// Draws the pixel that is asked about and lines to its VPLs over the picture that takes `place`.
    pub(super) fn lines(&self, painter: &Painter, place: Rect) {
        let (Some(explanation), Some(shown)) = (self.explanation(), &self.shown) else { return };
        let Some((position, _)) = explanation.surface else { return };
        let view = &shown.view;
        let on_screen = |[x, y]: [f64; 2]| {
            let share = [x / f64::from(view.width), y / f64::from(view.height)];
            pos2(place.min.x + share[0] as f32 * place.width(), place.min.y + share[1] as f32 * place.height())
        };
        let center = on_screen(explanation.pixel.map(|side| f64::from(side) + 0.5));
        let all = explanation.lighting();
        let listed = all.iter().filter(|light| self.question.lists(light));
        let most = all.first().map_or(1e-9, |light| luminance(&light.share.light)).max(1e-9);
        let pointed = |light: &Lighting<'_>| self.question.pointed == Some((light.bounce, light.index));
        let drawn = listed.enumerate().filter(|(place, light)| *place < self.question.lines || pointed(light));
        for (_, light) in drawn {
            let end = end_of(view, position, light.share.position.into()).map(on_screen);
            let Some(end) = end else { continue };
            let width = if pointed(light) { 3.0 } else { 0.6 + 1.6 * (luminance(&light.share.light) / most).sqrt() as f32 };
            let color = if pointed(light) { Color32::WHITE } else { agreement(light).color() };
            painter.line_segment([center, end], (width, color.gamma_multiply(0.8)));
            painter.circle_filled(end, width + 1.5, color);
        }
        cross(painter, center);
    }
}

/// Rows that are shown; a grid of thousands is slow.
const MOST_ROWS: usize = 300;

fn cross(painter: &Painter, at: Pos2) {
    for (color, width) in [(Color32::BLACK, 3.0), (Color32::WHITE, 1.0)] {
        painter.line_segment([pos2(at.x - 6.0, at.y), pos2(at.x + 6.0, at.y)], (width, color));
        painter.line_segment([pos2(at.x, at.y - 6.0), pos2(at.x, at.y + 6.0)], (width, color));
    }
}

/// Pixel of the end of a line from a point in sight to another point, cut where it passes the camera.
fn end_of(view: &View, from: Vec3, to: Vec3) -> Option<[f64; 2]> {
    if let Some((pixel, _)) = view.pixel_of(to) {
        return Some([pixel.x, pixel.y]);
    }
    let ahead = |at: Vec3| (at - Vec3::from(view.position)).dot(view.forward.into());
    let (near, far) = (ahead(to), ahead(from));
    let t = (far - 2.0 * view.near) / (far - near);
    let (pixel, _) = view.pixel_of(from + t.clamp(0.0, 1.0) * (to - from))?;
    Some([pixel.x, pixel.y])
}

/// The way from the VPLs' light to the picture, and what the reference has.
fn way(ui: &mut Ui, explanation: &Explanation, truth: Option<&Truth>) {
    let sums = explanation.sums();
    let row = |ui: &mut Ui, name: &str, value: Option<Vec3>, hint: &str| {
        ui.label(name).on_hover_text(hint);
        match value {
            None => drop(ui.label("?")),
            Some(value) => {
                let rgb = format!("{:.5}, {:.5}, {:.5} (R, G, B)", value.x, value.y, value.z);
                ui.label(RichText::new(format!("{:.4}", luminance(&value.to_array()))).monospace()).on_hover_text(rgb);
            }
        }
        ui.end_row();
    };
    ui.label(RichText::new("Indirect irradiance, W/m² (luminance)").strong());
    Grid::new("way").num_columns(2).striped(true).show(ui, |ui| {
        row(ui, "all VPLs, unshadowed", Some(sums.open), "Every VPL, whatever stands before it");
        row(ui, "all VPLs, by rays", Some(sums.by_rays), "Every VPL that a ray reaches: what perfect visibility would give");
        row(ui, "all VPLs, by the visibility", sums.seen, "Every VPL, shadowed as the config says");
        row(ui, "   of it leaks", sums.leaked, "Light that the visibility lets through and rays stop");
        row(ui, "   and lost", sums.lost, "Light that rays let through and the visibility stops");
        row(
            ui,
            "the gather's sum",
            Some(explanation.gathered),
            "VPLs of this pixel's sample set, times the number of sets, after roulette",
        );
        if sums.light != Vec3::ZERO || explanation.gathered == Vec3::ZERO {
            row(ui, "   less the VPLs below", Some(explanation.gathered - sums.light), "What the list does not explain: rounding");
        }
        row(ui, "from neighbours, by the filter", Some(explanation.irradiance - explanation.gathered), "What the filter adds or takes");
        row(ui, "after the filter", Some(explanation.irradiance), "The layer irradiance of the picture");
        if explanation.visible < 1.0 {
            let left = explanation.irradiance * explanation.visible;
            row(ui, "after ambient occlusion", Some(left), "What ambient occlusion leaves of it");
        }
        if let Some(truth) = truth {
            row(ui, "the reference", Some(truth.irradiance), "Of all of its bounces, where the surface reflects diffusely");
            let ours = explanation.irradiance * explanation.visible;
            row(ui, "   missing here", Some(truth.irradiance - ours), "The reference's less ours");
        }
    });
    ui.label(RichText::new("Radiance, W/(m² sr) (luminance)").strong());
    Grid::new("radiance").num_columns(2).striped(true).show(ui, |ui| {
        row(ui, "direct light", Some(explanation.direct), "Of the lights and the sky");
        row(ui, "indirect light", Some(explanation.indirect), "Irradiance times albedo over pi, and what a glossy receiver reflects");
        if let Some([_, after]) = explanation.reflection {
            row(ui, "   of it reflected by gloss", Some(after * explanation.visible), "By receivers with a GGX lobe");
        }
        let emitted = explanation.radiance - explanation.direct - explanation.indirect;
        if emitted.max_element() > 2e-3 * explanation.radiance.max_element() {
            row(ui, "emitted", Some(emitted), "By the surface itself");
        }
        row(ui, "the picture", Some(explanation.radiance), "The sum, before exposure");
        if let Some(truth) = truth {
            row(ui, "the reference", Some(truth.radiance), &format!("{} paths a pixel", truth.samples));
            row(ui, "   its standard error", Some(truth.error), "Of the mean over its paths");
            row(ui, "   direct", Some(truth.direct), "Its light without a bounce");
            for (bounce, light) in (1..).zip(&truth.bounces) {
                row(ui, &format!("   bounce {bounce}"), Some(*light), "Its light of this bounce");
            }
            row(ui, "   missing here", Some(truth.radiance - explanation.radiance), "The reference's less ours");
        }
    });
    if truth.is_none() {
        ui.label(RichText::new("Compare with the path tracer to see what is missing.").weak());
    }
}

/// The VPLs with all values, a line each.
fn csv(listed: &[&Lighting<'_>]) -> String {
    let heads = "bounce,vpl,x,y,z,normal_x,normal_y,normal_z,distance,cos_at_vpl,cos_at_surface,intensity_r,intensity_g,intensity_b,\
                 open_r,open_g,open_b,light_r,light_g,light_b,seen,by_rays,of_sample_set\n";
    let line = |light: &&Lighting<'_>| {
        let share = light.share;
        let first = [share.position, share.facing].concat();
        let middle = [light.distance, light.from, light.to];
        let colors = [share.intensity, share.open, share.light].concat();
        let last = [share.seen, share.by_rays, share.is_of_set as f32];
        let values: Vec<String> = [&first[..], &middle, &colors, &last].concat().iter().map(f32::to_string).collect();
        format!("{},{},{}\n", light.bounce, light.index, values.join(","))
    };
    heads.to_owned() + &listed.iter().map(line).collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aabb, Camera};

    #[test]
    fn a_line_to_a_vpl_behind_the_camera_leaves_the_picture_on_its_side() {
        let camera = Camera { name: String::new(), position: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y_deg: 60.0 };
        let view = View::new(&camera, [100, 100], Aabb { min: Vec3::splat(-5.0), max: Vec3::splat(5.0) });
        let from = Vec3::new(0.0, 0.0, -2.0);
        let [x, y] = end_of(&view, from, Vec3::new(1.0, 0.0, -2.0)).unwrap();
        assert!((50.0..100.0).contains(&x) && (y - 50.0).abs() < 1e-6, "{x}, {y}");
        let [x, y] = end_of(&view, from, Vec3::new(1.0, -0.5, 3.0)).unwrap();
        assert!(x > 100.0 && y > 100.0, "{x}, {y}");
    }
}
