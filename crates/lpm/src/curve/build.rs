//! Making curves: constant, steps, waves, tables, Fourier series.

use super::{Curve, Interpolation, Piece, Repr};
use crate::error::{LpmError, check};
use gear_numerics::spline::periodic_second_derivatives;

impl Curve {
    /// The same value everywhere.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for a value that is not finite.
    pub fn constant(value: f64) -> Result<Self, LpmError> {
        check(true, "constant value", value, "-", "finite")?;
        Ok(Self::assemble(1, vec![Piece { start: 0.0, a: [value, 0.0, 0.0, 0.0], kink: false }]))
    }

    /// Piecewise constant: `steps` holds (phase at which the value begins, value), phases ascending in `[0, period)`.
    ///
    /// # Errors
    /// [`LpmError::Table`] for phases that do not ascend in `[0, period)` or values that are not finite; [`LpmError::Length`] for an empty list;
    /// [`LpmError::OutOfRange`] for a period of 0.
    pub fn steps(period: usize, steps: &[(f64, f64)]) -> Result<Self, LpmError> {
        let (phases, values): (Vec<f64>, Vec<f64>) = steps.iter().copied().unzip();
        check_table(period, &phases, &values, 1)?;
        let pieces = steps.iter().map(|&(start, v)| Piece { start, a: [v, 0.0, 0.0, 0.0], kink: true }).collect();
        Ok(Self::from_pieces(period, pieces))
    }

    /// Rectangular wave of one cycle: `high` from phase `rise` for a fraction `duty` of the cycle, `low` elsewhere.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] unless `0 <= rise < 1` and `0 < duty < 1`; [`LpmError::Table`] for values that are not finite.
    pub fn rectangular(low: f64, high: f64, rise: f64, duty: f64) -> Result<Self, LpmError> {
        check((0.0..1.0).contains(&rise), "rise", rise, "cycles", "in [0, 1)")?;
        check(duty > 0.0 && duty < 1.0, "duty", duty, "-", "between 0 and 1, both excluded")?;
        let fall = (rise + duty) % 1.0;
        let mut steps = [(rise, high), (fall, low)];
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self::steps(1, &steps)
    }

    /// Rectangular wave with ramps: straight lines of length `ramp` (cycles) centred on the two jumps.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] unless `0 <= rise < 1`, `0 < duty < 1` and `0 < ramp < min(duty, 1 - duty)`; [`LpmError::Table`] for values
    /// that are not finite.
    pub fn trapezoidal(low: f64, high: f64, rise: f64, duty: f64, ramp: f64) -> Result<Self, LpmError> {
        check((0.0..1.0).contains(&rise), "rise", rise, "cycles", "in [0, 1)")?;
        check(duty > 0.0 && duty < 1.0, "duty", duty, "-", "between 0 and 1, both excluded")?;
        let room = duty.min(1.0 - duty);
        check(ramp > 0.0 && ramp < room, "ramp", ramp, "cycles", "above 0, below both plateaus")?;
        let r = 0.5 * ramp;
        let mut pts: Vec<(f64, f64)> =
            [(rise - r, low), (rise + r, high), (rise + duty - r, high), (rise + duty + r, low)]
                .iter()
                .map(|&(t, v)| (t.rem_euclid(1.0), v))
                .collect();
        pts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (phases, values): (Vec<f64>, Vec<f64>) = pts.into_iter().unzip();
        Self::table(1, &phases, &values, Interpolation::Linear)
    }

    /// Table of values at ascending phases in `[0, period)`; the curve closes on itself after `period` cycles.
    ///
    /// # Errors
    /// As [`Self::steps`]; [`LpmError::Length`] for lists of different length, or fewer points than the interpolation needs (2, splines 3).
    pub fn table(
        period: usize,
        phases: &[f64],
        values: &[f64],
        interpolation: Interpolation,
    ) -> Result<Self, LpmError> {
        let least = if interpolation == Interpolation::Spline { 3 } else { 2 };
        check_table(period, phases, values, least)?;
        let n = phases.len();
        let next = |i: usize| {
            if i + 1 < n { (phases[i + 1], values[i + 1]) } else { (phases[0] + period as f64, values[0]) }
        };
        let width: Vec<f64> = (0..n).map(|i| next(i).0 - phases[i]).collect();
        let slope: Vec<f64> = (0..n).map(|i| (next(i).1 - values[i]) / width[i]).collect();
        let pieces = match interpolation {
            Interpolation::Linear => {
                (0..n).map(|i| Piece { start: phases[i], a: [values[i], slope[i], 0.0, 0.0], kink: true }).collect()
            }
            Interpolation::Spline => {
                let m = periodic_second_derivatives(&width, &slope);
                if !m.iter().all(|v| v.is_finite()) {
                    return Err(LpmError::Singular { place: "periodic spline" });
                }
                (0..n)
                    .map(|i| {
                        let (m0, m1, h) = (m[i], m[(i + 1) % n], width[i]);
                        let a = [values[i], slope[i] - h * (2.0 * m0 + m1) / 6.0, 0.5 * m0, (m1 - m0) / (6.0 * h)];
                        Piece { start: phases[i], a, kink: false }
                    })
                    .collect()
            }
        };
        Ok(Self::from_pieces(period, pieces))
    }

    /// Table of equally spaced values, the first at phase 0.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn samples(period: usize, values: &[f64], interpolation: Interpolation) -> Result<Self, LpmError> {
        let n = values.len().max(1) as f64;
        let phases: Vec<f64> = (0..values.len()).map(|i| i as f64 * period as f64 / n).collect();
        Self::table(period, &phases, values, interpolation)
    }

    /// Fourier series of period one cycle: `mean + sum_j (c_j cos 2 pi j tau + s_j sin 2 pi j tau)`, `harmonics[j-1] = (c_j, s_j)`.
    ///
    /// # Errors
    /// [`LpmError::OutOfRange`] for coefficients that are not finite.
    pub fn fourier(mean: f64, harmonics: &[(f64, f64)]) -> Result<Self, LpmError> {
        check(true, "mean of a Fourier series", mean, "-", "finite")?;
        for &(c, s) in harmonics {
            check(true, "cosine coefficient", c, "-", "finite")?;
            check(true, "sine coefficient", s, "-", "finite")?;
        }
        Ok(Self { period: 1, repr: Repr::Fourier { mean, harmonics: harmonics.to_vec() } })
    }
}

fn check_table(period: usize, phases: &[f64], values: &[f64], least: usize) -> Result<(), LpmError> {
    check(period >= 1, "period", period as f64, "cycles", "at least 1")?;
    if phases.len() != values.len() {
        return Err(LpmError::Length { what: "values of a table", found: values.len(), needed: "as many as phases" });
    }
    if phases.len() < least {
        let needed = match least {
            1 => "at least 1",
            2 => "at least 2",
            _ => "at least 3",
        };
        return Err(LpmError::Length { what: "points of a table", found: phases.len(), needed });
    }
    for (index, (&phase, &value)) in phases.iter().zip(values).enumerate() {
        let fault = |reason| Err(LpmError::Table { index, phase, reason });
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
        return Err(LpmError::Table { index, phase: phases[index], reason: "coincides with the first point" });
    }
    Ok(())
}
