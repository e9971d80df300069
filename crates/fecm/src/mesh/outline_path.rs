//! Points of a tooth's outline by arc length.

use gear_geom::{HalfToothOutline, OutlineSegment};
use nalgebra::Point2;

/// Point of the flank at an involute arc length between the first and last break.
pub(super) fn flank_point_at_arc(outline: &HalfToothOutline, base: f64, breaks: &[f64], arc: f64) -> Point2<f64> {
    let roll = |arc: f64| (2.0 * base * arc.max(0.0)).sqrt();
    let (start, end) = (roll(breaks[0]), roll(breaks[breaks.len() - 1]));
    outline.point(OutlineSegment::Flank, ((roll(arc) - start) / (end - start)).clamp(0.0, 1.0))
}

/// Consecutive pieces of the outline, walked by arc length.
pub(super) struct OutlinePath<'a> {
    outline: &'a HalfToothOutline,
    /// Fraction of the length, segment, parameter: ascending.
    table: Vec<(f64, OutlineSegment, f64)>,
}

impl<'a> OutlinePath<'a> {
    /// Pieces `(segment, from, to)`; each starts where the one before ends.
    pub fn new(outline: &'a HalfToothOutline, pieces: &[(OutlineSegment, f64, f64)]) -> Self {
        const SAMPLES: usize = 64;
        let mut table = Vec::new();
        let mut length = 0.0;
        for &(segment, from, to) in pieces {
            let mut last = outline.point(segment, from);
            table.push((length, segment, from));
            for k in 1..=SAMPLES {
                let u = from + (to - from) * k as f64 / SAMPLES as f64;
                let point = outline.point(segment, u);
                length += (point - last).norm();
                table.push((length, segment, u));
                last = point;
            }
        }
        for entry in &mut table {
            entry.0 /= length;
        }
        Self { outline, table }
    }

    /// Segment and parameter at a fraction of the length.
    pub fn locate(&self, fraction: f64) -> (OutlineSegment, f64) {
        let next = self.table.partition_point(|entry| entry.0 < fraction).clamp(1, self.table.len() - 1);
        let ((a, _, u), (b, segment, v)) = (self.table[next - 1], self.table[next]);
        let same = self.table[next - 1].1 == segment;
        if !same || b <= a {
            return (segment, v);
        }
        (segment, u + (v - u) * ((fraction - a) / (b - a)).clamp(0.0, 1.0))
    }

    /// Point at a fraction of the length.
    pub fn point(&self, fraction: f64) -> Point2<f64> {
        let (segment, u) = self.locate(fraction);
        self.outline.point(segment, u)
    }
}
