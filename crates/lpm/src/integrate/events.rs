//! Loss and gain of contact within a step.
//!
//! The boundary is a function of displacement and phase, `g = delta - limit(tau)`; forces are finite, so a solution
//! meets it with a continuous rate `g'`. A step is cut
//! - where `g` changes sign: located by the Illinois method on *real steps* of the method from the start of the step, so
//!   the event is as accurate as the method and not as its interpolant; final bracket 1e-13 of the step;
//! - where `g` only dips within the step: the cubic through both ends tells of an interior extremum, a real step
//!   there decides.
//!
//! Derivatives of the flow cross an event by the saltation matrix `S = I + (f+ - f-) grad g / (g_t + grad g . f-)`
//! (Leine & Nijmeijer 2004, Eq. (7.32)): velocities are continuous, accelerations jump by `-M^-1 w (F+ - F-)`.
//! At grazing the denominator vanishes together with the jump of the force (compliant contact); there `S = I`.
//!
//! Tests: `tests/closed_form.rs` (instants to 1e-10 s), `tests/floquet.rs` (saltation against differences).

use super::{Record, Runner, steppers::Step};
use crate::system::{ContactPhase, Vector};

/// A cut of the step at the fraction `theta`; `next` is the phase after it, or `None` where the step is only shortened.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cut {
    pub theta: f64,
    pub next: Option<ContactPhase>,
}

/// A boundary of a phase: which neighbour lies behind it.
#[derive(Debug, Clone, Copy)]
struct Boundary {
    drive: bool,
    /// `+1` where the phase is on the positive side of the gap.
    sign: f64,
    next: ContactPhase,
}

fn boundaries(phase: ContactPhase, coast: bool) -> [Option<Boundary>; 2] {
    use ContactPhase::{Apart, Coast, Drive};
    match phase {
        Drive => [Some(Boundary { drive: true, sign: 1.0, next: Apart }), None],
        Coast => [Some(Boundary { drive: false, sign: -1.0, next: Apart }), None],
        Apart => [
            Some(Boundary { drive: true, sign: -1.0, next: Drive }),
            coast.then_some(Boundary { drive: false, sign: 1.0, next: Coast }),
        ],
    }
}

/// First cut within the step, if any.
pub(crate) fn find<const N: usize>(run: &Runner<N>, r: &Record<N>, trials: &mut u64) -> Option<Cut> {
    boundaries(r.phase, run.system.coast_gap(&r.before).is_some())
        .into_iter()
        .flatten()
        .filter_map(|b| find_one(run, r, b, trials))
        .min_by(|a, b| a.theta.total_cmp(&b.theta))
}

fn find_one<const N: usize>(run: &Runner<N>, r: &Record<N>, b: Boundary, trials: &mut u64) -> Option<Cut> {
    let s = run.system;
    let gap = |theta: f64, z: &Vector<N>| {
        let (g, rate) = if b.drive {
            s.drive_gap(r.segment, r.tau + theta * r.dtau, run.frequency, z)
        } else {
            s.coast_gap(z).unwrap_or((f64::INFINITY, 0.0))
        };
        (b.sign * g, b.sign * rate * r.dtau / run.frequency)
    };
    let mut at = |theta: f64| {
        *trials += 1;
        let step = Step::prepare(s, run.method, r.phase, r.segment, r.tau, theta * r.dtau, run.frequency);
        gap(theta, &step.apply(s, &r.before).0).0
    };
    let (g0, d0) = gap(0.0, &r.before);
    let (g1, d1) = gap(1.0, &r.after);
    if g1 >= 0.0 {
        // Inside at the end: look for a dip. `d0 < 0 < d1` is necessary.
        if !(d0 < 0.0 && d1 > 0.0) {
            return None;
        }
        let theta = cubic_minimum(g0, d0, g1, d1)?;
        let depth = hermite(theta, g0, d0, g1, d1);
        // The cubic is good to a few percent of its own bend; beyond that margin no dip is possible.
        let bend = (g0.abs().min(g1.abs()) + d0.abs() + d1.abs()) * 0.05;
        if depth > bend {
            return None;
        }
        let true_depth = at(theta);
        // Not outside: nothing happens. Outside: stop there with the phase of the start, one crossing at a time.
        if true_depth >= 0.0 {
            return None;
        }
        return if g0 > 0.0 {
            Some(Cut { theta: root(&mut at, (0.0, g0), (theta, true_depth)), next: Some(b.next) })
        } else {
            Some(Cut { theta: 0.0, next: Some(b.next) })
        };
    }
    let (lo, glo) = if g0 > 0.0 {
        (0.0, g0)
    } else if d0 > 0.0 {
        // Starts on the boundary and moves inside: the interior maximum brackets the way out.
        let theta = cubic_minimum(-g0, -d0, -g1, -d1).unwrap_or(0.5);
        let g = at(theta);
        if g <= 0.0 {
            return Some(Cut { theta: 0.0, next: Some(b.next) });
        }
        (theta, g)
    } else {
        return Some(Cut { theta: 0.0, next: Some(b.next) });
    };
    Some(Cut { theta: root(&mut at, (lo, glo), (1.0, g1)), next: Some(b.next) })
}

