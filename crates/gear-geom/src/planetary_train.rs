//! A planetary train of spur gears: assembly, speeds, phases of its meshes, and which tooth meets which when.
//!
//! Frame: `z` along the axis, angles counter-clockwise, planet `n` at the angle `psi_n` (`e_r` from the axis to it). In the carrier's frame the sun
//! turns counter-clockwise and drives the planets, which drive the ring: planets turn clockwise. The planet-ring pair is a [`GearPair`] in the
//! mirrored frame (`y -> -y`), where its pinion turns counter-clockwise.
//!
//! *Travelled* `t` is the rotation of ring and sun against the carrier in base pitches, `t = Z_r (theta_c - theta_r) / 2 pi`, the same in all meshes. The
//! mesh cycle of a mesh is `m = t + o` with an offset for each mesh (R. G. Parker, J. Lin, "Mesh phasing relationships in planetary and epicyclic
//! gears", *J. Mech. Des.* 126 (2004) 365-370; here from the flanks that drive, with tooth thickness, and not reduced to one cycle so that offsets number
//! teeth as well). With the angles of the centre lines of sun tooth 0 and ring tooth 0 at rest, `beta_s` and `beta_r`, half tooth angles `h` at the working
//! pitch circle of the mesh (subscripts `ps`, `pr` for the planet with the sun and with the ring), and [`GearPair::tooth_angle`] at `m = k`:
//!
//! | mesh | offset | pair `k` |
//! |---|---|---|
//! | planet-ring | `o_r = Z_r (psi_n - beta_r - h_r) / 2 pi` | ring tooth `k` |
//! | sun-planet | `o_s = Z_s (beta_s - psi_n + h_s) / 2 pi` | sun tooth `-k` |
//!
//! A planet's teeth are the same seen from both meshes: `o_s - o_r = gamma` but for whole cycles, `gamma = Z_p / 2 - Z_p (h_ps + h_pr) / 2 pi`. For one planet that turns
//! the sun into place; for the others it is the assembly condition, `(Z_s + Z_r) (psi_n - psi_0) / 2 pi` whole.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use gear_numerics::number::{gcd, lcm};

use crate::error::TrainError;
use crate::gear::{FlankSide, Gear, GearKind};
use crate::pair::{GearPair, Member};

/// Where two gears of the train mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshSite {
    /// Sun (pinion of the pair) and planet.
    SunPlanet,
    /// Planet (pinion of the pair) and ring.
    PlanetRing,
}

impl MeshSite {
    /// Both.
    pub const ALL: [Self; 2] = [Self::SunPlanet, Self::PlanetRing];

    /// A flank of a gear of the train, as its [`GearPair`] sees it: mirrored in the planet-ring pair.
    #[must_use]
    pub fn side_in_pair(self, side: FlankSide) -> FlankSide {
        match self {
            Self::SunPlanet => side,
            Self::PlanetRing => side.other(),
        }
    }
}

/// A rotating part on the main axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CentralMember {
    /// Sun.
    Sun,
    /// Carrier.
    Carrier,
    /// Ring.
    Ring,
}

/// A tooth of the train, numbered counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrainTooth {
    /// Of the sun.
    Sun(u32),
    /// Of a planet (first number). Tooth 0 is the one that at rest points most nearly away from the axis.
    Planet(usize, u32),
    /// Of the ring.
    Ring(u32),
}

/// Specification of a train.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanetaryTrainSpec {
    /// Sun, an external gear.
    pub sun: Gear,
    /// Planets, external gears, all alike.
    pub planet: Gear,
    /// Ring, an internal gear.
    pub ring: Gear,
    /// Distance of the planets' axes from the main axis (m).
    pub centre_distance: f64,
    /// Angles of the planets at rest (rad).
    pub planet_angles: Vec<f64>,
    /// Angle of the centre line of ring tooth 0 (rad).
    pub ring_tooth_angle: f64,
    /// Angle near which sun tooth 0 is at rest (rad); the nearest place that fits is taken.
    pub sun_tooth_angle: f64,
}

