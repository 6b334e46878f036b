//! The sky of a frame: an environment light's radiance, constant or from a map on the device.

use crate::gpu::{Format, Gpu, ImageId};
use crate::graph::{Buffer, Graph, Image};
use crate::scene::Light;
use crate::scene::sky::SkyMap;
use crate::shader_struct;
use anyhow::{Context, Result};
use glam::Vec3;
use std::collections::BTreeMap;
use std::f32::consts::TAU;
use std::path::{Path, PathBuf};

shader_struct! {
    /// `glsl/sky/radiance-constant.glsl` and its rivals.
    struct SkyBlock {
        radiance: [f32; 3],
        turn: f32,
    }
}

/// The environment of a frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Environment {
    /// Radiance, or with a map a factor of the map's.
    pub radiance: Vec3,
    /// File of the map.
    pub map: Option<PathBuf>,
    /// Turn of the map about +Y, radians, counter-clockwise seen from above.
    pub rotation: f32,
}

impl Environment {
    /// Sum of the environment lights. Only one of them may have a map, and it is the only one then.
    pub fn of(lights: &[Light]) -> Self {
        let mut sum = Self::default();
        for light in lights {
            if let Light::Environment { radiance, map, rotation } = light {
                sum = Self { radiance: sum.radiance + *radiance, map: map.clone(), rotation: *rotation };
            }
        }
        sum
    }

    /// Whether any light comes from it.
    pub fn shines(&self) -> bool {
        self.radiance != Vec3::ZERO
    }
}

/// A map on the host and on the device, which owns its images.
struct DeviceMap {
    map: SkyMap,
    texels: ImageId,
    rows: ImageId,
}

/// Maps of the sky by file. Each is read once.
#[derive(Default)]
pub struct Skies(BTreeMap<PathBuf, DeviceMap>);

/// The sky in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameSky<'f> {
    /// Uniform block of `glsl/sky/radiance-*.glsl`.
    pub block: Buffer,
    /// Radiance, or with a map a factor of the map's.
    pub radiance: Vec3,
    /// Turn of the map about +Y, radians.
    pub rotation: f32,
    pub map: Option<FrameSkyMap<'f>>,
}

/// A map of the sky in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameSkyMap<'f> {
    pub map: &'f SkyMap,
    /// [`SkyMap::texels`].
    pub texels: Image,
    /// [`SkyMap::rows`].
    pub rows: Image,
}

impl Skies {
    /// Reads a map and uploads it, if it is not there yet. `key` is the config's, for errors.
    ///
    /// # Errors
    /// As [`SkyMap::read`], and the device's own.
    pub fn bring(&mut self, gpu: &mut Gpu, key: &str, path: &Path) -> Result<()> {
        if !self.0.contains_key(path) {
            let map = SkyMap::read(path).with_context(|| key.to_owned())?;
            let [width, height] = map.size;
            let image = |gpu: &mut Gpu, name, format, size, bytes| gpu.create_filled_image(name, format, size, bytes, false);
            let texels = image(gpu, "sky/map", Format::Rgba32Float, [width, height, 1], bytemuck::cast_slice(&map.texels))?;
            let rows = image(gpu, "sky/rows", Format::R32Float, [height, 1, 1], bytemuck::cast_slice(&map.rows))?;
            self.0.insert(path.to_owned(), DeviceMap { map, texels, rows });
        }
        Ok(())
    }

    /// The map of a file that was [brought](Self::bring).
    pub fn map(&self, path: &Path) -> Option<&SkyMap> {
        self.0.get(path).map(|of| &of.map)
    }

    /// Imports an environment into a frame's graph.
    ///
    /// # Panics
    /// If its map was not brought.
    pub fn import(&self, g: &mut Graph, environment: &Environment) -> FrameSky<'_> {
        let map = environment.map.as_ref().map(|path| {
            let of = self.0.get(path).unwrap_or_else(|| unreachable!("{}: a frame was described before its map was read", path.display()));
            let [width, height] = of.map.size;
            FrameSkyMap {
                map: &of.map,
                texels: g.import_image("sky/map", of.texels, Format::Rgba32Float, [width, height], 1),
                rows: g.import_image("sky/rows", of.rows, Format::R32Float, [height, 1], 1),
            }
        });
        let (radiance, rotation) = (environment.radiance, environment.rotation);
        let block = SkyBlock { radiance: radiance.into(), turn: rotation / TAU };
        FrameSky { block: g.upload("sky/block", &[block]), radiance, rotation, map }
    }
}
