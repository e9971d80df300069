//! An elastic body as others see it: modal coordinates, and the motion of its ports, ring seat and sensors per unit of each.
//!
//! Coordinates are of unit modal mass, uncoupled within the body: `eta_k'' + 2 zeta_k omega_k eta_k' + omega_k^2 eta_k = phi_k . f`. Static
//! response to forces at ports and seat is part of the basis (attachment vectors, made orthogonal to the modes and diagonalised with them), so that
//! few modes leave the body too stiff for fast motion only, never in rest.

use faer::Mat;

/// A place where the body is held, moving as a rigid frame.
#[derive(Debug, Clone)]
pub struct Port {
    /// Name.
    pub name: String,
    /// Where (m).
    pub position: [f64; 3],
    /// Displacement `x, y, z` (m) and small rotation about `x, y, z` (rad) of the frame, a row each, per unit of each coordinate.
    pub shapes: Mat<f64>,
}

/// The circle about `z` that carries the teeth of a ring, by harmonics of the angle.
#[derive(Debug, Clone)]
pub struct RingSeat {
    /// Radius of the circle (m).
    pub radius: f64,
    /// Its height (m).
    pub z: f64,
    /// Highest harmonic `N`.
    pub harmonics: usize,
    /// Coefficients per unit of each coordinate. Rows: radial displacement `1, cos t, sin t, ..., cos N t, sin N t`, then tangential, then axial.
    pub shapes: Mat<f64>,
}

/// A sensor of acceleration.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name.
    pub name: String,
    /// Where (m).
    pub position: [f64; 3],
    /// Unit vector that it senses.
    pub direction: [f64; 3],
    /// Displacement along the direction (m) per unit of each coordinate.
    pub shape: Vec<f64>,
}

/// An elastic body.
#[derive(Debug, Clone, Default)]
pub struct ElasticBody {
    /// Circular frequencies of the coordinates (rad/s), ascending.
    pub frequencies: Vec<f64>,
    /// Their damping ratios.
    pub damping_ratios: Vec<f64>,
    /// Where others hold it.
    pub ports: Vec<Port>,
    /// Where the ring sits.
    pub ring_seat: Option<RingSeat>,
    /// Sensors.
    pub sensors: Vec<Sensor>,
}
