//! Typed arrays: accessors with any component type, stride, normalization and sparse replacements.

use super::buffers::View;
use super::{File, refuse};
use anyhow::{Context, Result};
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Index, buffer};
use std::fmt;

/// Limit of elements of an accessor without a buffer view. It is all zeros, and no bytes of the file bound its count.
const MAX_ZEROS: u64 = 1 << 20;

/// Use of an accessor: a vertex attribute, a property of animation keys, or matrices of a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attribute {
    Position,
    Normal,
    Tangent,
    TexCoord(u32),
    Color,
    Joints(u32),
    Weights(u32),
    Time,
    Translation,
    Rotation,
    Scale,
    MorphWeights,
    InverseBind,
}

impl fmt::Display for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position => f.write_str("POSITION"),
            Self::Normal => f.write_str("NORMAL"),
            Self::Tangent => f.write_str("TANGENT"),
            Self::TexCoord(set) => write!(f, "TEXCOORD_{set}"),
            Self::Color => f.write_str("COLOR_0"),
            Self::Joints(set) => write!(f, "JOINTS_{set}"),
            Self::Weights(set) => write!(f, "WEIGHTS_{set}"),
            Self::Time => f.write_str("time"),
            Self::Translation => f.write_str("translation"),
            Self::Rotation => f.write_str("rotation"),
            Self::Scale => f.write_str("scale"),
            Self::MorphWeights => f.write_str("weights"),
            Self::InverseBind => f.write_str("inverseBindMatrices"),
        }
    }
}

impl Attribute {
    /// Whether KHR_mesh_quantization allows more of the attribute.
    fn may_be_quantized(self) -> bool {
        matches!(self, Self::Position | Self::Normal | Self::Tangent | Self::TexCoord(_) | Self::Color)
    }

    /// Whether the attribute may have this component type, by glTF 2.0 or KHR_mesh_quantization.
    fn allows(self, component: ComponentType, normalized: bool, quantized: bool) -> bool {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        match (self, component) {
            (Self::Joints(_), U8 | U16) => !normalized,
            (Self::Joints(_), _) => false,
            (_, F32) => !normalized,
            (_, U32) => false,
            (Self::Position, _) => quantized,
            (Self::Normal | Self::Tangent, I8 | I16) => quantized && normalized,
            (Self::Normal | Self::Tangent, _) => false,
            (Self::TexCoord(_), U8 | U16) => normalized || quantized,
            (Self::TexCoord(_), _) => quantized,
            (Self::Color | Self::Weights(_), U8 | U16) => normalized,
            (Self::Color | Self::Weights(_), _) => false,
            (Self::Rotation | Self::MorphWeights, _) => normalized,
            (Self::Time | Self::Translation | Self::Scale | Self::InverseBind, _) => false,
        }
    }
}

fn size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn dimensions(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

/// An accessor whose type and component type are valid.
struct Typed<'a> {
    accessor: &'a Accessor,
    component: ComponentType,
    kind: Type,
}

