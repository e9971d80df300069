//! One step in time.
//!
//! Bodies move exactly under forces that are polynomials in the step (`propagator`); what is unknown is the force of every connection at the `s` stages
//! (`stages`). With `d = J q` at the stages and `W` the displacement that forces of the stages make within the step,
//!
//! `d = d_0 - W l`, springs `l = k d + c d'`, meshes `l = P max(0, F(m, x) + c(F) x')`
//!
//! where `d'` is the derivative of the polynomial through the start and the stages of `d`, and `P` the projection of a mesh's force on the stages, from points twice as many. A spring is then the
//! compliance `C = (k + c D)^-1` of the stages (`D` the matrix of differentiation), 0 where it is infinitely stiff.
//!
//! Rows that do not turn with the carrier are the same in every step. Their springs are eliminated once, with the housing and all bodies they hold: what is left is
//! a constant compliance between the places that turning rows act on, six of each body and the harmonics of the ring seat. A step builds the compliance of the
//! turning rows from it, eliminates the springs of the planets' pins, and solves for the meshes (`contact`). Coast flanks take part where they touch.
//!
//! Should Newton's method over the stages fail, the step is taken with one stage: mean forces of the step, whose problem has one solution that is always found.

use super::contact::{ContactReport, Problem, Touch, solve};
use super::dense::{Matrix, Square, axpy, dot};
use super::placed::Place;
use super::propagator::{BodyStep, ModeStep};
use super::rows::{HousingPart, Part, RIGID, SeatPart};
use super::stage_contact::{StageProblem, StageTouch, solve_stages};
use super::stages::Stages;
use super::system::{Spring, System};
use crate::error::PlanetaryError;

/// Smallest pivot against the largest entry of its column: below, infinitely stiff connections share a motion.
const PIVOT: f64 = 1e-12;

/// A place on which rows act: a coordinate of a body, a harmonic of the seat, or a whole row that does not turn.
#[derive(Debug, Clone, Default)]
struct Site {
    /// Coordinates of rigid bodies, and factors.
    rigid: Vec<(usize, f64)>,
    /// Interface of the housing, and factor.
    housing: Option<(usize, f64)>,
}

/// A row that turns, or that of a mesh that does not.
#[derive(Debug, Clone)]
struct ActiveRow {
    /// First site of a body, and part.
    parts: Vec<(usize, Part)>,
    /// First site of the seat, and part.
    seat: Option<(usize, SeatPart)>,
    /// Place of a row that does not turn.
    whole: Option<usize>,
}

/// A spring at the stages: compliance, and what its displacement at the start adds.
#[derive(Debug, Clone)]
struct StageSpring {
    compliance: Vec<f64>,
    start: Vec<f64>,
}

/// Everything about steps of one length that is the same in all of them.
#[derive(Debug, Clone)]
pub(super) struct Stepper {
    stages: Stages,
    step: f64,
    bodies: Vec<BodyStep>,
    modes: Vec<ModeStep>,
    springs: Vec<StageSpring>,
    /// Rows of springs that do not turn, and where they act.
    fixed: Vec<(usize, Site)>,
    /// Places on which the other rows act.
    places: Vec<Site>,
    /// Springs that turn.
    pins: Vec<(usize, ActiveRow)>,
    /// Flanks.
    flanks: Vec<ActiveRow>,
    /// Inverse compliance of the springs that do not turn (stages outside).
    fixed_inverse: Matrix,
    /// Motion of places by what these springs would move.
    to_places: Matrix,
    /// Their forces by forces on places.
    to_fixed: Matrix,
    /// Compliance of places.
    compliance: Matrix,
}

/// Start of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Begin<'a> {
    pub position: &'a [f64],
    pub velocity: &'a [f64],
    /// Forces of connections.
    pub connection: &'a [f64],
}

/// Where a step leads.
#[derive(Debug, Clone)]
pub(super) struct Course {
    /// At the start, then at the stages.
    pub places: Vec<Place>,
    /// Mesh cycles travelled at the points of meshes, and at the end.
    pub travelled: Vec<f64>,
    /// Loads on the rigid coordinates at the stages.
    pub external: Vec<Vec<f64>>,
}

