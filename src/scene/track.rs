//! Keyframed values: samplers of glTF animations.

use glam::{DQuat, DVec3, DVec4};

/// Interpolation between keys (glTF 2.0, appendix C).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// A key's value holds until the next key.
    Step,
    /// Linear interpolation; slerp the short way for rotations.
    Linear,
    /// A cubic Hermite spline through values with tangents.
    Cubic,
}

/// A key counts as reached this early, s. A frame's time and a file's are rounded differently, and a step at a frame's time
/// must fall on the frame.
pub(super) const EARLY: f64 = 1e-5;

/// Keys by time. The fourth number of vectors is unused; rotations are quaternions x, y, z, w.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    course: Course,
    times: Vec<f32>,
    /// One value per key; three for [`Course::Cubic`]: incoming tangent, value, outgoing tangent, the tangents per second.
    values: Vec<[f32; 4]>,
}

/// Position of a time among the keys.
enum Place {
    /// A key's own value holds: before the first key, after the last, or in a step.
    At(usize),
    /// A key, the fraction of the way to the next, and the seconds between both.
    Between(usize, f64, f64),
}

impl Track {
    /// A track of at least one key, with finite ascending times and as many values as its course needs.
    pub fn new(course: Course, times: Vec<f32>, values: Vec<[f32; 4]>) -> Self {
        assert!(!times.is_empty() && values.len() == times.len() * Self::values_a_key(course), "a track's values are those of its keys");
        assert!(times.iter().all(|time| time.is_finite()) && times.is_sorted(), "a track's times do not fall");
        Self { course, times, values }
    }

    /// Number of values per key of a course.
    pub fn values_a_key(course: Course) -> usize {
        if course == Course::Cubic { 3 } else { 1 }
    }

    /// Times of the keys, s.
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    /// The vector at a time, constant before the first key and after the last.
    pub fn vector(&self, seconds: f64) -> DVec3 {
        self.sample(seconds, |a, b, s| a + (b - a) * s).truncate()
    }

    /// The rotation at a time as a unit quaternion, constant before the first key and after the last.
    pub fn rotation(&self, seconds: f64) -> DQuat {
        let slerp = |a, b, s| DVec4::from(unit(a).slerp(unit(b), s));
        unit(self.sample(seconds, slerp))
    }

    fn sample(&self, seconds: f64, linear: impl FnOnce(DVec4, DVec4, f64) -> DVec4) -> DVec4 {
        match self.place(seconds) {
            Place::At(key) => self.value(key),
            Place::Between(key, s, span) if self.course == Course::Cubic => {
                let (s2, s3) = (s * s, s * s * s);
                self.value(key) * (2.0 * s3 - 3.0 * s2 + 1.0)
                    + self.wide(3 * key + 2) * (span * (s3 - 2.0 * s2 + s))
                    + self.value(key + 1) * (3.0 * s2 - 2.0 * s3)
                    + self.wide(3 * key + 3) * (span * (s3 - s2))
            }
            Place::Between(key, s, _) => linear(self.value(key), self.value(key + 1), s),
        }
    }

    fn place(&self, seconds: f64) -> Place {
        let after = self.times.partition_point(|at| f64::from(*at) <= seconds + EARLY);
        let Some(key) = after.checked_sub(1) else { return Place::At(0) };
        if after == self.times.len() || self.course == Course::Step {
            return Place::At(key);
        }
        let (from, to) = (f64::from(self.times[key]), f64::from(self.times[after]));
        match (seconds - from) / (to - from) {
            s if s > 0.0 => Place::Between(key, s, to - from),
            _ => Place::At(key),
        }
    }

    fn value(&self, key: usize) -> DVec4 {
        self.wide(if self.course == Course::Cubic { 3 * key + 1 } else { key })
    }

    fn wide(&self, i: usize) -> DVec4 {
        DVec4::from_array(self.values[i].map(f64::from))
    }
}

