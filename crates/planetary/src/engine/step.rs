//! One step: inertia over the step, connections, meshes.
//!
//! The weights of the integrator turn the equation of motion of every body into `A q = b - J^T l` at the end of the step, with a constant matrix `A`
//! (6 x 6 for a rigid body, a number for a coordinate of the housing) and `l` the forces of the connections, whose displacements are `d = J q`. Rotation is in
//! `J` alone. A spring and damper is a compliance: `d = C l + g`, `C = 1 / (k + w c)`, `w` the weight of the rate, `g` what the motion so far gives
//! the damper; an infinite stiffness is `C = 0`. With `l = l_0 + D`, `l_0` the forces of the step before (so that nothing large cancels),
//!
//! `(J A^-1 J^T + C) D = J A^-1 (b - J^T l_0) - C l_0 - g`
//!
//! for the springs, and the same with the law in place of `C` for the meshes (`contact`). Factored per step: as many rows as there are springs.
//! The housing comes in through its interfaces `H`: `H A^-1 H^T` is constant.
//!
//! Rest is found by the same step, with `A = rho M` plus the housing's stiffness and `b = rho M q` (proximal points: R. T. Rockafellar, *SIAM J. Control
//! Optim.* 14, 1976, 877-898): the energy of springs and meshes is convex, so the motion ends in a minimum where there is one, from any start, and a
//! part that nothing holds and nothing pushes stays where it is.

use fecm::dynamics::Weights;

use super::contact::{ContactReport, Problem, Touch, solve};
use super::dense::{Square, dot};
use super::rows::{HousingPart, RIGID};
use super::system::System;
use crate::error::PlanetaryError;

/// Smallest pivot against its diagonal: below, infinitely stiff connections share a motion.
const PIVOT: f64 = 1e-12;

/// Where the transmission stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Angle of the carrier (rad).
    pub angle: f64,
    /// Mesh cycles travelled.
    pub travelled: f64,
}

/// Inverse step matrices.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    bodies: Vec<[[f64; RIGID]; RIGID]>,
    modes: Vec<f64>,
    /// `H A^-1 H^T`.
    gram: Square,
    /// Weight of the rate (1/s); 0 at rest.
    rate: f64,
}

impl Operator {
    /// Of a step in time at a speed of the carrier (rad/s).
    pub fn moving(system: &System, weights: &Weights, speed: f64) -> Self {
        let (mass, rate) = (weights.mass(), weights.damping());
        let modal = system.frequencies.iter().zip(&system.damping_ratios);
        let modes = modal.map(|(w, zeta)| 1.0 / (mass + rate * 2.0 * zeta * w + w * w)).collect();
        Self::new(system, mass, rate * speed, modes, rate)
    }

    /// Of a proximal step towards rest.
    pub fn resting(system: &System, rho: f64) -> Self {
        Self::new(system, rho, 0.0, system.frequencies.iter().map(|w| 1.0 / (rho + w * w)).collect(), 0.0)
    }

    fn new(system: &System, mass: f64, gyroscopic: f64, modes: Vec<f64>, rate: f64) -> Self {
        let bodies = system.inertia.iter().map(|body| {
            let mut rotation = nalgebra::Matrix3::zeros();
            for i in 0..3 {
                for j in 0..3 {
                    rotation[(i, j)] = mass * body.tensor[i][j] + gyroscopic * body.gyroscopic[i][j];
                }
            }
            // positive inertia plus a skew matrix is never singular
            let inverse = rotation.try_inverse().unwrap_or_default();
            let mut whole = [[0.0; RIGID]; RIGID];
            for i in 0..3 {
                whole[i][i] = 1.0 / (mass * body.mass);
                for j in 0..3 {
                    whole[3 + i][3 + j] = inverse[(i, j)];
                }
            }
            whole
        });
        let bodies = bodies.collect();
        let faces = &system.interfaces;
        let mut gram = Square::zeros(faces.count);
        let mut scaled = vec![0.0; faces.modes];
        for j in 0..faces.count {
            for ((scaled, value), weight) in scaled.iter_mut().zip(faces.row(j)).zip(&modes) {
                *scaled = value * weight;
            }
            for i in 0..=j {
                let value = dot(faces.row(i), &scaled);
                *gram.at_mut(i, j) = value;
                *gram.at_mut(j, i) = value;
            }
        }
        Self { bodies, modes, gram, rate }
    }

    /// Springs that hold nothing: dampers alone, at rest.
    fn idle(&self, system: &System) -> Vec<bool> {
        system.springs.iter().map(|spring| spring.stiffness + self.rate * spring.damping == 0.0).collect()
    }