impl File<'_> {
    /// Number of an accessor's elements.
    pub fn count(&self, index: Index<Accessor>) -> Result<u64> {
        Ok(self.get(index, "accessor")?.count.0)
    }

    /// An attribute's elements as floats, all finite, of `N` components. A colour of three components gets ones in the rest.
    pub fn floats<const N: usize>(&self, index: Index<Accessor>, attribute: Attribute) -> Result<Vec<[f32; N]>> {
        self.read_floats(index, attribute).with_context(|| format!("{attribute}, accessor {index}"))
    }

    /// Vertex indices.
    pub fn indices(&self, index: Index<Accessor>) -> Result<Vec<u32>> {
        self.read_indices(index).with_context(|| format!("indices, accessor {index}"))
    }

    fn read_floats<const N: usize>(&self, index: Index<Accessor>, attribute: Attribute) -> Result<Vec<[f32; N]>> {
        let typed = self.typed(index)?;
        let Typed { accessor, component, kind } = typed;
        let padded_color = attribute == Attribute::Color && kind == Type::Vec3 && N == 4;
        if padded_color {
            let rgb: Vec<[f32; 3]> = self.read_floats(index, attribute)?;
            return Ok(rgb.into_iter().map(|c| std::array::from_fn(|i| c.get(i).copied().unwrap_or(1.0))).collect());
        }
        let is_matrix = matches!(kind, Type::Mat2 | Type::Mat3 | Type::Mat4);
        if is_matrix != (attribute == Attribute::InverseBind) || dimensions(kind) != N {
            refuse!("its type is {kind:?}, which {attribute} cannot be");
        }
        if !attribute.allows(component, accessor.normalized, self.quantized) {
            let normalized = if accessor.normalized { "normalized " } else { "" };
            let hint = if attribute.may_be_quantized() { " (integers may need KHR_mesh_quantization)" } else { "" };
            refuse!("its components are {normalized}{component:?}, which {attribute} cannot be{hint}");
        }
        let normalized = accessor.normalized;
        let scale = |max: f32| if normalized { 1.0 / max } else { 1.0 };
        let floor = if normalized { -1.0 } else { f32::NEG_INFINITY };
        let elements = match component {
            ComponentType::F32 => self.elements(&typed, f32::from_le_bytes)?,
            ComponentType::I8 => self.elements(&typed, |b| (f32::from(i8::from_le_bytes(b)) * scale(127.0)).max(floor))?,
            ComponentType::I16 => self.elements(&typed, |b| (f32::from(i16::from_le_bytes(b)) * scale(32767.0)).max(floor))?,
            ComponentType::U8 => self.elements(&typed, |[b]: [u8; 1]| f32::from(b) * scale(255.0))?,
            ComponentType::U16 => self.elements(&typed, |b| f32::from(u16::from_le_bytes(b)) * scale(65535.0))?,
            ComponentType::U32 => unreachable!("no attribute allows it"),
        };
        if let Some(bad) = elements.iter().position(|element: &[f32; N]| !element.iter().all(|c| c.is_finite())) {
            refuse!("element {bad} is not finite");
        }
        Ok(elements)
    }

    fn read_indices(&self, index: Index<Accessor>) -> Result<Vec<u32>> {
        let typed = self.typed(index)?;
        if typed.kind != Type::Scalar || typed.accessor.normalized {
            refuse!("its type is {:?}, indices are scalars that are not normalized", typed.kind);
        }
        let elements = match typed.component {
            ComponentType::U8 => self.elements(&typed, |[b]: [u8; 1]| u32::from(b))?,
            ComponentType::U16 => self.elements(&typed, |b| u32::from(u16::from_le_bytes(b)))?,
            ComponentType::U32 => self.elements(&typed, u32::from_le_bytes)?,
            other => refuse!("its components are {other:?}, indices are U8, U16 or U32"),
        };
        Ok(elements.into_iter().map(|[i]: [u32; 1]| i).collect())
    }

    fn typed(&self, index: Index<Accessor>) -> Result<Typed<'_>> {
        let accessor = self.get(index, "accessor")?;
        let Checked::Valid(component) = accessor.component_type else {
            refuse!("its componentType is none of glTF's");
        };
        let Checked::Valid(kind) = accessor.type_ else {
            refuse!("its type is none of glTF's");
        };
        Ok(Typed { accessor, component: component.0, kind })
    }

    /// All elements of an accessor; `convert` reads each component.
    fn elements<T: Copy + Default, const N: usize, const SIZE: usize>(
        &self,
        typed: &Typed<'_>,
        convert: impl Fn([u8; SIZE]) -> T,
    ) -> Result<Vec<[T; N]>> {
        let accessor = typed.accessor;
        debug_assert_eq!((SIZE, N), (size(typed.component), dimensions(typed.kind)));
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let at = accessor.byte_offset.unwrap_or_default().0;
                strided(self.view(view)?, at, accessor.count.0, &convert).with_context(|| format!("buffer view {view}"))?
            }
            None if accessor.count.0 > MAX_ZEROS => {
                refuse!("it has {} elements but no buffer view, at most {MAX_ZEROS} are supported", accessor.count.0)
            }
            None => vec![[T::default(); N]; accessor.count.0 as usize],
        };
        let Some(sparse) = &accessor.sparse else {
            return Ok(elements);
        };
        let count = sparse.count.0;
        let Checked::Valid(component) = sparse.indices.component_type else {
            refuse!("the componentType of its sparse indices is none of U8, U16 and U32");
        };
        let (at, view) = (sparse.indices.byte_offset.0, self.sparse_view(sparse.indices.buffer_view)?);
        let indices: Vec<u64> = match component.0 {
            ComponentType::U8 => strided(view, at, count, &|[b]: [u8; 1]| u64::from(b))?.into_iter().map(|[i]| i).collect(),
            ComponentType::U16 => strided(view, at, count, &|b| u64::from(u16::from_le_bytes(b)))?.into_iter().map(|[i]| i).collect(),
            _ => strided(view, at, count, &|b| u64::from(u32::from_le_bytes(b)))?.into_iter().map(|[i]| i).collect(),
        };
        let values: Vec<[T; N]> = strided(self.sparse_view(sparse.values.buffer_view)?, sparse.values.byte_offset.0, count, &convert)?;
        for (index, value) in indices.into_iter().zip(values) {
            let length = elements.len();
            let Some(element) = usize::try_from(index).ok().and_then(|index| elements.get_mut(index)) else {
                refuse!("its sparse index {index} is past its {length} elements");
            };
            *element = value;
        }
        Ok(elements)
    }

    /// The view of sparse indices or values, which are tightly packed.
    fn sparse_view(&self, index: Index<buffer::View>) -> Result<View<'_>> {
        Ok(View { stride: None, ..self.view(index)? })
    }
}

/// `count` elements of `N` components of `SIZE` bytes each, from byte `at` of a view.
fn strided<T: Copy, const N: usize, const SIZE: usize>(
    view: View<'_>,
    at: u64,
    count: u64,
    convert: &impl Fn([u8; SIZE]) -> T,
) -> Result<Vec<[T; N]>> {
    let element = N * SIZE;
    let stride = view.stride.unwrap_or(element);
    if stride < element {
        refuse!("its byteStride of {stride} is less than an element's {element} bytes");
    }
    if count == 0 {
        return Ok(Vec::new());
    }
    let end = (count - 1).checked_mul(stride as u64).and_then(|last| last.checked_add(at)?.checked_add(element as u64));
    if end.is_none_or(|end| end > view.bytes.len() as u64) {
        refuse!("{count} elements from byte {at} on go past its {} bytes", view.bytes.len());
    }
    let component = |chunk: &[u8], i: usize| {
        let bytes = chunk[i * SIZE..].first_chunk().unwrap_or_else(|| unreachable!("an element has N * SIZE bytes"));
        convert(*bytes)
    };
    let chunks = view.bytes[at as usize..].chunks(stride).take(count as usize);
    Ok(chunks.map(|chunk| std::array::from_fn(|i| component(chunk, i))).collect())
}
