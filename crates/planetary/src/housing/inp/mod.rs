//! Meshes as text of Abaqus and CalculiX (`.inp`): read from the user's own mesher, and written so that other programs can look at ours.
//!
//! Understood: `*NODE`, `*ELEMENT` of the kinds in [`Kind::ALL`](super::element::Kind::ALL) (and `C3D8`, taken as `C3D8I`), `*NSET`, `*ELSET` (lists
//! of numbers and names, or `GENERATE`), `*MATERIAL` with `*ELASTIC` (isotropic) and `*DENSITY`, `*SOLID SECTION`; comments, continued lines. Passed
//! over, for they change nothing here: `*HEADING`, `*PREPRINT`, `*SURFACE`, and everything from `*STEP` on (mounts and loads are given to
//! [`Housing`](super::Housing)). Anything else is an error that names it: no line is dropped that could matter. Names are in lower case whatever the
//! file has. Nodes of no element are left out, of sets too.

mod lines;
mod read;
mod write;

pub use read::read;
pub use write::write;

/// Units of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Unit of length (m).
    pub length: f64,
    /// Unit of stress (Pa).
    pub stress: f64,
    /// Unit of density (kg/m^3).
    pub density: f64,
}

impl Units {
    /// m, N, Pa, kg.
    pub const SI: Self = Self { length: 1.0, stress: 1.0, density: 1.0 };
    /// mm, N, MPa, t.
    pub const MILLIMETRE: Self = Self { length: 1e-3, stress: 1e6, density: 1e12 };
}