/// The normalized quaternion; the identity for one of length 0, which a spline may pass.
fn unit(v: DVec4) -> DQuat {
    DQuat::from_vec4(v.normalize_or(DVec4::W))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_6, PI};

    fn track(course: Course, times: &[f32], values: &[[f32; 3]]) -> Track {
        Track::new(course, times.to_vec(), values.iter().map(|[x, y, z]| [*x, *y, *z, 0.0]).collect())
    }

    fn turns(course: Course, times: &[f32], quaternions: &[DQuat]) -> Track {
        Track::new(course, times.to_vec(), quaternions.iter().map(|q| q.to_array().map(|c| c as f32)).collect())
    }

    #[test]
    fn a_step_holds_until_the_next_key_and_may_fall_on_a_frame_that_is_rounded_down() {
        let thirds: Vec<f32> = (0..60).map(|i| i as f32 / 30.0).collect();
        let values: Vec<[f32; 3]> = (0..60).map(|i| [i as f32, 0.0, 0.0]).collect();
        let track = track(Course::Step, &thirds, &values);
        for frame in 0..60 {
            let seconds = f64::from(frame) / 30.0;
            assert_eq!(track.vector(seconds).x, f64::from(frame));
            assert_eq!(track.vector(seconds + 0.033).x, f64::from(frame));
        }
        assert_eq!((track.vector(-1.0).x, track.vector(99.0).x), (0.0, 59.0));
    }

    #[test]
    fn a_line_runs_evenly_between_keys_of_any_spacing_and_is_held_outside() {
        let track = track(Course::Linear, &[1.0, 2.0, 4.0], &[[0., 0., 1.], [2., 0., 1.], [2., -8., 3.]]);
        for (seconds, expected) in [
            (0.0, [0., 0., 1.]),
            (1.0, [0., 0., 1.]),
            (1.25, [0.5, 0., 1.]),
            (2.0, [2., 0., 1.]),
            (2.5, [2., -2., 1.5]),
            (4.0, [2., -8., 3.]),
            (5.0, [2., -8., 3.]),
        ] {
            assert_eq!(track.vector(seconds), DVec3::from(expected), "{seconds}");
        }
    }

    #[test]
    fn keys_of_one_time_are_a_jump() {
        let track = track(Course::Linear, &[0.0, 1.0, 1.0, 2.0], &[[0.; 3], [1.; 3], [5.; 3], [6.; 3]]);
        assert_eq!([0.5, 1.0, 1.5].map(|seconds| track.vector(seconds).x), [0.5, 5.0, 5.5]);
    }

    #[test]
    fn a_spline_has_the_values_and_tangents_of_its_keys() {
        // x(t) = t^3 - 2 t and y(t) = t^2 are cubics, which splines follow exactly; z has a corner at the second key.
        let keys = |t: f32| {
            let (value, slope) = ([t * t * t - 2.0 * t, t * t, t], [3.0 * t * t - 2.0, 2.0 * t, 1.0]);
            [[slope[0], slope[1], 0.0], value, slope]
        };
        let times = [0.0, 0.5, 2.0];
        let values: Vec<[f32; 3]> = times.iter().flat_map(|t| keys(*t)).collect();
        let track = track(Course::Cubic, &times, &values);
        for seconds in [0.1, 0.25, 0.5, 0.7, 1.0, 1.9, 2.0] {
            let found = track.vector(seconds);
            let expected = DVec3::new(seconds.powi(3) - 2.0 * seconds, seconds * seconds, found.z);
            assert!((found - expected).length() < 1e-9, "{seconds}: {found}");
        }
        // From 0 to 1/2, tangents are 1 and 0 over half a second. By hand at the middle: (0 + 0.5) / 2 + 0.5 (1 - 0) / 8.
        assert!((track.vector(0.25).z - 0.3125).abs() < 1e-12);
    }

    #[test]
    fn rotations_turn_evenly_the_short_way() {
        let quarter = DQuat::from_rotation_y(FRAC_PI_2);
        // The opposite quaternion is the same rotation, and must not turn by three quarters.
        for end in [quarter, -quarter] {
            let track = turns(Course::Linear, &[0.0, 3.0], &[DQuat::IDENTITY, end]);
            for (seconds, angle) in [(0.0, 0.0), (1.0, FRAC_PI_6), (1.5, FRAC_PI_4), (2.0, PI / 3.0), (3.0, FRAC_PI_2)] {
                let found = track.rotation(seconds);
                assert!(found.angle_between(DQuat::from_rotation_y(angle)) < 1e-6, "{seconds}: {found}");
                assert!((found.length() - 1.0).abs() < 1e-12);
            }
        }
        let step = turns(Course::Step, &[0.0, 1.0], &[DQuat::IDENTITY, quarter * 2.0]);
        assert_eq!(step.rotation(0.9), DQuat::IDENTITY);
        assert!(step.rotation(1.0).angle_between(quarter) < 1e-6);
    }

    #[test]
    fn a_spline_of_rotations_is_one_of_unit_quaternions() {
        let (from, to) = (DQuat::IDENTITY, DQuat::from_rotation_x(FRAC_PI_2));
        let none = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let track = turns(Course::Cubic, &[0.0, 1.0], &[none, from, none, none, to, none]);
        // Without tangents the middle is the mean, normalized.
        assert!(track.rotation(0.5).angle_between(DQuat::from_rotation_x(FRAC_PI_4)) < 1e-6);
        assert!((track.rotation(0.5).length() - 1.0).abs() < 1e-12);
        // At a quarter of the way: 0.84375 of the first and 0.15625 of the second.
        let mean = DVec4::from(from) * 0.84375 + DVec4::from(to) * 0.15625;
        assert!(track.rotation(0.25).angle_between(DQuat::from_vec4(mean.normalize())) < 1e-6);
        let through_nothing = turns(Course::Cubic, &[0.0, 1.0], &[none, from, none, none, -from, none]);
        assert_eq!(through_nothing.rotation(0.5), DQuat::IDENTITY);
    }
}
