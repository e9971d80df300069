//! Where a root crack starts and runs: the chord below a tooth, from fillet to fillet, of which a crack takes a part.
//!
//! Without a crack, and for one along the chord, it is a cubic that leaves and reaches the fillets in thirds of their half turn. A crack with a path of its own is
//! followed up to its tip, and such a cubic leads on to the other fillet. Points of a path are joined by a centripetal Catmull-Rom curve (E. Catmull,
//! R. Rom, 1974; P. J. Barry, R. N. Goldman, SIGGRAPH 1988), which has no corners, so elements along it stay smooth.

use std::f64::consts::FRAC_PI_3;

use gear_geom::{CrackLength, CrackPath, CrackStart, HalfToothOutline, OutlineSegment, RootCrack};
use nalgebra::{Point2, Rotation2, Vector2};

use crate::error::FecmError;

/// A fillet's point at which tooth, body and root land meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Junction {
    pub point: Point2<f64>,
    /// Tangent of the outline, toward the tip.
    pub up: Vector2<f64>,
    /// +1 for the half at `theta > 0`.
    pub sign: f64,
}

/// Curve from the first junction to the second. Parameters are fractions of its length.
pub(super) struct ChordPath {
    /// Length fraction and point, ascending.
    table: Vec<(f64, Point2<f64>)>,
    /// Length fraction of the crack's tip from the first junction.
    pub crack_tip: Option<f64>,
    pub crack_length: f64,
    pub chord_length: f64,
    /// Whether the crack starts at the first junction.
    pub from_first: bool,
}

/// Largest part of the chord that a crack may take: what is left must carry the tooth.
const LONGEST_CRACK: f64 = 0.97;
/// Part of the chord that the tip of a crack with its own path must leave to the other fillet.
const LEAST_REST: f64 = 0.02;

impl ChordPath {
    pub fn new(
        crack: Option<&RootCrack>,
        first: &Junction,
        second: &Junction,
        outward: f64,
    ) -> Result<Self, FecmError> {
        let bend_direction = |at: &Junction| Rotation2::new(-outward * at.sign * FRAC_PI_3) * at.up;
        let (a, b) = (first.point, second.point);
        let (from_a, from_b) = (bend_direction(first), bend_direction(second));
        let chord = cubic(a, from_a, from_b, b);
        let chord_length = polyline_length(&chord);
        let Some(crack) = crack else {
            let table = by_length(&chord);
            return Ok(Self { table, crack_tip: None, crack_length: 0.0, chord_length, from_first: true });
        };
        let from_first = crack.side.sign() == first.sign;
        let (start, end, end_direction) = if from_first { (a, b, from_b) } else { (b, a, from_a) };
        let side = crack.side.sign();
        let place = |[across, inward]: [f64; 2]| start + Vector2::new(-outward * inward, -side * across);
        let through = match &crack.path {
            CrackPath::Through(points) => Some(curve_through(start, points, place)?),
            CrackPath::Chord | CrackPath::Straight(_) => None,
        };
        let length = match crack.length {
            CrackLength::Chord(fraction) => fraction * chord_length,
            CrackLength::Path(fraction) => fraction * through.as_deref().map_or(chord_length, polyline_length),
            CrackLength::Length(length) => length,
        };
        if !(length > 0.0 && length <= LONGEST_CRACK * chord_length) {
            let most = LONGEST_CRACK * chord_length;
            let allowed = format!("0 to {most:.4e} m: 97 % of the chord below the tooth");
            return Err(FecmError::Crack { what: "length (m)", value: length, allowed });
        }
        let own = match (&crack.path, through) {
            (CrackPath::Straight(angle), _) => {
                let at = |k: u32| place([angle.sin(), angle.cos()].map(|part| part * length * f64::from(k) / 64.0));
                Some((0..=64).map(at).collect())
            }
            (_, Some(curve)) => Some(first_part(curve, length)?),
            _ => None,
        };
        let mut points = match own {
            None if from_first => chord,
            None => chord.into_iter().rev().collect(),
            Some(mut points) => {
                stays_inside(&points, side, end, LEAST_REST * chord_length)?;
                let (tip, before) = (points[points.len() - 1], points[points.len() - 2]);
                points.pop();
                points.extend(cubic(tip, tip - before, end_direction, end));
                points
            }
        };
        let tip = length / polyline_length(&points);
        if !from_first {
            points.reverse();
        }
        let crack_tip = Some(if from_first { tip } else { 1.0 - tip });
        Ok(Self { table: by_length(&points), crack_tip, crack_length: length, chord_length, from_first })
    }

