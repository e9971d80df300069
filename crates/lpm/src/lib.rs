//! Lumped-parameter dynamics of a gear pair with contact loss.
//!
//! Two gears on elastic supports, joined by a mesh that pushes but does not pull. The mesh is known by two periodic curves
//! over the mesh cycle, its local stiffness `k_l` and its static transmission error `delta_0`, from wherever they come: a
//! finite-element run, a measured table, a Fourier series, a rectangular wave. The crate finds how the pair
//! swings: over time, over a rotation in steady state, over speed with every branch and turning point, after a blow, and
//! by how much damage changes it.
//!
//! # What to call
//!
//! | to get | call |
//! |---|---|
//! | the curves | [`Curve::table`], [`Curve::samples`], [`Curve::fourier`], [`Curve::rectangular`]; a damaged tooth once a rotation: [`Curve::with_cycles_replaced`] |
//! | a model | [`Gear`] twice, [`GearPair`], [`Excitation::new`], [`Model::new`]; [`GearPair::table_3_2`] is the dissertation's pair |
//! | natural frequencies, damping ratio | [`Model::natural_frequencies`], [`Model::damping_ratio`]; by a blow: [`Model::impulse_test`] |
//! | response from any state | [`Model::simulate`] |
//! | steady state over whole rotations | [`Model::steady_response`] |
//! | damage-induced response and spectrum | [`Model::damage_response`] |
//! | sweep up or down in speed | [`Model::sweep`] with [`frequencies`] |
//! | whole resonance curve, unstable parts too | [`Model::continuation`] |
//! | one periodic solution, stable or not | [`Model::shoot`] |
//! | what eliminating the supports costs | [`elimination_error`], [`elimination_frequency_error`] |
//! | parametric stability in permanent contact | [`Model::parametric_multipliers`] |
//! | error against run time of the integrators | [`work_precision`] |
//!
//! A [`Response`] holds transmission error, mesh and bearing forces, contact-loss intervals and events, and reads off
//! extremes, RMS, dynamic factor, forces on single tooth pairs ([`Response::pair_force`]) and spectra.
//!
//! # Where things are
//!
//! | module | holds |
//! |---|---|
//! | `curve`, `excitation` | periodic curves, jumps and kinks |
//! | `elimination` | error of eliminated supports, estimated |
//! | `model`, `system` | equations of motion, input free or prescribed, supports integrated, eliminated or rigid |
//! | `integrate` | four methods, step control, contact events, derivative of the flow |
//! | `periodic`, `floquet`, `branch`, `continuation`, `sweep` | steady states, stability, branches |
//! | `response`, `spectrum`, `damage`, `impulse` | what is read off |
//! | `precision` | work-precision study |
//! | [`analytic`] | closed forms that the tests compare with |
//!
//! SI throughout (m, N, s, kg, rad, Hz); phase in mesh cycles. Nothing prints, reads files or uses more than the caller's
//! thread; [`Model`] is `Sync`, so speeds or damage states may run in parallel, with the same bits as one by one.
//!
//! # Example
//!
//! ```
//! use lpm::{ContinuationOptions, Curve, Excitation, GearPair, Input, Model, Sampling, SteadyOptions, Supports};
//!
//! // Two pairs of teeth in contact over 0.64 of the cycle; error of a linear mesh under the mean force.
//! let pair = GearPair { damping_when_apart: true, ..GearPair::table_3_2(Input::Prescribed) };
//! let f0 = pair.mean_force();
//! let k = Curve::rectangular(533e6, 806e6, 0.18, 0.64)?;
//! let delta_0 = Curve::rectangular(f0 / 533e6, f0 / 806e6, 0.18, 0.64)?;
//! let healthy = Model::new(&pair, &Excitation::new(&k, &delta_0)?, Supports::Eliminated)?;
//!
//! // Two stable motions live between about 1700 and 2350 Hz.
//! let start = healthy.steady_state(3000.0, &healthy.equilibrium(0.0), &SteadyOptions::default())?;
//! let range = ContinuationOptions { from: 1450.0, to: 3050.0, ..Default::default() };
//! let branch = healthy.continuation(3000.0, &start.state, &range)?;
//! let (from, to) = branch.coexistence()[0];
//! assert!((from - 1705.0).abs() < 1.0 && (to - 2348.0).abs() < 1.0);
//!
//! // A damaged tooth in cycle 14 of 27: stiffness down by a tenth.
//! let damaged = Model::new(
//!     &pair,
//!     &Excitation::new(
//!         &k.with_cycles_replaced(27, 14, &k.scaled(0.9, 0.0)?)?,
//!         &delta_0.with_cycles_replaced(27, 14, &delta_0.scaled(1.0 / 0.9, 0.0)?)?,
//!     )?,
//!     Supports::Eliminated,
//! )?;
//! let d = healthy.damage_response(
//!     &damaged, 900.0, &healthy.equilibrium(0.0), &Sampling::default(), &SteadyOptions::default(),
//! )?;
//! assert_eq!(d.difference.len(), 2700);
//! assert!(d.peak_to_peak() > d.static_peak_to_peak());
//! # Ok::<(), lpm::LpmError>(())
//! ```

#![cfg_attr(
    not(test),
    warn(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::print_stdout,
        clippy::print_stderr,
        clippy::missing_errors_doc
    )
)]

pub mod analytic;
mod branch;
mod continuation;
mod curve;
mod damage;
mod elimination;
mod error;
mod excitation;
mod floquet;
mod impulse;
mod integrate;
mod linear;
mod model;
mod periodic;
mod precision;
mod response;
mod spectrum;
mod sweep;
mod system;

pub use branch::{Branch, BranchEnd, BranchPoint, ContinuationOptions, TurningPoint};
pub use curve::{Curve, CurveRange, Interpolation};
pub use damage::{DamageResponse, SteadyResponse};
pub use elimination::{elimination_error, elimination_frequency_error};
pub use error::LpmError;
pub use excitation::Excitation;
pub use floquet::{Multiplier, Stability, stability};
pub use impulse::{ImpulseTest, mesh_average};
pub use integrate::{Event, Method, Options, STOP_STEPS, Stats, StepControl, Stop};
pub use model::{Gear, GearPair, Input, Model, Separation, State, Supports};
pub use periodic::{Orbit, OrbitStatus, ShootingOptions, Steady, SteadyOptions};
pub use precision::{SUPPORT_STIFFNESSES, WorkPrecision, work_precision};
pub use response::{EnergyBalance, Extreme, Interval, Response, Sampling};
pub use spectrum::{Spectrum, damage_induced};
pub use sweep::{Measure, SweepOptions, SweepPoint, frequencies};
pub use system::ContactPhase;
