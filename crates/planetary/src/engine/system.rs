//! Bodies and connections as matrices.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::dense::dot;
use super::rows::{HousingPart, Part, RIGID, Row, SeatPart, SpurLine, arm};
use super::spec::{Anchor, Bearing, BodyId, Mesh, RigidBody, TransmissionSpec};
use crate::elastic::{ElasticBody, Port};
use crate::error::PlanetaryError;
use crate::mesh::MeshLaw;

/// Mass properties of a rigid body in standing axes.
#[derive(Debug, Clone)]
pub(super) struct Inertia {
    pub mass: f64,
    pub axis: [f64; 3],
    pub polar: f64,
    pub transverse: f64,
    /// Moments of inertia in standing axes (kg m^2).
    pub tensor: [[f64; 3]; 3],
    /// Moment by rate of tilt per speed of the carrier: `-I_p (spin ratio) [axis]x`, on the side of the masses.
    pub gyroscopic: [[f64; 3]; 3],
    /// Distance from the main axis and angle of a body carried around, for the centrifugal force.
    pub carried: Option<(f64, f64)>,
}

impl Inertia {
    fn new(body: &RigidBody, carried: Option<(f64, f64)>) -> Self {
        let a = body.axis;
        let spin = -body.polar * body.spin_ratio;
        let tensor = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (body.polar - body.transverse) * a[i] * a[j] + if i == j { body.transverse } else { 0.0 }
            })
        });
        let gyroscopic =
            [[0.0, -spin * a[2], spin * a[1]], [spin * a[2], 0.0, -spin * a[0]], [-spin * a[1], spin * a[0], 0.0]];
        let RigidBody { mass, axis, polar, transverse, .. } = *body;
        Self { mass, axis, polar, transverse, tensor, gyroscopic, carried }
    }

    /// Masses times a vector of accelerations.
    pub fn times(&self, x: [f64; RIGID]) -> [f64; RIGID] {
        let rotation = |i: usize| (0..3).map(|j| self.tensor[i][j] * x[3 + j]).sum::<f64>();
        [self.mass * x[0], self.mass * x[1], self.mass * x[2], rotation(0), rotation(1), rotation(2)]
    }
}

/// Spring and damper of a bilateral connection.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spring {
    /// 0 to infinity.
    pub stiffness: f64,
    pub damping: f64,
}

/// One side of the teeth of a mesh.
#[derive(Debug, Clone)]
pub(super) struct Flank {
    pub law: Arc<dyn MeshLaw>,
    pub cycle_offset: f64,
    /// Mesh cycles per mesh cycle of the planetary stage; negative on coast flanks.
    pub cycle_rate: f64,
    pub damping: f64,
    pub damping_force: f64,
    /// What the approach lacks.
    pub backlash: f64,
}

impl Flank {
    /// Its mesh cycle with mesh cycles of the planetary stage travelled.
    pub fn cycle_at(&self, travelled: f64) -> f64 {
        self.cycle_offset + self.cycle_rate * travelled
    }
}

/// Rows of a bearing; none where nothing holds.
#[derive(Debug, Clone)]
pub(super) struct BearingRows {
    pub name: String,
    pub rows: [Option<usize>; 6],
}

/// Flanks of a mesh.
#[derive(Debug, Clone)]
pub(super) struct MeshRows {
    pub name: String,
    pub drive: usize,
    pub coast: Option<usize>,
}

/// Motions of the housing that connections know, a row of modal coefficients each: of bearings, then harmonics of the ring seat.
#[derive(Debug, Clone, Default)]
pub(super) struct Interfaces {
    pub count: usize,
    pub modes: usize,
    pub rows: Vec<f64>,
    /// First of the seat.
    pub seat: usize,
    pub harmonics: usize,
}

impl Interfaces {
    pub fn row(&self, index: usize) -> &[f64] {
        &self.rows[index * self.modes..(index + 1) * self.modes]
    }

    /// Motion of every interface.
    pub fn motion(&self, modal: &[f64], out: &mut [f64]) {
        for (index, out) in out.iter_mut().enumerate() {
            *out = dot(self.row(index), modal);
        }
    }
}

