//! Bodies and connections of a transmission, put together.

mod check;
mod request;
mod spec;

pub use request::{
    BearingRecord, BodyRecord, Equilibrium, MeshRecord, NaturalMode, RunRequest, SensorRecord, Series, Start,
    TransmissionRun, TransmissionState, TransmissionStats, Turning,
};
pub use spec::{
    Anchor, Bearing, BevelStage, BodyId, CoastFlank, Mesh, Planet, PlanetaryStage, RigidBody, TransmissionSpec,
};
