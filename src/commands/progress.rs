//! Progress of long runs.

use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A line of progress on stderr. It is hidden if stderr is no terminal or the user asked for quiet.
pub struct Progress(ProgressBar);

impl Progress {
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        bar.enable_steady_tick(Duration::from_millis(200));
        Self(bar)
    }

    pub fn say(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }

    pub fn warn(&self, what: &str) {
        self.0.suspend(|| eprintln!("manylight: warning: {what}"));
    }

    /// Prints a line to stdout that the progress does not overwrite.
    pub fn print(&self, line: &str) {
        self.0.suspend(|| println!("{line}"));
    }

    pub fn frame(&self, frame: u32, count: u32) {
        if frame == 0
            && let Ok(style) = ProgressStyle::with_template("{spinner} frame {pos}/{len} [{bar:40}] {eta}")
        {
            self.0.set_length(u64::from(count));
            self.0.set_style(style);
        }
        self.0.set_position(u64::from(frame));
    }

    /// Progress of a path tracer: samples done and in all, rays a second, time left.
    pub fn samples(&self, done: u64, of: u64, rays_a_second: f64) {
        if self.0.length() != Some(of)
            && let Ok(style) = ProgressStyle::with_template("{spinner} sample {pos}/{len} [{bar:30}] {msg}, {eta} left")
        {
            self.0.set_length(of);
            self.0.set_style(style);
            // Samples of an earlier run are left out of this one's speed.
            self.0.set_position(done);
            self.0.reset_eta();
        }
        self.0.set_position(done);
        self.0.set_message(format!("{:.2} million rays/s", rays_a_second / 1e6));
    }

    /// Progress of a sweep: runs done and in all, and the present run.
    pub fn step(&self, done: u64, of: u64, what: &str) {
        if let Ok(style) = ProgressStyle::with_template("{spinner} run {pos}/{len} [{bar:30}] {msg}, {eta} left") {
            self.0.set_style(style);
        }
        self.0.set_length(of);
        self.0.set_position(done);
        self.0.set_message(what.to_owned());
    }

    pub fn tick(&self) {
        self.0.tick();
    }

    /// Runs `print` with the progress hidden.
    pub fn suspend(&self, print: impl FnOnce()) {
        self.0.suspend(print);
    }

    pub fn end(&self) {
        self.0.finish_and_clear();
    }
}
