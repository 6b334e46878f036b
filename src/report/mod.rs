//! Figures: times of passes, their statistics, memory of frames, and their output as tables, line, CSV and page.
//!
//! Every figure is written with its [`Provenance`].

mod csv;
mod flicker;
pub mod html;
mod line;
mod memory;
mod run;
mod statistics;
mod table;

pub use self::csv::timings_csv;
pub use self::flicker::{FlickerLine, flicker_csv};
pub use self::line::paste_line;
pub use self::memory::{Memory, counts_table, memory_table};
pub use self::run::{RunReport, resolved};
pub use self::statistics::{Row, Statistics, Timings};
pub use self::table::timing_table;

use serde::{Deserialize, Serialize};

/// Time of a pass in a frame. A pass that runs several times in a frame has several entries.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTime {
    /// Frame, counted from 0 without warm-up.
    pub frame: u32,
    /// Name of the pass, `stage/pass`: `visibility/ism-splat`.
    pub pass: String,
    /// Time, ms.
    pub ms: f64,
}

impl PassTime {
    /// Stage of the pass.
    pub fn stage(&self) -> &str {
        stage(&self.pass)
    }
}

/// The stage of a pass: its name up to the slash.
pub fn stage(pass: &str) -> &str {
    pass.split_once('/').map_or(pass, |(stage, _)| stage)
}

/// Origin of figures, to be written beside each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of this program.
    pub version: String,
    /// Name of the config that was rendered.
    pub preset: String,
    pub device: Device,
    /// Timing mode: `isolated`, `overlapped` or `serial`.
    pub timing_mode: String,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

impl Provenance {
    /// Values written beside every figure in a file, by name.
    pub fn known(&self) -> [(&'static str, String); 7] {
        [
            ("timing_mode", self.timing_mode.clone()),
            ("device", self.device.label()),
            ("driver", self.device.driver_label()),
            ("width", self.width.to_string()),
            ("height", self.height.to_string()),
            ("preset", self.preset.clone()),
            ("version", self.version.clone()),
        ]
    }

    /// Values written into an image's metadata, by name.
    pub fn of_image(&self) -> [(&'static str, String); 3] {
        [("version", self.version.clone()), ("preset", self.preset.clone()), ("device", self.device.name.clone())]
    }
}

/// A device and its driver, by their own names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Device {
    pub name: String,
    /// `cpu` for a software driver, else `gpu`.
    pub kind: String,
    pub driver: String,
    pub driver_version: String,
}

impl Device {
    /// Name and kind: `llvmpipe (LLVM 15.0.6, 256 bits) [cpu]`.
    pub fn label(&self) -> String {
        format!("{} [{}]", self.name, self.kind)
    }

    /// Driver and version, without the driver's name twice if the version repeats it.
    pub fn driver_label(&self) -> String {
        match self.driver_version.as_str() {
            "" => self.driver.clone(),
            version if version.starts_with(&self.driver) => version.to_owned(),
            version => format!("{} {version}", self.driver),
        }
    }
}

/// Peak memory of this process so far, bytes; `None` if the system does not tell.
pub fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?;
    Some(kibibytes.trim().parse::<u64>().ok()? * 1024)
}

/// A share of a whole as text: `31.0 %`.
pub fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

#[cfg(test)]
pub(crate) mod samples {
    use super::*;

    pub fn provenance() -> Provenance {
        Provenance {
            version: "0.1.0".into(),
            preset: "first-light".into(),
            device: Device {
                name: "llvmpipe (LLVM 15.0.6, 256 bits)".into(),
                kind: "cpu".into(),
                driver: "llvmpipe".into(),
                driver_version: "Mesa 22.3.6".into(),
            },
            timing_mode: "isolated".into(),
            width: 960,
            height: 540,
        }
    }

    pub fn times(list: &[(u32, &str, f64)]) -> Vec<PassTime> {
        list.iter().map(|&(frame, pass, ms)| PassTime { frame, pass: pass.into(), ms }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stage_is_what_stands_before_the_slash() {
        for (pass, expected) in [("visibility/ism-splat", "visibility"), ("gbuffer", "gbuffer"), ("a/b/c", "a")] {
            assert_eq!(stage(pass), expected);
        }
    }

    #[test]
    fn the_driver_is_not_named_twice() {
        let mut device = samples::provenance().device;
        assert_eq!(device.driver_label(), "llvmpipe Mesa 22.3.6");
        device.driver_version = "llvmpipe 22.3.6".into();
        assert_eq!(device.driver_label(), "llvmpipe 22.3.6");
        device.driver_version.clear();
        assert_eq!(device.driver_label(), "llvmpipe");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn peak_memory_covers_what_was_touched() {
        let touched = std::hint::black_box(vec![1_u8; 32 << 20]);
        assert!(peak_memory_bytes().unwrap() > touched.len() as u64);
    }
}
