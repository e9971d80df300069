//! The contact problem at one position.

use faer::Mat;

use super::crack_contact::{CrackCells, CrackState};
use super::model::{PairModel, on_ladder};
use super::result::{PairState, PositionResult, PositionStats, PositionStatus, PressurePatch};
use crate::contact::{ContactGrid, PairGrid};
use crate::error::FecmError;
use crate::face::FaceModel;
use crate::lcp::{ContactProblem, ContactSolution, SolveStats};
use crate::nearfield::NearField;
use crate::pairing::Touch;
use crate::search::{NoCell, OpposedPoints};

/// What one position hands to another as a start.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    /// Closing rotation since first touch (rad).
    pub closing: f64,
    /// Cell size along the profile (m).
    pub cell: f64,
    /// Rows on either side of the contact's centre.
    pub reach: i32,
    /// Cells along the face.
    pub columns: usize,
    /// Cells in contact, or kept from it by a pit alone: pair relative to the mesh cycle's integer part, row, face cell; ascending.
    pub active: Vec<(i32, i32, usize)>,
}

/// What to compute at a position.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PositionRequest<'a> {
    pub mesh_cycle: f64,
    /// First touch without load, if the flanks face each other.
    pub touch: Option<&'a Touch>,
    pub torque: f64,
    pub stiffness_difference: bool,
    pub keep_pressure: bool,
}

/// How far the grid of a position extends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GridScope {
    /// Multiple of the load that the grid shall hold: wider contacts, and pairs that only it closes.
    pub load_factor: f64,
}

impl Default for GridScope {
    fn default() -> Self {
        Self { load_factor: 1.0 }
    }
}

/// A position's contact problem, solved.
#[derive(Debug, Clone)]
pub struct Settled {
    /// Cells, with the gaps at `grid_rotation`.
    pub grid: ContactGrid,
    /// Compliance between all cells (m/N).
    pub compliance: Mat<f64>,
    /// Forces, and the approach from `grid_rotation` on.
    pub solution: ContactSolution,
    /// Cells of the cracks that feel the load.
    pub(crate) cracks: Option<CrackCells>,
    /// Their state, where faces press on each other.
    pub(crate) crack_state: Option<CrackState>,
    /// Whether it can be used.
    pub status: PositionStatus,
    /// Closing rotation of the wheel at which the gaps were taken (rad).
    pub grid_rotation: f64,
    /// Closing rotation under load (rad).
    pub rotation: f64,
    /// Closing rotation at first touch (rad).
    pub no_load: f64,
    /// Start for a neighbouring position.
    pub(crate) start: Start,
    /// Work so far.
    pub stats: PositionStats,
}

/// Geometry is set again when the rotation moved by more than this fraction: the error of the linear step is then below
/// `(0.02 delta)^2 / 2 R`, some 1e-5 of `delta`.
const ROTATION_TOLERANCE: f64 = 0.02;
/// The compliance is set again when the rotation moved by more than this fraction: contact then shifts along the flank by less than that
/// fraction of the deflection, some micrometres at most, over which the compliance of a tooth changes by some 1e-4.
const COMPLIANCE_TOLERANCE: f64 = 0.1;
const MOST_UPDATES: usize = 24;
/// Deflection at which a position counts as overloaded, in base pitches.
const MOST_DEFLECTION: f64 = 0.25;
/// Rows beyond those in contact at the start that a pair's grid gets: from one position to the next, contact widens by a row or so.
const SPARE_ROWS: i32 = 2;
/// Growth of cells that turn out too small: half an octave, so that positions share near fields.
const CELL_STEP: f64 = std::f64::consts::SQRT_2;
impl PairModel {
    /// Solves one position; returns also the start for the next.
    pub(super) fn solve_position(
        &self,
        request: &PositionRequest<'_>,
        start: Option<&Start>,
    ) -> Result<(PositionResult, Option<Start>), FecmError> {
        let Some(settled) = self.settle(request, start, &GridScope::default())? else {
            return Ok((self.untouched(request), None));
        };
        let mut stats = settled.stats;
        let difference = if request.stiffness_difference && request.torque > 0.0 {
            self.difference_slope(request, &settled, &mut stats.solver)?
        } else {
            None
        };
        Ok((self.collect(request, &settled, difference, stats), Some(settled.start)))
    }

