//! Meaning and range of values of several numbers: a field with `#[schemars(with = "Point")]` stays an array.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use std::borrow::Cow;

/// Three coordinates, metres, -1e7 to 1e7: farther out 32 bits have lost all precision.
pub struct Point;

/// Three numbers that are not all zero; need not be normalized.
pub struct Direction;

/// Red, green and blue, up to far over the sun's radiance and far under overflow.
pub struct Color;

/// Width and height, each from 1 to `MAX`.
pub struct Size<const MAX: u32>;

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