/// A transmission as matrices.
#[derive(Debug, Clone)]
pub(super) struct System {
    pub ids: Vec<BodyId>,
    pub inertia: Vec<Inertia>,
    pub carrier: usize,
    pub frequencies: Vec<f64>,
    pub damping_ratios: Vec<f64>,
    pub interfaces: Interfaces,
    /// Of springs, then of flanks.
    pub rows: Vec<Row>,
    pub springs: Vec<Spring>,
    pub flanks: Vec<Flank>,
    pub bearings: Vec<BearingRows>,
    pub meshes: Vec<MeshRows>,
    /// Row of the prescribed rotation.
    pub drive: Option<usize>,
    pub ring_teeth: f64,
    /// Base pitch of the planetary stage (m).
    pub base_pitch: f64,
    pub sensors: Vec<(String, Vec<f64>)>,
}

impl System {
    pub fn rigid(&self) -> usize {
        RIGID * self.ids.len()
    }

    pub fn size(&self) -> usize {
        self.rigid() + self.frequencies.len()
    }

    /// Assembles a checked specification.
    pub fn new(spec: &TransmissionSpec) -> Result<Self, PlanetaryError> {
        let ids = spec.body_ids();
        let mut inertia = Vec::with_capacity(ids.len());
        let mut places = BTreeMap::new();
        for &id in &ids {
            let Some(body) = spec.body(id) else { continue };
            let carried = match id {
                BodyId::Planet(index) => Some((spec.stage.centre_distance, spec.stage.planets[index].angle)),
                _ => None,
            };
            places.insert(id, (inertia.len(), body));
            inertia.push(Inertia::new(&body, carried));
        }
        let housing = spec.housing.as_ref();
        let mut builder = Builder { places, housing, rows: Vec::new(), springs: Vec::new(), interfaces: Vec::new() };
        let mut bearings = builder.planet_bearings(spec);
        for bearing in &spec.bearings {
            bearings.push(builder.bearing(bearing)?);
        }
        let drive = spec.drive.and_then(|id| builder.hold_rotation(id));
        let seat = builder.interfaces.len();
        let mut flanks = Flanks::default();
        builder.meshes(spec, &mut flanks);
        if let Some(seat) = housing.and_then(|housing| housing.ring_seat.as_ref()) {
            let rows = 2 * (2 * seat.harmonics + 1);
            builder.interfaces.extend((0..rows).map(|row| seat.shapes.row(row).iter().copied().collect()));
        }
        let mut rows = builder.rows;
        let mut sides = flanks.drive;
        let coast_start = sides.len();
        sides.extend(flanks.coast);
        let mut meshes = flanks.meshes;
        for mesh in &mut meshes {
            mesh.coast = mesh.coast.map(|index| coast_start + index);
        }
        let (side_rows, sides): (Vec<_>, Vec<_>) = sides.into_iter().unzip();
        rows.extend(side_rows);
        Ok(Self {
            carrier: builder.places.get(&BodyId::Carrier).map_or(0, |place| place.0),
            inertia,
            frequencies: housing.map_or_else(Vec::new, |housing| housing.frequencies.clone()),
            damping_ratios: housing.map_or_else(Vec::new, |housing| housing.damping_ratios.clone()),
            interfaces: Interfaces {
                count: builder.interfaces.len(),
                modes: housing.map_or(0, |housing| housing.frequencies.len()),
                rows: builder.interfaces.concat(),
                seat,
                harmonics: housing.and_then(|housing| housing.ring_seat.as_ref()).map_or(0, |seat| seat.harmonics),
            },
            rows,
            springs: builder.springs,
            flanks: sides,
            bearings,
            meshes,
            drive,
            ring_teeth: f64::from(spec.stage.ring_teeth),
            base_pitch: std::f64::consts::TAU * spec.stage.ring_base_radius / f64::from(spec.stage.ring_teeth),
            sensors: housing
                .map(|housing| {
                    housing.sensors.iter().map(|sensor| (sensor.name.clone(), sensor.shape.clone())).collect()
                })
                .unwrap_or_default(),
            ids,
        })
    }
}

/// Rows and sides of meshes.
#[derive(Default)]
struct Flanks {
    drive: Vec<(Row, Flank)>,
    coast: Vec<(Row, Flank)>,
    meshes: Vec<MeshRows>,
}