    fn body(&self, index: usize, x: &[f64]) -> [f64; RIGID] {
        let m = &self.bodies[index];
        let mut y = [0.0; RIGID];
        for i in 0..3 {
            y[i] = m[i][i] * x[i];
            y[3 + i] = m[3 + i][3] * x[3] + m[3 + i][4] * x[4] + m[3 + i][5] * x[5];
        }
        y
    }
}

/// Rows at a place.
pub(super) struct Placed {
    /// Parts on rigid bodies: row, body, values, derivatives by the carrier's angle.
    parts: Vec<PlacedPart>,
    /// Parts per body, as indices of `parts`.
    of_body: Vec<Vec<usize>>,
    /// Rows on one interface of the housing each, with sign -1.
    ports: Vec<(usize, usize)>,
    /// Rows on the seat: coefficients and derivatives.
    seats: Vec<PlacedSeat>,
}

struct PlacedPart {
    row: usize,
    body: usize,
    values: [f64; RIGID],
    derivatives: [f64; RIGID],
}

struct PlacedSeat {
    row: usize,
    values: Vec<f64>,
    derivatives: Vec<f64>,
}

impl Placed {
    pub fn new(system: &System, place: Place) -> Self {
        let (sin, cos) = place.angle.sin_cos();
        let mut placed = Self {
            parts: Vec::new(),
            of_body: vec![Vec::new(); system.ids.len()],
            ports: Vec::new(),
            seats: Vec::new(),
        };
        let seat_rows = 2 * (2 * system.interfaces.harmonics + 1);
        for (index, row) in system.rows.iter().enumerate() {
            for part in &row.parts {
                placed.of_body[part.body].push(placed.parts.len());
                placed.parts.push(PlacedPart {
                    row: index,
                    body: part.body,
                    values: part.at((cos, sin)),
                    derivatives: part.derivative((cos, sin)),
                });
            }
            match &row.housing {
                HousingPart::None => {}
                HousingPart::Interface(interface) => placed.ports.push((index, *interface)),
                HousingPart::Seat(seat) => {
                    let (mut values, mut derivatives) = (vec![0.0; seat_rows], vec![0.0; seat_rows]);
                    seat.coefficients(place.angle, system.interfaces.harmonics, &mut values, &mut derivatives);
                    placed.seats.push(PlacedSeat { row: index, values, derivatives });
                }
            }
        }
        placed
    }

    /// `out += J q`, from rigid coordinates and motions of interfaces.
    pub fn displacements(&self, rigid: &[f64], faces: &[f64], seat: usize, out: &mut [f64]) {
        for part in &self.parts {
            out[part.row] += dot6(&part.values, &rigid[RIGID * part.body..]);
        }
        for &(row, interface) in &self.ports {
            out[row] -= faces[interface];
        }
        for part in &self.seats {
            out[part.row] += dot(&part.values, &faces[seat..]);
        }
    }

    /// Largest displacement of a body that goes into an approach, rows from this one on.
    fn magnitude(&self, rigid: &[f64], first: usize) -> f64 {
        let parts = self.parts.iter().filter(|part| part.row >= first);
        parts.fold(0.0, |most, part| most.max(dot6(&part.values, &rigid[RIGID * part.body..]).abs()))
    }

    /// One row over all coordinates.
    pub fn row(&self, system: &System, index: usize) -> Vec<f64> {
        let rigid = system.rigid();
        let mut row = vec![0.0; system.size()];
        for part in self.parts.iter().filter(|part| part.row == index) {
            row[RIGID * part.body..][..RIGID].iter_mut().zip(part.values).for_each(|(out, value)| *out += value);
        }
        let mut add = |interface: usize, factor: f64| {
            let modal = row[rigid..].iter_mut().zip(system.interfaces.row(interface));
            modal.for_each(|(out, value)| *out += factor * value);
        };
        self.ports.iter().filter(|(row, _)| *row == index).for_each(|(_, interface)| add(*interface, -1.0));
        for part in self.seats.iter().filter(|part| part.row == index) {
            part.values.iter().enumerate().for_each(|(k, value)| add(system.interfaces.seat + k, *value));
        }
        row
    }

    /// `out += J' q`, by the carrier's angle.
    fn turning(&self, rigid: &[f64], faces: &[f64], seat: usize, out: &mut [f64]) {
        for part in &self.parts {
            out[part.row] += dot6(&part.derivatives, &rigid[RIGID * part.body..]);
        }
        for part in &self.seats {
            out[part.row] += dot(&part.derivatives, &faces[seat..]);
        }
    }

