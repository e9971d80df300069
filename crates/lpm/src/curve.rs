//! Periodic curves over the mesh cycle: constant, steps, tables, Fourier series.
//!
//! A curve is a function of the mesh phase `tau` (mesh cycles, 1 = one base pitch of rotation) with a period
//! of a whole number of cycles: 1 for a healthy pair, the tooth number of the damaged gear otherwise.
//! Everything but a Fourier series is held as cubic pieces
//!
//! `y(tau) = a + b u + c u^2 + d u^3`, `u = tau - knot`,
//!
//! and each knot knows whether the curve has a jump or a kink there. An integrator must land on such knots
//! to keep its order; it may step over the smooth ones of a spline.
//!
//! Tests: unit tests below (interpolation order, jumps from both sides, shifts, replaced cycles).

use crate::error::{LpmError, check};
use std::f64::consts::TAU;

/// Phases closer than this (mesh cycles) are one.
pub(crate) const SAME_PHASE: f64 = 1e-10;

/// How the values between the points of a table are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines; every point is a kink.
    Linear,
    /// Periodic cubic spline with continuous second derivative.
    Spline,
}

/// One cubic piece, from `start` to the start of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    /// Coefficients of 1, u, u^2, u^3.
    a: [f64; 4],
    /// The curve, or its slope, jumps at `start`.
    kink: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Repr {
    Pieces {
        pieces: Vec<Piece>,
        hint: Vec<u32>,
    },
    Fourier {
        mean: f64,
        harmonics: Vec<(f64, f64)>,
    },
}

/// A periodic function of the mesh phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    period: usize,
    repr: Repr,
}

fn taylor_shift(a: [f64; 4], s: f64) -> [f64; 4] {
    [
        a[0] + s * (a[1] + s * (a[2] + s * a[3])),
        a[1] + s * (2.0 * a[2] + 3.0 * s * a[3]),
        a[2] + 3.0 * s * a[3],
        a[3],
    ]
}

impl Curve {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Result<Self, LpmError> {
        check(true, "constant value", value, "-", "finite")?;
        Ok(Self::assemble(
            1,
            vec![Piece {
                start: 0.0,
                a: [value, 0.0, 0.0, 0.0],
                kink: false,
            }],
        ))
    }

    /// Piecewise constant: `steps` holds (phase at which the value begins, value), phases ascending in `[0, period)`.
    pub fn steps(period: usize, steps: &[(f64, f64)]) -> Result<Self, LpmError> {
        let (phases, values): (Vec<f64>, Vec<f64>) = steps.iter().copied().unzip();
        check_table(period, &phases, &values, 1)?;
        let pieces = steps
            .iter()
            .map(|&(start, v)| Piece {
                start,
                a: [v, 0.0, 0.0, 0.0],
                kink: true,
            })
            .collect();
        Ok(Self::from_pieces(period, pieces))
    }

    /// Rectangular wave of one cycle: `high` from phase `rise` for a fraction `duty` of the cycle, `low` elsewhere.
    pub fn rectangular(low: f64, high: f64, rise: f64, duty: f64) -> Result<Self, LpmError> {
        check(
            (0.0..1.0).contains(&rise),
            "rise",
            rise,
            "cycles",
            "in [0, 1)",
        )?;
        check(
            duty > 0.0 && duty < 1.0,
            "duty",
            duty,
            "-",
            "between 0 and 1, both excluded",
        )?;
        let fall = (rise + duty) % 1.0;
        let mut steps = [(rise, high), (fall, low)];
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self::steps(1, &steps)
    }

    /// Rectangular wave with ramps: straight lines of length `ramp` (cycles) centred on the two jumps.
    pub fn trapezoidal(
        low: f64,
        high: f64,
        rise: f64,
        duty: f64,
        ramp: f64,
    ) -> Result<Self, LpmError> {
        check(
            (0.0..1.0).contains(&rise),
            "rise",
            rise,
            "cycles",
            "in [0, 1)",
        )?;
        check(
            duty > 0.0 && duty < 1.0,
            "duty",
            duty,
            "-",
            "between 0 and 1, both excluded",
        )?;
        let room = duty.min(1.0 - duty);
        check(
            ramp > 0.0 && ramp < room,
            "ramp",
            ramp,
            "cycles",
            "above 0, below both plateaus",
        )?;
        let r = 0.5 * ramp;
        let mut pts: Vec<(f64, f64)> = [
            (rise - r, low),
            (rise + r, high),
            (rise + duty - r, high),
            (rise + duty + r, low),
        ]
        .iter()
        .map(|&(t, v)| (t.rem_euclid(1.0), v))
        .collect();
        pts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (phases, values): (Vec<f64>, Vec<f64>) = pts.into_iter().unzip();
        Self::table(1, &phases, &values, Interpolation::Linear)
    }

