//! Tooth pairs of a gear pair in space, as the contact search needs them.

use gear_geom::{Damage, FlankSide, Gear, GearPair, Member, ToothDamage};

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
    is_modified: bool,
    /// Damaged surfaces of the pinion and of the wheel, by tooth in `0..teeth`.
    surfaces: [Vec<(i64, Damage)>; 2],
}

/// Unloaded gears at first touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Closing rotation of the wheel (rad).
    pub rotation: f64,
    /// Nearest places of all pairs that face each other.
    pub approaches: Vec<Approach>,
}

/// Where a pair's flanks are nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Tooth-pair number.
    pub pair: i32,
    /// Arc length from the foot along the master flank (m).
    pub offset: f64,
    /// Gap there (m).
    pub gap: f64,
}

impl Pairing {
    /// From a gear pair.
    #[must_use]
    pub fn new(pair: &GearPair) -> Self {
        Self {
            pair: pair.clone(),
            profiles: MEMBERS.map(|member| FlankProfile::new(pair.gear(member))),
            is_modified: MEMBERS.iter().any(|&member| pair.gear(member).is_modified()),
            surfaces: [Vec::new(), Vec::new()],
        }
    }

    /// The same pair with damaged flanks.
    #[must_use]
    pub fn with_damage(mut self, damage: &[Vec<ToothDamage>; 2]) -> Self {
        for (index, list) in damage.iter().enumerate() {
            let teeth = i64::from(self.gear(index).teeth());
            let surfaces = list.iter().filter(|damage| damage.damage.is_on_surface());
            self.surfaces[index] =
                surfaces.map(|damage| (damage.tooth.rem_euclid(teeth), damage.damage.clone())).collect();
        }
        self.is_modified |= self.has_damaged_flanks();
        self
    }

    /// Whether damage has taken material from a flank.
    #[must_use]
    pub fn has_damaged_flanks(&self) -> bool {
        self.surfaces.iter().any(|surfaces| !surfaces.is_empty())
    }

    /// Whether both are of the same gears in the same place, damage aside.
    #[must_use]
    pub fn is_of_the_gears_of(&self, other: &Self) -> bool {
        let specs = |pairing: &Self| MEMBERS.map(|member| pairing.pair.gear(member).spec().clone());
        self.pair.centre_distance() == other.pair.centre_distance() && specs(self) == specs(other)
    }

    /// Gap (m) that no load closes: positions count as overloaded at a quarter of this deflection.
    #[must_use]
    pub fn never(&self) -> f64 {
        self.pair.base_pitch()
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
        of(0) + of(1) + self.damage_depth(pair, rolls, z)
    }

    /// What damage has taken from both flanks of a pair (m) at a roll distance on each and a face position, [`Self::never`] where nothing is
    /// left. Where damages of a tooth overlap, the deepest counts.
    #[must_use]
    pub fn damage_depth(&self, pair: i32, rolls: [f64; 2], z: f64) -> f64 {
        let of = |index: usize| {
            if self.surfaces[index].is_empty() {
                return 0.0;
            }
            let tooth = i64::from(pair) * i64::from(self.tooth_steps()[index]);
            let tooth = tooth.rem_euclid(i64::from(self.gear(index).teeth()));
            let own = self.surfaces[index].iter().filter(|(damaged, _)| *damaged == tooth);
            own.map(|(_, damage)| damage.depth_at(z, rolls[index])).fold(0.0, f64::max).min(self.never())
        };
        of(0) + of(1)
    }

    /// Whether damage leaves the places alone where a pair without it touches first at a mesh cycle. As damage only takes material away, first
    /// touch is then the same.
    #[must_use]
    pub fn leaves_touch_alone(&self, mesh_cycle: f64, touch: &Touch) -> bool {
        let half = 0.5 * self.common_facewidth();
        let least = touch.approaches.iter().map(|approach| approach.gap).fold(f64::INFINITY, f64::min);
        touch.approaches.iter().filter(|approach| approach.gap == least).all(|approach| {
            let placed = self.place(approach.pair, mesh_cycle, touch.rotation);
            let Ok(row) = placed.opposed(approach.offset) else { return false };
            let rolls = [row.pinion_roll, row.wheel_roll];
            // crown and slope decide where along the face; damage anywhere on that line may matter
            face_samples(half).all(|z| self.damage_depth(approach.pair, rolls, z) == 0.0)
        })
    }

