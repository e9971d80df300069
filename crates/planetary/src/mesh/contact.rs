//! Mesh tables from contact mechanics.
//!
//! [`fecm::PairModel`] gives static transmission error `delta_0` (the approach), force and exact tangent stiffness at any load. A position is solved at
//! loads an octave apart, from the highest down. Between two loads with the same tooth pairs in contact the curve is smooth, and a cubic is as good as
//! the loads' own discretisation: of fresh solutions between its knots a table of the dissertation's sun-planet pair misses the force by 2.9e-4 rms and 1.8e-3 at
//! worst (tip corners in contact) with 8 cells a Hertz half width, 2.0e-4 and 1.0e-3 with 16, 1.1e-4 and 5e-4 with 32.
//! Where a pair joins, stiffness jumps: there loads are added where the tangents from both sides meet, until a load falls on the curve that was
//! expected of it. A tooth with damage changes positions in which it, or a neighbour whose root it weakens, carries load; which these are is looked for at the
//! highest load, where most pairs touch. Where only neighbours carry load, the change is some 1e-4 of the deflection, and sound curves are stretched by it.
//!
//! Where loads along the face are not even, the same holds for the whole face; all motion across the line of action is left out (see [`super`]).

use fecm::{Observer, PairModel, PositionResult, StaticsRequest};
use gear_geom::{Damage, Member, ToothDamage};
use rayon::prelude::*;

use super::curve::{ForceCurve, ForceCurveData, ForceKnot};
use super::error::MeshError;
use super::table::{DamageWindow, MeshTable, MeshTableData};

/// How fine a table is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableOptions {
    /// Positions a cycle, 1 to 10,000.
    pub positions_per_cycle: usize,
    /// Mesh cycle of the first.
    pub origin: f64,
    /// Highest force of the curves (N); above it they go on straight.
    pub highest_force: f64,
    /// Octaves of load below it, 1 to 30; below the lowest they follow a power of the approach.
    pub octaves: usize,
    /// Relative error of the force that is allowed where pairs join, 1e-6 to 0.1.
    pub tolerance: f64,
}

impl TableOptions {
    /// 128 positions a cycle from mesh cycle 0, eight octaves, 0.05 %.
    #[must_use]
    pub fn up_to(highest_force: f64) -> Self {
        Self { positions_per_cycle: 128, origin: 0.0, highest_force, octaves: 8, tolerance: 5e-4 }
    }

    fn validate(&self) -> Result<(), MeshError> {
        let checks = [
            ("positions a cycle", self.positions_per_cycle as f64, 1.0, 1e4, "1 to 10,000"),
            ("origin", self.origin, -1e3, 1e3, "-1000 to 1000 mesh cycles"),
            ("highest force", self.highest_force, 1e-6, 1e12, "above 0, in N"),
            ("octaves", self.octaves as f64, 1.0, 30.0, "1 to 30"),
            ("tolerance", self.tolerance, 1e-6, 0.1, "1e-6 to 0.1 of the force"),
        ];
        match checks.into_iter().find(|(_, value, low, high, _)| !(low..=high).contains(&value)) {
            Some((name, value, _, _, allowed)) => Err(MeshError::Option { name, value, allowed }),
            None => Ok(()),
        }
    }

    pub(super) fn mesh_cycle(&self, position: i64) -> f64 {
        self.origin + position as f64 / self.positions_per_cycle as f64
    }
}

/// A damaged tooth of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct DamagedTooth {
    /// Its gear.
    pub member: Member,
    /// A pair that has it.
    pub pair: i64,
    /// What is wrong with it, as the [`gear_geom::GearPair`] sees its flanks.
    pub damage: Vec<Damage>,
}

