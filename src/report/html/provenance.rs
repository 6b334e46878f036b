//! Provenance of several runs: common parts once, others as notes.

use crate::report::Provenance;
use serde::Serialize;

/// The parts common to all runs, and notes by mark.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Origins {
    /// Parts common to all runs.
    pub common: String,
    /// Parts particular to the runs with a mark; empty if all runs agree.
    pub notes: Vec<Note>,
    /// `cpu` or `gpu`; `None` if there are both.
    pub kind: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Note {
    pub mark: String,
    pub text: String,
}

/// Device and driver, mode, resolution, preset, version.
pub fn parts(from: &Provenance) -> [String; 5] {
    [
        format!("{}, {}", from.device.label(), from.device.driver_label()),
        format!("{} timing", from.timing_mode),
        format!("{} × {} pixels", from.width, from.height),
        format!("preset {}", from.preset),
        format!("manylight {}", from.version),
    ]
}

/// The common origin of runs with its notes, and each run's mark.
pub fn origins<'p>(runs: impl Iterator<Item = &'p Provenance>) -> (Origins, Vec<Option<String>>) {
    let runs: Vec<&Provenance> = runs.collect();
    let all: Vec<[String; 5]> = runs.iter().map(|from| parts(from)).collect();
    let Some(first) = all.first() else { return Default::default() };
    let is_common: [bool; 5] = std::array::from_fn(|i| all.iter().all(|parts| parts[i] == first[i]));
    let join = |parts: &[String; 5], common: bool| {
        let wanted = parts.iter().zip(is_common).filter(|(_, is_common)| *is_common == common);
        wanted.map(|(part, _)| part.as_str()).collect::<Vec<_>>().join("; ")
    };
    let kind = Some(&runs[0].device.kind).filter(|kind| runs.iter().all(|from| from.device.kind == **kind)).cloned();
    let mut origins = Origins { common: join(first, true), notes: Vec::new(), kind };
    if is_common == [true; 5] {
        return (origins, vec![None; all.len()]);
    }
    let mut marks = Vec::new();
    for parts in &all {
        let text = join(parts, false);
        let known = origins.notes.iter().find(|note| note.text == text).map(|note| note.mark.clone());
        marks.push(Some(known.unwrap_or_else(|| {
            let mark = letters(origins.notes.len());
            origins.notes.push(Note { mark: mark.clone(), text });
            mark
        })));
    }
    (origins, marks)
}

/// Letters from a to z, then aa, ab and so on.
fn letters(number: usize) -> String {
    let last = char::from(b'a' + (number % 26) as u8);
    if number < 26 { last.to_string() } else { format!("{}{last}", letters(number / 26 - 1)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::provenance;

    #[test]
    fn what_all_runs_share_is_said_once() {
        let from = provenance();
        let (origins, marks) = origins([&from, &from].into_iter());
        assert_eq!(
            origins.common,
            "llvmpipe (LLVM 15.0.6, 256 bits) [cpu], llvmpipe Mesa 22.3.6; isolated timing; 960 × 540 pixels; preset first-light; manylight 0.1.0"
        );
        assert_eq!((origins.notes.len(), origins.kind.as_deref(), marks), (0, Some("cpu"), vec![None, None]));
    }

    #[test]
    fn what_they_do_not_share_stands_by_their_marks() {
        let (a, mut b) = (provenance(), provenance());
        b.device.kind = "gpu".to_owned();
        b.width = 1920;
        let (origins, marks) = origins([&a, &b, &a].into_iter());
        assert_eq!(origins.common, "isolated timing; preset first-light; manylight 0.1.0");
        assert_eq!(marks, ["a", "b", "a"].map(|mark| Some(mark.to_owned())));
        assert!(origins.notes[1].text.contains("[gpu]") && origins.notes[1].text.ends_with("1920 × 540 pixels"), "{origins:?}");
        assert_eq!(origins.kind, None);
    }

    #[test]
    fn no_runs_have_no_origins_and_many_have_letters_enough() {
        assert_eq!(origins(std::iter::empty()), Default::default());
        assert_eq!([0, 25, 26, 701, 702].map(letters), ["a", "z", "aa", "zz", "aaa"]);
    }
}
