//! Lumped-parameter dynamics of a gear pair with contact loss.
//!
//! See the modules.

pub mod analytic;
mod curve;
mod error;
mod excitation;
mod integrate;
mod model;
mod response;
mod spectrum;
mod system;

pub use curve::{Curve, CurveRange, Interpolation};
pub use error::LpmError;
pub use excitation::Excitation;
pub use integrate::{Event, Method, Options, Stats, StepControl};
pub use model::{Gear, GearPair, Input, Model, Separation, State, Supports};
pub use response::{EnergyBalance, Extreme, Interval, Response, Sampling};
pub use spectrum::{Spectrum, damage_induced};
pub use system::ContactPhase;
