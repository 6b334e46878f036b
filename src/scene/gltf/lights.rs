//! Lights of KHR_lights_punctual, and cameras, at their nodes.

use super::{File, Warning, Warnings, label, refuse};
use crate::scene::{Camera, Light, SpotFalloff};
use anyhow::{Context, Result};
use glam::{DAffine3, Vec3};
use gltf_json::camera::Type as CameraType;
use gltf_json::extensions::scene::khr_lights_punctual::{Light as PunctualLight, Type};
use gltf_json::validation::Checked;
use gltf_json::{Index, Node};
use std::f32::consts::{FRAC_PI_2, PI};

/// A light at a node, shining along the node's -Z. The extension's photometric numbers (lux, candela) are taken as radiometric
/// ones (W/m^2, W/sr) of the same value.
pub fn light(file: &File<'_>, index: Index<PunctualLight>, world: DAffine3, warnings: &mut Warnings) -> Result<Light> {
    let light = file.get(index, "light")?;
    punctual(light, world, warnings).with_context(|| label("light", index.value(), light.name.as_ref()))
}

fn punctual(light: &PunctualLight, world: DAffine3, warnings: &mut Warnings) -> Result<Light> {
    let power = Vec3::from(light.color) * light.intensity;
    if !(power.is_finite() && power.min_element() >= 0.0) {
        refuse!("its intensity {} times its color {:?} is negative or not finite", light.intensity, light.color);
    }
    if light.range.is_some() {
        warnings
            .add(Warning::LightRange, "the range of lights is ignored: light falls off with the square of the distance, without an end");
    }
    let (position, direction) = (Vec3::ZERO, Vec3::NEG_Z);
    let mut made = match light.type_ {
        Checked::Valid(Type::Directional) => Light::Directional { direction, irradiance: power },
        Checked::Valid(Type::Point) => Light::Point { position, intensity: power },
        Checked::Valid(Type::Spot) => {
            let Some(spot) = &light.spot else {
                refuse!("it is a spot light, but does not have the object \"spot\"");
            };
            let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
            // The tolerance admits pi / 2 as rounded by other programs.
            if !(0.0 <= inner && inner < outer && outer <= FRAC_PI_2 + 1e-4) {
                refuse!("its cone angles, inner {inner} and outer {outer}, must hold 0 <= inner < outer <= pi / 2");
            }
            let falloff = SpotFalloff::CosineSquared;
            Light::Spot { position, direction, intensity: power, inner, outer: outer.min(FRAC_PI_2), falloff }
        }
        Checked::Invalid => refuse!("its type is none of directional, point and spot"),
    };
    made.stand_at(world);
    Ok(made)
}

/// A perspective camera at a node, looking along the node's -Z. Orthographic cameras are left out.
pub fn camera(
    file: &File<'_>,
    index: Index<gltf_json::Camera>,
    node: &Node,
    world: DAffine3,
    warnings: &mut Warnings,
) -> Result<Option<Camera>> {
    let camera = file.get(index, "camera")?;
    let called = label("camera", index.value(), camera.name.as_ref());
    let perspective = match (camera.type_, &camera.perspective) {
        (Checked::Valid(CameraType::Perspective), Some(perspective)) => perspective,
        (Checked::Valid(CameraType::Orthographic), _) => {
            warnings.add(Warning::Orthographic, format!("{called} is orthographic, which is not supported: it is left out"));
            return Ok(None);
        }
        _ => refuse!("{called} is neither orthographic nor has the object \"perspective\""),
    };
    let fov = perspective.yfov;
    if !(fov > 0.0 && fov < PI) {
        refuse!("the yfov of {called} is {fov}, it must lie between 0 and pi");
    }
    let mut made = Camera {
        // Users see the node's name in their modelling programs.
        name: node.name.clone().or_else(|| camera.name.clone()).unwrap_or_else(|| format!("camera {index}")),
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov_y_deg: fov.to_degrees(),
    };
    made.stand_at(world);
    Ok(Some(made))
}
