//! Results of a dynamic analysis, in SI units.

use std::time::Duration;

use super::options::DynamicsState;
use crate::lcp::SolveStats;
use crate::statics::PressurePatch;

/// One step.
#[derive(Debug, Clone, PartialEq)]
pub struct StepRecord {
    /// Steps since the start.
    pub step: i64,
    /// Time since step 0 (s).
    pub time: f64,
    /// Mesh cycle.
    pub mesh_cycle: f64,
    /// Dynamic transmission error (m): closing rotation of the wheel times its base radius, and lead of the pinion times its own.
    pub transmission_error: f64,
    /// Force on the drive flanks (N), all pairs together.
    pub mesh_force: f64,
    /// Force on the coast flanks (N).
    pub back_force: f64,
    /// Force of each tooth pair that carries load on its drive flanks (N).
    pub pairs: Vec<(i32, f64)>,
    /// Rigid coordinates (m, rad), in the order of [`DynamicsRun::coordinates`].
    pub coordinates: Vec<f64>,
    /// Forces of the supports on the ground (N, N m), same order.
    pub support_forces: Vec<f64>,
}

/// Energies of a run (J).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// Work of the torques on the moving coordinates.
    pub external: f64,
    /// Work of the contact forces on bodies and modes.
    pub contact: f64,
    /// Lost to damping.
    pub dissipated: f64,
    /// Kinetic and elastic energy of bodies, gained since the start of the run.
    pub stored: f64,
    /// Largest `|stored - (external + contact - dissipated)|` seen: zero but for rounding, or the integrator's own damping.
    pub worst_residual: f64,
    /// Largest stored energy and work seen, against which the residual counts.
    pub scale: f64,
}

/// How the steps were solved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RunStats {
    /// Steps.
    pub steps: usize,
    /// Contact solvers of all steps: sums of counters.
    pub solver: SolveStats,
    /// Worst complementarity of any step.
    pub worst_complementarity: f64,
    /// Worst violation of `f >= 0`, `gap >= 0` of any step.
    pub worst_kkt: f64,
    /// Steps that needed wider grids than the first.
    pub widened: usize,
    /// Steps at which coast flanks were watched.
    pub watched_back: usize,
    /// Steps whose contact problem did not converge.
    pub not_converged: usize,
    /// Wall time.
    pub time: Duration,
}

/// Pressures of one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Steps since the start.
    pub step: i64,
    /// Mesh cycle.
    pub mesh_cycle: f64,
    /// Loaded pairs on their drive flanks.
    pub patches: Vec<PressurePatch>,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsRun {
    /// Length of a step (s).
    pub time_step: f64,
    /// Steps, in order; shorter than asked for where cancelled.
    pub records: Vec<StepRecord>,
    /// Body (0 pinion, 1 wheel) and hub coordinate of every rigid coordinate.
    pub coordinates: Vec<(usize, usize)>,
    /// Pressures kept.
    pub snapshots: Vec<Snapshot>,
    /// State after the last step.
    pub state: DynamicsState,
    /// Energies.
    pub energy: EnergyBalance,
    /// Work.
    pub stats: RunStats,
}

impl DynamicsRun {
    /// Intervals of mesh cycle without force on drive flanks.
    #[must_use]
    pub fn contact_loss(&self) -> Vec<[f64; 2]> {
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let mut open = false;
        for record in &self.records {
            let lost = record.mesh_force <= 0.0;
            match intervals.last_mut() {
                Some(last) if lost && open => last[1] = record.mesh_cycle,
                _ if lost => intervals.push([record.mesh_cycle; 2]),
                _ => {}
            }
            open = lost;
        }
        intervals
    }

    /// Transmission errors (m) in order of steps.
    #[must_use]
    pub fn transmission_errors(&self) -> Vec<f64> {
        self.records.iter().map(|record| record.transmission_error).collect()
    }
}
