//! Camera and lights of a frame: the config's at the frame's time, or the scene's own.

use crate::config::{CameraConfig, Config, Interpolation, LightConfig, LightKeyframe};
use crate::fail;
use crate::scene::{Aabb, Camera, Light, Scene, SpotFalloff};
use anyhow::Result;
use glam::{DVec3, Vec3};
use std::ops::{Add, Mul, Sub};

/// Default vertical field of view, degrees.
const DEFAULT_FOV_Y_DEG: f32 = 60.0;

/// Camera of a frame; frame `i` is at `i / fps` seconds. `bounds` are the scene's, for a view that frames all of it.
///
/// # Errors
/// `BadInput` if the config names a camera that the scene lacks, or if a path looks straight along its `up`.
pub fn camera(config: &Config, scene: &Scene, bounds: Aabb, frame_index: u32) -> Result<Camera> {
    let time = seconds(config, frame_index);
    let cameras = scene.cameras_at(time);
    let own_camera = || cameras.first().cloned().unwrap_or_else(|| framing(bounds, config.frame.size));
    let Some(wish) = &config.camera else { return Ok(own_camera()) };
    let mut camera = match (&wish.node, wish.position, wish.target) {
        (Some(name), ..) => named_camera(scene, &cameras, name)?,
        (None, Some(position), Some(target)) => looking(position.into(), target.into()),
        _ if wish.keyframes.is_empty() => own_camera(),
        _ => on_path(wish, time),
    };
    camera.up = wish.up.map_or(camera.up, |up| unit(up.into()).as_vec3());
    // A field of view in the keyframes wins over the camera's own.
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

/// Lights of a frame: the config's if it has any, else the scene's own.
pub fn lights(config: &Config, scene: &Scene, frame_index: u32) -> Vec<Light> {
    let time = seconds(config, frame_index);
    if config.light.is_empty() {
        return scene.lights_at(time).into_owned();
    }
    config.light.iter().map(|light| light_at(light, time)).collect()
}

/// Time of a frame, for the scene's animation and all keyframes: frame `i` is at `i / fps` seconds.
pub fn seconds(config: &Config, frame_index: u32) -> f64 {
    f64::from(frame_index) / f64::from(config.frame.fps)
}

fn looking(position: Vec3, target: Vec3) -> Camera {
    Camera { name: "config".to_owned(), position, target, up: Vec3::Y, fov_y_deg: DEFAULT_FOV_Y_DEG }
}

fn named_camera(scene: &Scene, cameras: &[Camera], name: &str) -> Result<Camera> {
    if let Some(camera) = cameras.iter().find(|camera| camera.name == name) {
        return Ok(camera.clone());
    }
    let names: Vec<_> = cameras.iter().take(20).map(|camera| format!("{:?}", camera.name)).collect();
    let has = if names.is_empty() { "no cameras".to_owned() } else { format!("the cameras {}", names.join(", ")) };
    Err(fail!(BadInput, "camera.node: {} has no camera {name:?}; it has {has}", scene.name))
}

/// A view that frames a whole box, from a corner and slightly from above.
fn framing(bounds: Aabb, size: [u32; 2]) -> Camera {
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
        // Halfway between opposite directions there is no direction: the light keeps its own.
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
        LightConfig::Environment { radiance, map, rotation_deg } => {
            Light::Environment { radiance: (*radiance).into(), map: map.clone(), rotation: rotation_deg.to_radians() }
        }
    }
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Normalized in 64 bits, in which the squared length of no 32-bit vector overflows or vanishes.
fn unit(v: Vec3) -> DVec3 {
    v.as_dvec3().normalize_or(DVec3::Y)
}

/// Value of a track at a time. `keys` are sorted by time, and their values are held at both ends; `None` if there are none.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;
    use std::path::Path;

    fn camera(config: &Config, scene: &Scene, frame_index: u32) -> Result<Camera> {
        super::camera(config, scene, scene.bounds(), frame_index)
    }

    fn parse(text: &str) -> Config {
        config::parse(text, Path::new("x.toml"), &[]).unwrap().config
    }

    /// A camera of its own, a light of its own, and one triangle from (-1, 0, -2) to (3, 4, 2).
    fn scene() -> Scene {
        let vertex = |position| crate::scene::Vertex { position, normal: 0, uv: [0.0; 2], color: 0, tangent: 0 };
        Scene {
            name: "triangle".to_owned(),
            vertices: vec![vertex([-1.0, 0.0, -2.0]), vertex([3.0, 4.0, 0.0]), vertex([0.0, 1.0, 2.0])],
            indices: vec![0, 1, 2],
            draws: vec![crate::scene::Draw {
                first_index: 0,
                index_count: 3,
                vertex_offset: 0,
                material: 0,
                transform: Default::default(),
            }],
            lights: vec![Light::Environment { radiance: Vec3::ONE, map: None, rotation: 0.0 }],
            cameras: vec![Camera { name: "eye".to_owned(), fov_y_deg: 20.0, ..looking(Vec3::X, Vec3::ZERO) }],
            ..Scene::default()
        }
    }

    #[test]
    fn the_view_is_the_configs_else_the_scenes_else_one_that_frames_everything() {
        let mut scene = scene();
        let at = |text: &str, scene: &Scene| camera(&parse(text), scene, 0).unwrap();
        let given = at("[camera]\nposition = [0, 1, 2]\ntarget = [3, 4, 5]\nup = [0, 0, 5]\nfov_y_deg = 33", &scene);
        assert_eq!(
            given,
            Camera { name: given.name.clone(), up: Vec3::Z, fov_y_deg: 33.0, ..looking([0., 1., 2.].into(), [3., 4., 5.].into()) }
        );
        assert_eq!(at("", &scene), scene.cameras[0]);
        assert_eq!(at("[camera]\nfov_y_deg = 50", &scene), Camera { fov_y_deg: 50.0, ..scene.cameras[0].clone() });
        scene.cameras.push(Camera { name: "second".to_owned(), ..looking(Vec3::Z, Vec3::ZERO) });
        assert_eq!(at("scene.file = \"a.glb\"\ncamera.node = \"second\"", &scene), scene.cameras[1]);
        let error = camera(&parse("scene.file = \"a.glb\"\ncamera.node = \"third\""), &scene, 0).unwrap_err();
        assert_eq!(error.to_string(), "camera.node: triangle has no camera \"third\"; it has the cameras \"eye\", \"second\"");
        scene.cameras.clear();
        for size in ["[960, 540]", "[200, 900]"] {
            let config = parse(&format!("frame.size = {size}"));
            let view = camera(&config, &scene, 0).unwrap();
            let aspect = config.frame.size[0] as f32 / config.frame.size[1] as f32;
            let ahead = (view.target - view.position).normalize();
            let right = ahead.cross(view.up).normalize();
            let seen = scene.draw_bounds(&scene.draws[0]).corners().map(|corner| {
                let corner = corner - view.position;
                let half_height = ahead.dot(corner) * (view.fov_y_deg.to_radians() * 0.5).tan();
                (right.dot(corner).abs() / (half_height * aspect)).max(right.cross(ahead).dot(corner).abs() / half_height)
            });
            let most = seen.into_iter().fold(0.0, f32::max);
            assert!((0.9..1.0).contains(&most), "{size}: {most}");
        }
        assert!(camera(&Config::default(), &Scene::default(), 0).is_ok());
    }

    #[test]
    fn a_path_goes_through_its_keyframes_and_holds_at_both_ends() {
        let text = |how: &str| {
            format!(
                "frame.fps = 2\n[camera]\nfov_y_deg = 30\ninterpolation = \"{how}\"\nkeyframes = [
                    {{ time = 1, position = [0, 0, 0], target = [0, 0, 9] }}, {{ time = 2, position = [1, 0, 0], target = [1, 0, 9] }},
                    {{ time = 4, position = [1, 2, 0], target = [1, 2, 9] }}]"
            )
        };
        let at = |how: &str, frame| camera(&parse(&text(how)), &scene(), frame).unwrap().position;
        for how in ["linear", "catmull-rom"] {
            assert_eq!(
                [0, 2, 4, 8, 100].map(|frame| at(how, frame)),
                [[0., 0., 0.], [0., 0., 0.], [1., 0., 0.], [1., 2., 0.], [1., 2., 0.]].map(Vec3::from)
            );
        }
        assert_eq!(at("linear", 3), Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(at("linear", 6), Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(camera(&parse(&text("linear")), &scene(), 3).unwrap().fov_y_deg, 30.0);
    }

    #[test]
    fn a_smooth_path_follows_a_parabola_whatever_the_spacing_of_its_keyframes() {
        let parabola = |t: f64| DVec3::new(t * t, 3.0 - t, 0.5 * t * t + t);
        let keys = [-1.0, 0.0, 0.7, 2.0, 5.0, 6.0].map(|t| (t, parabola(t)));
        for step in 0..=50 {
            let time = f64::from(step) * 0.1;
            let found = sample(&keys, time, Interpolation::CatmullRom).unwrap();
            assert!((found - parabola(time)).length() < 1e-9, "{time}: {found}");
        }
    }

    #[test]
    fn a_path_that_looks_along_its_up_is_refused_by_frame() {
        let config = parse(
            "frame.fps = 1\n[camera]\nkeyframes = [{ time = 0, position = [0, 0, 0], target = [1, -1, 0] }, { time = 2, position = [0, 0, 0], target = [-1, -1, 0] }]",
        );
        assert!(camera(&config, &scene(), 0).is_ok());
        assert!(camera(&config, &scene(), 1).unwrap_err().to_string().contains("in frame 1 it looks straight along camera.up"));
    }

    #[test]
    fn the_configs_lights_replace_the_scenes_and_move() {
        assert_eq!(lights(&Config::default(), &scene(), 0), scene().lights);
        let text = "frame.fps = 1
            [[light]]\nkind = \"spot\"\nposition = [0, 4, 0]\ntarget = [0, 0, 0]\nintensity = [2, 2, 2]\nouter_deg = 20
            keyframes = [{ time = 0, intensity = [2, 2, 2] }, { time = 1, position = [0, 4, 0] }, { time = 2, intensity = [4, 0, 2], position = [4, 0, 0] }]
            [[light]]\nkind = \"directional\"\nposition = [3, 0, 0]\ntarget = [1, 0, 0]\nirradiance = [1, 2, 3]
            [[light]]\nkind = \"directional\"\ndirection = [0, -7, 0]\nirradiance = [1, 1, 1]
            keyframes = [{ time = 0, direction = [5, 0, 0] }, { time = 2, direction = [0, -1, 0] }, { time = 4, direction = [0, 1, 0] }]";
        let at = |frame| lights(&parse(text), &scene(), frame);
        let spot = |position: [f32; 3], direction: [f32; 3], intensity: [f32; 3]| Light::Spot {
            position: position.into(),
            direction: direction.into(),
            intensity: intensity.into(),
            inner: 15f32.to_radians(),
            outer: 20f32.to_radians(),
            falloff: SpotFalloff::Angle,
        };
        assert_eq!(at(0)[0], spot([0., 4., 0.], [0., -1., 0.], [2., 2., 2.]));
        assert_eq!(at(1)[0], spot([0., 4., 0.], [0., -1., 0.], [3., 1., 2.]));
        assert_eq!(at(9)[0], spot([4., 0., 0.], [-1., 0., 0.], [4., 0., 2.]));
        assert_eq!(at(0)[1], Light::Directional { direction: Vec3::NEG_X, irradiance: Vec3::new(1.0, 2.0, 3.0) });
        let direction = |frame: u32| match at(frame)[2] {
            Light::Directional { direction, .. } => direction,
            ref other => panic!("{other:?}"),
        };
        assert!((direction(1) - Vec3::new(0.5f32.sqrt(), -(0.5f32.sqrt()), 0.0)).length() < 1e-6);
        assert_eq!(direction(3), Vec3::NEG_Y, "halfway between opposite directions the light keeps its own");
    }
}
