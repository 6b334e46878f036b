//! Traces of a run's time: spans of the host's work and passes of the device on one clock, as a file of Chrome's trace events for
//! ui.perfetto.dev and chrome://tracing.
//!
//! There is one recorder for the whole program, since work is spread over threads. While it is off, a span costs a load of one flag. A
//! crate for tracing would not do for the device's passes: it stamps events when they happen, and times of passes are known only after the
//! frame.
//!
//! Passes of the device are placed at the host's time of submission. Times between them are the device's own; the small delay before the
//! first is unknown and not shown.

use crate::files::write_file;
use anyhow::Result;
use serde_json::{Value, json};
use std::fmt::Display;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

static ON: AtomicBool = AtomicBool::new(false);
static RECORDER: Mutex<Option<Recorder>> = Mutex::new(None);

thread_local! {
    /// Number of this thread in the trace.
    static THREAD: u64 = {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        NEXT.fetch_add(1, Ordering::Relaxed)
    };
}

/// Processes of the trace: the first has the host's threads, the second the device's queue.
const CPU: u64 = 1;
const GPU: u64 = 2;

/// Turns the recorder on and discards earlier events.
pub fn start() {
    // The thread that starts the recorder is the first.
    THREAD.with(|_| ());
    with_recorder(|recorder| *recorder = Some(Recorder::new(Instant::now())));
    ON.store(true, Ordering::Relaxed);
}

/// Begins a span of the host's work, which ends when it is dropped. Spans of a thread nest.
pub fn span(name: impl Display) -> Span {
    Span(ON.load(Ordering::Relaxed).then(|| (name.to_string(), Instant::now())))
}

/// A span of the host's work; see [`span`].
#[must_use = "a span that is not held is over at once"]
pub struct Span(Option<(String, Instant)>);

impl Drop for Span {
    fn drop(&mut self) {
        let Some((name, begin)) = self.0.take() else { return };
        let end = Instant::now();
        let thread = (THREAD.with(|thread| *thread), std::thread::current());
        with_recorder(|recorder| {
            if let Some(recorder) = recorder {
                recorder.name_thread(thread.0, thread.1.name());
                recorder.events.push(Event { name, process: CPU, thread: thread.0, begin: recorder.at(begin), end: recorder.at(end) });
            }
        });
    }
}

/// Adds a pass that ran on the device for `ms` milliseconds, `begin` milliseconds after the first pass of the submission at `submitted`.
pub fn pass(name: &str, submitted: Instant, begin: f64, ms: f64) {
    if ON.load(Ordering::Relaxed) {
        with_recorder(|recorder| {
            if let Some(recorder) = recorder {
                let at = recorder.at(submitted);
                let (begin, end) = (at + begin * 1e3, at + (begin + ms) * 1e3);
                recorder.events.push(Event { name: name.to_owned(), process: GPU, thread: 1, begin, end });
            }
        });
    }
}

/// Turns the recorder off and writes its events; does nothing if it was off. `known` describes the run in the file, by name; its `device`
/// names the device's row.
///
/// # Errors
/// `OutputNotWritten` with the path and the reason.
pub fn finish(path: &Path, known: &[(&str, String)]) -> Result<()> {
    ON.store(false, Ordering::Relaxed);
    let Some(recorder) = with_recorder(Option::take) else { return Ok(()) };
    write_file(path, recorder.json(known).to_string().as_bytes())
}

fn with_recorder<R>(work: impl FnOnce(&mut Option<Recorder>) -> R) -> R {
    work(&mut RECORDER.lock().unwrap_or_else(PoisonError::into_inner))
}

/// An event; times are microseconds after the recorder's start.
struct Event {
    name: String,
    process: u64,
    thread: u64,
    begin: f64,
    end: f64,
}

struct Recorder {
    start: Instant,
    events: Vec<Event>,
    threads: Vec<(u64, String)>,
}

impl Recorder {
    fn new(start: Instant) -> Self {
        Self { start, events: Vec::new(), threads: Vec::new() }
    }

    /// Time of an event; earlier times, as of a span that was open at the start, are moved to the start.
    fn at(&self, time: Instant) -> f64 {
        time.saturating_duration_since(self.start).as_nanos() as f64 / 1e3
    }

