//! Force over approach at one position of the mesh cycle.
//!
//! Knots `(x_i, F_i, k_i = dF/dx)` of the contact problem at ascending loads, joined by cubics with these slopes (Hermite), slopes limited to
//! three times the secants beside them, which keeps cubics monotone (F. N. Fritsch, R. E. Carlson, *SIAM J. Numer. Anal.* 17 (1980) 238-246).
//! From first touch `x_0` to the first knot a power, `F = F_1 ((x - x_0) / (x_1 - x_0))^p` with `p = k_1 (x_1 - x_0) / F_1 >= 1`, as of Hertz's contacts (`3/2` for points, a little
//! over 1 for lines); above the last knot a straight line.

use serde::{Deserialize, Serialize};

use super::error::MeshError;
use super::law::MeshResponse;

/// The mesh at one load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceKnot {
    /// Approach (m).
    pub approach: f64,
    /// Force (N).
    pub force: f64,
    /// Its derivative (N/m).
    pub stiffness: f64,
    /// Forces of tooth pairs (N), by number; pair 0 touches at the pitch point at mesh cycle 0 of the curve's own cycle.
    pub pairs: Vec<(i32, f64)>,
}

/// What a curve is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceCurveData {
    /// Approach of first touch (m).
    pub touch: f64,
    /// Knots, ascending.
    pub knots: Vec<ForceKnot>,
}

/// Force over approach at one position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ForceCurveData", into = "ForceCurveData")]
pub struct ForceCurve {
    data: ForceCurveData,
    /// Slopes at the knots after limiting (N/m).
    slopes: Vec<f64>,
}

impl TryFrom<ForceCurveData> for ForceCurve {
    type Error = MeshError;

    fn try_from(data: ForceCurveData) -> Result<Self, MeshError> {
        Self::new(data)
    }
}

impl From<ForceCurve> for ForceCurveData {
    fn from(curve: ForceCurve) -> Self {
        curve.data
    }
}

impl ForceCurve {
    /// Checks knots and joins them.
    ///
    /// # Errors
    /// [`MeshError::Knot`] for one that is not above the one before (or the touch) in approach and force, or without positive stiffness;
    /// [`MeshError::Option`] for none at all.
    pub fn new(data: ForceCurveData) -> Result<Self, MeshError> {
        let ForceCurveData { touch, knots } = &data;
        if knots.is_empty() || !touch.is_finite() {
            let value = if knots.is_empty() { 0.0 } else { *touch };
            return Err(MeshError::Option {
                name: "knots, touch",
                value,
                allowed: "at least one knot, finite numbers",
            });
        }
        let mut before = (*touch, 0.0);
        for (knot, &ForceKnot { approach, force, stiffness, .. }) in knots.iter().enumerate() {
            let ascends = approach > before.0 && force > before.1 && stiffness > 0.0;
            if !(ascends && approach.is_finite() && force.is_finite() && stiffness.is_finite()) {
                return Err(MeshError::Knot { knot, approach, force, stiffness, touch: *touch });
            }
            before = (approach, force);
        }
        let secant = |a: &ForceKnot, b: &ForceKnot| (b.force - a.force) / (b.approach - a.approach);
        let slopes = (0..knots.len())
            .map(|i| {
                let below = i.checked_sub(1).map(|before| secant(&knots[before], &knots[i]));
                let above = knots.get(i + 1).map(|after| secant(&knots[i], after));
                below.into_iter().chain(above).fold(knots[i].stiffness, |slope, secant| slope.min(3.0 * secant))
            })
            .collect();
        Ok(Self { data, slopes })
    }

    /// What it is made of.
    #[must_use]
    pub fn data(&self) -> &ForceCurveData {
        &self.data
    }