/// Loads added at a position where pairs join, at most.
const MOST_ADDED: usize = 12;
/// A damaged tooth is felt where it changes the deflection under the highest force by more than this part of the tolerance. A crack weakens the root
/// of its neighbours: by 80 % through a tooth of the dissertation's sun, thin below its teeth, deflections change by 5e-4 where only these carry load, and by a tenth
/// of that a tooth further.
const FELT: f64 = 0.5;
/// Positions between those at which that is looked for, as a part of a cycle.
const PROBE_STEP: f64 = 0.1;

impl MeshTable {
    /// Table of a pair of sound gears. The observer hears of the loads an octave apart.
    ///
    /// # Errors
    /// Options out of range, a model with damage, positions without a solution, [`MeshError::Cancelled`].
    pub fn from_contact(model: &PairModel, options: &TableOptions, observer: &dyn Observer) -> Result<Self, MeshError> {
        let sound = 0..options.positions_per_cycle as i64;
        Self::new(MeshTableData {
            origin: options.origin,
            sound: force_curves(sound_model(model)?, sound, options, observer)?,
            windows: Vec::new(),
        })
    }

    /// This table with damaged teeth. `model` and `options` are those that the table was made of.
    ///
    /// # Errors
    /// As [`Self::from_contact`]; options of another table; damage that cannot be; [`MeshError::Overlap`] for teeth in mesh at the same time.
    pub fn with_damage(
        &self,
        model: &PairModel,
        teeth: &[DamagedTooth],
        options: &TableOptions,
        observer: &dyn Observer,
    ) -> Result<Self, MeshError> {
        let data = self.data();
        if data.sound.len() != options.positions_per_cycle || data.origin != options.origin {
            let (name, value) = ("positions a cycle", options.positions_per_cycle as f64);
            return Err(MeshError::Option { name, value, allowed: "positions and origin of the table to be damaged" });
        }
        let model = sound_model(model)?;
        let mut windows = data.windows.clone();
        let sound = Self::new(MeshTableData { windows: Vec::new(), ..data.clone() })?;
        for tooth in teeth {
            let damage = tooth.damage.iter().map(|damage| ToothDamage { tooth: 0, damage: damage.clone() }).collect();
            let damage = match tooth.member {
                Member::Pinion => [damage, Vec::new()],
                Member::Wheel => [Vec::new(), damage],
            };
            let damaged = model.with_damage(&damage)?;
            let period = model.pairing().pair().gear(tooth.member).teeth();
            let felt = Felt::new(model, &damaged, options)?;
            if felt.positions.is_empty() {
                continue;
            }
            let mut own = force_curves(&damaged, felt.in_mesh.clone(), options, observer)?.into_iter();
            let curve = |position: i64| {
                if let Some(curve) = felt.in_mesh.contains(&position).then(|| own.next()).flatten() {
                    return Ok(curve);
                }
                let (curve, shift) = sound.curve(position);
                curve.stretched(felt.stretch_at(position), shift as i32)
            };
            let curves = felt.positions.clone().map(curve).collect::<Result<Vec<_>, _>>()?;
            let first = felt.positions.start;
            windows.push(DamageWindow { pair: tooth.pair, period, first, curves });
        }
        Self::new(MeshTableData { windows, ..data.clone() })
    }
}

fn sound_model(model: &PairModel) -> Result<&PairModel, MeshError> {
    let damaged = model.options().damage.iter().flatten().count();
    if damaged > 0 {
        let allowed = "none: damage of a table is told apart from its sound model";
        return Err(MeshError::Option { name: "damages of the sound model", value: damaged as f64, allowed });
    }
    Ok(model)
}

/// Force curves at positions.
///
/// # Errors
/// Options out of range, positions without a solution, [`MeshError::Cancelled`].
pub fn force_curves(
    model: &PairModel,
    positions: std::ops::Range<i64>,
    options: &TableOptions,
    observer: &dyn Observer,
) -> Result<Vec<ForceCurve>, MeshError> {
    each_curve(model, positions, options, observer)?.into_iter().collect()
}

