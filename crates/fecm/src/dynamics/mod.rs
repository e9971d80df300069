//! Dynamics of a gear pair: Newmark integration with the contact solved at every step.
//!
//! Every body is a rigid hub with elastic modes (`system`), held by bearings; the meshes press on it through contact grids of the same cells, gaps and
//! compliance as in [`crate::statics`] (`operator`). A step of time (dissertation section 3.4.1; `integrator`) is a contact problem held by
//! inertia ([`crate::lcp::solve_held`]): forces `f` and motions `q` at its end with
//!
//! `A q - R^T f = b`, `gap = g + R q + C f >= 0`, `f >= 0`, `f . gap = 0`,
//!
//! `A` the step matrix and `b` what the motion so far and the loads give. Gaps, arms and compliance are those of the position at the end of the step
//! (`schedule`).
//!
//! Left out: friction, Coriolis and centrifugal terms of the elastic motion in the turning frame, inertia coupling between hub translations and modes.

mod flank;
#[cfg(test)]
mod full_fe;
#[cfg(test)]
mod impact;
mod impulse;
mod integrator;
mod operator;
mod options;
mod resolution;
mod result;
mod run;
mod schedule;
mod system;

pub use impulse::{ImpulseReading, ImpulseSpec};
pub use integrator::{Integrator, Weights};
pub use options::{
    DynamicsOptions, DynamicsRequest, DynamicsState, InitialState, Motion, RotorInertia, RotorOptions, StepSolver,
    TorquePulse,
};
pub use resolution::MeshVibration;
pub use result::{DynamicsRun, EnergyBalance, RunStats, Snapshot, StepRecord};
pub use run::{PairDynamics, Runner, SteadySpec};
pub use system::{Damping, HUB_COORDINATES, ROTATION, Support};