    /// The contact problem of a position under a torque on the wheel (N m), solved: cells, gaps, compliance and forces, for studies of one's own.
    /// `None` when nothing can touch.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn contact_at(&self, mesh_cycle: f64, torque: f64) -> Result<Option<Settled>, FecmError> {
        let touch = self.pairing.first_touch(mesh_cycle);
        let request = PositionRequest {
            mesh_cycle,
            touch: touch.as_ref(),
            torque,
            stiffness_difference: false,
            keep_pressure: false,
        };
        self.settle(&request, None, &GridScope::default())
    }

    /// Solves the contact problem at a position until the geometry no longer changes. `None` when nothing can touch.
    pub(crate) fn settle(
        &self,
        request: &PositionRequest<'_>,
        start: Option<&Start>,
        scope: &GridScope,
    ) -> Result<Option<Settled>, FecmError> {
        let Some(touch) = request.touch else {
            return Ok(None);
        };
        let no_load = touch.rotation;
        let base_radius = self.pairing.base_radius(1);
        let cells = self.options.contact.cells_per_half_width;
        let narrowest = (1.35 * scope.load_factor.sqrt() * cells).ceil() as i32 + 1;
        let mut reach = start.map_or(narrowest, |s| s.reach.max(narrowest));
        let mut cell = start.map_or_else(|| self.cell_size(request.torque), |s| s.cell);
        let most = no_load + MOST_DEFLECTION * self.pairing.pair().base_pitch() / base_radius;
        let mut rotation = match start {
            Some(start) => no_load + start.closing.max(0.0),
            None => no_load + self.deflection_guess(request.torque) / base_radius,
        };
        rotation = rotation.min(most);
        let mut warm = start.cloned();
        // rows that were in contact at the start; given up as soon as they turn out too few
        // torques around this one need room to widen
        let known = start.filter(|_| *scope == GridScope::default() && !request.stiffness_difference);
        let mut spans = known.map_or_else(Vec::new, |start| start.spans(request.mesh_cycle, cell));
        let mut stats = PositionStats::default();
        let mut outcome: Option<Settled> = None;
        // closing rotation at which the compliance was set
        let mut compliance_from = f64::NAN;
        for update in 0..MOST_UPDATES {
            stats.geometry_updates = update;
            let grid = self.grid(request, touch, rotation, (cell, reach), scope, &spans);
            if grid.size() == 0 {
                return Ok(None);
            }
            let same_cells = |before: &ContactGrid| grid.has_the_cells_of(before);
            let near_enough = (rotation - compliance_from).abs() < COMPLIANCE_TOLERANCE * (rotation - no_load);
            let (compliance, cracks) = match outcome.take() {
                Some(before) if near_enough && same_cells(&before.grid) => (before.compliance, before.cracks),
                _ => {
                    compliance_from = rotation;
                    let bodies = [&*self.bodies[0], &*self.bodies[1]];
                    let compliance = grid.compliance(bodies, self.pairing.tooth_steps(), &self.near_field(cell));
                    (compliance, self.crack_faces().cells(self, &grid))
                }
            };
            let active =
                warm.as_ref().map(|warm| to_cells(&grid, request.mesh_cycle, warm, 0.5 * self.pairing.never()));
            let (gaps, arms) = (grid.gaps(), grid.wheel_arms());
            let problem =
                ContactProblem { compliance: compliance.as_ref(), gap: &gaps, arm: &arms, load: request.torque };
            let (solution, crack_state) = self.solve_cells(&problem, cracks.as_ref(), active.as_deref())?;
            stats.solver = stats.solver.followed_by(&solution.stats);
            stats.cells = grid.size();
            let grid_rotation = rotation;
            let change = solution.approach;
            rotation += change;
            let active = from_cells(&grid, request.mesh_cycle, &solution.forces, 0.5 * self.pairing.never());
            let start = Start { closing: rotation - no_load, cell, reach, columns: grid.face.centres.len(), active };
            let before = warm.replace(start.clone());
            let crowded = grid_is_crowded(&grid, &solution.forces);
            if crowded && !spans.is_empty() {
                // too few rows: once more from where this step began, as if there had been all
                spans.clear();
                (rotation, warm) = (grid_rotation, before);
                continue;
            }
            let moved = change.abs() * base_radius > ROTATION_TOLERANCE * (rotation - no_load).abs() * base_radius;
            let converged = solution.is_converged();
            let fillet = touches_fillet(&grid, &solution.forces);
            let status = PositionStatus::NotConverged;
            let settled = Settled {
                grid,
                compliance,
                solution,
                cracks,
                crack_state,
                status,
                grid_rotation,
                rotation,
                no_load,
                start,
                stats,
            };
            let settled = outcome.insert(settled);
            if !converged {
                break;
            }
            if rotation > most {
                settled.status = PositionStatus::Overloaded;
                break;
            }
            if crowded && cell < 0.75 * self.widest_cell() {
                // the contact is wider than the load along the face made believe: coarser cells resolve it as well
                cell = on_ladder(CELL_STEP * cell);
            } else if crowded {
                reach = ((reach * 3 + 1) / 2).min(NearField::MOST_ROWS as i32 / 2 - 1);
            } else if !moved || request.torque == 0.0 {
                settled.status = if fillet { PositionStatus::FilletContact } else { PositionStatus::Converged };
                break;
            }
        }
        Ok(outcome)
    }

    /// Pairs that the deflection can close, the wheel closed by `rotation`, with rows around what is known of their contact (`spans`), else
    /// around their nearest approach.
    fn grid(
        &self,
        request: &PositionRequest<'_>,
        touch: &Touch,
        rotation: f64,
        (cell, reach): (f64, i32),
        scope: &GridScope,
        spans: &[Span],
    ) -> ContactGrid {
        let mut pairs = Vec::new();
        let deflection = (rotation - touch.rotation).max(0.0) * self.pairing.base_radius(1);
        for approach in &touch.approaches {
            // a pair that was apart by more than the deflection and half as much again stays apart
            if approach.gap > 1.5 * scope.load_factor * deflection.max(1e-3 * cell) {
                continue;
            }
            let pair = approach.pair;
            let placed = self.pairing.place(pair, request.mesh_cycle, rotation);
            let removed = |row: &OpposedPoints, z: f64| self.pairing.material_removed(pair, row, z);
            let (centre, reach) = match spans.iter().find(|span| span.pair == pair) {
                Some(span) => (f64::midpoint(span.first, span.last) * cell, span.reach().min(reach)),
                None => (approach.offset, reach),
            };
            let grid = PairGrid::new(pair, placed, cell, centre, reach, &self.face, &removed);
            if !grid.rows.is_empty() {
                pairs.push(grid);
            }
        }
        ContactGrid { pairs, cell, face: self.face.clone() }
    }

    /// Local slope from torques a little above and below, same geometry.
    fn difference_slope(
        &self,
        request: &PositionRequest<'_>,
        settled: &Settled,
        stats: &mut SolveStats,
    ) -> Result<Option<f64>, FecmError> {
        let Settled { grid, compliance, solution, cracks, .. } = settled;
        let (gaps, arms) = (grid.gaps(), grid.wheel_arms());
        let active: Vec<bool> = solution.forces.iter().map(|&f| f > 0.0).collect();
        let step = self.options.contact.slope_step;
        let mut rotations = [0.0; 2];
        for (rotation, sign) in rotations.iter_mut().zip([-1.0, 1.0]) {
            let load = request.torque * (1.0 + sign * step);
            let problem = ContactProblem { compliance: compliance.as_ref(), gap: &gaps, arm: &arms, load };
            let (nearby, _) = self.solve_cells(&problem, cracks.as_ref(), Some(&active))?;
            *stats = stats.followed_by(&nearby.stats);
            *rotation = nearby.approach;
        }
        let radius = self.pairing.base_radius(1);
        let opening = radius * radius * (rotations[1] - rotations[0]);
        Ok((opening > 0.0).then(|| 2.0 * step * request.torque / opening))
    }

    fn collect(
        &self,
        request: &PositionRequest<'_>,
        settled: &Settled,
        difference: Option<f64>,
        mut stats: PositionStats,
    ) -> PositionResult {
        let &Settled { ref grid, ref solution, status, rotation, no_load, .. } = settled;
        let radius = self.pairing.base_radius(1);
        let (ste, no_load_te) = (radius * rotation, radius * no_load);
        let deflection = ste - no_load_te;
        let total: f64 = solution.forces.iter().sum();
        let columns = grid.face.centres.len();
        // a mirrored cell's force is shared by two places
        let places = if grid.face.mirrored { 2.0 } else { 1.0 };
        let area = grid.cell * grid.face.width * places;
        let mut pairs = Vec::new();
        let mut patches = Vec::new();
        let mut at = 0;
        for pair in &grid.pairs {
            let count = pair.rows.len() * columns;
            let forces = &solution.forces[at..at + count];
            at += count;
            let force: f64 = forces.iter().sum();
            pairs.push(PairState {
                pair: pair.pair,
                force,
                share: if total > 0.0 { force / total } else { 0.0 },
                stiffness: if deflection > 0.0 { force / deflection } else { 0.0 },
                contact_width: contact_width(forces, columns, grid.cell),
                peak_pressure: forces.iter().fold(0.0_f64, |a, &f| a.max(f)) / area,
            });
            if request.keep_pressure && force > 0.0 {
                patches.push(PressurePatch {
                    pair: pair.pair,
                    pinion_roll: pair.rows.iter().map(|row| row.pinion_roll).collect(),
                    wheel_roll: pair.rows.iter().map(|row| row.wheel_roll).collect(),
                    face: grid.face.centres.clone(),
                    cell: [grid.cell, grid.face.width],
                    pressure: forces.chunks(columns).map(|row| row.iter().map(|f| f / area).collect()).collect(),
                });
            }
        }
        let moment: f64 = grid.wheel_arms().iter().zip(&solution.forces).map(|(a, f)| a * f).sum();
        stats.torque_residual = if request.torque > 0.0 { (moment / request.torque - 1.0).abs() } else { moment };
        let loaded = request.torque > 0.0;
        PositionResult {
            mesh_cycle: request.mesh_cycle,
            torque: request.torque,
            status,
            rotation,
            static_transmission_error: ste,
            no_load_transmission_error: no_load_te,
            mesh_force: request.torque / radius,
            stiffness_average_slope: (loaded && deflection > 0.0).then(|| request.torque / radius / deflection),
            stiffness_local_slope: solution.tangent.filter(|_| loaded).map(|t| t / (radius * radius)),
            stiffness_local_slope_difference: difference,
            pairs,
            patches,
            crack_faces: settled.crack_contacts(self),
            stats,
        }
    }

    /// Result where nothing can touch.
    fn untouched(&self, request: &PositionRequest<'_>) -> PositionResult {
        PositionResult {
            mesh_cycle: request.mesh_cycle,
            torque: request.torque,
            status: PositionStatus::NoContact,
            rotation: 0.0,
            static_transmission_error: 0.0,
            no_load_transmission_error: 0.0,
            mesh_force: request.torque / self.pairing.base_radius(1),
            stiffness_average_slope: None,
            stiffness_local_slope: None,
            stiffness_local_slope_difference: None,
            pairs: Vec::new(),
            patches: Vec::new(),
            crack_faces: Vec::new(),
            stats: PositionStats::default(),
        }
    }

    /// Whether the model is three-dimensional.
    #[must_use]
    pub fn is_solid(&self) -> bool {
        matches!(self.options.face, FaceModel::Solid { .. })
    }
}

