//! Static analysis of a case: healthy and damaged series, and force-deflection maps, in the units of the figures.

use anyhow::{Context as _, anyhow};
use fecm::statics::{PairModel, PositionResult, StaticsRequest, StaticsSeries};
use gear_geom::Damage;
use gearwright_case::SpurPairCase;
use serde::{Deserialize, Serialize};

/// One tooth pair at a position.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Pair {
    /// Tooth-pair number.
    pub number: i32,
    /// Force (N).
    pub force: f64,
    /// Stiffness (N/um).
    pub stiffness: f64,
    /// Contact width (mm).
    pub width: f64,
}

/// One position. Values that the solver does not vouch for are left out.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Point {
    /// Mesh cycle, with the origin of the case.
    pub cycle: f64,
    /// Static transmission error (um).
    pub error: f64,
    /// No-load transmission error (um).
    pub no_load: f64,
    /// Average-slope stiffness (N/um).
    pub average: Option<f64>,
    /// Local-slope stiffness (N/um).
    pub local: Option<f64>,
    /// Mesh force (N).
    pub force: f64,
    /// Loaded tooth pairs.
    pub pairs: Vec<Pair>,
}

/// A state of the pair over the mesh cycle.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Series {
    /// What distinguishes it.
    pub label: String,
    /// Damaged area or crack length (%), 0 without damage.
    pub percent: f64,
    /// Positions.
    pub points: Vec<Point>,
    /// Positions of the map, by torque from the smallest; empty if the case asks for none.
    pub map: Vec<Vec<Point>>,
}

/// All states of a case.
#[derive(Debug, Clone)]
pub struct Statics {
    /// Without damage.
    pub healthy: Series,
    /// Severities in order.
    pub damaged: Vec<Series>,
}

/// The healthy pair of a case.
pub fn healthy(case: &SpurPairCase) -> anyhow::Result<Series> {
    let model = PairModel::new(&case.pair, &case.options).context("the gears cannot be modelled")?;
    series(case, &model, None, "healthy", 0.0)
}

/// All severities of a case.
pub fn damaged(case: &SpurPairCase) -> anyhow::Result<Vec<Series>> {
    let sound = PairModel::new(&case.pair, &case.options).context("the gears cannot be modelled")?;
    // pits leave the positions alone at which nothing presses on them
    let solved = sound.solve(&request(case), &()).context("the contact of the sound pair cannot be solved")?;
    let mut before: Option<PairModel> = None;
    let mut all = Vec::new();
    for severity in &case.severities {
        // derived from the severity before: what they have in common is computed once
        let model = (before.as_ref().unwrap_or(&sound).with_damage(&severity.damage))
            .with_context(|| format!("{} cannot be modelled", severity.label))?;
        let percent = percent(case, &severity.damage);
        all.push(series(case, &model, Some((&sound, &solved)), &severity.label, percent)?);
        before = Some(model);
    }
    Ok(all)
}

/// Damaged part (%): pit area over the tooth's active surface, or crack length over the chord.
pub fn percent(case: &SpurPairCase, damage: &[Vec<gear_geom::ToothDamage>; 2]) -> f64 {
    let mut sum = 0.0;
    for (index, member) in [gear_geom::Member::Pinion, gear_geom::Member::Wheel].into_iter().enumerate() {
        for one in &damage[index] {
            sum += match &one.damage {
                Damage::Pit(pit) => 100.0 * area_fraction(case, member, pit),
                Damage::Crack(crack) => match crack.length {
                    gear_geom::CrackLength::Chord(fraction) | gear_geom::CrackLength::Path(fraction) => {
                        100.0 * fraction
                    }
                    gear_geom::CrackLength::Length(_) => 0.0,
                },
                // neither has a size in percent
                Damage::Wear(_) | Damage::BrokenCorner(_) => 0.0,
            };
        }
    }
    sum
}

/// Part of a tooth's active surface inside a pit: sampled evenly over the area, arc length by facewidth.
fn area_fraction(case: &SpurPairCase, member: gear_geom::Member, pit: &gear_geom::Pit) -> f64 {
    const SAMPLES: usize = 400;
    let (gear, landmarks) = (case.pair.gear(member), case.pair.landmarks(member));
    let arc = gear_geom::ProfileMeasure::ArcLength { base_radius: gear.base_radius() };
    let (low, high) = (arc.at(landmarks.sap.roll_distance), arc.at(landmarks.eap.roll_distance));
    let middle = |k: usize| (k as f64 + 0.5) / SAMPLES as f64;
    let inside = (0..SAMPLES).map(|i| {
        let roll = arc.roll(low + (high - low) * middle(i));
        (0..SAMPLES).filter(|&j| pit.contains(gear.facewidth() * (middle(j) - 0.5), roll)).count()
    });
    inside.sum::<usize>() as f64 / (SAMPLES * SAMPLES) as f64
}

/// All positions at the case's torque. Pressures say where a damaged pair differs from the sound one.
fn request(case: &SpurPairCase) -> StaticsRequest {
    StaticsRequest {
        mesh_cycles: case.mesh_cycles.clone(),
        torques: vec![case.inputs.load.torque_n_m],
        stiffness_difference: case.inputs.analysis.stiffness_by_differences,
        keep_pressure: true,
    }
}

