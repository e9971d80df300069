//! Masses, springs and dampers of all bodies: rigid coordinates of hubs, then elastic modes with hubs fixed (Craig and Bampton, *AIAA J.* 6, 1968,
//! 1313-1319).
//!
//! `M = [M_r, P; P^T, I]`, `K = [K_r, 0; 0, Omega^2]`, `C = alpha M + beta K + supports + 2 zeta Omega`. Modes are mass-normalised and do not
//! couple with each other, so a step eliminates them by division and leaves a small matrix for the rigid coordinates.

use faer::Mat;

use super::integrator::Weights;
use crate::error::FecmError;
use crate::linalg::DenseCholesky;

/// How a coordinate of a hub is held against the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Does not move from its nominal motion: an ideal bearing, or a prescribed rotation.
    Fixed,
    /// Held by a spring and a damper.
    Elastic {
        /// N/m or N m/rad, 0 or more.
        stiffness: f64,
        /// N s/m or N m s/rad, 0 or more.
        damping: f64,
    },
    /// Not held.
    Free,
}

/// Coordinates of a hub: translations x, y, z (m), rotations about x, y, z (rad), from its nominal motion, in space.
pub const HUB_COORDINATES: [&str; 6] = ["x", "y", "z", "tilt about x", "tilt about y", "rotation"];
/// Index of the rotation about the gear's axis.
pub const ROTATION: usize = 5;

/// Damping of all bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Rayleigh's `alpha` (1/s): on velocities from the nominal motion.
    pub mass_proportional: f64,
    /// Rayleigh's `beta` (s): on springs of supports and on elastic modes.
    pub stiffness_proportional: f64,
    /// Damping ratio of every elastic mode.
    pub modal_ratio: f64,
}

/// One body as the system sees it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BodyTerms {
    /// Mass of each hub coordinate (kg or kg m^2).
    pub mass: [f64; 6],
    pub supports: [Support; 6],
    /// Angular frequencies of the elastic modes (rad/s).
    pub frequencies: Vec<f64>,
    /// `phi^T M r`: modes x hub coordinates.
    pub participation: Vec<[f64; 6]>,
}

/// Matrices of all bodies.
#[derive(Debug, Clone)]
pub(super) struct System {
    /// Body and hub coordinate of every rigid coordinate.
    pub coordinates: Vec<(usize, usize)>,
    mass: Mat<f64>,
    stiffness: Vec<f64>,
    support_damping: Vec<f64>,
    /// `P`: coordinates x modes.
    participation: Mat<f64>,
    frequencies: Vec<f64>,
    damping: Damping,
}

/// The matrix of one step, modes eliminated.
#[derive(Debug, Clone)]
pub(super) struct StepMatrix {
    /// `A_rr - A_rm A_mm^-1 A_mr`.
    pub rigid: Mat<f64>,
    /// `A_mm`.
    pub modal: Vec<f64>,
    /// `A_rm`: coordinates x modes.
    pub coupling: Mat<f64>,
}

/// Positions, velocities or forces: rigid coordinates, then modes.
pub(super) type Generalised = Vec<f64>;

impl System {
    pub fn new(bodies: &[BodyTerms], damping: Damping) -> Result<Self, FecmError> {
        let mut coordinates = Vec::new();
        let (mut masses, mut stiffness, mut support_damping) = (Vec::new(), Vec::new(), Vec::new());
        let (mut first_mode, mut frequencies) = (Vec::new(), Vec::new());
        for (index, body) in bodies.iter().enumerate() {
            first_mode.push(frequencies.len());
            frequencies.extend_from_slice(&body.frequencies);
            for (axis, support) in body.supports.iter().enumerate() {
                let (k, c) = match *support {
                    Support::Fixed => continue,
                    Support::Elastic { stiffness, damping } => (stiffness, damping),
                    Support::Free => (0.0, 0.0),
                };
                coordinates.push((index, axis));
                masses.push(body.mass[axis]);
                stiffness.push(k);
                support_damping.push(c);
            }
        }
        let count = coordinates.len();
        let mass = Mat::from_fn(count, count, |i, j| if i == j { masses[i] } else { 0.0 });
        let mut participation = Mat::zeros(count, frequencies.len());
        for (row, &(body, axis)) in coordinates.iter().enumerate() {
            // tooth patterns turn with the gear; only motions that look the same at every angle keep a constant coupling with them
            if axis == 2 || axis == ROTATION {
                for (mode, p) in bodies[body].participation.iter().enumerate() {
                    participation[(row, first_mode[body] + mode)] = p[axis];
                }
            }
        }
        let system = Self { coordinates, mass, stiffness, support_damping, participation, frequencies, damping };
        system.check_mass()?;
        Ok(system)
    }

    /// An inertia given smaller than what the modes carry of it is no inertia. Motions that modes couple with (turning and moving along the axis)
    /// belong to different symmetry families, so each can be looked at alone.
    fn check_mass(&self) -> Result<(), FecmError> {
        for (row, &(body, axis)) in self.coordinates.iter().enumerate() {
            let given = self.mass[(row, row)];
            let carried: f64 = (0..self.mode_count()).map(|k| self.participation[(row, k)].powi(2)).sum();
            if !(carried < given) {
                let body = if body == 0 { "pinion" } else { "wheel" };
                let (inertia, unit) = if axis < 3 { ("mass", "kg") } else { ("moment of inertia", "kg m^2") };
                return Err(FecmError::LightHub { body, inertia, given, carried, unit });
            }
        }
        Ok(())
    }

