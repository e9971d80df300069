//! Resonance curves as data: options, points, turning points, and what is read off them.
//!
//! Tests: `tests/periodic.rs`.

use crate::error::{LpmError, check};
use crate::floquet::{Multiplier, Stability};
use crate::integrate::Options;
use crate::model::State;
use crate::response::Sampling;
use crate::sweep::Measure;

/// Options of [`crate::Model::continuation`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuationOptions<'a> {
    /// Least mesh frequency (Hz).
    pub from: f64,
    /// Largest mesh frequency (Hz).
    pub to: f64,
    /// Begin towards higher frequencies.
    pub upwards: bool,
    /// Largest arclength step (natural units: static scale, and natural frequency for the mesh frequency), 1e-4 to 1.
    pub max_step: f64,
    /// Points at most.
    pub max_points: usize,
    /// Integration.
    pub integration: Options<'a>,
    /// Relative residual aimed at. Where noise of the adaptive steps keeps Newton's method above it (unresolved ringing of
    /// stiff supports, forces that jump), the best iterate counts as long as it is within 1000 integration tolerances.
    pub tolerance: f64,
    /// Sampling of the response at each point.
    pub sampling: Sampling,
}

impl Default for ContinuationOptions<'_> {
    /// 200 to 4000 Hz downwards, steps up to 0.1, integration at 1e-9, residual 1e-8, 64 samples per cycle.
    fn default() -> Self {
        Self {
            from: 200.0,
            to: 4000.0,
            upwards: false,
            max_step: 0.1,
            max_points: 5000,
            integration: Options::with_tolerance(1e-9),
            tolerance: 1e-8,
            sampling: Sampling { per_cycle: 64, energy: false },
        }
    }
}

impl ContinuationOptions<'_> {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for the first number outside its range.
    pub fn validate(&self) -> Result<(), LpmError> {
        self.integration.validate()?;
        check(self.from > 0.0, "least mesh frequency", self.from, "Hz", "positive")?;
        check(self.to > self.from, "largest mesh frequency", self.to, "Hz", "above the least")?;
        check((1e-4..=1.0).contains(&self.max_step), "arclength step", self.max_step, "-", "between 1e-4 and 1")?;
        check(self.max_points >= 2, "points", self.max_points as f64, "-", "at least 2")?;
        check((1e-12..=1e-3).contains(&self.tolerance), "residual", self.tolerance, "-", "between 1e-12 and 1e-3")?;
        Ok(())
    }
}

/// A point of a resonance curve.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchPoint {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// State at phase 0.
    pub state: State,
    /// Floquet multipliers, largest modulus first.
    pub multipliers: Vec<Multiplier>,
    /// Stability.
    pub stability: Stability,
    /// Relative residual.
    pub residual: f64,
    /// Response over one period.
    pub measure: Measure,
}

/// A point where the curve turns back in frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct TurningPoint {
    /// The point itself; one multiplier is +1 here.
    pub point: BranchPoint,
    /// It lies between points `after` and `after + 1` of the branch.
    pub after: usize,
    /// The curve lies below this frequency nearby (a largest frequency), else above.
    pub is_maximum: bool,
}

/// Where a continuation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BranchEnd {
    /// The frequency range was left.
    RangeLeft,
    /// `max_points` reached.
    PointLimit,
    /// The corrector failed at the least step. With [`crate::Separation::DeflectionVanishes`] the force jumps where contact is lost, and
    /// a family of solutions can truly end where its orbit comes to graze the boundary.
    NoConvergence,
}

/// A family of periodic solutions.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct Branch {
    /// Points in order along the curve.
    pub points: Vec<BranchPoint>,
    /// Turning points in order.
    pub turning_points: Vec<TurningPoint>,
    /// Why it ended.
    pub end: BranchEnd,
    /// Newton iterations spent.
    pub iterations: usize,
}

impl Branch {
    /// Points at which stability changes, other than at turning points: (index of the first point after, kind it changes to).
    pub fn stability_changes(&self) -> Vec<(usize, Stability)> {
        let turning: Vec<usize> = self.turning_points.iter().map(|t| t.after + 1).collect();
        (1..self.points.len())
            .filter(|i| self.points[*i].stability != self.points[i - 1].stability && !turning.contains(i))
            .map(|i| (i, self.points[i].stability))
            .collect()
    }

    /// Frequency ranges (Hz) in which the curve holds more than one stable solution, ascending; neighbouring turning points and ends bound them.
    pub fn coexistence(&self) -> Vec<(f64, f64)> {
        let mut ends: Vec<f64> = self
            .turning_points
            .iter()
            .map(|t| t.point.mesh_frequency)
            .chain(self.points.first().map(|p| p.mesh_frequency))
            .chain(self.points.last().map(|p| p.mesh_frequency))
            .collect();
        ends.extend(self.stability_changes().iter().map(|c| self.points[c.0].mesh_frequency));
        ends.sort_by(f64::total_cmp);
        let mut found: Vec<(f64, f64)> = Vec::new();
        for w in ends.windows(2) {
            let stable = self.at(0.5 * (w[0] + w[1])).iter().filter(|p| p.1).count();
            if stable < 2 || w[0] == w[1] {
                continue;
            }
            match found.last_mut() {
                Some(last) if last.1 == w[0] => last.1 = w[1],
                _ => found.push((w[0], w[1])),
            }
        }
        found
    }

    /// Points and turning points in order along the curve.
    pub fn curve(&self) -> Vec<&BranchPoint> {
        let mut turning = self.turning_points.iter().peekable();
        let mut all = Vec::with_capacity(self.points.len() + self.turning_points.len());
        for (i, p) in self.points.iter().enumerate() {
            all.push(p);
            while let Some(t) = turning.next_if(|t| t.after == i) {
                all.push(&t.point);
            }
        }
        all
    }

    /// Solutions at `mesh_frequency` (Hz), interpolated linearly along the curve: (peak to peak in m, stable).
    pub fn at(&self, mesh_frequency: f64) -> Vec<(f64, bool)> {
        let curve = self.curve();
        curve
            .windows(2)
            .filter_map(|w| {
                let (a, b) = (w[0].mesh_frequency - mesh_frequency, w[1].mesh_frequency - mesh_frequency);
                if a * b > 0.0 || a == b || b == 0.0 {
                    return None;
                }
                let t = a / (a - b);
                let p = w[0].measure.peak_to_peak * (1.0 - t) + w[1].measure.peak_to_peak * t;
                // At a turning point the multiplier is +1 and its sign rounding: the other end of the stretch tells.
                let margin = |p: &BranchPoint| p.multipliers.iter().fold(0.0, |m: f64, x| m.max(x.modulus())) - 1.0;
                let (m0, m1) = (margin(w[0]), margin(w[1]));
                Some((p, if m0.abs() > m1.abs() { m0 < 0.0 } else { m1 < 0.0 }))
            })
            .collect()
    }
}
