//! Values between samples: linear, cubic spline, band-limited; time to angle.
//!
//! Problem. Synchronous averages need samples at equal angles, which fall between samples at equal
//! times.
//!
//! | method | error for a smooth signal | at a quarter of Nyquist | at 0.8 of Nyquist | ns a sample |
//! |---|---|---|---|---|
//! | [`Interpolation::Linear`] | O(h^2) | 7e-2 | 7e-1 | 4 |
//! | [`Interpolation::CubicSpline`] | O(h^4) | 1e-3 | 3e-1 | 17 |
//! | [`Interpolation::BandLimited`], L = 8, beta = 8 | exponential in L | 3e-5 | 6e-2 | 38 |
//! | the default, L = 24, beta = 12 | | 3e-7 | 2e-6 | 65 |
//! | L = 48, beta = 16 | | 4e-9 | 2e-8 | 118 |
//!
//! Band-limited: `y(x) = sum_k x_k c sinc(c (x - k)) w((x - k) c / L)` with a Kaiser window w of
//! shape beta and half width L samples (Kaiser 1974; Smith and Gossett 1984, ICASSP). Its ripple is
//! about `10^(-a/20)` with `a = beta / 0.1102 + 8.7` dB, for tones below the Nyquist frequency by at
//! least half the transition band `(a - 8) / (4.57 L)` rad per sample (Oppenheim and Schafer,
//! section 7.5.3). `c = min(1, samples in / samples out)` lowers the cut-off where the new grid is coarser,
//! so that nothing aliases; linear and spline interpolation do not filter, and want at least as
//! many samples out as in: [`samples_per_period`].
//!
//! The kernel is tabulated at 512 points per sample with exact slopes; the error of Hermite
//! interpolation in it, `(pi/512)^4 / 384 = 4e-12`, is below any ripple reachable with beta <= 16.
//! The table (largest error for a tone of amplitude 1; one core of a shared machine) is printed by
//! `examples/resampling_error.rs`.
//! Verified by `tests/resampling.rs` (orders two and four, scipy, exponential decay with L).

use crate::error::{HumsError, Result, require_finite, require_len, require_positive};
use crate::tachometer::Shaft;
use gear_numerics::spline;
use std::f64::consts::PI;
use std::sync::Arc;

/// How values between samples are found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Interpolation {
    /// Straight lines.
    Linear,
    /// Cubic spline with not-a-knot ends.
    CubicSpline,
    /// Windowed sinc.
    BandLimited {
        /// Half width L in samples, 2 to 512.
        half_width: usize,
        /// Kaiser shape, 0 to 16.
        beta: f64,
    },
}

impl Default for Interpolation {
    /// Band-limited, L = 24, beta = 12: ripple 1e-6 up to 0.84 of the Nyquist frequency.
    fn default() -> Self {
        Self::BandLimited { half_width: 24, beta: 12.0 }
    }
}

/// Samples on either side that a spline needs for its ends to be forgotten: their influence falls
/// by `2 - sqrt 3` a sample, to 1e-18 after 32.
const SPLINE_MARGIN: usize = 32;
/// Samples of an averaging period at most: half a gigabyte.
pub const MAX_PER_PERIOD: usize = 1 << 26;
/// Points of an angle grid for each sample of the record at most.
const MAX_OVERSAMPLING: f64 = 1024.0;
/// Kernel table resolution, points per sample.
const TABLE: usize = 512;

/// An interpolation made ready: kernel table (shared by clones), work space.
#[derive(Debug, Clone)]
pub struct Resampler {
    method: Interpolation,
    /// Kernel value and slope (per table step) at `i / TABLE` samples, for i = 0..=L * TABLE.
    kernel: Arc<[[f64; 2]]>,
    /// The same kernel by phase: for phase j of 0..=TABLE the 2 L values at taps `k - j / TABLE`,
    /// k = 1 - L..=L, then their 2 L slopes per phase step.
    phases: Arc<[f64]>,
    slopes: Vec<f64>,
}