/// A step, done.
#[derive(Debug, Clone, Default)]
pub(super) struct Marched {
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    /// Forces of connections at the stages, one connection after the other.
    pub forces: Vec<f64>,
    /// And at the end.
    pub connection: Vec<f64>,
    /// Approaches of flanks at the stages, backlash taken off, one flank after the other; 0 of coast flanks that are apart.
    pub approaches: Vec<f64>,
    /// And at the end.
    pub end_approaches: Vec<f64>,
    /// Positions of the rigid coordinates at the stages, one stage after the other.
    pub bodies: Vec<f64>,
    /// Projected rates of the coordinates of the housing, one stage after the other.
    pub rates: Vec<f64>,
    pub report: ContactReport,
}

impl Marched {
    /// A step of one stage as one of several: its means at all of them.
    pub fn spread(mut self, stages: usize) -> Self {
        let each = |values: &[f64]| values.iter().flat_map(|value| vec![*value; stages]).collect();
        (self.forces, self.approaches) = (each(&self.forces), each(&self.approaches));
        (self.bodies, self.rates) = (self.bodies.repeat(stages), self.rates.repeat(stages));
        self
    }
}

/// Entries of a row that are not 0, at the start and at the stages: places and values.
struct Entries {
    list: Vec<(usize, f64)>,
    ends: Vec<usize>,
}

impl Entries {
    /// At the start (0) or a stage (from 1).
    fn at(&self, i: usize) -> &[(usize, f64)] {
        let first = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.list[first..self.ends[i]]
    }

    fn times(&self, i: usize, motion: &[f64]) -> f64 {
        self.at(i).iter().map(|(site, value)| value * motion[*site]).sum()
    }
}

impl ActiveRow {
    /// Entries at places of the transmission.
    fn entries(&self, places: &[Place], harmonics: usize) -> Entries {
        let mut entries = Entries { list: Vec::new(), ends: Vec::with_capacity(places.len()) };
        let half = 2 * (2 * harmonics + 1);
        let mut values = vec![0.0; half];
        for place in places {
            if let Some(site) = self.whole {
                entries.list.push((site, 1.0));
            }
            let (sin, cos) = place.angle.sin_cos();
            for (first, part) in &self.parts {
                let row = part.at((cos, sin));
                entries.list.extend((0..RIGID).filter(|k| row[*k] != 0.0).map(|k| (first + k, row[k])));
            }
            if let Some((first, seat)) = &self.seat {
                seat.coefficients(place.angle, harmonics, &mut values);
                entries.list.extend((0..half).filter(|k| values[*k] != 0.0).map(|k| (first + k, values[k])));
            }
            entries.ends.push(entries.list.len());
        }
        entries
    }
}

impl StageSpring {
    fn new(stages: &Stages, step: f64, spring: &Spring) -> Self {
        let s = stages.count;
        if spring.stiffness.is_infinite() {
            return Self { compliance: vec![0.0; s * s], start: vec![0.0; s] };
        }
        // l = k d + c (D d + D_0 d_start), so d = (k + c D)^-1 (l - c D_0 d_start)
        let rate = |i: usize, j: usize| spring.damping / step * stages.slope[i * (s + 1) + j];
        let stiffness =
            nalgebra::DMatrix::from_fn(s, s, |i, j| rate(i, j + 1) + if i == j { spring.stiffness } else { 0.0 });
        // the matrix of differentiation has eigenvalues of positive real part
        let inverse = stiffness.try_inverse().unwrap_or_else(|| nalgebra::DMatrix::zeros(s, s));
        let start = (0..s).map(|i| -(0..s).map(|j| inverse[(i, j)] * rate(j, 0)).sum::<f64>()).collect();
        let compliance = (0..s * s).map(|k| inverse[(k / s, k % s)]).collect();
        Self { compliance, start }
    }
}

/// Motion of all coordinates over a step.
struct Moved {
    /// Positions of the rigid coordinates at the stages, one stage after the other.
    rigid: Vec<f64>,
    /// And of the housing's coordinates.
    modes: Vec<f64>,
    /// Rates at the end.
    velocity: Vec<f64>,
}

