//! The equations of motion inside one contact phase: linear, with coefficients that depend on the mesh phase.
//!
//! With coordinates `q` (`x`, `y_p`, `y_g`, or `x` alone), diagonal mass, support damping and support stiffness
//! `M`, `D`, `S` and the mesh direction `w = (1, 1, -1)`,
//!
//! ```text
//! M q'' + D q' + S q + w F = load e_x,     F = k(tau) w.q + c(tau) w.q' + p(tau)
//! ```
//!
//! | phase | `k` | `c` | `p` |
//! |---|---|---|---|
//! | drive contact | `k_l` | `c_m` | `f_0 - k_l delta_0` |
//! | apart | 0 | 0 (or `c_m`) | 0 |
//! | coast contact | `k_l` | `c_m` | `k_l b` |
//!
//! Eliminated supports: with compliance `s = 1/k_p + 1/k_g` in series, `x = delta + s F`, so `k`, `p` become
//! `k/(1+ks)`, `p/(1+ks)`, and the damper, which sees `delta' = x'/(1+ks)` and acts through the same lever,
//! `c/(1+ks)^2`.
//!
//! The mass matrix plus a multiple of damping and stiffness is diagonal plus `beta w w^T`; every implicit stage is
//! solved in closed form by the Sherman-Morrison formula, so stiff supports cost no more than soft ones.

use crate::error::LpmError;
use crate::excitation::{Excitation, Segment};
use crate::model::{GearPair, Separation, State};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Supports whose own frequency is this many times the mesh frequency are not resolved by the error control.
const STIFF_RATIO: f64 = 10.0;
/// Displacements beyond this many times the static scale end a run.
const BOUND: f64 = 1e7;

/// Which flanks touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactPhase {
    /// Drive flanks.
    Drive,
    /// None.
    Apart,
    /// Coast flanks, across the backlash.
    Coast,
}

/// Displacements and velocities of `N` coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Vector<const N: usize> {
    pub q: [f64; N],
    pub v: [f64; N],
}

impl<const N: usize> Vector<N> {
    pub const ZERO: Self = Self { q: [0.0; N], v: [0.0; N] };

    /// Component `i` of (q, v).
    pub fn get(&self, i: usize) -> f64 {
        if i < N { self.q[i] } else { self.v[i - N] }
    }

    /// Component `i` of (q, v), to write.
    pub fn set(&mut self, i: usize, value: f64) {
        if i < N {
            self.q[i] = value;
        } else {
            self.v[i - N] = value;
        }
    }

    pub fn is_finite(&self) -> bool {
        self.q.iter().chain(&self.v).all(|v| v.is_finite())
    }
}

/// Mesh force law and load at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Coefs {
    pub k: f64,
    pub c: f64,
    pub p: f64,
    pub load: f64,
}

impl Coefs {
    /// The homogeneous part, which carries differences of solutions.
    pub fn homogeneous(self) -> Self {
        Self { p: 0.0, load: 0.0, ..self }
    }
}

/// Gear pair and excitation in `N` coordinates.
#[derive(Debug, Clone)]
pub(crate) struct System<const N: usize> {
    pub mass: [f64; N],
    pub damping: [f64; N],
    pub stiffness: [f64; N],
    pub w: [f64; N],
    force: f64,
    mesh_damping: f64,
    damping_apart: f64,
    compliance: f64,
    separation: Separation,
    backlash: Option<f64>,
    excitation: Excitation,
    /// Displacement scale (m): static deflection and transmission error.
    pub scale: f64,
    /// Highest circular frequency of the mesh mode (rad/s), supports aside.
    pub omega: f64,
}

impl System<1> {
    pub fn one(pair: &GearPair, excitation: &Excitation, compliance: f64) -> Self {
        Self::build([pair.effective_mass()], [0.0], [0.0], [1.0], pair, excitation, compliance)
    }
}

impl System<3> {
    pub fn three(pair: &GearPair, excitation: &Excitation) -> Self {
        let (p, g) = (&pair.pinion, &pair.gear);
        Self::build(
            [pair.effective_mass(), p.mass, g.mass],
            [0.0, p.support_damping, g.support_damping],
            [0.0, p.support_stiffness, g.support_stiffness],
            [1.0, 1.0, -1.0],
            pair,
            excitation,
            0.0,
        )
    }
}

impl<const N: usize> System<N> {
    fn build(
        mass: [f64; N],
        damping: [f64; N],
        stiffness: [f64; N],
        w: [f64; N],
        pair: &GearPair,
        excitation: &Excitation,
        compliance: f64,
    ) -> Self {
        let force = pair.mean_force();
        let (kr, dr) = (excitation.mesh_stiffness().range(), excitation.transmission_error().range());
        let scale = (force / kr.min).max(dr.max - dr.min).max(dr.max.abs()).max(dr.min.abs());
        let inverse_mass = mass.iter().zip(&stiffness).filter(|(_, s)| **s < kr.max).map(|(m, _)| 1.0 / m).sum::<f64>();
        Self {
            mass,
            damping,
            stiffness,
            w,
            force,
            mesh_damping: pair.mesh_damping,
            damping_apart: if pair.damping_when_apart { pair.mesh_damping } else { 0.0 },
            compliance,
            separation: pair.separation,
            backlash: pair.backlash,
            excitation: excitation.clone(),
            scale: if scale > 0.0 { scale } else { 1e-6 },
            omega: (kr.max / (1.0 + kr.max * compliance) * inverse_mass).sqrt(),
        }
    }

