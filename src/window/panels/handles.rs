//! Handles of the config's lights over the picture: places are dragged, directions are turned.

use super::Panels;
use crate::config::{Config, LightConfig};
use crate::window::project::Project;
use crate::world::projection::View;
use egui::{Align2, Color32, FontId, Id, Painter, Pos2, Rect, Sense, Ui, Vec2, pos2, vec2};
use glam::Vec3;

/// Radius of a handle that is dragged, points.
const GRIP: f32 = 7.0;
/// Radius of the ball that shows a direction, points.
const BALL: f32 = 26.0;

/// A part of a light that is dragged.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    key: String,
    name: String,
    value: Value,
}

/// What a key of a light is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Value {
    /// A place in the scene.
    Place(Vec3),
    /// The direction in which light travels.
    Direction(Vec3),
}

/// Parts of the lights that stand still.
fn parts(config: &Config) -> Vec<Part> {
    let mut parts = Vec::new();
    for (i, light) in config.light.iter().enumerate() {
        let part = |key: &str, name: &str, value: Value| Part { key: format!("light.{i}.{key}"), name: format!("{name} {i}"), value };
        // What keyframes move is not moved by hand.
        if !light.keyframes().is_empty() {
            continue;
        }
        let (position, target, direction) = match light {
            LightConfig::Directional { direction, position, target, .. } => (*position, *target, *direction),
            LightConfig::Spot { position, direction, target, .. } => (Some(*position), *target, *direction),
            LightConfig::Point { position, .. } => (Some(*position), None, None),
            LightConfig::Environment { .. } => continue,
        };
        parts.extend(position.map(|at| part("position", "light", Value::Place(at.into()))));
        parts.extend(target.map(|at| part("target", "target of light", Value::Place(at.into()))));
        let along = direction.map(|along| Value::Direction(Vec3::from(along).normalize_or(Vec3::NEG_Y)));
        parts.extend(along.map(|along| part("direction", "direction of light", along)));
    }
    parts
}

/// Place in the scene that a pixel shows at a distance along the view's axis, metres.
fn place_at(view: &View, pixel: [f32; 2], distance: f32) -> Vec3 {
    let ndc = [2.0 * pixel[0] / view.width as f32 - 1.0, 1.0 - 2.0 * pixel[1] / view.height as f32];
    Vec3::from(view.position) + distance * (Vec3::from(view.forward) + ndc[0] * Vec3::from(view.right) + ndc[1] * Vec3::from(view.up))
}

/// A direction on the ball: right, up, and towards the eye, each from -1 to 1.
fn on_ball(view: &View, direction: Vec3) -> Vec3 {
    let axis = |v: [f32; 3]| Vec3::from(v).normalize();
    Vec3::new(direction.dot(axis(view.right)), direction.dot(axis(view.up)), -direction.dot(axis(view.forward)))
}

/// The direction at a place of the ball, on the side that it is on.
fn from_ball(view: &View, [right, up]: [f32; 2], towards_eye: bool) -> Vec3 {
    let axis = |v: [f32; 3]| Vec3::from(v).normalize();
    let length = (right * right + up * up).sqrt().max(1.0);
    let (right, up) = (right / length, up / length);
    let depth = (1.0 - right * right - up * up).max(0.0).sqrt();
    let depth = if towards_eye { depth } else { -depth };
    right * axis(view.right) + up * axis(view.up) - depth * axis(view.forward)
}

fn set(project: &mut Project, key: &str, value: Vec3) {
    project.set(key, format!("[{:?}, {:?}, {:?}]", value.x, value.y, value.z));
}