impl Flanks {
    fn add(&mut self, name: String, mesh: &Mesh, cycle_rate: f64, row: impl Fn(f64) -> Row) {
        let flank = |law: &Arc<dyn MeshLaw>, cycle_offset, cycle_rate, backlash| Flank {
            law: Arc::clone(law),
            cycle_offset,
            cycle_rate,
            damping: mesh.damping,
            damping_force: mesh.damping_force,
            backlash,
        };
        let coast = mesh.coast.as_ref().map(|coast| {
            self.coast.push((row(-1.0), flank(&coast.law, coast.cycle_offset, -cycle_rate, coast.backlash)));
            self.coast.len() - 1
        });
        self.meshes.push(MeshRows { name, drive: self.drive.len(), coast });
        self.drive.push((row(1.0), flank(&mesh.law, mesh.cycle_offset, cycle_rate, 0.0)));
    }
}

struct Builder<'a> {
    places: BTreeMap<BodyId, (usize, RigidBody)>,
    housing: Option<&'a ElasticBody>,
    rows: Vec<Row>,
    springs: Vec<Spring>,
    interfaces: Vec<Vec<f64>>,
}

impl Builder<'_> {
    /// A bilateral row, unless nothing holds it.
    fn spring(&mut self, stiffness: f64, damping: f64, row: Row) -> Option<usize> {
        if stiffness == 0.0 && damping == 0.0 {
            return None;
        }
        self.rows.push(row);
        self.springs.push(Spring { stiffness, damping });
        Some(self.springs.len() - 1)
    }

    /// Planets on the carrier's pins, in axes that turn.
    fn planet_bearings(&mut self, spec: &TransmissionSpec) -> Vec<BearingRows> {
        let Some(&(carrier, carrier_body)) = self.places.get(&BodyId::Carrier) else { return Vec::new() };
        let mut bearings = Vec::new();
        for (index, planet) in spec.stage.planets.iter().enumerate() {
            let id = BodyId::Planet(index);
            let Some(&(body, place)) = self.places.get(&id) else { continue };
            let (sin, cos) = planet.angle.sin_cos();
            let pin = arm(place.position, carrier_body.position);
            let axes = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
            let mut rows = [None; 6];
            for k in 0..5 {
                let parts = if k < 3 {
                    vec![
                        Part::along(body, 1.0, axes[k], [0.0; 3], true),
                        Part::along(carrier, -1.0, axes[k], pin, true),
                    ]
                } else {
                    vec![Part::about(body, 1.0, axes[k - 3], true), Part::about(carrier, -1.0, axes[k - 3], true)]
                };
                let row = Row { parts, housing: HousingPart::None };
                rows[k] = self.spring(planet.bearing_stiffness[k], planet.bearing_damping[k], row);
            }
            bearings.push(BearingRows { name: id.to_string(), rows });
        }
        bearings
    }

    fn bearing(&mut self, bearing: &Bearing) -> Result<BearingRows, PlanetaryError> {
        let missing = |name: String| PlanetaryError::Missing {
            what: format!("bearing `{}`", bearing.name),
            name,
            there: self.places.keys().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        };
        let place = |id: BodyId| self.places.get(&id).copied().ok_or_else(|| missing(id.to_string()));
        let (body, own) = place(bearing.body)?;
        let other = match &bearing.anchor {
            Anchor::Body(id) => Some(place(*id)?),
            Anchor::Ground | Anchor::Port(_) => None,
        };
        let port = match &bearing.anchor {
            Anchor::Port(name) => {
                let found = self.housing.and_then(|housing| housing.ports.iter().find(|port| port.name == *name));
                Some(found.ok_or_else(|| missing(name.clone()))?)
            }
            Anchor::Ground | Anchor::Body(_) => None,
        };
        let mut rows = [None; 6];
        for (k, row) in rows.iter_mut().enumerate() {
            let axis = bearing.axes[k % 3];
            let part = |body: usize, sign: f64, centre: [f64; 3]| {
                if k < 3 {
                    Part::along(body, sign, axis, arm(bearing.position, centre), false)
                } else {
                    Part::about(body, sign, axis, false)
                }
            };
            let (stiffness, damping) = (bearing.stiffness[k], bearing.damping[k]);
            if stiffness == 0.0 && damping == 0.0 {
                continue;
            }
            let mut parts = vec![part(body, 1.0, own.position)];
            parts.extend(other.map(|(index, place)| part(index, -1.0, place.position)));
            let housing = match port {
                None => HousingPart::None,
                Some(port) => {
                    self.interfaces.push(port_motion(port, bearing, k));
                    HousingPart::Interface(self.interfaces.len() - 1)
                }
            };
            *row = self.spring(stiffness, damping, Row { parts, housing });
        }
        Ok(BearingRows { name: bearing.name.clone(), rows })
    }

    fn hold_rotation(&mut self, id: BodyId) -> Option<usize> {
        let &(body, place) = self.places.get(&id)?;
        let row = Row { parts: vec![Part::about(body, 1.0, place.axis, false)], housing: HousingPart::None };
        self.spring(f64::INFINITY, 0.0, row)
    }

    fn meshes(&self, spec: &TransmissionSpec, flanks: &mut Flanks) {
        let stage = &spec.stage;
        let seat = self.housing.and_then(|housing| housing.ring_seat.as_ref());
        let planets = || {
            stage.planets.iter().enumerate().filter_map(|(index, planet)| {
                let id = BodyId::Planet(index);
                self.places.get(&id).map(|place| (id, planet, place.0))
            })
        };
        if let Some(&(sun, sun_body)) = self.places.get(&BodyId::Sun) {
            for (id, planet, body) in planets() {
                flanks.add(format!("sun-{id}"), &planet.sun_mesh, 1.0, |side| {
                    let line = SpurLine::sun(stage.sun_pressure_angle, side);
                    let height = stage.height - sun_body.position[2];
                    let parts = vec![
                        line.part(body, -1.0, planet.angle, -side * stage.planet_base_radius, 0.0),
                        line.part(sun, 1.0, planet.angle, side * stage.sun_base_radius, height),
                    ];
                    Row { parts, housing: HousingPart::None }
                });
            }
        }
        for (id, planet, body) in planets() {
            flanks.add(format!("ring-{id}"), &planet.ring_mesh, 1.0, |side| {
                let line = SpurLine::ring(stage.ring_pressure_angle, side);
                let parts = vec![line.part(body, -1.0, planet.angle, side * stage.planet_base_radius, 0.0)];
                let housing = seat.map_or(HousingPart::None, |seat| {
                    let rho = stage.ring_base_radius / stage.ring_pressure_angle.cos();
                    HousingPart::Seat(SeatPart {
                        angle: planet.angle,
                        radial: line.radial,
                        tangential: line.tangential,
                        radius_ratio: rho / seat.radius,
                    })
                });
                Row { parts, housing }
            });
        }
        let Some(bevel) = &spec.bevel else { return };
        let gear = if bevel.gear.is_some() { BodyId::BevelGear } else { BodyId::Sun };
        let (Some(&(pinion, pinion_body)), Some(&(gear, gear_body))) =
            (self.places.get(&BodyId::BevelPinion), self.places.get(&gear))
        else {
            return;
        };
        flanks.add("bevel".into(), &bevel.mesh, bevel.cycles_per_turn / f64::from(stage.ring_teeth), |side| {
            let on =
                |body, sign: f64, centre| Part::along(body, side * sign, bevel.normal, arm(bevel.point, centre), false);
            let parts = vec![on(pinion, 1.0, pinion_body.position), on(gear, -1.0, gear_body.position)];
            Row { parts, housing: HousingPart::None }
        });
    }
}

/// Motion of a port along or about an axis of a bearing, at the bearing's place.
fn port_motion(port: &Port, bearing: &Bearing, k: usize) -> Vec<f64> {
    let axis = bearing.axes[k % 3];
    let row = if k < 3 {
        Part::along(0, 1.0, axis, arm(bearing.position, port.position), false).row
    } else {
        Part::about(0, 1.0, axis, false).row
    };
    (0..port.shapes.ncols()).map(|mode| dot(&row, port.shapes.col_as_slice(mode))).collect()
}
