//! Least-squares fit of the phenomenon-based model to a difference signal.
//!
//! Problem. Given samples `d_i` at `t_i = i / rate`, minimise `sum (d_i - y(t_i))^2` over A and t_d
//! (D 4.5.1), and optionally natural frequency and damping.
//!
//! Method. A enters linearly and is eliminated (variable projection: Golub and Pereyra 1973):
//! `A = <d, g> / <g, g>` for the model g with A = 1, leaving `<d,d> - <d,g>^2 / <g,g>` to minimise.
//! In t_d this has a minimum a period: it is scanned over the record in steps of 1/16 damped period,
//! and the best cell refined. Then Gauss-Newton steps with Levenberg's damping on all free
//! parameters (A included, derivatives analytic) until the step is below 1e-12 of the scale of each.
//! Both signs of A are tried: a delay shifted by half a period changes A's sign.
//!
//! The model is zero before t_d; the derivative with respect to t_d jumps there, by
//! `-A w_d` times one sample, which is harmless with many samples a period.
//! The scan costs about 16 periods times the ringing's length in samples for each period of the
//! record: cut long records of lightly damped modes first.
//!
//! Verified by `tests/phenomenon.rs`: exact recovery, and the error in noise against Cramer-Rao.

use super::DampedSine;
use crate::error::{HumsError, Result, require_finite, require_len, require_positive};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::TAU;

/// What to fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Natural frequency (start value if free), Hz.
    pub natural_frequency: f64,
    /// Damping ratio (start value if free).
    pub damping: f64,
    /// Let the natural frequency vary.
    pub free_frequency: bool,
    /// Let the damping ratio vary.
    pub free_damping: bool,
    /// Force A > 0, as in the dissertation; otherwise the better sign wins.
    pub positive_amplitude: bool,
    /// Iterations at most.
    pub max_iterations: usize,
}

impl FitOptions {
    /// A and t_d only, A > 0, for a known mode.
    #[must_use]
    pub fn amplitude_and_delay(natural_frequency: f64, damping: f64) -> Self {
        Self {
            natural_frequency,
            damping,
            free_frequency: false,
            free_damping: false,
            positive_amplitude: true,
            max_iterations: 200,
        }
    }
}

/// How a fit ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitStatus {
    /// Steps fell below the tolerance.
    Converged,
    /// They did not; the best parameters so far are returned.
    IterationLimit,
}

/// A fitted model.
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub struct Fit {
    /// Parameters.
    pub model: DampedSine,
    /// How it ended.
    pub status: FitStatus,
    /// Gauss-Newton steps tried.
    pub iterations: usize,
    /// RMS of what is left, unit of the signal.
    pub residual_rms: f64,
    /// Share of the signal's energy that the model explains, 0 to 1.
    pub explained: f64,
}

/// Scan cells per damped period.
const CELLS: f64 = 16.0;

/// Fits the model to a difference signal sampled at `rate` (Hz).
///
/// # Errors
/// [`HumsError::TooShort`] below 8 samples; non-finite samples; parameters out of range;
/// [`HumsError::Parameter`] when the frequency is not below the Nyquist frequency;
/// [`HumsError::Undefined`] for a signal of zeros or when no delay gives an amplitude of the sign
/// asked for.
pub fn fit(difference: &[f64], rate: f64, options: &FitOptions) -> Result<Fit> {
    const WHAT: &str = "fit of the damped sine";
    require_len(WHAT, difference, 8)?;
    require_finite(WHAT, difference)?;
    require_positive("sampling rate", rate)?;
    let start = DampedSine {
        amplitude: 1.0,
        delay: 0.0,
        natural_frequency: options.natural_frequency,
        damping: options.damping,
    };
    start.validate()?;
    if start.natural_frequency >= rate / 2.0 {
        return Err(HumsError::Parameter {
            parameter: "natural frequency",
            value: start.natural_frequency,
            allowed: "below half the sampling rate",
        });
    }
    // Work on a signal of peak 1.
    let peak = crate::moments::peak(difference);
    if !(peak > 0.0) {
        return Err(HumsError::Undefined { what: WHAT, reason: "the signal is zero everywhere" });
    }
    let d: Vec<f64> = difference.iter().map(|x| x / peak).collect();
    let energy: f64 = d.iter().map(|x| x * x).sum();

    let guess = scan(&d, rate, start, options.positive_amplitude).ok_or(HumsError::Undefined {
        what: WHAT,
        reason: "no delay within the record gives an amplitude of the sign asked for",
    })?;
    let (mut model, status, iterations) = refine(&d, rate, guess, options);
    let rest = residual_energy(&d, rate, &model);
    model.amplitude *= peak;
    Ok(Fit {
        model,
        status,
        iterations,
        residual_rms: (rest / d.len() as f64).sqrt() * peak,
        explained: (1.0 - rest / energy).clamp(0.0, 1.0),
    })
}

fn residual_energy(d: &[f64], rate: f64, model: &DampedSine) -> f64 {
    d.iter().enumerate().map(|(i, x)| (x - model.value(i as f64 / rate)).powi(2)).sum()
}

