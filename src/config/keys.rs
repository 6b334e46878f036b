//! Keys of a config with values, default and meaning, read from the schema of the types.

use super::schema::schema;
use serde_json::{Map, Value};
use std::sync::LazyLock;

/// A key or a section of the config, with all that a check, a table or a widget needs.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyInfo {
    /// As `--set` spells it, with `N` for the index of a table in a list: `light.N.position`.
    pub key: String,
    pub kind: Kind,
    /// Default as TOML, or in words if it depends on other keys; `None` if the key is required.
    pub default: Option<String>,
    /// Whether the table that holds the key must have it.
    pub required: bool,
    /// Kinds of light that have the key; empty for keys of other sections. A key that kinds of light declare differently is listed
    /// several times.
    pub lights: Vec<String>,
    /// Meaning of the key or of the section, in sentences.
    pub what: String,
}

/// A name that a key takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub name: String,
    /// Meaning of the name, in sentences.
    pub what: String,
}

/// Values of a key.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// A table of keys, which follow: a section.
    Table,
    /// A list of tables, whose keys follow.
    Tables,
    Text,
    /// One of these names.
    Choice(Vec<Choice>),
    /// A list of these names, each at most once.
    Choices(Vec<Choice>),
    IndexOrName,
    Flag,
    Whole {
        min: i64,
        max: i64,
    },
    /// One of a few whole numbers.
    OneOf(Vec<i64>),
    Number(Range),
    /// One of a few whole numbers, or two of them, width and height.
    Block(Vec<i64>),
    /// Width and height, whole numbers from 1.
    Size {
        max: i64,
    },
    /// Three coordinates, metres.
    Point(Range),
    /// Three numbers that are not all zero.
    Direction,
    /// Red, green, blue.
    Color(Range),
}

/// Numbers from `min` to `max`; `min` itself is excluded if `above`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    pub min: f32,
    pub max: f32,
    pub above: bool,
}

impl Range {
    pub const FINITE: Self = Self { min: -f32::MAX, max: f32::MAX, above: false };

    /// Whether a number is in the range.
    pub fn contains(self, value: f32) -> bool {
        value <= self.max && if self.above { value > self.min } else { value >= self.min }
    }

    /// The range in words: `over 0 to 90`.
    pub fn text(self) -> String {
        let over = if self.above { "over " } else { "" };
        match (self.min == -f32::MAX, self.max == f32::MAX) {
            (true, _) => "any finite number".to_owned(),
            (_, false) => format!("{over}{} to {}", number(self.min), number(self.max)),
            (_, true) if self.above => format!("over {}", number(self.min)),
            (_, true) => format!("{} and more", number(self.min)),
        }
    }

    fn of(schema: &Value) -> Self {
        let bound = |key: &str| schema[key].as_f64().map(|bound| bound as f32);
        let above = bound("exclusiveMinimum");
        Self {
            min: above.or(bound("minimum")).unwrap_or(Self::FINITE.min),
            max: bound("maximum").unwrap_or(Self::FINITE.max),
            above: above.is_some(),
        }
    }
}

fn numbers(values: &[i64]) -> String {
    values.iter().map(i64::to_string).collect::<Vec<_>>().join(", ")
}

fn number(value: f32) -> String {
    if value.abs() >= 1e6 { format!("{value:e}") } else { format!("{value}") }
}

