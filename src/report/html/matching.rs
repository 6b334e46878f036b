//! Matching of runs with references.

use super::folders::Run;
use serde_json::Value;

/// Differences of a run and a reference in sections that must agree: scene, light and view. The methods may differ.
pub fn differences(run: &Run, reference: &Run) -> Vec<&'static str> {
    let (a, b) = (&run.record, &reference.record);
    let mut differing: Vec<&'static str> =
        ["scene", "camera", "light", "materials"].into_iter().filter(|section| a.config.get(section) != b.config.get(section)).collect();
    if (a.from.width, a.from.height) != (b.from.width, b.from.height) {
        differing.push("size");
    }
    let moves = moves(&a.config) || moves(&b.config);
    if moves && (frame(run), &a.config["frame"]["fps"]) != (frame(reference), &b.config["frame"]["fps"]) {
        differing.push("frame");
    }
    // A missing config counts as a difference.
    if a.config.is_null() || b.config.is_null() {
        differing.push("config");
    }
    differing
}

fn moves(config: &Value) -> bool {
    let has_keyframes = |value: &Value| value.get("keyframes").is_some_and(|keyframes| !keyframes.is_null());
    let lights = config.get("light").and_then(Value::as_array);
    config.get("camera").is_some_and(has_keyframes) || lights.is_some_and(|lights| lights.iter().any(has_keyframes))
}

/// The frame that the picture shows; a render's is its last.
fn frame(run: &Run) -> Option<u64> {
    let of_reference = run.record.counts.get("reference/frame").copied();
    of_reference.or_else(|| run.record.config["frame"]["count"].as_u64().and_then(|count| count.checked_sub(1)))
}

/// A run's reference, if there is one.
#[derive(Debug, Clone, PartialEq)]
pub enum Match<'r> {
    Found(&'r Run),
    /// No reference agrees; the nearest, and its differences.
    Nearest(&'r Run, Vec<&'static str>),
    /// There is no reference at all.
    Nothing,
}

/// The reference of a run from `own`, its table's, or else from `others`: of those that agree the one with the most samples,
/// the first among equals.
pub fn reference_of<'r>(run: &Run, own: &'r [Run], others: &'r [Run]) -> Match<'r> {
    for candidates in [own, others] {
        let agreeing = candidates.iter().filter(|reference| differences(run, reference).is_empty());
        // `max_by_key` takes the last of equals; reversing makes it the first.
        if let Some(best) = agreeing.rev().max_by_key(|reference| reference.samples()) {
            return Match::Found(best);
        }
    }
    let nearest = own.iter().chain(others).map(|reference| (reference, differences(run, reference))).min_by_key(|(_, list)| list.len());
    nearest.map_or(Match::Nothing, |(reference, list)| Match::Nearest(reference, list))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::samples::run;
    use serde_json::json;

    fn with(label: &str, samples: Option<u64>, change: impl FnOnce(&mut Run)) -> Run {
        let mut run = run(label);
        run.record.counts.extend(samples.map(|samples| ("reference/samples".to_owned(), samples)));
        change(&mut run);
        run
    }

    #[test]
    fn how_light_is_computed_may_differ_and_what_is_looked_at_may_not() {
        let test = run("test");
        let same = with("r", Some(4), |r| {
            r.record.config["vpls"]["count"] = json!(9);
            r.record.config["frame"]["count"] = json!(1);
        });
        assert!(differences(&test, &same).is_empty());
        let other = |change: fn(&mut Run)| differences(&test, &with("r", Some(4), change));
        assert_eq!(other(|r| r.record.config["scene"]["seed"] = json!(1)), ["scene"]);
        assert_eq!(other(|r| r.record.config["camera"] = json!({ "fov_y_deg": 50 })), ["camera"]);
        assert_eq!(other(|r| r.record.config["light"] = json!([{ "kind": "spot" }])), ["light"]);
        assert_eq!(other(|r| r.record.config["materials"]["dielectric"] = json!("ggx")), ["materials"]);
        assert_eq!(other(|r| r.record.from.width += 1), ["size"]);
        assert!(!other(|r| r.record.config = Value::Null).is_empty());
        let nothing = with("test", None, |r| r.record.config = Value::Null);
        assert_eq!(differences(&nothing, &nothing), ["config"]);
    }

    #[test]
    fn the_frame_counts_only_where_something_moves() {
        let moving = |label: &str, samples: Option<u64>, frame: u64| {
            with(label, samples, |r| {
                r.record.config["light"] = json!([{ "keyframes": [{ "time": 0 }] }]);
                r.record.config["frame"]["count"] = json!(5);
                r.record.counts.extend(samples.map(|_| ("reference/frame".to_owned(), frame)));
            })
        };
        let test = moving("test", None, 0);
        assert!(differences(&test, &moving("r", Some(4), 4)).is_empty());
        assert_eq!(differences(&test, &moving("r", Some(4), 3)), ["frame"]);
        let still = with("r", Some(4), |r| r.record.counts.extend([("reference/frame".to_owned(), 77)]));
        assert!(differences(&run("test"), &still).is_empty());
    }

    #[test]
    fn the_most_samples_win_and_a_tables_own_references_come_first() {
        let reference = |label: &str, samples| with(label, Some(samples), |_| ());
        let (own, others) = ([reference("own", 4)], [reference("few", 16), reference("many", 64), reference("as many", 64)]);
        let found = |own, others| match reference_of(&run("test"), own, others) {
            Match::Found(reference) => reference.label.clone(),
            other => panic!("{other:?}"),
        };
        assert_eq!(found(&own, &others), "own");
        assert_eq!(found(&[], &others), "many");
    }

    #[test]
    fn where_none_agrees_the_nearest_says_why() {
        let far = with("far", Some(4), |r| {
            r.record.from.width = 1;
            r.record.config["scene"] = json!("another");
        });
        let near = with("near", Some(4), |r| r.record.from.width = 1);
        let references = [far, near];
        let Match::Nearest(nearest, why) = reference_of(&run("test"), &[], &references) else { panic!() };
        assert_eq!((nearest, why), (&references[1], vec!["size"]));
        assert_eq!(reference_of(&run("test"), &[], &[]), Match::Nothing);
    }
}