    /// Table of values at ascending phases in `[0, period)`; the curve closes on itself after `period` cycles.
    pub fn table(
        period: usize,
        phases: &[f64],
        values: &[f64],
        interpolation: Interpolation,
    ) -> Result<Self, LpmError> {
        let least = if interpolation == Interpolation::Spline {
            3
        } else {
            2
        };
        check_table(period, phases, values, least)?;
        let n = phases.len();
        let next = |i: usize| {
            if i + 1 < n {
                (phases[i + 1], values[i + 1])
            } else {
                (phases[0] + period as f64, values[0])
            }
        };
        let width: Vec<f64> = (0..n).map(|i| next(i).0 - phases[i]).collect();
        let slope: Vec<f64> = (0..n).map(|i| (next(i).1 - values[i]) / width[i]).collect();
        let pieces = match interpolation {
            Interpolation::Linear => (0..n)
                .map(|i| Piece {
                    start: phases[i],
                    a: [values[i], slope[i], 0.0, 0.0],
                    kink: true,
                })
                .collect(),
            Interpolation::Spline => {
                let m = cyclic_spline(&width, &slope)?;
                (0..n)
                    .map(|i| {
                        let (m0, m1, h) = (m[i], m[(i + 1) % n], width[i]);
                        let a = [
                            values[i],
                            slope[i] - h * (2.0 * m0 + m1) / 6.0,
                            0.5 * m0,
                            (m1 - m0) / (6.0 * h),
                        ];
                        Piece {
                            start: phases[i],
                            a,
                            kink: false,
                        }
                    })
                    .collect()
            }
        };
        Ok(Self::from_pieces(period, pieces))
    }

    /// Table of equally spaced values, the first at phase 0.
    pub fn samples(
        period: usize,
        values: &[f64],
        interpolation: Interpolation,
    ) -> Result<Self, LpmError> {
        let n = values.len().max(1) as f64;
        let phases: Vec<f64> = (0..values.len())
            .map(|i| i as f64 * period as f64 / n)
            .collect();
        Self::table(period, &phases, values, interpolation)
    }

    /// Fourier series of period one cycle: `mean + sum_j (c_j cos 2 pi j tau + s_j sin 2 pi j tau)`, `harmonics[j-1] = (c_j, s_j)`.
    pub fn fourier(mean: f64, harmonics: &[(f64, f64)]) -> Result<Self, LpmError> {
        check(true, "mean of a Fourier series", mean, "-", "finite")?;
        for &(c, s) in harmonics {
            check(true, "cosine coefficient", c, "-", "finite")?;
            check(true, "sine coefficient", s, "-", "finite")?;
        }
        Ok(Self {
            period: 1,
            repr: Repr::Fourier {
                mean,
                harmonics: harmonics.to_vec(),
            },
        })
    }

    /// Period in whole mesh cycles.
    pub fn period(&self) -> usize {
        self.period
    }

    /// Value at phase `tau` (any finite number of mesh cycles); from the right at a jump, and within 1e-10 cycles before it.
    pub fn value(&self, tau: f64) -> f64 {
        self.value_and_slope(tau).0
    }

    /// Value and slope (per mesh cycle) at phase `tau`; from the right at a jump.
    pub fn value_and_slope(&self, tau: f64) -> (f64, f64) {
        // A phase computed as a multiple of a sampling step misses a jump by rounding.
        let near = self.wrap(tau + SAME_PHASE);
        self.eval_in((near - SAME_PHASE).max(0.0), self.locate(near))
    }

