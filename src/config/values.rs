//! Meaning and range of values of several numbers: a field with `#[schemars(with = "Point")]` stays an array.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// Three coordinates, metres, -1e7 to 1e7: farther out 32 bits have lost all precision.
pub struct Point;

/// Three numbers that are not all zero; need not be normalized.
pub struct Direction;

/// Red, green and blue, up to far over the sun's radiance and far under overflow.
pub struct Color;

/// Width and height, each from 1 to `MAX`.
pub struct Size<const MAX: u32>;

/// A block of pixels: its width and height, each 1, 2, 4 or 8. A square one is written as its side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "SideOrSides", into = "SideOrSides")]
pub struct Block(pub [u32; 2]);

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum SideOrSides {
    Side(u32),
    Sides([u32; 2]),
}

impl From<SideOrSides> for Block {
    fn from(sides: SideOrSides) -> Self {
        match sides {
            SideOrSides::Side(side) => side.into(),
            SideOrSides::Sides(sides) => Self(sides),
        }
    }
}

impl From<Block> for SideOrSides {
    fn from(Block([across, down]): Block) -> Self {
        if across == down { Self::Side(across) } else { Self::Sides([across, down]) }
    }
}

impl From<u32> for Block {
    fn from(side: u32) -> Self {
        Self([side; 2])
    }
}

impl fmt::Display for Block {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            [across, down] if across == down => write!(f, "{across}"),
            [across, down] => write!(f, "[{across}, {down}]"),
        }
    }
}

macro_rules! value {
    ([$($generic:tt)*] $type:ty, $format:literal, $schema:tt) => {
        impl $($generic)* JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                $format.into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    };
}

value!([] Point, "point", {
    "type": "array", "format": "point", "items": { "type": "number", "minimum": -1e7, "maximum": 1e7 }, "minItems": 3, "maxItems": 3
});
value!([] Direction, "direction", {
    "type": "array", "format": "direction", "items": { "type": "number" }, "contains": { "not": { "const": 0.0 } }, "minItems": 3, "maxItems": 3
});
value!([] Color, "color", {
    "type": "array", "format": "color", "items": { "type": "number", "minimum": 0.0, "maximum": 1e9 }, "minItems": 3, "maxItems": 3
});
value!([<const MAX: u32>] Size<MAX>, "size", {
    "type": "array", "format": "size", "items": { "type": "integer", "minimum": 1, "maximum": MAX }, "minItems": 2, "maxItems": 2
});
value!([] Block, "block", {
    "format": "block", "anyOf": [
        { "type": "integer", "enum": [1, 2, 4, 8] },
        { "type": "array", "items": { "type": "integer", "enum": [1, 2, 4, 8] }, "minItems": 2, "maxItems": 2 }
    ]
});
