//! Statics of a pair of gears.

pub mod damage;
pub mod stress;
pub mod summary;
pub mod tables;

use fecm::statics::{ModelStats, PositionResult, StaticsSeries};
use gear_geom::{GearPair, Member, ToothDamage};

use damage::Effect;
use stress::Stresses;
use summary::Times;

/// A case, computed.
pub struct Statics {
    /// Sizes of the model.
    pub stats: ModelStats,
    /// The healthy pair over the mesh cycle.
    pub healthy: StaticsSeries,
    /// What is read from its stresses.
    pub stresses: Stresses,
    /// Force-deflection map, by torque.
    pub map: Option<StaticsSeries>,
    /// Damaged pairs, by severity.
    pub damaged: Vec<DamagedPair>,
    /// Wall times.
    pub times: Times,
}

/// A damaged pair, computed.
pub struct DamagedPair {
    /// Severity.
    pub label: String,
    /// Damaged teeth of pinion and gear.
    pub damage: [Vec<ToothDamage>; 2],
    /// Whether both halves of the face are alike.
    pub symmetric: bool,
    /// Length of the longest crack along its path (m).
    pub crack_length: Option<f64>,
    /// The pair over the mesh cycle.
    pub series: StaticsSeries,
    /// What is read from its stresses.
    pub stresses: Stresses,
}

impl Statics {
    /// Positions of the healthy pair.
    #[must_use]
    pub fn positions(&self) -> &[PositionResult] {
        first(&self.healthy)
    }

    /// Effects of all severities; `origin` is added to mesh cycles.
    #[must_use]
    pub fn effects(&self, origin: f64) -> Vec<Effect> {
        let of = |damaged: &DamagedPair| {
            let stresses = (damaged.crack_length, &damaged.stresses);
            damage::effect(&damaged.label, self.positions(), damaged.positions(), stresses, origin)
        };
        self.damaged.iter().map(of).collect()
    }

    /// All series: healthy, map, damaged.
    pub fn series(&self) -> impl Iterator<Item = &StaticsSeries> {
        std::iter::once(&self.healthy).chain(self.map.as_ref()).chain(self.damaged.iter().map(|d| &d.series))
    }

    /// Positions without a usable answer, and all positions.
    #[must_use]
    pub fn unusable(&self) -> (usize, usize) {
        let all = || self.series().flat_map(|s| s.results.iter().flatten());
        (all().filter(|position| !position.status.is_usable()).count(), all().count())
    }
}

impl DamagedPair {
    /// Its positions.
    #[must_use]
    pub fn positions(&self) -> &[PositionResult] {
        first(&self.series)
    }

    /// Whether a tooth pair has a damaged tooth.
    #[must_use]
    pub fn touches(&self, pair: &GearPair, tooth_pair: i32) -> bool {
        [Member::Pinion, Member::Wheel].into_iter().zip(&self.damage).any(|(member, damaged)| {
            let teeth = i64::from(pair.gear(member).teeth());
            let own = i64::from(tooth_pair) * i64::from(pair.tooth_step(member));
            damaged.iter().any(|damage| (own - damage.tooth).rem_euclid(teeth) == 0)
        })
    }

    /// Depth of damage (m) at a place of the pinion's flank, on it or on the flank opposite, of any tooth.
    #[must_use]
    pub fn depth_at(&self, pair: &GearPair, face: f64, roll: f64) -> f64 {
        let rolls = [roll, pair.partner_roll(Member::Pinion, roll)];
        let of = |member: usize| self.damage[member].iter().map(move |d| d.damage.depth_at(face, rolls[member]));
        of(0).chain(of(1)).fold(0.0, f64::max)
    }
}

fn first(series: &StaticsSeries) -> &[PositionResult] {
    series.results.first().map_or(&[], Vec::as_slice)
}
