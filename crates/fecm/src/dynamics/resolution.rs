//! The vibration that steps of time must follow, and what steps of a given length leave of it.
//!
//! Hubs on their supports and the mesh as a spring `k_m` along the line of action make a linear system of the coordinates that move,
//! `M a + (K + k_m r r^T) q = 0`, `r` how far each coordinate closes the flanks. `k_m` is the tangent stiffness of the contact problem under the torque,
//! the mean over the positions given. A mode `phi` of unit modal mass and angular frequency `omega` has the part `k_m (r . phi)^2 / omega^2` in what the
//! mesh gives way; one that has little of it (hubs on bearings much stiffer than the mesh) shows little in the motion, however few steps follow it.
//!
//! An integrator of second order sees the frequency `omega (1 - e (omega h)^2)` in steps of length `h`, with `e = 1/12` for average acceleration and
//! `e = 1/12 + 3/8 (alpha_f - alpha_m)^2` for generalised alpha (from its characteristic polynomial on the unit circle). Where a harmonic of the mesh
//! frequency meets the natural frequency, a shift by the part `d` changes the response `1 / (1 - x^2 + 2 i zeta x)` by `d / zeta` of itself: the largest
//! error, and the one told here, because far below the natural frequency there is always a harmonic near it. Elastic modes shift `omega` a little and
//! are left out.
//!
//! | symbol | field | unit |
//! |---|---|---|
//! | `omega / 2 pi` | [`MeshVibration::frequency`] | Hz |
//! | `zeta` | [`MeshVibration::damping_ratio`] | 1 |
//! | `k_m` | [`MeshVibration::mesh_stiffness`] | N/m |

use std::f64::consts::PI;

use faer::Mat;

use super::integrator::Integrator;
use super::run::PairDynamics;
use super::system::{ROTATION, System};
use crate::error::FecmError;
use crate::linalg::symmetric_eigen;
use crate::statics::StaticsRequest;

/// Vibration of two gears on the stiffness of their mesh, which steps of time must follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshVibration {
    /// Natural frequency (Hz): the highest among the modes with a part in what the mesh gives way.
    pub frequency: f64,
    /// Its damping ratio, of supports and damping proportional to mass or stiffness.
    pub damping_ratio: f64,
    /// Mesh stiffness it is on (N/m).
    pub mesh_stiffness: f64,
}

/// Modes with less than this part in what the mesh gives way are not followed: with a twentieth, an error of half their motion is 2.5 % of the whole.
const LEAST_PART: f64 = 0.05;

impl PairDynamics<'_> {
    /// Natural frequency of the pair under a torque (N m), on the mean tangent stiffness of the mesh at these positions.
    ///
    /// # Errors
    /// No position with a static equilibrium; gears of which neither can turn.
    pub fn mesh_vibration(&self, mesh_cycles: &[f64], torque: f64) -> Result<MeshVibration, FecmError> {
        let request = StaticsRequest::new(mesh_cycles.to_vec(), [torque]);
        let solved = self.model.solve(&request, &())?;
        let found: Vec<f64> = solved.results.iter().flatten().filter_map(|r| r.stiffness_local_slope).collect();
        if found.is_empty() {
            let mesh_cycle = mesh_cycles.first().copied().unwrap_or_default();
            return Err(FecmError::NoEquilibrium { mesh_cycle, torque });
        }
        let stiffness = found.iter().sum::<f64>() / found.len() as f64;
        let pairing = self.model.pairing();
        let angle = pairing.pair().working_pressure_angle();
        mesh_vibration(&self.system, stiffness, angle, [0, 1].map(|body| pairing.base_radius(body)))
    }
}

