//! Finite-element/contact-mechanics model of gear tooth contact.
//!
//! | module | holds |
//! |---|---|
//! | [`element`], [`mesh`], [`face`], [`assembly`] | finite elements of an extruded body |
//! | [`condense`], [`ring`] | one sector condensed, the ring of sectors closed |
//! | [`functional`], [`fracture`], [`surface`] | what is read from a displacement field: crack tips, stress on free surfaces |
//! | [`crack_faces`] | where the faces of a crack can press on each other |
//! | [`body`] | a gear as the contact problem sees it |
//! | [`mass`], [`modes`] | inertia of a gear, and its elastic modes with the hub held |
//! | [`profile`], [`pairing`], [`search`] | flanks in space, exact separations, tip contact |
//! | [`profile_basis`], [`halfspace`], [`nearfield`], [`contact`] | functions along a flank, local deformation, contact grid and its compliance |
//! | [`lcp`] | the contact problem and its solvers |
//! | [`statics`] | transmission error, load sharing and mesh stiffness over the mesh cycle |
//! | [`dynamics`] | motion in time, with the contact solved at every step |
//! | [`analytic`] | closed forms for tests and figures |
//!
//! ```
//! use fecm::{FaceModel, PairModel, PairModelOptions, StaticsRequest};
//! use gear_geom::{Gear, GearPair, GearSpec};
//! // a 25-tooth gear of module 6 mm and standard proportions with itself, in plane stress
//! let gear = Gear::new(&GearSpec::standard(25, 6e-3))?;
//! let pair = GearPair::new(gear.clone(), gear, 150.1e-3)?;
//! let options = PairModelOptions { face: FaceModel::PlaneStress, ..PairModelOptions::default() };
//! let model = PairModel::new(&pair, &options)?;
//! let request = StaticsRequest::new([0.0, 0.5], [200.0]);
//! let series = model.solve(&request, &())?;
//! let [single, double] = &series.results[0][..] else { unreachable!() };
//! assert_eq!((single.loaded_pairs().count(), double.loaded_pairs().count()), (1, 2));
//! assert!(single.static_transmission_error > double.static_transmission_error);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)
)]

pub mod analytic;
pub mod assembly;
pub mod body;
pub mod condense;
pub mod contact;
pub mod crack_faces;
pub mod dynamics;
pub mod element;
pub mod error;
pub mod face;
pub mod face_part;
pub mod fracture;
pub mod functional;
pub mod halfspace;
pub mod lcp;
pub mod linalg;
pub mod mass;
pub mod material;
pub mod mesh;
pub mod modes;
pub mod nearfield;
pub mod pairing;
pub mod profile;
pub mod profile_basis;
pub mod ring;
pub mod search;
pub mod statics;
pub mod surface;

pub use body::BoreCondition;
pub use error::FecmError;
pub use face::FaceModel;
pub use lcp::SolverKind;
pub use mass::BodyInertia;
pub use material::Material;
pub use mesh::MeshDensity;
pub use modes::{GearModes, ModesOptions};
pub use statics::{
    ContactOptions, MemberOptions, Observer, PairModel, PairModelOptions, PositionResult, PositionStatus,
    StaticsRequest, StaticsSeries,
};
