//! Numerical impulse tests: natural frequency and damping ratio of a pair that stands at a position.
//!
//! As in dissertation section 4.3: under its nominal torque the pair gets a short pulse of torque, and the decay of the transmission error about
//! equilibrium is read twice,
//!
//! * by its maxima: damped frequency from their times, damping ratio from the logarithmic decrement `zeta = d / sqrt(4 pi^2 + d^2)`;
//! * by its spectrum: the frequency of the peak, and `zeta = (f_2 - f_1) / 2 f` from the frequencies where the amplitude is `1 / sqrt 2` of it.

use super::options::{DynamicsRequest, InitialState, Motion, TorquePulse};
use super::result::DynamicsRun;
use super::run::PairDynamics;
use crate::error::FecmError;
use crate::statics::Observer;

/// What an impulse test does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpulseSpec {
    /// Mesh cycle at which the gears stand.
    pub mesh_cycle: f64,
    /// Torque on the wheel (N m).
    pub torque: f64,
    /// Peak of the pulse as a fraction of the torque; teeth must stay in contact for a linear reading.
    pub pulse: f64,
    /// Length of the record in natural periods, 8 to 10,000; the half-power width wants some `1 / zeta` of them.
    pub periods: usize,
}

/// What an impulse test reads.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseReading {
    /// Mesh cycle at which the gears stood.
    pub mesh_cycle: f64,
    /// Undamped natural frequency, from the maxima (Hz).
    pub natural_frequency: f64,
    /// Damping ratio, from the logarithmic decrement.
    pub damping_log_decrement: f64,
    /// Frequency of the peak of the spectrum (Hz).
    pub peak_frequency: f64,
    /// Damping ratio, from the half-power width.
    pub damping_half_power: f64,
    /// Maxima read.
    pub maxima: usize,
    /// The decay.
    pub run: DynamicsRun,
}

/// Steps a natural period: average acceleration lengthens the period by `(2 pi / steps)^2 / 12`, here 8e-6.
const STEPS: usize = 640;

impl PairDynamics<'_> {
    /// Strikes the pair and reads the decay. `None` where fewer than three maxima stand out.
    ///
    /// # Errors
    /// As [`PairDynamics::run`].
    pub fn impulse_test(
        &self,
        spec: &ImpulseSpec,
        observer: &dyn Observer,
    ) -> Result<Option<ImpulseReading>, FecmError> {
        if !(spec.pulse.abs() > 0.0 && spec.pulse.is_finite()) {
            return Err(FecmError::Option {
                name: "pulse",
                value: spec.pulse,
                allowed: "a fraction of the torque, not 0",
            });
        }
        if !(8..=10_000).contains(&spec.periods) {
            let value = spec.periods as f64;
            return Err(FecmError::Option { name: "natural periods", value, allowed: "8 to 10000" });
        }
        let period = 1.0 / self.mesh_vibration(&[spec.mesh_cycle], spec.torque)?.frequency;
        let pulse = TorquePulse { start: 0.0, duration: 0.125 * period, peak: spec.pulse * spec.torque };
        let request = DynamicsRequest {
            mesh_cycle: spec.mesh_cycle,
            motion: Motion::Standing { time_step: period / STEPS as f64 },
            torque: spec.torque,
            pulse: Some(pulse),
            initial: InitialState::Equilibrium,
            snapshots: Vec::new(),
        };
        let mut runner = self.start(&request)?;
        let rest = runner.transmission_error();
        let run = runner.advance(STEPS * spec.periods, observer)?;
        let first = (pulse.duration / run.time_step).ceil() as usize;
        let decay: Vec<f64> = run.records.iter().skip(first).map(|r| r.transmission_error - rest).collect();
        let Some((damped, damping_log_decrement, maxima)) = by_maxima(&decay, run.time_step) else {
            return Ok(None);
        };
        let Some((peak_frequency, damping_half_power)) = by_spectrum(&decay, run.time_step, damped) else {
            return Ok(None);
        };
        let natural_frequency = damped / (1.0 - damping_log_decrement * damping_log_decrement).sqrt();
        let mesh_cycle = spec.mesh_cycle;
        Ok(Some(ImpulseReading {
            mesh_cycle,
            natural_frequency,
            damping_log_decrement,
            peak_frequency,
            damping_half_power,
            maxima,
            run,
        }))
    }
}

