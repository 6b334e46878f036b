//! Axes of plots: places of values and ticks.

use serde::Serialize;

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Linear, from 0 or the smallest value on.
    Linear,
    /// Logarithmic; values that are not over 0 are at the low end.
    Log,
}

/// A map from a range of values to a range of pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    scale: Scale,
    /// Ends of the range, as values or as their decimal logarithms.
    low: f64,
    high: f64,
    /// Pixels of the low end and of the high end.
    pixels: [f64; 2],
}

/// A tick with its label.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tick {
    /// Place, pixels.
    pub at: f64,
    pub label: String,
}

/// Margin beyond the outermost values, as a part of their range.
const MARGIN: f64 = 0.08;
/// Least range of a logarithmic axis, in powers of ten; equal values are in its middle.
const SHORTEST_LOG: f64 = 0.7;
const MOST_TICKS: usize = 8;

impl Axis {
    /// A logarithmic axis over all of these values.
    pub fn log(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let logs: Vec<f64> = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10).collect();
        let (low, high) = bounds(&logs).unwrap_or((0.0, 0.0));
        let margin = ((high - low) * MARGIN).max((SHORTEST_LOG - (high - low)) / 2.0);
        Self { scale: Scale::Log, low: low - margin, high: high + margin, pixels }
    }

    /// A linear axis from `low`, or the smallest value if it is less, to the largest value.
    pub fn linear(low: Option<f64>, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let values: Vec<f64> = values.chain(low).filter(|value| value.is_finite()).collect();
        let (low, high) = bounds(&values).unwrap_or((0.0, 1.0));
        Self { scale: Scale::Linear, low, high: if high > low { high } else { low + 1.0 }, pixels }
    }

    /// Place of a value, pixels.
    pub fn at(&self, value: f64) -> f64 {
        let value = match self.scale {
            Scale::Linear => value,
            Scale::Log if value > 0.0 => value.log10(),
            Scale::Log => self.low,
        };
        round(self.pixels[0] + (value - self.low) / (self.high - self.low) * (self.pixels[1] - self.pixels[0]))
    }

    /// Decimal logarithms of the ends of a logarithmic axis.
    pub fn logs(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Ticks at round values.
    pub fn ticks(&self) -> Vec<Tick> {
        let values = match self.scale {
            Scale::Linear => self.linear_ticks(),
            Scale::Log => self.log_ticks(),
        };
        values.into_iter().map(|(value, label)| Tick { at: self.at(value), label }).collect()
    }

    fn linear_ticks(&self) -> Vec<(f64, String)> {
        let rough = (self.high - self.low) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * power >= rough * 0.999).unwrap_or(10.0);
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let (first, last) = ((self.low / step - 1e-9).ceil() as i64, (self.high / step + 1e-9).floor() as i64);
        (first..=last).map(|i| (i as f64 * step, format!("{:.decimals$}", i as f64 * step))).collect()
    }

    /// Ticks at powers of ten if at least three fit; otherwise at 1, 2 and 5 times a power, otherwise at 1 to 9 times.
    fn log_ticks(&self) -> Vec<(f64, String)> {
        let powers = self.low.floor() as i32..=self.high.ceil() as i32;
        let among = |digits: &[u32]| -> Vec<(u32, i32)> {
            let all = powers.clone().flat_map(|power| digits.iter().map(move |digit| (*digit, power)));
            all.filter(|(digit, power)| (self.low..=self.high).contains(&(f64::from(*digit).log10() + f64::from(*power)))).collect()
        };
        let sets: [&[u32]; 3] = [&[1], &[1, 2, 5], &[1, 2, 3, 4, 5, 6, 7, 8, 9]];
        let found = sets.iter().map(|digits| among(digits)).find(|ticks| ticks.len() >= 3).unwrap_or_else(|| among(sets[2]));
        // A range of many powers shows only every second or third of them.
        let every = found.len().div_ceil(MOST_TICKS).max(1);
        let shown = found.into_iter().filter(|(digit, power)| *digit != 1 || every == 1 || power.rem_euclid(every as i32) == 0);
        shown.map(|(digit, power)| (f64::from(digit) * 10_f64.powi(power), decimal(digit, power))).collect()
    }
}

