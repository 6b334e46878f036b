//! Formatting of figures.

/// Three digits; small figures keep an exponent instead of becoming 0: `0.0123`, `41.7`, `2130`, `3.2e-5`.
pub fn short(figure: f64) -> String {
    if figure == 0.0 {
        return "0".to_owned();
    }
    let magnitude = figure.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{figure:.1e}");
    }
    format!("{figure:.*}", decimals(figure.abs()))
}

/// The figures of a column with equal decimals, so that they line up: as many as the largest needs for three digits. A figure
/// that would round to 0 is shown as less than the smallest that fits.
pub fn column(figures: &[Option<f64>]) -> Vec<Option<String>> {
    let largest = figures.iter().flatten().map(|figure| figure.abs()).fold(0.0, f64::max);
    let decimals = decimals(largest).max(1);
    let text = |figure: f64| {
        let text = format!("{figure:.decimals$}");
        let vanishes = figure > 0.0 && text.chars().all(|c| "0.".contains(c));
        if vanishes { format!("<{:.decimals$}", 10_f64.powi(-(decimals as i32))) } else { text }
    };
    figures.iter().map(|figure| figure.map(text)).collect()
}

/// Decimals for three digits.
fn decimals(figure: f64) -> usize {
    // A number that rounds up to the next power of ten gets one digit more.
    if figure > 0.0 { (2.0 - (figure * 1.0005).log10().floor()).clamp(0.0, 6.0) as usize } else { 0 }
}

/// Bytes in the unit that leaves one to three digits before the point.
pub fn bytes(count: f64) -> String {
    let unit = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count;
    let mut step = 0;
    while value.abs() >= 1024.0 && step + 1 < unit.len() {
        value /= 1024.0;
        step += 1;
    }
    let text = if step == 0 { format!("{value}") } else { short(value) };
    format!("{text} {}", unit[step])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits() {
        let cases = [
            (0.0, "0"),
            (0.012_345, "0.0123"),
            (41.66, "41.7"),
            (2130.4, "2130"),
            (9.999, "10.0"),
            (0.000_032, "3.2e-5"),
            (2e9, "2.0e9"),
            (-1.5, "-1.50"),
        ];
        for (figure, expected) in cases {
            assert_eq!(short(figure), expected);
        }
    }

    #[test]
    fn a_column_lines_up_and_hides_nothing_behind_a_zero() {
        let some = |list: &[&str]| list.iter().map(|text| Some((*text).to_owned())).collect::<Vec<_>>();
        assert_eq!(column(&[Some(123.4), Some(5.0), Some(0.01), Some(0.0)]), some(&["123.4", "5.0", "<0.1", "0.0"]));
        assert_eq!(column(&[Some(1.234), None, Some(0.5)]), [Some("1.23".to_owned()), None, Some("0.50".to_owned())]);
        assert!(column(&[]).is_empty());
    }

    #[test]
    fn bytes_have_a_unit_that_fits() {
        for (count, expected) in [(12.0, "12 B"), (1536.0, "1.50 KiB"), (104_857_600.0, "100 MiB")] {
            assert_eq!(bytes(count), expected);
        }
    }
}
