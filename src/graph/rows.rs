//! Buffers as tables: a column a number, a row an element.

use super::{DumpData, Member};

/// Kinds of numbers that shaders share with the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    Float,
    Signed,
    Unsigned,
}

impl Number {
    /// The numbers of a Rust type's name, such as `[f32; 3]`.
    fn of(kind: &str) -> Self {
        if kind.contains("f32") || kind.contains("float") || kind.starts_with("vec") {
            Self::Float
        } else if kind.contains("i32") {
            Self::Signed
        } else {
            Self::Unsigned
        }
    }

    fn spelled(self, word: [u8; 4]) -> String {
        match self {
            Self::Float => format!("{:.5}", f32::from_ne_bytes(word)),
            Self::Signed => i32::from_ne_bytes(word).to_string(),
            Self::Unsigned => u32::from_ne_bytes(word).to_string(),
        }
    }
}

/// A buffer of a dump, as a table.
#[derive(Debug)]
pub struct Rows<'d> {
    /// Name of each column: of a member, with the number's place in it if it has several.
    pub columns: Vec<String>,
    numbers: Vec<(usize, Number)>,
    stride: usize,
    bytes: &'d [u8],
}

impl<'d> Rows<'d> {
    /// The buffer in a dump; `None` for an image.
    pub fn of(data: &'d DumpData) -> Option<Self> {
        let DumpData::Buffer { element, members, element_bytes, bytes } = data else { return None };
        let whole = [Member { name: element, kind: element, offset: 0, bytes: *element_bytes }];
        let members = if members.is_empty() { &whole[..] } else { members };
        let (mut columns, mut numbers) = (Vec::new(), Vec::new());
        for member in members {
            let count = member.bytes / 4;
            for i in 0..count {
                columns.push(if count == 1 { member.name.to_owned() } else { format!("{}.{}", member.name, place(i, count)) });
                numbers.push((member.offset + 4 * i, Number::of(member.kind)));
            }
        }
        Some(Self { columns, numbers, stride: *element_bytes, bytes })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.bytes.len() / self.stride.max(1)
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A row's numbers in decimals, one a column.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> Vec<String> {
        let element = &self.bytes[row * self.stride..][..self.stride];
        let word = |at: usize| [element[at], element[at + 1], element[at + 2], element[at + 3]];
        self.numbers.iter().map(|(at, number)| number.spelled(word(*at))).collect()
    }
}

/// Name of a number in a member of `count`.
fn place(i: usize, count: usize) -> String {
    if count <= 4 { "xyzw"[i..=i].to_owned() } else { i.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::ShaderStruct;

    crate::shader_struct! {
        struct Mixed {
            at: [f32; 3],
            number: u32,
            step: i32,
        }
    }

    #[test]
    fn a_struct_has_a_column_a_number_and_a_row_an_element() {
        let elements = [Mixed { at: [1.0, 2.5, -3.0], number: 7, step: -1 }, Mixed { at: [0.0; 3], number: u32::MAX, step: 2 }];
        let bytes = bytemuck::cast_slice(&elements).to_vec();
        let data = DumpData::Buffer { element: Mixed::NAME, members: Mixed::MEMBERS, element_bytes: 20, bytes };
        let rows = Rows::of(&data).unwrap();
        assert_eq!(rows.columns, ["at.x", "at.y", "at.z", "number", "step"]);
        assert_eq!((rows.len(), rows.row(0)), (2, ["1.00000", "2.50000", "-3.00000", "7", "-1"].map(str::to_owned).to_vec()));
        assert_eq!(rows.row(1)[3], "4294967295");
    }

    #[test]
    fn numbers_without_a_struct_are_named_by_their_type() {
        let data = DumpData::Buffer { element: "vec3", members: &[], element_bytes: 12, bytes: vec![0; 24] };
        assert_eq!(
            (Rows::of(&data).unwrap().columns, Rows::of(&data).unwrap().len()),
            (["vec3.x", "vec3.y", "vec3.z"].map(str::to_owned).to_vec(), 2)
        );
        let data = DumpData::Buffer { element: "uint", members: &[], element_bytes: 4, bytes: 5_u32.to_ne_bytes().to_vec() };
        assert_eq!(Rows::of(&data).unwrap().row(0), ["5"]);
    }
}
