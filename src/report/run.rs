//! `run.json`: the record of a run with its config, device, times and checks.

use super::{Memory, PassTime, Provenance, Timings, peak_memory_bytes};
use crate::config::Config;
use crate::files::write_file;
use anyhow::{Context, Result};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Content of `run.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// Version, preset, device, timing mode and resolution.
    #[serde(flatten)]
    pub from: Provenance,
    /// Hash of all shaders' sources ([`crate::graph::Library::key_of_all`]). Figures with different hashes must not be
    /// combined.
    pub shaders: String,
    pub seed: u64,
    /// Number of timed frames.
    pub frames: u32,
    /// Number of untimed frames before them.
    pub warmup: u32,
    /// Choices that the config left to the program, by key, as made on this device: `gather.conservative_clusters.rasterization`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub choices: BTreeMap<&'static str, Value>,
    pub timings: Timings,
    /// Counts of passes in the last frame: triangles drawn, VPLs, look-ups.
    pub counts: BTreeMap<String, u64>,
    /// Figures derived from the counts: means per pixel, and shares.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub means: BTreeMap<String, f64>,
    /// Bytes of the last frame's own resources, each and by stage.
    pub memory: Memory,
    /// Checks and their results by name (`{"check-nan": {"gather/per-pixel": 0}}`).
    pub checks: BTreeMap<String, Value>,
    /// All printed warnings.
    pub warnings: Vec<String>,
    /// Peak memory of the process, bytes; `None` if the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// The resolved config, which renders the same again.
    pub config: Value,
}

impl RunReport {
    /// The record's fields that follow from the config, the times of passes and the memory of the last frame. The others are
    /// empty, for the caller to fill.
    pub fn of(from: &Provenance, shaders: String, config: &Config, times: &[PassTime], memory: &[(String, u64)]) -> Result<Self> {
        Ok(Self {
            from: from.clone(),
            shaders,
            seed: u64::from(config.frame.seed),
            frames: 0,
            warmup: 0,
            choices: BTreeMap::new(),
            timings: Timings::of(times),
            counts: BTreeMap::new(),
            means: BTreeMap::new(),
            memory: Memory::of(memory),
            checks: BTreeMap::new(),
            warnings: Vec::new(),
            peak_memory_bytes: peak_memory_bytes(),
            config: resolved(config)?,
        })
    }

    /// Writes the report as JSON.
    ///
    /// # Errors
    /// `OutputNotWritten` with the path and the reason; no file is left then.
    pub fn write(&self, path: &Path) -> Result<()> {
        write_file(path, self.json()?.as_bytes())
    }

    /// The report as indented JSON, keys in a fixed order.
    pub fn json(&self) -> Result<String> {
        let json = serde_json::to_string_pretty(self).context("run.json cannot be put together")?;
        Ok(json + "\n")
    }
}

/// A config with all keys, which renders the same again.
pub fn resolved(config: &Config) -> Result<Value> {
    serde_json::to_value(config).context("the config cannot be written as JSON")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::{provenance, times};
    use serde_json::json;

    #[test]
    fn the_report_says_what_ran_where_and_how_long_it_took() {
        let report = RunReport {
            from: provenance(),
            shaders: "0123".to_owned(),
            seed: 7,
            frames: 2,
            warmup: 2,
            choices: [("gather.conservative_clusters.rasterization", json!("geometry-shader"))].into(),
            timings: Timings::of(&times(&[(0, "gbuffer/draw", 1.0), (1, "gbuffer/draw", 2.0)])),
            counts: [("gather/vpls".to_owned(), 1024)].into(),
            means: [("gather/glossy-listed".to_owned(), 2.5)].into(),
            memory: Memory::of(&[("rsm/depth".to_owned(), 16), ("rsm/flux".to_owned(), 64)]),
            checks: [("check-nan".to_owned(), json!({ "gather/per-pixel": 0 }))].into(),
            warnings: vec!["unused extension".into()],
            peak_memory_bytes: Some(1 << 30),
            config: json!({ "frame": { "size": [960, 540] } }),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.json");
        report.write(&path).unwrap();
        let read: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let statistics = json!({ "median": 1.5, "p5": 1.05, "p95": 1.95, "n": 2 });
        let row = json!({ "median": 1.5, "p5": 1.05, "p95": 1.95, "n": 2, "share": 1.0 });
        let named = |name: &str| {
            let mut row = row.clone();
            row["name"] = name.into();
            row
        };
        assert_eq!(
            read,
            json!({
                "version": "0.1.0",
                "preset": "first-light",
                "device": { "name": "llvmpipe (LLVM 15.0.6, 256 bits)", "kind": "cpu", "driver": "llvmpipe", "driver_version": "Mesa 22.3.6" },
                "timing_mode": "isolated",
                "width": 960,
                "height": 540,
                "shaders": "0123",
                "seed": 7,
                "frames": 2,
                "warmup": 2,
                "choices": { "gather.conservative_clusters.rasterization": "geometry-shader" },
                "timings": { "stages": [named("gbuffer")], "passes": [named("gbuffer/draw")], "total": statistics },
                "counts": { "gather/vpls": 1024 },
                "means": { "gather/glossy-listed": 2.5 },
                "memory": { "resources": { "rsm/depth": 16, "rsm/flux": 64 }, "stages": { "rsm": 80 } },
                "checks": { "check-nan": { "gather/per-pixel": 0 } },
                "warnings": ["unused extension"],
                "peak_memory_bytes": 1_u64 << 30,
                "config": { "frame": { "size": [960, 540] } },
            })
        );
    }
}