    pub fn excitation(&self) -> &Excitation {
        &self.excitation
    }

    /// Mean mesh force (N).
    pub fn force(&self) -> f64 {
        self.force
    }

    /// Displacement beyond which a run is given up (m).
    pub fn bound(&self) -> f64 {
        BOUND * self.scale + self.backlash.unwrap_or(0.0)
    }

    /// Mesh force law at `tau` in `segment`.
    #[inline]
    pub fn coefs(&self, phase: ContactPhase, segment: &Segment, tau: f64) -> Coefs {
        if phase == ContactPhase::Apart {
            return Coefs { k: 0.0, c: self.damping_apart, p: 0.0, load: self.force };
        }
        let (k, error) = self.excitation.values(segment, tau);
        let lever = 1.0 / (1.0 + k * self.compliance);
        let p = match (phase, self.backlash) {
            (ContactPhase::Coast, Some(b)) => k * b,
            _ => self.force - k * error,
        };
        Coefs { k: k * lever, c: self.mesh_damping * lever * lever, p: p * lever, load: self.force }
    }

    /// `w . a`.
    #[inline]
    pub fn along_mesh(&self, a: &[f64; N]) -> f64 {
        let mut s = 0.0;
        for i in 0..N {
            s += self.w[i] * a[i];
        }
        s
    }

    /// Mesh force (N) of the law `co` in state `z`.
    #[inline]
    pub fn mesh_force(&self, co: &Coefs, z: &Vector<N>) -> f64 {
        co.k * self.along_mesh(&z.q) + co.c * self.along_mesh(&z.v) + co.p
    }

    /// Mesh deflection `delta` (m) under the mesh force `force` (N): `x` less the give of eliminated supports.
    pub fn deflection(&self, z: &Vector<N>, force: f64) -> f64 {
        self.along_mesh(&z.q) - self.compliance * force
    }

    /// Accelerations.
    #[inline]
    pub fn acceleration(&self, co: &Coefs, z: &Vector<N>) -> [f64; N] {
        let force = self.mesh_force(co, z);
        let mut a = [0.0; N];
        for i in 0..N {
            let load = if i == 0 { co.load } else { 0.0 };
            a[i] = (load - self.damping[i] * z.v[i] - self.stiffness[i] * z.q[i] - self.w[i] * force) / self.mass[i];
        }
        a
    }

    /// Accelerations `a` that satisfy the equations at `q + g^2 a`, `v + g a`.
    #[inline]
    pub fn implicit_acceleration(&self, co: &Coefs, z: &Vector<N>, g: f64) -> [f64; N] {
        let force = self.mesh_force(co, z);
        let beta = g * (co.c + g * co.k);
        let (mut a, mut inverse_w) = ([0.0; N], [0.0; N]);
        let (mut wr, mut ww) = (0.0, 0.0);
        for i in 0..N {
            let load = if i == 0 { co.load } else { 0.0 };
            let r = load - self.damping[i] * z.v[i] - self.stiffness[i] * z.q[i] - self.w[i] * force;
            let d = self.mass[i] + g * (self.damping[i] + g * self.stiffness[i]);
            a[i] = r / d;
            inverse_w[i] = self.w[i] / d;
            wr += self.w[i] * a[i];
            ww += self.w[i] * inverse_w[i];
        }
        let f = beta * wr / (1.0 + beta * ww);
        for i in 0..N {
            a[i] -= f * inverse_w[i];
        }
        a
    }

    /// The support of coordinate `i` swings so fast that the error control leaves it out.
    #[inline]
    pub fn is_stiff(&self, i: usize) -> bool {
        i > 0 && self.stiffness[i] >= (STIFF_RATIO * self.omega).powi(2) * self.mass[i]
    }

    /// Weighted size of an error (1 = the displacement scale): largest over the coordinates, those on stiff supports only
    /// where `all` is set (an explicit method would be unstable without them).
    #[inline]
    pub fn norm(&self, e: &Vector<N>, all: bool) -> f64 {
        let mut m = (e.q[0].abs() / self.scale).max(e.v[0].abs() / (self.scale * self.omega));
        for i in 1..N {
            if all {
                // In units of the support's own give, small on stiff supports: its force must be right.
                m = m.max(e.q[i].abs() / self.unit(i)).max(e.v[i].abs() / self.unit(N + i));
            } else if !self.is_stiff(i) {
                let own = (self.stiffness[i] / self.mass[i]).sqrt();
                m = m.max(e.q[i].abs() / self.scale).max(e.v[i].abs() / (self.scale * self.omega.max(own)));
            }
        }
        if e.is_finite() { m } else { f64::INFINITY }
    }