impl Moved {
    /// Under forces at the stages on rigid coordinates, and on those of the housing where there are any.
    fn new(stepper: &Stepper, begin: &Begin<'_>, forces: &[Vec<f64>], modal: Option<&[f64]>) -> Self {
        let (s, modes, rigid) = (stepper.stages.count, stepper.modes.len(), RIGID * stepper.bodies.len());
        let mut moved = Self {
            rigid: vec![0.0; s * rigid],
            modes: vec![0.0; s * modes],
            velocity: Vec::with_capacity(rigid + modes),
        };
        let (mut force, mut at) = (vec![[0.0; RIGID]; s], vec![[0.0; RIGID]; s]);
        for (body, own) in stepper.bodies.iter().enumerate() {
            let range = RIGID * body..RIGID * (body + 1);
            for (to, from) in force.iter_mut().zip(forces) {
                to.copy_from_slice(&from[range.clone()]);
            }
            let end = own.advance(&begin.position[range.clone()], &begin.velocity[range.clone()], &force, &mut at);
            for (i, at) in at.iter().enumerate() {
                moved.rigid[i * rigid..][range.clone()].copy_from_slice(at);
            }
            moved.velocity.extend(end);
        }
        let columns = s + 2;
        let mut inputs = vec![0.0; columns];
        for (k, own) in stepper.modes.iter().enumerate() {
            (inputs[0], inputs[1]) = (begin.position[rigid + k], begin.velocity[rigid + k]);
            if let Some(modal) = modal {
                (0..s).for_each(|j| inputs[2 + j] = modal[j * modes + k]);
            }
            for (i, row) in own.rows.chunks_exact(columns).enumerate() {
                let value = row.iter().zip(&inputs).map(|(a, b)| a * b).sum();
                if i < s { moved.modes[i * modes + k] = value } else { moved.velocity.push(value) }
            }
        }
        moved
    }
}

/// Forces of the connections that are solved for in a step, at the stages, one connection after the other.
struct Connections {
    /// On the places, one stage after the other.
    on_places: Vec<f64>,
    pins: Vec<f64>,
    flanks: Vec<f64>,
    /// Approaches of the flanks at the start and the stages, without backlash taken off.
    approaches: Vec<f64>,
    report: ContactReport,
}

impl Stepper {
    /// Of a number of stages and a step (s), the carrier at a speed (rad/s).
    ///
    /// # Errors
    /// Infinitely stiff connections that share a motion.
    pub fn new(system: &System, count: usize, step: f64, speed: f64, cycle: f64) -> Result<Self, PlanetaryError> {
        let stages = Stages::new(count);
        let bodies: Vec<BodyStep> =
            system.inertia.iter().map(|body| BodyStep::new(&stages, step, body, speed)).collect();
        let modes: Vec<ModeStep> = system
            .frequencies
            .iter()
            .zip(&system.damping_ratios)
            .map(|(w, zeta)| ModeStep::new(&stages, step, *w, *zeta))
            .collect();
        let springs = system.springs.iter().map(|spring| StageSpring::new(&stages, step, spring)).collect();
        let mut stepper = Self {
            stages,
            step,
            bodies,
            modes,
            springs,
            fixed: Vec::new(),
            places: Vec::new(),
            pins: Vec::new(),
            flanks: Vec::new(),
            fixed_inverse: Matrix::default(),
            to_places: Matrix::default(),
            to_fixed: Matrix::default(),
            compliance: Matrix::default(),
        };
        stepper.sort_rows(system);
        stepper.condense(system).ok_or(PlanetaryError::OverConstrained { cycle })?;
        Ok(stepper)
    }

    /// Stages of a step.
    pub fn stages(&self) -> &Stages {
        &self.stages
    }

    /// Tells rows that turn from those that do not, and numbers the places on which they act.
    fn sort_rows(&mut self, system: &System) {
        let springs = system.springs.len();
        let mut first_of_body: Vec<Option<usize>> = vec![None; system.ids.len()];
        let mut first_of_seat = None;
        for (index, row) in system.rows.iter().enumerate() {
            let turns = matches!(row.housing, HousingPart::Seat(_)) || row.parts.iter().any(|part| part.turning);
            if !turns {
                let rigid = row
                    .parts
                    .iter()
                    .flat_map(|part| part.row.iter().enumerate().map(|(k, value)| (RIGID * part.body + k, *value)));
                let housing = match row.housing {
                    HousingPart::Interface(interface) => Some((interface, -1.0)),
                    _ => None,
                };
                let site = Site { rigid: rigid.filter(|(_, value)| *value != 0.0).collect(), housing };
                if index < springs {
                    self.fixed.push((index, site));
                } else {
                    self.flanks.push(ActiveRow { parts: vec![], seat: None, whole: Some(self.places.len()) });
                    self.places.push(site);
                }
                continue;
            }
            let mut active = ActiveRow { parts: Vec::new(), seat: None, whole: None };
            for part in &row.parts {
                let places = &mut self.places;
                let first = *first_of_body[part.body].get_or_insert_with(|| {
                    let coordinate = |k| Site { rigid: vec![(RIGID * part.body + k, 1.0)], housing: None };
                    places.extend((0..RIGID).map(coordinate));
                    places.len() - RIGID
                });
                active.parts.push((first, part.clone()));
            }
            if let HousingPart::Seat(seat) = &row.housing {
                let harmonics = 2 * (2 * system.interfaces.harmonics + 1);
                let places = &mut self.places;
                let first = *first_of_seat.get_or_insert_with(|| {
                    let harmonic = |k| Site { rigid: vec![], housing: Some((system.interfaces.seat + k, 1.0)) };
                    places.extend((0..harmonics).map(harmonic));
                    places.len() - harmonics
                });
                active.seat = Some((first, seat.clone()));
            }
            if index < springs { self.pins.push((index, active)) } else { self.flanks.push(active) }
        }
    }