    pub fn point(&self, t: f64) -> Point2<f64> {
        let next = self.table.partition_point(|entry| entry.0 < t).clamp(1, self.table.len() - 1);
        let ((s0, p0), (s1, p1)) = (self.table[next - 1], self.table[next]);
        p0 + (p1 - p0) * ((t - s0) / (s1 - s0)).clamp(0.0, 1.0)
    }
}

/// The path of a crack through points, finely sampled from its start.
fn curve_through(
    start: Point2<f64>,
    points: &[[f64; 2]],
    place: impl Fn([f64; 2]) -> Point2<f64>,
) -> Result<Vec<Point2<f64>>, FecmError> {
    let fault = |value: f64, allowed: &str| {
        Err(FecmError::Crack { what: "point of the path (m)", value, allowed: allowed.to_owned() })
    };
    if let Some(value) = points.iter().flatten().find(|value| !value.is_finite()) {
        return fault(*value, "a number of metres");
    }
    let mut corners = vec![start];
    corners.extend(points.iter().map(|&point| place(point)));
    if corners.len() < 2 {
        return fault(0.0, "one point or more");
    }
    if let Some(k) = (1..corners.len()).find(|&k| corners[k] == corners[k - 1]) {
        return fault(points[k - 1][0], "points that differ from the one before and from the start");
    }
    Ok(smooth(&corners))
}

/// The first part of a path, of a length.
fn first_part(path: Vec<Point2<f64>>, length: f64) -> Result<Vec<Point2<f64>>, FecmError> {
    let whole = polyline_length(&path);
    if length > whole * (1.0 + 1e-12) {
        let allowed = format!("0 to {whole:.4e} m: the length of the path");
        return Err(FecmError::Crack { what: "length (m)", value: length, allowed });
    }
    let mut part = vec![path[0]];
    let mut left = length;
    for pair in path.windows(2) {
        let step = (pair[1] - pair[0]).norm();
        if step >= left {
            part.push(pair[0] + (pair[1] - pair[0]) * (left / step));
            return Ok(part);
        }
        left -= step;
        part.push(pair[1]);
    }
    Ok(part)
}

/// A crack must run on from its flank toward the other, and leave something before that.
fn stays_inside(points: &[Point2<f64>], side: f64, end: Point2<f64>, rest: f64) -> Result<(), FecmError> {
    let tip = points[points.len() - 1];
    let runs_on = points.windows(2).all(|pair| side * (pair[0].y - pair[1].y) > 0.0);
    if runs_on && side * (tip.y - end.y) > rest {
        return Ok(());
    }
    let allowed = "a path and length that run toward the other flank and stay inside the tooth".to_owned();
    Err(FecmError::Crack { what: "place of the tip across the tooth (m)", value: tip.y, allowed })
}

/// Parameter of the fillet at which a crack starts; `None`: the middle of its turn.
pub(super) fn mouth_on_fillet(outline: &HalfToothOutline, start: CrackStart) -> Result<Option<f64>, FecmError> {
    let tangent = |u: f64| outline.tangent(OutlineSegment::Fillet, u).x.abs().min(1.0).acos();
    let radius = |u: f64| outline.point(OutlineSegment::Fillet, u).coords.norm();
    match start {
        CrackStart::MiddleOfFillet => Ok(None),
        // from the root land (a right angle) to the flank the tangent turns toward the centre line
        CrackStart::Tangent(angle) => along_fillet(tangent, angle, "tangent angle at the start (rad)", "rad").map(Some),
        CrackStart::Radius(value) => along_fillet(radius, value, "radius at the start (m)", "m").map(Some),
    }
}

