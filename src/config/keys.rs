//! Every key of a config in one list: what it takes, its range, its default and what it means. Loading checks values against
//! it, and the README's table is made from it; the defaults come from the types.

use super::{
    BounceVisibility, Bounds, Builtin, Centers, Collect, Config, Culling, Dielectric, Emitters, FilterKind, GatherMethod, Importance,
    Interpolation, IsmRenderer, Layer, Layers, Lookup, Pattern, PointSet, Rasterization, Receiver, Reflection, Representative,
    RouletteChoice, Shadows, Shares, SsaoMethod, SsaoResolution, TimingMode, Tonemap, VisibilityMethod, VplSampler,
};
use serde::Deserialize;
use serde::de::{self, Visitor};
use std::sync::LazyLock;

/// A key, as `--set` spells it with `N` for the index of a table in a list.
#[derive(Debug, Clone)]
pub struct KeyInfo {
    pub key: &'static str,
    pub kind: Kind,
    /// As TOML, or in words where the key may be absent; `None` where it must be given.
    pub default: Option<String>,
    /// The kinds of light that have it; empty for keys of other sections.
    pub lights: &'static [&'static str],
    pub what: &'static str,
}

/// What a key takes.
#[derive(Debug, Clone)]
pub enum Kind {
    Text,
    /// A name, one of these.
    Choice(&'static [&'static str]),
    /// A list of names, each at most once.
    Choices(&'static [&'static str]),
    IndexOrName,
    Flag,
    Whole {
        min: i64,
        max: i64,
    },
    /// One of a few whole numbers.
    OneOf(&'static [i64]),
    Number(Range),
    /// Two whole numbers from 1.
    Size {
        max: i64,
    },
    /// Three coordinates, metres.
    Point,
    /// Three numbers that are not all zero.
    Direction,
    /// Three numbers of 0 and more: red, green, blue.
    Color,
    /// A list of tables, whose keys follow.
    Tables,
}

/// Numbers from `min` to `max`; `min` itself is out where `above` is set.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    pub min: f32,
    pub max: f32,
    pub above: bool,
}

/// Coordinates farther out have lost all precision.
pub const FARTHEST: Range = Range { min: -1e7, max: 1e7, above: false };
/// Far over the sun's radiance, far under what overflows.
pub const BRIGHTEST: Range = Range { min: 0.0, max: 1e9, above: false };
pub const FINITE: Range = Range { min: -f32::MAX, max: f32::MAX, above: false };

impl Range {
    pub fn contains(self, value: f32) -> bool {
        value <= self.max && if self.above { value > self.min } else { value >= self.min }
    }

    pub fn text(self) -> String {
        let over = if self.above { "over " } else { "" };
        match (self.min == -f32::MAX, self.max == f32::MAX) {
            (true, _) => "any finite number".to_owned(),
            (_, false) => format!("{over}{} to {}", number(self.min), number(self.max)),
            (_, true) if self.above => format!("over {}", number(self.min)),
            (_, true) => format!("{} and more", number(self.min)),
        }
    }
}

fn number(value: f32) -> String {
    if value.abs() >= 1e6 { format!("{value:e}") } else { format!("{value}") }
}

impl Kind {
    /// What it takes, in words: `expects {}`.
    pub fn expects(&self) -> &'static str {
        match self {
            Kind::Text => "a string",
            Kind::Choice(_) => "a name",
            Kind::Choices(_) => "a list of names",
            Kind::IndexOrName => "an index or a name",
            Kind::Flag => "true or false",
            Kind::Whole { .. } | Kind::OneOf(_) => "a whole number",
            Kind::Number(_) => "a number",
            Kind::Size { .. } => "[width, height], two whole numbers",
            Kind::Point => "[x, y, z], three numbers",
            Kind::Direction => "[x, y, z], three numbers",
            Kind::Color => "[red, green, blue], three numbers",
            Kind::Tables => "a list of tables",
        }
    }

    /// Which values it takes, in words.
    pub fn range(&self) -> String {
        match self {
            Kind::Text => "text".to_owned(),
            Kind::Choice(names) | Kind::Choices(names) => listed(names),
            Kind::IndexOrName => "0 and more, or text".to_owned(),
            Kind::Flag => "true, false".to_owned(),
            Kind::Whole { min, max } => format!("{min} to {max}"),
            Kind::OneOf(values) => values.iter().map(i64::to_string).collect::<Vec<_>>().join(", "),
            Kind::Number(range) => range.text(),
            Kind::Size { max } => format!("1 to {max}"),
            Kind::Point => FARTHEST.text(),
            Kind::Direction => "not zero".to_owned(),
            Kind::Color => BRIGHTEST.text(),
            Kind::Tables => "list of tables".to_owned(),
        }
    }
}

