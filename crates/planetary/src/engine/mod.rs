//! Bodies and connections of a transmission, put together: at rest, in free vibration, in time.
//!
//! # Model
//!
//! Small motion about the nominal turning of the train, in axes that stand. Sun, planets, carrier and the bodies of the bevel stage are rigid with six
//! coordinates each; the housing is an [`ElasticBody`](crate::elastic::ElasticBody) whose seat carries the ring. All coupling is in scalar connections,
//! each of which knows one displacement `d = J q` and answers with one force:
//!
//! * bearings, splines, mounts: `k d + c d'`, `k` from 0 to infinity, in axes that stand or, on the carrier's pins, turn;
//! * flanks of a mesh: a law `F(m, x)` of mesh cycle and approach that only pushes ([`MeshLaw`](crate::mesh::MeshLaw)), and damping while it does.
//!
//! Rotation enters in `J` alone. The speed adds the centrifugal force of the planets and constant gyroscopic moments of every body (`-I_p w [axis]x` times
//! its tilting rate); centrifugal stiffness and Coriolis terms of coordinates that turn do not arise in standing axes.
//!
//! | at | equation | solved by |
//! |---|---|---|
//! | a step in time | generalised alpha ([`fecm::dynamics::Integrator`]) on all coordinates, forces of connections at its end | elimination of bilateral connections, Newton's method over flanks (`step`, `contact`) |
//! | rest | stationary energy | the same step with a vanishing inertia (`step`, `transmission`) |
//! | free vibration | tangent stiffness, infinite ones taken out | symmetric eigenproblem (`natural`) |
//!
//! A ring's seat moves as the harmonics of the seat tell, so its teeth act where they are, at the angle of the planet (`rows`).
//!
//! # Left out
//!
//! Friction of meshes and bearings, clearance of bearings, tilting of gears in their meshes (the approach is that of mid-face), elasticity of carrier and
//! shafts beyond their connections. The coast flanks of the bevel mesh push along the same line as its drive flanks, backwards.
//!
//! # Verified
//!
//! Natural frequencies of Lin and Parker (1999) with a moving ring; torques, reactions and energy at rest; an oscillator that parts from its mesh in closed
//! form; order two in time with bearings of any stiffness; energy of an undamped transmission; turning loads that do not excite; sidebands at multiples of the
//! planet-pass frequency alone (`tests/engine_*.rs`).

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