    /// Force and stiffness at an approach (m).
    #[must_use]
    pub fn response(&self, approach: f64) -> MeshResponse {
        let ForceCurveData { touch, knots } = &self.data;
        let above = knots.partition_point(|knot| knot.approach <= approach);
        if !(approach > *touch) {
            return MeshResponse::default();
        }
        if above == 0 {
            let first = &knots[0];
            let (span, part) = (first.approach - touch, (approach - touch) / (first.approach - touch));
            let power = (self.slopes[0] * span / first.force).max(1.0);
            let force = first.force * part.powf(power);
            return MeshResponse { force, stiffness: power * force / (approach - touch) };
        }
        let (from, k_0) = (&knots[above - 1], self.slopes[above - 1]);
        let Some(to) = knots.get(above) else {
            return MeshResponse { force: from.force + k_0 * (approach - from.approach), stiffness: k_0 };
        };
        let k_1 = self.slopes[above];
        let width = to.approach - from.approach;
        let t = (approach - from.approach) / width;
        let secant = (to.force - from.force) / width;
        // F = F_0 + h t (k_0 + t (3 s - 2 k_0 - k_1 + t (k_0 + k_1 - 2 s)))
        let (b, c) = (3.0 * secant - 2.0 * k_0 - k_1, k_0 + k_1 - 2.0 * secant);
        let force = from.force + width * t * (k_0 + t * (b + t * c));
        let stiffness = (k_0 + t * (2.0 * b + t * 3.0 * c)).max(0.0);
        MeshResponse { force, stiffness }
    }

