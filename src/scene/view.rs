//! What a frame is seen and lit by: the config's camera and lights at the frame's time, or the scene's own.

use super::{Aabb, Camera, Light, Scene, SpotFalloff};
use crate::config::{CameraConfig, Config, Interpolation, LightConfig, LightKeyframe};
use crate::fail;
use anyhow::Result;
use glam::{DVec3, Vec3};
use std::ops::{Add, Mul, Sub};

/// Vertical field of view of a camera that says none, degrees.
const DEFAULT_FOV_Y_DEG: f32 = 60.0;

/// The camera of a frame; frame `i` is at `i / fps` seconds.
///
/// Fails where the config names a camera that the scene lacks, and where a path looks straight along its `up`.
pub fn camera(config: &Config, scene: &Scene, frame_index: u32) -> Result<Camera> {
    let Some(wish) = &config.camera else { return Ok(own_camera(config, scene)) };
    let mut camera = match (&wish.node, wish.position, wish.target) {
        (Some(name), ..) => named_camera(scene, name)?,
        (None, Some(position), Some(target)) => looking(position.into(), target.into()),
        _ if wish.keyframes.is_empty() => own_camera(config, scene),
        _ => on_path(wish, seconds(config, frame_index)),
    };
    camera.up = wish.up.map_or(camera.up, |up| unit(up.into()).as_vec3());
    // Where keyframes say the field of view, it is theirs.
    if wish.keyframes.iter().all(|key| key.fov_y_deg.is_none()) {
        camera.fov_y_deg = wish.fov_y_deg.unwrap_or(camera.fov_y_deg);
    }
    let ahead = (camera.target.as_dvec3() - camera.position.as_dvec3()).normalize_or_zero();
    if ahead.cross(unit(camera.up)).length() < 1e-5 {
        return Err(fail!(
            BadInput,
            "camera: in frame {frame_index} it looks straight along camera.up or nowhere; change the keyframes or camera.up"
        ));
    }
    Ok(camera)
}

/// The lights of a frame: the config's if it has any, else the scene's own.
pub fn lights(config: &Config, scene: &Scene, frame_index: u32) -> Vec<Light> {
    if config.light.is_empty() {
        return scene.lights.clone();
    }
    let time = seconds(config, frame_index);
    config.light.iter().map(|light| light_at(light, time)).collect()
}

fn seconds(config: &Config, frame_index: u32) -> f64 {
    f64::from(frame_index) / f64::from(config.frame.fps)
}

fn looking(position: Vec3, target: Vec3) -> Camera {
    Camera { name: "config".to_owned(), position, target, up: Vec3::Y, fov_y_deg: DEFAULT_FOV_Y_DEG }
}

fn own_camera(config: &Config, scene: &Scene) -> Camera {
    scene.cameras.first().cloned().unwrap_or_else(|| framing(scene, config.frame.size))
}

fn named_camera(scene: &Scene, name: &str) -> Result<Camera> {
    if let Some(camera) = scene.cameras.iter().find(|camera| camera.name == name) {
        return Ok(camera.clone());
    }
    let names: Vec<_> = scene.cameras.iter().take(20).map(|camera| format!("{:?}", camera.name)).collect();
    let has = if names.is_empty() { "no cameras".to_owned() } else { format!("the cameras {}", names.join(", ")) };
    Err(fail!(BadInput, "camera.node: {} has no camera {name:?}; it has {has}", scene.name))
}

/// A view from a corner of the scene, slightly from above, that all of its bounds fit into.
fn framing(scene: &Scene, size: [u32; 2]) -> Camera {
    let bounds = scene.draws.iter().map(|draw| scene.draw_bounds(draw)).fold(Aabb::EMPTY, Aabb::union);
    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
        return Camera { name: "default".to_owned(), ..looking(Vec3::Z, Vec3::ZERO) };
    }
    let back = Vec3::new(0.6, 0.4, 1.0).normalize();
    let right = Vec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let tan_y = (DEFAULT_FOV_Y_DEG.to_radians() * 0.5).tan();
    let tan_x = tan_y * size[0] as f32 / size[1] as f32;
    let needed = bounds.corners().map(|corner| {
        let corner = corner - bounds.center();
        back.dot(corner) + (right.dot(corner).abs() / tan_x).max(up.dot(corner).abs() / tan_y)
    });
    let distance = 1.03 * needed.into_iter().fold(1e-3, f32::max);
    Camera { name: "framing".to_owned(), ..looking(bounds.center() + distance * back, bounds.center()) }
}

