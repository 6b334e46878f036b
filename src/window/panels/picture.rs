//! The picture: shown, flown through, and read pixel by pixel.

use super::{Panels, Tab};
use crate::window::flight::Push;
use egui::{Color32, Event, Key, PointerButton, Pos2, Rect, Sense, Ui, Vec2};
use glam::Vec2 as Angles;

/// Radians that the camera turns when the pointer crosses the picture.
const TURN: f32 = 2.0;

impl Panels {
    pub(super) fn picture(&mut self, ui: &mut Ui) {
        if self.buffer(ui) {
            return;
        }
        self.bring_texture(ui.ctx());
        let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let Some(texture) = &self.texture else {
            let text = self.doing.map_or("starting", |(what, _)| what);
            ui.painter().text(
                area.center(),
                egui::Align2::CENTER_CENTER,
                text,
                egui::FontId::proportional(16.0),
                ui.visuals().weak_text_color(),
            );
            return;
        };
        let [width, height] = self.texels().map_or([1, 1], |texels| texels.size);
        let size = Vec2::new(width as f32, height as f32);
        let pixels = ui.ctx().pixels_per_point();
        // A smaller picture of a moving camera takes the place of the whole one.
        let at_rest = self.shown.as_ref().map_or(1.0, |shown| shown.request.scale);
        let natural = size / at_rest / pixels;
        let fit = (area.size() / natural).min_elem();
        let size = if self.fits { natural * fit } else { natural };
        let corner = area.center() - size * 0.5;
        // On whole pixels, so that a pixel is a pixel.
        let corner = Pos2::new((corner.x * pixels).round() / pixels, (corner.y * pixels).round() / pixels);
        let place = Rect::from_min_size(corner, size);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        let painter = ui.painter_at(area);
        painter.image(texture.id(), place, whole, Color32::WHITE);
        if let Some((other, takes_all)) = self.compare.beside() {
            let split = if takes_all { 0.0 } else { self.compare.split.unwrap_or(0.5) };
            let left = place.min.x + split * place.width();
            let right = Rect::from_min_max(Pos2::new(left, place.min.y), place.max);
            painter.image(other.id(), right, Rect::from_min_max(Pos2::new(split, 0.0), Pos2::new(1.0, 1.0)), Color32::WHITE);
            if !takes_all {
                painter.vline(left, place.y_range(), (1.0, Color32::WHITE));
            }
        }

        self.lines(&painter, place);
        self.vpls(ui, &response, &painter, place);
        self.handles(ui, &painter, place);
        let pixel = |at: Pos2| {
            let share = (at - place.min) / place.size();
            let inside = share.min_elem() >= 0.0 && share.max_elem() < 1.0;
            inside.then_some([(share.x * width as f32) as u32, (share.y * height as f32) as u32])
        };
        self.under_cursor = response.hover_pos().and_then(pixel);
        let pointed = response.interact_pointer_pos().and_then(pixel);
        if let (Some(place), Some(shown)) = (pointed, &self.shown) {
            // A pixel of the whole picture, whatever image is shown.
            let of = |side: [u32; 2]| [place[0] * side[0] / width.max(1), place[1] * side[1] / height.max(1)];
            if response.drag_started_by(PointerButton::Secondary) {
                self.aim = Some(of([shown.view.width, shown.view.height]));
            }
            if response.clicked_by(PointerButton::Primary) && self.tab == Tab::Light {
                self.question.pixel = Some(of([shown.view.width, shown.view.height].map(|side| (side as f32 / at_rest).round() as u32)));
            }
        }
        self.navigate(ui, &response, area);
    }

    fn navigate(&mut self, ui: &Ui, response: &egui::Response, area: Rect) {
        let Some(flight) = &mut self.flight else { return };
        let before = flight.clone();
        let by = response.drag_delta() / area.height().max(1.0) * TURN;
        let by = Angles::new(by.x, -by.y);
        if response.dragged_by(PointerButton::Primary) {
            flight.look(by);
        }
        if response.dragged_by(PointerButton::Secondary) {
            flight.orbit(by);
        }
        if response.clicked() || response.dragged() {
            response.request_focus();
        }
        if ui.ctx().egui_wants_keyboard_input() && !response.has_focus() {
            return;
        }
        let (push, seconds, wheel, zoom, shift) = ui.input(|input| {
            let axis = |plus: Key, minus: Key| f32::from(u8::from(input.key_down(plus))) - f32::from(u8::from(input.key_down(minus)));
            let push = Push { right: axis(Key::D, Key::A), up: axis(Key::E, Key::Q), forward: axis(Key::W, Key::S) };
            let push = if input.modifiers.command || input.modifiers.alt { Push::default() } else { push };
            (push, input.stable_dt.min(0.1), input.smooth_scroll_delta.y, input.zoom_delta(), input.modifiers.shift)
        });
        if response.hovered() && wheel != 0.0 {
            flight.speed = (flight.speed * (wheel / 200.0).exp()).clamp(1e-4, 1e6);
        }
        if response.hovered() && zoom != 1.0 {
            flight.approach(1.0 / zoom);
        }
        if !push.is_none() {
            flight.fly(push, if shift { 4.0 * seconds } else { seconds });
            ui.ctx().request_repaint();
        }
        // A key that is held is one press: the display repeats it, and a window that gains the focus hears of it again.
        let is_press = |event: &Event, wanted: Key| matches!(event, Event::Key { key, pressed: true, repeat: false, .. } if *key == wanted);
        let pressed = |key: Key| ui.input(|input| !input.modifiers.any() && input.events.iter().any(|event| is_press(event, key)));
        if pressed(Key::F)
            && let Some(shown) = &self.shown
        {
            flight.frame(shown.bounds);
        }
        let moved = (flight.position, flight.target) != (before.position, before.target);
        if pressed(Key::Num1) {
            self.fits = !self.fits;
        }
        if pressed(Key::V) {
            self.waits_for_display = !self.waits_for_display;
        }
        if pressed(Key::C) {
            ["camera.position", "camera.target", "camera.up", "camera.fov_y_deg", "camera.keyframes"]
                .iter()
                .for_each(|key| self.project.reset(key));
            self.flight = None;
            self.moved = None;
        } else if moved {
            self.move_camera();
        }
    }
}