/// Parameter of the fillet where a monotonic measure has a value.
fn along_fillet(
    measure: impl Fn(f64) -> f64,
    value: f64,
    what: &'static str,
    unit: &'static str,
) -> Result<f64, FecmError> {
    let (mut low, mut high) = (0.02, 0.98);
    let (at_low, at_high) = (measure(low), measure(high));
    let (least, most) = (at_low.min(at_high), at_low.max(at_high));
    if !(value > least && value < most) {
        let allowed = format!("{least:.6} to {most:.6} {unit}: the range of this fillet");
        return Err(FecmError::Crack { what, value, allowed });
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (measure(middle) > value) == (at_low > at_high) { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// Finely sampled cubic from `a` along `from_a` to `b`, where `from_b` points back into the curve.
fn cubic(a: Point2<f64>, from_a: Vector2<f64>, from_b: Vector2<f64>, b: Point2<f64>) -> Vec<Point2<f64>> {
    const SAMPLES: u32 = 2000;
    let reach = (b - a).norm() / 3.0;
    let (a_bend, b_bend) = (a + from_a.normalize() * reach, b + from_b.normalize() * reach);
    let at = |t: f64| {
        let s = 1.0 - t;
        Point2::from(
            a.coords * (s * s * s)
                + a_bend.coords * (3.0 * s * s * t)
                + b_bend.coords * (3.0 * s * t * t)
                + b.coords * (t * t * t),
        )
    };
    (0..=SAMPLES).map(|k| at(f64::from(k) / f64::from(SAMPLES))).collect()
}

/// Finely sampled centripetal Catmull-Rom curve through points, no two neighbours alike.
fn smooth(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    const SAMPLES: u32 = 500;
    let last = points.len() - 1;
    if last < 2 {
        return points.to_vec();
    }
    let mut curve = vec![points[0]];
    for k in 0..last {
        let (b, c) = (points[k], points[k + 1]);
        // beyond the ends the curve goes on as it came
        let a = if k > 0 { points[k - 1] } else { b + (b - c) };
        let d = if k + 1 < last { points[k + 2] } else { c + (c - b) };
        let knot = |from: Point2<f64>, to: Point2<f64>| (to - from).norm().sqrt();
        let (ab, bc, cd) = (knot(a, b), knot(b, c), knot(c, d));
        // slopes by the chord parameter of the middle stretch
        let slope = |before: Vector2<f64>, after: Vector2<f64>, h: f64, g: f64| {
            (before / h - (before + after) / (h + g) + after / g) * bc
        };
        let (from, to) = (slope(b - a, c - b, ab, bc), slope(c - b, d - c, bc, cd));
        for j in 1..=SAMPLES {
            let t = f64::from(j) / f64::from(SAMPLES);
            let (t2, t3) = (t * t, t * t * t);
            curve.push(Point2::from(
                b.coords * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + from * (t3 - 2.0 * t2 + t)
                    + c.coords * (3.0 * t2 - 2.0 * t3)
                    + to * (t3 - t2),
            ));
        }
    }
    curve
}

pub(super) fn polyline_length(points: &[Point2<f64>]) -> f64 {
    points.windows(2).map(|p| (p[1] - p[0]).norm()).sum()
}

/// Points with their fraction of the length.
fn by_length(points: &[Point2<f64>]) -> Vec<(f64, Point2<f64>)> {
    let total = polyline_length(points);
    let mut sum = 0.0;
    let mut table = vec![(0.0, points[0])];
    for pair in points.windows(2) {
        sum += (pair[1] - pair[0]).norm();
        table.push((sum / total, pair[1]));
    }
    table
}
