//! Which operator belongs to which step, made once and shared by all steps at the same place of the mesh.
//!
//! With a whole number of steps a mesh cycle, healthy teeth meet at the same positions in every cycle; only cycles near a tooth that differs (damage, pitch
//! error) need operators of their own. They are made in chunks of neighbouring positions that hand their solutions on, chunks in
//! parallel, always the same chunks: what a step computes does not depend on the number of threads, nor on what was computed before.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::flank::PairModes;
use super::operator::{Flanks, Operator};
use super::system::{StepMatrix, System};
use crate::error::FecmError;
use crate::pairing::Pairing;
use crate::statics::{GridScope, PairModel, PositionRequest, Start};

/// Positions that hand their solution on.
const CHUNK: usize = 5;
/// Operators hold this multiple of the static load; each level doubles it.
const LOAD_FACTOR: f64 = 1.5;
/// Levels: the last holds some hundred times the static load.
pub(super) const LEVELS: u32 = 7;

/// One chunk of positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct ChunkKey {
    /// Mesh cycle that stands for all like it.
    cycle: i64,
    /// Position within the cycle over [`CHUNK`].
    chunk: usize,
    /// How wide the grids are.
    level: u32,
    coast: bool,
}

/// Where a step finds its operator.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    key: ChunkKey,
    slot: usize,
    /// Mesh cycles from the operator's own to the step's.
    pub shift: i32,
}

/// All operators made so far; see the module header.
pub(super) struct Schedule<'a> {
    model: &'a PairModel,
    /// The pair as its coast flanks see it: without damage.
    healthy: &'a PairModel,
    torque: f64,
    start: f64,
    steps: usize,
    period: i64,
    window: [i64; 2],
    special: [Vec<i64>; 2],
    system: &'a System,
    step: Arc<StepMatrix>,
    modes: &'a PairModes,
    chunks: BTreeMap<ChunkKey, Chunk>,
    clock: u64,
    most_bytes: usize,
}

struct Chunk {
    /// `None` while a step works with it.
    operators: Vec<Option<Operator>>,
    bytes: usize,
    used: u64,
}

/// No operator where there must be one; not reached.
const MISSING: FecmError =
    FecmError::Option { name: "operator of a step", value: f64::NAN, allowed: "made before it is used" };

/// What a schedule rests on.
pub(super) struct ScheduleSpec<'a> {
    pub model: &'a PairModel,
    pub healthy: &'a PairModel,
    /// Torque of the static solutions (N m).
    pub torque: f64,
    /// Mesh cycle of step 0.
    pub start: f64,
    /// Steps a mesh cycle.
    pub steps: usize,
    pub system: &'a System,
    pub step: Arc<StepMatrix>,
    pub modes: &'a PairModes,
    /// Memory for operators (bytes).
    pub most_bytes: usize,
}

impl<'a> Schedule<'a> {
    pub fn new(spec: ScheduleSpec<'a>) -> Self {
        let special = special_teeth(spec.model);
        let period = period_of(spec.model, &special);
        // pairs that can touch, and teeth whose compliance feels a cracked one
        let pairs = spec.model.pairing().candidates(0.0);
        let felt = spec.model.bodies().iter().map(|body| i64::from(body.reach_of_damage())).max().unwrap_or(0);
        let window = [i64::from(*pairs.start()) - felt - 1, i64::from(*pairs.end()) + felt + 1];
        let ScheduleSpec { model, healthy, torque, start, steps, system, step, modes, most_bytes } = spec;
        Self {
            model,
            healthy,
            torque,
            start,
            steps,
            period,
            window,
            special,
            system,
            step,
            modes,
            chunks: BTreeMap::new(),
            clock: 0,
            most_bytes,
        }
    }

    pub fn mesh_cycle(&self, step: i64) -> f64 {
        self.start + step as f64 / self.steps as f64
    }

