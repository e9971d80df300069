//! Bodies and connections of a transmission, put together.

mod check;
mod contact;
mod dense;
mod natural;
mod request;
mod rows;
mod run;
mod spec;
mod step;
mod system;
mod transmission;

pub use request::{
    BearingRecord, BodyRecord, Equilibrium, MeshRecord, NaturalMode, RunRequest, SensorRecord, Series, Start,
    TransmissionRun, TransmissionState, TransmissionStats, Turning,
};
pub use run::Runner;
pub use spec::{
    Anchor, Bearing, BevelStage, BodyId, CoastFlank, Mesh, Planet, PlanetaryStage, RigidBody, TransmissionSpec,
};
pub use transmission::{Load, Transmission};
