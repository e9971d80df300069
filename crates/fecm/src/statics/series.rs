//! Many positions, many torques.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::model::{PairModel, cracks_of};
use super::options::PairModelOptions;
use super::position::{PositionRequest, Start};
use super::result::{PositionResult, PressurePatch};
use crate::error::FecmError;
use crate::lcp::SolveStats;
use crate::nearfield::FaceCells;

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

impl StaticsRequest {
    /// All of `mesh_cycles` at all of `torques` on the wheel (N m); neither differences nor pressures are kept.
    ///
    /// ```
    /// let request = fecm::StaticsRequest::new([0.0, 0.25, 0.5], [200.0]).keeping_pressure();
    /// assert!(request.keep_pressure && !request.stiffness_difference);
    /// ```
    #[must_use]
    pub fn new(mesh_cycles: impl Into<Vec<f64>>, torques: impl Into<Vec<f64>>) -> Self {
        Self {
            mesh_cycles: mesh_cycles.into(),
            torques: torques.into(),
            stiffness_difference: false,
            keep_pressure: false,
        }
    }

    /// One mesh cycle from 0 at equally spaced positions, at one torque on the wheel (N m).
    #[must_use]
    pub fn one_cycle(positions: u32, torque: f64) -> Self {
        let cycles: Vec<f64> = (0..positions).map(|k| f64::from(k) / f64::from(positions)).collect();
        Self::new(cycles, [torque])
    }

    /// The same with the local slope of the force also by differences.
    #[must_use]
    pub fn with_stiffness_difference(self) -> Self {
        Self { stiffness_difference: true, ..self }
    }

    /// The same with the pressure of every cell kept.
    #[must_use]
    pub fn keeping_pressure(self) -> Self {
        Self { keep_pressure: true, ..self }
    }
}

/// All positions at all torques.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticsSeries {
    /// `[torque][mesh cycle]`, in the order of the request; shorter where cancelled.
    pub results: Vec<Vec<PositionResult>>,
    /// Wall time of the contact solutions.
    pub time: Duration,
    /// What each position hands to another as a start, where it was solved.
    starts: Vec<Vec<Option<Start>>>,
}

/// Positions that hand their solution on; fixed, so that results do not depend on the number of threads.
const CHUNK: usize = 5;

/// One torque's results and what they hand on.
#[derive(Clone, Default)]
struct Track {
    results: Vec<PositionResult>,
    starts: Vec<Option<Start>>,
}

impl PairModel {
    /// Solves all positions at all torques, in parallel over chunks of positions.
    ///
    /// # Errors
    /// The first error in the order of positions.
    pub fn solve(&self, request: &StaticsRequest, observer: &dyn Observer) -> Result<StaticsSeries, FecmError> {
        self.solve_series(request, None, observer)
    }

