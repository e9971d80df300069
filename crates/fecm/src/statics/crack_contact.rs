//! Contact between the faces of cracks, as part of the contact problem of a position.
//!
//! The openings `o` of the cells of [`crate::crack_faces`] under forces `f` on the flanks and `h` on the faces are `o = G f + F h`, and by reciprocity `h`
//! opens the gaps of the flanks by `G^T h`. So the cells join the problem of [`crate::lcp`] as cells without gap and without arm, for forces
//! within a gear do not balance its torque:
//!
//! `C -> [C, G^T; G, F]`, `g -> [g; 0]`, `a -> [a; 0]`.
//!
//! With a functional carried through the factorisation of its sector ([`super::reading`]), on tooth `t`,
//!
//! `G = (K_II^-1 w)^T f_t + c^T sum_b P_tb X_b^T f_b`, `F = w^T K_II^-1 w + c^T P_tt c`, `c = X^T w`,
//!
//! where `P` is the compliance of the closed ring on the cuts. A position is first solved as if faces did not touch: where none overlap, that is the
//! solution, to the bit. What open faces cost is then `G f`.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use faer::Mat;

use super::model::PairModel;
use super::position::Settled;
use super::reading::SectorReading;
use crate::body::{GearBody, Station};
use crate::condense::CondensedBody;
use crate::contact::{ContactGrid, PairGrid};
use crate::crack_faces::CrackFaceCells;
use crate::error::FecmError;
use crate::functional::Functional;
use crate::lcp::{ContactProblem, ContactSolution, solve_contact};
use crate::linalg::{
    DenseCholesky, add_block, add_product, add_scaled, column_slice, column_slice_mut, lower_triangle, product,
    symmetrise,
};

/// Openings below this fraction of the deflection count as none: rounding of the sectors' solutions, not contact.
const TOLERANCE: f64 = 1e-9;

/// Faces of one crack that press on each other at a position.
#[derive(Debug, Clone, PartialEq)]
pub struct CrackFaceContact {
    /// Pinion (0) or wheel (1).
    pub member: usize,
    /// Tooth number in `0..teeth`.
    pub tooth: i32,
    /// Distance of the cells' rows from the mouth along the path (m).
    pub along: Vec<f64>,
    /// Face position of each column (m); where the scene is symmetric, only the half at `z > 0`.
    pub face: Vec<f64>,
    /// Force of each cell `[row][column]`, mirror images included (N).
    pub force: Vec<Vec<f64>>,
    /// Mean pressure over each cell `[row][column]` (Pa).
    pub pressure: Vec<Vec<f64>>,
    /// Opening of each cell `[row][column]` (m).
    pub opening: Vec<Vec<f64>>,
}

impl CrackFaceContact {
    /// Normal force between the faces (N).
    #[must_use]
    pub fn total_force(&self) -> f64 {
        self.force.iter().flatten().sum()
    }

    /// Part of the cells that carry load.
    #[must_use]
    pub fn closed_fraction(&self) -> f64 {
        let count = self.force.iter().flatten().count();
        self.force.iter().flatten().filter(|&&force| force > 0.0).count() as f64 / count.max(1) as f64
    }
}

/// From loads on the flank of a tooth to openings, by crack, family and tooth.
type FlankMatrices = BTreeMap<(usize, usize, i32), Arc<Mat<f64>>>;

/// The faces of all cracks of a pair of gears, ready to join contact problems.
pub(super) struct CrackFaces {
    pub cracks: Vec<CrackOnTooth>,
    flank: Mutex<FlankMatrices>,
}

/// One crack.
pub(super) struct CrackOnTooth {
    pub member: usize,
    pub tooth: i32,
    pub cells: CrackFaceCells,
    /// Openings, by family.
    pub openings: Vec<Vec<Functional>>,
    /// `(K_II^-1 w)^T` at the flank's unknowns, by family.
    own: Vec<Mat<f64>>,
    /// `c`, by family.
    pub on_cuts: Vec<Mat<f64>>,
    /// `w^T K_II^-1 w`, all families.
    interior: Mat<f64>,
}

/// The cells of the cracks that a contact grid can load.
#[derive(Debug, Clone)]
pub(crate) struct CrackCells {
    /// Cracks, and the rows that each has.
    cracks: Vec<(usize, Range<usize>)>,
    /// `G`: openings by unit forces on the cells of the flanks (m/N).
    coupling: Mat<f64>,
    /// `F`: openings by unit forces on the faces (m/N).
    compliance: Mat<f64>,
}

