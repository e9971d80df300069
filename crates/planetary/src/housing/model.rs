//! A housing: mesh, what holds it, and where others hold on to it; its reduction to an elastic body.

use faer::Mat;
use fecm::linalg::column_slice;
use nalgebra::{Matrix3, Vector3};

use super::assembly::{NodeSpring, Structure};
use super::error::HousingError;
use super::mesh::SolidMesh;
use super::reading::Reading;
use super::reduce::reduce;
use super::surface::Surface;
use crate::elastic::{ElasticBody, Port, RingSeat, Sensor};

/// A mount: a node set tied to the ground, everywhere alike.
#[derive(Debug, Clone, PartialEq)]
pub struct Mount {
    /// Node set.
    pub set: String,
    /// How it is tied.
    pub tie: Tie,
}

/// Tie of a mount to the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tie {
    /// Nodes do not move.
    Fixed,
    /// Springs spread over the set by its nodes' shares of the surface: stiffness (N/m) of all of them together along the radius (from the
    /// `z` axis to the middle of the set), the tangent, and `z`.
    Springs([f64; 3]),
}

/// A place where others hold on to the housing.
#[derive(Debug, Clone, PartialEq)]
pub struct PortPlace {
    /// Name of the port, and of its node set.
    pub name: String,
    /// Where its frame is (m); the middle of the set if absent.
    pub position: Option<[f64; 3]>,
}

/// Where the ring's teeth sit.
#[derive(Debug, Clone, PartialEq)]
pub struct SeatPlace {
    /// Node set, on a circle about `z`.
    pub set: String,
    /// Highest harmonic of the angle.
    pub harmonics: usize,
}

/// A sensor to be placed.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorPlace {
    /// Name.
    pub name: String,
    /// Where.
    pub at: SensorAt,
    /// What it senses (need not be of unit length); radially outward if absent.
    pub direction: Option<[f64; 3]>,
}

/// Place of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorAt {
    /// On the outermost wall at an angle about `z` (rad) and a height (m).
    Wall {
        /// Angle from `x` (rad).
        angle: f64,
        /// Height (m).
        z: f64,
    },
    /// At the node of the surface nearest to a place (m).
    Nearest([f64; 3]),
}

/// Damping of the coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// The same ratio for all.
    Ratio(f64),
    /// `zeta = mass / (2 omega) + stiffness omega / 2`.
    Rayleigh {
        /// Coefficient of the mass matrix (1/s).
        mass: f64,
        /// Coefficient of the stiffness matrix (s).
        stiffness: f64,
    },
}

impl Damping {
    /// Damping ratio at a circular frequency (rad/s).
    #[must_use]
    pub fn ratio(self, frequency: f64) -> f64 {
        match self {
            Self::Ratio(ratio) => ratio,
            Self::Rayleigh { mass, stiffness } => 0.5 * (mass / frequency + stiffness * frequency),
        }
    }
}

/// How much of the housing's motion is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionOptions {
    /// Modes kept at most; default 200.
    pub modes: usize,
    /// Modes above this frequency (Hz) are kept as static response only; default 12 kHz.
    pub highest_frequency: f64,
    /// Damping; default a ratio of 0.02.
    pub damping: Damping,
}

impl Default for ReductionOptions {
    fn default() -> Self {
        Self { modes: 200, highest_frequency: 12e3, damping: Damping::Ratio(0.02) }
    }
}

/// A housing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Housing {
    /// Mesh.
    pub mesh: SolidMesh,
    /// What holds it.
    pub mounts: Vec<Mount>,
    /// Where others hold on to it.
    pub ports: Vec<PortPlace>,
    /// Where the ring sits.
    pub seat: Option<SeatPlace>,
    /// Sensors.
    pub sensors: Vec<SensorPlace>,
}

