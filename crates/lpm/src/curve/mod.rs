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
//! Tests: `tests.rs` beside this file (interpolation order, jumps from both sides, shifts, replaced cycles).

mod build;
mod edit;

pub use edit::CurveRange;

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
    Pieces { pieces: Vec<Piece>, hint: Vec<u32> },
    Fourier { mean: f64, harmonics: Vec<(f64, f64)> },
}

/// A periodic function of the mesh phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    period: usize,
    repr: Repr,
}

fn taylor_shift(a: [f64; 4], s: f64) -> [f64; 4] {
    [a[0] + s * (a[1] + s * (a[2] + s * a[3])), a[1] + s * (2.0 * a[2] + 3.0 * s * a[3]), a[2] + 3.0 * s * a[3], a[3]]
}

impl Curve {
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

    /// Phases in `[0, period)` at which the curve or its slope jumps.
    pub(crate) fn kinks(&self) -> Vec<f64> {
        match &self.repr {
            Repr::Fourier { .. } => Vec::new(),
            Repr::Pieces { pieces, .. } => pieces.iter().filter(|p| p.kink).map(|p| p.start).collect(),
        }
    }

    /// Length over which the curve may change its course within the pieces `range` between `start` and `end` (mesh cycles): a
    /// piece of a spline, a quarter of the shortest wave of a series; infinite for a single cubic. Not below 1/128: the
    /// points of a denser table follow each other smoothly or not at all.
    pub(crate) fn resolution(&self, start: f64, end: f64, range: (u32, u32)) -> f64 {
        let length = match &self.repr {
            Repr::Fourier { harmonics, .. } => 0.25 / harmonics.len().max(1) as f64,
            Repr::Pieces { .. } if range.0 == range.1 => f64::INFINITY,
            Repr::Pieces { .. } => (end - start) / f64::from(range.1 - range.0 + 1),
        };
        length.max(1.0 / 128.0)
    }

    /// First and last piece of the stretch `(start, end)`, which holds no kink.
    pub(crate) fn pieces_of(&self, start: f64, end: f64) -> (u32, u32) {
        let eps = 1e-3 * (end - start).min(1e-9);
        (self.locate(start + eps), self.locate(end - eps))
    }

    /// Value and slope at `tau` in `[0, period]`, using only the pieces `range` (so jumps are seen from one side).
    #[inline]
    pub(crate) fn value_and_slope_within(&self, tau: f64, range: (u32, u32)) -> (f64, f64) {
        let piece = if range.0 == range.1 { range.0 } else { self.locate(tau).clamp(range.0, range.1) };
        self.eval_in(tau, piece)
    }

    /// Value alone; as [`Self::value_and_slope_within`].
    #[inline]
    pub(crate) fn value_within(&self, tau: f64, range: (u32, u32)) -> f64 {
        match &self.repr {
            Repr::Fourier { .. } => self.eval_in(tau, 0).0,
            Repr::Pieces { pieces, .. } => {
                let piece = if range.0 == range.1 { range.0 } else { self.locate(tau).clamp(range.0, range.1) };
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
                (p.a[0] + u * (p.a[1] + u * (p.a[2] + u * p.a[3])), p.a[1] + u * (2.0 * p.a[2] + 3.0 * u * p.a[3]))
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
            let head = Piece { start: 0.0, a: taylor_shift(last.a, period as f64 - last.start), kink: false };
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
        Self { period, repr: Repr::Pieces { pieces, hint } }
    }
}

#[cfg(test)]
mod tests;