    /// Natural scale of component `i` of (q, v).
    pub fn unit(&self, i: usize) -> f64 {
        let c = i % N;
        let own = if c == 0 { self.omega } else { (self.stiffness[c] / self.mass[c]).sqrt() };
        let length = if c == 0 {
            self.scale
        } else {
            self.scale * (self.mass[0] * self.omega * self.omega / self.stiffness[c]).min(1.0)
        };
        if i < N { length } else { length * own.max(self.omega) }
    }

    /// Distance of the mesh deflection from the drive flanks (m; positive in contact) and its rate (m/s).
    pub fn drive_gap(&self, segment: &Segment, tau: f64, mesh_frequency: f64, z: &Vector<N>) -> (f64, f64) {
        let (delta, rate) = (self.along_mesh(&z.q), self.along_mesh(&z.v));
        match self.separation {
            Separation::DeflectionVanishes => (delta, rate),
            Separation::ForceVanishes => {
                let e = self.excitation.point(segment, tau);
                let limit = e.error - self.force / e.stiffness;
                let slope = e.error_slope + self.force * e.stiffness_slope / (e.stiffness * e.stiffness);
                (delta - limit, rate - mesh_frequency * slope)
            }
        }
    }

    /// Distance from the coast flanks (m; positive when clear of them) and its rate; `None` without a coast side.
    pub fn coast_gap(&self, z: &Vector<N>) -> Option<(f64, f64)> {
        self.backlash.map(|b| (self.along_mesh(&z.q) + b, self.along_mesh(&z.v)))
    }

    /// Phase of a state. On a boundary the direction of motion decides, then drive contact.
    pub fn phase(&self, segment: &Segment, tau: f64, mesh_frequency: f64, z: &Vector<N>) -> ContactPhase {
        let inside = |(g, rate): (f64, f64)| {
            let rounding = 1e-15 * self.scale;
            if g.abs() > rounding { g > 0.0 } else { rate >= 0.0 }
        };
        if inside(self.drive_gap(segment, tau, mesh_frequency, z)) {
            return ContactPhase::Drive;
        }
        match self.coast_gap(z) {
            Some(gap) if !inside(gap) => ContactPhase::Coast,
            _ => ContactPhase::Apart,
        }
    }

    pub fn equilibrium(&self, tau: f64) -> Vector<N> {
        let mut z = Vector::ZERO;
        z.q[0] = self.excitation.transmission_error().value(tau) + self.force * self.compliance;
        for i in 1..N {
            z.q[i] = -self.w[i] * self.force / self.stiffness[i];
            z.q[0] -= self.w[i] * z.q[i];
        }
        z
    }

    pub fn natural_frequencies(&self, tau: f64) -> Vec<f64> {
        let k = self.excitation.mesh_stiffness().value(tau);
        let k = k / (1.0 + k * self.compliance);
        let matrix = DMatrix::from_fn(N, N, |i, j| {
            let own = if i == j { self.stiffness[i] } else { 0.0 };
            (own + k * self.w[i] * self.w[j]) / (self.mass[i] * self.mass[j]).sqrt()
        });
        let mut f: Vec<f64> = matrix.symmetric_eigenvalues().iter().map(|l| l.max(0.0).sqrt() / TAU).collect();
        f.sort_by(f64::total_cmp);
        f
    }

    pub fn damping_ratio(&self, tau: f64) -> f64 {
        let k = self.excitation.mesh_stiffness().value(tau);
        let series: f64 = self.compliance + self.stiffness.iter().skip(1).map(|s| 1.0 / s).sum::<f64>();
        let lever = 1.0 / (1.0 + k * series);
        self.mesh_damping * lever * lever / (2.0 * (k * lever * self.mass[0]).sqrt())
    }

    /// Fails where drive and coast flanks would overlap.
    pub fn check_backlash(&self) -> Result<(), LpmError> {
        let Some(backlash) = self.backlash else {
            return Ok(());
        };
        for s in self.excitation.segments() {
            for i in 0..=32 {
                let phase = s.start + (s.end - s.start) * f64::from(i) / 32.0;
                let drive = -self.drive_gap(s, phase, 0.0, &Vector::ZERO).0;
                if drive <= -backlash {
                    return Err(LpmError::Jammed { backlash, drive, phase });
                }
            }
        }
        Ok(())
    }

    /// To the public form.
    pub fn export(&self, z: &Vector<N>) -> State {
        let mut s = State::default();
        s.position[..N].copy_from_slice(&z.q);
        s.velocity[..N].copy_from_slice(&z.v);
        s
    }

    /// From the public form.
    pub fn import(&self, s: &State) -> Result<Vector<N>, LpmError> {
        let mut z = Vector::ZERO;
        z.q.copy_from_slice(&s.position[..N]);
        z.v.copy_from_slice(&s.velocity[..N]);
        if z.is_finite() {
            Ok(z)
        } else {
            let value = s.position.iter().chain(&s.velocity).copied().find(|v| !v.is_finite()).unwrap_or(f64::NAN);
            Err(LpmError::OutOfRange { quantity: "initial state", value, unit: "m, m/s", allowed: "finite" })
        }
    }
}
