//! Finite elements of a housing, and its reduction to an [`ElasticBody`](crate::elastic::ElasticBody).
//!
//! | module | holds |
//! |---|---|
//! | [`element`] | solid elements as tables |
//! | [`mesh`], [`surface`] | nodes, elements, sets; outer faces |
//! | [`block`] | structured blocks of any kind of element |
//! | [`casing`] | a parametric housing, meshed |
//! | [`assembly`] | stiffness, factored, and mass |
//! | [`inp`] | meshes as text of Abaqus and CalculiX |
//! | [`held`] | whether mounts hold every part |
//! | [`reading`] | frames, ring harmonics and sensors from the motion of nodes |
//! | [`reduce`] | lowest modes and static responses |
//! | [`model`] | a housing with mounts, ports, seat and sensors |

pub mod assembly;
pub mod block;
pub mod casing;
pub mod element;
pub mod error;
pub mod held;
pub mod inp;
pub mod mesh;
pub mod model;
pub mod reading;
pub mod reduce;
pub mod surface;

pub use casing::Casing;
pub use error::HousingError;
pub use mesh::SolidMesh;
pub use model::{
    Damping, Housing, Mount, PortPlace, ReducedHousing, ReductionOptions, ReductionStats, SeatPlace, SensorAt,
    SensorPlace, Tie,
};