impl Resampler {
    /// Prepares a method.
    ///
    /// # Errors
    /// [`HumsError::Parameter`] for a half width or beta out of range.
    pub fn new(method: Interpolation) -> Result<Self> {
        let kernel = match method {
            Interpolation::BandLimited { half_width, beta } => {
                if !(2..=512).contains(&half_width) {
                    return Err(HumsError::Parameter {
                        parameter: "half width of the interpolation kernel",
                        value: half_width as f64,
                        allowed: "2 to 512 samples",
                    });
                }
                if !(0.0..=16.0).contains(&beta) {
                    return Err(HumsError::Parameter { parameter: "Kaiser beta", value: beta, allowed: "0 to 16" });
                }
                kernel_table(half_width, beta)
            }
            _ => Vec::new(),
        };
        let phases = match method {
            Interpolation::BandLimited { half_width, .. } => by_phase(&kernel, half_width),
            _ => Vec::new(),
        };
        Ok(Self { method, kernel: kernel.into(), phases: phases.into(), slopes: Vec::new() })
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> Interpolation {
        self.method
    }

    /// Samples needed beyond the first and last position for a value unaffected by the record's
    /// ends; `step` is the distance of positions in samples.
    pub(crate) fn margin(&self, step: f64) -> usize {
        match self.method {
            Interpolation::Linear => 1,
            Interpolation::CubicSpline => SPLINE_MARGIN,
            Interpolation::BandLimited { half_width, .. } => (half_width as f64 * step.max(1.0)).ceil() as usize + 1,
        }
    }

    /// Whether values within the margin of the record's ends are inexact (zeros are assumed beyond).
    pub(crate) fn needs_margin(&self) -> bool {
        matches!(self.method, Interpolation::BandLimited { .. })
    }

    /// Values of `signal` at `positions` (in samples, 0 the first sample, increasing), appended to
    /// `out`. Positions outside 0..=N-1 take the end's cubic or zeros, so the caller keeps within.
    pub(crate) fn evaluate(&mut self, signal: &[f64], positions: &[f64], out: &mut Vec<f64>) {
        let n = signal.len();
        if n == 1 {
            out.extend(positions.iter().map(|_| signal[0]));
            return;
        }
        let cell = |p: f64| (p.max(0.0) as usize).min(n.saturating_sub(2));
        match self.method {
            Interpolation::Linear => out.extend(positions.iter().map(|&p| {
                let i = cell(p);
                signal[i] + (p - i as f64) * (signal[i + 1] - signal[i])
            })),
            Interpolation::CubicSpline => {
                spline::uniform_slopes(signal, &mut self.slopes);
                out.extend(positions.iter().map(|&p| {
                    let i = cell(p);
                    let y = [signal[i], signal[i + 1]];
                    let s = [self.slopes[i], self.slopes[i + 1]];
                    spline::hermite(p - i as f64, 1.0, y, s)
                }));
            }
            Interpolation::BandLimited { half_width, .. } => {
                let step = mean_step(positions);
                let cutoff = if step > 1.0 { 1.0 / step } else { 1.0 };
                let reach = half_width as f64 / cutoff;
                out.extend(positions.iter().map(|&p| match self.whole_kernel(signal, p, half_width) {
                    Some(value) if step <= 1.0 => value,
                    _ => self.windowed_sinc(signal, p, cutoff, reach),
                }));
            }
        }
    }

    /// Without a lowered cut-off and away from the ends: all taps share one phase, so that Hermite
    /// interpolation in the table becomes four dot products of contiguous rows.
    fn whole_kernel(&self, signal: &[f64], p: f64, half_width: usize) -> Option<f64> {
        let i = p.max(0.0) as usize;
        let taps = signal.get((i + 1).checked_sub(half_width)?..=i + half_width)?;
        let place = (p - i as f64) * TABLE as f64;
        let j = (place as usize).min(TABLE - 1);
        let u = place - j as f64;
        let width = 2 * half_width;
        let rows = &self.phases[2 * width * j..2 * width * (j + 2)];
        let (y0, rest) = rows.split_at(width);
        let (s0, rest) = rest.split_at(width);
        let (y1, s1) = rest.split_at(width);
        let mut dots = [[0.0; 2]; 4];
        for (k, x) in taps.chunks_exact(2).enumerate() {
            for lane in 0..2 {
                let at = 2 * k + lane;
                dots[0][lane] += x[lane] * y0[at];
                dots[1][lane] += x[lane] * s0[at];
                dots[2][lane] += x[lane] * y1[at];
                dots[3][lane] += x[lane] * s1[at];
            }
        }
        let [y0, s0, y1, s1] = dots.map(|d| d[0] + d[1]);
        Some(spline::hermite(u, 1.0, [y0, y1], [s0, s1]))
    }

    fn windowed_sinc(&self, signal: &[f64], p: f64, cutoff: f64, reach: f64) -> f64 {
        let first = (p - reach).ceil().max(0.0) as usize;
        let last = ((p + reach).floor().max(0.0) as usize).min(signal.len() - 1);
        if first > last {
            return 0.0;
        }
        let scale = cutoff * TABLE as f64;
        let highest = self.kernel.len() - 2;
        let mut sum = 0.0;
        for (k, x) in signal[first..=last].iter().enumerate() {
            let place = ((first + k) as f64 - p).abs() * scale;
            let i = (place as usize).min(highest);
            let u = place - i as f64;
            let ([y0, s0], [y1, s1]) = (self.kernel[i], self.kernel[i + 1]);
            sum += x * spline::hermite(u, 1.0, [y0, y1], [s0, s1]);
        }
        sum * cutoff
    }
}

fn mean_step(positions: &[f64]) -> f64 {
    match positions {
        [first, .., last] => (last - first) / (positions.len() - 1) as f64,
        _ => 1.0,
    }
}

fn kernel_table(half_width: usize, beta: f64) -> Vec<[f64; 2]> {
    let l = half_width as f64;
    let i0_beta = bessel_i0(beta);
    (0..=half_width * TABLE + 1)
        .map(|i| {
            let x = i as f64 / TABLE as f64;
            let r = x / l;
            let root = (1.0 - r * r).max(0.0).sqrt();
            let w = bessel_i0(beta * root) / i0_beta;
            // d/dr I0(beta sqrt(1 - r^2)) = -beta r I1(beta root) / root; I1(z)/z -> 1/2.
            let w_slope = -beta * beta * r * bessel_i1_over(beta * root) / i0_beta / l;
            let (s, s_slope) = sinc(x);
            [s * w, (s_slope * w + s * w_slope) / TABLE as f64]
        })
        .collect()
}

fn by_phase(kernel: &[[f64; 2]], half_width: usize) -> Vec<f64> {
    let width = 2 * half_width;
    let mut rows = Vec::with_capacity(2 * width * (TABLE + 1));
    for j in 0..=TABLE {
        // Distance of tap k = m + 1 - L from the position, in table steps, with its sign.
        let taps = (0..width).map(|m| {
            let steps = (m as i64 + 1 - half_width as i64) * TABLE as i64 - j as i64;
            let [value, slope] = kernel[steps.unsigned_abs() as usize];
            // The distance falls as the phase grows, for taps ahead.
            (value, if steps > 0 { -slope } else { slope })
        });
        let (values, slopes): (Vec<f64>, Vec<f64>) = taps.unzip();
        rows.extend(values);
        rows.extend(slopes);
    }
    rows
}

/// `sin(pi x) / (pi x)` and its derivative.
fn sinc(x: f64) -> (f64, f64) {
    if x < 1e-4 {
        let z = PI * x;
        return (1.0 - z * z / 6.0, -PI * z / 3.0);
    }
    // sin(pi x) vanishes exactly at whole x, where the kernel must be exactly 0.
    let s = if x.fract() == 0.0 { 0.0 } else { (PI * x).sin() };
    let value = s / (PI * x);
    (value, ((PI * x).cos() - value) / x)
}

/// Modified Bessel function I0 by its power series (all terms positive: no cancellation).
fn bessel_i0(z: f64) -> f64 {
    let q = z * z / 4.0;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..200 {
        term *= q / (k * k) as f64;
        sum += term;
        if term <= sum * f64::EPSILON {
            break;
        }
    }
    sum
}

/// I1(z) / z by its power series.
fn bessel_i1_over(z: f64) -> f64 {
    let q = z * z / 4.0;
    let (mut term, mut sum) = (0.5, 0.5);
    for k in 1..200 {
        term *= q / (k * (k + 1)) as f64;
        sum += term;
        if term <= sum * f64::EPSILON {
            break;
        }
    }
    sum
}

/// Values of a signal at positions in samples (0 = first sample), in any unit of the signal.
///
/// Positions for [`Interpolation::BandLimited`] are taken as a grid whose mean distance sets the
/// anti-aliasing cut-off; within the half width of the record's ends zeros are assumed beyond.
///
/// # Errors
/// Empty or non-finite signal; [`HumsError::Parameter`] for a position outside `0..=N-1`.
pub fn resample(signal: &[f64], positions: &[f64], method: Interpolation) -> Result<Vec<f64>> {
    require_len("resampling", signal, 1)?;
    require_finite("resampling", signal)?;
    let end = (signal.len() - 1) as f64;
    if let Some(&p) = positions.iter().find(|p| !(**p >= 0.0 && **p <= end)) {
        return Err(HumsError::Parameter { parameter: "position", value: p, allowed: "0 to the last sample's index" });
    }
    let mut out = Vec::with_capacity(positions.len());
    Resampler::new(method)?.evaluate(signal, positions, &mut out);
    Ok(out)
}

/// A signal on a grid of equal angles.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleSignal {
    /// Samples, unit of the signal.
    pub samples: Vec<f64>,
    /// Turn of the first sample.
    pub first_turn: f64,
    /// Samples per turn.
    pub per_turn: usize,
}