    /// Eliminates the springs that do not turn.
    fn condense(&mut self, system: &System) -> Option<()> {
        let (s, count) = (self.stages.count, system.interfaces.count);
        // H X H^T of the housing between stages
        let mut scaled = vec![0.0; self.modes.len()];
        let mut grams = Vec::with_capacity(s * s);
        for i in 0..s {
            for j in 0..s {
                let mut gram = Square::zeros(count);
                for b in 0..count {
                    for ((scaled, value), mode) in scaled.iter_mut().zip(system.interfaces.row(b)).zip(&self.modes) {
                        *scaled = value * mode.rows[i * (2 + s) + 2 + j];
                    }
                    for a in 0..count {
                        *gram.at_mut(a, b) = dot(system.interfaces.row(a), &scaled);
                    }
                }
                grams.push(gram);
            }
        }
        let between = |left: &[&Site], right: &[&Site]| {
            let mut matrix = Matrix::zeros(s * left.len(), s * right.len());
            for j in 0..s {
                for (b, to) in right.iter().enumerate() {
                    let column = matrix.column_mut(j * right.len() + b);
                    for i in 0..s {
                        for (a, from) in left.iter().enumerate() {
                            column[i * left.len() + a] = self.site_compliance((i, from), (j, to), &grams[i * s + j]);
                        }
                    }
                }
            }
            matrix
        };
        let fixed: Vec<&Site> = self.fixed.iter().map(|(_, site)| site).collect();
        let places: Vec<&Site> = self.places.iter().collect();
        let mut own = between(&fixed, &fixed);
        for (a, (row, _)) in self.fixed.iter().enumerate() {
            for i in 0..s {
                for j in 0..s {
                    *own.at_mut(i * fixed.len() + a, j * fixed.len() + a) += self.springs[*row].compliance[i * s + j];
                }
            }
        }
        let inverse = own.factor(PIVOT)?.inverse();
        let to_places = between(&places, &fixed).times(&inverse);
        let on_fixed = between(&fixed, &places);
        let mut compliance = between(&places, &places);
        for j in 0..compliance.columns {
            to_places.add_times(-1.0, on_fixed.column(j), compliance.column_mut(j));
        }
        self.to_fixed = inverse.times(&on_fixed);
        (self.fixed_inverse, self.to_places, self.compliance) = (inverse, to_places, compliance);
        Some(())
    }

    /// Motion of one site at a stage by a force on another at a stage.
    fn site_compliance(&self, (i, a): (usize, &Site), (j, b): (usize, &Site), gram: &Square) -> f64 {
        let mut sum = 0.0;
        for &(at, value) in &a.rigid {
            for &(by, other) in b.rigid.iter().filter(|(by, _)| by / RIGID == at / RIGID) {
                sum += value * other * self.bodies[at / RIGID].compliance((i, at % RIGID), (j, by % RIGID));
            }
        }
        if let (Some((at, value)), Some((by, other))) = (a.housing, b.housing) {
            sum += value * other * gram.at(at, by);
        }
        sum
    }