fn on_path(wish: &CameraConfig, time: f64) -> Camera {
    let track = |value: fn(&crate::config::CameraKeyframe) -> [f32; 3]| {
        let keys: Vec<_> = wish.keyframes.iter().map(|key| (f64::from(key.time), vector(value(key)))).collect();
        sample(&keys, time, wish.interpolation).unwrap_or_default().as_vec3()
    };
    let fov: Vec<_> = wish.keyframes.iter().filter_map(|key| Some((f64::from(key.time), f64::from(key.fov_y_deg?)))).collect();
    let mut camera = looking(track(|key| key.position), track(|key| key.target));
    if let Some(fov) = sample(&fov, time, wish.interpolation) {
        // A smooth curve may overshoot its keyframes.
        camera.fov_y_deg = fov.clamp(1.0, 170.0) as f32;
    }
    camera
}

fn light_at(light: &LightConfig, time: f64) -> Light {
    let track = |keyframes: &[LightKeyframe], value: fn(&LightKeyframe) -> Option<[f32; 3]>, without: [f32; 3]| -> DVec3 {
        let keys: Vec<_> = keyframes.iter().filter_map(|key| Some((f64::from(key.time), vector(value(key)?)))).collect();
        sample(&keys, time, Interpolation::Linear).unwrap_or(vector(without))
    };
    let aim = |keyframes: &[LightKeyframe], direction: Option<[f32; 3]>, position: Option<[f32; 3]>, target: Option<[f32; 3]>| {
        let (now, still) = match (direction, position, target) {
            (Some(direction), ..) => {
                let unit_of = |key: &LightKeyframe| key.direction.map(|direction| unit(direction.into()).as_vec3().to_array());
                (track(keyframes, unit_of, direction), vector(direction))
            }
            (None, Some(position), Some(target)) => {
                let from = track(keyframes, |key| key.position, position);
                (track(keyframes, |key| key.target, target) - from, vector(target) - vector(position))
            }
            _ => (DVec3::NEG_Y, DVec3::NEG_Y),
        };
        // Halfway between opposite directions there is none: the light keeps its own.
        let now = if now.length() > 1e-6 { now } else { still };
        now.normalize_or(DVec3::NEG_Y).as_vec3()
    };
    match light {
        LightConfig::Directional { direction, position, target, irradiance, keyframes } => Light::Directional {
            direction: aim(keyframes, *direction, *position, *target),
            irradiance: track(keyframes, |key| key.irradiance, *irradiance).as_vec3(),
        },
        LightConfig::Spot { position, direction, target, intensity, inner_deg, outer_deg, keyframes } => Light::Spot {
            position: track(keyframes, |key| key.position, *position).as_vec3(),
            direction: aim(keyframes, *direction, Some(*position), *target),
            intensity: track(keyframes, |key| key.intensity, *intensity).as_vec3(),
            inner: inner_deg.unwrap_or(0.75 * outer_deg).to_radians(),
            outer: outer_deg.to_radians(),
            falloff: SpotFalloff::Angle,
        },
        LightConfig::Point { position, intensity, keyframes } => Light::Point {
            position: track(keyframes, |key| key.position, *position).as_vec3(),
            intensity: track(keyframes, |key| key.intensity, *intensity).as_vec3(),
        },
        LightConfig::Environment { radiance } => Light::Environment { radiance: (*radiance).into() },
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// In 64 bits the square of no 32-bit length overflows or vanishes.
fn unit(v: Vec3) -> DVec3 {
    v.as_dvec3().normalize_or(DVec3::Y)
}

/// The value of a track at a time: `keys` by rising time, held at both ends; `None` if there are none.
fn sample<V>(keys: &[(f64, V)], time: f64, interpolation: Interpolation) -> Option<V>
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    let after = keys.partition_point(|(at, _)| *at <= time);
    let Some(i) = after.checked_sub(1) else { return keys.first().map(|key| key.1) };
    if after == keys.len() {
        return Some(keys[i].1);
    }
    let ((from, a), (to, b)) = (keys[i], keys[after]);
    let span = to - from;
    let s = (time - from) / span;
    if interpolation == Interpolation::Linear {
        return Some(a + (b - a) * s);
    }
    // Cubic Hermite with the tangents of the parabola through each three keyframes: Catmull-Rom for times of any spacing.
    let slope = |k: usize| (keys[k + 1].1 - keys[k].1) * (1.0 / (keys[k + 1].0 - keys[k].0));
    let tangent = |k: usize| {
        if k == 0 {
            slope(0)
        } else if k + 1 == keys.len() {
            slope(k - 1)
        } else {
            let (before, after) = (keys[k].0 - keys[k - 1].0, keys[k + 1].0 - keys[k].0);
            (slope(k) * before + slope(k - 1) * after) * (1.0 / (before + after))
        }
    };
    let (s2, s3) = (s * s, s * s * s);
    Some(
        a * (2.0 * s3 - 3.0 * s2 + 1.0)
            + b * (3.0 * s2 - 2.0 * s3)
            + tangent(i) * (span * (s3 - 2.0 * s2 + s))
            + tangent(after) * (span * (s3 - s2)),
    )
}
