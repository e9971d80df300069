//! Lumped-parameter dynamics of a gear pair with contact loss.
//!
//! See the modules.

pub mod analytic;
mod continuation;
mod curve;
mod damage;
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

pub use continuation::{Branch, BranchEnd, BranchPoint, ContinuationOptions, TurningPoint};
pub use curve::{Curve, CurveRange, Interpolation};
pub use damage::{DamageResponse, SteadyResponse};
pub use error::LpmError;
pub use excitation::Excitation;
pub use floquet::{Multiplier, Stability, stability};
pub use impulse::{ImpulseTest, mesh_average};
pub use integrate::{Event, Method, Options, Stats, StepControl};
pub use model::{Gear, GearPair, Input, Model, Separation, State, Supports};
pub use periodic::{Orbit, OrbitStatus, ShootingOptions, Steady, SteadyOptions};
pub use precision::{SUPPORT_STIFFNESSES, WorkPrecision, work_precision};
pub use response::{EnergyBalance, Extreme, Interval, Response, Sampling};
pub use spectrum::{Spectrum, damage_induced};
pub use sweep::{Measure, SweepOptions, SweepPoint, frequencies};
pub use system::ContactPhase;
