//! A compiled shader and its reflection: names, kinds and access of resources, and the layout of blocks.

use anyhow::{Context, Result, bail};
use spirq::constant::ConstantValue;
use spirq::prelude::*;
use spirq::ty::{AccessType, DescriptorType, ScalarType, Type};
use std::collections::{HashMap, HashSet};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShaderStage {
    Vertex,
    TessellationControl,
    TessellationEvaluation,
    Geometry,
    Fragment,
    Compute,
}

impl ShaderStage {
    /// File extensions and stages, in the order of a pipeline.
    pub const ALL: [(&'static str, Self); 6] = [
        ("vert", Self::Vertex),
        ("tesc", Self::TessellationControl),
        ("tese", Self::TessellationEvaluation),
        ("geom", Self::Geometry),
        ("frag", Self::Fragment),
        ("comp", Self::Compute),
    ];
}

/// SPIR-V with its interface. Resources have their names in GLSL.
#[derive(Debug, Clone)]
pub struct Shader {
    /// Path below the shader folder, for messages.
    pub name: String,
    pub stage: ShaderStage,
    /// SPIR-V.
    pub words: Vec<u32>,
    pub bindings: Vec<Binding>,
    /// Push-constant block.
    pub push_constants: Option<Block>,
    /// Specialization constants: name and id.
    pub constants: Vec<(String, u32)>,
    /// Inputs from the stage before, or from the vertex.
    pub inputs: Vec<Input>,
    /// Outputs of a fragment shader: name and location.
    pub outputs: Vec<(String, u32)>,
    /// Workgroup size of a compute shader: the value, and the specialization constant that sets it.
    local_size: [(u32, Option<u32>); 3],
}

/// An input of a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    pub name: String,
    pub location: u32,
    /// GLSL name of its type, such as `vec3`.
    pub glsl: String,
}

/// A resource that a shader uses.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    pub name: String,
    pub kind: BindingKind,
    pub access: ShaderAccess,
}

#[derive(Debug, Clone, PartialEq)]
pub enum BindingKind {
    UniformBlock(Block),
    StorageBlock(Block),
    /// Combined image and sampler.
    Sampled {
        array: bool,
    },
    StorageImage {
        array: bool,
    },
}

/// Access to a resource by the shader's qualifiers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShaderAccess {
    Read,
    Write,
    ReadWrite,
}

/// Layout of a block. If a block consists of one struct, or of one array of structs, its members are the struct's.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    pub members: Vec<BlockMember>,
    /// Stride of the array, bytes.
    pub stride: Option<usize>,
}

/// A member of a block or of its array's struct; sizes in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockMember {
    pub name: String,
    pub offset: usize,
    pub bytes: usize,
}

impl Shader {
    /// Reflects SPIR-V that was compiled with names.
    pub fn new(name: &str, stage: ShaderStage, words: Vec<u32>) -> Result<Self> {
        let entry_points = ReflectConfig::new()
            .spv(words.clone())
            .ref_all_rscs(true)
            .combine_img_samplers(false)
            .reflect()
            .with_context(|| format!("glsl/{name}: reflection failed"))?;
        let Some(entry) = entry_points.into_iter().next() else { bail!("glsl/{name}: has no entry point") };
        let mut shader = Self {
            name: name.into(),
            stage,
            words,
            bindings: Vec::new(),
            push_constants: None,
            constants: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            local_size: [(1, None); 3],
        };
        // The crate's own detection of used variables misses atomics on images.
        let used = used_variables(&shader.words);
        for variable in entry.vars {
            match variable {
                Variable::Descriptor { name: resource, desc_ty, ty, nbind, .. } => {
                    let resource = resource.unwrap_or_default();
                    if !used.contains(&resource) {
                        continue;
                    }
                    if nbind != 1 {
                        bail!("glsl/{name}: {resource} is an array of bindings, which not every driver can index");
                    }
                    shader.bindings.push(binding(name, resource, &desc_ty, &ty)?);
                }
                Variable::PushConstant { ty, .. } => shader.push_constants = Some(block(&ty)),
                Variable::SpecConstant { name, spec_id, .. } => shader.constants.push((name.unwrap_or_default(), spec_id)),
                Variable::Input { name: Some(name), location, ty } => {
                    shader.inputs.push(Input { name, location: location.loc(), glsl: glsl_name(&ty) });
                }
                Variable::Output { name: Some(output), location, .. } => shader.outputs.push((output, location.loc())),
                _ => {}
            }
        }
        shader.bindings.sort_by(|a, b| a.name.cmp(&b.name));
        for mode in &entry.exec_modes {
            if matches!(mode.exec_mode, spirq::spirv::ExecutionMode::LocalSize | spirq::spirv::ExecutionMode::LocalSizeId) {
                for (axis, operand) in mode.operands.iter().take(3).enumerate() {
                    let ConstantValue::U32(value) = operand.value else { bail!("glsl/{name}: its workgroup size is no constant") };
                    shader.local_size[axis] = (value, operand.spec_id);
                }
            }
        }
        Ok(shader)
    }

    /// Workgroup size under these specialization constants (id and value).
    pub fn local_size(&self, constants: &[(u32, u32)]) -> [u32; 3] {
        self.local_size.map(|(value, id)| constants.iter().find(|(c, _)| Some(*c) == id).map_or(value, |(_, v)| *v))
    }

