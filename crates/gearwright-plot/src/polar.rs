//! Quantities over the angles of sensors about the housing, as in D5.9 and D6.8 (there the natural logarithm of FM4).

use super::{Line, PolarChart};

/// What is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity<'a> {
    /// Its name.
    pub name: String,
    /// What it is of.
    pub of: String,
    /// Its unit; empty for none.
    pub unit: &'a str,
    /// Whether powers of a thousand may be taken out; not so for logarithms.
    pub rescaled: bool,
}

/// Points of angle (degrees) and radius in order, the first once more a turn later.
pub fn closed(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = points.map(|(angle, radius)| (angle.rem_euclid(360.0), radius)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.extend(points.first().copied().map(|(angle, radius)| (angle + 360.0, radius)));
    points
}

/// Points between two of a line at most a degree apart, so that a limit common to all sensors is a circle.
#[must_use]
pub fn rounded(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for pair in points.windows(2) {
        let steps = (pair[1].0 - pair[0].0).ceil().max(1.0);
        for k in 0..steps as usize {
            let u = k as f64 / steps;
            found.push((pair[0].0 + u * (pair[1].0 - pair[0].0), pair[0].1 + u * (pair[1].1 - pair[0].1)));
        }
    }
    found.extend(points.last());
    found
}

/// A chart of lines about the housing with a rim that has short labels; `None` where no line has points.
#[must_use]
pub fn about_housing(title: &str, quantity: &Quantity<'_>, mut lines: Vec<Line>) -> Option<PolarChart> {
    lines.retain(|line| line.points.len() > 2);
    if lines.is_empty() {
        return None;
    }
    let radii = || lines.iter().flat_map(|line| &line.points).map(|point| point.1);
    let (low, high) = (radii().fold(f64::INFINITY, f64::min), radii().fold(f64::NEG_INFINITY, f64::max));
    // logarithms may be negative: the centre lies below them all
    let centre = if low < 0.0 { low.floor() } else { 0.0 };
    let rim = round_up(high - centre) + centre;
    // rings have labels of few decimals
    let exponent = if (0.1..1e4).contains(&rim.abs()) { 0 } else { 3 * (rim.abs().log10() / 3.0).floor() as i32 };
    let scale = 10_f64.powi(-exponent);
    lines.iter_mut().flat_map(|line| &mut line.points).for_each(|point| point.1 *= scale);
    let unit = match (quantity.unit, exponent) {
        _ if !quantity.rescaled => String::new(),
        ("", 0) => String::new(),
        ("", power) => format!(" (1e{power})"),
        (unit, 0) => format!(" ({unit})"),
        (unit, power) => format!(" (1e{power} {unit})"),
    };
    let what = format!("{} {}{unit} about the housing", quantity.name, quantity.of);
    let title = if title.is_empty() { what } else { format!("{title}: {what}") };
    Some(PolarChart { title, lines, radii: (centre * scale, rim * scale) })
}

/// The next number with short labels on four rings up to it.
fn round_up(value: f64) -> f64 {
    if !(value > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powi(value.log10().floor() as i32);
    [1.0, 1.2, 1.6, 2.0, 4.0, 6.0, 8.0].iter().map(|f| f * power).find(|rim| *rim >= value).unwrap_or(10.0 * power)
}