/// Resamples a record (`rate` Hz) to `per_turn` samples a turn of the shaft, over every turn the
/// record and the tachometer cover: order tracking by computed resampling (Fyfe and Munck 1997,
/// Mech. Syst. Signal Process. 11:187).
///
/// # Errors
/// Non-finite samples; a rate or `per_turn` that is not positive; [`HumsError::Undefined`] when
/// record and tachometer share no point of the grid.
pub fn to_angle(
    signal: &[f64],
    rate: f64,
    shaft: &Shaft,
    per_turn: usize,
    method: Interpolation,
) -> Result<AngleSignal> {
    const WHAT: &str = "angle resampling";
    require_positive("sampling rate", rate)?;
    require_positive("samples per turn", per_turn as f64)?;
    require_len(WHAT, signal, 2)?;
    require_finite(WHAT, signal)?;
    let mut resampler = Resampler::new(method)?;
    let slowest = shaft.speed_range().0;
    let pad = if resampler.needs_margin() { resampler.margin(rate / (slowest * per_turn as f64)) as f64 } else { 0.0 };
    let step = 1.0 / per_turn as f64;
    let (from, to) = shaft.time_range();
    let start = from.max(pad / rate);
    let end = to.min(((signal.len() - 1) as f64 - pad) / rate);
    let grid = |t: f64| shaft.turn_at(t).map(|turn| turn * per_turn as f64);
    let (Some(low), Some(high)) = (grid(start), grid(end)) else {
        return Err(no_overlap(WHAT));
    };
    // A grid point within rounding of the range's ends counts as inside.
    let (low, high) = ((low - 1e-9).ceil(), (high + 1e-9).floor());
    if !(start <= end && low <= high) {
        return Err(no_overlap(WHAT));
    }
    if !(high - low < MAX_OVERSAMPLING * signal.len() as f64) {
        return Err(HumsError::Parameter {
            parameter: "samples per turn",
            value: per_turn as f64,
            allowed: "at most 1024 points of angle for each sample of the record",
        });
    }
    let count = (high - low) as usize + 1;
    let mut positions = Vec::with_capacity(count);
    shaft.times_of(low * step, step, count, &mut positions);
    let last = (signal.len() - 1) as f64;
    positions.iter_mut().for_each(|t| *t = (*t * rate).clamp(0.0, last));
    let mut samples = Vec::with_capacity(count);
    // In pieces, so that the cut-off follows the speed.
    for piece in positions.chunks(per_turn) {
        evaluate_piece(&mut resampler, signal, piece, &mut samples);
    }
    Ok(AngleSignal { samples, first_turn: low * step, per_turn })
}