fn bounds(values: &[f64]) -> Option<(f64, f64)> {
    Some((values.iter().copied().reduce(f64::min)?, values.iter().copied().reduce(f64::max)?))
}

/// Rounds to a tenth of a pixel, to keep the page small.
pub fn round(pixels: f64) -> f64 {
    (pixels * 10.0).round() / 10.0
}

/// `digit` times ten to the `power`, in the usual notation.
fn decimal(digit: u32, power: i32) -> String {
    match power {
        0..=4 => format!("{digit}{}", "0".repeat(power as usize)),
        -4..=-1 => format!("0.{}{digit}", "0".repeat((-power - 1) as usize)),
        _ => {
            let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize]);
            let raised: String = power.to_string().chars().map(raise).collect();
            if digit == 1 { format!("10{raised}") } else { format!("{digit}·10{raised}") }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|tick| tick.label).collect()
    }

    fn log(values: &[f64]) -> Axis {
        Axis::log(values.iter().copied(), [0.0, 100.0])
    }

    #[test]
    fn ticks_of_a_log_axis_are_as_coarse_as_the_range_is_long() {
        assert_eq!(labels(log(&[0.9, 1100.0])), ["1", "10", "100", "1000"]);
        assert_eq!(labels(log(&[9.0, 210.0])), ["10", "20", "50", "100", "200"]);
        assert_eq!(labels(log(&[0.021, 0.043])), ["0.02", "0.03", "0.04", "0.05", "0.06"]);
        assert_eq!(labels(log(&[1e-12, 1e9])), ["10⁻¹²", "10⁻⁹", "10⁻⁶", "0.001", "1", "1000", "10⁶", "10⁹"]);
        assert_eq!(labels(log(&[2e5, 2e6])), ["2·10⁵", "5·10⁵", "10⁶", "2·10⁶"]);
    }

    #[test]
    fn a_value_alone_lies_in_the_middle_and_has_ticks_about_it() {
        for value in [1e-9, 0.37, 1.0, 12345.0] {
            let axis = log(&[value, value]);
            assert!((axis.at(value) - 50.0).abs() < 0.06, "{value}: {}", axis.at(value));
            let ticks = axis.ticks();
            assert!((2..=MOST_TICKS).contains(&ticks.len()), "{value}: {ticks:?}");
            assert!(ticks.iter().all(|tick| (0.0..=100.0).contains(&tick.at)), "{ticks:?}");
        }
    }

    #[test]
    fn zero_lies_at_the_low_end_of_a_log_axis_and_sets_no_range() {
        let axis = log(&[0.0, 1.0, 10.0]);
        assert_eq!((axis.at(0.0), axis), (0.0, log(&[1.0, 10.0])));
        // An axis exists for zeros alone too.
        let zeros = log(&[0.0, 0.0]);
        assert_eq!(zeros.at(0.0), 0.0);
        assert!(zeros.ticks().len() >= 2);
    }

    #[test]
    fn ticks_of_a_linear_axis_are_round() {
        let linear = |low, values: &[f64]| Axis::linear(low, values.iter().copied(), [100.0, 0.0]);
        assert_eq!(labels(linear(Some(0.0), &[0.9, 0.2])), ["0.0", "0.2", "0.4", "0.6", "0.8"]);
        assert_eq!(labels(linear(None, &[3.0, 12.0])), ["4", "6", "8", "10", "12"]);
        let zeros = linear(Some(0.0), &[0.0]);
        assert_eq!((zeros.at(0.0), labels(zeros).len()), (100.0, 6));
        assert!(labels(linear(Some(0.0), &[])).len() > 1);
    }
}