/// Rows in contact on a tooth pair, in cells from the foot.
struct Span {
    pair: i32,
    first: f64,
    last: f64,
}

impl Span {
    /// Rows on either side of the middle, some spare ones with them.
    fn reach(&self) -> i32 {
        (0.5 * (self.last - self.first)).ceil() as i32 + SPARE_ROWS
    }
}

impl Start {
    /// Rows in contact of every pair, for cells of another size.
    fn spans(&self, mesh_cycle: f64, cell: f64) -> Vec<Span> {
        let own = mesh_cycle.floor() as i32;
        let ratio = self.cell / cell;
        let of_pair = |cells: &[(i32, i32, usize)]| {
            let (first, last) = (cells.first()?, cells.last()?);
            Some(Span { pair: first.0 + own, first: f64::from(first.1) * ratio, last: f64::from(last.1) * ratio })
        };
        self.active.chunk_by(|a, b| a.0 == b.0).filter_map(of_pair).collect()
    }

    /// Face cell of this start for one of `columns`: of half the face for the whole, where the two differ.
    fn column(&self, column: usize, columns: usize) -> usize {
        match columns.checked_sub(self.columns) {
            None | Some(0) => column,
            Some(half) if column >= half => column - half,
            Some(half) => (half - 1 - column).min(self.columns - 1),
        }
    }
}