/// Evaluates increasing positions on the part of the signal that they need.
pub(crate) fn evaluate_piece(resampler: &mut Resampler, signal: &[f64], positions: &[f64], out: &mut Vec<f64>) {
    let (Some(&first), Some(&last)) = (positions.first(), positions.last()) else {
        return;
    };
    let margin = resampler.margin(mean_step(positions));
    let from = (first.max(0.0) as usize).saturating_sub(margin);
    let to = (last.max(0.0) as usize + 2 + margin).min(signal.len());
    let local: Vec<f64> = positions.iter().map(|p| p - from as f64).collect();
    resampler.evaluate(&signal[from..to], &local, out);
}

fn no_overlap(what: &'static str) -> HumsError {
    HumsError::Undefined { what, reason: "record and tachometer share no point of the angle grid" }
}

/// Samples per period so that no angle interval is longer than a time interval: the power of two at
/// or above `rate * period_turns / slowest speed` (to 1e-9).
///
/// # Errors
/// [`HumsError::Parameter`] for a rate or period that is not positive, or above 2^26 samples.
pub fn samples_per_period(rate: f64, shaft: &Shaft, period_turns: f64) -> Result<usize> {
    require_positive("sampling rate", rate)?;
    require_positive("averaging period", period_turns)?;
    let needed = rate * period_turns / shaft.speed_range().0;
    if !(needed <= MAX_PER_PERIOD as f64) {
        return Err(HumsError::Parameter {
            parameter: "samples per averaging period",
            value: needed,
            allowed: "at most 2^26",
        });
    }
    // Rounding of the pulse times must not double the number.
    Ok(((needed * (1.0 - 1e-9)).ceil() as usize).max(2).next_power_of_two())
}
