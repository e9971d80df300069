//! A mesh whose teeth have errors of pitch, each its own.
//!
//! With rigid hubs all tooth pairs `j` close by the same approach `x`. A pair that stands back by `e_j`, the errors of both its teeth together, closes by
//! `x - e_j`, less what the loads on the other pairs bend away:
//!
//! `y_j = x - e_j - sum_k c_jk f_k`, `f_j = phi_j(y_j)`, `F = sum_j f_j`,
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | `phi_j` | force of the pair alone in contact over the approach, at its own place in the mesh | N |
//! | `c_jk` | approach lost by pair `j` for a unit force on pair `k`, symmetric | m/N |
//! | `e_j` | error of both teeth: material removed, positive | m |
//!
//! `phi` holds all that is not linear (flattening, tip corners); what a pair does to another is elastic at a distance, so one `c` for each place of the two is
//! enough. Both come from the contact model: `phi` with all other teeth out of reach, `c` from two pairs that share a load. The table of perfect teeth
//! stays the reference: the mesh with errors has the force of the table at the approach `x'` where the equations without errors give the same `F`, so
//! that what they leave out cancels where errors are small, and nothing is left of it without errors.
//!
//! Verified against contact statics of gears with errors over their hunting period in `tests/tooth_errors.rs`.

use std::sync::Arc;

use fecm::{Observer, PairModel, StaticsRequest};
use gear_geom::{Damage, MeasuredDeviation, MeshSite, ToothDamage};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::contact::{TableOptions, possible_curves};
use super::curve::ForceCurve;
use super::error::MeshError;
use super::law::{MeshLaw, MeshResponse};
use super::table::MeshTable;

/// Tooth pairs in reach at one position, at most.
const MAX_PAIRS: usize = 8;
/// Material taken off teeth that are not to touch, in base pitches.
const OUT_OF_REACH: f64 = 0.2;
/// Load at which pairs share, in parts of the highest force.
const SHARED_LOAD: f64 = 0.3;
/// Newton steps for the forces of the pairs, and for the approach of perfect teeth.
const MAX_STEPS: usize = 60;
/// Change of an approach that is rounding (m).
const ROUNDING: f64 = 1e-17;

/// Force curves of single tooth pairs, and what they do to each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToothPairCurves {
    /// Positions a cycle.
    steps: i64,
    /// Mesh cycle of position 0.
    origin: f64,
    /// Position of the first curve of pair 0.
    first: i64,
    /// Pair 0 alone in contact, position after position.
    alone: Vec<ForceCurve>,
    /// `couplings[d - 1][i]`: pair 0 with pair `d`, at position `first + i` (m/N); 0 where they cannot share a load.
    couplings: Vec<Vec<f64>>,
}

/// Errors of the teeth of both gears, by the number of the pair that they are in: tooth `k mod Z` of the list is in pair `k`.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothErrors {
    /// Pinion: material removed (m), as many as teeth.
    pub pinion: Vec<f64>,
    /// Wheel.
    pub wheel: Vec<f64>,
}

impl ToothErrors {
    /// Error of a pair (m).
    #[must_use]
    pub fn of_pair(&self, pair: i64) -> f64 {
        let at = |list: &[f64]| match list.len() {
            0 => 0.0,
            count => list[pair.rem_euclid(count as i64) as usize],
        };
        at(&self.pinion) + at(&self.wheel)
    }

    /// Largest difference between the errors of two pairs (m).
    #[must_use]
    pub fn spread(&self) -> f64 {
        let span = |list: &[f64]| {
            let (low, high) = list.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| (l.min(*e), h.max(*e)));
            if list.is_empty() { 0.0 } else { high - low }
        };
        span(&self.pinion) + span(&self.wheel)
    }
}

