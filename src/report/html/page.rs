//! The page: sections filled into the template.

use super::errors::Picture;
use super::folders::{Group, Run};
use super::group::{Builder, GroupView};
use crate::metrics::LayerPair;
use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;
use sha2::{Digest, Sha256};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Input of the template.
#[derive(Debug, Serialize)]
struct Page {
    title: String,
    /// Numbers of tables, runs, references and flicker measurements.
    summary: String,
    sections: Vec<GroupView>,
    /// Pictures of references.
    shared: Vec<Picture>,
    /// The heatmaps' colours.
    ramp: Picture,
    /// Layers that errors are measured on.
    layers: String,
    style: &'static str,
    script: &'static str,
    /// Hashes of the style and the script for the content policy.
    style_hash: String,
    script_hash: String,
}

/// The page of these groups; errors are measured on `layers`.
///
/// # Errors
/// `BadInput` with the file that cannot be shown or compared.
pub fn render(groups: &[Group], layers: &LayerPair) -> Result<String> {
    let others: &[Run] = groups.iter().find(|group| group.table.is_none()).map_or(&[], |group| &group.references);
    let mut builder = Builder::new(layers);
    let mut sections = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        sections.push(builder.group(group, others, i + 1)?);
    }
    let title = match sections.as_slice() {
        [section] if section.table.is_some() => section.title.clone(),
        _ => "manylight report".to_owned(),
    };
    let page = Page {
        title,
        summary: summary(groups),
        sections,
        shared: builder.shared,
        ramp: Picture::ramp()?,
        layers: layers.to_string(),
        style: STYLE,
        script: SCRIPT,
        style_hash: hash(STYLE),
        script_hash: hash(SCRIPT),
    };
    Ok(fill(&page))
}

fn fill(page: &Page) -> String {
    let mut environment = Environment::new();
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    // The template's ending `.html` turns escaping on.
    let filled = environment.add_template("page.html", TEMPLATE).and_then(|()| environment.get_template("page.html")?.render(page));
    match filled {
        Ok(html) => html,
        Err(error) => unreachable!("the page's template takes what it is given: {error:#}"),
    }
}

/// Hash in the content policy's form.
fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text)))
}

fn summary(groups: &[Group]) -> String {
    let count = |count: fn(&Group) -> usize, one: &str, many: &str| match groups.iter().map(count).sum::<usize>() {
        0 => None,
        1 => Some(format!("1 {one}")),
        several => Some(format!("{several} {many}")),
    };
    let counts = [
        count(|group| usize::from(group.table.is_some()), "table", "tables"),
        count(|group| group.runs.len(), "run", "runs"),
        count(|group| group.references.len(), "reference", "references"),
        count(|group| group.flickers.len(), "flicker measurement", "flicker measurements"),
    ];
    counts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Timings;
    use crate::report::html::flicker::Flicker;
    use crate::report::html::samples::run;
    use crate::report::samples::times;
    use serde_json::json;

    const HOSTILE: &str = "<script>alert('&\"')</script>";

    fn page(groups: &[Group]) -> String {
        render(groups, &LayerPair::radiance()).unwrap()
    }

    /// A group with hostile text in every field.
    fn hostile() -> Group {
        let mut run = run(HOSTILE);
        run.record.from.preset = HOSTILE.to_owned();
        run.record.from.device.name = HOSTILE.to_owned();
        run.record.from.timing_mode = HOSTILE.to_owned();
        run.record.warnings = vec![HOSTILE.to_owned()];
        run.record.checks.insert(HOSTILE.to_owned(), json!(HOSTILE));
        run.record.counts.insert(HOSTILE.to_owned(), 1);
        run.record.config[HOSTILE] = json!(HOSTILE);
        run.record.timings = Timings::of(&times(&[(0, HOSTILE, 1.0)]));
        let mut reference = run.clone();
        reference.record.counts.insert("reference/samples".to_owned(), 1);
        let table = serde_json::from_value(json!({
            "name": HOSTILE, "title": HOSTILE, "source": HOSTILE, "about": HOSTILE, "version": HOSTILE, "timing_mode": HOSTILE,
            "device": { "name": HOSTILE, "kind": HOSTILE, "driver": HOSTILE, "driver_version": HOSTILE },
            "published": { "hardware": HOSTILE, "scene": HOSTILE, "settings": HOSTILE }, "deviations": [HOSTILE],
            "rows": [HOSTILE], "columns": [HOSTILE, "b"],
            "cells": [[{ "measure": HOSTILE, "unit": HOSTILE, "value": null, "why": HOSTILE }, { "value": 1, "run": HOSTILE }]],
        }));
        Group {
            table: Some(table.unwrap()),
            runs: vec![run],
            references: vec![reference],
            flickers: vec![Flicker { label: HOSTILE.to_owned(), from: None, walk: Some(1.0), pairs: vec![(0.0, 1.0)] }],
            missing: vec![HOSTILE.to_owned()],
        }
    }

    #[test]
    fn names_from_files_are_text_and_never_markup() {
        let html = page(&[hostile()]);
        assert_eq!(html.matches("<script").count(), 1, "the page's own alone");
        assert!(html.matches("&lt;script&gt;").count() > 20);
        assert!(!html.contains("alert('"), "quotes end no attribute");
    }

    #[test]
    fn the_page_asks_for_nothing_from_outside() {
        let html = page(&[hostile(), Group { runs: vec![run("a"), run("b")], ..Group::default() }]);
        assert!(html.contains("default-src 'none'; img-src data:; "));
        for outside in ["http:", "https:", "//", "@import", "url(", "<link", "<iframe"] {
            let rest = html.replace(SCRIPT, "");
            assert!(!rest.contains(outside), "{outside}");
        }
        for own in [STYLE, SCRIPT] {
            assert!(html.contains(own) && html.contains(&hash(own)), "the policy names what is there");
        }
        // The policy blocks inline styles and handlers.
        assert!(!html.contains(" style=\"") && !html.contains(" onclick"));
    }

    #[test]
    fn the_same_input_is_the_same_page() {
        assert_eq!(page(&[hostile()]), page(&[hostile()]));
    }

    #[test]
    fn the_hash_is_that_of_browsers() {
        // The example from Content Security Policy Level 3.
        assert_eq!(hash("alert('Hello, world.');"), "sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng=");
    }

    #[test]
    fn several_sections_have_a_table_of_contents() {
        let runs = || Group { runs: vec![run("a")], ..Group::default() };
        let html = page(&[hostile(), runs()]);
        assert!(html.contains("<nav") && html.contains("href=\"#s1\"") && html.contains("href=\"#s2\""));
        assert!(html.contains("1 table, 2 runs, 1 reference, 1 flicker measurement"), "counted");
        assert!(!page(&[runs()]).contains("href=\"#s2\""));
    }
}