/// Forces and openings of a position's crack cells.
#[derive(Debug, Clone)]
pub(crate) struct CrackState {
    pub forces: Vec<f64>,
    pub openings: Vec<f64>,
}

impl CrackFaces {
    /// Prepares all cracks of both gears; there may be none.
    pub fn new(bodies: &[Arc<GearBody>; 2]) -> Self {
        let mut cracks = Vec::new();
        for (member, body) in bodies.iter().enumerate() {
            cracks.extend(body.damaged_teeth().filter_map(|tooth| CrackOnTooth::new(body, member, tooth)));
        }
        Self { cracks, flank: Mutex::default() }
    }

    /// Cells of the cracks within reach of the loads on a grid, `None` if there are none.
    pub fn cells(&self, model: &PairModel, grid: &ContactGrid) -> Option<CrackCells> {
        if !model.options.contact.crack_face_contact {
            return None;
        }
        let in_reach = |crack: &CrackOnTooth, pair: &PairGrid| {
            let ring = &model.bodies[crack.member].families[0].ring;
            ring.offset(crack.tooth, model.tooth_of(pair.pair, crack.member)).abs() <= model.reach(crack.member)
        };
        let mut cracks = Vec::new();
        let mut size = 0;
        for (index, crack) in self.cracks.iter().enumerate() {
            if grid.pairs.iter().any(|pair| in_reach(crack, pair)) {
                cracks.push((index, size..size + crack.cells.size()));
                size += crack.cells.size();
            }
        }
        if cracks.is_empty() {
            return None;
        }
        let mut coupling = Mat::zeros(size, grid.size());
        let mut compliance = Mat::zeros(size, size);
        for (index, rows) in &cracks {
            let crack = &self.cracks[*index];
            let mut column = 0;
            for pair in &grid.pairs {
                if in_reach(crack, pair) {
                    let block = self.by_pair(model, *index, grid, pair);
                    add_block(&mut coupling, rows.start, column, 1.0, &block);
                }
                column += pair.rows.len() * grid.face.centres.len();
            }
            for (other, columns) in &cracks {
                if let Some(block) = self.between(model, *index, *other) {
                    add_block(&mut compliance, rows.start, columns.start, 1.0, &block);
                }
            }
        }
        symmetrise(&mut compliance);
        Some(CrackCells { cracks, coupling, compliance })
    }

    /// Openings of a crack by unit forces on the cells of a tooth pair.
    fn by_pair(&self, model: &PairModel, index: usize, grid: &ContactGrid, pair: &PairGrid) -> Mat<f64> {
        let crack = &self.cracks[index];
        let body = &model.bodies[crack.member];
        let tooth = model.tooth_of(pair.pair, crack.member);
        let sector = body.sector(tooth);
        let columns = grid.face.centres.len();
        let mut block = Mat::zeros(crack.cells.size(), pair.rows.len() * columns);
        for (k, family) in body.families.iter().enumerate() {
            let flank = self.by_flank(model, index, k, tooth);
            let values: Vec<Vec<f64>> = grid.face.centres.iter().map(|&z| family.basis.plane_values(z)).collect();
            for (i, row) in pair.rows.iter().enumerate() {
                let roll = if crack.member == 0 { row.pinion_roll } else { row.wheel_roll };
                let modal = by_station(&flank, &sector.station(roll), family.basis.plane_degrees().len());
                for (j, values) in values.iter().enumerate() {
                    let target = column_slice_mut(&mut block, i * columns + j);
                    values
                        .iter()
                        .enumerate()
                        .for_each(|(m, value)| add_scaled(target, *value, column_slice(&modal, m)));
                }
            }
        }
        block
    }

    /// Openings of a crack by unit loads on the unknowns of a tooth's flank, made once.
    fn by_flank(&self, model: &PairModel, index: usize, family: usize, tooth: i32) -> Arc<Mat<f64>> {
        let lock = || self.flank.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (index, family, tooth);
        if let Some(known) = lock().get(&key) {
            return Arc::clone(known);
        }
        // made outside the lock: two threads may both do it, with the same outcome
        let crack = &self.cracks[index];
        let body = &model.bodies[crack.member];
        let between = body.families[family].ring.pair(crack.tooth, tooth);
        let through = product(crack.on_cuts[family].transpose(), between.as_ref());
        let at_flank = &body.sector(tooth).families[family].at_flank;
        let mut made = product(through.as_ref(), at_flank.transpose());
        if tooth == crack.tooth {
            made += &crack.own[family];
        }
        Arc::clone(lock().entry(key).or_insert_with(|| Arc::new(made)))
    }