impl ToothPairCurves {
    /// Curves for a table of perfect teeth; `model` and `options` are those that it was made of. `spread` is the largest difference of errors (m) that
    /// they serve.
    ///
    /// # Errors
    /// Options out of range, positions without a solution, [`MeshError::Cancelled`].
    pub fn from_contact(
        table: &MeshTable,
        model: &PairModel,
        options: &TableOptions,
        spread: f64,
        observer: &dyn Observer,
    ) -> Result<Self, MeshError> {
        let steps = options.positions_per_cycle as i64;
        let deepest = |curve: &ForceCurve| curve.data().knots.last().map_or(0.0, |knot| knot.approach);
        let deepest = table.data().sound.iter().map(deepest).fold(0.0, f64::max);
        let alone = with_errors(model, &[(0, 0.0)])?;
        let reach = model.pairing().most_pairs() as i64 * steps;
        let range = places_in_reach(&alone, -reach..=reach, options, deepest + spread.max(0.0))?;
        let curves = possible_curves(&alone, range.clone(), options, observer)?;
        // the stretch around the pitch point in which every place has a curve
        let middle = (-range.start) as usize;
        let before = curves[..middle].iter().rev().take_while(|curve| curve.is_some()).count();
        let own: Vec<ForceCurve> = curves.into_iter().skip(middle - before).map_while(|curve| curve).collect();
        let first = -(before as i64);
        if own.len() as i64 >= MAX_PAIRS as i64 * steps || own.is_empty() {
            let name = "mesh cycles in which a tooth pair is in reach";
            return Err(MeshError::Option {
                name,
                value: own.len() as f64 / steps as f64,
                allowed: "above 0, below 8",
            });
        }
        let mut couplings = Vec::new();
        for distance in 1..=(own.len() as i64 - 1) / steps {
            // pair `distance` is at the place of pair 0 this many positions before
            let shared: Vec<i64> = (first + distance * steps..first + own.len() as i64).collect();
            let found: Vec<Result<Option<f64>, MeshError>> = shared
                .par_iter()
                .map(|&position| {
                    if observer.is_cancelled() {
                        return Err(MeshError::Cancelled);
                    }
                    let at = |place: i64| &own[(place - first) as usize];
                    coupling(model, options, position, distance as i32, [at(position), at(position - distance * steps)])
                })
                .collect();
            let found = found.into_iter().collect::<Result<Vec<_>, _>>()?;
            let mut row = vec![0.0; own.len()];
            for (index, &position) in shared.iter().enumerate() {
                row[(position - first) as usize] = nearest(&found, index);
            }
            couplings.push(row);
        }
        Ok(Self { steps, origin: options.origin, first, alone: own, couplings })
    }

    /// Pairs in reach at a position: number, curve, place of the curve.
    fn pairs(&self, position: i64) -> impl Iterator<Item = (i64, usize)> {
        let (first, steps, count) = (self.first, self.steps, self.alone.len() as i64);
        // position - pair steps within first .. first + count
        let lowest = (position - first - count).div_euclid(steps) + 1;
        let highest = (position - first).div_euclid(steps);
        (lowest..=highest).map(move |pair| (pair, (position - pair * steps - first) as usize))
    }
}

/// The model with only these pairs in reach, each standing back.
fn with_errors(model: &PairModel, pairs: &[(i32, f64)]) -> Result<PairModel, MeshError> {
    let pairing = model.pairing();
    let (step, teeth) = (pairing.tooth_steps()[0], i64::from(pairing.gear(0).teeth()));
    let around = pairing.most_pairs() as i32 + 1 + pairs.iter().map(|(pair, _)| pair.abs()).max().unwrap_or(0);
    let mut damage: Vec<ToothDamage> = Vec::new();
    for pair in -around..=around {
        let tooth = (i64::from(pair) * i64::from(step)).rem_euclid(teeth);
        let own = pairs.iter().find(|(own, _)| *own == pair).map(|(_, back)| *back);
        let depth = own.unwrap_or(OUT_OF_REACH * pairing.pair().base_pitch());
        if depth > 0.0 && !damage.iter().any(|other| other.tooth == tooth) {
            let table = MeasuredDeviation { roll: vec![0.0], face: vec![0.0], removed: vec![vec![depth]] };
            damage.push(ToothDamage { tooth, damage: Damage::Wear(table) });
        }
    }
    Ok(model.with_damage(&[damage, Vec::new()])?)
}

