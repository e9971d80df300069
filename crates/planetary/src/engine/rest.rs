//! A step towards rest.
//!
//! Rest is a minimum of the energy of springs, meshes and housing, which is convex. It is found by proximal points (R. T. Rockafellar, *SIAM J. Control Optim.* 14, 1976,
//! 877-898): `A q = b - J^T l` with `A = rho M` plus the housing's stiffness, `b = rho M q` and the loads, `l` the forces of connections, whose displacements are `d = J q`.
//! So the motion ends in a minimum where there is one, from any start, and a part that nothing holds and nothing pushes stays where it is. A spring is the
//! compliance `C = 1 / k`, 0 for an infinite stiffness. With `l = l_0 + D`, `l_0` the forces of the step before (so that nothing large cancels),
//!
//! `(J A^-1 J^T + C) D = J A^-1 (b - J^T l_0) - C l_0`
//!
//! for the springs, and the same with the law in place of `C` for the meshes (`contact`). The housing comes in through its interfaces `H` and `H A^-1 H^T`.

use super::contact::{ContactReport, Problem, Touch, solve};
use super::dense::{Square, dot};
use super::placed::{Place, Placed};
use super::rows::RIGID;
use super::system::System;
use crate::error::PlanetaryError;

/// Smallest pivot against its diagonal: below, infinitely stiff connections share a motion.
const PIVOT: f64 = 1e-12;

/// Inverse matrices of a step.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    bodies: Vec<[[f64; RIGID]; RIGID]>,
    modes: Vec<f64>,
    /// `H A^-1 H^T`.
    pub gram: Square,
}

impl Operator {
    /// Of a weight of the mass (1/s^2).
    pub fn new(system: &System, rho: f64) -> Self {
        let bodies = system.inertia.iter().map(|body| {
            let rotation = nalgebra::Matrix3::from_fn(|i, j| rho * body.tensor[i][j]);
            // moments of inertia are positive
            let inverse = rotation.try_inverse().unwrap_or_default();
            let mut whole = [[0.0; RIGID]; RIGID];
            for i in 0..3 {
                whole[i][i] = 1.0 / (rho * body.mass);
                for j in 0..3 {
                    whole[3 + i][3 + j] = inverse[(i, j)];
                }
            }
            whole
        });
        let bodies = bodies.collect();
        let modes: Vec<f64> = system.frequencies.iter().map(|w| 1.0 / (rho + w * w)).collect();
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
        Self { bodies, modes, gram }
    }

    pub fn body(&self, index: usize, x: &[f64]) -> [f64; RIGID] {
        let m = &self.bodies[index];
        let mut y = [0.0; RIGID];
        for i in 0..3 {
            y[i] = m[i][i] * x[i];
            y[3 + i] = m[3 + i][3] * x[3] + m[3 + i][4] * x[4] + m[3 + i][5] * x[5];
        }
        y
    }
}

/// End of a step.
pub(super) struct Stepped {
    pub position: Vec<f64>,
    pub forces: Vec<f64>,
    /// Approaches of the flanks, backlash taken off.
    pub approaches: Vec<f64>,
    pub report: ContactReport,
}

/// Solves a step from loads `b` and forces of connections before.
pub(super) fn step(
    system: &System,
    operator: &Operator,
    place: Place,
    right: &[f64],
    before: &[f64],
) -> Result<Stepped, PlanetaryError> {
    let (rigid, faces) = (system.rigid(), &system.interfaces);
    let (count, springs, seat) = (system.rows.len(), system.springs.len(), faces.seat);
    let placed = Placed::new(system, place);

    // motion under the load and the forces of before
    let mut load = right[..rigid].to_vec();
    let mut reaction = vec![0.0; faces.count];
    placed.react(before, &mut load, &mut reaction, seat);
    let solve_bodies = |load: &[f64]| -> Vec<f64> {
        load.chunks_exact(RIGID).enumerate().flat_map(|(body, load)| operator.body(body, load)).collect()
    };
    let modal: Vec<f64> = right[rigid..].iter().zip(&operator.modes).map(|(b, d)| b * d).collect();
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

    // springs eliminated
    let w = placed.compliance(operator, count, seat);
    let mut matrix = Square::zeros(springs);
    let mut answer = free[..springs].to_vec();
    for k in 0..springs {
        matrix.column_mut(k).copy_from_slice(&w.column(k)[..springs]);
    }
    // dampers alone hold nothing at rest
    let idle: Vec<bool> = system.springs.iter().map(|spring| spring.stiffness == 0.0).collect();
    for (k, spring) in system.springs.iter().enumerate() {
        if idle[k] {
            (0..springs).for_each(|j| (*matrix.at_mut(k, j), *matrix.at_mut(j, k)) = (0.0, 0.0));
            *matrix.at_mut(k, k) = 1.0;
            answer[k] = -before[k];
        } else {
            *matrix.at_mut(k, k) += 1.0 / spring.stiffness;
            answer[k] -= before[k] / spring.stiffness;
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
        .map(|flank| Touch { flank, cycle: flank.cycle_at(place.travelled), rate: 0.0, history: 0.0 })
        .collect();
    let meshes_before = &before[springs..];
    let mut forces = vec![0.0; count];
    let problem = Problem { touches: &touches, compliance: &compliance, free: &approach, before: meshes_before, scale };
    let report = solve(&problem, &mut forces[springs..]);
    for j in 0..meshes {
        let change = forces[springs + j] - meshes_before[j];
        for (out, through) in answer.iter_mut().zip(&on_springs[j]) {
            *out -= change * through;
        }
    }
    for k in 0..springs {
        forces[k] = before[k] + answer[k];
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
    let whole: Vec<f64> = right.iter().zip(&generalised).map(|(b, f)| b + f).collect();
    let mut position = solve_bodies(&whole[..rigid]);
    position.extend(whole[rigid..].iter().zip(&operator.modes).map(|(b, d)| b * d));
    let approaches = approach
        .iter()
        .enumerate()
        .map(|(i, free)| {
            let sum: f64 = (0..meshes).map(|j| compliance.at(i, j) * (forces[springs + j] - meshes_before[j])).sum();
            free - sum - system.flanks[i].backlash
        })
        .collect();
    Ok(Stepped { position, forces, approaches, report })
}
