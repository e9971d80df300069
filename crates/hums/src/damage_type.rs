//! Type and severity of a tooth's damage from its static transmission error.
//!
//! Problem. A crack and a pit can raise the largest transmission error by the same amount, but a crack is felt whenever its tooth carries
//! load, which is a contact ratio's worth of mesh cycles, a pit only while the contact passes over it (D 3.3, Figure 3.13). A crack also bends the
//! tooth the more, the farther out the contact lies, so its rise leans toward the end of mesh at the tip, in a way of its own at every length; that of
//! a pit lies about the pit. So three numbers of a curve over the mesh cycle tell type and severity:
//!
//! | symbol | field | meaning | unit |
//! |---|---|---|---|
//! | `rise` | [`CurveFeatures::peak_rise`] | largest value, relative to the healthy one, minus 1 | - |
//! | | [`CurveFeatures::largest_rise`] | largest relative increase at any place | - |
//! | `L` | [`CurveFeatures::affected`] | length over which the curve exceeds the healthy one by more than 1 % | mesh cycles |
//! | `c` | [`CurveFeatures::centre`] | centre of the rise over that length | mesh cycles |
//!
//! Method. Reference curves, computed for the pair at hand, hold `rise`, `L` and `c` over severity for cracks and for pits. The rise seen gives the
//! severity that either type would need, and that severity the `L` and `c` it would have. Cracks of a pair are one family: at a given rise there is one
//! `(L, c)`. Pits are many, for a pit of any height and place may cause the rise. So a curve is a crack's if its `(L, c)` lies less than half as far from
//! that of a crack as the nearest pit that is known ([`DamageClassifier::reach`]), and otherwise a pit's. Nothing is a threshold but the 1 % and the
//! least rise that counts. Interpolation is linear between reference points, hence monotone where they are.
//!
//! Measured on the nonunity pair: cracks of 10 to 95 % lie within 0.06 mesh cycles of the curve through every second of them, 120 pits of six widths,
//! four heights and five places no nearer than 0.26.
//!
//! Limits. Noise moves `L` and `c`: [`Diagnosis::margin`] says by how much they may move before the type changes. Pits off the pitch
//! line leave the largest value alone while they are small: use [`SeverityFeature::LargestRise`] for them. Verified by `tests/damage_type.rs`; the
//! confusion table of a gear pair is in `docs/reports/damage-classifier.md`.

use crate::error::{HumsError, Result, require_finite, require_len, require_positive};

/// The 1 % rule of D 3.3.
pub const AFFECTED: f64 = 0.01;

/// What is read from a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveFeatures {
    /// Largest value over the healthy curve's largest value, minus 1.
    pub peak_rise: f64,
    /// Largest relative increase over the healthy curve at any place.
    pub largest_rise: f64,
    /// Mesh cycles over which the curve exceeds the healthy one by more than the threshold.
    pub affected: f64,
    /// Centre of the relative increase where it exceeds the threshold (mesh cycles from the first sample); 0 where it nowhere does.
    pub centre: f64,
}