fn series(
    case: &SpurPairCase,
    model: &PairModel,
    sound: Option<(&PairModel, &StaticsSeries)>,
    label: &str,
    percent: f64,
) -> anyhow::Result<Series> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let shown = |solved: &StaticsSeries| -> Vec<Vec<Point>> {
        solved.results.iter().map(|results| points(results, origin)).collect()
    };
    let unsolved = || format!("the contact of {label} cannot be solved");
    let solved = match sound {
        Some(known) => model.solve_from(&request(case), known, &()),
        None => model.solve(&request(case), &()),
    };
    let points = shown(&solved.with_context(unsolved)?).into_iter().next().ok_or_else(|| anyhow!("no positions"))?;
    if points.is_empty() {
        return Err(anyhow!("no position of {label} has a usable answer"));
    }
    let map = if case.map_torques.is_empty() {
        Vec::new()
    } else {
        let torques = case.map_torques.clone();
        let request = StaticsRequest { torques, stiffness_difference: false, keep_pressure: false, ..request(case) };
        shown(&model.solve(&request, &()).with_context(unsolved)?)
    };
    Ok(Series { label: label.into(), percent, points, map })
}

fn points(results: &[PositionResult], origin: f64) -> Vec<Point> {
    let point = |r: &PositionResult| Point {
        cycle: r.mesh_cycle + origin,
        error: r.static_transmission_error * 1e6,
        no_load: r.no_load_transmission_error * 1e6,
        average: r.stiffness_average_slope.map(|k| k * 1e-6),
        local: r.stiffness_local_slope_difference.or(r.stiffness_local_slope).map(|k| k * 1e-6),
        force: r.mesh_force,
        pairs: r
            .loaded_pairs()
            .map(|p| Pair {
                number: p.pair,
                force: p.force,
                stiffness: p.stiffness * 1e-6,
                width: p.contact_width * 1e3,
            })
            .collect(),
    };
    results.iter().filter(|r| r.status.is_usable()).map(point).collect()
}

impl Series {
    /// A quantity over the mesh cycle.
    pub fn over(&self, value: impl Fn(&Point) -> Option<f64>) -> Vec<(f64, f64)> {
        self.points.iter().filter_map(|p| value(p).map(|v| (p.cycle, v))).collect()
    }

    /// Transmission error over the mesh cycle (um).
    pub fn error(&self) -> Vec<(f64, f64)> {
        self.over(|p| Some(p.error))
    }

    /// Local-slope stiffness over the mesh cycle (N/um).
    pub fn local(&self) -> Vec<(f64, f64)> {
        self.over(|p| p.local)
    }

    /// Average-slope stiffness over the mesh cycle (N/um).
    pub fn average(&self) -> Vec<(f64, f64)> {
        self.over(|p| p.average)
    }

    /// A quantity of a tooth pair while it carries load.
    pub fn of_pair(&self, number: i32, value: impl Fn(&Pair) -> f64) -> Vec<(f64, f64)> {
        let own = |p: &Point| p.pairs.iter().find(|pair| pair.number == number).map(&value);
        self.over(own)
    }

    /// Share of the mesh cycle over which more than one pair carries load.
    pub fn double_contact(&self) -> f64 {
        self.points.iter().filter(|p| p.pairs.len() > 1).count() as f64 / self.points.len() as f64
    }
}

/// Ordinate at an abscissa, linear between the points; `None` outside.
pub fn at(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let next = points.iter().position(|p| p.0 >= x - 1e-9)?;
    let (b, y) = points[next];
    if (b - x).abs() < 1e-9 || next == 0 {
        return ((b - x).abs() < 1e-9).then_some(y);
    }
    let (a, z) = points[next - 1];
    Some(z + (y - z) * (x - a) / (b - a))
}

/// Point of the largest ordinate.
pub fn top(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().copied().fold((f64::NAN, f64::NEG_INFINITY), |best, p| if p.1 > best.1 { p } else { best })
}

/// Point of the least ordinate.
pub fn bottom(points: &[(f64, f64)]) -> (f64, f64) {
    points.iter().copied().fold((f64::NAN, f64::INFINITY), |best, p| if p.1 < best.1 { p } else { best })
}

/// Relative difference of two curves at an abscissa (%).
pub fn increase(damaged: &[(f64, f64)], healthy: &[(f64, f64)], x: f64) -> Option<f64> {
    Some(100.0 * (at(damaged, x)? / at(healthy, x)? - 1.0))
}

/// Span of the abscissa where the damaged curve exceeds the healthy one by more than 1 %: from the first such place to the last, and both.
pub fn affected(damaged: &[(f64, f64)], healthy: &[(f64, f64)]) -> Option<(f64, f64)> {
    let beyond = |p: &&(f64, f64)| at(healthy, p.0).is_some_and(|h| p.1 > 1.01 * h);
    let first = damaged.iter().find(beyond)?.0;
    let last = damaged.iter().rev().find(beyond)?.0;
    Some((first, last))
}
