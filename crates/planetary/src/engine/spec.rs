//! What a transmission is made of, in plain numbers.
//!
//! Frame: `z` along the main axis, angles counter-clockwise seen from `+z`; the ring stands, sun and carrier turn counter-clockwise. Everything SI.

use std::fmt;
use std::sync::Arc;

use crate::elastic::ElasticBody;
use crate::mesh::MeshLaw;

/// A body of the transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum BodyId {
    /// The sun, with everything rigidly joined to it.
    Sun,
    /// A planet, from 0.
    Planet(usize),
    /// The carrier with its pins.
    Carrier,
    /// The bevel gear with its shaft, where it is a body of its own.
    BevelGear,
    /// The bevel pinion with its shaft.
    BevelPinion,
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sun => write!(f, "sun"),
            Self::Planet(index) => write!(f, "planet {}", index + 1),
            Self::Carrier => write!(f, "carrier"),
            Self::BevelGear => write!(f, "bevel gear"),
            Self::BevelPinion => write!(f, "bevel pinion"),
        }
    }
}

/// A rigid body that spins about an axis of symmetry. A planet's position and axis are those of the stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBody {
    /// Centre of mass (m).
    pub position: [f64; 3],
    /// Direction of its axis, unit vector.
    pub axis: [f64; 3],
    /// kg.
    pub mass: f64,
    /// Moment of inertia about the axis (kg m^2).
    pub polar: f64,
    /// Moment of inertia about a diameter through the centre of mass (kg m^2).
    pub transverse: f64,
    /// Turns about the axis per turn of the carrier, for gyroscopic moments.
    pub spin_ratio: f64,
}

/// Coast flanks of a mesh.
#[derive(Debug, Clone)]
pub struct CoastFlank {
    /// Force over approach of the coast flanks.
    pub law: Arc<dyn MeshLaw>,
    /// Mesh cycle of the coast flanks where nothing has travelled yet; it runs backwards from there.
    pub cycle_offset: f64,
    /// Backlash along the line of action (m), 0 or more.
    pub backlash: f64,
}

/// A mesh.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Force over approach.
    pub law: Arc<dyn MeshLaw>,
    /// Mesh cycle where nothing has travelled yet.
    pub cycle_offset: f64,
    /// Damping in contact (N s/m).
    pub damping: f64,
    /// Force from which on the damping is full (N), positive; below, it falls in proportion, so that touching is no jump.
    pub damping_force: f64,
    /// Coast flanks, where the other side can touch.
    pub coast: Option<CoastFlank>,
}

/// A planet.
#[derive(Debug, Clone)]
pub struct Planet {
    /// Angle about the main axis where nothing has travelled yet (rad).
    pub angle: f64,
    /// kg.
    pub mass: f64,
    /// Moment of inertia about its axis (kg m^2).
    pub polar: f64,
    /// Moment of inertia about a diameter (kg m^2).
    pub transverse: f64,
    /// Turns per turn of the carrier in the standing frame, `1 - Z_r / Z_p`.
    pub spin_ratio: f64,
    /// Stiffness against the carrier's pin: radial, tangential, axial (N/m), tilt about the radial and tangential direction (N m/rad); 0 to infinity.
    /// Nothing holds the rotation.
    pub bearing_stiffness: [f64; 5],
    /// Its damping (N s/m, N m s/rad).
    pub bearing_damping: [f64; 5],
    /// Mesh with the sun.
    pub sun_mesh: Mesh,
    /// Mesh with the ring.
    pub ring_mesh: Mesh,
}

/// The planetary stage. Its ring stands in the ring seat of the housing, or stands still where there is none.
#[derive(Debug, Clone)]
pub struct PlanetaryStage {
    /// Teeth of the ring: mesh cycles per turn of the carrier.
    pub ring_teeth: u32,
    /// Distance of the planets' axes from the main axis (m).
    pub centre_distance: f64,
    /// Height of the gears' mid-planes (m).
    pub height: f64,
    /// Base radius (m).
    pub sun_base_radius: f64,
    /// Base radius (m).
    pub planet_base_radius: f64,
    /// Base radius (m).
    pub ring_base_radius: f64,
    /// Operating pressure angle of sun and planet (rad).
    pub sun_pressure_angle: f64,
    /// Operating pressure angle of planet and ring (rad).
    pub ring_pressure_angle: f64,
    /// Planets, one or more.
    pub planets: Vec<Planet>,
}