/// A reduced housing and what it took.
#[derive(Debug, Clone)]
pub struct ReducedHousing {
    /// For the transmission.
    pub body: ElasticBody,
    /// Displacements of all nodes (three rows each, zero where fixed) per unit of each coordinate of the body.
    pub shapes: Mat<f64>,
    /// Numbers for the report.
    pub stats: ReductionStats,
}

/// Numbers of a reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionStats {
    /// Unknowns of the structure.
    pub unknowns: usize,
    /// Entries of the factor.
    pub factor_entries: usize,
    /// Eigenmodes among the coordinates.
    pub modes: usize,
    /// The spectrum is complete up to this frequency (Hz): that of the highest mode found.
    pub complete_to: f64,
    /// Coordinates of static response.
    pub attachments: usize,
}

impl Housing {
    /// Assembles and factors the structure.
    ///
    /// # Errors
    /// As [`Structure::new`]; [`HousingError::Value`] of a negative spring.
    pub fn structure(&self) -> Result<Structure, HousingError> {
        let surface = Surface::new(&self.mesh);
        let (mut springs, mut fixed) = (Vec::new(), Vec::new());
        for mount in &self.mounts {
            let set = self.mesh.set(&mount.set)?;
            match mount.tie {
                Tie::Fixed => fixed.extend_from_slice(set),
                Tie::Springs(stiffness) => {
                    if let Some(&value) = stiffness.iter().find(|k| !(**k >= 0.0 && k.is_finite())) {
                        let name = "mount stiffness";
                        return Err(HousingError::Value { name, value, allowed: "a number of N/m, at least 0" });
                    }
                    let shares = surface.shares(&self.mesh, set);
                    let matrix = turned(stiffness, self.middle(set, &shares));
                    let spring = |(&node, share): (&u32, &f64)| NodeSpring { node, stiffness: matrix * *share };
                    springs.extend(set.iter().zip(&shares).map(spring));
                }
            }
        }
        Structure::new(&self.mesh, &springs, &fixed)
    }

    fn middle(&self, set: &[u32], shares: &[f64]) -> Vector3<f64> {
        set.iter().zip(shares).map(|(&node, share)| *share * self.mesh.node(node)).sum()
    }

    /// Reduces the housing to modes and static responses.
    ///
    /// # Errors
    /// [`HousingError`] of the mesh, sets, sensors, or algebra.
    pub fn reduce(&self, options: &ReductionOptions) -> Result<ReducedHousing, HousingError> {
        options.validate()?;
        let structure = self.structure()?;
        let surface = Surface::new(&self.mesh);
        let mut loads = Mat::zeros(3 * structure.free_nodes().len(), 0);
        let mut add = |reading: &Reading| fecm::modes::krylov::append(&mut loads, &reading.loads(&structure));
        let mut ports = Vec::with_capacity(self.ports.len());
        for place in &self.ports {
            let set = self.mesh.set(&place.name)?;
            let position = place.position.unwrap_or_else(|| self.middle(set, &surface.shares(&self.mesh, set)).into());
            let reading = Reading::frame(&self.mesh, &surface, &place.name, position)?;
            add(&reading);
            ports.push((place.name.clone(), position, reading));
        }
        let mut seat = None;
        if let Some(place) = &self.seat {
            let (reading, circle) = Reading::harmonics(&self.mesh, &surface, &place.set, place.harmonics)?;
            add(&reading);
            seat = Some((place.harmonics, circle, reading));
        }
        let sensors = self.sensors.iter().map(|place| self.sensor(&surface, place)).collect::<Result<Vec<_>, _>>()?;
        let limit = std::f64::consts::TAU * options.highest_frequency;
        let reduced = reduce(&structure, &loads, options.modes, limit)?;
        let shapes = |reading: &Reading| reading.of(&structure, &reduced.shapes);
        let body = ElasticBody {
            damping_ratios: reduced.frequencies.iter().map(|&frequency| options.damping.ratio(frequency)).collect(),
            ports: ports
                .into_iter()
                .map(|(name, position, reading)| Port { name, position, shapes: shapes(&reading) })
                .collect(),
            ring_seat: seat.map(|(harmonics, circle, reading)| RingSeat {
                radius: circle.radius,
                z: circle.z,
                harmonics,
                shapes: shapes(&reading),
            }),
            sensors: sensors
                .into_iter()
                .map(|(sensor, reading)| {
                    let row = shapes(&reading);
                    Sensor { shape: (0..row.ncols()).map(|k| row[(0, k)]).collect(), ..sensor }
                })
                .collect(),
            frequencies: reduced.frequencies.clone(),
        };
        let stats = ReductionStats {
            unknowns: 3 * structure.free_nodes().len(),
            factor_entries: structure.factor_entries(),
            modes: reduced.modes,
            complete_to: reduced.complete_to / std::f64::consts::TAU,
            attachments: reduced.frequencies.len() - reduced.modes,
        };
        Ok(ReducedHousing { body, shapes: self.on_all_nodes(&structure, &reduced.shapes), stats })
    }

