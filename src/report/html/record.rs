//! A run's record as collapsible text.

use super::files::Record;
use super::folders::Run;
use super::numbers;
use super::provenance::parts;
use crate::config::{self, Config};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A record in the form that the template takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordView {
    pub label: String,
    pub from: String,
    /// Counts and checks.
    pub facts: Vec<[String; 2]>,
    pub warnings: Vec<String>,
    /// The config as TOML, or as JSON if this version cannot parse it; empty if there is none.
    pub config: String,
}

impl RecordView {
    pub fn of(run: &Run) -> Self {
        let record = &run.record;
        let count = |(name, count): (&String, &u64)| {
            let text = if name.ends_with("bytes") { numbers::bytes(*count as f64) } else { count.to_string() };
            [name.clone(), text]
        };
        let check = |(name, check): (&String, &Value)| {
            let text = match check.as_f64() {
                Some(figure) => numbers::short(figure),
                None => check.to_string(),
            };
            [name.clone(), text]
        };
        Self {
            label: run.label.clone(),
            from: parts(&record.from).join("; "),
            facts: record.counts.iter().map(count).chain(record.checks.iter().map(check)).collect(),
            warnings: record.warnings.clone(),
            config: config_text(&record.config),
        }
    }
}

fn config_text(value: &Value) -> String {
    if value.is_null() {
        return String::new();
    }
    match Config::deserialize(value) {
        Ok(config) => config::to_toml(&config),
        Err(_) => serde_json::to_string_pretty(value).unwrap_or_default(),
    }
}

/// Samples, bounces and standard error of a reference.
pub fn reference_facts(record: &Record) -> String {
    let count = |name: &str, one: &str, many: &str| {
        record.counts.get(name).map(|count| format!("{count} {}", if *count == 1 { one } else { many }))
    };
    let error = record.checks.get("relative-standard-error").and_then(Value::as_f64);
    let facts = [
        count("reference/samples", "sample a pixel", "samples a pixel"),
        count("reference/bounces", "bounce", "bounces"),
        error.map(|error| format!("standard error {} % of the mean", numbers::short(error * 100.0))),
    ];
    facts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::samples::run;
    use serde_json::json;

    #[test]
    fn a_config_is_toml_and_one_of_another_version_json() {
        let config = serde_json::to_value(Config::default()).unwrap();
        let text = config_text(&config);
        assert!(text.contains("[gather]") && text.contains("min_distance = 0.3\n"), "{text}");
        let again = config::parse(&text, "c.toml".as_ref(), &[]).unwrap();
        assert_eq!((again.config, again.warnings), (Config::default(), Vec::new()));
        assert_eq!(config_text(&json!({ "from": "later" })), "{\n  \"from\": \"later\"\n}");
        assert_eq!(config_text(&Value::Null), "");
    }

    #[test]
    fn a_reference_says_how_good_it_is_as_far_as_it_is_known() {
        let mut record = run("r").record;
        record.counts.extend([("reference/samples".to_owned(), 1), ("reference/bounces".to_owned(), 3)]);
        record.checks.insert("relative-standard-error".to_owned(), Value::Null);
        assert_eq!(reference_facts(&record), "1 sample a pixel, 3 bounces");
        record.checks.insert("relative-standard-error".to_owned(), json!(0.0321));
        assert_eq!(reference_facts(&record), "1 sample a pixel, 3 bounces, standard error 3.21 % of the mean");
    }
}