/// Speeds of the parts (rad/s), counter-clockwise positive, against the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainSpeeds {
    /// Sun.
    pub sun: f64,
    /// Carrier.
    pub carrier: f64,
    /// Ring.
    pub ring: f64,
    /// Planets about their own axes.
    pub planet: f64,
    /// Teeth passing through each mesh (Hz), never negative.
    pub mesh_frequency: f64,
    /// Planets passing a place on the ring (Hz), never negative.
    pub planet_pass_frequency: f64,
}

/// When a tooth is in a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// Turns of the carrier against the ring, from rest, at which the tooth touches at the pitch point.
    pub carrier_turns: f64,
    /// Planet.
    pub planet: usize,
    /// Mesh.
    pub site: MeshSite,
    /// Number of the tooth pair.
    pub pair: i64,
}

/// A train that can be assembled.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanetaryTrain {
    spec: PlanetaryTrainSpec,
    sun_pair: GearPair,
    ring_pair: GearPair,
    sun_tooth_angle: f64,
    planets: Vec<Planet>,
}

#[derive(Debug, Clone, PartialEq)]
struct Planet {
    sun_offset: f64,
    ring_offset: f64,
    /// Pair numbers of planet tooth 0 with the sun and with the ring.
    first_pair: [i64; 2],
}

/// Departure from the assembly condition that is taken for rounding of the angles (tooth pitches).
const ASSEMBLY_TOLERANCE: f64 = 1e-6;
/// Most engagements in a list.
const MOST_ENGAGEMENTS: f64 = 1e8;

impl PlanetaryTrain {
    /// Puts a train together.
    ///
    /// # Errors
    /// [`TrainError`]: pairs that cannot mesh, planets that do not fit or collide, numbers that are none.
    pub fn new(spec: &PlanetaryTrainSpec) -> Result<Self, TrainError> {
        let PlanetaryTrainSpec { sun, planet, ring, centre_distance, planet_angles, .. } = spec;
        for (gear, name, kind, needed) in [
            (sun, "sun", GearKind::External, "external"),
            (planet, "planet", GearKind::External, "external"),
            (ring, "ring", GearKind::Internal, "internal"),
        ] {
            if gear.kind() != kind {
                return Err(TrainError::Kind { gear: name, needed });
            }
        }
        let numbers = planet_angles.iter().map(|&angle| ("planet angle", angle));
        let fixed = [("ring tooth angle", spec.ring_tooth_angle), ("sun tooth angle", spec.sun_tooth_angle)];
        if let Some((quantity, value)) = numbers.chain(fixed).find(|(_, value)| !value.is_finite()) {
            return Err(TrainError::NotFinite { quantity, value });
        }
        let mate = |pair, pinion: &Gear, wheel: &Gear| {
            GearPair::new(pinion.clone(), wheel.clone(), *centre_distance)
                .map_err(|source| TrainError::Pair { pair, source })
        };
        let sun_pair = mate("sun-planet pair", sun, planet)?;
        let ring_pair = mate("planet-ring pair", planet, ring)?;
        check_places(spec)?;
        let &first = planet_angles.first().ok_or(TrainError::NoPlanet)?;

        let half = |pair: &GearPair, member: Member| {
            let radius = pair.working_pitch_radius(member);
            0.5 * pair.gear(member).thickness_at(radius) / radius
        };
        let [z_s, z_p, z_r] = [sun, planet, ring].map(|gear| f64::from(gear.teeth()));
        let (h_s, h_ps) = (half(&sun_pair, Member::Pinion), half(&sun_pair, Member::Wheel));
        let (h_pr, h_r) = (half(&ring_pair, Member::Pinion), half(&ring_pair, Member::Wheel));
        let gamma = 0.5 * z_p - z_p * (h_ps + h_pr) / TAU;
        let ring_offset = |psi: f64| z_r * (psi - spec.ring_tooth_angle - h_r) / TAU;
        // the sun's place: planet 0 between ring and sun, but for whole teeth
        let wished = z_s * (spec.sun_tooth_angle - first + h_s) / TAU;
        let fitting = ring_offset(first) + gamma;
        let first_offset = fitting + (wished - fitting).round();
        let sun_tooth_angle = first_offset * TAU / z_s + first - h_s;
        let place = |&psi: &f64| {
            let (sun_offset, ring_offset) = (first_offset - z_s * (psi - first) / TAU, ring_offset(psi));
            let with_ring = (ring_offset - z_p * h_pr / TAU).round() as i64;
            let between = (sun_offset - ring_offset - gamma).round() as i64;
            Planet { sun_offset, ring_offset, first_pair: [with_ring + between, with_ring] }
        };
        let planets = planet_angles.iter().map(place).collect();
        Ok(Self { spec: spec.clone(), sun_pair, ring_pair, sun_tooth_angle, planets })
    }

