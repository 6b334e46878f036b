//! Plots: the places of everything in them, in pixels of a drawing of [`WIDTH`] x [`HEIGHT`]. The page's template draws them.

use super::axis::{Axis, Tick, round};
use serde::Serialize;

pub const WIDTH: f64 = 460.0;
pub const HEIGHT: f64 = 320.0;
/// Area of the values: left, top, right, bottom.
const AREA: [f64; 4] = [58.0, 14.0, 446.0, 272.0];
/// Estimated width of a letter and height of a line of labels, pixels.
const LETTER: f64 = 6.2;
const LINE: f64 = 13.0;

/// Frame common to all plots.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Frame {
    pub width: f64,
    pub height: f64,
    pub area: [f64; 4],
    pub x_ticks: Vec<Tick>,
    pub y_ticks: Vec<Tick>,
    pub x_label: String,
    pub y_label: String,
    /// Alternative text.
    pub alt: String,
}

/// A run in a plot of error against time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    pub label: String,
    /// Time, ms.
    pub time: f64,
    pub error: f64,
    /// Anchor of the run on the page.
    pub target: String,
}

/// A plot of error against time, both logarithmic.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scatter {
    pub frame: Frame,
    pub points: Vec<Point>,
    pub guide: Option<Guide>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub label: String,
    /// Place of the label; `None` if it fits nowhere.
    pub text: Option<Text>,
    /// Whether the error is 0, which a logarithmic axis cannot show.
    pub is_zero: bool,
    pub target: String,
    /// The figures in words.
    pub title: String,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Text {
    pub x: f64,
    pub y: f64,
    /// `start`, `middle` or `end`.
    pub anchor: &'static str,
}

/// Line of a method's expected error over increasing time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Guide {
    pub from: [f64; 2],
    pub to: [f64; 2],
}

/// A plot of error against time. `slope` is the guide's: -1 for squared errors, which fall as 1/t, and -1/2 for others, which
/// fall as its root. The guide goes through the run that is most efficient by this law, so that runs above it are less
/// efficient.
pub fn scatter(samples: &[Sample], slope: f64, x_label: &str, y_label: &str) -> Scatter {
    let [left, top, right, bottom] = AREA;
    let x = Axis::log(samples.iter().map(|sample| sample.time), [left, right]);
    let y = Axis::log(samples.iter().map(|sample| sample.error), [bottom, top]);
    let mut points: Vec<Point> = samples
        .iter()
        .map(|sample| Point {
            x: x.at(sample.time),
            y: y.at(sample.error),
            label: sample.label.clone(),
            text: None,
            is_zero: sample.error <= 0.0,
            target: sample.target.clone(),
            title: format!(
                "{}: {} ms, {y_label} {}",
                sample.label,
                super::numbers::short(sample.time),
                super::numbers::short(sample.error)
            ),
        })
        .collect();
    place_labels(&mut points);
    let alt = format!("Plot of {y_label} against {x_label}. {}", points.iter().map(|p| p.title.as_str()).collect::<Vec<_>>().join("; "));
    Scatter { frame: frame(&x, &y, x_label, y_label, alt), guide: guide(samples, slope, &x, &y), points }
}

fn frame(x: &Axis, y: &Axis, x_label: &str, y_label: &str, alt: String) -> Frame {
    let (x_label, y_label) = (x_label.to_owned(), y_label.to_owned());
    Frame { width: WIDTH, height: HEIGHT, area: AREA, x_ticks: x.ticks(), y_ticks: y.ticks(), x_label, y_label, alt }
}

fn guide(samples: &[Sample], slope: f64, x: &Axis, y: &Axis) -> Option<Guide> {
    let logs = samples.iter().filter(|sample| sample.time > 0.0 && sample.error > 0.0).map(|s| (s.time.log10(), s.error.log10()));
    // The line is e = level + slope t.
    let levels: Vec<f64> = logs.map(|(time, error)| error - slope * time).collect();
    let level = levels.iter().copied().reduce(f64::min).filter(|_| levels.len() > 1)?;
    let ([low, high], [bottom, top]) = (x.logs(), y.logs());
    // Both ends are in the area: a falling line enters at its left or top side, and leaves at its right or bottom.
    let [from, to] = [low.max((top - level) / slope), high.min((bottom - level) / slope)];
    let end = |time: f64| [x.at(10_f64.powf(time)), y.at(10_f64.powf(level + slope * time))];
    Some(Guide { from: end(from), to: end(to) })
}

/// Places each point's label to its right, left, top or bottom, wherever it overlaps nothing, in the points' order.
fn place_labels(points: &mut [Point]) {
    let centers: Vec<(f64, f64)> = points.iter().map(|point| (point.x, point.y)).collect();
    let mut taken: Vec<[f64; 4]> = centers.iter().map(|(x, y)| [x - 5.0, y - 5.0, x + 5.0, y + 5.0]).collect();
    for (i, point) in points.iter_mut().enumerate() {
        let width = point.label.chars().count() as f64 * LETTER;
        let (x, y) = (point.x, point.y);
        let places = [
            ("start", x + 9.0, y, x + 9.0),
            ("end", x - 9.0, y, x - 9.0 - width),
            ("middle", x, y - 12.0, x - width / 2.0),
            ("middle", x, y + 12.0, x - width / 2.0),
        ];
        for (anchor, text_x, center, left) in places {
            let area = [left, center - LINE / 2.0, left + width, center + LINE / 2.0];
            let inside = area[0] >= AREA[0] && area[1] >= AREA[1] - LINE && area[2] <= WIDTH && area[3] <= AREA[3];
            let hits = |other: &[f64; 4]| area[0] < other[2] && other[0] < area[2] && area[1] < other[3] && other[1] < area[3];
            if inside && !taken.iter().enumerate().any(|(j, other)| j != i && hits(other)) {
                point.text = Some(Text { x: round(text_x), y: round(center + 4.0), anchor });
                taken.push(area);
                break;
            }
        }
    }
}

