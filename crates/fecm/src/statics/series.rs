//! Many positions, many torques.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::model::PairModel;
use super::position::{PositionRequest, Start};
use super::result::PositionResult;
use crate::error::FecmError;

/// Watches a computation; called from any thread.
pub trait Observer: Sync {
    /// `done` of `total` contact problems are solved.
    fn advanced(&self, _done: usize, _total: usize) {}

    /// Whether to stop; what is not yet solved is then missing from the result.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Observer for () {}

/// What to solve.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticsRequest {
    /// Mesh cycles.
    pub mesh_cycles: Vec<f64>,
    /// Torques on the wheel (N m), 0 or more.
    pub torques: Vec<f64>,
    /// Whether to compute the local slope by differences as well.
    pub stiffness_difference: bool,
    /// Whether to keep the pressure of every cell.
    pub keep_pressure: bool,
}

/// All positions at all torques.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticsSeries {
    /// `[torque][mesh cycle]`, in the order of the request; shorter where cancelled.
    pub results: Vec<Vec<PositionResult>>,
    /// Wall time of the contact solutions.
    pub time: Duration,
}

/// Positions that hand their solution on; fixed, so that results do not depend on the number of threads.
const CHUNK: usize = 5;

impl PairModel {
    /// Solves all positions at all torques, in parallel over chunks of positions.
    ///
    /// # Errors
    /// The first error in the order of positions.
    pub fn solve(&self, request: &StaticsRequest, observer: &dyn Observer) -> Result<StaticsSeries, FecmError> {
        for &torque in &request.torques {
            if !(torque >= 0.0 && torque.is_finite()) {
                let allowed = "0 or more, in N m";
                return Err(FecmError::Option { name: "torque", value: torque, allowed });
            }
        }
        if let Some(&value) = request.mesh_cycles.iter().find(|m| !(m.abs() < 1e6)) {
            return Err(FecmError::Option { name: "mesh cycle", value, allowed: "-1e6 to 1e6" });
        }
        let started = Instant::now();
        let total = request.mesh_cycles.len() * request.torques.len();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let solve_chunk = |positions: &[f64]| -> Result<Vec<Vec<PositionResult>>, FecmError> {
            let mut chunk = vec![Vec::new(); request.torques.len()];
            let mut starts: Vec<Option<Start>> = vec![None; request.torques.len()];
            for &mesh_cycle in positions {
                let touch = self.pairing.first_touch(mesh_cycle);
                for (index, &torque) in request.torques.iter().enumerate() {
                    if observer.is_cancelled() {
                        return Ok(chunk);
                    }
                    let position = PositionRequest {
                        mesh_cycle,
                        touch: touch.as_ref(),
                        torque,
                        stiffness_difference: request.stiffness_difference,
                        keep_pressure: request.keep_pressure,
                    };
                    let (result, start) = self.solve_position(&position, starts[index].as_ref())?;
                    chunk[index].push(result);
                    starts[index] = start;
                    let count = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                    observer.advanced(count, total);
                }
            }
            Ok(chunk)
        };
        let chunks: Vec<Result<Vec<Vec<PositionResult>>, FecmError>> =
            request.mesh_cycles.par_chunks(CHUNK).map(solve_chunk).collect();
        let mut results = vec![Vec::new(); request.torques.len()];
        for chunk in chunks {
            for (all, part) in results.iter_mut().zip(chunk?) {
                all.extend(part);
            }
        }
        Ok(StaticsSeries { results, time: started.elapsed() })
    }
}
