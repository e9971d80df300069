//! The two excitations of Eq. (3.3): local mesh stiffness `k_l(tau)` and static transmission error `delta_0(tau)`.
//!
//! Both are periodic curves over the mesh cycle. Their common period is the least common multiple of the two;
//! it is divided into *segments* at every jump or kink of either curve, so that an integrator that lands on the
//! ends of segments sees smooth coefficients only.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `k_l` | `mesh_stiffness` | N/m |
//! | `delta_0` | `transmission_error` | m, positive in the direction of tooth approach |
//!
//! Tests: `invariant_segments_cover_the_period` below.

use crate::curve::{Curve, SAME_PHASE};
use crate::error::{LpmError, check};
use gear_numerics::number::lcm;

/// Longest common period accepted (mesh cycles).
const MAX_PERIOD: usize = 100_000;

/// Mesh stiffness and static transmission error over the mesh cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Excitation {
    stiffness: Curve,
    error: Curve,
    period: usize,
    segments: Vec<Segment>,
}

/// A stretch of the period without jump or kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment {
    pub start: f64,
    pub end: f64,
    /// Longest step that does not overlook what the curves do (mesh cycles).
    pub max_step: f64,
    stiffness: (u32, u32),
    error: (u32, u32),
}

/// Both excitations and their slopes at one phase.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub stiffness: f64,
    pub stiffness_slope: f64,
    pub error: f64,
    pub error_slope: f64,
}

impl Excitation {
    /// From local mesh stiffness (N/m, positive everywhere) and static transmission error (m).
    ///
    /// # Errors
    /// [`LpmError::StiffnessNotPositive`]; [`LpmError::Period`] for a common period of more than 100,000 mesh cycles.
    pub fn new(mesh_stiffness: &Curve, transmission_error: &Curve) -> Result<Self, LpmError> {
        let (a, b) = (mesh_stiffness.period(), transmission_error.period());
        let period = lcm(a, b);
        if period > MAX_PERIOD {
            let reason = "their common period is longer than 100000 mesh cycles";
            return Err(LpmError::Period { first: a, second: b, reason });
        }
        let r = mesh_stiffness.range();
        if !(r.min.is_finite() && r.min > 0.0) {
            return Err(LpmError::StiffnessNotPositive { value: r.min, phase: r.min_phase });
        }
        let (stiffness, error) = (mesh_stiffness.repeated(period / a)?, transmission_error.repeated(period / b)?);
        let mut ends: Vec<f64> = stiffness.kinks().into_iter().chain(error.kinks()).collect();
        ends.extend([0.0, period as f64]);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|later, earlier| *later - *earlier < SAME_PHASE);
        if let Some(last) = ends.last_mut() {
            *last = period as f64;
        }
        let segments = ends
            .windows(2)
            .map(|w| {
                let (start, end) = (w[0], w[1]);
                let pieces = (stiffness.pieces_of(start, end), error.pieces_of(start, end));
                Segment {
                    start,
                    end,
                    max_step: stiffness.resolution(start, end, pieces.0).min(error.resolution(start, end, pieces.1)),
                    stiffness: pieces.0,
                    error: pieces.1,
                }
            })
            .collect();
        Ok(Self { stiffness, error, period, segments })
    }

    /// Local mesh stiffness (N/m).
    pub fn mesh_stiffness(&self) -> &Curve {
        &self.stiffness
    }

    /// Static transmission error (m).
    pub fn transmission_error(&self) -> &Curve {
        &self.error
    }

    /// Common period (mesh cycles).
    pub fn period(&self) -> usize {
        self.period
    }

    /// The excitation held still at phase `tau`, as in an impulse test at standstill.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for a phase that is not finite.
    pub fn frozen(&self, tau: f64) -> Result<Self, LpmError> {
        check(true, "phase", tau, "cycles", "finite")?;
        Self::new(&Curve::constant(self.stiffness.value(tau))?, &Curve::constant(self.error.value(tau))?)
    }

    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Segment that holds `tau` in `[0, period)`; the later one at a common end.
    pub(crate) fn segment_at(&self, tau: f64) -> usize {
        self.segments.partition_point(|s| s.end <= tau).min(self.segments.len() - 1)
    }

    /// Stiffness and transmission error at `tau` seen from inside `segment`.
    #[inline]
    pub(crate) fn values(&self, segment: &Segment, tau: f64) -> (f64, f64) {
        (self.stiffness.value_within(tau, segment.stiffness), self.error.value_within(tau, segment.error))
    }

    /// As [`Self::values`], with slopes per mesh cycle.
    pub(crate) fn point(&self, segment: &Segment, tau: f64) -> Point {
        let (stiffness, stiffness_slope) = self.stiffness.value_and_slope_within(tau, segment.stiffness);
        let (error, error_slope) = self.error.value_and_slope_within(tau, segment.error);
        Point { stiffness, stiffness_slope, error, error_slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Interpolation;

    #[test]
    fn invariant_segments_cover_the_period() -> Result<(), LpmError> {
        let k = Curve::rectangular(5e8, 8e8, 0.7, 0.5)?;
        let d = Curve::samples(3, &[1e-6, 2e-6, 4e-6, 3e-6, 2e-6, 2.5e-6, 1e-6], Interpolation::Spline)?;
        let e = Excitation::new(&k, &d)?;
        assert_eq!(e.period(), 3);
        assert_eq!(e.segments().len(), 7); // two jumps per cycle and the start of the period
        for s in e.segments() {
            for i in 0..=10 {
                let t = s.start + (s.end - s.start) * i as f64 / 10.0;
                let inside = t.clamp(s.start + 1e-9, s.end - 1e-9);
                let (kv, dv) = e.values(s, t);
                assert!((kv - k.value(inside)).abs() < 1e-3, "stiffness at {t}");
                assert!((dv - d.value(inside)).abs() < 1e-13, "error at {t}");
            }
        }
        Ok(())
    }

    #[test]
    fn extreme_negative_stiffness_is_refused() -> Result<(), LpmError> {
        let k = Curve::fourier(1e8, &[(1.1e8, 0.0)])?;
        let d = Curve::constant(1e-5)?;
        assert!(matches!(Excitation::new(&k, &d), Err(LpmError::StiffnessNotPositive { .. })));
        Ok(())
    }
}