/// Positions around 0 at which pair 0 touches before an approach.
fn places_in_reach(
    alone: &PairModel,
    places: std::ops::RangeInclusive<i64>,
    options: &TableOptions,
    deepest: f64,
) -> Result<std::ops::Range<i64>, MeshError> {
    let lowest = options.highest_force * 0.5_f64.powi(options.octaves as i32);
    let request = StaticsRequest {
        mesh_cycles: places.clone().map(|place| options.mesh_cycle(place)).collect(),
        torques: vec![lowest * alone.pairing().base_radius(1)],
        stiffness_difference: false,
        keep_pressure: false,
    };
    let series = alone.solve(&request, &())?;
    let results = series.results.iter().flatten();
    let touches: Vec<bool> =
        results.map(|result| result.status.is_usable() && result.no_load_transmission_error < deepest).collect();
    let middle = (-places.start()) as usize;
    let before = touches[..middle].iter().rev().take_while(|touches| **touches).count() as i64;
    let after = touches[middle..].iter().take_while(|touches| **touches).count() as i64;
    Ok(-before..after)
}

/// Approach that pair 0 loses for a unit force on pair `distance`, from both sharing a load; `None` where one carries all.
fn coupling(
    model: &PairModel,
    options: &TableOptions,
    position: i64,
    distance: i32,
    curves: [&ForceCurve; 2],
) -> Result<Option<f64>, MeshError> {
    // both touch at once
    let touch = curves.map(|curve| curve.data().touch);
    let back = [(touch[1] - touch[0]).max(0.0), (touch[0] - touch[1]).max(0.0)];
    let shared = with_errors(model, &[(0, back[0]), (distance, back[1])])?;
    let request = StaticsRequest {
        mesh_cycles: vec![options.mesh_cycle(position)],
        torques: vec![SHARED_LOAD * options.highest_force * shared.pairing().base_radius(1)],
        stiffness_difference: false,
        keep_pressure: false,
    };
    let series = shared.solve(&request, &())?;
    let Some(result) = series.results.iter().flatten().find(|result| result.status.is_usable()) else {
        return Ok(None);
    };
    let force = |pair: i32| result.loaded_pairs().find(|own| own.pair == pair).map(|own| own.force);
    let (Some(own), Some(other)) = (force(0), force(distance)) else { return Ok(None) };
    let lost =
        |index: usize, force: f64| result.static_transmission_error - back[index] - curves[index].approach_of(force);
    // one number for both: c = c_01 = c_10, each weighted with the force that causes it
    let found = (lost(0, own) * other + lost(1, other) * own) / (own * own + other * other);
    Ok(found.is_finite().then_some(found))
}

/// The value at an index, or the nearest that is known, or 0.
fn nearest(values: &[Option<f64>], index: usize) -> f64 {
    let by_distance = (0..values.len()).filter_map(|k| Some((k.abs_diff(index), values[k]?)));
    by_distance.min_by_key(|(distance, _)| *distance).map_or(0.0, |(_, value)| value)
}

/// A mesh of gears whose teeth have errors.
#[derive(Debug, Clone)]
pub struct MeshWithErrors {
    table: Arc<MeshTable>,
    curves: Arc<ToothPairCurves>,
    errors: ToothErrors,
}

impl MeshWithErrors {
    /// From a table of perfect (or otherwise damaged) teeth, the curves of its pairs, and errors.
    ///
    /// # Errors
    /// [`MeshError::Option`] for curves of other positions than the table's, and for errors that are no numbers.
    pub fn new(table: Arc<MeshTable>, curves: Arc<ToothPairCurves>, errors: ToothErrors) -> Result<Self, MeshError> {
        if table.positions_per_cycle() as i64 != curves.steps || table.data().origin != curves.origin {
            let (name, value) = ("positions a cycle of single pairs", curves.steps as f64);
            return Err(MeshError::Option { name, value, allowed: "positions and origin of the table" });
        }
        if let Some(&value) = errors.pinion.iter().chain(&errors.wheel).find(|error| !error.is_finite()) {
            return Err(MeshError::Option { name: "error of a tooth", value, allowed: "finite, in m" });
        }
        Ok(Self { table, curves, errors })
    }

    /// Approach of perfect teeth with the same force at a position, and its derivative by the approach.
    fn equivalent(&self, position: i64, approach: f64) -> (f64, f64) {
        let mut pairs = Pairs::at(&self.curves, position, &self.errors);
        if pairs.errors().iter().all(|error| *error == 0.0) {
            return (approach, 1.0);
        }
        let with = pairs.solve(approach);
        if !(with.force > 0.0) {
            // as far from touching as the teeth with errors are
            return (approach + pairs.touch(false) - pairs.touch(true), 1.0);
        }
        let weighted = pairs.mean_error();
        pairs.clear_errors();
        let (perfect, stiffness) = pairs.approach_of(with.force, approach - weighted);
        let slope = with.stiffness / stiffness;
        (perfect, if slope.is_finite() { slope } else { 1.0 })
    }
}

