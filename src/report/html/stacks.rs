//! Shares of a whole as stacked bars: ours over the paper's.

use super::table::TableFile;
use crate::report::percent;
use crate::tables::Part;
use serde::Serialize;

/// Width of a bar of the whole, in the picture's units.
const WIDTH: f64 = 1000.0;
/// A share's figure stands in its segment from this width on.
const LEAST_FOR_TEXT: f64 = 48.0;
/// Colours that the style has.
const COLORS: usize = 10;
/// What is left of a whole is shown from this share on.
const LEAST_REST: f64 = 0.002;

/// A table's stacks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stacks {
    /// What the shares are of.
    pub whole: String,
    pub legend: Vec<Color>,
    pub stacks: Vec<StackView>,
    pub width: f64,
    /// Whether any bar has a rest that is none of its parts.
    pub has_rest: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Color {
    pub name: String,
    pub color: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StackView {
    pub name: String,
    /// Bars with the name of whose they are.
    pub bars: Vec<StackBar>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StackBar {
    pub whose: &'static str,
    pub segments: Vec<Segment>,
    /// The bar in words.
    pub alt: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Segment {
    /// Number of a colour; `None` for the rest.
    pub color: Option<usize>,
    pub x: f64,
    pub width: f64,
    /// Figure, where there is room for it.
    pub text: Option<String>,
    pub title: String,
}

/// The stacks of a table; `None` if it has none, or no figure in them.
pub fn stacks(table: &TableFile) -> Option<Stacks> {
    let named = |part: &Part| (part.name.clone(), part.share);
    let papers = |part: &Part| (part.name.clone(), part.published_share);
    let view = |stack: &crate::tables::Stack| {
        let bars = [("ours", stack.parts.iter().map(named).collect::<Vec<_>>()), ("paper", stack.parts.iter().map(papers).collect())];
        let bars = bars.into_iter().filter_map(|(whose, parts)| bar(whose, &parts)).collect::<Vec<_>>();
        StackView { name: stack.name.clone(), bars }
    };
    let stacks: Vec<StackView> = table.stacks.iter().map(view).filter(|stack| !stack.bars.is_empty()).collect();
    let legend = table.stacks.first()?.parts.iter().enumerate();
    let legend = legend.map(|(i, part)| Color { name: part.name.clone(), color: i % COLORS }).collect();
    let has_rest = stacks.iter().flat_map(|stack| &stack.bars).flat_map(|bar| &bar.segments).any(|segment| segment.color.is_none());
    let whole = table.share_of.clone().unwrap_or_default();
    (!stacks.is_empty()).then_some(Stacks { whole, legend, stacks, width: WIDTH, has_rest })
}

/// A bar of shares one after the other, and what is left of the whole; `None` without figures. Shares over the whole make it the longer.
fn bar(whose: &'static str, parts: &[(String, Option<f64>)]) -> Option<StackBar> {
    let shares: Vec<f64> = parts.iter().map(|(_, share)| share.filter(|share| share.is_finite()).unwrap_or(0.0).clamp(0.0, 1e6)).collect();
    let sum: f64 = shares.iter().sum();
    if sum <= 0.0 {
        return None;
    }
    let scale = WIDTH / sum.max(1.0);
    let mut x = 0.0;
    let mut segments = Vec::new();
    let names = parts.iter().enumerate().map(|(i, (name, _))| (Some(i % COLORS), name.as_str())).chain([(None, "the rest")]);
    for ((color, name), share) in names.zip(shares.iter().copied().chain([1.0 - sum])) {
        if share <= 0.0 || (color.is_none() && share < LEAST_REST) {
            continue;
        }
        let (width, text) = (share * scale, percent(share));
        let title = format!("{name}: {text}");
        segments.push(Segment { color, x: tenths(x), width: tenths(width), text: Some(text).filter(|_| width >= LEAST_FOR_TEXT), title });
        x += width;
    }
    let alt = segments.iter().map(|segment| segment.title.as_str()).collect::<Vec<_>>().join(", ");
    Some(StackBar { whose, segments, alt })
}

fn tenths(length: f64) -> f64 {
    (10.0 * length).round() / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn table(parts: serde_json::Value) -> TableFile {
        serde_json::from_value(json!({
            "name": "t", "title": "T", "version": "0.1.0", "timing_mode": "isolated", "share_of": "total",
            "device": { "name": "d", "kind": "cpu", "driver": "e", "driver_version": "1" },
            "rows": [], "columns": [], "cells": [], "stacks": [{ "name": "frame", "parts": parts }],
        }))
        .unwrap()
    }

    #[test]
    fn a_bar_has_its_parts_one_after_the_other_and_the_rest() {
        let parts = json!([
            { "name": "a", "share": 0.25, "published_share": 0.5 },
            { "name": "b", "share": 0.5, "published_share": null },
            { "name": "c", "share": 0.01, "published_share": 0.5 },
        ]);
        let view = stacks(&table(parts)).unwrap();
        let [ours, paper] = view.stacks[0].bars.as_slice() else { panic!("{view:?}") };
        let places = |bar: &StackBar| bar.segments.iter().map(|part| (part.color, part.x, part.width)).collect::<Vec<_>>();
        assert_eq!(places(ours), [(Some(0), 0.0, 250.0), (Some(1), 250.0, 500.0), (Some(2), 750.0, 10.0), (None, 760.0, 240.0)]);
        assert_eq!(places(paper), [(Some(0), 0.0, 500.0), (Some(2), 500.0, 500.0)]);
        assert_eq!(ours.alt, "a: 25.0 %, b: 50.0 %, c: 1.0 %, the rest: 24.0 %");
        let texts: Vec<_> = ours.segments.iter().map(|part| part.text.as_deref()).collect();
        assert_eq!(texts, [Some("25.0 %"), Some("50.0 %"), None, Some("24.0 %")]);
        assert!(view.has_rest && view.whole == "total" && view.legend.len() == 3);
    }

    #[test]
    fn a_table_whose_paper_has_no_figures_has_our_bar_alone_and_one_without_figures_none() {
        let view = stacks(&table(json!([{ "name": "a", "share": 3.0, "published_share": null }]))).unwrap();
        assert_eq!((view.stacks[0].bars.len(), view.stacks[0].bars[0].segments[0].width, view.has_rest), (1, 1000.0, false));
        assert_eq!(stacks(&table(json!([{ "name": "a", "share": null, "published_share": null }]))), None);
        assert_eq!(stacks(&table(json!([{ "name": "a", "share": -1.0, "published_share": 0.0 }]))), None);
    }
}
