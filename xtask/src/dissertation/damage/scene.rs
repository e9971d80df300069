//! A pair of `configs/` with its healthy solution, to which damage is done.

use std::path::Path;

use fecm::statics::{PairModel, PositionResult, StaticsRequest};
use gear_geom::{Damage, Pit, ProfileMeasure, RootCrack, ToothDamage};
use gearwright::case::{self, SpurPairCase};

/// Positions in a mesh cycle.
const PER_CYCLE: f64 = 50.0;

/// A pair, its positions and its healthy results.
pub struct Scene {
    pub case: SpurPairCase,
    pub model: PairModel,
    pub cycles: Vec<f64>,
    /// Mesh cycle of the pitch point in the figures.
    pub origin: f64,
    pub healthy: Vec<PositionResult>,
    torque: f64,
}

impl Scene {
    /// A case over mesh cycles of the figures, at its own torque or another (N m).
    pub fn new(file: &str, from: f64, to: f64, torque: Option<f64>) -> anyhow::Result<Self> {
        let case = case::load_spur_pair(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs").join(file))?;
        // the figures of chapter 3 count from 0.75 before the pitch point whether or not the case says so
        let origin =
            if case.inputs.analysis.mesh_cycle_origin == 0.0 { 0.75 } else { case.inputs.analysis.mesh_cycle_origin };
        let count = ((to - from) * PER_CYCLE).round() as usize;
        let cycles = (0..=count).map(|k| from + (to - from) * k as f64 / count as f64 - origin).collect::<Vec<_>>();
        let model = PairModel::new(&case.pair, &case.options)?;
        let torque = torque.unwrap_or(case.inputs.load.torque_n_m);
        let mut scene = Self { case, model, cycles, origin, healthy: Vec::new(), torque };
        scene.healthy = scene.solve(&scene.model)?;
        Ok(scene)
    }

    fn solve(&self, model: &PairModel) -> anyhow::Result<Vec<PositionResult>> {
        let request = StaticsRequest {
            mesh_cycles: self.cycles.clone(),
            torques: vec![self.torque],
            stiffness_difference: false,
            keep_pressure: false,
        };
        Ok(model.solve(&request, &())?.results.remove(0))
    }

    /// Damage of tooth 0 of the pinion (0) or gear (1).
    pub fn damaged(&self, member: usize, damage: Damage) -> anyhow::Result<Vec<PositionResult>> {
        let mut teeth = [Vec::new(), Vec::new()];
        teeth[member].push(ToothDamage { tooth: 0, damage });
        self.solve(&self.model.with_damage(&teeth)?)
    }

    /// A crack along the chord, on the loaded side.
    pub fn cracked(&self, member: usize, fraction: f64) -> anyhow::Result<Vec<PositionResult>> {
        let side = self.model.bodies()[member].side;
        self.damaged(member, Damage::Crack(RootCrack::along_chord(side, fraction)))
    }

    /// A pit of the pinion centred at a roll distance, sizes in mm, the height an arc length on the flank.
    pub fn pit(&self, roll: f64, width: f64, height: f64, depth: Option<f64>) -> Pit {
        self.pit_at(0.0, roll, width, height, depth)
    }

    /// The same at a face position (m).
    pub fn pit_at(&self, face: f64, roll: f64, width: f64, height: f64, depth: Option<f64>) -> Pit {
        let measure = ProfileMeasure::ArcLength { base_radius: self.case.pair.pinion().base_radius() };
        Pit { depth, ..Pit::ellipse(face, roll, width * 1e-3, height * 1e-3, measure) }
    }

    /// The pair with a pit on the pinion.
    pub fn pitted(&self, pit: Pit) -> anyhow::Result<Vec<PositionResult>> {
        self.damaged(0, Damage::Pit(pit))
    }

    /// Index of the position nearest to a mesh cycle of the figures.
    pub fn at(&self, cycle: f64) -> usize {
        let distance = |k: &usize| (self.cycles[*k] + self.origin - cycle).abs();
        (0..self.cycles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }

    /// Increase of the transmission error at a mesh cycle (%).
    pub fn increase(&self, damaged: &[PositionResult], cycle: f64) -> f64 {
        let k = self.at(cycle);
        100.0 * (damaged[k].static_transmission_error / self.healthy[k].static_transmission_error - 1.0)
    }

    /// Mesh cycles of the figures whose transmission error grew by more than 1 %: how many, the first, the last.
    pub fn affected(&self, damaged: &[PositionResult]) -> (f64, f64, f64) {
        let grown =
            |k: &usize| damaged[*k].static_transmission_error > 1.01 * self.healthy[*k].static_transmission_error;
        let all: Vec<usize> = (0..damaged.len()).filter(grown).collect();
        let cycle = |k: Option<&usize>| k.map_or(f64::NAN, |&k| self.cycles[k] + self.origin);
        (all.len() as f64 * (self.cycles[1] - self.cycles[0]), cycle(all.first()), cycle(all.last()))
    }

    /// Mesh cycle of the figures with the largest transmission error.
    pub fn place_of_largest(&self, results: &[PositionResult]) -> f64 {
        let ste = |k: &usize| results[*k].static_transmission_error;
        let k = (0..results.len()).max_by(|a, b| ste(a).total_cmp(&ste(b))).unwrap_or(0);
        self.cycles[k] + self.origin
    }
}

/// Largest transmission error (um).
pub fn largest(results: &[PositionResult]) -> f64 {
    results.iter().map(|r| r.static_transmission_error * 1e6).fold(0.0, f64::max)
}

/// Peak-to-peak transmission error (um).
pub fn peak_to_peak(results: &[PositionResult]) -> f64 {
    let least = results.iter().map(|r| r.static_transmission_error * 1e6).fold(f64::INFINITY, f64::min);
    largest(results) - least
}

/// Least of a stiffness (N/um).
pub fn least(results: &[PositionResult], value: impl Fn(&PositionResult) -> Option<f64>) -> f64 {
    results.iter().filter_map(value).fold(f64::INFINITY, f64::min) * 1e-6
}