    /// `rigid -= J^T l`, `faces -= J^T l`.
    fn react(&self, forces: &[f64], rigid: &mut [f64], faces: &mut [f64], seat: usize) {
        for part in &self.parts {
            let force = forces[part.row];
            for (out, value) in rigid[RIGID * part.body..].iter_mut().zip(&part.values) {
                *out -= force * value;
            }
        }
        for &(row, interface) in &self.ports {
            faces[interface] += forces[row];
        }
        for part in &self.seats {
            let force = forces[part.row];
            for (out, value) in faces[seat..].iter_mut().zip(&part.values) {
                *out -= force * value;
            }
        }
    }

    /// `J A^-1 J^T`.
    fn compliance(&self, operator: &Operator, rows: usize, seat: usize) -> Square {
        let mut w = Square::zeros(rows);
        for (body, parts) in self.of_body.iter().enumerate() {
            for &j in parts {
                let column = operator.body(body, &self.parts[j].values);
                let target = w.column_mut(self.parts[j].row);
                for &i in parts {
                    target[self.parts[i].row] += dot6(&self.parts[i].values, &column);
                }
            }
        }
        let gram = &operator.gram;
        for &(column, interface) in &self.ports {
            let source = gram.column(interface);
            let target = w.column_mut(column);
            for &(row, other) in &self.ports {
                target[row] += source[other];
            }
        }
        let mut motion = vec![0.0; gram.size];
        for part in &self.seats {
            motion.fill(0.0);
            for (k, value) in part.values.iter().enumerate() {
                for (out, entry) in motion.iter_mut().zip(gram.column(seat + k)) {
                    *out += value * entry;
                }
            }
            for &(row, interface) in &self.ports {
                *w.at_mut(row, part.row) -= motion[interface];
                *w.at_mut(part.row, row) -= motion[interface];
            }
            for other in &self.seats {
                *w.at_mut(other.row, part.row) += dot(&other.values, &motion[seat..]);
            }
        }
        w
    }
}

fn dot6(a: &[f64; RIGID], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
}

/// What the motion so far gives a step.
pub(super) struct History<'a> {
    /// Right-hand side, without forces of connections.
    pub load: &'a [f64],
    /// `v = rate q - velocity`.
    pub velocity: &'a [f64],
    /// Motion expected at the end of the step, for the turning of the axes.
    pub expected: &'a [f64],
    /// Speed of the carrier (rad/s).
    pub speed: f64,
    /// Forces of connections before.
    pub forces: &'a [f64],
}

/// End of a step.
pub(super) struct Stepped {
    pub position: Vec<f64>,
    pub forces: Vec<f64>,
    /// Forces of connections on the coordinates.
    pub generalised: Vec<f64>,
    /// Approaches of the flanks, backlash taken off.
    pub approaches: Vec<f64>,
    pub report: ContactReport,
}

