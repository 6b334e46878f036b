//! Scenes: triangles, materials, textures, lights and cameras, as plain host data.
//!
//! A scene comes from a glTF file ([`gltf`]) or from code ([`builtin`]). It has one vertex and one index array; a [`Draw`] is a
//! range of them with a material and a transform. Lengths are metres, +Y is up, the coordinate system is right-handed, and
//! light is in the radiometric units of the README.

pub mod animation;
pub mod bend;
pub mod builder;
pub mod builtin;
pub mod caches;
pub mod gltf;
pub mod order;
pub mod pack;
pub mod sky;
pub mod source;
pub mod split;
pub mod tangents;
pub mod track;

use glam::{Affine3A, Mat2, Vec2, Vec3};
use std::path::PathBuf;

/// A vertex as laid out in the vertex buffer: 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Position in the draw's own space, m.
    pub position: [f32; 3],
    /// Shading normal, octahedral, two signed normalized 16-bit numbers ([`pack::octahedral_snorm16`]).
    pub normal: u32,
    /// Texture coordinates as in glTF: (0, 0) is the image's upper left corner.
    pub uv: [f32; 2],
    /// Linear RGBA, four unsigned normalized bytes ([`pack::unorm8x4`]); multiplies the base colour.
    pub color: u32,
    /// Tangent and its handedness ([`pack::tangent`]); only read if the material has a normal map.
    pub tangent: u32,
}

/// A scene: its geometry, materials, lights and cameras.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Name for the user: the file's, or the built-in's.
    pub name: String,
    pub vertices: Vec<Vertex>,
    /// Indices, three per triangle, relative to the draw's `vertex_offset`; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    pub draws: Vec<Draw>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    /// The scene's own lights; the config's `[[light]]` tables replace them.
    pub lights: Vec<Light>,
    /// The scene's own cameras; the first is the default.
    pub cameras: Vec<Camera>,
    /// The animation, if there is one. The other fields hold the scene at one time: [`Scene::set_time`].
    pub animation: Option<animation::Animation>,
    /// Meshes that bend, if there are any.
    pub bending: Option<bend::Bending>,
}

/// A range of triangles with one material and one transform. Several draws may share a range (instances).
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    pub first_index: u32,
    pub index_count: u32,
    /// Offset added to every index of the range.
    pub vertex_offset: u32,
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// Transform from the draw's own space to the world.
    pub transform: Affine3A,
}

/// A surface: Lambert for dielectrics, GGX for metals. Factors multiply their maps, as in glTF.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGBA; alpha only matters with `alpha_cutoff`.
    pub base_color: [f32; 4],
    pub base_color_map: Option<Map>,
    pub metallic: f32,
    /// Perceptual roughness; its square is GGX alpha.
    pub roughness: f32,
    /// Metallic in blue, roughness in green.
    pub metallic_roughness_map: Option<Map>,
    /// Emitted radiance, RGB, strength included.
    pub emission: [f32; 3],
    pub emission_map: Option<Map>,
    pub normal_map: Option<Map>,
    pub normal_scale: f32,
    /// Alpha under which texels are holes; `None` is opaque.
    pub alpha_cutoff: Option<f32>,
    /// Whether both faces reflect. Otherwise back faces are invisible to the camera, and light that hits them is lost.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_map: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_map: None,
            emission: [0.0; 3],
            emission_map: None,
            normal_map: None,
            normal_scale: 1.0,
            alpha_cutoff: None,
            double_sided: false,
        }
    }
}

/// A use of a texture: its index, wrapping, filter, and transform on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Map {
    /// Index into [`Scene::textures`].
    pub texture: u32,
    pub wrap_u: Wrap,
    pub wrap_v: Wrap,
    pub filter: Filter,
    /// Transform of texture coordinates: the texture is looked up at `matrix * uv + offset`.
    pub matrix: Mat2,
    pub offset: Vec2,
}