    /// The cycle whose teeth stand for those of a cycle.
    fn representative(&self, cycle: i64) -> i64 {
        let own = cycle.rem_euclid(self.period);
        if self.is_special(own) { own } else { (0..self.period).find(|&c| !self.is_special(c)).unwrap_or(own) }
    }

    fn is_special(&self, cycle: i64) -> bool {
        let pairing: &Pairing = self.model.pairing();
        let first = cycle + self.start.floor() as i64;
        (0..2).any(|index| {
            let teeth = i64::from(self.model.bodies()[index].teeth());
            let tooth = |pair: i64| (pair * i64::from(pairing.tooth_steps()[index])).rem_euclid(teeth);
            (first + self.window[0]..=first + self.window[1]).any(|pair| self.special[index].contains(&tooth(pair)))
        })
    }

    /// Place of the operator of a step.
    pub fn place(&self, step: i64, level: u32, coast: bool) -> Place {
        let steps = self.steps as i64;
        let (cycle, position) = (step.div_euclid(steps), step.rem_euclid(steps) as usize);
        let representative = if coast { 0 } else { self.representative(cycle) };
        let key = ChunkKey { cycle: representative, chunk: position / CHUNK, level, coast };
        Place { key, slot: position % CHUNK, shift: (cycle - representative) as i32 }
    }

    /// Makes, in parallel, the operators of steps in a range that are not yet there.
    pub fn prepare(&mut self, steps: std::ops::Range<i64>) -> Result<(), FecmError> {
        let mut keys: Vec<ChunkKey> = steps.map(|step| self.place(step, 0, false).key).collect();
        keys.sort_unstable();
        keys.dedup();
        keys.retain(|key| !self.chunks.contains_key(key));
        self.make(&keys)
    }

    fn make(&mut self, keys: &[ChunkKey]) -> Result<(), FecmError> {
        let made: Vec<Result<Vec<Operator>, FecmError>> = keys.par_iter().map(|key| self.operators(key)).collect();
        for (key, operators) in keys.iter().zip(made) {
            let operators = operators?;
            let bytes = operators.iter().map(Operator::bytes).sum();
            self.clock += 1;
            let operators = operators.into_iter().map(Some).collect();
            self.chunks.insert(*key, Chunk { operators, bytes, used: self.clock });
        }
        Ok(())
    }

    /// The pair's geometry.
    pub fn pairing(&self) -> &Pairing {
        self.model.pairing()
    }

    /// The operator at a place.
    pub fn operator(&mut self, place: &Place) -> Result<&Operator, FecmError> {
        let slot = self.slot(place)?;
        slot.as_ref().ok_or(MISSING)
    }

    /// Takes an operator out, to be put back.
    pub fn take(&mut self, place: &Place) -> Result<Operator, FecmError> {
        self.slot(place)?.take().ok_or(MISSING)
    }

    /// Puts an operator back.
    pub fn put_back(&mut self, place: &Place, operator: Operator) {
        if let Some(slot) = self.chunks.get_mut(&place.key).and_then(|chunk| chunk.operators.get_mut(place.slot)) {
            *slot = Some(operator);
        }
    }

    fn slot(&mut self, place: &Place) -> Result<&mut Option<Operator>, FecmError> {
        if !self.chunks.contains_key(&place.key) {
            self.make(&[place.key])?;
        }
        self.clock += 1;
        self.forget(&place.key);
        let chunk = self.chunks.get_mut(&place.key).ok_or(MISSING)?;
        chunk.used = self.clock;
        chunk.operators.get_mut(place.slot).ok_or(MISSING)
    }

    /// Drops the chunks not used for longest while there are too many.
    fn forget(&mut self, keep: &ChunkKey) {
        while self.chunks.values().map(|chunk| chunk.bytes).sum::<usize>() > self.most_bytes {
            let oldest = self.chunks.iter().filter(|(key, _)| *key != keep).min_by_key(|(_, chunk)| chunk.used);
            match oldest.map(|(key, _)| *key) {
                Some(key) => self.chunks.remove(&key),
                None => break,
            };
        }
    }

