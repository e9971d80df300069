//! Force over approach of a tooth mesh.
//!
//! With hubs that are rigid and shafts that stay parallel, all that a mesh knows of the motion of its gears is one number, the *approach* along
//! its line of action: how far the flanks would pass through each other if they were rigid, perfect involutes (m). What it answers is one
//! number too, the normal force of all its tooth pairs together (N). The contact problem, solved once for each position and load, gives the
//! curve between them; in time it is only read.
//!
//! What the one number leaves out: a hub that moves *across* the line of action by 20 um, as bearings give way, changes the deflection of the dissertation's
//! sun-planet pair by 2.5e-3 at the median of the cycle and by 1.7 % where pairs join (`tests/mesh_table.rs`). Shafts that *tilt* by `theta` in the plane of action press one end of the
//! face more: the mean approach gives the force as long as the whole face stays in contact, but the moment `k b^2 theta / 12` (some 1e5 N m/rad for that pair) that resists the
//! tilt is not there. Friction is left out.
//!
//! | type | a mesh from |
//! |---|---|
//! | [`MeshTable`] | contact mechanics, sound or with damaged teeth ([`MeshTable::from_contact`], [`MeshTable::with_damage`]) |
//! | [`SlicedMesh`] | inclined teeth as slices of straight ones: spiral bevel gears ([`SlicedMesh::bevel`], [`virtual_table`]) |
//! | [`MeshWithErrors`] | a table, with errors of single teeth |
//! | [`LinearMesh`] | a stiffness and an error over the mesh cycle |

mod contact;
mod curve;
mod error;
mod law;
mod linear;
mod sliced;
mod table;
mod tooth_errors;

pub use contact::{DamagedTooth, TableOptions, force_curves};
pub use curve::{ForceCurve, ForceCurveData, ForceKnot};
pub use error::MeshError;
pub use law::{MeshLaw, MeshResponse};
pub use linear::{LinearMesh, Periodic};
pub use sliced::{BevelSlices, Slice, SlicedMesh, virtual_table};
pub use table::{DamageWindow, MeshTable, MeshTableData};
pub use tooth_errors::{MeshWithErrors, OffsetMesh, ToothErrors, ToothPairCurves, pin_offset};
