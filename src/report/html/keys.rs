//! Config keys in which runs differ.

use super::folders::Run;
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Most keys shown; further ones are found in the configs.
const MOST: usize = 5;

/// The first differing keys, and each run's values of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Keys {
    pub names: Vec<String>,
    /// A list for each run; empty text if the run lacks the key.
    pub values: Vec<Vec<String>>,
    /// Number of differing keys beyond `names`.
    pub more: usize,
}

/// The keys in which these runs differ.
pub fn differing(runs: &[Run]) -> Keys {
    let configs: Vec<BTreeMap<String, String>> = runs
        .iter()
        .map(|run| {
            let mut keys = BTreeMap::new();
            flatten("", &run.record.config, &mut keys);
            keys
        })
        .collect();
    let all: BTreeSet<&String> = configs.iter().flat_map(BTreeMap::keys).collect();
    let differs = |key: &&&String| configs.iter().any(|config| config.get(**key) != configs[0].get(**key));
    let differing: Vec<&String> = all.iter().filter(differs).copied().collect();
    let names: Vec<String> = differing.iter().take(MOST).map(|key| (*key).clone()).collect();
    let value = |config: &BTreeMap<String, String>, key: &String| config.get(key).cloned().unwrap_or_default();
    let values = configs.iter().map(|config| names.iter().map(|key| value(config, key)).collect()).collect();
    Keys { more: differing.len() - names.len(), names, values }
}

/// Flattens tables to dotted keys; lists are values.
fn flatten(prefix: &str, value: &Value, keys: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(table) => table.iter().for_each(|(key, value)| {
            let key = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
            flatten(&key, value, keys);
        }),
        Value::Null => {}
        value => {
            keys.insert(prefix.to_owned(), text(value));
        }
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // Configs hold 32-bit numbers, whose 64-bit form has digits that nobody wrote.
        Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(number) => (number as f32).to_string(),
            None => number.to_string(),
        },
        Value::Array(list) => format!("[{}]", list.iter().map(text).collect::<Vec<_>>().join(", ")),
        value => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::samples::run;
    use serde_json::json;

    #[test]
    fn what_differs_is_a_column_and_what_does_not_is_not() {
        let mut runs = [run("a"), run("b")];
        runs[0].record.config["filter"] = json!({ "radius": 0.1_f32, "kind": "none" });
        runs[1].record.config["filter"] = json!({ "kind": "none", "box": [1, 0.5] });
        let keys = differing(&runs);
        assert_eq!(keys.names, ["filter.box", "filter.radius"]);
        assert_eq!(keys.values, [["", "0.1"], ["[1, 0.5]", ""]]);
        assert_eq!(differing(&runs[..1]), Keys { names: vec![], values: vec![vec![]], more: 0 });
        assert_eq!(differing(&[]), Keys { names: vec![], values: vec![], more: 0 });
    }

    #[test]
    fn runs_that_have_little_in_common_leave_the_rest_to_their_configs() {
        let mut runs = [run("a"), run("b")];
        runs[0].record.config = (0..9).map(|i| (format!("key{i}"), json!(i))).collect();
        let keys = differing(&runs);
        assert_eq!(keys.names.len(), MOST);
        assert!(keys.more >= 4);
    }
}