/// Zero of `f` between `a` (positive) and `b` (negative): Illinois variant of regula falsi, with bisection when slow.
fn root(f: &mut impl FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)) -> f64 {
    let ((mut a, mut fa), (mut b, mut fb)) = (a, b);
    let mut side = 0i8;
    for i in 0..80 {
        if (b - a).abs() <= 1e-13 {
            break;
        }
        let mut t = (a * fb - b * fa) / (fb - fa);
        if !(t > a && t < b) || i % 12 == 11 {
            t = 0.5 * (a + b);
        }
        let ft = f(t);
        if ft == 0.0 {
            return t;
        }
        if ft > 0.0 {
            (a, fa) = (t, ft);
            if side == 1 {
                fb *= 0.5;
            }
            side = 1;
        } else {
            (b, fb) = (t, ft);
            if side == -1 {
                fa *= 0.5;
            }
            side = -1;
        }
    }
    // The outer end, so that the next phase starts on its own side.
    b
}

fn hermite(t: f64, g0: f64, d0: f64, g1: f64, d1: f64) -> f64 {
    let (c2, c3) = (3.0 * (g1 - g0) - 2.0 * d0 - d1, 2.0 * (g0 - g1) + d0 + d1);
    g0 + t * (d0 + t * (c2 + t * c3))
}

/// Interior minimum of the cubic through both ends, for `d0 < 0 < d1`.
fn cubic_minimum(g0: f64, d0: f64, g1: f64, d1: f64) -> Option<f64> {
    let (c2, c3) = (3.0 * (g1 - g0) - 2.0 * d0 - d1, 2.0 * (g0 - g1) + d0 + d1);
    // d0 + 2 c2 t + 3 c3 t^2 = 0 with rising slope.
    let disc = c2 * c2 - 3.0 * c3 * d0;
    if disc < 0.0 {
        return None;
    }
    let q = disc.sqrt();
    let t = if c2 > 0.0 { -d0 / (c2 + q) } else { (q - c2) / (3.0 * c3) };
    (t > 0.0 && t < 1.0).then_some(t)
}

/// Jump of the velocities per unit normal displacement: `(M^-1-scaled direction, 1 / rate of the gap)`.
pub(crate) fn saltation<const N: usize>(run: &Runner<N>, r: &Record<N>, next: ContactPhase) -> Option<([f64; N], f64)> {
    let s = run.system;
    let tau = r.tau + r.dtau;
    let z = &r.after;
    let drive = r.phase == ContactPhase::Drive || next == ContactPhase::Drive;
    let rate = if drive { s.drive_gap(r.segment, tau, run.frequency, z).1 } else { s.coast_gap(z)?.1 };
    let force = |phase| s.mesh_force(&s.coefs(phase, r.segment, tau), z);
    let jump = force(next) - force(r.phase);
    if jump == 0.0 || rate.abs() < 1e-12 * s.scale * s.omega {
        return None;
    }
    let mut column = [0.0; N];
    for i in 0..N {
        column[i] = -s.w[i] * jump / s.mass[i];
    }
    // Perturbed solutions cross earlier by (grad g . dz) / rate and spend that time under the new force.
    Some((column, 1.0 / rate))
}
