//! New curves from old ones, and what a curve amounts to: range and mean.

use super::{Curve, Piece, Repr, taylor_shift};
use crate::error::{LpmError, check};
use std::f64::consts::TAU;

impl Curve {
    /// The curve moved to later phases by `shift` cycles: `new(tau) = old(tau - shift)`.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for a shift that is not finite.
    pub fn shifted(&self, shift: f64) -> Result<Self, LpmError> {
        check(true, "shift", shift, "cycles", "finite")?;
        Ok(match &self.repr {
            Repr::Fourier { mean, harmonics } => {
                let rotated = harmonics
                    .iter()
                    .enumerate()
                    .map(|(j, &(c, s))| {
                        let (sn, cs) = (TAU * (j + 1) as f64 * shift.rem_euclid(1.0)).sin_cos();
                        (c * cs - s * sn, c * sn + s * cs)
                    })
                    .collect();
                Self { period: 1, repr: Repr::Fourier { mean: *mean, harmonics: rotated } }
            }
            Repr::Pieces { pieces, .. } => {
                let period = self.period as f64;
                let mut moved: Vec<Piece> = pieces
                    .iter()
                    .map(|p| Piece { start: (p.start + shift).rem_euclid(period), ..*p })
                    .map(|p| if p.start >= period { Piece { start: 0.0, ..p } } else { p })
                    .collect();
                moved.sort_by(|a, b| a.start.total_cmp(&b.start));
                Self::from_pieces(self.period, moved)
            }
        })
    }

    /// `factor * curve + offset`.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for numbers that are not finite.
    pub fn scaled(&self, factor: f64, offset: f64) -> Result<Self, LpmError> {
        check(true, "factor", factor, "-", "finite")?;
        check(true, "offset", offset, "-", "finite")?;
        let mut new = self.clone();
        match &mut new.repr {
            Repr::Fourier { mean, harmonics } => {
                *mean = factor * *mean + offset;
                harmonics.iter_mut().for_each(|(c, s)| (*c, *s) = (factor * *c, factor * *s));
            }
            Repr::Pieces { pieces, .. } => {
                for p in pieces {
                    p.a = p.a.map(|v| factor * v);
                    p.a[0] += offset;
                }
            }
        }
        Ok(new)
    }

    /// The same function with a period `times` as long.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for 0 repetitions.
    pub fn repeated(&self, times: usize) -> Result<Self, LpmError> {
        check(times >= 1, "repetitions", times as f64, "-", "at least 1")?;
        Ok(match &self.repr {
            Repr::Fourier { .. } => self.clone(),
            Repr::Pieces { pieces, .. } => {
                let period = self.period as f64;
                let all = (0..times)
                    .flat_map(|r| pieces.iter().map(move |p| Piece { start: p.start + r as f64 * period, ..*p }))
                    .collect();
                Self::assemble(self.period * times, all)
            }
        })
    }

    /// A rotation of `cycles` mesh cycles that follows `self` except in the cycles `first .. first + damaged.period()`,
    /// where it follows `damaged` (whose phase 0 falls on `first`). Both must be tables or steps.
    ///
    /// # Errors
    /// [`LpmError::Period`] where the periods do not fit the rotation, or a curve is a Fourier series.
    pub fn with_cycles_replaced(&self, cycles: usize, first: usize, damaged: &Curve) -> Result<Self, LpmError> {
        let misfit = |reason| Err(LpmError::Period { first: cycles, second: damaged.period, reason });
        if !cycles.is_multiple_of(self.period) {
            return misfit("the rotation must be a multiple of the healthy curve's period");
        }
        if first + damaged.period > cycles {
            return misfit("the damaged stretch must end within the rotation");
        }
        let (Repr::Pieces { pieces: bad, .. }, Repr::Pieces { .. }) = (&damaged.repr, &self.repr) else {
            return misfit("cycles of a Fourier series cannot be replaced: tabulate it first");
        };
        let whole = self.repeated(cycles / self.period)?;
        let Repr::Pieces { pieces: good, .. } = &whole.repr else {
            return misfit("not a table");
        };
        let (lo, hi) = (first as f64, (first + damaged.period) as f64);
        let mut all: Vec<Piece> = good.iter().filter(|p| p.start < lo).copied().collect();
        all.extend(bad.iter().map(|p| Piece { start: p.start + lo, kink: p.kink || p.start <= 0.0, ..*p }));
        if hi < cycles as f64 {
            let at = good.partition_point(|p| p.start <= hi).saturating_sub(1);
            if let Some(p) = good.get(at) {
                all.push(Piece { start: hi, a: taylor_shift(p.a, hi - p.start), kink: true });
            }
            all.extend(good.iter().filter(|p| p.start > hi));
        }
        Ok(Self::assemble(cycles, all))
    }

    /// Least and largest value with their phases, from the ends and interior extrema of the pieces (exact up to
    /// rounding), or from 64 samples per wave of the highest harmonic of a Fourier series.
    pub fn range(&self) -> CurveRange {
        let mut r = CurveRange { min: f64::INFINITY, min_phase: 0.0, max: f64::NEG_INFINITY, max_phase: 0.0 };
        let mut take = |t: f64, v: f64| {
            if v < r.min {
                (r.min, r.min_phase) = (v, t);
            }
            if v > r.max {
                (r.max, r.max_phase) = (v, t);
            }
        };
        match &self.repr {
            Repr::Fourier { harmonics, .. } => {
                let n = 64 * (harmonics.len() + 1);
                (0..n).map(|i| i as f64 / n as f64).for_each(|t| take(t, self.value(t)));
            }
            Repr::Pieces { pieces, .. } => {
                for (i, p) in pieces.iter().enumerate() {
                    let end = pieces.get(i + 1).map_or(self.period as f64, |n| n.start);
                    let w = end - p.start;
                    for u in [Some(0.0), Some(w)].into_iter().chain(quadratic_roots(p.a[1], 2.0 * p.a[2], 3.0 * p.a[3]))
                    {
                        if let Some(u) = u.filter(|u| (0.0..=w).contains(u)) {
                            take(p.start + u, taylor_shift(p.a, u)[0]);
                        }
                    }
                }
            }
        }
        r
    }

    /// Mean over the period.
    pub fn mean(&self) -> f64 {
        match &self.repr {
            Repr::Fourier { mean, .. } => *mean,
            Repr::Pieces { pieces, .. } => {
                let total: f64 = pieces
                    .iter()
                    .enumerate()
                    .map(|(i, p)| {
                        let w = pieces.get(i + 1).map_or(self.period as f64, |n| n.start) - p.start;
                        w * (p.a[0] + w * (p.a[1] / 2.0 + w * (p.a[2] / 3.0 + w * p.a[3] / 4.0)))
                    })
                    .sum();
                total / self.period as f64
            }
        }
    }
}

/// Extremes of a curve, see [`Curve::range`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveRange {
    /// Least value.
    pub min: f64,
    /// Its phase (mesh cycles).
    pub min_phase: f64,
    /// Largest value.
    pub max: f64,
    /// Its phase (mesh cycles).
    pub max_phase: f64,
}

fn quadratic_roots(c: f64, b: f64, a: f64) -> [Option<f64>; 2] {
    let disc = b * b - 4.0 * a * c;
    if disc < 0.0 {
        return [None, None];
    }
    let q = -0.5 * (b + disc.sqrt().copysign(b));
    [Some(q / a).filter(|r| r.is_finite()), Some(c / q).filter(|r| r.is_finite())]
}
