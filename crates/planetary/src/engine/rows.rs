//! Displacements that connections know, as rows over the coordinates.
//!
//! Every connection, a spring of a bearing or the flanks of a mesh, knows one scalar `d = J q`: how far two bodies move against each other along one
//! direction. A row has up to two parts on rigid bodies and one on the housing. Parts that turn with the carrier are constant in its axes:
//! `(n, (P - X) x n)` turned about `z` by its angle.

use super::dense::{cross, minus};

/// Rigid coordinates of a body.
pub(super) const RIGID: usize = 6;

/// Part of a row on a rigid body, with the carrier at angle 0.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub body: usize,
    pub row: [f64; RIGID],
    pub turning: bool,
}

impl Part {
    /// `sign` times the displacement along `direction` of a point `arm` from the body's centre.
    pub fn along(body: usize, sign: f64, direction: [f64; 3], arm: [f64; 3], turning: bool) -> Self {
        let [x, y, z] = direction.map(|d| sign * d);
        let [rx, ry, rz] = cross(arm, [x, y, z]);
        Self { body, row: [x, y, z, rx, ry, rz], turning }
    }

    /// `sign` times the rotation about `direction`.
    pub fn about(body: usize, sign: f64, direction: [f64; 3], turning: bool) -> Self {
        let [rx, ry, rz] = direction.map(|d| sign * d);
        Self { body, row: [0.0, 0.0, 0.0, rx, ry, rz], turning }
    }

    /// With the carrier at the angle of this cosine and sine.
    pub fn at(&self, (cos, sin): (f64, f64)) -> [f64; RIGID] {
        if !self.turning {
            return self.row;
        }
        let [x, y, z, rx, ry, rz] = self.row;
        [cos * x - sin * y, sin * x + cos * y, z, cos * rx - sin * ry, sin * rx + cos * ry, rz]
    }
}

/// Displacement of the point of a line of action that the ring seat carries.
///
/// The point at the angle `t` and radius `rho` moves with the seat there, turned by its rotation `w = (u_t - u_r') / R` about the seat circle:
/// `n_r u_r + n_t (u_t + (rho - R) w)`. Exact for any rigid motion of the ring.
#[derive(Debug, Clone)]
pub(super) struct SeatPart {
    /// Angle with the carrier at angle 0 (rad).
    pub angle: f64,
    /// Components of the direction, with the sign of the row.
    pub radial: f64,
    pub tangential: f64,
    /// `rho / R`.
    pub radius_ratio: f64,
}

impl SeatPart {
    /// Coefficients of the seat's radial and tangential harmonics at a carrier angle.
    pub fn coefficients(&self, carrier: f64, harmonics: usize, values: &mut [f64]) {
        let t = self.angle + carrier;
        let on_tangential = self.tangential * self.radius_ratio;
        let on_slope = -self.tangential * (self.radius_ratio - 1.0);
        let half = 2 * harmonics + 1;
        (values[0], values[half]) = (self.radial, on_tangential);
        for n in 1..=harmonics {
            let order = n as f64;
            let (sin, cos) = (order * t).sin_cos();
            let (c, s) = (2 * n - 1, 2 * n);
            // u_r = a cos + b sin, u_r' = n (b cos - a sin)
            values[c] = self.radial * cos - on_slope * order * sin;
            values[s] = self.radial * sin + on_slope * order * cos;
            values[half + c] = on_tangential * cos;
            values[half + s] = on_tangential * sin;
        }
    }
}

/// Part of a row on the housing.
#[derive(Debug, Clone)]
pub(super) enum HousingPart {
    None,
    /// Minus one of its interfaces.
    Interface(usize),
    Seat(SeatPart),
}

/// A row.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub parts: Vec<Part>,
    pub housing: HousingPart,
}

/// Line of action of a mesh of spur gears at the angle of a planet.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpurLine {
    /// Direction of the force on the planet: radial, tangential.
    pub radial: f64,
    pub tangential: f64,
}

impl SpurLine {
    /// Sun pushes planet: `side` 1 on the drive flanks, -1 on the coast flanks.
    pub fn sun(pressure_angle: f64, side: f64) -> Self {
        let (sin, cos) = pressure_angle.sin_cos();
        Self { radial: sin, tangential: side * cos }
    }

    /// Ring pushes planet.
    pub fn ring(pressure_angle: f64, side: f64) -> Self {
        let (sin, cos) = pressure_angle.sin_cos();
        Self { radial: -sin, tangential: side * cos }
    }

    /// Row part on a gear on whose axis `torque_arm` is the moment of a unit force along the line, at a height above its centre.
    pub fn part(&self, body: usize, sign: f64, angle: f64, torque_arm: f64, height: f64) -> Part {
        let (sin, cos) = angle.sin_cos();
        let n = [self.radial * cos - self.tangential * sin, self.radial * sin + self.tangential * cos, 0.0];
        let [rx, ry, _] = cross([0.0, 0.0, height], n);
        Part { body, row: [n[0], n[1], 0.0, rx, ry, torque_arm].map(|x| sign * x), turning: true }
    }
}

/// Arm from a body's centre.
pub(super) fn arm(point: [f64; 3], centre: [f64; 3]) -> [f64; 3] {
    minus(point, centre)
}