    fn operators(&self, key: &ChunkKey) -> Result<Vec<Operator>, FecmError> {
        let first = key.chunk * CHUNK;
        let model = if key.coast { self.healthy } else { self.model };
        let load_factor = LOAD_FACTOR * f64::from(1_u32 << key.level);
        let scope = GridScope { load_factor };
        let mut start: Option<Start> = None;
        let mut made = Vec::new();
        for position in first..(first + CHUNK).min(self.steps) {
            let real = self.mesh_cycle(key.cycle * self.steps as i64 + position as i64);
            let (mesh_cycle, flanks) = if key.coast { mirrored(model.pairing(), real) } else { (real, Flanks::Drive) };
            let touch = model.pairing().first_touch(mesh_cycle);
            let request = PositionRequest {
                mesh_cycle,
                touch: touch.as_ref(),
                torque: self.torque,
                stiffness_difference: false,
                keep_pressure: false,
            };
            let settled = model.settle(&request, start.as_ref(), &scope)?;
            let Some(settled) = settled.filter(|settled| settled.status.is_usable()) else {
                return Err(FecmError::NoEquilibrium { mesh_cycle: real, torque: self.torque });
            };
            start = Some(settled.start.clone());
            let system = (self.system, &*self.step);
            made.push(Operator::new(settled, model, load_factor, flanks, system, self.modes)?);
        }
        Ok(made)
    }
}

/// The mesh cycle at which a pair seen in a mirror stands when the real one is at `mesh_cycle`, and how far its wheel is then from touching.
pub(super) fn mirrored(pairing: &Pairing, mesh_cycle: f64) -> (f64, Flanks) {
    use gear_geom::Member::{Pinion, Wheel};
    let pair = pairing.pair();
    // tooth 0 of the pinion points to minus its angle
    let per_cycle = pair.tooth_angle(Pinion, 0, 1.0) - pair.tooth_angle(Pinion, 0, 0.0);
    let image = (-pair.tooth_angle(Pinion, 0, mesh_cycle) - pair.tooth_angle(Pinion, 0, 0.0)) / per_cycle;
    let teeth = f64::from(pair.wheel().teeth());
    let pitch = 2.0 * std::f64::consts::PI / teeth;
    let turned = -pair.tooth_angle(Wheel, 0, mesh_cycle) - pair.tooth_angle(Wheel, 0, image);
    let closing = pair.closing_direction() * turned;
    // teeth are alike: the one that is open by less than a pitch; equal to rounding is zero backlash
    let tiny = 1e-9 * pitch;
    let offset = (closing - tiny).rem_euclid(pitch) + tiny - pitch;
    (image, Flanks::Coast { offset })
}

/// Teeth of each gear that differ from the others.
fn special_teeth(model: &PairModel) -> [Vec<i64>; 2] {
    [0, 1].map(|index| {
        let gear = model.pairing().gear(index);
        let teeth = i64::from(gear.teeth());
        let damaged = model.options().damage[index].iter().map(|damage| damage.tooth.rem_euclid(teeth));
        let displaced = (0..teeth).filter(|&tooth| gear.pitch_error(tooth) != 0.0);
        let mut special: Vec<i64> = damaged.chain(displaced).collect();
        special.sort_unstable();
        special.dedup();
        special
    })
}

/// Mesh cycles after which the teeth in mesh repeat, as far as they differ.
pub(super) fn period(model: &PairModel) -> i64 {
    period_of(model, &special_teeth(model))
}

fn period_of(model: &PairModel, special: &[Vec<i64>; 2]) -> i64 {
    let teeth = [0, 1].map(|index| i64::from(model.bodies()[index].teeth()));
    match special.each_ref().map(Vec::is_empty) {
        [true, true] => 1,
        [false, true] => teeth[0],
        [true, false] => teeth[1],
        [false, false] => lcm(teeth[0], teeth[1]),
    }
}

fn lcm(a: i64, b: i64) -> i64 {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}
