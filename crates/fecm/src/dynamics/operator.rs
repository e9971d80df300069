//! Contact of a mesh at one position, as a step of dynamics needs it.
//!
//! The cells, gaps and compliance are those of the static solution at the position ([`crate::statics`]), taken wide enough for more than the static
//! load. Motions of the hubs and elastic modes open the gaps linearly from there:
//!
//! `gap = g + R q + Phi eta + C_res f`, `C_res = C - Phi Omega^-2 Phi^T`
//!
//! with `C` the static compliance and `C_res` what the kept modes leave of it (residual flexibility; R. H. MacNeal, *Comput. Struct.* 1, 1971,
//! 581-601), so that a slow motion is the static answer whatever the number of modes. With the modes of a step eliminated the compliance is
//! `C - Phi (Omega^-2 - A_mm^-1) Phi^T`. The linearisation errs by `(q - q_static)^2 / 2 R`: some nanometres at the edge of losing contact.

use faer::Mat;
use nalgebra::{Point2, Vector2};

use super::flank::{PairModes, take_out};
use super::system::{StepMatrix, System};
use crate::error::FecmError;
use crate::lcp::{FactorMemory, HeldBlock, HeldProblem, solve_held};
use crate::linalg::{add_product, column_slice_mut};
use crate::pairing::Pairing;
use crate::statics::{PairModel, PressurePatch, Settled};

/// Cells of one tooth pair within an operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PairCells {
    /// Tooth-pair number at the position where the operator was made.
    pub pair: i32,
    /// First cell.
    pub start: usize,
    /// Number of cells.
    pub count: usize,
    /// Whether load in the first or last row would want more rows.
    pub open_ends: [bool; 2],
}

/// Which flanks an operator's cells lie on, and how its plane lies in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Flanks {
    /// The pinion drives.
    Drive,
    /// The wheel drives: the same pair seen in a mirror that exchanges the flanks, with this closing rotation of the mirrored wheel when the real
    /// one is at its nominal rotation (rad, negative by the backlash).
    Coast {
        /// See above.
        offset: f64,
    },
}

/// See the module header.
pub(super) struct Operator {
    pub pairs: Vec<PairCells>,
    pub columns: usize,
    /// `g` at `q = 0`, `eta = 0` (m).
    pub gap: Vec<f64>,
    /// `R`: cells x rigid coordinates.
    pub motion: Mat<f64>,
    /// `R - Phi A_mm^-1 A_mr`.
    pub step_motion: Mat<f64>,
    /// `Phi`: cells x modes.
    pub modes: Mat<f64>,
    /// `C - Phi (Omega^-2 - A_mm^-1) Phi^T` (m/N).
    pub compliance: Mat<f64>,
    /// Static closing rotation of the wheel (rad), in the frame of the flanks.
    pub rotation: f64,
    /// Closing rotation at first touch (rad).
    pub no_load: f64,
    /// Largest closing rotation at which all pairs that can touch are in the grid (rad).
    pub most: f64,
    /// Static cell forces (N).
    pub static_forces: Vec<f64>,
    pub memory: FactorMemory,
    /// Roll distances of every row on pinion and wheel (m).
    pub rolls: Vec<[f64; 2]>,
    face: Vec<f64>,
    cell: [f64; 2],
    mirrored: bool,
}