impl Kind {
    /// Type of the values in words, as in `expects {}`.
    pub fn expects(&self) -> &'static str {
        match self {
            Kind::Table => "a table",
            Kind::Tables => "a list of tables",
            Kind::Text => "a string",
            Kind::Choice(_) => "a name",
            Kind::Choices(_) => "a list of names",
            Kind::IndexOrName => "an index or a name",
            Kind::Flag => "true or false",
            Kind::Whole { .. } | Kind::OneOf(_) => "a whole number",
            Kind::Number(_) => "a number",
            Kind::Block(_) => "a whole number, or [width, height]",
            Kind::Size { .. } => "[width, height], two whole numbers",
            Kind::Point(_) | Kind::Direction => "[x, y, z], three numbers",
            Kind::Color(_) => "[red, green, blue], three numbers",
        }
    }

    /// Range of the values in words.
    pub fn range(&self) -> String {
        match self {
            Kind::Table => "table".to_owned(),
            Kind::Tables => "list of tables".to_owned(),
            Kind::Text => "text".to_owned(),
            Kind::Choice(choices) | Kind::Choices(choices) => listed(choices.iter().map(|choice| &choice.name)),
            Kind::IndexOrName => "0 and more, or text".to_owned(),
            Kind::Flag => "true, false".to_owned(),
            Kind::Whole { min, max } => format!("{min} to {max}"),
            Kind::OneOf(values) => numbers(values),
            Kind::Block(values) => format!("{}, or two of them", numbers(values)),
            Kind::Size { max } => format!("1 to {max}"),
            Kind::Number(range) | Kind::Point(range) | Kind::Color(range) => range.text(),
            Kind::Direction => "not zero".to_owned(),
        }
    }

    /// Values that a schema describes.
    ///
    /// # Panics
    /// If the schema describes values that no `Kind` covers.
    fn of(schema: &Value) -> Self {
        let whole = |key: &str| schema[key].as_i64();
        let values = |schema: &Value| schema["enum"].as_array().map(|values| values.iter().filter_map(Value::as_i64).collect());
        match (schema["type"].as_str(), schema["format"].as_str()) {
            (Some("object"), _) => Kind::Table,
            (Some("array"), Some("size")) => Kind::Size { max: schema["items"]["maximum"].as_i64().unwrap_or(i64::MAX) },
            (Some("array"), Some("point")) => Kind::Point(Range::of(&schema["items"])),
            (Some("array"), Some("direction")) => Kind::Direction,
            (Some("array"), Some("color")) => Kind::Color(Range::of(&schema["items"])),
            (Some("array"), None) => match Choice::all(&schema["items"]) {
                Some(choices) => Kind::Choices(choices),
                None => Kind::Tables,
            },
            (Some("string"), _) => Kind::Text,
            (Some("boolean"), _) => Kind::Flag,
            (Some("integer"), _) => match values(schema) {
                Some(values) => Kind::OneOf(values),
                None => Kind::Whole { min: whole("minimum").unwrap_or(0), max: whole("maximum").unwrap_or(u32::MAX.into()) },
            },
            (Some("number"), _) => Kind::Number(Range::of(schema)),
            (None, Some("block")) => Kind::Block(values(&schema["anyOf"][0]).unwrap_or_default()),
            (None, _) if schema["anyOf"].is_array() => Kind::IndexOrName,
            _ => match Choice::all(schema) {
                Some(choices) => Kind::Choice(choices),
                None => panic!("a schema that no key takes: {schema}"),
            },
        }
    }
}

impl Choice {
    /// Names of an enum; `None` for any other schema.
    fn all(schema: &Value) -> Option<Vec<Self>> {
        schema["oneOf"]
            .as_array()?
            .iter()
            .map(|choice| Some(Self { name: choice["const"].as_str()?.to_owned(), what: what(choice) }))
            .collect()
    }
}

/// Names in quotes, with commas.
pub fn listed(names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    names.into_iter().map(|name| format!("\"{}\"", name.as_ref())).collect::<Vec<_>>().join(", ")
}

/// Every section and key, in the order of the sections; a section comes before its keys.
pub fn keys() -> &'static [KeyInfo] {
    static KEYS: LazyLock<Vec<KeyInfo>> = LazyLock::new(|| {
        let mut keys = Vec::new();
        walk(schema(), "", None, &mut keys);
        keys
    });
    &KEYS
}

/// Names that a key takes; empty if it takes other values.
pub fn choices(key: &str) -> impl Iterator<Item = &'static str> {
    let choices = keys().iter().find(|info| info.key == key).and_then(|info| match &info.kind {
        Kind::Choice(choices) | Kind::Choices(choices) => Some(choices),
        _ => None,
    });
    choices.into_iter().flatten().map(|choice| choice.name.as_str())
}

fn what(schema: &Value) -> String {
    schema["description"].as_str().unwrap_or_default().to_owned()
}