impl Panels {
    /// Draws the handles over the picture that takes `place`, and follows those that are dragged.
    pub(super) fn handles(&mut self, ui: &Ui, painter: &Painter, place: Rect) {
        let (true, Some(shown)) = (self.has_handles, &self.shown) else { return };
        let (view, config) = (shown.view, shown.config.clone());
        let mut balls = 0;
        let parts = parts(&config);
        if parts.is_empty() {
            let why = if config.light.is_empty() {
                "The scene's own lights shine: give the config [[light]] tables to move them"
            } else {
                "No light of the config stands still"
            };
            painter.text(place.min + vec2(12.0, 12.0), Align2::LEFT_TOP, why, FontId::proportional(14.0), Color32::WHITE);
        }
        for Part { key, name, value } in parts {
            match value {
                Value::Place(at) => {
                    let Some((pixel, distance)) = view.pixel_of(at) else { continue };
                    let scale = vec2(place.width() / view.width as f32, place.height() / view.height as f32);
                    let center = place.min + vec2(pixel.x as f32, pixel.y as f32) * scale;
                    if !painter.clip_rect().contains(center) {
                        continue;
                    }
                    let response = grip(ui, painter, center, &key, &name);
                    if response.dragged() {
                        let to = (center + response.drag_delta() - place.min) / scale;
                        set(&mut self.project, &key, place_at(&view, [to.x, to.y], distance as f32));
                        self.moved = Some(std::time::Instant::now());
                    }
                }
                Value::Direction(along) => {
                    let middle = pos2(place.min.x + 12.0 + BALL + balls as f32 * (2.0 * BALL + 12.0), place.min.y + 12.0 + BALL);
                    balls += 1;
                    painter.circle(middle, BALL, Color32::from_black_alpha(140), (1.0, Color32::WHITE));
                    // The light stands where it comes from.
                    let towards = on_ball(&view, -along);
                    let center = middle + vec2(towards.x, -towards.y) * BALL;
                    painter.line_segment([middle, center], (1.5, Color32::from_rgb(255, 214, 90)));
                    let response = grip(ui, painter, center, &key, &name);
                    if towards.z < 0.0 {
                        painter.circle_filled(center, GRIP - 3.0, Color32::from_black_alpha(200));
                    }
                    if response.dragged() {
                        let to = (center + response.drag_delta() - middle) / BALL;
                        // Past the rim the light goes round to the other side.
                        let over = to.length() > 1.0 && Vec2::new(towards.x, -towards.y).length() > 0.999;
                        let side = (towards.z >= 0.0) != over;
                        set(&mut self.project, &key, -from_ball(&view, [to.x, -to.y], side));
                        self.moved = Some(std::time::Instant::now());
                    }
                }
            }
        }
    }
}

fn grip(ui: &Ui, painter: &Painter, center: Pos2, key: &str, name: &str) -> egui::Response {
    let response = ui.interact(Rect::from_center_size(center, Vec2::splat(2.0 * GRIP)), Id::unique(("handle", key)), Sense::drag());
    let color = if response.hovered() || response.dragged() { Color32::WHITE } else { Color32::from_rgb(255, 214, 90) };
    painter.circle(center, GRIP - 2.0, color, (1.5, Color32::BLACK));
    if response.hovered() || response.dragged() {
        painter.text(center + vec2(GRIP + 4.0, 0.0), Align2::LEFT_CENTER, name, FontId::proportional(13.0), Color32::WHITE);
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, name));
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aabb, Camera};

    fn view() -> View {
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(-1.0, 0.5, -4.0),
            up: Vec3::Y,
            fov_y_deg: 55.0,
        };
        View::new(&camera, [320, 200], Aabb { min: Vec3::splat(-5.0), max: Vec3::splat(5.0) })
    }

    #[test]
    fn a_place_that_is_not_dragged_stays() {
        let (view, at) = (view(), Vec3::new(0.3, 0.9, -2.0));
        let (pixel, distance) = view.pixel_of(at).unwrap();
        let back = place_at(&view, [pixel.x as f32, pixel.y as f32], distance as f32);
        assert!(back.distance(at) < 1e-4, "{back}");
    }

    #[test]
    fn a_direction_stays_on_its_side_of_the_ball() {
        let view = view();
        for direction in [Vec3::new(0.2, -1.0, 0.3), Vec3::new(-0.5, 0.1, -0.9), Vec3::X].map(Vec3::normalize) {
            let ball = on_ball(&view, direction);
            let back = from_ball(&view, [ball.x, ball.y], ball.z >= 0.0);
            assert!(back.distance(direction) < 1e-3, "{direction} {back}");
        }
        // Beyond the rim it lies on it.
        assert!((from_ball(&view, [3.0, 4.0], true).length() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn lights_with_keyframes_have_no_handles() {
        let text = "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\nintensity = [1, 1, 1]\n[[light]]\nkind = \"directional\"\ndirection = [0, -2, 0]\n\
                    irradiance = [1, 1, 1]\n[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\nintensity = [1, 1, 1]\nkeyframes = [{ time = 0 }]\n";
        let config = crate::config::parse_preset(text, std::path::Path::new("x.toml"), &[]).unwrap().config;
        let keys: Vec<String> = parts(&config).into_iter().map(|part| part.key).collect();
        assert_eq!(keys, ["light.0.position", "light.1.direction"]);
    }
}
