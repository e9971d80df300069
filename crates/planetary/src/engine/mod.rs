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
//! | a step in time | bodies exactly under polynomial forces, connections at Gauss stages (`propagator`, `stages`) | elimination of bilateral connections, Newton's method over flanks (`march`, `stage_contact`) |
//! | a record | low-pass of the motion in continuous time | `band` |
//! | rest | stationary energy | steps of a vanishing inertia (`rest`, `contact`, `transmission`) |
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
//! form; order of convergence with bearings of any stiffness; a housing of 60 modes under a known force against its exact motion; energy of an undamped transmission; turning loads that do not
//! excite; sidebands at multiples of the planet-pass frequency alone (`tests/engine_*.rs`).

mod band;
mod check;
mod contact;
mod dense;
mod march;
mod natural;
mod placed;
mod propagator;
mod request;
mod rest;
mod rows;
mod run;
mod spec;
mod stage_contact;
mod stages;
mod system;
mod transmission;

pub use band::Band;
pub use request::{
    BearingRecord, BodyRecord, Deviation, Equilibrium, MeshRecord, NaturalMode, RunRequest, STAGES, SensorRecord,
    Series, Start, TransmissionRun, TransmissionState, TransmissionStats, Turning,
};
pub use run::Runner;
pub use spec::{
    Anchor, Bearing, BevelStage, BodyId, CoastFlank, Mesh, Planet, PlanetaryStage, RigidBody, TransmissionSpec,
};
pub use transmission::{Load, Transmission};
