//! JSON Schema (draft 2020-12) of the config, generated from the types. Checks, tables of keys and editors read it.

use super::Config;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

/// A config file: a config, and its base.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields)]
struct File {
    /// A config that this one changes: its path from the folder of this file, or a preset's name. A key here replaces the base's, a
    /// list its whole list.
    #[schemars(length(min = 1), extend("x-default" = "none"))]
    #[serde(default)]
    #[expect(dead_code)]
    base: Option<String>,
    #[serde(flatten)]
    #[expect(dead_code)]
    config: Config,
}

/// The schema of a config file. Beside the standard keywords it has `format`s for values of several numbers (`point`, `direction`,
/// `color`, `size`) and `x-default`, in words, for keys that may be absent.
pub fn schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
        let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
        let settings = settings.with_transform(RecursiveTransform(tidy));
        let mut schema = settings.into_generator().into_root_schema_for::<File>();
        schema.insert("title".to_owned(), json!("manylight config"));
        schema.to_value()
    });
    &SCHEMA
}

/// Turns a schema of Rust types into one of TOML values.
fn tidy(schema: &mut Schema) {
    let Some(schema) = schema.as_object_mut() else { return };
    drop_null(schema);
    match schema.get_mut("default") {
        Some(Value::Object(_) | Value::Null) => _ = schema.shift_remove("default"),
        Some(default) => shorten(default),
        None => {}
    }
    if let Some(Value::String(text)) = schema.get_mut("description") {
        *text = text.replace('\n', " ");
    }
    for light in schema.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten() {
        only_of_kind(light);
    }
}

/// Removes null, which TOML lacks: an optional key is absent instead.
fn drop_null(schema: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            schema["type"] = only.clone();
        }
    }
    if let Some(Value::Array(either)) = schema.get_mut("anyOf") {
        either.retain(|schema| schema["type"] != "null");
        if let [Value::Object(only)] = either.as_slice() {
            let only = only.clone();
            schema.shift_remove("anyOf");
            for (key, value) in only {
                schema.entry(key).or_insert(value);
            }
        }
    }
}

/// Shortens numbers, which have 32 bits, to the digits that they need.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(shorten),
        Value::Number(number) if number.is_f64() => {
            let short = number.as_f64().and_then(|number| (number as f32).to_string().parse::<f64>().ok());
            *value = json!(short);
        }
        _ => {}
    }
}

/// Removes keys of other kinds from the keyframes of a kind of light; `x-lights` lists the kinds that have a key.
fn only_of_kind(light: &mut Value) {
    let kind = light["properties"]["kind"]["const"].clone();
    if let Some(Value::Object(keys)) = light.pointer_mut("/properties/keyframes/items/properties") {
        keys.retain(|_, key| match key.as_object_mut().and_then(|key| key.shift_remove("x-lights")) {
            Some(Value::Array(kinds)) => kinds.contains(&kind),
            _ => true,
        });
    }
}