impl Operator {
    /// From the static solution at a position.
    pub fn new(
        mut settled: Settled,
        model: &PairModel,
        load_factor: f64,
        flanks: Flanks,
        (system, step): (&System, &StepMatrix),
        flank_modes: &PairModes,
    ) -> Result<Self, FecmError> {
        let pairing = model.pairing();
        let grid = &settled.grid;
        let columns = grid.face.centres.len();
        let size = grid.size();
        let arms = grid.wheel_arms();
        let mut gap = grid.gaps();
        // from the rotation at which the gaps were taken to none of the mirrored or real wheel
        let from = match flanks {
            Flanks::Drive => settled.grid_rotation,
            Flanks::Coast { offset } => settled.grid_rotation - offset,
        };
        for (gap, arm) in gap.iter_mut().zip(&arms) {
            *gap += arm * from;
        }
        let motion = motions(&settled, pairing, flanks, system);
        let mut modes = Mat::zeros(size, system.mode_count());
        // crack faces that the static load closes stay closed
        let mut compliance = settled.take_held_compliance()?;
        let mut step_motion = motion.clone();
        // teeth that meet on their coast flanks deform as they would at rest
        if system.mode_count() > 0 && flanks == Flanks::Drive {
            modes = flank_modes.openings(&settled, model);
            let weights = system.frequencies().iter().zip(&step.modal).map(|(w, a)| 1.0 / (w * w) - 1.0 / a);
            take_out(&mut compliance, &modes, weights);
            let mut divided = modes.clone();
            for (k, a) in step.modal.iter().enumerate() {
                column_slice_mut(&mut divided, k).iter_mut().for_each(|v| *v /= a);
            }
            add_product(step_motion.as_mut(), -1.0, divided.as_ref(), step.coupling.transpose());
        }
        let grid = settled.grid;
        let mut pairs = Vec::new();
        let mut start = 0;
        for pair in &grid.pairs {
            let count = pair.rows.len() * columns;
            pairs.push(PairCells { pair: pair.pair, start, count, open_ends: pair.limits.map(|l| l.is_none()) });
            start += count;
        }
        let rows = grid.pairs.iter().flat_map(|pair| &pair.rows);
        Ok(Self {
            pairs,
            columns,
            gap,
            motion,
            step_motion,
            modes,
            compliance,
            rotation: settled.rotation,
            no_load: settled.no_load,
            most: settled.no_load + load_factor * (settled.rotation - settled.no_load),
            static_forces: settled.solution.forces,
            memory: FactorMemory::default(),
            rolls: rows.map(|row| [row.pinion_roll, row.wheel_roll]).collect(),
            cell: [grid.cell, grid.face.width],
            mirrored: grid.face.mirrored,
            face: grid.face.centres,
        })
    }

    /// Whether load reaches a row beyond which the grid could go on.
    pub fn is_crowded(&self, forces: &[f64]) -> bool {
        let loaded = |cells: &[f64]| cells.iter().any(|&f| f > 0.0);
        self.pairs.iter().any(|pair| {
            let own = &forces[pair.start..pair.start + pair.count];
            (pair.open_ends[0] && loaded(&own[..self.columns]))
                || (pair.open_ends[1] && loaded(&own[pair.count - self.columns..]))
        })
    }

    /// Generalised force `(R, Phi)^T f`; modes as the operator's own teeth feel them.
    pub fn generalised(&self, forces: &[f64]) -> Vec<f64> {
        let of = |matrix: &Mat<f64>, k: usize| -> f64 {
            matrix.col_as_slice(k).iter().zip(forces).map(|(r, f)| r * f).sum()
        };
        let rigid = (0..self.motion.ncols()).map(|k| of(&self.motion, k));
        let modal = (0..self.modes.ncols()).map(|k| of(&self.modes, k));
        rigid.chain(modal).collect()
    }

    /// Force of every pair with cells (N), pair numbers moved by `shift`.
    pub fn pair_forces(&self, forces: &[f64], shift: i32) -> impl Iterator<Item = (i32, f64)> {
        self.pairs
            .iter()
            .map(move |pair| (pair.pair + shift, forces[pair.start..pair.start + pair.count].iter().sum::<f64>()))
    }