/// Active cells of a grid by pair, row and column, pairs counted from the position's own. In loaded rows also those with a gap beyond `never`.
fn from_cells(grid: &ContactGrid, mesh_cycle: f64, forces: &[f64], never: f64) -> Vec<(i32, i32, usize)> {
    let columns = grid.face.centres.len();
    let own = mesh_cycle.floor() as i32;
    let mut cells = Vec::new();
    let mut at = 0;
    for pair in &grid.pairs {
        for (row, gaps) in pair.gaps.iter().enumerate() {
            let forces = &forces[at..at + columns];
            at += columns;
            if forces.iter().all(|&force| force == 0.0) {
                continue;
            }
            let active = (0..columns).filter(|&column| forces[column] > 0.0 || gaps[column] >= never);
            cells.extend(active.map(|column| (pair.pair - own, pair.first_row + row as i32, column)));
        }
    }
    cells
}

/// The start's active cells on a grid whose cells may have another size, less those with a gap beyond `never`.
fn to_cells(grid: &ContactGrid, mesh_cycle: f64, start: &Start, never: f64) -> Vec<bool> {
    let columns = grid.face.centres.len();
    let own = mesh_cycle.floor() as i32;
    let ratio = grid.cell / start.cell;
    let was_active = |pair: &PairGrid, row: usize, column: usize| {
        let place = f64::from(pair.first_row + row as i32) * ratio;
        let known = (pair.pair - own, place.round() as i32, start.column(column, columns));
        pair.gaps[row][column] < never && start.active.binary_search(&known).is_ok()
    };
    let rows = grid.pairs.iter().flat_map(|pair| (0..pair.rows.len()).map(move |row| (pair, row)));
    rows.flat_map(|(pair, row)| (0..columns).map(move |column| was_active(pair, row, column))).collect()
}