    /// Advances by a step.
    ///
    /// # Errors
    /// Infinitely stiff connections that share a motion.
    pub fn advance(&self, system: &System, course: &Course, begin: &Begin<'_>) -> Result<Marched, PlanetaryError> {
        let s = self.stages.count;
        let (rigid, springs, faces) = (system.rigid(), system.springs.len(), &system.interfaces);
        let (fixed, places) = (self.fixed.len(), self.places.len());

        // motion without connections: at the start, then at the stages
        let mut forces = course.external.clone();
        let mut moved = Moved::new(self, begin, &forces, None);
        let mut interface = vec![0.0; (s + 1) * faces.count];
        for (i, out) in interface.chunks_exact_mut(faces.count.max(1)).enumerate() {
            let at = i.checked_sub(1).map(|i| &moved.modes[i * self.modes.len()..(i + 1) * self.modes.len()]);
            faces.motion(at.unwrap_or(&begin.position[rigid..]), out);
        }
        let motion = |site: &Site, i: usize| {
            let bodies = if i == 0 { &begin.position[..rigid] } else { &moved.rigid[(i - 1) * rigid..i * rigid] };
            let on_bodies: f64 = site.rigid.iter().map(|(k, value)| value * bodies[*k]).sum();
            on_bodies + site.housing.map_or(0.0, |(k, value)| value * interface[i * faces.count + k])
        };

        // springs that do not turn
        let mut drive = vec![0.0; s * fixed];
        for (a, (row, site)) in self.fixed.iter().enumerate() {
            let start = motion(site, 0);
            for i in 0..s {
                drive[i * fixed + a] = motion(site, i + 1) - self.springs[*row].start[i] * start;
            }
        }
        let mut free = vec![0.0; (s + 1) * places];
        for i in 0..=s {
            for (k, site) in self.places.iter().enumerate() {
                free[i * places + k] = motion(site, i);
            }
        }
        self.to_places.add_times(-1.0, &drive, &mut free[places..]);

        // rows that turn
        let entries = |row: &ActiveRow| row.entries(&course.places, faces.harmonics);
        let pins: Vec<Entries> = self.pins.iter().map(|(_, row)| entries(row)).collect();
        let flanks: Vec<Entries> = self.flanks.iter().map(entries).collect();
        let mut near: Vec<usize> = (0..flanks.len())
            .filter(|&flank| system.flanks[flank].cycle_rate > 0.0 || begin.connection[springs + flank] > 0.0)
            .collect();
        let found = loop {
            let rows: Vec<&Entries> = pins.iter().chain(near.iter().map(|&flank| &flanks[flank])).collect();
            let found = self.connections(system, course, begin, &rows, &near, &free)?;
            // flanks that come into contact
            let mut moved = free[places..].to_vec();
            self.compliance.add_times(-1.0, &found.on_places, &mut moved);
            let touches = |flank: &usize| {
                let own = &flanks[*flank];
                let mut held = vec![own.times(0, &free[..places])];
                held.extend((0..s).map(|i| own.times(i + 1, &moved[i * places..(i + 1) * places])));
                let backlash = system.flanks[*flank].backlash;
                self.stages.value.chunks_exact(s + 1).any(|weights| dot(weights, &held) > backlash)
            };
            let before = near.len();
            let more: Vec<usize> = (0..flanks.len()).filter(|flank| !near.contains(flank)).filter(touches).collect();
            near.extend(more);
            if near.len() == before {
                break found;
            }
            near.sort_unstable();
        };

        // forces of all springs
        let mut done = Marched { report: found.report, ..Marched::default() };
        done.forces = vec![0.0; s * system.rows.len()];
        let mut on_fixed = vec![0.0; s * fixed];
        self.fixed_inverse.add_times(1.0, &drive, &mut on_fixed);
        self.to_fixed.add_times(-1.0, &found.on_places, &mut on_fixed);
        for (a, (row, _)) in self.fixed.iter().enumerate() {
            (0..s).for_each(|i| done.forces[row * s + i] = on_fixed[i * fixed + a]);
        }
        for ((row, _), force) in self.pins.iter().zip(found.pins.chunks_exact(s)) {
            done.forces[row * s..(row + 1) * s].copy_from_slice(force);
        }
        for (flank, force) in near.iter().zip(found.flanks.chunks_exact(s)) {
            done.forces[(springs + flank) * s..(springs + flank + 1) * s].copy_from_slice(force);
        }

        // bodies follow
        let mut on_interfaces = vec![0.0; s * faces.count];
        for i in 0..s {
            let own = self.fixed.iter().map(|(_, site)| site).zip(&on_fixed[i * fixed..(i + 1) * fixed]);
            let others = self.places.iter().zip(&found.on_places[i * places..(i + 1) * places]);
            for (site, force) in own.chain(others).filter(|(_, force)| **force != 0.0) {
                for (k, value) in &site.rigid {
                    forces[i][*k] -= value * force;
                }
                if let Some((k, value)) = site.housing {
                    on_interfaces[i * faces.count + k] -= value * force;
                }
            }
        }
        let count = self.modes.len();
        let mut modal = vec![0.0; s * count];
        for (i, out) in modal.chunks_exact_mut(count.max(1)).enumerate() {
            for (k, &force) in on_interfaces[i * faces.count..(i + 1) * faces.count].iter().enumerate() {
                if force != 0.0 {
                    axpy(out, force, faces.row(k));
                }
            }
        }
        moved = Moved::new(self, begin, &forces, Some(&modal));
        let end = &self.stages.motion_end;
        done.position = (0..system.size())
            .map(|k| {
                let stage =
                    |i: usize| if k < rigid { moved.rigid[i * rigid + k] } else { moved.modes[i * count + k - rigid] };
                end[0] * begin.position[k] + (0..s).map(|i| end[i + 1] * stage(i)).sum::<f64>()
            })
            .collect();
        done.rates = vec![0.0; s * count];
        for (i, slopes) in self.stages.slope.chunks_exact(s + 1).enumerate() {
            let rates = &mut done.rates[i * count..(i + 1) * count];
            axpy(rates, slopes[0] / self.step, &begin.position[rigid..]);
            for j in 0..s {
                axpy(rates, slopes[j + 1] / self.step, &moved.modes[j * count..(j + 1) * count]);
            }
        }
        (done.velocity, done.bodies) = (moved.velocity, moved.rigid);
        let value_end = |forces: &[f64]| dot(&self.stages.force_end, forces);
        done.connection = done.forces.chunks_exact(s).map(value_end).collect();
        done.approaches = vec![0.0; s * flanks.len()];
        done.end_approaches = vec![0.0; flanks.len()];
        let travelled = course.travelled.last().copied().unwrap_or_default();
        for (&index, held) in near.iter().zip(found.approaches.chunks_exact(s + 1)) {
            let flank = &system.flanks[index];
            let (x, speed) = (dot(end, held), dot(&self.stages.rate_end, held) / self.step);
            done.connection[springs + index] = flank.press(flank.cycle_at(travelled), x, speed).force;
            done.end_approaches[index] = x - flank.backlash;
            (0..s).for_each(|i| done.approaches[index * s + i] = held[i + 1] - flank.backlash);
        }
        Ok(done)
    }