    /// The specification.
    #[must_use]
    pub fn spec(&self) -> &PlanetaryTrainSpec {
        &self.spec
    }

    /// The gear pair of a mesh; that of planet and ring in the mirrored frame.
    #[must_use]
    pub fn pair(&self, site: MeshSite) -> &GearPair {
        match site {
            MeshSite::SunPlanet => &self.sun_pair,
            MeshSite::PlanetRing => &self.ring_pair,
        }
    }

    /// Number of planets.
    #[must_use]
    pub fn planets(&self) -> usize {
        self.planets.len()
    }

    /// Angle of the centre line of sun tooth 0 at rest (rad).
    #[must_use]
    pub fn sun_tooth_angle(&self) -> f64 {
        self.sun_tooth_angle
    }

    fn planet(&self, planet: usize) -> Result<&Planet, TrainError> {
        let count = self.planets.len();
        self.planets.get(planet).ok_or(TrainError::NoSuch { what: "planet", number: planet, count })
    }

    /// Mesh cycle of a mesh at rest.
    ///
    /// # Errors
    /// [`TrainError::NoSuch`] planet.
    pub fn mesh_offset(&self, site: MeshSite, planet: usize) -> Result<f64, TrainError> {
        self.planet(planet).map(|planet| match site {
            MeshSite::SunPlanet => planet.sun_offset,
            MeshSite::PlanetRing => planet.ring_offset,
        })
    }

    /// Mesh cycle of all meshes, but for their offsets, per turn of the carrier against the ring.
    #[must_use]
    pub fn cycles_per_carrier_turn(&self) -> f64 {
        f64::from(self.spec.ring.teeth())
    }

    /// Whether all meshes of a site are at the same place of their cycle at the same time.
    #[must_use]
    pub fn is_in_phase(&self, site: MeshSite) -> bool {
        let teeth = match site {
            MeshSite::SunPlanet => self.spec.sun.teeth(),
            MeshSite::PlanetRing => self.spec.ring.teeth(),
        };
        let first = self.spec.planet_angles[0];
        let parts = self.spec.planet_angles.iter().map(|psi| f64::from(teeth) * (psi - first) / TAU);
        parts.into_iter().all(|part| (part - part.round()).abs() < ASSEMBLY_TOLERANCE)
    }

    /// Teeth of a pair of a mesh: of the pinion and of the wheel of its [`GearPair`], numbered as [`TrainTooth`].
    ///
    /// # Errors
    /// [`TrainError::NoSuch`] planet.
    pub fn teeth_of_pair(&self, site: MeshSite, planet: usize, pair: i64) -> Result<[u32; 2], TrainError> {
        let modulo = |tooth: i64, gear: &Gear| tooth.rem_euclid(i64::from(gear.teeth())) as u32;
        let [with_sun, with_ring] = self.planet(planet)?.first_pair;
        let PlanetaryTrainSpec { sun, planet, ring, .. } = &self.spec;
        Ok(match site {
            MeshSite::SunPlanet => [modulo(-pair, sun), modulo(pair - with_sun, planet)],
            MeshSite::PlanetRing => [modulo(pair - with_ring, planet), modulo(pair, ring)],
        })
    }