/// A bevel stage before the sun. Its coast flanks push along the same line, backwards.
#[derive(Debug, Clone)]
pub struct BevelStage {
    /// Pinion with its shaft.
    pub pinion: RigidBody,
    /// Gear with its shaft, joined to the sun by a [`Bearing`]; none where it is rigid with the sun.
    pub gear: Option<RigidBody>,
    /// Mesh.
    pub mesh: Mesh,
    /// Where the line of action passes (m).
    pub point: [f64; 3],
    /// Direction of the pinion's force on the gear, unit vector.
    pub normal: [f64; 3],
    /// Mesh cycles per turn of the carrier.
    pub cycles_per_turn: f64,
}

/// What the far side of a bearing is fixed to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Anchor {
    /// Something that does not move.
    Ground,
    /// A port of the housing, by name.
    Port(String),
    /// Another body.
    Body(BodyId),
}

/// A bearing, spline or mount in standing axes: six springs and dampers between two frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Bearing {
    /// Name.
    pub name: String,
    /// The body it holds.
    pub body: BodyId,
    /// What holds the body.
    pub anchor: Anchor,
    /// Where (m).
    pub position: [f64; 3],
    /// Directions of its axes, orthonormal, a row each.
    pub axes: [[f64; 3]; 3],
    /// Stiffness along (N/m) and about (N m/rad) the axes, 0 to infinity.
    pub stiffness: [f64; 6],
    /// Damping along (N s/m) and about (N m s/rad) the axes.
    pub damping: [f64; 6],
}

/// A transmission.
#[derive(Debug, Clone)]
pub struct TransmissionSpec {
    /// Planetary stage.
    pub stage: PlanetaryStage,
    /// Sun.
    pub sun: RigidBody,
    /// Carrier.
    pub carrier: RigidBody,
    /// Bevel stage.
    pub bevel: Option<BevelStage>,
    /// Bearings in standing axes; those of the planets are theirs.
    pub bearings: Vec<Bearing>,
    /// Housing; without it all ports are missing and the ring stands still.
    pub housing: Option<ElasticBody>,
    /// Body whose rotation is prescribed: it turns evenly. None where the input is free, which leaves no equilibrium under load.
    pub drive: Option<BodyId>,
}

impl TransmissionSpec {
    /// Bodies in the order of their coordinates.
    #[must_use]
    pub fn body_ids(&self) -> Vec<BodyId> {
        let mut ids = vec![BodyId::Sun, BodyId::Carrier];
        ids.extend((0..self.stage.planets.len()).map(BodyId::Planet));
        if let Some(bevel) = &self.bevel {
            ids.push(BodyId::BevelPinion);
            if bevel.gear.is_some() {
                ids.push(BodyId::BevelGear);
            }
        }
        ids
    }

    /// A body; for planets with nothing travelled.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<RigidBody> {
        match id {
            BodyId::Sun => Some(self.sun),
            BodyId::Carrier => Some(self.carrier),
            BodyId::BevelPinion => self.bevel.as_ref().map(|bevel| bevel.pinion),
            BodyId::BevelGear => self.bevel.as_ref().and_then(|bevel| bevel.gear),
            BodyId::Planet(index) => self.stage.planets.get(index).map(|planet| {
                let (sin, cos) = planet.angle.sin_cos();
                let radius = self.stage.centre_distance;
                RigidBody {
                    position: [radius * cos, radius * sin, self.stage.height],
                    axis: [0.0, 0.0, 1.0],
                    mass: planet.mass,
                    polar: planet.polar,
                    transverse: planet.transverse,
                    spin_ratio: planet.spin_ratio,
                }
            }),
        }
    }
}