/// Damped frequency (Hz), damping ratio and number of maxima of a decay, down to a thousandth of the first maximum.
fn by_maxima(decay: &[f64], step: f64) -> Option<(f64, f64, usize)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for (k, window) in decay.windows(3).enumerate() {
        let [before, here, after] = [window[0], window[1], window[2]];
        let first = found.first().map_or(0.0, |m| m.1);
        if here > before && here >= after && here > 1e-3 * first && here > 0.0 {
            // vertex of the parabola through three samples
            let bend = before - 2.0 * here + after;
            let shift = 0.5 * (before - after) / bend;
            found.push((step * (k as f64 + 1.0 + shift), here - 0.25 * (before - after) * shift));
        }
    }
    let (first, last) = (found.first()?, found.last()?);
    if found.len() < 3 {
        return None;
    }
    let intervals = (found.len() - 1) as f64;
    let frequency = intervals / (last.0 - first.0);
    let decrement = (first.1 / last.1).ln() / intervals;
    Some((frequency, decrement / decrement.hypot(2.0 * std::f64::consts::PI), found.len()))
}

/// Peak frequency (Hz) and half-power damping ratio of a decay's spectrum near a frequency.
fn by_spectrum(decay: &[f64], step: f64, near: f64) -> Option<(f64, f64)> {
    let amplitude = |frequency: f64| {
        let turn = 2.0 * std::f64::consts::PI * frequency * step;
        // rotation by recurrence, started anew often enough that it keeps its digits
        let (mut re, mut im) = (0.0, 0.0);
        for (block, samples) in decay.chunks(256).enumerate() {
            let (mut s, mut c) = (turn * (block * 256) as f64).sin_cos();
            let (ds, dc) = turn.sin_cos();
            for x in samples {
                re += x * c;
                im += x * s;
                (c, s) = (c * dc - s * ds, s * dc + c * ds);
            }
        }
        re.hypot(im)
    };
    const GRID: usize = 200;
    let at = |k: usize| near * (0.7 + 0.6 * k as f64 / GRID as f64);
    let top = (0..=GRID).max_by(|&a, &b| amplitude(at(a)).total_cmp(&amplitude(at(b))))?;
    let (mut low, mut high) = (at(top.saturating_sub(1)), at((top + 1).min(GRID)));
    for _ in 0..60 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if amplitude(a) < amplitude(b) { low = a } else { high = b }
    }
    let peak = 0.5 * (low + high);
    let half = amplitude(peak) / std::f64::consts::SQRT_2;
    // walk to either side, then halve
    let crossing = |direction: f64| -> Option<f64> {
        let mut inside = peak;
        let mut width = 1e-3 * peak;
        let mut outside = peak + direction * width;
        while amplitude(outside) > half {
            inside = outside;
            width *= 1.5;
            outside = peak + direction * width;
            if width > 0.9 * peak {
                return None;
            }
        }
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if amplitude(middle) > half { inside = middle } else { outside = middle }
        }
        Some(inside)
    };
    let (f1, f2) = (crossing(-1.0)?, crossing(1.0)?);
    Some((peak, 0.5 * (f2 - f1) / peak))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_decay_is_read_exactly() {
        for (frequency, ratio) in [(2370.0_f64, 0.048_f64), (2900.0, 0.01), (500.0, 0.1)] {
            let step = 1.0 / (frequency * 640.0);
            let omega = 2.0 * std::f64::consts::PI * frequency;
            let damped = omega * (1.0 - ratio * ratio).sqrt();
            // until nothing is left of the slowest
            let decay: Vec<f64> = (0..640 * 200)
                .map(|k| {
                    let t = f64::from(k) * step;
                    1e-6 * (-ratio * omega * t).exp() * (damped * t).sin()
                })
                .collect();
            let (f, zeta, maxima) = by_maxima(&decay, step).unwrap();
            assert!((f / (damped / (2.0 * std::f64::consts::PI)) - 1.0).abs() < 1e-6 && maxima > 3);
            assert!((zeta / ratio - 1.0).abs() < 1e-4, "{zeta} {ratio}");
            // the width formula is that of small damping
            let (f, zeta) = by_spectrum(&decay, step, frequency).unwrap();
            assert!((f / frequency - 1.0).abs() < 1.5 * ratio * ratio + 1e-4, "{f} {frequency}");
            assert!((zeta / ratio - 1.0).abs() < 2.0 * ratio + 0.01, "{zeta} {ratio}");
        }
    }

    #[test]
    fn no_oscillation_is_no_reading() {
        let decay: Vec<f64> = (0..100).map(|k| (-0.1 * f64::from(k)).exp()).collect();
        assert!(by_maxima(&decay, 1e-6).is_none());
    }
}