    /// The curve moved to later phases by `shift` cycles: `new(tau) = old(tau - shift)`.
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
                Self {
                    period: 1,
                    repr: Repr::Fourier {
                        mean: *mean,
                        harmonics: rotated,
                    },
                }
            }
            Repr::Pieces { pieces, .. } => {
                let period = self.period as f64;
                let mut moved: Vec<Piece> = pieces
                    .iter()
                    .map(|p| Piece {
                        start: (p.start + shift).rem_euclid(period),
                        ..*p
                    })
                    .map(|p| {
                        if p.start >= period {
                            Piece { start: 0.0, ..p }
                        } else {
                            p
                        }
                    })
                    .collect();
                moved.sort_by(|a, b| a.start.total_cmp(&b.start));
                Self::from_pieces(self.period, moved)
            }
        })
    }

    /// `factor * curve + offset`.
    pub fn scaled(&self, factor: f64, offset: f64) -> Result<Self, LpmError> {
        check(true, "factor", factor, "-", "finite")?;
        check(true, "offset", offset, "-", "finite")?;
        let mut new = self.clone();
        match &mut new.repr {
            Repr::Fourier { mean, harmonics } => {
                *mean = factor * *mean + offset;
                harmonics
                    .iter_mut()
                    .for_each(|(c, s)| (*c, *s) = (factor * *c, factor * *s));
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
    pub fn repeated(&self, times: usize) -> Result<Self, LpmError> {
        check(times >= 1, "repetitions", times as f64, "-", "at least 1")?;
        Ok(match &self.repr {
            Repr::Fourier { .. } => self.clone(),
            Repr::Pieces { pieces, .. } => {
                let period = self.period as f64;
                let all = (0..times)
                    .flat_map(|r| {
                        pieces.iter().map(move |p| Piece {
                            start: p.start + r as f64 * period,
                            ..*p
                        })
                    })
                    .collect();
                Self::assemble(self.period * times, all)
            }
        })
    }

    /// A rotation of `cycles` mesh cycles that follows `self` except in the cycles `first .. first + damaged.period()`,
    /// where it follows `damaged` (whose phase 0 falls on `first`). Both must be tables or steps.
    pub fn with_cycles_replaced(
        &self,
        cycles: usize,
        first: usize,
        damaged: &Curve,
    ) -> Result<Self, LpmError> {
        let misfit = |reason| {
            Err(LpmError::Period {
                first: cycles,
                second: damaged.period,
                reason,
            })
        };
        if !cycles.is_multiple_of(self.period) {
            return misfit("the rotation must be a multiple of the healthy curve's period");
        }
        if first + damaged.period > cycles {
            return misfit("the damaged stretch must end within the rotation");
        }
        let (Repr::Pieces { pieces: bad, .. }, Repr::Pieces { .. }) = (&damaged.repr, &self.repr)
        else {
            return misfit("cycles of a Fourier series cannot be replaced: tabulate it first");
        };
        let whole = self.repeated(cycles / self.period)?;
        let Repr::Pieces { pieces: good, .. } = &whole.repr else {
            return misfit("not a table");
        };
        let (lo, hi) = (first as f64, (first + damaged.period) as f64);
        let mut all: Vec<Piece> = good.iter().filter(|p| p.start < lo).copied().collect();
        all.extend(bad.iter().map(|p| Piece {
            start: p.start + lo,
            kink: p.kink || p.start <= 0.0,
            ..*p
        }));
        if hi < cycles as f64 {
            let at = good.partition_point(|p| p.start <= hi).saturating_sub(1);
            if let Some(p) = good.get(at) {
                all.push(Piece {
                    start: hi,
                    a: taylor_shift(p.a, hi - p.start),
                    kink: true,
                });
            }
            all.extend(good.iter().filter(|p| p.start > hi));
        }
        Ok(Self::assemble(cycles, all))
    }

    /// Least and largest value with their phases, from the ends and interior extrema of the pieces (exact up to
    /// rounding), or from 64 samples per wave of the highest harmonic of a Fourier series.
    pub fn range(&self) -> CurveRange {
        let mut r = CurveRange {
            min: f64::INFINITY,
            min_phase: 0.0,
            max: f64::NEG_INFINITY,
            max_phase: 0.0,
        };
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
                (0..n)
                    .map(|i| i as f64 / n as f64)
                    .for_each(|t| take(t, self.value(t)));
            }
            Repr::Pieces { pieces, .. } => {
                for (i, p) in pieces.iter().enumerate() {
                    let end = pieces.get(i + 1).map_or(self.period as f64, |n| n.start);
                    let w = end - p.start;
                    for u in [Some(0.0), Some(w)].into_iter().chain(quadratic_roots(
                        p.a[1],
                        2.0 * p.a[2],
                        3.0 * p.a[3],
                    )) {
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

    /// Phases in `[0, period)` at which the curve or its slope jumps.
    pub(crate) fn kinks(&self) -> Vec<f64> {
        match &self.repr {
            Repr::Fourier { .. } => Vec::new(),
            Repr::Pieces { pieces, .. } => {
                pieces.iter().filter(|p| p.kink).map(|p| p.start).collect()
            }
        }
    }

    /// First and last piece of the stretch `(start, end)`, which holds no kink.
    pub(crate) fn pieces_of(&self, start: f64, end: f64) -> (u32, u32) {
        let eps = 1e-3 * (end - start).min(1e-9);
        (self.locate(start + eps), self.locate(end - eps))
    }

    /// Value and slope at `tau` in `[0, period]`, using only the pieces `range` (so jumps are seen from one side).
    #[inline]
    pub(crate) fn value_and_slope_within(&self, tau: f64, range: (u32, u32)) -> (f64, f64) {
        let piece = if range.0 == range.1 {
            range.0
        } else {
            self.locate(tau).clamp(range.0, range.1)
        };
        self.eval_in(tau, piece)
    }

    /// Value alone; as [`Self::value_and_slope_within`].
    #[inline]
    pub(crate) fn value_within(&self, tau: f64, range: (u32, u32)) -> f64 {
        match &self.repr {
            Repr::Fourier { .. } => self.eval_in(tau, 0).0,
            Repr::Pieces { pieces, .. } => {
                let piece = if range.0 == range.1 {
                    range.0
                } else {
                    self.locate(tau).clamp(range.0, range.1)
                };
                let p = &pieces[piece as usize];
                let u = tau - p.start;
                p.a[0] + u * (p.a[1] + u * (p.a[2] + u * p.a[3]))
            }
        }
    }

    fn wrap(&self, tau: f64) -> f64 {
        let p = self.period as f64;
        let t = tau.rem_euclid(p);
        if t < p { t } else { 0.0 }
    }

    fn eval_in(&self, tau: f64, piece: u32) -> (f64, f64) {
        match &self.repr {
            Repr::Pieces { pieces, .. } => {
                let p = &pieces[piece as usize];
                let u = tau - p.start;
                (
                    p.a[0] + u * (p.a[1] + u * (p.a[2] + u * p.a[3])),
                    p.a[1] + u * (2.0 * p.a[2] + 3.0 * u * p.a[3]),
                )
            }
            Repr::Fourier { mean, harmonics } => {
                let (s1, c1) = (TAU * tau).sin_cos();
                let (mut c, mut s, mut v, mut d) = (1.0, 0.0, *mean, 0.0);
                for (j, &(a, b)) in harmonics.iter().enumerate() {
                    (c, s) = (c * c1 - s * s1, s * c1 + c * s1);
                    v += a * c + b * s;
                    d += (j + 1) as f64 * (b * c - a * s);
                }
                (v, TAU * d)
            }
        }
    }

    fn locate(&self, tau: f64) -> u32 {
        match &self.repr {
            Repr::Fourier { .. } => 0,
            Repr::Pieces { pieces, hint } => {
                let bucket = (tau / self.period as f64 * hint.len() as f64) as usize;
                let mut i = hint[bucket.min(hint.len() - 1)] as usize;
                while i + 1 < pieces.len() && pieces[i + 1].start <= tau {
                    i += 1;
                }
                i as u32
            }
        }
    }

    /// From pieces with ascending starts in `[0, period)`: the one that runs past the period is split at 0.
    fn from_pieces(period: usize, mut pieces: Vec<Piece>) -> Self {
        if let (Some(first), Some(last)) = (pieces.first().copied(), pieces.last().copied())
            && first.start > 0.0
        {
            let head = Piece {
                start: 0.0,
                a: taylor_shift(last.a, period as f64 - last.start),
                kink: false,
            };
            pieces.insert(0, head);
        }
        Self::assemble(period, pieces)
    }

    /// From pieces that begin at 0, with the search grid.
    fn assemble(period: usize, pieces: Vec<Piece>) -> Self {
        let n = pieces.len();
        let hint = (0..n)
            .map(|b| {
                let t = b as f64 * period as f64 / n as f64;
                pieces.partition_point(|p| p.start <= t).saturating_sub(1) as u32
            })
            .collect();
        Self {
            period,
            repr: Repr::Pieces { pieces, hint },
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
    [
        Some(q / a).filter(|r| r.is_finite()),
        Some(c / q).filter(|r| r.is_finite()),
    ]
}

fn check_table(
    period: usize,
    phases: &[f64],
    values: &[f64],
    least: usize,
) -> Result<(), LpmError> {
    check(period >= 1, "period", period as f64, "cycles", "at least 1")?;
    if phases.len() != values.len() {
        return Err(LpmError::Length {
            what: "values of a table",
            found: values.len(),
            needed: "as many as phases",
        });
    }
    if phases.len() < least {
        let needed = match least {
            1 => "at least 1",
            2 => "at least 2",
            _ => "at least 3",
        };
        return Err(LpmError::Length {
            what: "points of a table",
            found: phases.len(),
            needed,
        });
    }
    for (index, (&phase, &value)) in phases.iter().zip(values).enumerate() {
        let fault = |reason| {
            Err(LpmError::Table {
                index,
                phase,
                reason,
            })
        };
        if !value.is_finite() {
            return fault("value is not finite");
        }
        if !(0.0..period as f64).contains(&phase) {
            return fault("phase must lie in [0, period)");
        }
        if index > 0 && phase - phases[index - 1] < 1e-9 {
            return fault("phases must ascend by at least 1e-9 cycles");
        }
    }
    if phases.len() > 1 && period as f64 - phases[phases.len() - 1] + phases[0] < 1e-9 {
        let index = phases.len() - 1;
        return Err(LpmError::Table {
            index,
            phase: phases[index],
            reason: "coincides with the first point",
        });
    }
    Ok(())
}

/// Second derivatives of the periodic cubic spline (cyclic tridiagonal system by Sherman-Morrison).
fn cyclic_spline(width: &[f64], slope: &[f64]) -> Result<Vec<f64>, LpmError> {
    let n = width.len();
    let prev = |i: usize| (i + n - 1) % n;
    let rhs: Vec<f64> = (0..n).map(|i| 6.0 * (slope[i] - slope[prev(i)])).collect();
    let mut diag: Vec<f64> = (0..n).map(|i| 2.0 * (width[prev(i)] + width[i])).collect();
    let corner = width[n - 1];
    let g = -diag[0];
    diag[0] -= g;
    diag[n - 1] -= corner * corner / g;
    let solve = |mut r: Vec<f64>| {
        let mut d = diag.clone();
        for i in 1..n {
            let f = width[i - 1] / d[i - 1];
            d[i] -= f * width[i - 1];
            r[i] -= f * r[i - 1];
        }
        r[n - 1] /= d[n - 1];
        for i in (0..n - 1).rev() {
            r[i] = (r[i] - width[i] * r[i + 1]) / d[i];
        }
        r
    };
    let y = solve(rhs);
    let mut u = vec![0.0; n];
    (u[0], u[n - 1]) = (g, corner);
    let z = solve(u);
    let factor = (y[0] + corner / g * y[n - 1]) / (1.0 + z[0] + corner / g * z[n - 1]);
    let m: Vec<f64> = y.iter().zip(&z).map(|(y, z)| y - factor * z).collect();
    if m.iter().all(|v| v.is_finite()) {
        Ok(m)
    } else {
        Err(LpmError::Singular {
            place: "periodic spline",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invariant_a_jump_met_up_to_rounding_counts_as_reached() -> Result<(), LpmError> {
        // 0.82 cycles after every start, by three routes of rounding.
        let wave = Curve::rectangular(1.0, 2.0, 0.18, 0.64)?;
        let rotation = wave.with_cycles_replaced(27, 14, &wave.scaled(10.0, 0.0)?)?;
        for i in 0..27 {
            for t in [f64::from(i) + 0.82, f64::from(100 * i + 82) / 100.0] {
                assert_eq!(wave.value(t), 1.0, "{t}");
                assert_eq!(rotation.value(t), if i == 14 { 10.0 } else { 1.0 }, "{t}");
                assert_eq!(wave.value(t - 1e-9), 2.0, "{t}");
            }
        }
        Ok(())
    }

    #[test]
    fn order_spline_is_fourth_order_and_linear_second() -> Result<(), LpmError> {
        let f = |t: f64| (TAU * t).sin() + 0.3 * (2.0 * TAU * t).cos();
        let error = |n: usize, kind| -> Result<f64, LpmError> {
            let values: Vec<f64> = (0..n).map(|i| f(i as f64 / n as f64)).collect();
            let c = Curve::samples(1, &values, kind)?;
            Ok((0..997)
                .map(|i| i as f64 / 997.0)
                .map(|t| (c.value(t) - f(t)).abs())
                .fold(0.0, f64::max))
        };
        for (kind, order) in [(Interpolation::Linear, 2.0), (Interpolation::Spline, 4.0)] {
            let e: Vec<f64> = [20, 40, 80, 160]
                .iter()
                .map(|&n| error(n, kind))
                .collect::<Result<_, _>>()?;
            let slope = (e[0] / e[3]).log2() / 3.0;
            assert!(
                (slope - order).abs() < 0.15,
                "{kind:?}: order {slope}, errors {e:?}"
            );
        }
        Ok(())
    }

    #[test]
    fn analytic_rectangular_and_shifted_jumps() -> Result<(), LpmError> {
        let c = Curve::rectangular(1.0, 2.0, 0.7, 0.5)?;
        for (t, v) in [
            (0.0, 2.0),
            (0.19, 2.0),
            (0.2, 1.0),
            (0.69, 1.0),
            (0.7, 2.0),
            (-0.1, 2.0),
            (5.5, 1.0),
        ] {
            assert_eq!(c.value(t), v, "at {t}");
        }
        assert!((c.mean() - 1.5).abs() < 1e-15);
        let s = c.shifted(0.4)?;
        for i in 0..50 {
            let t = i as f64 * 0.02 + 0.003;
            assert_eq!(s.value(t), c.value(t - 0.4), "at {t}");
        }
        Ok(())
    }

    #[test]
    fn invariant_replaced_cycles_follow_both_curves() -> Result<(), LpmError> {
        let h = Curve::trapezoidal(5.0, 8.0, 0.3, 0.4, 0.1)?;
        let d = h.repeated(2)?.scaled(0.5, 0.0)?;
        let w = h.with_cycles_replaced(7, 3, &d)?;
        assert_eq!(w.period(), 7);
        for i in 0..700 {
            let t = i as f64 * 0.01 + 0.001;
            let want = if (3.0..5.0).contains(&t) {
                0.5 * h.value(t)
            } else {
                h.value(t)
            };
            assert!((w.value(t) - want).abs() < 1e-12, "at {t}");
        }
        Ok(())
    }

    #[test]
    fn invariant_fourier_slope_shift_and_range() -> Result<(), LpmError> {
        let c = Curve::fourier(2.0, &[(0.5, -0.2), (0.0, 0.1)])?;
        let s = c.shifted(0.13)?;
        for i in 0..40 {
            let t = i as f64 / 40.0;
            let (v, d) = c.value_and_slope(t);
            let num = (c.value(t + 1e-6) - c.value(t - 1e-6)) / 2e-6;
            assert!((d - num).abs() < 1e-8, "slope {d} {num}");
            assert!((s.value(t + 0.13) - v).abs() < 1e-14);
            assert!(c.range().min <= v + 1e-3 && v <= c.range().max + 1e-3);
        }
        Ok(())
    }

    #[test]
    fn extreme_bad_tables_are_refused() {
        assert!(Curve::table(1, &[0.0, 0.5], &[1.0], Interpolation::Linear).is_err());
        assert!(Curve::table(1, &[0.5, 0.2], &[1.0, 2.0], Interpolation::Linear).is_err());
        assert!(Curve::table(1, &[0.0, 1.0], &[1.0, 2.0], Interpolation::Linear).is_err());
        assert!(Curve::table(1, &[0.0, f64::NAN], &[1.0, 2.0], Interpolation::Linear).is_err());
        assert!(
            Curve::table(1, &[0.0, 0.5], &[1.0, f64::INFINITY], Interpolation::Linear).is_err()
        );
        assert!(Curve::samples(1, &[], Interpolation::Spline).is_err());
        assert!(Curve::table(0, &[0.0, 0.5], &[1.0, 2.0], Interpolation::Linear).is_err());
        assert!(Curve::constant(f64::NAN).is_err());
    }
}
