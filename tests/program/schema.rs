//! The JSON Schema for editors: it accepts what the program accepts, and finds mistakes within its reach.

use manylight::{config, presets};
use serde_json::{Value, json};

/// The first place where a value breaks a schema. Only our schema's keywords are known: a validator crate would add thirty
/// dependencies.
fn mistake(value: &Value, schema: &Value, at: &str) -> Option<String> {
    let number = value.as_f64();
    let items = value.as_array();
    let all = |list: &Value| list.as_array().unwrap().clone();
    let fits = |schema: &Value| mistake(value, schema, at).is_none();
    for (word, says) in schema.as_object().unwrap() {
        let is_right = match word.as_str() {
            "$schema" | "title" | "description" | "default" | "format" | "x-default" => true,
            "type" => match says.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "boolean" => value.is_boolean(),
                "integer" => value.is_i64(),
                "number" => value.is_number(),
                other => panic!("unknown type {other}"),
            },
            "properties" => {
                let inner = says.as_object().unwrap().iter().filter_map(|(key, schema)| Some((key, value.get(key)?, schema)));
                let found = inner.into_iter().find_map(|(key, value, schema)| mistake(value, schema, &format!("{at}.{key}")));
                if found.is_some() {
                    return found;
                }
                true
            }
            "additionalProperties" | "unevaluatedProperties" => {
                assert_eq!(says, false);
                value.as_object().is_none_or(|table| table.keys().all(|key| schema["properties"].get(key).is_some()))
            }
            "required" => all(says).iter().all(|key| value.get(key.as_str().unwrap()).is_some()),
            "items" => items.is_none_or(|items| items.iter().all(|item| mistake(item, says, at).is_none())),
            "minItems" => items.is_none_or(|items| items.len() as u64 >= says.as_u64().unwrap()),
            "maxItems" => items.is_none_or(|items| items.len() as u64 <= says.as_u64().unwrap()),
            "uniqueItems" => items.is_none_or(|items| (1..items.len()).all(|i| !items[..i].contains(&items[i]))),
            "contains" => items.is_none_or(|items| items.iter().any(|item| mistake(item, says, at).is_none())),
            "not" => !fits(says),
            "const" => value == says || number.is_some() && number == says.as_f64(),
            "enum" => all(says).contains(value),
            "oneOf" => all(says).iter().filter(|schema| fits(schema)).count() == 1,
            "anyOf" => all(says).iter().any(fits),
            "minLength" => value.as_str().is_none_or(|text| text.len() as u64 >= says.as_u64().unwrap()),
            "minimum" => number.is_none_or(|number| number >= says.as_f64().unwrap()),
            "exclusiveMinimum" => number.is_none_or(|number| number > says.as_f64().unwrap()),
            "maximum" => number.is_none_or(|number| number <= says.as_f64().unwrap()),
            other => panic!("a word that this test does not know: {other}"),
        };
        if !is_right {
            return Some(format!("{at}: {word}"));
        }
    }
    None
}

fn mistake_of(text: &str) -> Option<String> {
    let value: toml::Table = text.parse().unwrap_or_else(|error| panic!("{error}\n{text}"));
    mistake(&json!(value), config::schema(), "")
}

#[test]
fn every_config_that_comes_with_the_program_is_as_the_schema_has_it() {
    let full = include_str!("../fuzz/seeds/config/full.toml");
    for (name, text) in presets::all().into_iter().chain(presets::views()).chain([("full", full)]) {
        assert_eq!(mistake_of(text), None, "{name}");
    }
}

#[test]
fn the_schema_finds_what_is_no_rule_between_keys() {
    let spot = |more: &str| format!("[[light]]\nkind = \"spot\"\nposition = [0, 3, 0]\nintensity = [1, 1, 1]\n{more}");
    assert_eq!(mistake_of(&spot("direction = [0, -1, 0]")), None);
    let cases = [
        ("[gather]\ninterleve = 2", ".gather: additionalProperties"),
        ("[gahter]\ninterleave = 2", ": additionalProperties"),
        ("base = \"\"", ".base: minLength"),
        ("[gather]\ninterleave = 3", ".gather.interleave: anyOf"),
        ("[gather]\nmethod = \"splat\"", ".gather.method: oneOf"),
        ("[vpls]\ncount = 1.5", ".vpls.count: type"),
        ("[vpls]\ncount = 1048577", ".vpls.count: maximum"),
        ("[frame]\nsize = [0, 5]", ".frame.size: items"),
        ("[frame]\nsize = [1, 2, 3]", ".frame.size: maxItems"),
        ("[frame]\nfps = 0", ".frame.fps: exclusiveMinimum"),
        ("[camera]\nup = [0, 0, 0]", ".camera.up: contains"),
        ("[output]\nlayers = [\"depth\", \"depth\"]", ".output.layers: uniqueItems"),
        ("[rsm.box]\nmin = [0, 0, 0]", ".rsm.box: required"),
        ("[scene]\nscene = 1.5", ".scene.scene: anyOf"),
        (&spot("irradiance = [1, 1, 1]"), ".light: items"),
        (&spot("keyframes = [{ time = 0, irradiance = [1, 1, 1] }]"), ".light: items"),
        (&spot("outer_deg = 0.1"), ".light: items"),
    ];
    for (text, expected) in cases {
        assert_eq!(mistake_of(text).as_deref(), Some(expected), "{text}");
    }
}
