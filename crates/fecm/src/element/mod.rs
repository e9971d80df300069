//! Finite elements: quadrilaterals of any order in the plane of the gear.

pub mod lagrange;
pub mod quad;

pub use quad::{PairIntegrals, ReferenceQuad};
