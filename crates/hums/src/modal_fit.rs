//! Several damped modes from a ringing signal: matrix pencil and least-squares Prony.
//!
//! Problem. A transmission rings in several modes. Find the M damped cosines
//! `y_i = sum_j a_j e^(-zeta_j w_j t_i) cos(w_dj t_i + phi_j)`, `t_i = i / rate`, that explain the
//! samples; no start values, no iteration on a cost with many minima.
//!
//! Method. The samples obey a linear recurrence with roots `z = e^(s / rate)`.
//! - [`Method::MatrixPencil`] (Hua and Sarkar 1990, IEEE Trans. ASSP 38:814): the Hankel matrix
//!   `Y_ij = y_(i+j)`, N - L rows, L + 1 columns, L = N/2, is cut to rank 2M by its singular value
//!   decomposition; with V1, V2 the leading right singular vectors without last and without first row,
//!   z are the eigenvalues of `V1^+ V2`. With noise of 1 % of the largest of three modes, that mode's
//!   damping comes out to better than 1 %.
//! - [`Method::Prony`] (least-squares Prony: Kumaresan and Tufts 1982 for the background): the
//!   recurrence's 2M coefficients by least squares, z as eigenvalues of its companion matrix. Cheap,
//!   exact without noise, biased with it: damping comes out too high.
//!
//! Amplitudes and phases then follow by linear least squares in cosines and sines. Real and unstable
//! roots (growing, or at zero or Nyquist frequency) do not ring and are left out and counted.
//!
//! At most [`MAX_SAMPLES`] samples: cut the record to the ringing part first; the singular value
//! decomposition grows with the third power. Verified by `tests/phenomenon.rs`.

use crate::error::{HumsError, Result, require_finite, require_len, require_positive};
use crate::phenomenon::modes::Mode;
use gear_numerics::fft::Complex;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, TAU};

/// Samples at most.
pub const MAX_SAMPLES: usize = 2048;

/// How the poles are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Matrix pencil.
    #[default]
    MatrixPencil,
    /// Least-squares Prony.
    Prony,
}

/// Modes found.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct ModalFit {
    /// Modes, largest amplitude first; amplitude > 0, phase in (-pi, pi], time 0 at the first sample.
    pub modes: Vec<Mode>,
    /// Roots left out because they do not ring.
    pub discarded: usize,
    /// RMS of what is left, unit of the signal.
    pub residual_rms: f64,
    /// Singular values over the largest, for the choice of the number of modes (matrix pencil only;
    /// noise-free data have 2M above rounding).
    pub singular_values: Vec<f64>,
}

/// Fits `modes` damped modes to samples at `rate` (Hz), all of them, from the first on.
///
/// # Errors
/// [`HumsError::TooShort`] below `6 modes + 2` samples; [`HumsError::Parameter`] for 0 modes or
/// more than [`MAX_SAMPLES`] samples; [`HumsError::Undefined`] for a signal of zeros or one in which
/// nothing rings; [`HumsError::NoConvergence`] of the matrix decompositions.
pub fn fit_modes(signal: &[f64], rate: f64, modes: usize, method: Method) -> Result<ModalFit> {
    const WHAT: &str = "modal fit";
    require_positive("sampling rate", rate)?;
    if modes == 0 || modes > MAX_SAMPLES / 6 {
        return Err(HumsError::Parameter {
            parameter: "number of modes",
            value: modes as f64,
            allowed: "at least 1, at most a sixth of the samples",
        });
    }
    require_len(WHAT, signal, 6 * modes + 2)?;
    if signal.len() > MAX_SAMPLES {
        return Err(HumsError::Parameter {
            parameter: "samples",
            value: signal.len() as f64,
            allowed: "at most 2048; cut the record to the ringing part",
        });
    }
    require_finite(WHAT, signal)?;
    let peak = crate::moments::peak(signal);
    if !(peak > 0.0) {
        return Err(HumsError::Undefined { what: WHAT, reason: "the signal is zero everywhere" });
    }
    let y: Vec<f64> = signal.iter().map(|x| x / peak).collect();
    let (roots, singular_values) = match method {
        Method::MatrixPencil => pencil_roots(&y, 2 * modes)?,
        Method::Prony => (prony_roots(&y, 2 * modes)?, Vec::new()),
    };
    let mut poles: Vec<Complex<f64>> = roots
        .iter()
        .filter(|z| z.im > 0.0 && z.norm() < 1.0 && z.arg() < PI)
        .map(|z| z.ln() * rate)
        .filter(|s| s.re.is_finite() && s.im > 0.0)
        .collect();
    poles.sort_by(|a, b| a.im.total_cmp(&b.im));
    if poles.is_empty() {
        return Err(HumsError::Undefined { what: WHAT, reason: "no root of the recurrence is a decaying oscillation" });
    }
    let (mut found, rest) = amplitudes(&y, rate, &poles)?;
    found.iter_mut().for_each(|m| m.amplitude *= peak);
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    Ok(ModalFit { discarded: roots.len() - 2 * found.len(), modes: found, residual_rms: rest * peak, singular_values })
}

