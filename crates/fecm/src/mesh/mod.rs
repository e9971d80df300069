//! Plane meshes: blocks ([`blocks`]), and the tooth sector made of them ([`sector`]).

pub mod blocks;
pub mod plane;
pub mod sector;

pub use plane::PlaneMesh;
pub use sector::{FlankEdge, MeshDensity, SectorMesh};