/// See the header; signs of `r` do not matter where mass and supports are diagonal.
fn mesh_vibration(
    system: &System,
    stiffness: f64,
    pressure_angle: f64,
    base_radii: [f64; 2],
) -> Result<MeshVibration, FecmError> {
    if !system.coordinates.iter().any(|&(_, axis)| axis == ROTATION) {
        let allowed = "at least one gear whose rotation is not fixed";
        return Err(FecmError::Option { name: "free rotations", value: 0.0, allowed });
    }
    let count = system.rigid_count();
    // coordinates scaled to unit mass
    let root: Vec<f64> = (0..count).map(|i| system.mass(i).sqrt()).collect();
    let closing: Vec<f64> = (system.coordinates.iter().zip(&root))
        .map(|(&(body, axis), root)| match axis {
            0 => pressure_angle.sin() / root,
            1 => pressure_angle.cos() / root,
            ROTATION => base_radii[body] / root,
            _ => 0.0,
        })
        .collect();
    let matrix = Mat::from_fn(count, count, |i, j| {
        let support = if i == j { system.support_stiffness(i) / system.mass(i) } else { 0.0 };
        support + stiffness * closing[i] * closing[j]
    });
    let (squares, modes) = symmetric_eigen(&matrix, "hubs on the stiffness of the mesh")?;
    let parts: Vec<f64> = (squares.iter().enumerate())
        .map(|(k, &square)| {
            let closed: f64 = modes.col_as_slice(k).iter().zip(&closing).map(|(v, r)| v * r).sum();
            stiffness * closed * closed / square.max(f64::MIN_POSITIVE)
        })
        .collect();
    // rigid motion closes no flanks but for rounding, which a frequency of nothing would make a part of it
    let floor = 1e-13 * squares.last().copied().unwrap_or_default();
    let kept = |k: &usize| squares[*k] > floor;
    let all: f64 = (0..count).filter(kept).map(|k| parts[k]).sum();
    let highest = (0..count).rev().filter(kept).find(|&k| parts[k] >= LEAST_PART * all).unwrap_or(count - 1);
    let omega = squares[highest].sqrt();
    let shape: Vec<f64> = modes.col_as_slice(highest).iter().zip(&root).map(|(v, root)| v / root).collect();
    let mut whole = shape.clone();
    whole.resize(system.size(), 0.0);
    let lost: f64 = system.times_damping(&whole).iter().zip(&shape).map(|(c, v)| c * v).sum();
    Ok(MeshVibration { frequency: omega / (2.0 * PI), damping_ratio: 0.5 * lost / omega, mesh_stiffness: stiffness })
}

impl MeshVibration {
    /// Error of a response at resonance that steps of this length (s) leave, over the response; infinite without damping.
    #[must_use]
    pub fn resonance_error(&self, integrator: Integrator, time_step: f64) -> f64 {
        elongation(integrator) * (2.0 * PI * self.frequency * time_step).powi(2) / self.damping_ratio
    }

    /// Length of a step (s) that leaves this error at resonance; 0 without damping.
    #[must_use]
    pub fn time_step(&self, integrator: Integrator, resonance_error: f64) -> f64 {
        (resonance_error * self.damping_ratio / elongation(integrator)).sqrt() / (2.0 * PI * self.frequency)
    }
}

/// `e`: a step of length `h` lowers a frequency by the part `e (omega h)^2`.
fn elongation(integrator: Integrator) -> f64 {
    let weights = integrator.weights(1.0);
    1.0 / 12.0 + 0.375 * (weights.alpha_f - weights.alpha_m).powi(2)
}

#[cfg(test)]
mod tests {
    use super::super::system::{BodyTerms, Damping, Support};
    use super::*;

    const STIFFNESS: f64 = 5e8;
    const RADII: [f64; 2] = [0.035, 0.046];
    const INERTIA: [f64; 2] = [8e-4, 5e-3];

    fn body(index: usize, translation: Support, rotation: Support) -> BodyTerms {
        let mut supports = [Support::Fixed; 6];
        (supports[0], supports[1], supports[ROTATION]) = (translation, translation, rotation);
        let mass = [0.8, 0.8, 0.8, 1e-3, 1e-3, INERTIA[index]];
        BodyTerms { mass, supports, frequencies: Vec::new(), participation: Vec::new() }
    }

    fn vibration(bodies: [BodyTerms; 2]) -> MeshVibration {
        let damping = Damping { mass_proportional: 1000.0, stiffness_proportional: 0.0, modal_ratio: 0.0 };
        mesh_vibration(&System::new(&bodies, damping).unwrap(), STIFFNESS, 0.43, RADII).unwrap()
    }