    fn on_all_nodes(&self, structure: &Structure, fields: &Mat<f64>) -> Mat<f64> {
        let mut all = Mat::zeros(3 * self.mesh.nodes.len(), fields.ncols());
        for k in 0..fields.ncols() {
            let (source, target) = (column_slice(fields, k), fecm::linalg::column_slice_mut(&mut all, k));
            for (number, &node) in structure.free_nodes().iter().enumerate() {
                target[3 * node as usize..][..3].copy_from_slice(&source[3 * number..][..3]);
            }
        }
        all
    }

    /// A sensor, its shape still empty, and what reads it.
    fn sensor(&self, surface: &Surface, place: &SensorPlace) -> Result<(Sensor, Reading), HousingError> {
        let (point, angle, height) = match place.at {
            SensorAt::Wall { angle, z } => (surface.outermost(&self.mesh, angle, z), angle, z),
            SensorAt::Nearest(at) => (surface.nearest_node(&self.mesh, at), at[1].atan2(at[0]), at[2]),
        };
        let point = point.ok_or_else(|| HousingError::NoWall { sensor: place.name.clone(), angle, height })?;
        let direction = place.direction.map_or(Vector3::new(angle.cos(), angle.sin(), 0.0), Vector3::from);
        let length = direction.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(HousingError::Value {
                name: "length of a sensor's direction",
                value: length,
                allowed: "more than 0",
            });
        }
        let direction = direction / length;
        let reading = Reading::sensor(&point, direction);
        let (name, position, direction) = (place.name.clone(), point.position, direction.into());
        Ok((Sensor { name, position, direction, shape: Vec::new() }, reading))
    }
}

impl ReductionOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`HousingError::Value`].
    pub fn validate(&self) -> Result<(), HousingError> {
        let value = |name, value, allowed| Err(HousingError::Value { name, value, allowed });
        if !(self.highest_frequency >= 0.0) {
            return value("highest_frequency", self.highest_frequency, "a frequency of Hz, at least 0");
        }
        let (numbers, name): (&[f64], _) = match &self.damping {
            Damping::Ratio(ratio) => (&[*ratio], "damping ratio"),
            Damping::Rayleigh { mass, stiffness } => (&[*mass, *stiffness], "Rayleigh coefficient"),
        };
        match numbers.iter().find(|number| !(**number >= 0.0 && number.is_finite())) {
            Some(&number) => value(name, number, "at least 0"),
            None => Ok(()),
        }
    }
}

/// Stiffness along radius, tangent and `z` at a place, in `x, y, z`.
fn turned(stiffness: [f64; 3], place: Vector3<f64>) -> Matrix3<f64> {
    let angle = place.y.atan2(place.x);
    let directions =
        [Vector3::new(angle.cos(), angle.sin(), 0.0), Vector3::new(-angle.sin(), angle.cos(), 0.0), Vector3::z()];
    directions.iter().zip(stiffness).map(|(d, k)| k * d * d.transpose()).sum()
}