    /// Approach (m) at which the curve has a force (N), by bisection; that of first touch for none.
    #[must_use]
    pub fn approach_of(&self, force: f64) -> f64 {
        let ForceCurveData { touch, knots } = &self.data;
        let above = knots.partition_point(|knot| knot.force < force);
        let mut low = above.checked_sub(1).map_or(*touch, |below| knots[below].approach);
        let Some(mut high) = knots.get(above).map(|knot| knot.approach) else {
            let (last, slope) = (&knots[knots.len() - 1], self.slopes[knots.len() - 1]);
            return last.approach + (force - last.force) / slope;
        };
        while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            *(if self.response(middle).force < force { &mut low } else { &mut high }) = middle;
        }
        high
    }

    /// The curve with deflections larger by a fraction, above -1, and pairs counted on.
    ///
    /// # Errors
    /// [`MeshError::Knot`] for a fraction that is not above -1.
    pub fn stretched(&self, fraction: f64, shift: i32) -> Result<Self, MeshError> {
        let touch = self.data.touch;
        let knots = self.data.knots.iter().map(|knot| ForceKnot {
            approach: touch + (knot.approach - touch) * (1.0 + fraction),
            force: knot.force,
            stiffness: knot.stiffness / (1.0 + fraction),
            pairs: knot.pairs.iter().map(|&(pair, force)| (pair.saturating_add(shift), force)).collect(),
        });
        Self::new(ForceCurveData { touch, knots: knots.collect() })
    }

    /// Normal forces of the tooth pairs at an approach (N): parts of [`Self::response`]'s force, between those of the knots beside. Their sum is that
    /// force but for lever arms: tips in corner contact press not quite along the line of action (some 1e-4).
    #[must_use]
    pub fn pair_forces(&self, approach: f64) -> Vec<(i32, f64)> {
        let force = self.response(approach).force;
        if !(force > 0.0) {
            return Vec::new();
        }
        let knots = &self.data.knots;
        let above = knots.partition_point(|knot| knot.force <= force).min(knots.len() - 1);
        let below = above.saturating_sub(1);
        let (low, high) = (&knots[below], &knots[above]);
        let part = if above > below { ((force - low.force) / (high.force - low.force)).clamp(0.0, 1.0) } else { 0.0 };
        let share = |knot: &ForceKnot, pair: i32| {
            knot.pairs.iter().find(|(own, _)| *own == pair).map_or(0.0, |(_, own)| own / knot.force)
        };
        let mut pairs: Vec<i32> = low.pairs.iter().chain(&high.pairs).map(|(pair, _)| *pair).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
            .into_iter()
            .map(|pair| (pair, force * (share(low, pair) * (1.0 - part) + share(high, pair) * part)))
            .filter(|(_, force)| *force > 0.0)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(approach: f64, force: f64, stiffness: f64) -> ForceKnot {
        ForceKnot { approach, force, stiffness, pairs: vec![(0, 0.25 * force), (1, 0.75 * force)] }
    }

    /// A power law is its own power below the first knot; cubics meet values and slopes; a line follows above.
    #[test]
    fn analytic_power_law() {
        let at = |x: f64| (1e9 * x.powf(1.5), 1.5e9 * x.sqrt());
        let knots = [1e-6, 2e-6, 4e-6, 8e-6].map(|x| knot(x + 3e-6, at(x).0, at(x).1));
        let curve = ForceCurve::new(ForceCurveData { touch: 3e-6, knots: knots.to_vec() }).unwrap();
        for (x, tolerance) in
            [(1e-8, 1e-13), (0.7e-6, 1e-13), (2e-6, 1e-13), (1.5e-6, 1e-3), (3e-6, 1e-3), (6e-6, 1e-3)]
        {
            let (force, stiffness) = at(x);
            let answer = curve.response(x + 3e-6);
            assert!((answer.force / force - 1.0).abs() < tolerance, "{x}: {answer:?}, {force}");
            assert!((answer.stiffness / stiffness - 1.0).abs() < 10.0 * tolerance, "{x}: {answer:?}, {stiffness}");
        }
        let (force, stiffness) = at(8e-6);
        let beyond = curve.response(20e-6);
        assert!((beyond.force / (force + stiffness * 9e-6) - 1.0).abs() < 1e-13);
        assert_eq!((curve.response(3e-6), curve.response(-1.0)), Default::default());
        let softer = curve.stretched(0.25, 3).unwrap();
        let (answer, other) = (curve.response(5e-6), softer.response(3e-6 + 1.25 * 2e-6));
        assert!((other.force / answer.force - 1.0).abs() < 1e-12 && softer.pair_forces(5e-6)[0].0 == 3);
        assert!((other.stiffness * 1.25 / answer.stiffness - 1.0).abs() < 1e-12 && curve.stretched(-1.0, 0).is_err());
        let pairs = curve.pair_forces(5.5e-6);
        let sum: f64 = pairs.iter().map(|(_, force)| force).sum();
        assert!((sum / curve.response(5.5e-6).force - 1.0).abs() < 1e-12 && pairs.len() == 2);
    }

    /// Force never falls and stiffness is its derivative, also beside a kink.
    #[test]
    fn invariant_monotone() {
        let knots = vec![knot(1e-6, 400.0, 4.1e8), knot(3e-6, 1210.0, 9e8), knot(5e-6, 3010.0, 9.1e8)];
        let curve = ForceCurve::new(ForceCurveData { touch: 0.0, knots }).unwrap();
        let mut before = 0.0;
        for i in 1..7000 {
            let x = f64::from(i) * 1e-9;
            let answer = curve.response(x);
            assert!(answer.force >= before && answer.stiffness >= 0.0);
            before = answer.force;
            let step = 1e-12;
            let slope = (curve.response(x + step).force - curve.response(x - step).force) / (2.0 * step);
            assert!((slope - answer.stiffness).abs() < 1e-3 * answer.stiffness, "{x}: {slope} {answer:?}");
        }
    }

    #[test]
    fn extreme_knots_are_refused() {
        let refused = |knots: Vec<ForceKnot>| ForceCurve::new(ForceCurveData { touch: 0.0, knots }).unwrap_err();
        assert!(matches!(refused(vec![]), MeshError::Option { .. }));
        assert!(matches!(refused(vec![knot(0.0, 1.0, 1.0)]), MeshError::Knot { knot: 0, .. }));
        assert!(matches!(refused(vec![knot(1.0, 1.0, 1.0), knot(2.0, 0.5, 1.0)]), MeshError::Knot { knot: 1, .. }));
        assert!(matches!(refused(vec![knot(1.0, f64::NAN, 1.0)]), MeshError::Knot { .. }));
    }
}