impl CurveFeatures {
    /// Features of a curve sampled at the places of a healthy one, `step` mesh cycles apart. `threshold` is the relative excess that counts as affected
    /// ([`AFFECTED`]). Crossings of the threshold are interpolated, so that the length does not jump by a step.
    ///
    /// # Errors
    /// Fewer than two samples, different lengths, values that are not finite, healthy values that are not positive, `step` or `threshold` not positive.
    pub fn of(healthy: &[f64], curve: &[f64], step: f64, threshold: f64) -> Result<Self> {
        const WHAT: &str = "features of a transmission error curve";
        require_len(WHAT, healthy, 2)?;
        if healthy.len() != curve.len() {
            return Err(HumsError::LengthMismatch { what: WHAT, left: healthy.len(), right: curve.len() });
        }
        require_finite(WHAT, healthy)?;
        require_finite(WHAT, curve)?;
        require_positive("step (mesh cycles)", step)?;
        require_positive("threshold", threshold)?;
        if healthy.iter().any(|&value| value <= 0.0) {
            return Err(HumsError::Undefined { what: WHAT, reason: "the healthy curve is not positive everywhere" });
        }
        let largest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rises: Vec<f64> = curve.iter().zip(healthy).map(|(value, healthy)| value / healthy - 1.0).collect();
        let affected: f64 = rises.windows(2).map(|pair| share_above(pair[0] - threshold, pair[1] - threshold)).sum();
        let above = || rises.iter().enumerate().filter(|(_, rise)| **rise > threshold);
        let sum: f64 = above().map(|(_, rise)| rise).sum();
        let moment: f64 = above().map(|(place, rise)| place as f64 * rise).sum();
        Ok(Self {
            peak_rise: largest(curve) / largest(healthy) - 1.0,
            largest_rise: largest(&rises),
            affected: step * affected,
            centre: if sum > 0.0 { step * moment / sum } else { 0.0 },
        })
    }
}

/// Part of an interval over which the straight line between two values is positive.
fn share_above(a: f64, b: f64) -> f64 {
    match (a > 0.0, b > 0.0) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => a / (a - b),
        (false, true) => b / (b - a),
    }
}

/// Types of damage that can be told apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DamageType {
    /// Tooth root crack.
    Crack,
    /// Surface pit.
    Pit,
}

/// Which rise measures severity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SeverityFeature {
    /// That of the largest value: what D 3.3 uses.
    #[default]
    PeakRise,
    /// The largest at any place: also for damage that single contact does not see.
    LargestRise,
}

impl SeverityFeature {
    fn of(self, features: &CurveFeatures) -> f64 {
        match self {
            Self::PeakRise => features.peak_rise,
            Self::LargestRise => features.largest_rise,
        }
    }
}

/// Features over severity for one type of damage.
#[derive(Debug, Clone, PartialEq)]
struct Reference {
    /// Severity, rise, affected length, centre; severity and rise ascending, from no damage.
    points: Vec<[f64; 4]>,
}

/// What one type of damage would have to be to cause a rise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Type.
    pub damage: DamageType,
    /// Severity, in the unit of the reference; that of the last reference point for a rise beyond it.
    pub severity: f64,
    /// Affected length that this severity has (mesh cycles).
    pub affected: f64,
    /// Centre of the rise that it has (mesh cycles).
    pub centre: f64,
    /// Whether the rise lies within the reference.
    pub within_reference: bool,
}

/// Outcome of a classification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Diagnosis {
    /// The likelier type with its severity; `None` where the curve is not affected or its rise does not count.
    pub damage: Option<Estimate>,
    /// As crack and as pit.
    pub estimates: [Estimate; 2],
    /// How far the curve's `(L, c)` is from where the type changes (mesh cycles); 0 is a toss-up.
    pub margin: f64,
}

/// Tells cracks from pits by reference curves of one gear pair and load.
#[derive(Debug, Clone, PartialEq)]
pub struct DamageClassifier {
    feature: SeverityFeature,
    least_rise: f64,
    cracks: Reference,
    pits: Reference,
    reach: f64,
}

