//! A flight, recorded as keyframes of the camera.

use super::flight::Flight;
use glam::Vec3;

/// Place and target of a camera at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Seconds.
    pub time: f32,
    pub position: Vec3,
    pub target: Vec3,
}

/// A flight in the making.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    keys: Vec<Key>,
}

/// Seconds between keys of a flight in the making.
const STEP: f32 = 1.0 / 30.0;

impl Recording {
    /// Takes the camera's place at a time, seconds since the flight began.
    pub fn record(&mut self, time: f32, camera: &Flight) {
        if self.keys.last().is_none_or(|last| time >= last.time + STEP) {
            self.keys.push(Key { time, position: camera.position, target: camera.target });
        }
    }

    /// The flight with as few keys as stay within `tolerance` of it, metres. It begins and ends with a movement, at second 0. `None` if the
    /// camera did not move.
    pub fn finish(&self, tolerance: f32) -> Option<Vec<Key>> {
        let moves = |pair: &[Key]| (pair[0].position, pair[0].target) != (pair[1].position, pair[1].target);
        let first = self.keys.windows(2).position(moves)?;
        let last = self.keys.windows(2).rposition(moves)? + 1;
        let keys = &self.keys[first..=last];
        let mut kept = vec![0];
        thin(keys, 0, keys.len() - 1, tolerance, &mut kept);
        let begin = keys[0].time;
        Some(kept.into_iter().map(|i| Key { time: keys[i].time - begin, ..keys[i] }).collect())
    }
}

/// Appends the keys after `first`, up to `last`, that a straight line misses (Douglas and Peucker 1973, in time).
fn thin(keys: &[Key], first: usize, last: usize, tolerance: f32, kept: &mut Vec<usize>) {
    let (a, b) = (keys[first], keys[last]);
    let missed = |i: usize| {
        let t = (keys[i].time - a.time) / (b.time - a.time).max(1e-6);
        let off = |from: Vec3, to: Vec3, at: Vec3| from.lerp(to, t).distance(at);
        off(a.position, b.position, keys[i].position).max(off(a.target, b.target, keys[i].target))
    };
    let worst = (first + 1..last).map(|i| (missed(i), i)).max_by(|a, b| a.0.total_cmp(&b.0));
    match worst {
        Some((distance, i)) if distance > tolerance => {
            thin(keys, first, i, tolerance, kept);
            thin(keys, i, last, tolerance, kept);
        }
        _ => kept.push(last),
    }
}

/// Keys as the value of `camera.keyframes`.
pub fn toml(keys: &[Key]) -> String {
    let vector = |v: Vec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let key = |key: &Key| format!("{{ time = {:?}, position = {}, target = {} }}", key.time, vector(key.position), vector(key.target));
    format!("[{}]", keys.iter().map(key).collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aabb, Camera};

    fn flight(x: f32, z: f32) -> Flight {
        let position = Vec3::new(x, 0.0, z);
        let camera = Camera { name: String::new(), position, target: position + Vec3::NEG_Z, up: Vec3::Y, fov_y_deg: 60.0 };
        Flight::from(&camera, Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE })
    }

    #[test]
    fn a_flight_around_a_corner_has_three_keys() {
        let mut recording = Recording::default();
        for i in 0..=100 {
            // It stands for a second at first.
            let along = (i as f32 - 20.0).clamp(0.0, 60.0);
            recording.record(i as f32 * 0.05, &flight(along.min(30.0), (along - 30.0).max(0.0)));
        }
        let keys = recording.finish(0.01).unwrap();
        let places: Vec<Vec3> = keys.iter().map(|key| key.position).collect();
        assert_eq!(places, [Vec3::ZERO, Vec3::new(30.0, 0.0, 0.0), Vec3::new(30.0, 0.0, 30.0)]);
        assert!(keys[0].time == 0.0 && (keys[1].time - 1.5).abs() < 1e-5 && (keys[2].time - 3.0).abs() < 1e-5, "{keys:?}");
        let set = format!("camera.keyframes={}", toml(&keys));
        let config =
            crate::config::parse_preset(crate::presets::find("linke").unwrap(), std::path::Path::new("x.toml"), &[set]).unwrap().config;
        assert_eq!(config.camera.unwrap().keyframes.len(), 3);
    }

    #[test]
    fn a_camera_that_stands_still_is_no_flight() {
        let mut recording = Recording::default();
        (0..10).for_each(|i| recording.record(i as f32, &flight(1.0, 2.0)));
        assert_eq!(recording.finish(0.01), None);
    }
}