/// Names in quotes, with commas.
pub fn listed(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

/// Every key, in the order of the sections.
pub fn keys() -> &'static [KeyInfo] {
    static KEYS: LazyLock<Vec<KeyInfo>> = LazyLock::new(list);
    &KEYS
}

/// The keys as a Markdown table, for the README.
pub fn markdown_table() -> String {
    let mut table = String::from("| Key | Default | Takes | What it is |\n|---|---|---|---|\n");
    for key in keys() {
        let default = match (&key.default, &key.kind) {
            (Some(text), Kind::Choices(names)) if *text == format!("[{}]", listed(names)) => "all of them".to_owned(),
            (Some(text), _) if toml::de::DeValue::parse(text).is_ok() => format!("`{text}`"),
            (Some(text), _) => text.clone(),
            (None, _) => "must be given".to_owned(),
        };
        let lights = if key.lights.is_empty() { String::new() } else { format!(" ({})", key.lights.join(", ")) };
        table += &format!("| `{}`{lights} | {default} | {} | {} |\n", key.key, key.kind.range(), key.what);
    }
    table
}

pub const LIGHT_KINDS: &[&str] = &["directional", "spot", "point", "environment"];
const U32: Kind = Kind::Whole { min: 0, max: u32::MAX as i64 };

fn list() -> Vec<KeyInfo> {
    use Kind::*;
    let above = |min, max| Number(Range { min, max, above: true });
    let from = |min, max| Number(Range { min, max, above: false });
    let frames = |min| Whole { min, max: 1_000_000 };
    let fov = || from(1.0, 170.0);
    let key = |key, kind, what| KeyInfo { key, kind, default: None, lights: &[], what };
    let absent = |name, kind, default: &str, what| KeyInfo { default: Some(default.to_owned()), ..key(name, kind, what) };
    let light = |name, kind, lights, what| KeyInfo { lights, ..key(name, kind, what) };
    let light_or =
        |name, kind, default: &str, lights, what| KeyInfo { default: Some(default.to_owned()), ..light(name, kind, lights, what) };
    let placed = &["directional", "spot", "point"];
    let aimed = &["directional", "spot"];
    let bulbs = &["spot", "point"];

    let mut keys = vec![
        absent(
            "base",
            Text,
            "none",
            "A config that this one changes, relative to this file: a key here replaces the base's, a list its whole list",
        ),
        absent("scene.file", Text, "none", "A .glb or .gltf file, relative to this file; instead of `scene.builtin`"),
        absent("scene.scene", IndexOrName, "the file's default", "Which of the file's scenes"),
        absent("scene.animation", IndexOrName, "the file's first", "Which of the file's animations moves it, in a loop; `none` for none"),
        key("scene.builtin", Choice(choices::<Builtin>()), "A scene made by code"),
        key(
            "scene.triangles",
            Whole { min: 8_000, max: 8_000_000 },
            "About how many triangles the atrium has, from 10,000 on; just how many the caustics",
        ),
        absent(
            "scene.roughness",
            from(0.001, 1.0),
            "0.05 of the caustics",
            "GGX's alpha of the caustics' metal: a glTF material's roughness is its root",
        ),
        key("scene.seed", U32, "Seed of what is random in the atrium"),
        absent(
            "scene.split",
            from(0.001, 1.0),
            "none",
            "Triangles are split until no edge is longer than this part of the scene's diagonal: maps of clusters bend long ones",
        ),
        absent(
            "camera.position",
            Point,
            "the scene's first camera, else a view of all of it",
            "Where the camera stands, metres; with `target`",
        ),
        absent("camera.target", Point, "as `position`", "A point straight ahead, metres"),
        absent("camera.up", Direction, "[0, 1, 0]", "Which way is up in the picture"),
        absent("camera.fov_y_deg", fov(), "that of the scene's camera, else 60", "Vertical field of view, degrees"),
        absent("camera.node", Text, "none", "A camera of the glTF file by name; instead of `position` and `target`"),
        absent("camera.interpolation", Choice(choices::<Interpolation>()), "\"linear\"", "How the path runs between keyframes"),
        absent("camera.keyframes", Tables, "none", "A path; instead of `position` and `target`"),
        key("camera.keyframes.N.time", Number(FINITE), "Seconds, rising; frame i is at i / `frame.fps`"),
        key("camera.keyframes.N.position", Point, "Metres"),
        key("camera.keyframes.N.target", Point, "Metres"),
        absent("camera.keyframes.N.fov_y_deg", fov(), "`camera.fov_y_deg`", "Degrees; runs between the keyframes that give it"),
        absent("light", Tables, "the scene's own lights", "One `[[light]]` table a light; they replace the scene's own"),
        light("light.N.kind", Choice(LIGHT_KINDS), LIGHT_KINDS, "What it is"),
        light("light.N.position", Point, bulbs, "Metres; a directional light may have it, with `target`"),
        light_or("light.N.direction", Direction, "this or `target`", aimed, "The way the light travels"),
        light_or("light.N.target", Point, "this or `direction`", aimed, "A point that the light is aimed at, metres"),
        light("light.N.irradiance", Color, &["directional"], "On a plane that faces the light, W/m^2"),
        light("light.N.intensity", Color, bulbs, "Radiant intensity on the axis, W/sr"),
        light_or("light.N.inner_deg", from(0.0, 80.0), "3/4 of `outer_deg`", &["spot"], "Half-angle of full intensity, degrees"),
        light_or("light.N.outer_deg", above(0.1, 80.0), "40.0", &["spot"], "Half-angle where the light ends, degrees"),
        light("light.N.radiance", Color, &["environment"], "From everywhere, W/(m^2 sr)"),
        light_or(
            "light.N.keyframes",
            Tables,
            "none",
            placed,
            "The light over time; a value runs linearly between the keyframes that give it",
        ),
        light("light.N.keyframes.N.time", Number(FINITE), placed, "Seconds, rising"),
        light_or("light.N.keyframes.N.position", Point, "`position`", placed, "Metres"),
        light_or("light.N.keyframes.N.direction", Direction, "`direction`", aimed, "If the light is aimed by `direction`"),
        light_or("light.N.keyframes.N.target", Point, "`target`", aimed, "If the light is aimed by `target`, metres"),
        light_or("light.N.keyframes.N.intensity", Color, "`intensity`", bulbs, "W/sr"),
        light_or("light.N.keyframes.N.irradiance", Color, "`irradiance`", &["directional"], "W/m^2"),
        key("frame.size", Size { max: 16_384 }, "Width and height of the picture, pixels"),
        key("frame.count", frames(1), "Frames that are measured; the last one is the picture"),
        key("frame.warmup", frames(0), "Frames before them that are not measured"),
        key("frame.fps", above(0.0, f32::MAX), "Frames a second of animation time"),
        key("frame.seed", U32, "Seed of what is random: a reference's paths, and which points go into which imperfect shadow map"),
        key("frame.timing", Choice(choices::<TimingMode>()), "A barrier around each pass; none but the needed; or one submit a pass"),
        key("materials.dielectric", Choice(choices::<Dielectric>()), "How non-metals reflect"),
        key("rsm.size", Size { max: 8192 }, "Width and height of a light's reflective shadow map, texels"),
        absent("rsm.box.min", Point, "the scene's bounds", "Lower corner of the box that directional lights' maps cover, metres"),
        absent("rsm.box.max", Point, "the scene's bounds", "Upper corner of that box"),
        key("vpls.sampler", Choice(choices::<VplSampler>()), "How texels are chosen to be virtual point lights"),
        key("vpls.count", Whole { min: 1, max: 1_048_576 }, "Virtual point lights in all; `\"every-texel\"` has its own number"),
        key(
            "vpls.importance",
            Choice(choices::<Importance>()),
            "Where texels are likelier to be chosen, by `\"hammersley\"`: nowhere, or where light stays in the scene",
        ),
        key(
            "vpls.reflection",
            Choice(choices::<Reflection>()),
            "Which reflection makes virtual point lights; glossy ones need stochastic culling",
        ),
        key("bounce.count", Whole { min: 1, max: 8 }, "Bounces of indirect light; one is that of the lights above alone"),
        key("bounce.clusters", Whole { min: 1, max: 64 }, "Clusters of a bounce's virtual point lights, each with a map of what it sees"),
        key("bounce.representative", Choice(choices::<Representative>()), "Where a cluster's map is rendered from"),
        key("bounce.centers", Choice(choices::<Centers>()), "Where a frame's clusters start: from the last frame's, or anew"),
        key("bounce.rounds", Whole { min: 1, max: 64 }, "Rounds of k-means a frame; the first frame has as many as it takes"),
        key("bounce.position_weight", from(0.0, 1000.0), "What distance counts for between clusters, in scene's diagonals"),
        key("bounce.normal_weight", from(0.0, 1000.0), "What the angle between normals counts for"),
        key("bounce.map_size", OneOf(&[64, 128, 256, 512, 1024]), "Side of a cluster's map, texels"),
        key("bounce.layers", Choice(choices::<Layers>()), "How the maps of all clusters are filled"),
        key("bounce.pattern", Choice(choices::<Pattern>()), "Where samples lie in a map: over its disk, or over the square around it"),
        key(
            "bounce.shares",
            Choice(choices::<Shares>()),
            "How many of the lights below a cluster gets: as many as any, or by the flux that it passes on",
        ),
        key("bounce.vpls", Whole { min: 1, max: 65_536 }, "Virtual point lights of each bounce after the first, in all"),
        key("bounce.visibility", Choice(choices::<BounceVisibility>()), "How their shadows are found"),
        key("visibility.method", Choice(choices::<VisibilityMethod>()), "How a virtual point light's shadows are found"),
        key(
            "visibility.shared_maps",
            Whole { min: 1, max: 65_536 },
            "Imperfect shadow maps that `\"every-texel\"`'s lights share, at most: neighbours see much the same",
        ),
        key("visibility.renderer", Choice(choices::<IsmRenderer>()), "How points get into imperfect shadow maps"),
        key("visibility.collect", Choice(choices::<Collect>()), "How points are made from triangles"),
        key("visibility.points", Choice(choices::<PointSet>()), "Which points a map gets: any, or by the solid angle that its light sees"),
        key("visibility.point_count", Whole { min: 1, max: 1 << 26 }, "About how many points stand for the scene"),
        key("visibility.thin", Flag, "Leaves small triangles out by lot, so that points stand for equal areas"),
        absent("visibility.capacity", Whole { min: 1, max: 1 << 20 }, "from the others", "Points that a map's partition holds"),
        key("visibility.map_size", OneOf(&[16, 32, 64, 128, 256]), "Side of an imperfect shadow map, texels"),
        absent("visibility.considered", Whole { min: 1, max: 32 }, "16, 1 for splats", "Maps that a point is considered for"),
        absent("visibility.collected", Whole { min: 1, max: 16 }, "4, 1 for splats", "Maps that it is drawn into, at most"),
        key("visibility.distortion", Flag, "Points are as large as the paraboloid projection makes them"),
        key("visibility.clamp", Flag, "Points, and what is made of them, stay in their own map"),
        absent(
            "visibility.enlarge",
            above(0.0, 16.0),
            "1, 1.1 if adaptive, 1.25 with normals, 0.9 for splats",
            "Multiplies the points' radius",
        ),
        key("visibility.normals", Flag, "A point's normal limits its size"),
        key("visibility.lookup", Choice(choices::<Lookup>()), "Receivers are compared with one texel of a map, or with the four around"),
        key("visibility.bias", from(0.0, 64.0), "How far behind a map's surface is still lit, in units of what the map resolves there"),
        key("gather.method", Choice(choices::<GatherMethod>()), "How the lights are summed at the pixels"),
        key("gather.interleave", OneOf(&[1, 2, 4, 8]), "Side of the block of pixels that share out the lights"),
        key(
            "gather.culling",
            Choice(choices::<Culling>()),
            "How lights that cannot shine on pixels are left out; all but the stochastic ones leave the picture as it is",
        ),
        key(
            "gather.bounds",
            Choice(choices::<Bounds>()),
            "What stochastic culling bounds a glossy light's range by; with none every tile lists every light",
        ),
        key(
            "gather.rasterization",
            Choice(choices::<Rasterization>()),
            "How conservative clusters' bounds find the tiles that they touch: automatic is by the extension where the device has it",
        ),
        key("gather.nodes", Whole { min: 1, max: 1 << 24 }, "Nodes that conservative clusters' light lists have room for, 8 bytes each"),
        key("gather.delta", above(0.0, 1e6), "Irradiance facing a light, W/m^2, below which stochastic culling leaves it to chance"),
        key(
            "gather.roulette",
            Choice(choices::<RouletteChoice>()),
            "The random numbers for that: the same in every frame, new ones, or none: then that light is lost",
        ),
        key(
            "gather.statistics",
            Flag,
            "Counts the lights that stochastic culling lists and lights a pixel, and pictures them: `--dump gather/statistics`",
        ),
        key(
            "gather.receiver",
            Choice(choices::<Receiver>()),
            "What the camera sees reflects indirect light by its diffuse part, or by GGX too: with `\"stochastic-tiled\"`",
        ),
        key("gather.emitters", Choice(choices::<Emitters>()), "What virtual point lights shine as on what is near them"),
        key("gather.min_distance", from(0.0, 1e6), "Below this distance a light gets no brighter, metres; 0 turns it off"),
        key("filter.kind", Choice(choices::<FilterKind>()), "How the indirect light is smoothed"),
        absent("filter.radius", Whole { min: 1, max: 32 }, "from `gather.interleave`", "Where a neighbour's weight reaches 0, pixels away"),
        key(
            "filter.normal_threshold_deg",
            above(0.0, 90.0),
            "Normals farther apart are not mixed, degrees; a cross bilateral filter mixes them by e^-2 there, and less beyond",
        ),
        key(
            "filter.plane_distance",
            above(0.0, 1e6),
            "Points farther off the pixel's plane are not mixed, in units of view depth; a cross bilateral filter as above",
        ),
        key("direct.shadows", Choice(choices::<Shadows>()), "Shadows of the direct light"),
        key(
            "direct.bias",
            from(0.0, 1e6),
            "How far points are lifted off their surface for the shadow test, beside a texel's width on slopes, metres",
        ),
        key("direct.blur", Whole { min: 0, max: 8 }, "Filter radius of the shadow map, texels"),
        key("ssao.method", Choice(choices::<SsaoMethod>()), "Screen-space ambient occlusion of the indirect light"),
        key("ssao.radius", above(0.0, 1000.0), "How far occluders are looked for, metres"),
        key("ssao.samples", Whole { min: 1, max: 32 }, "Looks at the depth to each of both sides"),
        key("ssao.resolution", Choice(choices::<SsaoResolution>()), "Of all pixels, or of every second in every second row"),
        key("ssao.strength", from(0.0, 1.0), "How much of it is applied"),
        key("compose.exposure", above(0.0, 1e9), "Multiplies the radiance; only in the picture, never in the EXR"),
        key(
            "compose.background",
            Color,
            "Shown where there is no surface, beside an environment; it lights nothing and is in the picture alone",
        ),
        key("compose.tonemap", Choice(choices::<Tonemap>()), "From radiance to [0, 1]; \"none\" clamps"),
        key("output.layers", Choices(choices::<Layer>()), "Layers of the EXR beside the final radiance"),
    ];
    let defaults = match toml::Value::try_from(Config::default()) {
        Ok(value) => value,
        Err(error) => unreachable!("the default config is plain data: {error}"),
    };
    for key in &mut keys {
        if let Some(value) = key.key.split('.').try_fold(&defaults, |value, part| value.get(part)) {
            key.default = Some(toml_text(value));
        }
    }
    keys
}

/// A value as a user would write it: floats came from 32 bits and need no more digits.
fn toml_text(value: &toml::Value) -> String {
    match value {
        toml::Value::Float(value) => format!("{:?}", *value as f32),
        toml::Value::Array(items) => format!("[{}]", items.iter().map(toml_text).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

/// The names of an enum without data, as serde knows them: a deserializer that only listens to what is asked of it.
pub fn choices<'de, T: Deserialize<'de>>() -> &'static [&'static str] {
    struct Listen<'n>(&'n mut &'static [&'static str]);
    impl<'de> de::Deserializer<'de> for Listen<'_> {
        type Error = de::value::Error;
        fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
            Err(de::Error::custom("not an enum"))
        }
        fn deserialize_enum<V: Visitor<'de>>(self, _: &'static str, names: &'static [&'static str], _: V) -> Result<V::Value, Self::Error> {
            *self.0 = names;
            Err(de::Error::custom("heard enough"))
        }
        serde::forward_to_deserialize_any! {
            bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
            newtype_struct seq tuple tuple_struct map struct identifier ignored_any
        }
    }
    let mut names: &'static [&'static str] = &[];
    let _ = T::deserialize(Listen(&mut names));
    names
}
