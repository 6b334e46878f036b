//! Flying and orbiting with a camera.

use crate::scene::{Aabb, Camera};
use glam::{Quat, Vec2, Vec3};

/// Movement of a moment: each axis from -1 to 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Push {
    pub right: f32,
    pub up: f32,
    pub forward: f32,
}

impl Push {
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}

/// A camera in flight. Its target is the point that it orbits.
#[derive(Debug, Clone, PartialEq)]
pub struct Flight {
    pub position: Vec3,
    pub target: Vec3,
    pub up: Vec3,
    pub fov_y_deg: f32,
    /// Metres a second.
    pub speed: f32,
}

/// Closest to straight up or down that the camera looks, radians.
const POLE: f32 = 0.02;

impl Flight {
    /// Begins at a camera of a scene. The speed crosses the scene in ten seconds.
    pub fn from(camera: &Camera, bounds: Aabb) -> Self {
        let diagonal = (bounds.max - bounds.min).length();
        let speed = if diagonal.is_finite() && diagonal > 0.0 { diagonal / 10.0 } else { 1.0 };
        Self { position: camera.position, target: camera.target, up: camera.up, fov_y_deg: camera.fov_y_deg, speed }
    }

    /// Moves along the camera's axes for `seconds`.
    pub fn fly(&mut self, push: Push, seconds: f32) {
        let (forward, right) = self.axes();
        let step = (right * push.right + self.up.normalize_or(Vec3::Y) * push.up + forward * push.forward) * self.speed * seconds;
        self.position += step;
        self.target += step;
    }

    /// Turns the camera where it stands by angles, radians: to the right, and up.
    pub fn look(&mut self, by: Vec2) {
        let ahead = self.turned(self.target - self.position, by);
        self.target = self.position + ahead;
    }

    /// Moves the camera around its target by angles, radians.
    pub fn orbit(&mut self, by: Vec2) {
        let ahead = self.turned(self.target - self.position, by);
        self.position = self.target - ahead;
    }

    /// Moves towards the target, or away from it: the distance is multiplied.
    pub fn approach(&mut self, by: f32) {
        self.position = self.target + (self.position - self.target) * by;
    }

    /// Looks at a point that is orbited from now on, without moving.
    pub fn aim(&mut self, target: Vec3) {
        if target.is_finite() && target != self.position {
            self.target = target;
            // Not along its own up.
            self.look(Vec2::ZERO);
        }
    }

    /// Stands so that all of a box is seen, and looks as before.
    pub fn frame(&mut self, bounds: Aabb) {
        let radius = 0.5 * (bounds.max - bounds.min).length();
        if !(radius.is_finite() && radius > 0.0) {
            return;
        }
        let (forward, _) = self.axes();
        let distance = radius / (self.fov_y_deg.to_radians() * 0.5).sin();
        self.target = bounds.center();
        self.position = self.target - forward * distance;
    }

    fn axes(&self) -> (Vec3, Vec3) {
        let forward = (self.target - self.position).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(self.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        (forward, right)
    }

    fn turned(&self, ahead: Vec3, by: Vec2) -> Vec3 {
        let up = self.up.normalize_or(Vec3::Y);
        let length = ahead.length().max(1e-6);
        let ahead = Quat::from_axis_angle(up, -by.x) * ahead / length;
        let right = ahead.cross(up).try_normalize().unwrap_or_else(|| ahead.any_orthonormal_vector());
        let from_pole = ahead.angle_between(up);
        let tilt = by.y.clamp(from_pole - std::f32::consts::PI + POLE, from_pole - POLE);
        Quat::from_axis_angle(right, tilt) * ahead * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight() -> Flight {
        let camera = Camera { name: String::new(), position: Vec3::Z * 2.0, target: Vec3::ZERO, up: Vec3::Y, fov_y_deg: 60.0 };
        Flight::from(&camera, Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) })
    }

    #[test]
    fn a_camera_flies_along_its_axes() {
        let mut camera = flight();
        camera.speed = 2.0;
        camera.fly(Push { right: 1.0, up: 0.5, forward: 1.0 }, 0.5);
        assert!(camera.position.distance(Vec3::new(1.0, 0.5, 1.0)) < 1e-6, "{camera:?}");
        assert!(camera.target.distance(Vec3::new(1.0, 0.5, -1.0)) < 1e-6, "{camera:?}");
    }

    #[test]
    fn looking_right_turns_right_and_orbiting_keeps_the_distance() {
        let mut camera = flight();
        camera.look(Vec2::new(0.5, 0.25));
        let ahead = (camera.target - camera.position).normalize();
        assert!(ahead.x > 0.4 && ahead.y > 0.2 && camera.position == Vec3::Z * 2.0, "{ahead}");
        let mut camera = flight();
        camera.orbit(Vec2::new(1.0, -0.5));
        assert!((camera.position.length() - 2.0).abs() < 1e-5 && camera.position.y > 0.5 && camera.position.x < -0.5, "{camera:?}");
    }

    #[test]
    fn no_turn_looks_along_up() {
        let mut camera = flight();
        for by in [1.0, 9.0, -3.0, -9.0, -9.0] {
            camera.look(Vec2::new(0.3, by));
            let angle = (camera.target - camera.position).angle_between(Vec3::Y);
            assert!((0.015..3.13).contains(&angle), "{angle}");
        }
    }

    #[test]
    fn framing_sees_the_whole_box_from_outside() {
        let mut camera = flight();
        camera.frame(Aabb { min: Vec3::splat(-10.0), max: Vec3::splat(10.0) });
        assert!(camera.position.length() > 30.0 && camera.target == Vec3::ZERO);
    }
}