    /// The pairs in which a tooth takes part in a mesh: the first number that is not negative, and the number of pairs from one to the next. `None`
    /// where the tooth is not of that mesh.
    ///
    /// # Errors
    /// [`TrainError::NoSuch`] planet or tooth.
    pub fn pairs_of_tooth(
        &self,
        site: MeshSite,
        planet: usize,
        tooth: TrainTooth,
    ) -> Result<Option<(i64, u32)>, TrainError> {
        let [with_sun, with_ring] = self.planet(planet)?.first_pair;
        let gears = &self.spec;
        let (gear, number) = match tooth {
            TrainTooth::Sun(number) => (&gears.sun, number),
            TrainTooth::Planet(own, number) => {
                self.planet(own)?;
                (&gears.planet, number)
            }
            TrainTooth::Ring(number) => (&gears.ring, number),
        };
        let teeth = gear.teeth();
        if number >= teeth {
            return Err(TrainError::NoSuch { what: "tooth", number: number as usize, count: teeth as usize });
        }
        let number = i64::from(number);
        let pair = match (site, tooth) {
            (MeshSite::SunPlanet, TrainTooth::Sun(_)) => Some(-number),
            (MeshSite::SunPlanet, TrainTooth::Planet(own, _)) if own == planet => Some(number + with_sun),
            (MeshSite::PlanetRing, TrainTooth::Planet(own, _)) if own == planet => Some(number + with_ring),
            (MeshSite::PlanetRing, TrainTooth::Ring(_)) => Some(number),
            _ => None,
        };
        Ok(pair.map(|pair| (pair.rem_euclid(i64::from(teeth)), teeth)))
    }

    /// When a tooth touches at a pitch point, in a range of turns of the carrier against the ring from rest; in the order of time.
    ///
    /// # Errors
    /// [`TrainError::NoSuch`] planet or tooth, [`TrainError::NotFinite`] range, [`TrainError::TooManyEngagements`].
    pub fn engagements(&self, tooth: TrainTooth, turns: Range<f64>) -> Result<Vec<Engagement>, TrainError> {
        if let Some(&value) = [turns.start, turns.end].iter().find(|turn| !turn.is_finite()) {
            return Err(TrainError::NotFinite { quantity: "carrier turns", value });
        }
        let per_turn = self.cycles_per_carrier_turn();
        // as if a tooth met each planet every cycle, from rest on
        let farthest = turns.start.abs().max(turns.end.abs());
        let count = 2.0 * self.planets() as f64 * per_turn * farthest;
        if count > MOST_ENGAGEMENTS {
            return Err(TrainError::TooManyEngagements { count, most: MOST_ENGAGEMENTS });
        }
        let mut engagements = Vec::new();
        for site in MeshSite::ALL {
            for planet in 0..self.planets() {
                let Some((first, period)) = self.pairs_of_tooth(site, planet, tooth)? else { continue };
                let offset = self.mesh_offset(site, planet)?;
                let period = f64::from(period);
                let from = ((turns.start * per_turn + offset - first as f64) / period).ceil() as i64;
                let meetings = (from..).map(|count| first + count * period as i64).map(|pair| {
                    let carrier_turns = (pair as f64 - offset) / per_turn;
                    Engagement { carrier_turns, planet, site, pair }
                });
                engagements.extend(meetings.take_while(|meeting| meeting.carrier_turns < turns.end));
            }
        }
        engagements.sort_by(|a, b| a.carrier_turns.total_cmp(&b.carrier_turns));
        Ok(engagements)
    }

    /// Turns of the carrier against the ring after which every tooth is where it was, and with the same mates.
    #[must_use]
    pub fn hunting_period(&self) -> u64 {
        let [sun, planet] = [&self.spec.sun, &self.spec.planet].map(|gear| self.return_period(gear));
        lcm(sun, planet)
    }