impl MeshLaw for MeshWithErrors {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        if !(mesh_cycle.is_finite() && approach.is_finite()) {
            return self.table.response(mesh_cycle, approach);
        }
        let (mut perfect, mut slope) = (0.0, 0.0);
        let mut is_perfect = true;
        for (position, weight) in self.table.beside(mesh_cycle).into_iter().filter(|(_, weight)| *weight != 0.0) {
            let (own, rate) = self.equivalent(position, approach);
            is_perfect &= own == approach;
            perfect += weight * own;
            slope += weight * rate;
        }
        if is_perfect {
            return self.table.response(mesh_cycle, approach);
        }
        let MeshResponse { force, stiffness } = self.table.response(mesh_cycle, perfect);
        MeshResponse { force, stiffness: stiffness * slope.max(0.0) }
    }
}

/// Tooth pairs in reach at a position.
struct Pairs<'a> {
    curves: &'a ToothPairCurves,
    count: usize,
    places: [usize; MAX_PAIRS],
    errors: [f64; MAX_PAIRS],
    coupling: [[f64; MAX_PAIRS]; MAX_PAIRS],
    /// Approaches of the pairs, from the last solution.
    approaches: [f64; MAX_PAIRS],
    forces: [f64; MAX_PAIRS],
}

impl<'a> Pairs<'a> {
    fn at(curves: &'a ToothPairCurves, position: i64, errors: &ToothErrors) -> Self {
        let mut own = Self {
            curves,
            count: 0,
            places: [0; MAX_PAIRS],
            errors: [0.0; MAX_PAIRS],
            coupling: [[0.0; MAX_PAIRS]; MAX_PAIRS],
            approaches: [0.0; MAX_PAIRS],
            forces: [0.0; MAX_PAIRS],
        };
        for (pair, place) in curves.pairs(position).take(MAX_PAIRS) {
            (own.places[own.count], own.errors[own.count]) = (place, errors.of_pair(pair));
            own.count += 1;
        }
        for low in 0..own.count {
            for high in low + 1..own.count {
                // pairs come in ascending order: the lower one is pair 0 of the coupling
                let row = curves.couplings.get(high - low - 1);
                let value = row.map_or(0.0, |row| row[own.places[low]]);
                (own.coupling[low][high], own.coupling[high][low]) = (value, value);
            }
        }
        own
    }

    fn errors(&self) -> &[f64] {
        &self.errors[..self.count]
    }

    fn clear_errors(&mut self) {
        self.errors = [0.0; MAX_PAIRS];
    }