/// Adds the keys of a table; `light` is the kind of light whose table it is.
fn walk(table: &Value, path: &str, light: Option<&str>, keys: &mut Vec<KeyInfo>) {
    let none = Map::new();
    let properties = table["properties"].as_object().unwrap_or(&none);
    // The constant key that tells tables of several kinds apart is added by `several`.
    for (name, schema) in properties.iter().filter(|(_, schema)| schema["const"].is_null()) {
        let key = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        let required = table["required"].as_array().is_some_and(|names| names.iter().any(|known| known == name));
        let in_words = schema["x-default"].as_str().map(str::to_owned);
        let default = in_words.or_else(|| schema.get("default").map(toml_text));
        let info = KeyInfo { kind: Kind::of(schema), default, required, lights: Vec::new(), what: what(schema), key: key.clone() };
        match keys.iter_mut().find(|known| KeyInfo { lights: Vec::new(), ..(**known).clone() } == info) {
            Some(known) => known.lights.extend(light.map(str::to_owned)),
            None => keys.push(KeyInfo { lights: light.map(str::to_owned).into_iter().collect(), ..info }),
        }
        let items = format!("{key}.N");
        match (schema["type"].as_str(), schema["items"]["oneOf"].as_array()) {
            (Some("object"), _) => walk(schema, &key, light, keys),
            (Some("array"), Some(tables)) => several(&schema["items"], tables, &items, keys),
            (Some("array"), None) => walk(&schema["items"], &items, light, keys),
            _ => {}
        }
    }
}

/// Adds the keys of tables of several kinds, each known by its `kind`.
fn several(any: &Value, tables: &[Value], path: &str, keys: &mut Vec<KeyInfo>) {
    let kind = |table: &Value| table["properties"]["kind"]["const"].as_str().map(str::to_owned);
    let kinds: Vec<Choice> = tables.iter().filter_map(|table| Some(Choice { name: kind(table)?, what: what(table) })).collect();
    if kinds.is_empty() {
        return;
    }
    let lights = kinds.iter().map(|kind| kind.name.clone()).collect();
    keys.push(KeyInfo { key: format!("{path}.kind"), kind: Kind::Choice(kinds), default: None, required: true, lights, what: what(any) });
    tables.iter().for_each(|table| walk(table, path, kind(table).as_deref(), keys));
}

/// A value as a user would write it in TOML.
fn toml_text(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(toml_text).collect::<Vec<_>>().join(", ")),
        Value::Number(number) if number.is_f64() => format!("{:?}", number.as_f64().unwrap_or_default()),
        other => other.to_string(),
    }
}

/// All keys as Markdown, a heading and a table a section: `configs/README.md`.
pub fn markdown() -> String {
    const HEAD: &str = "| Key | Default | Takes | What it is |\n|---|---|---|---|\n";
    let mut page = String::from(HEAD);
    for info in keys() {
        let key = &info.key;
        match info.kind {
            Kind::Table => {
                page += &format!("\n### `[{key}]`\n\n{}\n\n{HEAD}", info.what);
                continue;
            }
            Kind::Tables if !key.contains('.') => page += &format!("\n### `[[{key}]]`\n\n{HEAD}"),
            _ => {}
        }
        let (takes, choices) = match &info.kind {
            Kind::Choice(choices) => ("one of these names".to_owned(), choices.as_slice()),
            Kind::Choices(choices) => ("some of these names".to_owned(), choices.as_slice()),
            other => (other.range(), &[][..]),
        };
        let default = match &info.default {
            Some(text) if *text == format!("[{}]", listed(choices.iter().map(|choice| &choice.name))) => "all of them".to_owned(),
            Some(text) if toml::de::DeValue::parse(text).is_ok() => format!("`{text}`"),
            Some(text) => text.clone(),
            None => "must be given".to_owned(),
        };
        let lights = if info.lights.is_empty() { String::new() } else { format!(" ({})", info.lights.join(", ")) };
        let names: String = choices.iter().map(|choice| format!("<br>`\"{}\"`: {}", choice.name, choice.what)).collect();
        page += &format!("| `{key}`{lights} | {default} | {takes} | {}{names} |\n", info.what);
    }
    page
}