    fn name_thread(&mut self, thread: u64, name: Option<&str>) {
        if !self.threads.iter().any(|(known, _)| *known == thread) {
            self.threads.push((thread, name.map_or_else(|| format!("worker {thread}"), str::to_owned)));
        }
    }

    /// The trace as JSON: names of processes and threads, then the events by thread and time, enclosing events first.
    fn json(mut self, known: &[(&str, String)]) -> Value {
        let name = |what: &str, process: u64, thread: u64, name: &str| json!({ "ph": "M", "name": what, "pid": process, "tid": thread, "args": { "name": name } });
        let mut events = vec![name("process_name", CPU, 0, "CPU"), name("process_name", GPU, 0, "GPU")];
        events.extend(self.threads.iter().map(|(thread, known)| name("thread_name", CPU, *thread, known)));
        let device = known.iter().find(|(name, _)| *name == "device").map_or("device", |(_, device)| device);
        events.push(name("thread_name", GPU, 1, device));
        self.events.sort_by(|a, b| {
            let place = |event: &Event| (event.process, event.thread);
            place(a).cmp(&place(b)).then(a.begin.total_cmp(&b.begin)).then(b.end.total_cmp(&a.end))
        });
        events.extend(self.events.iter().map(|event| {
            let category = if event.process == GPU { "gpu" } else { "cpu" };
            json!({
                "ph": "X", "name": event.name, "cat": category, "pid": event.process, "tid": event.thread,
                "ts": event.begin, "dur": event.end - event.begin,
            })
        }));
        let known: serde_json::Map<String, Value> = known.iter().map(|(name, what)| ((*name).to_owned(), what.as_str().into())).collect();
        json!({ "traceEvents": events, "displayTimeUnit": "ms", "otherData": known })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn known() -> [(&'static str, String); 2] {
        [("preset", "first-light".to_owned()), ("device", "llvmpipe (LLVM 15.0.6, 256 bits) [cpu]".to_owned())]
    }

    #[test]
    fn events_stand_by_thread_and_time_with_what_is_around_others_first() {
        let start = Instant::now();
        let mut recorder = Recorder::new(start);
        let mut add = |name: &str, process, thread, begin: u64, end: u64| {
            let [begin, end] = [begin, end].map(|us| recorder.at(start + Duration::from_micros(us)));
            recorder.events.push(Event { name: name.to_owned(), process, thread, begin, end });
        };
        // In the order in which spans end: inner ones first.
        add("gbuffer/draw", GPU, 1, 30, 40);
        add("waiting", CPU, 1, 25, 50);
        add("frame 0", CPU, 1, 25, 60);
        add("shader a.comp", CPU, 2, 5, 9);
        recorder.name_thread(1, Some("main"));
        recorder.name_thread(2, None);
        recorder.name_thread(2, None);
        let json = recorder.json(&known());
        let events = json["traceEvents"].as_array().unwrap();
        let of = |kind: &str| events.iter().filter(|event| event["ph"] == kind).collect::<Vec<_>>();
        let spans: Vec<(&str, u64, f64, f64)> = of("X")
            .iter()
            .map(|e| (e["name"].as_str().unwrap(), e["pid"].as_u64().unwrap(), e["ts"].as_f64().unwrap(), e["dur"].as_f64().unwrap()))
            .collect();
        let expected = [
            ("frame 0", CPU, 25.0, 35.0),
            ("waiting", CPU, 25.0, 25.0),
            ("shader a.comp", CPU, 5.0, 4.0),
            ("gbuffer/draw", GPU, 30.0, 10.0),
        ];
        assert_eq!(spans, expected);
        let names: Vec<&str> = of("M").iter().map(|event| event["args"]["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["CPU", "GPU", "main", "worker 2", "llvmpipe (LLVM 15.0.6, 256 bits) [cpu]"]);
        assert_eq!(json["otherData"]["preset"], "first-light");
    }

    #[test]
    fn what_began_before_the_recorder_is_put_at_its_start() {
        let start = Instant::now();
        assert_eq!(Recorder::new(start + Duration::from_secs(1)).at(start), 0.0);
    }

    #[test]
    fn a_recorder_that_was_never_on_writes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(span("nobody records this"));
        finish(&folder.path().join("trace.json"), &known()).unwrap();
        assert!(!folder.path().join("trace.json").exists());
    }
}