    /// Openings of one crack by unit forces on the faces of another, or the same; `None` where they do not feel each other.
    fn between(&self, model: &PairModel, observed: usize, loaded: usize) -> Option<Mat<f64>> {
        let (crack, other) = (&self.cracks[observed], &self.cracks[loaded]);
        let body = &model.bodies[crack.member];
        let ring = |family: usize| &body.families[family].ring;
        let is_felt =
            crack.member == other.member && ring(0).offset(crack.tooth, other.tooth).abs() <= model.reach(crack.member);
        is_felt.then(|| {
            let mut sum = if observed == loaded {
                crack.interior.clone()
            } else {
                Mat::zeros(crack.cells.size(), other.cells.size())
            };
            for family in 0..body.families.len() {
                let pair = ring(family).pair(crack.tooth, other.tooth);
                let through = product(crack.on_cuts[family].transpose(), pair.as_ref());
                add_product(sum.as_mut(), 1.0, through.as_ref(), other.on_cuts[family].as_ref());
            }
            sum
        })
    }
}

impl CrackOnTooth {
    /// Adds forces of the cells, if there are any, to the interior loads of the sector in a family.
    pub fn add_load(&self, family: usize, condensed: &CondensedBody, forces: &[f64], interior: &mut Mat<f64>) {
        for (opening, force) in self.openings[family].iter().zip(forces) {
            for &(node, dof, weight) in opening.terms() {
                if let Some(row) = condensed.interior_row(node, dof) {
                    interior[(row, 0)] += weight * force;
                }
            }
        }
    }

    fn new(body: &GearBody, member: usize, tooth: i32) -> Option<Self> {
        let sector = body.sector(tooth);
        let crack = sector.shape.crack.as_ref().filter(|crack| crack.rich.is_empty())?;
        let bases: Vec<_> = body.families.iter().map(|family| &family.basis).collect();
        let cells = CrackFaceCells::new(&sector.shape.mesh, [&crack.nodes[0], &crack.nodes[1]], &bases)?;
        let openings: Vec<Vec<Functional>> = bases.iter().map(|basis| cells.openings(basis)).collect();
        let reading = SectorReading::new(body, sector, &openings, Some(&openings));
        let mut interior = Mat::zeros(cells.size(), cells.size());
        let (mut own, mut on_cuts) = (Vec::new(), Vec::new());
        for family in reading.families {
            interior += family.at_faces;
            own.push(family.at_flank.transpose().to_owned());
            on_cuts.push(family.cuts);
        }
        symmetrise(&mut interior);
        Some(Self { member, tooth, cells, openings, own, on_cuts, interior })
    }
}

/// Openings by inward unit normal loads of a station, a column for each of the functions along the face.
fn by_station(flank: &Mat<f64>, station: &Station, functions: usize) -> Mat<f64> {
    let mut modal = Mat::zeros(flank.nrows(), functions);
    for (m, value) in station.values.iter().enumerate() {
        for k in 0..functions {
            add_scaled(column_slice_mut(&mut modal, k), *value, column_slice(flank, m * functions + k));
        }
    }
    modal
}

impl PairModel {
    /// Solves the flanks' contact problem, with the faces of cracks in it where they would overlap.
    pub(super) fn solve_cells(
        &self,
        problem: &ContactProblem<'_>,
        cracks: Option<&CrackCells>,
        warm: Option<&[bool]>,
    ) -> Result<(ContactSolution, Option<CrackState>), FecmError> {
        let open = solve_contact(self.options.contact.solver, problem, warm)?;
        match cracks {
            Some(cracks) => cracks.solve(self, problem, open),
            None => Ok((open, None)),
        }
    }
}

impl Settled {
    /// Takes the compliance between all cells (m/N), with the crack faces that press on each other held together.
    pub(crate) fn take_held_compliance(&mut self) -> Result<Mat<f64>, FecmError> {
        let mut compliance = std::mem::replace(&mut self.compliance, Mat::new());
        if let (Some(cracks), Some(state)) = (&self.cracks, &self.crack_state) {
            cracks.hold(&mut compliance, state)?;
        }
        Ok(compliance)
    }

    pub(super) fn crack_contacts(&self, model: &PairModel) -> Vec<CrackFaceContact> {
        match (&self.cracks, &self.crack_state) {
            (Some(cracks), Some(state)) => cracks.contacts(model.crack_faces(), state),
            _ => Vec::new(),
        }
    }
}

