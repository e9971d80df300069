//! What a transmission needs to know of a mesh.

/// Answer of a mesh to an approach.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshResponse {
    /// Normal force of all tooth pairs together (N), never negative.
    pub force: f64,
    /// Its derivative by the approach (N/m), never negative.
    pub stiffness: f64,
}

/// Force of a mesh over the approach of its gears.
pub trait MeshLaw: std::fmt::Debug + Send + Sync {
    /// Force at a mesh cycle (base pitches of rotation; pair `k` touches at the pitch point at cycle `k`) and an approach along the line of
    /// action (m; that of perfect rigid involutes). Does not fall with the approach; zero where nothing touches.
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse;
}