    fn frequency(inverse_mass: f64) -> f64 {
        (STIFFNESS * inverse_mass).sqrt() / (2.0 * PI)
    }

    #[test]
    fn analytic_frequencies_of_gears_that_turn() {
        let turning = |index: usize| RADII[index].powi(2) / INERTIA[index];
        let held = Support::Fixed;
        for (rotations, inverse_mass) in
            [([Support::Fixed, Support::Free], turning(1)), ([Support::Free, Support::Free], turning(0) + turning(1))]
        {
            let exact = frequency(inverse_mass);
            let found = vibration([body(0, held, rotations[0]), body(1, held, rotations[1])]);
            assert!((found.frequency / exact - 1.0).abs() < 1e-12, "{} {exact}", found.frequency);
            // damping proportional to mass: zeta = alpha / 2 omega
            assert!((found.damping_ratio / (1000.0 / (4.0 * PI * exact)) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn bearings_stiffer_than_the_mesh_do_not_count_and_free_hubs_do() {
        let rotations = [Support::Fixed, Support::Free];
        let on = |stiffness: f64| {
            let spring = Support::Elastic { stiffness, damping: 0.0 };
            vibration([body(0, spring, rotations[0]), body(1, spring, rotations[1])]).frequency
        };
        let turning = RADII[1].powi(2) / INERTIA[1];
        for stiffness in [1e12, 1e15, 1e18] {
            // springs in series with the mesh: k / (1 + 2 k / k_b), to first order
            let exact = frequency(turning) * (1.0 - STIFFNESS / stiffness);
            assert!((on(stiffness) / exact - 1.0).abs() < 1e-5, "{stiffness:e}: {} {exact}", on(stiffness));
        }
        // hubs without bearings: the mesh between all that moves
        let free = frequency(turning + 2.0 / 0.8);
        assert!((on(0.0) / free - 1.0).abs() < 1e-6, "{} {free}", on(0.0));
    }

    #[test]
    fn no_gear_that_turns_is_refused() {
        let bodies = [0, 1].map(|index| body(index, Support::Free, Support::Fixed));
        let damping = Damping { mass_proportional: 0.0, stiffness_proportional: 0.0, modal_ratio: 0.0 };
        let system = System::new(&bodies, damping).unwrap();
        assert!(matches!(mesh_vibration(&system, STIFFNESS, 0.4, RADII), Err(FecmError::Option { .. })));
    }

    /// The one-mass oscillator at resonance, stepped by the integrator itself until steady, against the exact response.
    #[test]
    fn analytic_error_at_resonance() {
        let zeta = 0.05;
        let vibration = MeshVibration { frequency: 1.0 / (2.0 * PI), damping_ratio: zeta, mesh_stiffness: STIFFNESS };
        for integrator in [
            Integrator::AverageAcceleration,
            Integrator::GeneralizedAlpha { spectral_radius: 0.5 },
            Integrator::GeneralizedAlpha { spectral_radius: 0.8 },
        ] {
            let step = vibration.time_step(integrator, 0.01);
            let steps = (2.0 * PI / step).ceil() as usize;
            let h = 2.0 * PI / steps as f64;
            let weights = integrator.weights(h);
            let force = |k: usize| (k as f64 * h).cos();
            let (mut q, mut v, mut a) = (0.0, 0.0, 1.0);
            let mut worst = 0.0_f64;
            for k in 0..steps * 60 {
                let right = weights.mass_history(q, v, a)
                    + 2.0 * zeta * weights.damping_history(q, v, a)
                    + force(k + 1)
                    + weights.start() * (force(k) - q);
                let next = right / (weights.mass() + 2.0 * zeta * weights.damping() + 1.0);
                (v, a) = weights.end([q, next], v, a);
                q = next;
                if k >= steps * 59 {
                    // x'' + 2 zeta x' + x = cos t: x = sin t / 2 zeta
                    worst = worst.max((q - ((k + 1) as f64 * h).sin() / (2.0 * zeta)).abs() * 2.0 * zeta);
                }
            }
            let told = vibration.resonance_error(integrator, h);
            // of what the damping of the integrator adds, nothing is told: third order
            assert!((0.8..1.3).contains(&(worst / told)), "{integrator:?}: {worst} told {told}");
        }
    }
}