/// Force curves at positions; `None` where loads have no solution.
///
/// # Errors
/// Options out of range, [`MeshError::Cancelled`].
pub(super) fn possible_curves(
    model: &PairModel,
    positions: std::ops::Range<i64>,
    options: &TableOptions,
    observer: &dyn Observer,
) -> Result<Vec<Option<ForceCurve>>, MeshError> {
    let curves = each_curve(model, positions, options, observer)?.into_iter().map(|curve| match curve {
        Ok(curve) => Ok(Some(curve)),
        Err(MeshError::TooFewLoads { .. } | MeshError::Knot { .. }) => Ok(None),
        Err(error) => Err(error),
    });
    curves.collect()
}

fn each_curve(
    model: &PairModel,
    positions: std::ops::Range<i64>,
    options: &TableOptions,
    observer: &dyn Observer,
) -> Result<Vec<Result<ForceCurve, MeshError>>, MeshError> {
    options.validate()?;
    let mesh_cycles: Vec<f64> = positions.map(|position| options.mesh_cycle(position)).collect();
    let forces = (0..=options.octaves).rev().map(|octave| options.highest_force * 0.5_f64.powi(octave as i32));
    let radius = model.pairing().base_radius(1);
    let request = request(mesh_cycles.clone(), forces.map(|force| force * radius).collect());
    let series = model.solve(&request, observer)?;
    if observer.is_cancelled() || series.results.iter().any(|results| results.len() != mesh_cycles.len()) {
        return Err(MeshError::Cancelled);
    }
    let curves = (0..mesh_cycles.len()).into_par_iter().map(|index| {
        let results: Vec<&PositionResult> = series.results.iter().map(|results| &results[index]).collect();
        curve(model, &results, options, observer)
    });
    Ok(curves.collect())
}

fn request(mesh_cycles: Vec<f64>, torques: Vec<f64>) -> StaticsRequest {
    StaticsRequest::new(mesh_cycles, torques)
}

/// Knot of a load, where it has a solution.
fn knot(result: &PositionResult) -> Option<ForceKnot> {
    let stiffness = result.stiffness_local_slope?;
    result.status.is_usable().then(|| ForceKnot {
        approach: result.static_transmission_error,
        force: result.mesh_force,
        stiffness,
        pairs: result.loaded_pairs().map(|pair| (pair.pair, pair.force)).collect(),
    })
}

/// Joins the loads of a position, and adds loads where pairs join.
fn curve(
    model: &PairModel,
    results: &[&PositionResult],
    options: &TableOptions,
    observer: &dyn Observer,
) -> Result<ForceCurve, MeshError> {
    let mut knots: Vec<ForceKnot> = results.iter().filter_map(|result| knot(result)).collect();
    let (Some(highest), true) = (results.last(), knots.len() >= 2) else {
        let last = results.last();
        return Err(MeshError::TooFewLoads {
            mesh_cycle: last.map_or(f64::NAN, |result| result.mesh_cycle),
            usable: knots.len(),
            loads: results.len(),
            highest_force: options.highest_force,
            status: last.map_or(fecm::PositionStatus::NoContact, |result| result.status),
        });
    };
    let radius = model.pairing().base_radius(1);
    let touch =
        results.iter().find(|result| result.status.is_usable()).map_or(0.0, |result| result.no_load_transmission_error);
    let same_pairs = |a: &ForceKnot, b: &ForceKnot| a.pairs.iter().map(|p| p.0).eq(b.pairs.iter().map(|p| p.0));
    let mut index = 0;
    let mut added = 0;
    while index + 1 < knots.len() && added < MOST_ADDED && !observer.is_cancelled() {
        let (low, high) = (&knots[index], &knots[index + 1]);
        if same_pairs(low, high) {
            index += 1;
            continue;
        }
        let force = meeting_force(low, high);
        let series = model.solve(&request(vec![highest.mesh_cycle], vec![force * radius]), observer)?;
        added += 1;
        let found = series.results.iter().flatten().find_map(knot);
        let Some(found) = found.filter(|found| found.approach > low.approach && found.approach < high.approach) else {
            index += 1;
            continue;
        };
        let data = ForceCurveData { touch: touch.min(low.approach), knots: vec![low.clone(), high.clone()] };
        let expected = ForceCurve::new(data)?.response(found.approach).force;
        let is_expected = (expected / found.force - 1.0).abs() < options.tolerance;
        knots.insert(index + 1, found);
        if is_expected {
            index += 2;
        }
    }
    ForceCurve::new(ForceCurveData { touch, knots })
}

