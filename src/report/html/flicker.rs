//! `flicker.json`: changes of a picture from frame to frame.

use super::files::{Record, json};
use crate::report::Provenance;
use anyhow::Result;
use serde_json::Value;
use std::path::Path;

/// The changes over a run's frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Flicker {
    pub label: String,
    /// Provenance of the run, if one of the files has it.
    pub from: Option<Provenance>,
    /// Root mean square over the whole camera path.
    pub walk: Option<f64>,
    /// Each frame, and the root mean square of the change to it.
    pub pairs: Vec<(f64, f64)>,
}

impl Flicker {
    /// Reads the known keys of the file, which may have others; `None` if there is no file.
    ///
    /// # Errors
    /// `BadInput` if the file is no JSON.
    pub fn read(path: &Path, label: &str, record: Option<&Record>) -> Result<Option<Self>> {
        let Some(file): Option<Value> = json(path)? else { return Ok(None) };
        let number = |value: &Value, key: &str| value.get(key).and_then(Value::as_f64);
        let pairs = file.get("pairs").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
        let pairs =
            pairs.iter().enumerate().filter_map(|(i, pair)| Some((number(pair, "frame").unwrap_or(i as f64), number(pair, "rms")?)));
        let from = serde_json::from_value(file.clone()).ok().or_else(|| record.map(|record| record.from.clone()));
        Ok(Some(Self {
            label: label.to_owned(),
            from,
            walk: file.get("walk").and_then(|walk| number(walk, "rms")),
            pairs: pairs.collect(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_passed_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flicker.json");
        assert_eq!(Flicker::read(&path, "f", None).unwrap(), None);
        let cases = [
            (
                r#"{"walk": {"rms": 0.5, "more": []}, "pairs": [{"frame": 3, "rms": 0.25}, {"frame": 4}, {"rms": 1}]}"#,
                Some(0.5),
                vec![(3.0, 0.25), (2.0, 1.0)],
            ),
            (r#"{"pairs": 3}"#, None, vec![]),
            ("[]", None, vec![]),
        ];
        for (text, walk, pairs) in cases {
            std::fs::write(&path, text).unwrap();
            let flicker = Flicker::read(&path, "f", None).unwrap().unwrap();
            assert_eq!((flicker.walk, flicker.pairs, flicker.from), (walk, pairs, None), "{text}");
        }
        std::fs::write(&path, "{").unwrap();
        assert!(Flicker::read(&path, "f", None).unwrap_err().to_string().contains("flicker.json: is not what a report can read ("));
    }
}