    fn curve(&self, index: usize) -> &'a ForceCurve {
        &self.curves.alone[self.places[index]]
    }

    /// Approach of first touch, with errors or without.
    fn touch(&self, with_errors: bool) -> f64 {
        let touch = |j: usize| self.curve(j).data().touch + if with_errors { self.errors[j] } else { 0.0 };
        (0..self.count).map(touch).fold(f64::INFINITY, f64::min)
    }

    /// Mean of the errors, weighted with the forces of the last solution.
    fn mean_error(&self) -> f64 {
        let sum: f64 = self.forces[..self.count].iter().sum();
        (0..self.count).map(|j| self.errors[j] * self.forces[j] / sum).sum()
    }

    /// Forces at an approach: sum and its derivative.
    fn solve(&mut self, approach: f64) -> MeshResponse {
        let n = self.count;
        for j in 0..n {
            self.approaches[j] = approach - self.errors[j];
        }
        let mut answer = MeshResponse::default();
        for _ in 0..MAX_STEPS {
            let mut slopes = [0.0; MAX_PAIRS];
            for j in 0..n {
                let own = self.curve(j).response(self.approaches[j]);
                (self.forces[j], slopes[j]) = (own.force, own.stiffness);
            }
            // (1 + C K) dy = -r, and (1 + C K) y' = 1 for the derivative by the approach
            let mut matrix = [[0.0; MAX_PAIRS]; MAX_PAIRS];
            let mut right = [[0.0; 2]; MAX_PAIRS];
            for j in 0..n {
                let mut residual = self.approaches[j] - (approach - self.errors[j]);
                for k in 0..n {
                    matrix[j][k] = f64::from(u8::from(j == k)) + self.coupling[j][k] * slopes[k];
                    residual += self.coupling[j][k] * self.forces[k];
                }
                right[j] = [-residual, 1.0];
            }
            eliminate(&mut matrix, &mut right, n);
            answer = MeshResponse {
                force: self.forces[..n].iter().sum(),
                stiffness: (0..n).map(|j| slopes[j] * right[j][1]).sum::<f64>().max(0.0),
            };
            let mut change = 0.0_f64;
            for j in 0..n {
                self.approaches[j] += right[j][0];
                change = change.max(right[j][0].abs());
            }
            if change <= ROUNDING {
                break;
            }
        }
        answer
    }

    /// Approach at which the pairs carry a force, and the stiffness there; Newton's method within a bracket, since force does not fall.
    fn approach_of(&mut self, force: f64, start: f64) -> (f64, f64) {
        let (mut low, mut high) = (self.touch(true), f64::INFINITY);
        let mut x = start.max(low);
        let mut stiffness = 0.0;
        for _ in 0..MAX_STEPS {
            let answer = self.solve(x);
            stiffness = answer.stiffness;
            let miss = force - answer.force;
            *(if miss > 0.0 { &mut low } else { &mut high }) = x;
            let mut next = x + miss / stiffness;
            if !(next > low && next < high) {
                next = if high.is_finite() { 0.5 * (low + high) } else { x + (x - self.touch(true)).max(1e-7) };
            }
            if (next - x).abs() <= ROUNDING || miss == 0.0 {
                break;
            }
            x = next;
        }
        (x, stiffness)
    }
}

/// Solves a small system in place, with pivoting; a pivot that vanishes leaves its row as it is.
fn eliminate(matrix: &mut [[f64; MAX_PAIRS]; MAX_PAIRS], right: &mut [[f64; 2]; MAX_PAIRS], n: usize) {
    for column in 0..n {
        let pivot = (column..n).max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()));
        let pivot = pivot.unwrap_or(column);
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let diagonal = matrix[column][column];
        if diagonal == 0.0 {
            continue;
        }
        let (own, own_right) = (matrix[column], right[column]);
        for row in (0..n).filter(|row| *row != column) {
            let factor = matrix[row][column] / diagonal;
            for k in column..n {
                matrix[row][k] -= factor * own[k];
            }
            right[row] = std::array::from_fn(|k| right[row][k] - factor * own_right[k]);
        }
    }
    for row in 0..n {
        let diagonal = matrix[row][row];
        if diagonal != 0.0 {
            right[row] = right[row].map(|value| value / diagonal);
        }
    }
}

/// A mesh whose gears stand off their places: its approach is less by a length.
#[derive(Debug, Clone)]
pub struct OffsetMesh {
    law: Arc<dyn MeshLaw>,
    offset: f64,
}

impl OffsetMesh {
    /// A law whose flanks stand back by `offset` (m).
    ///
    /// # Errors
    /// [`MeshError::Option`] for an offset that is no number.
    pub fn new(law: Arc<dyn MeshLaw>, offset: f64) -> Result<Self, MeshError> {
        if !offset.is_finite() {
            return Err(MeshError::Option { name: "offset of a mesh", value: offset, allowed: "finite, in m" });
        }
        Ok(Self { law, offset })
    }
}

impl MeshLaw for OffsetMesh {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        self.law.response(mesh_cycle, approach - self.offset)
    }
}

/// By how much the drive flanks of a planet stand back (m) whose pin is off its place outward and ahead (m). Sun and ring both push the planet ahead, the
/// sun outward, the ring inward.
#[must_use]
pub fn pin_offset(site: MeshSite, pressure_angle: f64, [radial, tangential]: [f64; 2]) -> f64 {
    let outward = if site == MeshSite::SunPlanet { pressure_angle.sin() } else { -pressure_angle.sin() };
    outward * radial + pressure_angle.cos() * tangential
}