    /// As [`Self::solve`], with the help of the same request solved for the same pair in another state (`known`).
    ///
    /// If that state is sound flanks and the same cracks, positions at which damaged flank carries no load in it are not solved again: material
    /// taken away where nothing pressed leaves the contact as it was (the conditions of contact still hold, and their solution is unique).
    /// Their results are those known, to the bit, with no work counted; this needs kept pressures. Other positions start from the known
    /// contact where they have no neighbour to start from.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_from(
        &self,
        request: &StaticsRequest,
        known: (&Self, &StaticsSeries),
        observer: &dyn Observer,
    ) -> Result<StaticsSeries, FecmError> {
        self.solve_series(request, Some(known), observer)
    }

    fn solve_series(
        &self,
        request: &StaticsRequest,
        known: Option<(&Self, &StaticsSeries)>,
        observer: &dyn Observer,
    ) -> Result<StaticsSeries, FecmError> {
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
        let same_bodies = known.is_some_and(|(other, _)| self.differs_by_flank_damage(other));
        let solve_chunk = |first: usize, positions: &[f64]| -> Result<Vec<Track>, FecmError> {
            let mut chunk = vec![Track::default(); request.torques.len()];
            for (index, &mesh_cycle) in positions.iter().enumerate() {
                let mut touch = None;
                for (track, &torque) in chunk.iter_mut().zip(&request.torques) {
                    if observer.is_cancelled() {
                        return Ok(chunk);
                    }
                    let known = known.and_then(|known| Known::find(known, first + index, mesh_cycle, torque));
                    let copied = known.as_ref().filter(|known| same_bodies && self.keeps(known, request));
                    let (result, start) = if let Some(known) = copied {
                        (known.taken_over(&self.face), known.start.clone())
                    } else {
                        let touch = touch.get_or_insert_with(|| self.pairing.first_touch(mesh_cycle));
                        let position = PositionRequest {
                            mesh_cycle,
                            touch: touch.as_ref(),
                            torque,
                            stiffness_difference: request.stiffness_difference,
                            keep_pressure: request.keep_pressure,
                        };
                        let before = track.starts.last().and_then(Option::as_ref);
                        self.solve_position(&position, before.or(known.and_then(|known| known.start.as_ref())))?
                    };
                    track.results.push(result);
                    track.starts.push(start);
                    let count = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                    observer.advanced(count, total);
                }
            }
            Ok(chunk)
        };
        let chunks: Vec<Result<Vec<Track>, FecmError>> = request
            .mesh_cycles
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(index, positions)| solve_chunk(index * CHUNK, positions))
            .collect();
        let mut series = vec![Track::default(); request.torques.len()];
        for chunk in chunks {
            for (all, part) in series.iter_mut().zip(chunk?) {
                all.results.extend(part.results);
                all.starts.extend(part.starts);
            }
        }
        let (results, starts) = series.into_iter().map(|track| (track.results, track.starts)).unzip();
        Ok(StaticsSeries { results, time: started.elapsed(), starts })
    }

    /// Whether another model is this one but for damage of its flanks, of which the other has none.
    fn differs_by_flank_damage(&self, other: &Self) -> bool {
        let cracks = |options: &PairModelOptions| [0, 1].map(|index| cracks_of(&options.damage[index]));
        let rest = PairModelOptions { damage: self.options.damage.clone(), ..other.options.clone() };
        self.pairing.is_of_the_gears_of(&other.pairing)
            && rest == self.options
            && cracks(&self.options) == cracks(&other.options)
            && !other.pairing.has_damaged_flanks()
    }

    /// Whether a position solved with sound flanks is that of this model.
    fn keeps(&self, known: &Known<'_>, request: &StaticsRequest) -> bool {
        let result = known.result;
        let cells = |model: &Self| model.face.centres.len() * if model.face.mirrored { 2 } else { 1 };
        let has_difference = result.stiffness_local_slope_difference.is_some();
        let touch_is_kept = || {
            let touch = known.model.pairing.first_touch(result.mesh_cycle);
            touch.is_some_and(|touch| self.pairing.leaves_touch_alone(result.mesh_cycle, &touch))
        };
        request.keep_pressure
            && cells(self) == cells(known.model)
            && result.status.is_usable()
            && result.torque > 0.0
            && has_difference == request.stiffness_difference
            && !result.patches.is_empty()
            && (!has_difference || result.patches.len() == result.pairs.len())
            && result.patches.iter().all(|patch| self.is_sound_below(patch, known.model.face.mirrored, has_difference))
            && touch_is_kept()
    }

    /// Whether no damage lies under the loaded cells of a patch, nor under the rows next to them; or under any of its cells.
    fn is_sound_below(&self, patch: &PressurePatch, mirrored: bool, any: bool) -> bool {
        let rows = patch.pressure.len();
        (0..rows).all(|row| {
            let near = row.saturating_sub(1)..(row + 2).min(rows);
            let rolls = [patch.pinion_roll[row], patch.wheel_roll[row]];
            let depth = |z: f64| self.pairing.damage_depth(patch.pair, rolls, z);
            patch.face.iter().enumerate().all(|(column, &z)| {
                let loaded = any || patch.pressure[near.clone()].iter().any(|row| row[column] > 0.0);
                !loaded || (depth(z) == 0.0 && (!mirrored || depth(-z) == 0.0))
            })
        })
    }
}

/// A position solved for another state of the pair.
struct Known<'a> {
    model: &'a PairModel,
    result: &'a PositionResult,
    start: &'a Option<Start>,
}

impl<'a> Known<'a> {
    /// The position of a series that was asked for at an index.
    fn find(
        (model, series): (&'a PairModel, &'a StaticsSeries),
        index: usize,
        mesh_cycle: f64,
        torque: f64,
    ) -> Option<Self> {
        let all = series.results.iter().zip(&series.starts);
        let at_index = all.filter_map(|(results, starts)| results.get(index).zip(starts.get(index)));
        let mut same = at_index.filter(|(result, _)| result.mesh_cycle == mesh_cycle && result.torque == torque);
        same.next().map(|(result, start)| Self { model, result, start })
    }

    /// The result without the work that it took, pressures on the whole of a face that is not mirrored.
    fn taken_over(&self, face: &FaceCells) -> PositionResult {
        let mut result = self.result.clone();
        let solver = SolveStats { solves: 0, pivots: 0, factorisations: 0, ..result.stats.solver };
        result.stats.solver = solver;
        if self.model.face.mirrored && !face.mirrored {
            for patch in &mut result.patches {
                patch.face.clone_from(&face.centres);
                for row in &mut patch.pressure {
                    *row = row.iter().rev().chain(row.iter()).copied().collect();
                }
            }
        }
        result
    }
}