    /// Forces of springs that turn, and of meshes.
    fn connections(
        &self,
        system: &System,
        course: &Course,
        begin: &Begin<'_>,
        rows: &[&Entries],
        near: &[usize],
        free: &[f64],
    ) -> Result<Connections, PlanetaryError> {
        let (s, places, count) = (self.stages.count, self.places.len(), rows.len());
        let overconstrained =
            || PlanetaryError::OverConstrained { cycle: course.travelled.last().copied().unwrap_or_default() };
        // J W J^T of these rows
        let mut compliance = Matrix::zeros(s * count, s * count);
        let mut motion = vec![0.0; s * places];
        for (b, by) in rows.iter().enumerate() {
            for j in 0..s {
                motion.fill(0.0);
                for (site, value) in by.at(j + 1) {
                    axpy(&mut motion, *value, self.compliance.column(j * places + site));
                }
                let column = compliance.column_mut(b * s + j);
                for (a, row) in rows.iter().enumerate() {
                    for i in 0..s {
                        column[a * s + i] = row.times(i + 1, &motion[i * places..(i + 1) * places]);
                    }
                }
            }
        }
        let at = |row: &Entries, i: usize| row.times(i, &free[i * places..(i + 1) * places]);
        // springs
        let pins = s * self.pins.len();
        let mut matrix = Matrix::zeros(pins, pins);
        let mut answer = Vec::with_capacity(pins);
        for j in 0..pins {
            matrix.column_mut(j).copy_from_slice(&compliance.column(j)[..pins]);
        }
        for (a, (row, _)) in self.pins.iter().enumerate() {
            let (spring, start) = (&self.springs[*row], at(rows[a], 0));
            for i in 0..s {
                for j in 0..s {
                    *matrix.at_mut(a * s + i, a * s + j) += spring.compliance[i * s + j];
                }
                answer.push(at(rows[a], i + 1) - spring.start[i] * start);
            }
        }
        let factors = matrix.factor(PIVOT).ok_or_else(overconstrained)?;
        factors.solve(&mut answer);
        // meshes, springs eliminated
        let meshes = s * near.len();
        let mut through = Vec::with_capacity(meshes);
        let mut own = Matrix::zeros(meshes, meshes);
        let mut rows_on_pins = Matrix::zeros(pins, meshes);
        for k in 0..pins {
            for i in 0..meshes {
                *rows_on_pins.at_mut(k, i) = compliance.at(pins + i, k);
            }
        }
        for j in 0..meshes {
            let column = compliance.column(pins + j);
            let mut on_pins = column[..pins].to_vec();
            factors.solve(&mut on_pins);
            for i in 0..meshes {
                *own.at_mut(i, j) = column[pins + i] - dot(rows_on_pins.column(i), &on_pins);
            }
            through.push(on_pins);
        }
        let mut scale = 0.0_f64;
        let mut unloaded = Vec::with_capacity(meshes);
        let springs = system.springs.len();
        let touches: Vec<StageTouch<'_>> = near
            .iter()
            .enumerate()
            .map(|(k, &index)| {
                let row = rows[self.pins.len() + k];
                for i in 0..s {
                    let by_pins = dot(rows_on_pins.column(k * s + i), &answer);
                    unloaded.push(at(row, i + 1) - by_pins);
                }
                let terms = row.at(s).iter().map(|(site, value)| (value * free[s * places + site]).abs());
                scale = terms.fold(scale, f64::max);
                let flank = &system.flanks[index];
                let points = &course.travelled[..self.stages.points.len()];
                let cycles = points.iter().map(|travelled| flank.cycle_at(*travelled)).collect();
                StageTouch { flank, cycles, start: at(row, 0) }
            })
            .collect();
        let mut forces: Vec<f64> = near.iter().flat_map(|index| vec![begin.connection[springs + index]; s]).collect();
        let (stage_approaches, report) = if s == 1 {
            mean_forces(&self.stages, self.step, &touches, own, &unloaded, scale, &mut forces)
        } else {
            let problem = StageProblem {
                stages: &self.stages,
                step: self.step,
                touches: &touches,
                compliance: &own,
                free: &unloaded,
                scale,
            };
            solve_stages(&problem, &mut forces)
        };
        for (through, force) in through.iter().zip(&forces) {
            axpy(&mut answer, -force, through);
        }
        let mut on_places = vec![0.0; s * places];
        for (a, row) in rows.iter().enumerate() {
            for i in 0..s {
                let k = a * s + i;
                let force = if k < pins { answer[k] } else { forces[k - pins] };
                row.at(i + 1).iter().for_each(|(site, value)| on_places[i * places + site] += value * force);
            }
        }
        let held = touches.iter().zip(stage_approaches.chunks_exact(s));
        let approaches = held.flat_map(|(touch, x)| std::iter::once(touch.start).chain(x.iter().copied())).collect();
        Ok(Connections { on_places, pins: answer, flanks: forces, approaches, report })
    }
}

/// Mean forces of the meshes over a step of one stage; `forces` are where they begin.
fn mean_forces(
    stages: &Stages,
    step: f64,
    touches: &[StageTouch<'_>],
    compliance: Matrix,
    free: &[f64],
    scale: f64,
    forces: &mut [f64],
) -> (Vec<f64>, ContactReport) {
    let touches: Vec<Touch<'_>> = touches
        .iter()
        .map(|touch| Touch {
            flank: touch.flank,
            cycle: touch.cycles[0],
            rate: stages.slope[1] / step,
            history: -stages.slope[0] / step * touch.start,
        })
        .collect();
    let before = forces.to_vec();
    let mut loaded = free.to_vec();
    compliance.add_times(-1.0, &before, &mut loaded);
    let square = Square { size: compliance.rows, values: compliance.values };
    let problem = Problem { touches: &touches, compliance: &square, free: &loaded, before: &before, scale };
    let report = solve(&problem, forces);
    let mut approaches = free.to_vec();
    for (j, force) in forces.iter().enumerate() {
        axpy(&mut approaches, -force, square.column(j));
    }
    (approaches, report)
}