impl DamageClassifier {
    /// Classifier from `(severity, features)` of cracks and of pits, in the order of severity, and the features of further pits, which only bound
    /// what may be a crack: of other shapes and places, high ones toward the tip above all. All features are of curves at the same places. Rises
    /// below `least_rise` count as no damage: choose a few standard deviations of the relative noise of a measured curve.
    ///
    /// # Errors
    /// No reference, severities not ascending from above 0, values not finite, a rise that falls with severity, `least_rise` negative.
    pub fn new(
        feature: SeverityFeature,
        least_rise: f64,
        cracks: &[(f64, CurveFeatures)],
        pits: &[(f64, CurveFeatures)],
        other_pits: &[CurveFeatures],
    ) -> Result<Self> {
        if !(least_rise >= 0.0 && least_rise.is_finite()) {
            let allowed = "finite and >= 0";
            return Err(HumsError::Parameter { parameter: "least rise", value: least_rise, allowed });
        }
        let reference = |points| Reference::new(feature, points);
        let (cracks, severities) = (reference(cracks)?, reference(pits)?);
        let mut nearest = f64::INFINITY;
        for pit in pits.iter().map(|(_, features)| features).chain(other_pits) {
            let rise = feature.of(pit);
            require_finite("reference pits", &[rise, pit.affected, pit.centre])?;
            if rise > least_rise && pit.affected > 0.0 {
                nearest = nearest.min(cracks.estimate(DamageType::Crack, rise).distance(pit));
            }
        }
        let reach = if nearest.is_finite() { 0.5 * nearest } else { 0.0 };
        Ok(Self { feature, least_rise, cracks, pits: severities, reach })
    }

    /// Distance in `(L, c)` from a crack of the same rise (mesh cycles) within which a curve is a crack's: half that of the nearest pit that is known.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Type and severity behind a curve's features.
    ///
    /// # Errors
    /// Features that are not finite.
    pub fn classify(&self, features: &CurveFeatures) -> Result<Diagnosis> {
        let rise = self.feature.of(features);
        require_finite("damage classification", &[rise, features.affected, features.centre])?;
        let estimates = [self.cracks.estimate(DamageType::Crack, rise), self.pits.estimate(DamageType::Pit, rise)];
        let inside = self.reach - estimates[0].distance(features);
        let chosen = if inside >= 0.0 { estimates[0] } else { estimates[1] };
        let counts = rise > self.least_rise && features.affected > 0.0;
        Ok(Diagnosis { damage: counts.then_some(chosen), estimates, margin: inside.abs() })
    }
}

impl Estimate {
    /// Distance of a curve from it in affected length and centre (mesh cycles).
    fn distance(&self, features: &CurveFeatures) -> f64 {
        (self.affected - features.affected).hypot(self.centre - features.centre)
    }
}

impl Reference {
    fn new(feature: SeverityFeature, points: &[(f64, CurveFeatures)]) -> Result<Self> {
        const WHAT: &str = "reference of a damage type";
        if points.is_empty() {
            return Err(HumsError::TooShort { what: WHAT, needed: 1, found: 0 });
        }
        let mut all: Vec<[f64; 4]> = Vec::new();
        for (severity, features) in points {
            let point = [*severity, feature.of(features), features.affected, features.centre];
            require_finite(WHAT, &point)?;
            let last = all.last().copied().unwrap_or([0.0, 0.0, features.affected, features.centre]);
            if !(point[0] > last[0]) {
                let allowed = "ascending and > 0";
                return Err(HumsError::Parameter { parameter: "reference severity", value: point[0], allowed });
            }
            if all.is_empty() {
                // the healthy curve; a first damage is felt as far as it ever is
                all.push(last);
            }
            if !(point[1] >= last[1]) {
                let reason = "the rise falls with severity: sort it, or take fewer points where it saturates";
                return Err(HumsError::Undefined { what: WHAT, reason });
            }
            all.push(point);
        }
        Ok(Self { points: all })
    }

    /// Severity and affected length at a rise.
    fn estimate(&self, damage: DamageType, rise: f64) -> Estimate {
        let points = &self.points;
        let last = points.len() - 1;
        let next = points.partition_point(|point| point[1] < rise).clamp(1, last);
        let [from, to] = [points[next - 1], points[next]];
        let part = if to[1] > from[1] { ((rise - from[1]) / (to[1] - from[1])).clamp(0.0, 1.0) } else { 1.0 };
        let mix = |k: usize| from[k] + part * (to[k] - from[k]);
        let within_reference = rise >= 0.0 && rise <= points[last][1];
        Estimate { damage, severity: mix(0), affected: mix(2), centre: mix(3), within_reference }
    }
}
