//! Results of a static analysis, in SI units.

use super::crack_contact::CrackFaceContact;
use crate::lcp::SolveStats;

/// One tooth pair at one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairState {
    /// Tooth-pair number: pair `k` touches at the pitch point at mesh cycle `k`.
    pub pair: i32,
    /// Normal force (N).
    pub force: f64,
    /// Share of the sum of the pairs' forces, 0 without load.
    pub share: f64,
    /// Tooth-pair stiffness `F_i / (delta_0 - epsilon)` (N/m), 0 without load.
    pub stiffness: f64,
    /// Full width of the contact along the profile where it is most heavily loaded (m), from the second moment of the pressure: exact for
    /// Hertz's distribution.
    pub contact_width: f64,
    /// Largest cell pressure (Pa).
    pub peak_pressure: f64,
}

/// Contact pressure on one tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PressurePatch {
    /// Tooth-pair number.
    pub pair: i32,
    /// Roll distance of each row on the pinion (m).
    pub pinion_roll: Vec<f64>,
    /// Roll distance of each row on the wheel (m).
    pub wheel_roll: Vec<f64>,
    /// Face position of each column (m); where the scene is symmetric, only the half at `z > 0`.
    pub face: Vec<f64>,
    /// Size of a cell along the profile and along the face (m).
    pub cell: [f64; 2],
    /// Pressure `[row][column]` (Pa).
    pub pressure: Vec<Vec<f64>>,
}

/// How a position was solved.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PositionStats {
    /// Contact cells.
    pub cells: usize,
    /// Times the geometry was set again from the new rotation or a wider grid.
    pub geometry_updates: usize,
    /// Contact solver, all solves of this position together; residuals of the last.
    pub solver: SolveStats,
    /// `|sum a_i f_i - T| / T`.
    pub torque_residual: f64,
}

/// Whether the answer at a position can be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionStatus {
    /// Converged.
    Converged,
    /// Converged, but the contact runs into the fillet of a tooth, where no contact is modelled.
    FilletContact,
    /// The iteration stopped early; the residuals say how far it got.
    NotConverged,
    /// The load would push the teeth a quarter of a base pitch into each other, far beyond what small-strain elasticity and the
    /// geometry of the flanks can mean; numbers are those of the step where this was noticed.
    Overloaded,
    /// Nothing can touch at this position.
    NoContact,
}

impl PositionStatus {
    /// All states.
    pub const ALL: [Self; 5] =
        [Self::Converged, Self::FilletContact, Self::NotConverged, Self::Overloaded, Self::NoContact];

    /// Name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::FilletContact => "fillet-contact",
            Self::NotConverged => "not-converged",
            Self::Overloaded => "overloaded",
            Self::NoContact => "no-contact",
        }
    }

    /// Whether the position's numbers are a solution.
    #[must_use]
    pub fn is_usable(self) -> bool {
        matches!(self, Self::Converged | Self::FilletContact)
    }
}

/// One position of the mesh cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionResult {
    /// Mesh cycle.
    pub mesh_cycle: f64,
    /// Torque on the wheel (N m).
    pub torque: f64,
    /// Whether the answer can be used.
    pub status: PositionStatus,
    /// Closing rotation of the wheel's hub (rad).
    pub rotation: f64,
    /// `r_bw` times the rotation (m).
    pub static_transmission_error: f64,
    /// The same at first touch without load (m).
    pub no_load_transmission_error: f64,
    /// `T / r_bw` (N).
    pub mesh_force: f64,
    /// Average-slope mesh stiffness (N/m); `None` without load.
    pub stiffness_average_slope: Option<f64>,
    /// Local-slope mesh stiffness (N/m), exact tangent of the cells in contact: a stair in the load, as cells join one by one; `None` without
    /// contact.
    pub stiffness_local_slope: Option<f64>,
    /// Local-slope mesh stiffness (N/m) by torques above and below ([`super::ContactOptions::slope_step`]): the slope of the stair; `None` without
    /// load, or where not asked for.
    pub stiffness_local_slope_difference: Option<f64>,
    /// Pairs in the contact problem, by number.
    pub pairs: Vec<PairState>,
    /// Pressures, if kept.
    pub patches: Vec<PressurePatch>,
    /// Cracks whose faces press on each other.
    pub crack_faces: Vec<CrackFaceContact>,
    /// How it was solved.
    pub stats: PositionStats,
}

impl PositionResult {
    /// The best local-slope mesh stiffness there is (N/m): by differences, else the tangent.
    #[must_use]
    pub fn local_stiffness(&self) -> Option<f64> {
        self.stiffness_local_slope_difference.or(self.stiffness_local_slope)
    }

    /// Pairs that carry load.
    pub fn loaded_pairs(&self) -> impl Iterator<Item = &PairState> {
        self.pairs.iter().filter(|pair| pair.force > 0.0)
    }

    /// Largest pressure of all pairs (Pa).
    #[must_use]
    pub fn peak_pressure(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.peak_pressure).fold(0.0, f64::max)
    }
}