/// Force at which the tangents of two knots meet, well within them.
fn meeting_force(low: &ForceKnot, high: &ForceKnot) -> f64 {
    const MARGIN: f64 = 0.05;
    let (width, rise) = (high.approach - low.approach, high.force - low.force);
    let part = (high.stiffness * width - rise) / ((high.stiffness - low.stiffness) * width);
    let part = if part.is_finite() { part.clamp(MARGIN, 1.0 - MARGIN) } else { 0.5 };
    // a share of the rise, as of a broken line with the knots' slopes in proportion
    let line = (low.stiffness * part * width / rise).clamp(MARGIN, 1.0 - MARGIN);
    low.force + rise * line
}

/// Where damage of the teeth of pair 0 is felt.
struct Felt {
    positions: std::ops::Range<i64>,
    /// Of these, where pair 0 carries load.
    in_mesh: std::ops::Range<i64>,
    /// Relative change of the deflection at positions a stride apart.
    stretch: Vec<(i64, f64)>,
}

impl Felt {
    fn new(sound: &PairModel, damaged: &PairModel, options: &TableOptions) -> Result<Self, MeshError> {
        let steps = options.positions_per_cycle as i64;
        let stride = ((PROBE_STEP * steps as f64).floor() as i64).max(1);
        let reach = damaged.pairing().most_pairs() as i64 * steps / stride;
        let probes: Vec<i64> = (-reach..=reach).map(|k| k * stride).collect();
        let mesh_cycles = probes.iter().map(|&position| options.mesh_cycle(position)).collect();
        let request = request(mesh_cycles, vec![options.highest_force * damaged.pairing().base_radius(1)]);
        let [before, after] = [sound.solve(&request, &())?, damaged.solve(&request, &())?];
        let (mut stretch, mut felt, mut in_mesh) = (Vec::new(), Vec::new(), Vec::new());
        let results = before.results.iter().flatten().zip(after.results.iter().flatten());
        for (&position, (before, after)) in probes.iter().zip(results) {
            let deflection = before.static_transmission_error - before.no_load_transmission_error;
            let change = (after.static_transmission_error - before.static_transmission_error) / deflection;
            // also where there is no number, for a load too high for the damaged tooth
            let differs = before.status != after.status;
            let is_felt = differs || !(change.abs() < FELT * options.tolerance);
            // falls to nothing at the first place that is not in the window
            stretch.push((position, if is_felt && change.is_finite() { change } else { 0.0 }));
            if is_felt {
                felt.push(position);
                if differs || [before, after].iter().any(|result| result.loaded_pairs().any(|pair| pair.pair == 0)) {
                    in_mesh.push(position);
                }
            }
        }
        let around = |positions: &[i64]| match (positions.first(), positions.last()) {
            (Some(first), Some(last)) => first - stride + 1..last + stride,
            _ => 0..0,
        };
        Ok(Self { positions: around(&felt), in_mesh: around(&in_mesh), stretch })
    }

    /// Relative change of the deflection at a position, linear between those looked at.
    fn stretch_at(&self, position: i64) -> f64 {
        let after = self.stretch.partition_point(|(place, _)| *place <= position);
        match (after.checked_sub(1).and_then(|before| self.stretch.get(before)), self.stretch.get(after)) {
            (Some(&(low, a)), Some(&(high, b))) => a + (b - a) * (position - low) as f64 / (high - low) as f64,
            (Some(&(_, value)), None) | (None, Some(&(_, value))) => value,
            (None, None) => 0.0,
        }
    }
}