/// A line over numbered frames.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    pub frame: Frame,
    /// Points of an SVG polyline.
    pub points: String,
    /// The only point, if there is just one.
    pub dot: Option<[f64; 2]>,
}

/// A plot of values over frames, from 0 on.
pub fn line(values: &[(f64, f64)], x_label: &str, y_label: &str) -> Line {
    let [left, top, right, bottom] = AREA;
    let x = Axis::linear(None, values.iter().map(|value| value.0), [left, right]);
    let y = Axis::linear(Some(0.0), values.iter().map(|value| value.1), [bottom, top]);
    let places: Vec<[f64; 2]> = values.iter().map(|value| [x.at(value.0), y.at(value.1)]).collect();
    let alt = format!("Plot of {y_label} against {x_label}, {} values", values.len());
    let points = places.iter().map(|[x, y]| format!("{x},{y}")).collect::<Vec<_>>().join(" ");
    Line { frame: frame(&x, &y, x_label, y_label, alt), points, dot: (places.len() == 1).then(|| places[0]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(list: &[(f64, f64)]) -> Vec<Sample> {
        let sample = |(i, &(time, error)): (usize, &(f64, f64))| Sample { label: format!("run {i}"), time, error, target: String::new() };
        list.iter().enumerate().map(sample).collect()
    }

    fn plot(list: &[(f64, f64)], slope: f64) -> Scatter {
        scatter(&samples(list), slope, "time", "error")
    }

    #[test]
    fn one_point_lies_in_the_middle_with_its_label_and_no_guide() {
        let plot = plot(&[(40.0, 0.01)], -1.0);
        let point = &plot.points[0];
        assert!((point.x - (AREA[0] + AREA[2]) / 2.0).abs() < 0.1 && (point.y - (AREA[1] + AREA[3]) / 2.0).abs() < 0.1, "{point:?}");
        assert!(point.text.is_some() && plot.guide.is_none() && plot.frame.x_ticks.len() > 1);
        assert_eq!(point.title, "run 0: 40.0 ms, error 0.0100");
    }

    #[test]
    fn less_error_is_lower_and_more_time_to_the_right() {
        let plot = plot(&[(10.0, 0.1), (100.0, 0.01)], -1.0);
        assert!(plot.points[0].x < plot.points[1].x && plot.points[0].y < plot.points[1].y);
    }

    #[test]
    fn the_guide_goes_through_the_most_efficient_run_and_stays_inside() {
        for slope in [-1.0, -0.5] {
            let plot = plot(&[(10.0, 0.1), (100.0, 0.005), (30.0, 0.3)], slope);
            let Guide { from, to } = plot.guide.unwrap();
            let [left, top, right, bottom] = AREA;
            for [x, y] in [from, to] {
                assert!((left - 0.1..=right + 0.1).contains(&x) && (top - 0.1..=bottom + 0.1).contains(&y), "{from:?} {to:?}");
            }
            // Every point is on the guide or above.
            let under = |p: &&Point| p.y > from[1] + (to[1] - from[1]) * (p.x - from[0]) / (to[0] - from[0]) + 0.5;
            assert_eq!(plot.points.iter().filter(under).count(), 0);
            let best = &plot.points[1];
            assert!((from[1] + (to[1] - from[1]) * (best.x - from[0]) / (to[0] - from[0]) - best.y).abs() < 0.5);
        }
    }

    #[test]
    fn equal_runs_share_a_place_and_one_label_suffices_there() {
        let plot = plot(&[(5.0, 0.5); 6], -1.0);
        assert!(plot.points.iter().all(|point| (point.x, point.y) == (plot.points[0].x, plot.points[0].y)));
        let labelled = plot.points.iter().filter(|point| point.text.is_some()).count();
        assert!(labelled < 6, "{labelled} labels over each other");
    }

    #[test]
    fn no_error_is_marked_at_the_foot() {
        let plot = plot(&[(5.0, 0.0), (9.0, 0.2)], -1.0);
        assert!(plot.points[0].is_zero && !plot.points[1].is_zero);
        assert_eq!(plot.points[0].y, AREA[3]);
        let zeros = super::scatter(&samples(&[(1.0, 0.0), (2.0, 0.0)]), -1.0, "t", "e");
        assert!(zeros.guide.is_none() && zeros.points.iter().all(|point| point.y == AREA[3]));
        assert!(plot.frame.alt.contains("run 0: 5.00 ms, error 0"));
    }

    #[test]
    fn a_line_runs_from_edge_to_edge_and_a_single_value_is_a_dot() {
        let plot = line(&[(0.0, 0.5), (1.0, 1.0), (4.0, 0.0)], "frame", "rms");
        assert_eq!(plot.points, format!("{},{} 155,{} {},{}", AREA[0], (AREA[1] + AREA[3]) / 2.0, AREA[1], AREA[2], AREA[3]));
        assert!(plot.dot.is_none());
        assert!(line(&[(3.0, 0.5)], "frame", "rms").dot.is_some());
    }
}
