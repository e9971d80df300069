//! Analytic signal, envelope, and demodulation of one mesh harmonic.
//!
//! Problem. A local fault modulates the mesh vibration. The band around a mesh harmonic, turned
//! into an analytic signal `z = x + i H[x]`, gives amplitude modulation `|z|` and phase modulation
//! `arg z - m theta` (McFadden 1986, J. Vib. Acoust. 108:165). The amplitude is the input of NB4.
//!
//! Method. Discrete Fourier transform of the record, one side kept and doubled, and back (Marple
//! 1999, IEEE Trans. Sig. Proc. 47:2600): exact for signals periodic in the record, hence meant
//! for synchronous averages; raw records show end effects.
//!
//! Units: amplitude in the signal's unit, phase in rad. Verified by `tests/spectra.rs`.

use crate::error::{HumsError, Result, require_finite, require_len};
use crate::spectrum::{Spectrum, forward};
use gear_numerics::fft::{Complex, Fft, complex_inverse};
use std::f64::consts::{PI, TAU};

/// Analytic signal `x + i H[x]` of the whole band (mean included).
///
/// # Errors
/// Empty signal or non-finite sample.
pub fn analytic_signal(signal: &[f64]) -> Result<Vec<Complex<f64>>> {
    require_len("analytic signal", signal, 1)?;
    require_finite("analytic signal", signal)?;
    let bins = forward(&mut signal.to_vec());
    let highest = bins.len() - 1;
    Ok(one_sided_inverse(&bins, signal.len(), 0..=highest, complex_inverse(signal.len()).as_ref()))
}

/// Envelope `|x + i H[x]|` of the whole band, unit of the signal.
///
/// # Errors
/// Empty signal or non-finite sample.
pub fn envelope(signal: &[f64]) -> Result<Vec<f64>> {
    Ok(moduli(&analytic_signal(signal)?))
}

/// Amplitude spectrum of the envelope, its mean removed (rectangular window).
///
/// # Errors
/// Empty signal or non-finite sample.
pub fn envelope_spectrum(signal: &[f64]) -> Result<Spectrum> {
    let mut envelope = envelope(signal)?;
    crate::signal::detrend(&mut envelope, false)?;
    Spectrum::of(&envelope, crate::spectrum::Window::Rectangular)
}

/// A band of a synchronous average, demodulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Demodulated {
    /// The band itself, unit of the signal.
    pub band: Vec<f64>,
    /// Amplitude modulation `|z|`, unit of the signal.
    pub amplitude: Vec<f64>,
    /// Phase modulation `arg z - carrier * theta`, unwrapped, starting in (-pi, pi], rad.
    pub phase: Vec<f64>,
}

/// Band-pass signal of the orders `carrier - half_width ..= carrier + half_width` with amplitude
/// and phase modulation.
///
/// # Errors
/// [`HumsError::Parameter`] unless `0 < half_width < carrier`; [`HumsError::OrderNotResolved`] when
/// the band passes the Nyquist order; empty signal or non-finite sample.
pub fn demodulate(average: &[f64], carrier: usize, half_width: usize) -> Result<Demodulated> {
    require_len("demodulation", average, 2)?;
    require_finite("demodulation", average)?;
    demodulate_bins(&forward(&mut average.to_vec()), average.len(), carrier, half_width)
}

pub(crate) fn demodulate_bins(
    bins: &[Complex<f64>],
    samples: usize,
    carrier: usize,
    half_width: usize,
) -> Result<Demodulated> {
    let z = band_analytic(bins, samples, carrier, half_width, complex_inverse(samples).as_ref())?;
    let mut phase = Vec::with_capacity(samples);
    let mut last = 0.0;
    for (n, value) in z.iter().enumerate() {
        // carrier * n modulo the period, so that the product stays exact for long records.
        let turn = (carrier as u128 * n as u128 % samples as u128) as f64 / samples as f64;
        let raw = value.arg() - TAU * turn;
        let wrapped = raw - TAU * ((raw - last) / TAU).round();
        let unwrapped = if n == 0 { raw - TAU * ((raw - PI) / TAU).ceil() } else { wrapped };
        phase.push(unwrapped);
        last = unwrapped;
    }
    Ok(Demodulated { band: z.iter().map(|v| v.re).collect(), amplitude: moduli(&z), phase })
}

pub(crate) fn band_analytic(
    bins: &[Complex<f64>],
    samples: usize,
    carrier: usize,
    half_width: usize,
    plan: &dyn Fft<f64>,
) -> Result<Vec<Complex<f64>>> {
    let mut buffers = AnalyticBuffers::default();
    band_analytic_into(bins, samples, carrier, half_width, plan, &mut buffers)?;
    Ok(buffers.z)
}

/// An analytic signal and the work space of its transform, to be used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct AnalyticBuffers {
    pub(crate) z: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

pub(crate) fn band_analytic_into(
    bins: &[Complex<f64>],
    samples: usize,
    carrier: usize,
    half_width: usize,
    plan: &dyn Fft<f64>,
    buffers: &mut AnalyticBuffers,
) -> Result<()> {
    if half_width == 0 || half_width >= carrier {
        return Err(HumsError::Parameter {
            parameter: "half width of the band",
            value: half_width as f64,
            allowed: "at least 1 order and below the carrier's order",
        });
    }
    let upper = carrier + half_width;
    if 2 * upper >= samples {
        return Err(HumsError::OrderNotResolved { order: upper, highest: samples.saturating_sub(1) / 2, samples });
    }
    one_sided_inverse_into(bins, samples, carrier - half_width..=upper, plan, buffers);
    Ok(())
}

/// Analytic signal of a range of one-sided bins: DC and Nyquist once, the others doubled.
fn one_sided_inverse(
    bins: &[Complex<f64>],
    samples: usize,
    range: std::ops::RangeInclusive<usize>,
    plan: &dyn Fft<f64>,
) -> Vec<Complex<f64>> {
    let mut buffers = AnalyticBuffers::default();
    one_sided_inverse_into(bins, samples, range, plan, &mut buffers);
    buffers.z
}

fn one_sided_inverse_into(
    bins: &[Complex<f64>],
    samples: usize,
    range: std::ops::RangeInclusive<usize>,
    plan: &dyn Fft<f64>,
    buffers: &mut AnalyticBuffers,
) {
    let AnalyticBuffers { z, scratch } = buffers;
    let zero = Complex::new(0.0, 0.0);
    z.clear();
    z.resize(samples, zero);
    for k in range {
        let sides = if k == 0 || 2 * k == samples { 1.0 } else { 2.0 };
        z[k] = bins[k] * (sides / samples as f64);
    }
    scratch.resize(plan.get_inplace_scratch_len(), zero);
    plan.process_with_scratch(z, scratch);
}

/// Moduli `|z|`; without the care of `hypot` where squares can neither overflow nor vanish.
pub(crate) fn moduli(z: &[Complex<f64>]) -> Vec<f64> {
    let mut out = Vec::new();
    moduli_into(z, &mut out);
    out
}

pub(crate) fn moduli_into(z: &[Complex<f64>], out: &mut Vec<f64>) {
    out.clear();
    let largest = z.iter().fold(0.0_f64, |m, v| m.max(v.re.abs()).max(v.im.abs()));
    if (1e-140..1e140).contains(&largest) {
        out.extend(z.iter().map(|v| v.norm_sqr().sqrt()));
    } else {
        out.extend(z.iter().map(|v| v.norm()));
    }
}