impl CrackCells {
    /// Solves a contact problem with the faces of cracks in it. Returns the solution on the flanks, and the state of the faces where they touch.
    fn solve(
        &self,
        model: &PairModel,
        problem: &ContactProblem<'_>,
        open: ContactSolution,
    ) -> Result<(ContactSolution, Option<CrackState>), FecmError> {
        let flank = problem.gap.len();
        let deflection = largest_deflection(problem, &open.forces);
        let free = times(&self.coupling, &open.forces);
        let overlaps = |opening: f64| opening < -TOLERANCE * deflection;
        if !open.is_converged() || !free.iter().any(|&opening| overlaps(opening)) {
            return Ok((open, None));
        }
        let size = flank + free.len();
        let mut compliance = Mat::zeros(size, size);
        compliance.as_mut().submatrix_mut(0, 0, flank, flank).copy_from(problem.compliance);
        compliance.as_mut().submatrix_mut(flank, 0, free.len(), flank).copy_from(&self.coupling);
        compliance.as_mut().submatrix_mut(0, flank, flank, free.len()).copy_from(self.coupling.transpose());
        compliance.as_mut().submatrix_mut(flank, flank, free.len(), free.len()).copy_from(&self.compliance);
        let with_none = |values: &[f64]| -> Vec<f64> {
            values.iter().copied().chain(std::iter::repeat_n(0.0, free.len())).collect()
        };
        let (gap, arm) = (with_none(problem.gap), with_none(problem.arm));
        let joint = ContactProblem { compliance: compliance.as_ref(), gap: &gap, arm: &arm, load: problem.load };
        let warm: Vec<bool> =
            open.forces.iter().map(|&f| f > 0.0).chain(free.iter().map(|&opening| overlaps(opening))).collect();
        let mut solution = solve_contact(model.options.contact.solver, &joint, Some(&warm))?;
        let forces = solution.forces.split_off(flank);
        let mut openings = times(&self.coupling, &solution.forces);
        for (opening, closed) in openings.iter_mut().zip(times(&self.compliance, &forces)) {
            *opening += closed;
        }
        solution.stats = open.stats.followed_by(&solution.stats);
        Ok((solution, Some(CrackState { forces, openings })))
    }

    /// Compliance of the flanks with the faces that carry load held closed: `C - G_A^T F_AA^-1 G_A` (m/N).
    fn hold(&self, compliance: &mut Mat<f64>, state: &CrackState) -> Result<(), FecmError> {
        let closed: Vec<usize> = (0..state.forces.len()).filter(|&i| state.forces[i] > 0.0).collect();
        let factor = DenseCholesky::new(lower_triangle(self.compliance.as_ref(), &closed), "crack faces")?;
        let own = Mat::from_fn(closed.len(), self.coupling.ncols(), |i, j| self.coupling[(closed[i], j)]);
        let mut solved = own.clone();
        factor.solve_in_place(solved.as_mut());
        add_product(compliance.as_mut(), -1.0, own.transpose(), solved.as_ref());
        symmetrise(compliance);
        Ok(())
    }

    /// Results of the cracks whose faces carry load.
    fn contacts(&self, faces: &CrackFaces, state: &CrackState) -> Vec<CrackFaceContact> {
        let loaded = self.cracks.iter().filter(|(_, rows)| state.forces[rows.clone()].iter().any(|&f| f > 0.0));
        let contact = |(index, rows): &(usize, Range<usize>)| {
            let crack = &faces.cracks[*index];
            let cells = &crack.cells;
            let columns = cells.face.len();
            let table = |values: &[f64]| values.chunks(columns).map(<[f64]>::to_vec).collect();
            let forces = &state.forces[rows.clone()];
            let pressures: Vec<f64> = forces.iter().enumerate().map(|(i, force)| force / cells.area(i)).collect();
            CrackFaceContact {
                member: crack.member,
                tooth: crack.tooth,
                along: cells.along.clone(),
                face: cells.face.clone(),
                force: table(forces),
                pressure: table(&pressures),
                opening: table(&state.openings[rows.clone()]),
            }
        };
        loaded.map(contact).collect()
    }
}

/// Displacement of the cell with the largest force (m).
fn largest_deflection(problem: &ContactProblem<'_>, forces: &[f64]) -> f64 {
    let most = (0..forces.len()).max_by(|&i, &j| forces[i].total_cmp(&forces[j]));
    most.map_or(0.0, |i| problem.compliance.row(i).iter().zip(forces).map(|(c, f)| c * f).sum())
}

fn times(matrix: &Mat<f64>, vector: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; matrix.nrows()];
    for (j, value) in vector.iter().enumerate().filter(|(_, value)| **value != 0.0) {
        add_scaled(&mut sum, *value, column_slice(matrix, j));
    }
    sum
}
