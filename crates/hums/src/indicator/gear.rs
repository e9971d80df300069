//! Indicators that use the mesh order: FM0, energy ratio, sidebands.
//!
//! With `A(m)` the amplitude at order m of the synchronous average, z the mesh order, s the
//! sideband spacing:
//!
//! | indicator | formula | source |
//! |---|---|---|
//! | FM0 | `PP(x) / sum_h A(h z)` | Stewart 1977 |
//! | energy ratio | `sigma(difference) / sigma(regular)` | Swansson 1980; D B.2 |
//! | sideband index | `[A(z - s) + A(z + s)] / 2`, unit of the signal | Szczepanik 1989 |
//! | sideband level factor | `[A(z - s) + A(z + s)] / sigma(x)` | Zakrajsek 1993 |
//! | sideband energy ratio | `sum_(i=1..6) [A(z - i s) + A(z + i s)] / A(z)` | Hanna et al. 2011 |
//!
//! Verified by `tests/indicators.rs` on modulated tones with known lines.

use super::basic::peak_to_peak_of;
use crate::error::{HumsError, Result};
use crate::moments::Moments;
use crate::spectrum::Spectrum;

/// Lines with amplitudes below this many times epsilon of the largest line are rounding of the
/// transform, not vibration.
const LINE_FLOOR: f64 = 64.0 * f64::EPSILON;

/// Sideband pairs in the sideband energy ratio, by its published definition.
pub const SER_PAIRS: usize = 6;

/// Size of rounding in the spectrum's amplitudes. The larger of real and imaginary part stands in for
/// the modulus: no overflow, no square roots.
fn floor_of(spectrum: &Spectrum) -> f64 {
    let largest = spectrum.bins().iter().fold(0.0_f64, |m, bin| m.max(bin.re.abs()).max(bin.im.abs()));
    LINE_FLOOR * 2.0 * largest / spectrum.samples() as f64
}

/// Zero-order figure of merit FM0: peak to peak over the sum of the first `harmonics` mesh
/// amplitudes (those up to the Nyquist order).
///
/// # Errors
/// [`HumsError::Undefined`] when no mesh amplitude rises above rounding;
/// [`HumsError::OrderNotResolved`] when not even the fundamental is resolved.
pub fn fm0(average: &Moments, spectrum: &Spectrum, mesh_order: usize, harmonics: usize) -> Result<f64> {
    spectrum.amplitude(mesh_order)?;
    let highest = spectrum.bins().len() - 1;
    let sum: f64 =
        (1..=harmonics.min(highest / mesh_order.max(1))).filter_map(|h| spectrum.amplitude(h * mesh_order).ok()).sum();
    if mesh_order == 0 || sum <= floor_of(spectrum) {
        return Err(HumsError::Undefined { what: "FM0", reason: "there is no mesh-harmonic amplitude to divide by" });
    }
    Ok(peak_to_peak_of(average)? / sum)
}

/// Energy ratio of the difference to the regular signal, standard deviations.
///
/// # Errors
/// [`HumsError::Undefined`] when the regular signal is constant.
pub fn energy_ratio(difference: &Moments, regular: &Moments) -> Result<f64> {
    if regular.is_constant() {
        return Err(HumsError::Undefined { what: "energy ratio", reason: "the regular signal has no variance" });
    }
    Ok(difference.standard_deviation() / regular.standard_deviation())
}

fn sideband_sum(spectrum: &Spectrum, mesh_order: usize, spacing: usize, pairs: usize) -> Result<f64> {
    let reach = pairs.saturating_mul(spacing);
    if spacing == 0 || reach >= mesh_order {
        return Err(HumsError::Parameter {
            parameter: "sideband spacing times pairs",
            value: reach as f64,
            allowed: "at least 1 and below the mesh order",
        });
    }
    (1..=pairs).try_fold(0.0, |sum, i| {
        let offset = i * spacing;
        Ok(sum + spectrum.amplitude(mesh_order - offset)? + spectrum.amplitude(mesh_order + offset)?)
    })
}

/// Sideband index: mean amplitude of the first sideband pair of the fundamental, unit of the signal.
///
/// # Errors
/// Sidebands outside the spectrum.
pub fn sideband_index(spectrum: &Spectrum, mesh_order: usize, spacing: usize) -> Result<f64> {
    Ok(sideband_sum(spectrum, mesh_order, spacing, 1)? / 2.0)
}

/// Sideband level factor: sum of the first sideband pair over the average's standard deviation.
///
/// # Errors
/// Sidebands outside the spectrum; [`HumsError::Undefined`] for a constant average.
pub fn sideband_level_factor(average: &Moments, spectrum: &Spectrum, mesh_order: usize, spacing: usize) -> Result<f64> {
    let sum = sideband_sum(spectrum, mesh_order, spacing, 1)?;
    if average.is_constant() {
        return Err(HumsError::Undefined { what: "sideband level factor", reason: "the average has no variance" });
    }
    Ok(sum / average.standard_deviation())
}

/// Sideband energy ratio: six sideband pairs over the fundamental's amplitude.
///
/// # Errors
/// Sidebands outside the spectrum; [`HumsError::Undefined`] without a mesh line.
pub fn sideband_energy_ratio(spectrum: &Spectrum, mesh_order: usize, spacing: usize) -> Result<f64> {
    let sum = sideband_sum(spectrum, mesh_order, spacing, SER_PAIRS)?;
    let mesh = spectrum.amplitude(mesh_order)?;
    if mesh <= floor_of(spectrum) {
        return Err(HumsError::Undefined {
            what: "sideband energy ratio",
            reason: "the mesh fundamental has no amplitude",
        });
    }
    Ok(sum / mesh)
}