fn eigenvalues(what: &'static str, matrix: DMatrix<f64>) -> Result<Vec<Complex<f64>>> {
    const LIMIT: usize = 10_000;
    let schur = nalgebra::Schur::try_new(matrix, f64::EPSILON, LIMIT)
        .ok_or(HumsError::NoConvergence { what, iterations: LIMIT })?;
    let values = schur.complex_eigenvalues();
    Ok(values.iter().map(|z| Complex::new(z.re, z.im)).collect())
}

/// Moore-Penrose solution by singular value decomposition.
fn least_squares(what: &'static str, a: DMatrix<f64>, b: &DMatrix<f64>) -> Result<DMatrix<f64>> {
    let limit = 10_000;
    let failed = HumsError::NoConvergence { what, iterations: limit };
    let svd = a.try_svd(true, true, f64::EPSILON, limit).ok_or_else(|| failed.clone())?;
    let cut = svd.singular_values.max() * 1e-14;
    svd.solve(b, cut).map_err(|_| failed)
}

fn pencil_roots(y: &[f64], order: usize) -> Result<(Vec<Complex<f64>>, Vec<f64>)> {
    const WHAT: &str = "matrix pencil";
    let n = y.len();
    let l = (n / 2).max(order);
    let hankel = DMatrix::from_fn(n - l, l + 1, |i, j| y[i + j]);
    let svd = hankel
        .try_svd(false, true, f64::EPSILON, 10_000)
        .ok_or(HumsError::NoConvergence { what: WHAT, iterations: 10_000 })?;
    let Some(v_t) = svd.v_t else {
        return Err(HumsError::NoConvergence { what: WHAT, iterations: 0 });
    };
    // nalgebra does not promise an order unless asked: sort by size.
    let mut by_size: Vec<usize> = (0..svd.singular_values.len()).collect();
    by_size.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
    let largest = svd.singular_values[by_size[0]];
    let values: Vec<f64> = by_size.iter().map(|k| svd.singular_values[*k] / largest).collect();
    let rank = values.iter().take(order).filter(|v| **v > 1e-14).count().max(1);
    let v1 = DMatrix::from_fn(l, rank, |i, j| v_t[(by_size[j], i)]);
    let v2 = DMatrix::from_fn(l, rank, |i, j| v_t[(by_size[j], i + 1)]);
    let pencil = least_squares(WHAT, v1, &v2)?;
    Ok((eigenvalues(WHAT, pencil)?, values))
}

fn prony_roots(y: &[f64], order: usize) -> Result<Vec<Complex<f64>>> {
    const WHAT: &str = "Prony's method";
    let rows = y.len() - order;
    let past = DMatrix::from_fn(rows, order, |i, j| y[i + j]);
    let next = DMatrix::from_fn(rows, 1, |i, _| y[i + order]);
    let coefficients = least_squares(WHAT, past, &next)?;
    // y_(i+p) = sum_j c_j y_(i+j): the companion matrix shifts the state (y_i .. y_(i+p-1)).
    let companion = DMatrix::from_fn(order, order, |i, j| {
        if i + 1 == order {
            coefficients[(j, 0)]
        } else if j == i + 1 {
            1.0
        } else {
            0.0
        }
    });
    eigenvalues(WHAT, companion)
}

/// Amplitudes and phases for known poles, and the RMS of what is left.
fn amplitudes(y: &[f64], rate: f64, poles: &[Complex<f64>]) -> Result<(Vec<Mode>, f64)> {
    let basis = DMatrix::from_fn(y.len(), 2 * poles.len(), |i, j| {
        let t = i as f64 / rate;
        let s = poles[j / 2];
        let phase = s.im * t;
        (s.re * t).exp() * if j % 2 == 0 { phase.cos() } else { phase.sin() }
    });
    let samples = DMatrix::from_column_slice(y.len(), 1, y);
    let x = least_squares("modal amplitudes", basis.clone(), &samples)?;
    let rest: DVector<f64> = (&samples - basis * &x).column(0).into_owned();
    let modes = poles
        .iter()
        .enumerate()
        .map(|(k, s)| {
            // a cos(wt + phi) = a cos phi cos wt - a sin phi sin wt
            let (c, d) = (x[(2 * k, 0)], x[(2 * k + 1, 0)]);
            Mode {
                amplitude: c.hypot(d),
                phase: (-d).atan2(c),
                natural_frequency: s.norm() / TAU,
                damping: -s.re / s.norm(),
            }
        })
        .collect();
    Ok((modes, (rest.norm_squared() / y.len() as f64).sqrt()))
}
