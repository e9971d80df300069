//! Tooth pairs of a gear pair in space, as the contact search needs them.

use gear_geom::{FlankSide, Gear, GearPair, Member};

use crate::profile::FlankProfile;
use crate::search::{OpposedPoints, PlacedFlank, PlacedPair, Placement};

/// Index of a member: 0 pinion, 1 wheel.
const MEMBERS: [Member; 2] = [Member::Pinion, Member::Wheel];

/// A pair of teeth is a candidate for contact this many base pitches before and after its path on the line of action.
const EARLY_AND_LATE: f64 = 0.9;

/// Geometry of a gear pair for contact.
#[derive(Debug, Clone)]
pub struct Pairing {
    pair: GearPair,
    profiles: [FlankProfile; 2],
}

impl Pairing {
    /// From a gear pair.
    #[must_use]
    pub fn new(pair: &GearPair) -> Self {
        Self { pair: pair.clone(), profiles: MEMBERS.map(|member| FlankProfile::new(pair.gear(member))) }
    }

    /// The gear pair.
    #[must_use]
    pub fn pair(&self) -> &GearPair {
        &self.pair
    }

    /// Gear of a member index.
    #[must_use]
    pub fn gear(&self, index: usize) -> &Gear {
        self.pair.gear(MEMBERS[index])
    }

    /// Working flank of a member.
    #[must_use]
    pub fn side(&self, index: usize) -> FlankSide {
        self.pair.working_side(MEMBERS[index])
    }

    /// Base radius of a member (m).
    #[must_use]
    pub fn base_radius(&self, index: usize) -> f64 {
        self.profiles[index].base_radius
    }

    /// Change of tooth numbers from one pair to the next.
    #[must_use]
    pub fn tooth_steps(&self) -> [i32; 2] {
        MEMBERS.map(|member| self.pair.tooth_step(member))
    }

    /// Face that both gears share (m); both are centred at mid-face.
    #[must_use]
    pub fn common_facewidth(&self) -> f64 {
        self.pair.pinion().facewidth().min(self.pair.wheel().facewidth())
    }

    /// Whether nothing distinguishes the two halves of the face.
    #[must_use]
    pub fn is_symmetric_about_midface(&self) -> bool {
        MEMBERS.iter().all(|&member| self.pair.gear(member).spec().modification.is_symmetric())
    }

    /// Largest difference of pair numbers that may carry load together.
    #[must_use]
    pub fn most_pairs(&self) -> usize {
        self.pair.contact_ratio().ceil() as usize + 1
    }

    /// Arc length of the shorter of the two involutes (m).
    #[must_use]
    pub fn shortest_flank(&self) -> f64 {
        self.profiles.iter().map(|p| p.along_at(p.form_roll).abs()).fold(f64::INFINITY, f64::min)
    }

    /// Hertz half width at the pitch point (m) for `1 / E*` (1/Pa) and a line load (N/m).
    #[must_use]
    pub fn hertz_half_width(&self, inverse_modulus: f64, line_load: f64) -> f64 {
        let tangent = self.pair.working_pressure_angle().tan();
        let curvature: f64 = self.profiles.iter().map(|p| p.sigma / (p.base_radius * tangent)).sum();
        (4.0 * line_load * inverse_modulus / (std::f64::consts::PI * curvature)).sqrt()
    }

    /// Tooth pairs that can touch at a mesh cycle, deflected or not.
    #[must_use]
    pub fn candidates(&self, mesh_cycle: f64) -> std::ops::RangeInclusive<i32> {
        let pitch = self.pair.base_pitch();
        let [start, end] = self.pair.active_rolls();
        let at = |roll: f64| (roll - self.pair.pitch_roll()) / pitch;
        let first = mesh_cycle - at(end) - EARLY_AND_LATE;
        let last = mesh_cycle - at(start) + EARLY_AND_LATE;
        first.ceil() as i32..=last.floor() as i32
    }

    /// Places a tooth pair at a mesh cycle, the wheel closed by `rotation` (rad) from the unloaded kinematics of unmodified flanks.
    #[must_use]
    pub fn place(&self, pair: i32, mesh_cycle: f64, rotation: f64) -> PlacedPair {
        let flank = |index: usize, extra: f64| PlacedFlank {
            profile: self.profiles[index],
            placement: Placement {
                centre: self.pair.centre(MEMBERS[index]),
                angle: self.pair.tooth_angle(MEMBERS[index], pair, mesh_cycle) + extra,
                side: self.side(index).sign(),
            },
        };
        let roll = |member| self.pair.contact_roll(member, pair, mesh_cycle);
        let closing = self.pair.closing_direction() * rotation;
        PlacedPair::new(flank(0, 0.0), flank(1, closing), roll(Member::Pinion), roll(Member::Wheel))
    }

    /// Material removed from both flanks at opposite points (m).
    #[must_use]
    pub fn material_removed(&self, pair: i32, row: &OpposedPoints, z: f64) -> f64 {
        let rolls = [row.pinion_roll, row.wheel_roll];
        let of = |index: usize| {
            let tooth = i64::from(pair) * i64::from(self.tooth_steps()[index]);
            self.gear(index).material_removed(tooth, rolls[index], z)
        };
        of(0) + of(1)
    }

    /// Nearest approach of a pair, modifications included: arc length from the foot and gap (m). Samples `count` steps of `step` (m) on
    /// either side of the foot, then refines around the best. `None` when the flanks never face each other.
    pub fn nearest(
        &self,
        placed: &PlacedPair,
        removed: &impl Fn(&OpposedPoints, f64) -> f64,
        step: f64,
        count: i32,
    ) -> Option<(f64, f64)> {
        const FACE_SAMPLES: i32 = 8;
        let half = 0.5 * self.common_facewidth();
        let gap = |offset: f64| {
            let row = placed.opposed(offset).ok()?;
            let across = (-FACE_SAMPLES..=FACE_SAMPLES)
                .map(|k| removed(&row, half * f64::from(k) / f64::from(FACE_SAMPLES)))
                .fold(f64::INFINITY, f64::min);
            Some(row.separation + across)
        };
        let samples = (-count..=count).filter_map(|k| {
            let offset = f64::from(k) * step;
            gap(offset).map(|g| (offset, g))
        });
        let mut best = samples.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut reach = step;
        for _ in 0..30 {
            reach *= 0.5;
            for offset in [best.0 - reach, best.0 + reach] {
                if let Some(g) = gap(offset)
                    && g < best.1
                {
                    best = (offset, g);
                }
            }
        }
        Some(best)
    }
}