/// Solves a step.
pub(super) fn step(
    system: &System,
    operator: &Operator,
    place: Place,
    history: &History<'_>,
) -> Result<Stepped, PlanetaryError> {
    let (rigid, faces) = (system.rigid(), &system.interfaces);
    let (count, springs, seat) = (system.rows.len(), system.springs.len(), faces.seat);
    let placed = Placed::new(system, place);

    // motion under the load and the forces of before
    let mut load = history.load[..rigid].to_vec();
    let mut reaction = vec![0.0; faces.count];
    placed.react(history.forces, &mut load, &mut reaction, seat);
    let solve_bodies = |load: &[f64]| -> Vec<f64> {
        load.chunks_exact(RIGID).enumerate().flat_map(|(body, load)| operator.body(body, load)).collect()
    };
    let modal: Vec<f64> = history.load[rigid..].iter().zip(&operator.modes).map(|(b, d)| b * d).collect();
    let mut motion = vec![0.0; faces.count];
    faces.motion(&modal, &mut motion);
    for (k, force) in reaction.iter().enumerate().filter(|(_, force)| **force != 0.0) {
        for (out, entry) in motion.iter_mut().zip(operator.gram.column(k)) {
            *out += force * entry;
        }
    }
    let mut free = vec![0.0; count];
    let rigid_motion = solve_bodies(&load);
    placed.displacements(&rigid_motion, &motion, seat, &mut free);
    let mut scale = placed.magnitude(&rigid_motion, springs);

    // rates: d' = rate d - lag
    let mut lag = vec![0.0; count];
    if operator.rate > 0.0 {
        faces.motion(&history.velocity[rigid..], &mut motion);
        placed.displacements(&history.velocity[..rigid], &motion, seat, &mut lag);
        if history.speed != 0.0 {
            faces.motion(&history.expected[rigid..], &mut motion);
            let mut turning = vec![0.0; count];
            placed.turning(&history.expected[..rigid], &motion, seat, &mut turning);
            lag.iter_mut().zip(&turning).for_each(|(lag, turning)| *lag -= history.speed * turning);
        }
    }

    // springs eliminated
    let w = placed.compliance(operator, count, seat);
    let mut matrix = Square::zeros(springs);
    let mut answer = free[..springs].to_vec();
    for k in 0..springs {
        matrix.column_mut(k).copy_from_slice(&w.column(k)[..springs]);
    }
    let idle = operator.idle(system);
    for (k, spring) in system.springs.iter().enumerate() {
        let whole = spring.stiffness + operator.rate * spring.damping;
        if idle[k] {
            (0..springs).for_each(|j| (*matrix.at_mut(k, j), *matrix.at_mut(j, k)) = (0.0, 0.0));
            *matrix.at_mut(k, k) = 1.0;
            answer[k] = -history.forces[k];
        } else {
            let damper = if whole.is_finite() { spring.damping / whole * lag[k] } else { 0.0 };
            *matrix.at_mut(k, k) += 1.0 / whole;
            answer[k] -= history.forces[k] / whole + damper;
        }
    }
    if !matrix.factor(PIVOT) {
        return Err(PlanetaryError::OverConstrained { cycle: place.travelled });
    }
    matrix.solve(&mut answer);

    // meshes
    let meshes = count - springs;
    let mut compliance = Square::zeros(meshes);
    let mut on_springs = Vec::with_capacity(meshes);
    for j in 0..meshes {
        let column = w.column(springs + j);
        let mut through = column[..springs].to_vec();
        through.iter_mut().zip(&idle).filter(|(_, idle)| **idle).for_each(|(value, _)| *value = 0.0);
        matrix.solve(&mut through);
        on_springs.push(through);
        compliance.column_mut(j).copy_from_slice(&column[springs..]);
    }
    let mut approach = free[springs..].to_vec();
    for i in 0..meshes {
        // row of W from a mesh to the springs
        let row: Vec<f64> = (0..springs).map(|k| w.at(springs + i, k)).collect();
        scale = scale.max(row.iter().zip(&answer).map(|(w, l)| (w * l).abs()).sum::<f64>());
        approach[i] -= dot(&row, &answer);
        for j in 0..meshes {
            *compliance.at_mut(i, j) -= dot(&row, &on_springs[j]);
        }
    }
    let touches: Vec<Touch<'_>> = system
        .flanks
        .iter()
        .enumerate()
        .map(|(i, flank)| Touch {
            flank,
            cycle: flank.cycle_offset + flank.cycle_rate * place.travelled,
            rate: operator.rate,
            history: lag[springs + i],
        })
        .collect();
    let before = &history.forces[springs..];
    let mut forces = vec![0.0; count];
    let problem = Problem { touches: &touches, compliance: &compliance, free: &approach, before, scale };
    let report = solve(&problem, &mut forces[springs..]);
    for j in 0..meshes {
        let change = forces[springs + j] - before[j];
        for (out, through) in answer.iter_mut().zip(&on_springs[j]) {
            *out -= change * through;
        }
    }
    for k in 0..springs {
        forces[k] = history.forces[k] + answer[k];
    }

    // bodies follow
    let mut generalised = vec![0.0; system.size()];
    reaction.fill(0.0);
    placed.react(&forces, &mut generalised[..rigid], &mut reaction, seat);
    let modal_force = &mut generalised[rigid..];
    for (k, &force) in reaction.iter().enumerate() {
        if force != 0.0 {
            for (out, value) in modal_force.iter_mut().zip(faces.row(k)) {
                *out += force * value;
            }
        }
    }
    let whole: Vec<f64> = history.load.iter().zip(&generalised).map(|(b, f)| b + f).collect();
    let mut position = solve_bodies(&whole[..rigid]);
    position.extend(whole[rigid..].iter().zip(&operator.modes).map(|(b, d)| b * d));
    let approaches = approach
        .iter()
        .enumerate()
        .map(|(i, free)| {
            let sum: f64 = (0..meshes).map(|j| compliance.at(i, j) * (forces[springs + j] - before[j])).sum();
            free - sum - system.flanks[i].backlash
        })
        .collect();
    Ok(Stepped { position, forces, generalised, approaches, report })
}
