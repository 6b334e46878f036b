//! Structs shared by Rust and GLSL. They are written in both languages, and compared when a pipeline is made.

use crate::gpu::{Block, BlockMember};
use anyhow::{Result, bail};
use bytemuck::Pod;

/// A member of a [`ShaderStruct`]; offset and size in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Member {
    pub name: &'static str,
    /// Its type in Rust, as `[f32; 3]`.
    pub kind: &'static str,
    pub offset: usize,
    pub bytes: usize,
}

/// A `#[repr(C)]` struct whose GLSL twin has the same members at the same offsets under `layout(scalar)`. Numbers and vectors implement it
/// without members, and only their size is compared. Use [`crate::shader_struct!`].
pub trait ShaderStruct: Pod {
    const NAME: &'static str;
    const MEMBERS: &'static [Member];
}

impl ShaderStruct for u32 {
    const NAME: &'static str = "uint";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for f32 {
    const NAME: &'static str = "float";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for [u32; 2] {
    const NAME: &'static str = "uvec2";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for [u32; 4] {
    const NAME: &'static str = "uvec4";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for [f32; 2] {
    const NAME: &'static str = "vec2";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for [f32; 3] {
    const NAME: &'static str = "vec3";
    const MEMBERS: &'static [Member] = &[];
}

impl ShaderStruct for [f32; 4] {
    const NAME: &'static str = "vec4";
    const MEMBERS: &'static [Member] = &[];
}

/// Declares structs that shaders share: `shader_struct! { /// doc \n pub struct Name { pub member: Type } }`.
#[macro_export]
macro_rules! shader_struct {
    ($( $(#[$meta:meta])* $vis:vis struct $name:ident { $( $(#[$member_meta:meta])* $member_vis:vis $member:ident : $ty:ty ),* $(,)? } )*) => {
        $(
            $(#[$meta])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, ::bytemuck::Pod, ::bytemuck::Zeroable)]
            $vis struct $name { $( $(#[$member_meta])* $member_vis $member: $ty ),* }

            impl $crate::graph::ShaderStruct for $name {
                const NAME: &'static str = stringify!($name);
                const MEMBERS: &'static [$crate::graph::Member] = &[$(
                    $crate::graph::Member {
                        name: stringify!($member),
                        kind: stringify!($ty),
                        offset: ::std::mem::offset_of!($name, $member),
                        bytes: ::std::mem::size_of::<$ty>(),
                    }
                ),*];
            }
        )*
    };
}

impl super::Element {
    pub(super) fn of<T: ShaderStruct>() -> Self {
        Self { name: T::NAME, members: T::MEMBERS, bytes: size_of::<T>() }
    }

    /// Compares the Rust side with the shader's block; the error names the first difference.
    pub(super) fn check(&self, block: &Block) -> Result<()> {
        if let Some(stride) = block.stride
            && stride != self.bytes
        {
            bail!("an element of {} takes {} bytes here and {stride} in the shader", self.name, self.bytes);
        }
        if self.members.is_empty() {
            return Ok(());
        }
        let spelled = |m: Option<&BlockMember>| m.map_or("nothing".into(), |m| format!("{} at {} ({} bytes)", m.name, m.offset, m.bytes));
        for i in 0..self.members.len().max(block.members.len()) {
            let (ours, theirs) = (self.members.get(i), block.members.get(i));
            let ours = ours.map(|m| BlockMember { name: m.name.into(), offset: m.offset, bytes: m.bytes });
            if ours.as_ref() != theirs {
                bail!("member {i} of {} is {} here and {} in the shader", self.name, spelled(ours.as_ref()), spelled(theirs));
            }
        }
        Ok(())
    }
}
