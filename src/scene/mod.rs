//! What is rendered: triangles, materials, textures, lights and cameras, as plain host data.
//!
//! A scene comes from a glTF file ([`gltf`]) or is made by code ([`builtin`]). All of it lies in one vertex and one index
//! array; a [`Draw`] is a range of them with a material and a place in the world. Lengths are metres, +Y is up, the
//! coordinate system is right-handed, and light is in the radiometric units of the README.

pub mod animation;
pub mod builder;
pub mod builtin;
pub mod gltf;
pub mod order;
pub mod pack;
pub mod source;
pub mod split;
pub mod tangents;
pub mod track;

use glam::{Affine3A, Mat2, Vec2, Vec3};

/// A vertex as it lies in the vertex buffer: 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Position in the draw's own space, metres.
    pub position: [f32; 3],
    /// Shading normal, octahedral, two signed normalized 16-bit numbers ([`pack::octahedral_snorm16`]).
    pub normal: u32,
    /// Texture coordinates as in glTF: (0, 0) is the upper left corner of the image.
    pub uv: [f32; 2],
    /// Linear RGBA, four unsigned normalized bytes ([`pack::unorm8x4`]); multiplies the base colour.
    pub color: u32,
    /// Tangent and its handedness ([`pack::tangent`]); only read where the material has a normal map.
    pub tangent: u32,
}

/// Everything that is drawn, and what it is lit and seen by.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// What the user calls it: the file's name or the built-in's.
    pub name: String,
    pub vertices: Vec<Vertex>,
    /// Three a triangle, relative to the draw's `vertex_offset`; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    pub draws: Vec<Draw>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    /// The scene's own lights; the config's `[[light]]` tables replace them.
    pub lights: Vec<Light>,
    /// The scene's own cameras; the first is the default one.
    pub cameras: Vec<Camera>,
    /// How it moves, if it does. What stands in the other fields is the scene at one time: [`Scene::set_time`].
    pub animation: Option<animation::Animation>,
}

/// A range of triangles with one material at one place. Several draws may share their range (instances).
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    pub first_index: u32,
    pub index_count: u32,
    /// Added to every index of the range.
    pub vertex_offset: u32,
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// From the draw's own space to the world.
    pub transform: Affine3A,
}

/// A surface: Lambert where it is not metal, GGX where it is. Factors multiply their maps, as in glTF.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGBA; alpha only matters under `alpha_cutoff`.
    pub base_color: [f32; 4],
    pub base_color_map: Option<Map>,
    pub metallic: f32,
    /// Perceptual roughness: GGX alpha is its square.
    pub roughness: f32,
    /// Metallic in blue, roughness in green.
    pub metallic_roughness_map: Option<Map>,
    /// Emitted radiance, RGB, strength included.
    pub emission: [f32; 3],
    pub emission_map: Option<Map>,
    pub normal_map: Option<Map>,
    pub normal_scale: f32,
    /// Texels with less alpha are holes; `None` is opaque.
    pub alpha_cutoff: Option<f32>,
    /// Both faces reflect; otherwise the camera looks through back faces, and light that meets them is lost.
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

/// A use of a texture: which, how it wraps, and where it lies on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Map {
    /// Index into [`Scene::textures`].
    pub texture: u32,
    pub wrap_u: Wrap,
    pub wrap_v: Wrap,
    pub filter: Filter,
    /// The texture is looked up at `matrix * uv + offset`.
    pub matrix: Mat2,
    pub offset: Vec2,
}

impl Map {
    /// The texture as it is: repeated, filtered, not transformed.
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

/// Magnification; minification is trilinear with `Linear` and takes the nearest texel of the nearest mip with `Nearest`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Filter {
    Linear,
    Nearest,
}

/// An image of `width * height` RGBA texels of 8 bits each, first row on top. Mips are made when it goes to the device.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Colour (sRGB curve on RGB) or data (linear).
    pub srgb: bool,
    pub texels: Vec<u8>,
}

/// A light source. Directions are those in which light travels, normalized.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Irradiance on a plane that faces it, W/m^2.
    Directional { direction: Vec3, irradiance: Vec3 },
    /// Radiant intensity on the axis, W/sr; half-angles in radians.
    Spot { position: Vec3, direction: Vec3, intensity: Vec3, inner: f32, outer: f32, falloff: SpotFalloff },
    /// Radiant intensity, W/sr, the same in all directions.
    Point { position: Vec3, intensity: Vec3 },
    /// Radiance from everywhere, W/(m^2 sr).
    Environment { radiance: Vec3 },
}

/// How a spot light falls off between its inner and its outer half-angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpotFalloff {
    /// `clamp((outer - a) / (outer - inner), 0, 1)` of the angle a: the config's lights, and Mitsuba's `spot`.
    Angle,
    /// `clamp((cos a - cos outer) / (cos inner - cos outer), 0, 1)^2`: KHR_lights_punctual.
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
    /// Contains nothing; the identity of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box around this one where a transform takes it.
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

    /// The vertices of a draw's triangles, three each.
    pub fn draw_vertices(&self, draw: &Draw) -> impl Iterator<Item = &Vertex> {
        let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
        let offset = draw.vertex_offset;
        self.indices[range].iter().map(move |&i| &self.vertices[(offset + i) as usize])
    }

    /// World-space bounds of all that is drawn; of what moves, over all of the animation ([`Scene::swept_bounds`]), so that what
    /// depends on them does not tremble.
    pub fn bounds(&self) -> Aabb {
        let moving = self.moving_draws();
        let still = self.draws.iter().zip(moving).filter(|(_, moves)| !moves).map(|(draw, _)| self.draw_bounds(draw));
        still.chain(self.swept_bounds().into_iter().map(|(_, swept)| swept)).fold(Aabb::EMPTY, Aabb::union)
    }

    /// World-space bounds of a draw at the scene's time.
    pub fn draw_bounds(&self, draw: &Draw) -> Aabb {
        Aabb::of(self.draw_vertices(draw).map(|vertex| draw.transform.transform_point3(vertex.position.into())))
    }
}
