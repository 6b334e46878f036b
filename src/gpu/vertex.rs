//! Vertex layouts: given by whoever draws, and checked against the inputs of the vertex shader.

use super::shader::Shader;
use anyhow::{Result, bail};
use ash::vk;

/// Memory format of an attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VertexFormat {
    /// Two floats, a `vec2`.
    Float2,
    /// Three floats, a `vec3`.
    Float3,
    /// Two signed normalized numbers of 16 bits, a `vec2`.
    Snorm16x2,
    /// Four unsigned normalized bytes, a `vec4`.
    Unorm8x4,
    /// 32 bits, a `uint`.
    Uint,
}

impl VertexFormat {
    pub const fn bytes(self) -> usize {
        match self {
            Self::Float2 => 8,
            Self::Float3 => 12,
            Self::Snorm16x2 | Self::Unorm8x4 | Self::Uint => 4,
        }
    }

    /// GLSL type of the shader's input.
    pub const fn glsl(self) -> &'static str {
        match self {
            Self::Float2 | Self::Snorm16x2 => "vec2",
            Self::Float3 => "vec3",
            Self::Unorm8x4 => "vec4",
            Self::Uint => "uint",
        }
    }

    fn vk(self) -> vk::Format {
        match self {
            Self::Float2 => vk::Format::R32G32_SFLOAT,
            Self::Float3 => vk::Format::R32G32B32_SFLOAT,
            Self::Snorm16x2 => vk::Format::R16G16_SNORM,
            Self::Unorm8x4 => vk::Format::R8G8B8A8_UNORM,
            Self::Uint => vk::Format::R32_UINT,
        }
    }
}

/// An attribute of a vertex, named as the shaders' input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct VertexAttribute {
    pub name: &'static str,
    pub format: VertexFormat,
    /// Offset in the vertex, bytes.
    pub offset: u32,
}

/// Layout of vertices in their buffer. Made by [`vertex_layout!`](crate::vertex_layout).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct VertexLayout {
    pub attributes: &'static [VertexAttribute],
    /// Bytes from a vertex to the next.
    pub stride: u32,
}

impl VertexLayout {
    /// Checks a vertex shader's inputs against the attributes of their names. A shader need not read all; locations are the shader's own.
    ///
    /// # Errors
    /// They name the shader, and the input that the vertex lacks or has with another type.
    pub fn check(&self, shader: &Shader) -> Result<()> {
        self.inputs(shader).map(|_| ())
    }

    /// Attributes that a vertex shader reads, at its locations.
    pub(super) fn inputs(&self, shader: &Shader) -> Result<Vec<vk::VertexInputAttributeDescription>> {
        let mut inputs: Vec<vk::VertexInputAttributeDescription> = Vec::with_capacity(shader.inputs.len());
        for input in &shader.inputs {
            let (name, location) = (&input.name, input.location);
            let Some(attribute) = self.attributes.iter().find(|attribute| attribute.name == name) else {
                bail!("glsl/{}: a vertex has no {name}", shader.name);
            };
            if input.glsl != attribute.format.glsl() {
                bail!("glsl/{}: {name} is a {}, a vertex has it as a {}", shader.name, input.glsl, attribute.format.glsl());
            }
            inputs.push(vk::VertexInputAttributeDescription {
                location,
                binding: 0,
                format: attribute.format.vk(),
                offset: attribute.offset,
            });
        }
        Ok(inputs)
    }
}

/// Vertex layout of a struct by its fields: `vertex_layout!(Vertex { position: Float3, tangent: Uint })`. A field whose size differs from
/// its format's does not compile.
#[macro_export]
macro_rules! vertex_layout {
    ($vertex:ty { $($name:ident: $format:ident),+ $(,)? }) => {
        $crate::gpu::VertexLayout {
            attributes: &[$($crate::gpu::VertexAttribute {
                name: stringify!($name),
                format: $crate::gpu::VertexFormat::$format,
                offset: {
                    const fn bytes<T>(_field: fn(&$vertex) -> &T) -> usize {
                        size_of::<T>()
                    }
                    assert!(bytes(|vertex| &vertex.$name) == $crate::gpu::VertexFormat::$format.bytes());
                    ::std::mem::offset_of!($vertex, $name) as u32
                },
            }),+],
            stride: size_of::<$vertex>() as u32,
        }
    };
}