    /// Energy stored in the compliance that no mode carries (J), `1/2 f C_res f`, with the forces that positions of hubs and modes imply.
    /// Only drive flanks; `C_res` is built for this, so it costs a factorisation.
    pub fn energy_at(&self, q: &[f64], eta: &[f64], modal: &[f64], system: &System) -> Result<f64, FecmError> {
        let mut gap = self.gap.clone();
        let columns =
            (0..q.len()).map(|k| (&self.motion, k, q[k])).chain((0..eta.len()).map(|k| (&self.modes, k, eta[k])));
        for (matrix, k, value) in columns {
            for (gap, rate) in gap.iter_mut().zip(matrix.col_as_slice(k)) {
                *gap += rate * value;
            }
        }
        // C_res = C_step - Phi A_mm^-1 Phi^T
        let mut residual = self.compliance.clone();
        if system.mode_count() > 0 {
            take_out(&mut residual, &self.modes, modal.iter().map(|a| 1.0 / a));
        }
        let none = Mat::zeros(gap.len(), 0);
        let stiffness = Mat::zeros(0, 0);
        let block = HeldBlock { compliance: residual.as_ref(), motion: none.as_ref(), gap: &gap };
        let problem = HeldProblem { blocks: vec![block], stiffness: stiffness.as_ref(), load: &[] };
        let solution = solve_held(&problem, &mut [FactorMemory::default()])?;
        // in contact the gap is closed by the compliance alone: f C f = - f g
        Ok(solution.forces.iter().flatten().zip(&gap).map(|(f, g)| -0.5 * f * g).sum())
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let n = self.gap.len();
        8 * n * (n + 2 * self.motion.ncols() + self.modes.ncols() + 8)
    }

    /// Pressures of loaded pairs.
    pub fn patches(&self, forces: &[f64], shift: i32) -> Vec<PressurePatch> {
        let places = if self.mirrored { 2.0 } else { 1.0 };
        let area = self.cell[0] * self.cell[1] * places;
        let loaded =
            self.pairs.iter().filter(|pair| forces[pair.start..pair.start + pair.count].iter().any(|&f| f > 0.0));
        loaded
            .map(|pair| {
                let own = &forces[pair.start..pair.start + pair.count];
                let rows = pair.start / self.columns..(pair.start + pair.count) / self.columns;
                PressurePatch {
                    pair: pair.pair + shift,
                    pinion_roll: self.rolls[rows.clone()].iter().map(|r| r[0]).collect(),
                    wheel_roll: self.rolls[rows].iter().map(|r| r[1]).collect(),
                    face: self.face.clone(),
                    cell: self.cell,
                    pressure: own.chunks(self.columns).map(|row| row.iter().map(|f| f / area).collect()).collect(),
                }
            })
            .collect()
    }
}

/// `R`: the work of a unit force of each cell on unit rigid coordinates. A mirrored cell stands for two places whose tilts cancel.
fn motions(settled: &Settled, pairing: &Pairing, flanks: Flanks, system: &System) -> Mat<f64> {
    let pair = pairing.pair();
    let centres = [gear_geom::Member::Pinion, gear_geom::Member::Wheel].map(|member| pair.centre(member));
    let mirror = |v: Vector2<f64>| if flanks == Flanks::Drive { v } else { Vector2::new(v.x, -v.y) };
    let grid = &settled.grid;
    let rows: Vec<(Point2<f64>, Vector2<f64>)> = (grid.pairs.iter().flat_map(|pair| &pair.rows))
        .map(|row| (Point2::from(mirror(row.position.coords)), mirror(row.normal)))
        .collect();
    let columns = grid.face.centres.len();
    Mat::from_fn(rows.len() * columns, system.rigid_count(), |cell, coordinate| {
        let (body, axis) = system.coordinates[coordinate];
        let (position, normal) = rows[cell / columns];
        let z = if grid.face.mirrored { 0.0 } else { grid.face.centres[cell % columns] };
        let lever = position - centres[body];
        let along = match axis {
            0 => normal.x,
            1 => normal.y,
            3 => -z * normal.y,
            4 => z * normal.x,
            5 => lever.x * normal.y - lever.y * normal.x,
            _ => 0.0,
        };
        // the normal is the direction of the force on the wheel: the wheel opens along it, the pinion against it
        if body == 0 { -along } else { along }
    })
}