/// Best delay on a grid, with its amplitude; `None` when no amplitude has the sign asked for.
fn scan(d: &[f64], rate: f64, start: DampedSine, positive: bool) -> Option<DampedSine> {
    let cell = 1.0 / (CELLS * start.damped_frequency());
    let duration = d.len() as f64 / rate;
    // From one period before the record to its last samples.
    let cells = ((duration / cell) as usize).min(1_000_000);
    let mut best: Option<(f64, DampedSine)> = None;
    for k in 0..cells + CELLS as usize {
        let unit = DampedSine { delay: (k as f64 - CELLS) * cell, ..start };
        let (amplitude, gain) = projection(d, rate, &unit);
        let allowed = amplitude.is_finite() && (!positive || amplitude > 0.0);
        if allowed && gain > best.as_ref().map_or(0.0, |b| b.0) {
            best = Some((gain, DampedSine { amplitude, ..unit }));
        }
    }
    best.map(|b| b.1)
}

/// Best amplitude `<d,g>/<g,g>` and the energy `<d,g>^2/<g,g>` that it explains. The oscillation is
/// advanced by complex multiplication; it is cut where it has decayed to 1e-16.
fn projection(d: &[f64], rate: f64, unit: &DampedSine) -> (f64, f64) {
    let decay = TAU * unit.natural_frequency * unit.damping;
    let omega = TAU * unit.damped_frequency();
    let first = (unit.delay * rate).ceil().max(0.0) as usize;
    let length = (37.0 / decay * rate).min(d.len() as f64).ceil() as usize;
    let last = first.saturating_add(length).min(d.len());
    if first >= last {
        return (f64::NAN, 0.0);
    }
    let tau = first as f64 / rate - unit.delay;
    let envelope = (-decay * tau).exp();
    let (mut re, mut im) = (envelope * (omega * tau).cos(), envelope * (omega * tau).sin());
    let shrink = (-decay / rate).exp();
    let (c, s) = (shrink * (omega / rate).cos(), shrink * (omega / rate).sin());
    let (mut dg, mut gg) = (0.0, 0.0);
    for x in &d[first..last] {
        dg += x * im;
        gg += im * im;
        (re, im) = (re * c - im * s, re * s + im * c);
    }
    if gg > 0.0 { (dg / gg, dg * dg / gg) } else { (f64::NAN, 0.0) }
}

/// Levenberg-Marquardt on (A, t_d, w_n, zeta), those that are free, each scaled to order 1.
fn refine(d: &[f64], rate: f64, start: DampedSine, options: &FitOptions) -> (DampedSine, FitStatus, usize) {
    let free = [true, true, options.free_frequency, options.free_damping];
    let mut model = start;
    let mut cost = residual_energy(d, rate, &model);
    let mut lambda = 1e-3;
    for iteration in 1..=options.max_iterations {
        let scale = SVector::<f64, 4>::new(
            model.amplitude.abs(),
            1.0 / model.damped_frequency(),
            model.natural_frequency,
            model.damping,
        );
        let (mut normal, right) = normal_equations(d, rate, &model, &scale, free);
        for k in 0..4 {
            normal[(k, k)] *= 1.0 + lambda;
        }
        let Some(step) = normal.cholesky().map(|c| c.solve(&right)) else {
            lambda *= 10.0;
            if lambda > 1e12 {
                return (model, FitStatus::IterationLimit, iteration);
            }
            continue;
        };
        let trial = DampedSine {
            amplitude: model.amplitude + step[0] * scale[0],
            delay: model.delay + step[1] * scale[1],
            natural_frequency: model.natural_frequency + step[2] * scale[2],
            damping: model.damping + step[3] * scale[3],
        };
        let allowed = trial.validate().is_ok()
            && trial.natural_frequency < rate / 2.0
            && (!options.positive_amplitude || trial.amplitude > 0.0);
        let trial_cost = if allowed { residual_energy(d, rate, &trial) } else { f64::INFINITY };
        let small = step.amax() < 1e-12;
        if trial_cost <= cost {
            (model, cost) = (trial, trial_cost);
            lambda = (lambda * 0.1).max(1e-15);
        } else {
            lambda *= 10.0;
        }
        // A step that is refused at any damping means that rounding has the last word.
        if small || lambda > 1e12 {
            return (model, FitStatus::Converged, iteration);
        }
    }
    (model, FitStatus::IterationLimit, options.max_iterations)
}

fn normal_equations(
    d: &[f64],
    rate: f64,
    model: &DampedSine,
    scale: &SVector<f64, 4>,
    free: [bool; 4],
) -> (SMatrix<f64, 4, 4>, SVector<f64, 4>) {
    let (zeta, w) = (model.damping, TAU * model.natural_frequency);
    let root = (1.0 - zeta * zeta).sqrt();
    let mut normal = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    for (i, x) in d.iter().enumerate() {
        let tau = i as f64 / rate - model.delay;
        if tau <= 0.0 {
            continue;
        }
        let e = (-zeta * w * tau).exp();
        let (s, c) = (w * root * tau).sin_cos();
        let a = model.amplitude * e;
        // y = a s; derivatives with respect to A, t_d, f_n, zeta.
        let mut gradient = SVector::<f64, 4>::new(
            e * s,
            a * w * (zeta * s - root * c),
            TAU * tau * a * (root * c - zeta * s),
            a * w * tau * (-s - zeta / root * c),
        );
        for k in 0..4 {
            gradient[k] *= if free[k] { scale[k] } else { 0.0 };
        }
        right += gradient * (x - a * s);
        normal += gradient * gradient.transpose();
    }
    for k in 0..4 {
        if !free[k] || normal[(k, k)] <= 0.0 {
            normal[(k, k)] = 1.0;
        }
    }
    (normal, right)
}
