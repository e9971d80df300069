//! Statics of a gear pair: transmission error, load sharing, pressure and mesh stiffness over the mesh cycle.
//!
//! At one position the pinion's hub is held and the wheel's hub closes by a rotation `phi` until the contact carries the torque:
//!
//! `gap_i = g_i + (C f)_i - a_i phi >= 0`, `f_i >= 0`, `f_i gap_i = 0`, `sum a_i f_i = T`.
//!
//! Gaps `g_i` and arms `a_i` are those of the exact geometry with the wheel turned by a predicted `phi`, and the position is solved again
//! from the new one until the prediction no longer matters: nothing is linearised about the line of action.
//!
//! | symbol | field | meaning |
//! |---|---|---|
//! | `delta_0` | `static_transmission_error` | `r_bw phi` (m), dissertation section 2.2 |
//! | `epsilon` | `no_load_transmission_error` | the same at first touch, `T -> 0` |
//! | `k_a` | `stiffness_average_slope` | `F_m / (delta_0 - epsilon)`, Eq. (3.1), `F_m = T / r_bw` |
//! | `k_l` | `stiffness_local_slope` | `dF_m / d delta`, the limit of Eq. (3.2), exact from the cells in contact |
//! | `k_i` | [`PairState::stiffness`] | `F_i / (delta_0 - epsilon)`, section 2.2 |
//!
//! Faces of cracks that would overlap join the problem as cells with neither gap nor arm ([`CrackFaceContact`]); faces that part cost nothing but a look.
//!
//! [`PairModel::new`] does what is done once (mesh, condense); [`PairModel::solve`] is cheap and parallel.

mod crack_contact;
mod crack_tip;
mod deformation;
mod model;
mod options;
mod position;
mod reading;
mod result;
mod root_stress;
mod series;

pub use crack_contact::CrackFaceContact;
pub use crack_tip::{CrackTip, CrackTipReader};
pub use deformation::BodyDeformation;
pub use model::{ModelStats, PairModel};
pub use options::{ContactOptions, MemberOptions, PairModelOptions};
pub use position::Settled;
pub(crate) use position::{GridScope, PositionRequest, Start};
pub use result::{PairState, PositionResult, PositionStats, PositionStatus, PressurePatch};
pub use root_stress::{RootPeak, RootStress, RootStressReader};
pub use series::{Observer, StaticsRequest, StaticsSeries};
