//! Dynamics of the finite-element/contact model of a case: one rotation of the pinion in steady state, healthy and damaged.
//!
//! Hubs are rigid with the inertias of Table 3.2 on ideal bearings, the pinion turns at constant speed, and damping is proportional to mass,
//! from the damping ratio printed in section 4.3 for one pair in contact: the dissertation prints no damping of its finite-element model.

use std::f64::consts::TAU;

use anyhow::{Context as _, bail, ensure};
use fecm::dynamics::{
    Damping, DynamicsOptions, DynamicsRequest, InitialState, PairDynamics, RotorInertia, RotorOptions, SteadySpec,
    Support,
};
use fecm::statics::PairModel;
use gearwright_case::SpurPairCase;
use serde::{Deserialize, Serialize};

use super::statics::percent;

/// Steps per mesh cycle, as in the dissertation.
pub const STEPS: usize = 50;
/// Mesh cycle of the figures at which tooth 0 touches at the pitch point: it then engages near 14.02, as printed.
pub const PITCH: f64 = 14.75;
/// Damping ratio and natural frequency (Hz) of section 4.3, one pair in contact.
const PRINTED_MODE: (f64, f64) = (0.048, 2370.73);

/// One state of the pair over a rotation of the pinion.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Motion {
    /// What distinguishes it.
    pub label: String,
    /// Damaged area or crack length (%).
    pub percent: f64,
    /// Dynamic transmission error (um), [`STEPS`] a mesh cycle, the first one step after mesh cycle 0.
    pub error: Vec<f64>,
    /// Intervals of the mesh cycle without contact.
    pub lost: Vec<[f64; 2]>,
}

/// All states of a case at a speed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Dynamics {
    /// Mesh frequency (Hz).
    pub mesh_frequency: f64,
    /// Without damage.
    pub healthy: Motion,
    /// The severities asked for.
    pub damaged: Vec<Motion>,
}

impl Motion {
    /// Transmission error over the mesh cycle.
    pub fn over_cycles(&self) -> Vec<(f64, f64)> {
        over_cycles(&self.error)
    }

    /// Damaged minus healthy (um).
    pub fn difference(&self, healthy: &Self) -> Vec<f64> {
        self.error.iter().zip(&healthy.error).map(|(d, h)| d - h).collect()
    }
}

/// Samples over the mesh cycle.
pub fn over_cycles(samples: &[f64]) -> Vec<(f64, f64)> {
    samples.iter().enumerate().map(|(k, x)| ((k + 1) as f64 / STEPS as f64, *x)).collect()
}

impl Dynamics {
    /// Runs the healthy pair and the picked severities until each repeats.
    pub fn compute(case: &SpurPairCase, mesh_frequency: f64, picked: &[usize]) -> anyhow::Result<Self> {
        let table = lpm::GearPair::table_3_2(lpm::Input::Prescribed);
        let rotor = |gear: lpm::Gear, rotation| {
            let inertia = RotorInertia { mass: gear.mass, polar: gear.inertia, transverse: 0.5 * gear.inertia };
            RotorOptions::on_ideal_bearings(inertia, rotation)
        };
        let (ratio, frequency) = PRINTED_MODE;
        let mass_proportional = 2.0 * ratio * TAU * frequency;
        let options = DynamicsOptions::new(
            [rotor(table.pinion, Support::Fixed), rotor(table.gear, Support::Free)],
            Damping { mass_proportional, stiffness_proportional: 0.0, modal_ratio: 0.0 },
        );
        let teeth = case.pair.pinion().teeth() as usize;
        let mut request = DynamicsRequest {
            mesh_cycle: -PITCH,
            ..DynamicsRequest::running(TAU * mesh_frequency / teeth as f64, STEPS, case.inputs.load.torque_n_m)
        };
        let mut model = PairModel::new(&case.pair, &case.options).context("the gears cannot be modelled")?;
        let settled = |model: &PairModel, request: &DynamicsRequest, spec: &SteadySpec, label: &str| {
            let dynamics = PairDynamics::new(model, &options)?;
            let (run, change) = dynamics.start(request)?.settle(spec, &())?;
            ensure!(change < spec.tolerance, "{label} at {mesh_frequency} Hz does not repeat: change {change:.1e}");
            Ok(run)
        };
        let cycle = SteadySpec { period: STEPS, tolerance: 1e-6, most_periods: 400 };
        let run = settled(&model, &request, &cycle, "the healthy pair").context("the healthy pair cannot be run")?;
        let one: Vec<f64> = run.transmission_errors().iter().map(|x| x * 1e6).collect();
        let error = one.iter().copied().cycle().take(STEPS * teeth).collect();
        let healthy = Motion { label: "healthy".into(), percent: 0.0, error, lost: Vec::new() };
        // the damaged pair starts where the healthy one is at the same phase, far from the damage
        let mut state = run.state;
        state.step = 0;
        request.initial = InitialState::Given(state);
        let rotation = SteadySpec { period: STEPS * teeth, tolerance: 1e-2, most_periods: 6 };
        let mut damaged = Vec::new();
        for &index in picked {
            let Some(severity) = case.severities.get(index) else { bail!("the case has no severity {index}") };
            model = model.with_damage(&severity.damage)?;
            let run = settled(&model, &request, &rotation, &severity.label)?;
            let start = run.records.first().map_or(0.0, |r| r.mesh_cycle) - 1.0 / STEPS as f64;
            damaged.push(Motion {
                label: severity.label.clone(),
                percent: percent(case, &severity.damage),
                error: run.transmission_errors().iter().map(|x| x * 1e6).collect(),
                lost: run.contact_loss().iter().map(|l| l.map(|c| c - start)).collect(),
            });
        }
        Ok(Self { mesh_frequency, healthy, damaged })
    }

    /// Sampling rate (Hz).
    pub fn rate(&self) -> f64 {
        self.mesh_frequency * STEPS as f64
    }

    /// Amplitudes over frequency (Hz) up to a limit, without the mean.
    pub fn spectrum(&self, samples: &[f64], up_to: f64) -> anyhow::Result<Vec<(f64, f64)>> {
        let lines = lpm::Spectrum::of(samples, samples.len() as f64 / self.rate())?;
        let lines = lines.frequency.into_iter().zip(lines.amplitude).skip(1);
        Ok(lines.take_while(|l| l.0 <= up_to).collect())
    }
}
