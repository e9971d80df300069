//! What eliminating the supports costs: the error of the response, estimated before it is computed.
//!
//! An eliminated support gives way like its spring alone, `1/k_i`; an integrated one by its dynamic compliance
//! `G_i(w) = 1 / (k_i - m_i w^2 + i w c_i)`. With the mesh linearised about its mean (`Z = k + i w c`, teeth in contact) a fluctuation
//! `P(w)` of the mesh force moves the pair by
//!
//! ```text
//! integrated   x = -P / (Z - m_e w^2 (1 + Z (G_p + G_g)))
//! eliminated   x = -P / (k + i w c l - m_e w^2 / l),        l = 1 / (1 + k (1/k_p + 1/k_g))
//! ```
//!
//! `P` is the fluctuation of `k(tau) (delta_0(tau) - mean)` over the period of the excitation. The estimate is the root of the summed squares of
//! the difference of both over that of the integrated one, all harmonics together: it holds the static and the dynamic stiffness of the
//! eliminated coordinates at the frequencies of the response, and their amplification near a resonance. Loss of contact is not in it.
//!
//! Test: `tests/supports.rs`, against the difference of both models.

use nalgebra::Complex;

use crate::error::{LpmError, check};
use crate::excitation::Excitation;
use crate::model::GearPair;
use crate::spectrum::Spectrum;
use crate::system::System;
use std::f64::consts::TAU;

/// Samples of a mesh cycle.
const SAMPLES: usize = 64;
/// Samples of a long period.
const MAX_SAMPLES: usize = 1 << 16;

/// Estimated error of the transmission error of eliminated supports at `mesh_frequency` (Hz), root mean square, over its variation with
/// integrated supports.
///
/// # Errors
/// Pairs and frequencies out of range.
pub fn elimination_error(pair: &GearPair, excitation: &Excitation, mesh_frequency: f64) -> Result<f64, LpmError> {
    pair.validate()?;
    check((1e-6..=1e9).contains(&mesh_frequency), "mesh frequency", mesh_frequency, "Hz", "between 1e-6 and 1e9")?;
    let (k, delta) = (excitation.mesh_stiffness(), excitation.transmission_error());
    let period = excitation.period();
    let count = (SAMPLES * period).min(MAX_SAMPLES);
    let at = |i: usize| {
        let tau = i as f64 * period as f64 / count as f64;
        (k.value(tau), delta.value(tau))
    };
    let (mut stiffness, mut moment) = (0.0, 0.0);
    for (k, delta) in (0..count).map(at) {
        stiffness += k / count as f64;
        moment += k * delta / count as f64;
    }
    let mean = moment / stiffness;
    let force: Vec<f64> = (0..count).map(at).map(|(k, delta)| k * (delta - mean)).collect();
    let lines = Spectrum::of(&force, period as f64 / mesh_frequency)?;
    let (mass, damping) = (pair.effective_mass(), pair.mesh_damping);
    let supports = [&pair.pinion, &pair.gear];
    let series: f64 = supports.iter().map(|gear| 1.0 / gear.support_stiffness).sum();
    let lever = 1.0 / (1.0 + stiffness * series);
    let (mut error, mut whole) = (0.0, 0.0);
    for (frequency, amplitude) in lines.frequency.iter().zip(&lines.amplitude).skip(1) {
        let w = TAU * frequency;
        let mesh = Complex::new(stiffness, w * damping);
        let support = |gear: &crate::model::Gear| {
            Complex::new(gear.support_stiffness - gear.mass * w * w, w * gear.support_damping).inv()
        };
        let compliance: Complex<f64> = support(supports[0]) + support(supports[1]);
        let integrated = (mesh - (mesh * compliance + 1.0) * (mass * w * w)).inv();
        let eliminated = Complex::new(stiffness - mass * w * w / lever, w * damping * lever).inv();
        error += amplitude * amplitude * (eliminated - integrated).norm_sqr();
        whole += amplitude * amplitude * integrated.norm_sqr();
    }
    let ratio = (error / whole).sqrt();
    // nothing moves under a constant mesh, and a support at its resonance without damping answers without bound
    Ok(match ratio.is_finite() {
        true => ratio,
        false if error == 0.0 => 0.0,
        false => f64::INFINITY,
    })
}

/// Relative error of the natural frequency of the mesh mode with eliminated supports, largest over the mesh cycle: what free motion (an
/// impulse test) shows.
///
/// # Errors
/// Pairs out of range.
pub fn elimination_frequency_error(pair: &GearPair, excitation: &Excitation) -> Result<f64, LpmError> {
    pair.validate()?;
    let three = System::three(pair, excitation);
    let one = System::one(pair, excitation, 1.0 / pair.pinion.support_stiffness + 1.0 / pair.gear.support_stiffness);
    let period = excitation.period();
    let count = (SAMPLES * period).min(MAX_SAMPLES);
    let at = |i: usize| {
        let tau = i as f64 * period as f64 / count as f64;
        let eliminated = one.natural_frequencies(tau)[0];
        let nearest = |found: f64| (eliminated / found - 1.0).abs();
        three.natural_frequencies(tau).into_iter().map(nearest).fold(f64::INFINITY, f64::min)
    };
    Ok((0..count).map(at).fold(0.0, f64::max))
}
