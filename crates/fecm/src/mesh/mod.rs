//! Plane meshes: blocks ([`blocks`]), and the tooth sector made of them ([`sector`]).

pub mod blocks;
mod crack_path;
mod crack_zone;
mod outline_path;
pub mod plane;
pub mod sector;
mod sector_blocks;

pub use plane::PlaneMesh;
pub use sector::{FlankEdge, MeshDensity, SectorMesh};