    /// First touch of the unloaded gears at a mesh cycle. `None` when no flanks face each other.
    #[must_use]
    pub fn first_touch(&self, mesh_cycle: f64) -> Option<Touch> {
        const TOLERANCE: f64 = 1e-12;
        const MOST_STEPS: usize = 6;
        let base = self.base_radius(1);
        let mut touch = Touch { rotation: 0.0, approaches: Vec::new() };
        for step in 0..MOST_STEPS {
            let known = std::mem::take(&mut touch.approaches);
            for pair in self.candidates(mesh_cycle) {
                let placed = self.place(pair, mesh_cycle, touch.rotation);
                let from = known.iter().find(|approach: &&Approach| approach.pair == pair);
                if step > 0 && from.is_none() {
                    continue;
                }
                touch.approaches.extend(self.nearest(pair, &placed, from));
            }
            let least = touch.approaches.iter().map(|a| a.gap).min_by(f64::total_cmp)?;
            if least.abs() < TOLERANCE {
                break;
            }
            touch.rotation += least / base;
        }
        Some(touch)
    }

    /// Where the flanks of a pair are nearest, modifications included: sampled along the whole flank (or around a known place), then
    /// refined by halving. `None` when the flanks never face each other.
    fn nearest(&self, pair: i32, placed: &PlacedPair, known: Option<&Approach>) -> Option<Approach> {
        const SAMPLES: i32 = 48;
        const HALVINGS: usize = 26;
        let spacing = self.shortest_flank() / f64::from(SAMPLES);
        let gap = |offset: f64| self.gap(pair, &placed.opposed(offset).ok()?);
        let (middle, span) = known.map_or((0.0, SAMPLES), |approach| (approach.offset, 2));
        // unmodified flanks are nearest at the foot
        let span = if self.is_modified || gap(middle).is_none() { span } else { 0 };
        let samples = (-span..=span).filter_map(|k| {
            let offset = middle + f64::from(k) * spacing;
            gap(offset).map(|gap| Approach { pair, offset, gap })
        });
        let mut best = samples.min_by(|a, b| a.gap.total_cmp(&b.gap))?;
        let mut reach = spacing;
        for _ in 0..HALVINGS {
            reach *= 0.5;
            for offset in [best.offset - reach, best.offset + reach] {
                if let Some(gap) = gap(offset)
                    && gap < best.gap
                {
                    best = Approach { pair, offset, gap };
                }
            }
        }
        Some(best)
    }

    /// Least gap along the face at opposite points (m).
    fn gap(&self, pair: i32, row: &OpposedPoints) -> Option<f64> {
        if !self.is_modified {
            return Some(row.separation);
        }
        let half = 0.5 * self.common_facewidth();
        let removed = |z: f64| self.material_removed(pair, row, z);
        let least =
            face_samples(half).map(removed).chain(self.damage_rims(pair, row).map(removed)).min_by(f64::total_cmp)?;
        Some(row.separation + least)
    }

    /// Places along the face where damage at opposite points begins or ends, on the side of less damage: crowned flanks with a pit on their crest
    /// touch there first.
    fn damage_rims(&self, pair: i32, row: &OpposedPoints) -> impl Iterator<Item = f64> {
        const HALVINGS: usize = 24;
        let rolls = [row.pinion_roll, row.wheel_roll];
        let depth = move |z: f64| self.damage_depth(pair, rolls, z);
        let is_damaged = self.surfaces.iter().any(|list| !list.is_empty());
        let half = 0.5 * self.common_facewidth();
        let stretches = face_samples(half).zip(face_samples(half).skip(1)).take_while(move |_| is_damaged);
        stretches.filter_map(move |(one, other)| {
            let depths = [depth(one), depth(other)];
            let [mut less, mut more] = if depths[0] < depths[1] { [one, other] } else { [other, one] };
            let least = depths[0].min(depths[1]);
            if depths[0].max(depths[1]) <= least {
                return None;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (less + more);
                *(if depth(middle) > least { &mut more } else { &mut less }) = middle;
            }
            Some(less)
        })
    }
}

/// Places along a face from `-half` to `half` at which least gaps are looked for.
fn face_samples(half: f64) -> impl Iterator<Item = f64> {
    const EACH_WAY: i32 = 8;
    (-EACH_WAY..=EACH_WAY).map(move |k| half * f64::from(k) / f64::from(EACH_WAY))
}