    pub fn rigid_count(&self) -> usize {
        self.coordinates.len()
    }

    pub fn mode_count(&self) -> usize {
        self.frequencies.len()
    }

    pub fn size(&self) -> usize {
        self.rigid_count() + self.mode_count()
    }

    pub fn frequencies(&self) -> &[f64] {
        &self.frequencies
    }

    /// Row of a hub coordinate, if it can move.
    pub fn row(&self, body: usize, axis: usize) -> Option<usize> {
        self.coordinates.iter().position(|&c| c == (body, axis))
    }

    pub fn times_mass(&self, x: &[f64]) -> Generalised {
        let (r, n) = (self.rigid_count(), self.mode_count());
        let mut y = vec![0.0; r + n];
        for i in 0..r {
            y[i] = (0..r).map(|j| self.mass[(i, j)] * x[j]).sum::<f64>();
            for k in 0..n {
                y[i] += self.participation[(i, k)] * x[r + k];
                y[r + k] += self.participation[(i, k)] * x[i];
            }
        }
        for k in 0..n {
            y[r + k] += x[r + k];
        }
        y
    }

    pub fn times_stiffness(&self, x: &[f64]) -> Generalised {
        let rigid = self.stiffness.iter().zip(x).map(|(k, x)| k * x);
        let modal = self.frequencies.iter().zip(&x[self.rigid_count()..]).map(|(w, x)| w * w * x);
        rigid.chain(modal).collect()
    }

    pub fn times_damping(&self, x: &[f64]) -> Generalised {
        let Damping { mass_proportional, stiffness_proportional, modal_ratio } = self.damping;
        let mut y = self.times_mass(x);
        let stiff = self.times_stiffness(x);
        for (y, stiff) in y.iter_mut().zip(stiff) {
            *y = mass_proportional * *y + stiffness_proportional * stiff;
        }
        for (i, c) in self.support_damping.iter().enumerate() {
            y[i] += c * x[i];
        }
        let r = self.rigid_count();
        for (k, w) in self.frequencies.iter().enumerate() {
            y[r + k] += 2.0 * modal_ratio * w * x[r + k];
        }
        y
    }

    /// Mass of a rigid coordinate (kg, kg m^2).
    pub fn mass(&self, coordinate: usize) -> f64 {
        self.mass[(coordinate, coordinate)]
    }

    /// Spring of a rigid coordinate (N/m, N m/rad).
    pub fn support_stiffness(&self, coordinate: usize) -> f64 {
        self.stiffness[coordinate]
    }

    /// Force of the supports on each rigid coordinate's ground (N or N m).
    pub fn support_forces(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        (0..self.rigid_count()).map(|i| self.stiffness[i] * q[i] + self.support_damping[i] * v[i]).collect()
    }

    pub fn step_matrix(&self, weights: &Weights) -> StepMatrix {
        let (r, n) = (self.rigid_count(), self.mode_count());
        let (m, c) = (weights.mass(), weights.damping());
        let Damping { mass_proportional, stiffness_proportional, modal_ratio } = self.damping;
        let on_mass = m + mass_proportional * c;
        let on_stiffness = 1.0 + stiffness_proportional * c;
        let modal: Vec<f64> =
            self.frequencies.iter().map(|w| on_mass + on_stiffness * w * w + 2.0 * modal_ratio * w * c).collect();
        let coupling = Mat::from_fn(r, n, |i, k| on_mass * self.participation[(i, k)]);
        let mut rigid = Mat::from_fn(r, r, |i, j| {
            let own = if i == j { on_stiffness * self.stiffness[i] + c * self.support_damping[i] } else { 0.0 };
            on_mass * self.mass[(i, j)] + own
        });
        for k in 0..n {
            for i in 0..r {
                for j in 0..r {
                    rigid[(i, j)] -= coupling[(i, k)] * coupling[(j, k)] / modal[k];
                }
            }
        }
        StepMatrix { rigid, modal, coupling }
    }

    /// Right-hand side of a step: history of the motion, and `force`, already weighed between the ends.
    pub fn history(&self, weights: &Weights, q: &[f64], v: &[f64], a: &[f64], force: &[f64]) -> Generalised {
        let each = |f: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> {
            q.iter().zip(v).zip(a).map(|((&q, &v), &a)| f(q, v, a)).collect()
        };
        let mut right = self.times_mass(&each(&|q, v, a| weights.mass_history(q, v, a)));
        let damped = self.times_damping(&each(&|q, v, a| weights.damping_history(q, v, a)));
        let stiff = self.times_stiffness(q);
        for i in 0..right.len() {
            right[i] += damped[i] - weights.start() * stiff[i] + force[i];
        }
        right
    }

    /// `M a = force`.
    pub fn acceleration(&self, force: &[f64]) -> Result<Generalised, FecmError> {
        let (r, n) = (self.rigid_count(), self.mode_count());
        let mut left = self.mass.clone();
        crate::linalg::add_product(left.as_mut(), -1.0, self.participation.as_ref(), self.participation.transpose());
        let mut right = Mat::from_fn(r, 1, |i, _| {
            force[i] - (0..n).map(|k| self.participation[(i, k)] * force[r + k]).sum::<f64>()
        });
        DenseCholesky::new(left, "mass of the hubs")?.solve_in_place(right.as_mut());
        let mut a: Generalised = (0..r).map(|i| right[(i, 0)]).collect();
        for k in 0..n {
            let carried: f64 = (0..r).map(|i| self.participation[(i, k)] * a[i]).sum();
            a.push(force[r + k] - carried);
        }
        Ok(a)
    }
}