/// Whether load reaches the first or last row of a pair that could have more rows.
fn grid_is_crowded(grid: &ContactGrid, forces: &[f64]) -> bool {
    end_rows(grid, forces).any(|(limit, loaded)| limit.is_none() && loaded)
}

/// Whether load reaches a row next to a fillet.
fn touches_fillet(grid: &ContactGrid, forces: &[f64]) -> bool {
    end_rows(grid, forces).any(|(limit, loaded)| limit == Some(NoCell::Fillet) && loaded)
}

fn end_rows<'a>(grid: &'a ContactGrid, forces: &'a [f64]) -> impl Iterator<Item = (Option<NoCell>, bool)> + 'a {
    let columns = grid.face.centres.len();
    let mut start = 0;
    grid.pairs.iter().flat_map(move |pair| {
        let count = pair.rows.len() * columns;
        let own = &forces[start..start + count];
        start += count;
        let loaded = |cells: &[f64]| cells.iter().any(|&f| f > 0.0);
        [(pair.limits[0], loaded(&own[..columns])), (pair.limits[1], loaded(&own[count - columns..]))]
    })
}

/// Four standard deviations of the pressure along the profile, in the face column that carries most.
fn contact_width(forces: &[f64], columns: usize, cell: f64) -> f64 {
    let column_sum = |column: usize| forces.iter().skip(column).step_by(columns).sum::<f64>();
    let heaviest = (0..columns).max_by(|&a, &b| column_sum(a).total_cmp(&column_sum(b))).unwrap_or(0);
    let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
    for (row, force) in forces.iter().skip(heaviest).step_by(columns).enumerate() {
        let x = row as f64 * cell;
        sum += force;
        first += force * x;
        second += force * (x * x + cell * cell / 12.0);
    }
    if sum > 0.0 { 4.0 * (second / sum - (first / sum).powi(2)).max(0.0).sqrt() } else { 0.0 }
}