    /// Turns of the carrier against the ring after which sun, carrier and ring are where they were.
    #[must_use]
    pub fn sun_ring_period(&self) -> u64 {
        self.return_period(&self.spec.sun)
    }

    /// Least whole number of carrier turns in which a gear makes a whole number of turns against the carrier.
    fn return_period(&self, gear: &Gear) -> u64 {
        let (teeth, ring) = (u64::from(gear.teeth()), u64::from(self.spec.ring.teeth()));
        teeth / gcd(teeth, ring)
    }

    /// Speeds of all parts from those of two (rad/s): `Z_s (w_s - w_c) = -Z_r (w_r - w_c) = -Z_p (w_p - w_c)` (R. Willis, *Principles of Mechanism*, 1870).
    ///
    /// # Errors
    /// [`TrainError::SpeedsUndetermined`] for one part given twice, [`TrainError::NotFinite`].
    pub fn speeds(&self, given: [(CentralMember, f64); 2]) -> Result<TrainSpeeds, TrainError> {
        if let Some(&(_, value)) = given.iter().find(|(_, speed)| !speed.is_finite()) {
            return Err(TrainError::NotFinite { quantity: "speed", value });
        }
        if given[0].0 == given[1].0 {
            return Err(TrainError::SpeedsUndetermined(given[0].0));
        }
        let of = |member| given.iter().find(|(known, _)| *known == member).map(|(_, speed)| *speed);
        let [z_s, z_p, z_r] = [&self.spec.sun, &self.spec.planet, &self.spec.ring].map(|gear| f64::from(gear.teeth()));
        // the third from two: Z_s w_s + Z_r w_r = (Z_s + Z_r) w_c
        let carrier = |sun: f64, ring: f64| (z_s * sun + z_r * ring) / (z_s + z_r);
        let (sun, carrier, ring) = match (of(CentralMember::Sun), of(CentralMember::Carrier), of(CentralMember::Ring)) {
            (Some(sun), Some(carrier), _) => (sun, carrier, ((z_s + z_r) * carrier - z_s * sun) / z_r),
            (Some(sun), None, ring) => (sun, carrier(sun, ring.unwrap_or(0.0)), ring.unwrap_or(0.0)),
            (None, carrier, ring) => {
                let (carrier, ring) = (carrier.unwrap_or(0.0), ring.unwrap_or(0.0));
                (((z_s + z_r) * carrier - z_r * ring) / z_s, carrier, ring)
            }
        };
        let planet = carrier - z_s / z_p * (sun - carrier);
        let passing = (carrier - ring).abs() / TAU;
        Ok(TrainSpeeds {
            sun,
            carrier,
            ring,
            planet,
            mesh_frequency: z_r * passing,
            planet_pass_frequency: self.planets() as f64 * passing,
        })
    }
}

/// Assembly, and room between the planets.
fn check_places(spec: &PlanetaryTrainSpec) -> Result<(), TrainError> {
    let angles = &spec.planet_angles;
    let (sun_teeth, ring_teeth) = (spec.sun.teeth(), spec.ring.teeth());
    let step = TAU / f64::from(sun_teeth + ring_teeth);
    for (planet, &angle) in angles.iter().enumerate() {
        let steps = (angle - angles[0]) / step;
        if (steps - steps.round()).abs() > ASSEMBLY_TOLERANCE {
            let nearest = angles[0] + steps.round() * step;
            return Err(TrainError::Assembly { planet, angle, sun_teeth, ring_teeth, step, nearest });
        }
    }
    for second in 1..angles.len() {
        for first in 0..second {
            let apart = 2.0 * spec.centre_distance * (0.5 * (angles[second] - angles[first])).rem_euclid(PI).sin();
            let overlap = 2.0 * spec.planet.tip_radius() - apart;
            if overlap > 0.0 {
                return Err(TrainError::Collision { first, second, overlap });
            }
        }
    }
    Ok(())
}