    /// SPIR-V with each resource's binding number set by its name.
    pub(super) fn words_bound(&self, numbers: &HashMap<&str, u32>) -> Vec<u32> {
        const OP_DECORATE: u32 = 71;
        const DECORATION_BINDING: u32 = 33;
        let mut words = self.words.clone();
        let names = names(&words);
        for (at, opcode, _) in instructions(&self.words) {
            if opcode == OP_DECORATE && words[at + 2] == DECORATION_BINDING {
                let number = names.get(&words[at + 1]).and_then(|name| numbers.get(name.as_str()));
                // An unused resource gets a number that is out of the way.
                words[at + 3] = number.copied().unwrap_or(u32::from(u16::MAX));
            }
        }
        words
    }
}

/// Instructions of a module: offset, opcode, and length in words.
fn instructions(words: &[u32]) -> impl Iterator<Item = (usize, u32, usize)> {
    let mut at = 5;
    std::iter::from_fn(move || {
        let word = *words.get(at)?;
        let (start, length) = (at, ((word >> 16) as usize).max(1));
        at += length;
        (at <= words.len()).then_some((start, word & 0xffff, length))
    })
}

/// Names of the module's ids.
fn names(words: &[u32]) -> HashMap<u32, String> {
    const OP_NAME: u32 = 5;
    let text = |words: &[u32]| {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|byte| *byte != 0).collect();
        String::from_utf8_lossy(&bytes).into_owned()
    };
    instructions(words)
        .filter(|(_, opcode, length)| *opcode == OP_NAME && *length > 2)
        .map(|(at, _, length)| (words[at + 1], text(&words[at + 2..at + length])))
        .collect()
}

/// Names of variables that any instruction loads from, stores to, points into or passes to a function.
fn used_variables(words: &[u32]) -> HashSet<String> {
    let names = names(words);
    let mut used = HashSet::new();
    for (at, opcode, length) in instructions(words) {
        // Words of the instruction that are pointers.
        let pointers = match opcode {
            // OpStore, OpAtomicStore
            62 | 228 => 1..2,
            // OpImageTexelPointer, OpLoad, OpAccessChain, OpInBoundsAccessChain, OpArrayLength, OpCopyObject, OpAtomic*
            60 | 61 | 65 | 66 | 68 | 83 | 227 | 229..=242 => 3..4,
            // OpFunctionCall
            57 => 4..length,
            _ => continue,
        };
        used.extend(pointers.filter(|i| *i < length).filter_map(|i| names.get(&words[at + i]).cloned()));
    }
    used
}

fn binding(shader: &str, name: String, kind: &DescriptorType, ty: &Type) -> Result<Binding> {
    let access = |access: &AccessType| match access {
        AccessType::ReadOnly => ShaderAccess::Read,
        AccessType::WriteOnly => ShaderAccess::Write,
        AccessType::ReadWrite => ShaderAccess::ReadWrite,
    };
    let (kind, access) = match (kind, ty) {
        (DescriptorType::UniformBuffer(), _) => (BindingKind::UniformBlock(block(ty)), ShaderAccess::Read),
        (DescriptorType::StorageBuffer(a), _) => (BindingKind::StorageBlock(block(ty)), access(a)),
        (DescriptorType::CombinedImageSampler(), Type::CombinedImageSampler(image)) => {
            (BindingKind::Sampled { array: image.sampled_image_ty.is_array }, ShaderAccess::Read)
        }
        (DescriptorType::StorageImage(a), Type::StorageImage(image)) => (BindingKind::StorageImage { array: image.is_array }, access(a)),
        _ => bail!("glsl/{shader}: {name} is of a kind that passes do not bind: {kind:?}"),
    };
    Ok(Binding { name, kind, access })
}

/// GLSL name of a scalar or vector type; other types as the crate prints them.
fn glsl_name(ty: &Type) -> String {
    let (scalar, count) = match ty {
        Type::Scalar(scalar) => (scalar, 1),
        Type::Vector(vector) => (&vector.scalar_ty, vector.nscalar),
        other => return other.to_string(),
    };
    let (one, many) = match scalar {
        ScalarType::Float { bits: 32 } => ("float", "vec"),
        ScalarType::Integer { bits: 32, is_signed: true } => ("int", "ivec"),
        ScalarType::Integer { bits: 32, is_signed: false } => ("uint", "uvec"),
        _ => return ty.to_string(),
    };
    if count == 1 { one.to_owned() } else { format!("{many}{count}") }
}

fn block(ty: &Type) -> Block {
    let members = |ty: &Type| match ty {
        Type::Struct(s) => s
            .members
            .iter()
            .map(|m| BlockMember {
                name: m.name.clone().unwrap_or_default(),
                offset: m.offset.unwrap_or(0),
                bytes: m.ty.nbyte().unwrap_or(0),
            })
            .collect(),
        _ => Vec::new(),
    };
    if let Type::Struct(s) = ty
        && let [only] = s.members.as_slice()
    {
        match &only.ty {
            Type::Array(array) => return Block { members: members(&array.element_ty), stride: array.stride },
            Type::Struct(_) => return Block { members: members(&only.ty), stride: None },
            _ => {}
        }
    }
    Block { members: members(ty), stride: None }
}