impl Map {
    /// The texture untransformed, repeated, and filtered linearly.
    pub fn new(texture: u32) -> Self {
        Self { texture, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, filter: Filter::Linear, matrix: Mat2::IDENTITY, offset: Vec2::ZERO }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Wrap {
    Repeat,
    MirroredRepeat,
    ClampToEdge,
}

/// Magnification filter. Minification is trilinear with `Linear`; with `Nearest` it takes the nearest texel of the nearest mip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Filter {
    Linear,
    Nearest,
}

/// An image of `width * height` RGBA texels of 8 bits each, first row on top. Mips are made on upload.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Whether RGB is sRGB-encoded colour; otherwise it is linear data.
    pub srgb: bool,
    pub texels: Vec<u8>,
}

/// A light source. Directions are normalized, and point the way the light travels.
#[derive(Debug, Clone, PartialEq)]
pub enum Light {
    /// Irradiance on a plane that faces the light, W/m^2.
    Directional { direction: Vec3, irradiance: Vec3 },
    /// Radiant intensity on the axis, W/sr; half-angles in radians.
    Spot { position: Vec3, direction: Vec3, intensity: Vec3, inner: f32, outer: f32, falloff: SpotFalloff },
    /// Radiant intensity, W/sr, equal in all directions.
    Point { position: Vec3, intensity: Vec3 },
    /// Radiance from all directions, W/(m^2 sr). If there is a map of the sky ([`sky::SkyMap`]), by its file, it is a factor of the map's, and
    /// `rotation` turns the map about +Y, radians.
    Environment { radiance: Vec3, map: Option<PathBuf>, rotation: f32 },
}

/// Falloff of a spot light between its inner and its outer half-angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpotFalloff {
    /// `clamp((outer - a) / (outer - inner), 0, 1)` at angle a from the axis: the config's lights, and Mitsuba's `spot`.
    Angle,
    /// `clamp((cos a - cos outer) / (cos inner - cos outer), 0, 1)^2` at angle a from the axis: KHR_lights_punctual.
    CosineSquared,
}

/// A pinhole camera with square pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    pub name: String,
    pub position: Vec3,
    /// A point straight ahead.
    pub target: Vec3,
    pub up: Vec3,
    /// Vertical field of view, degrees.
    pub fov_y_deg: f32,
}

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    pub min: Vec3,
    pub max: Vec3,
}

impl Aabb {
    /// The empty box; the identity of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Bounds of this box after a transform.
    pub fn transformed(self, transform: &Affine3A) -> Self {
        Self::of(self.corners().map(|corner| transform.transform_point3(corner)))
    }

    pub fn center(self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    pub fn size(self) -> Vec3 {
        self.max - self.min
    }

    pub fn corners(self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}

impl Scene {
    pub fn triangle_count(&self) -> u64 {
        self.draws.iter().map(|draw| u64::from(draw.index_count) / 3).sum()
    }

    /// The vertices of a draw's triangles, three per triangle.
    pub fn draw_vertices(&self, draw: &Draw) -> impl Iterator<Item = &Vertex> {
        let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
        let offset = draw.vertex_offset;
        self.indices[range].iter().map(move |&i| &self.vertices[(offset + i) as usize])
    }

    /// World-space bounds of all draws. Draws that move or bend count with their bounds over the whole
    /// animation ([`Scene::swept_bounds`]), so that sizes derived from the bounds do not jitter.
    pub fn bounds(&self) -> Aabb {
        let moving = self.moving_draws();
        let still = self.draws.iter().zip(moving).filter(|(_, moves)| !moves).map(|(draw, _)| self.draw_bounds(draw));
        still.chain(self.swept_bounds().into_iter().map(|(_, swept)| swept)).fold(Aabb::EMPTY, Aabb::union)
    }

    /// World-space bounds of a draw at the scene's present time.
    pub fn draw_bounds(&self, draw: &Draw) -> Aabb {
        Aabb::of(self.draw_vertices(draw).map(|vertex| draw.transform.transform_point3(vertex.position.into())))
    }
}
