//! What a transmission's numbers must be.

use super::request::{RunRequest, TransmissionState, Turning};
use super::spec::{Anchor, Bearing, BevelStage, BodyId, Mesh, PlanetaryStage, RigidBody, TransmissionSpec};
use crate::elastic::ElasticBody;
use crate::error::PlanetaryError;

type Checked = Result<(), PlanetaryError>;

const POSITIVE: &str = "a positive number";
const NOT_NEGATIVE: &str = "0 or more";
const FINITE: &str = "a finite number";
/// How far directions may be from unit length and right angles.
const DIRECTION_TOLERANCE: f64 = 1e-6;
/// How far the centres of sun and carrier, about which their connections turn, may be from the main axis (m).
const ON_AXIS: f64 = 1e-9;
/// Radius of the ring's seat over the ring's base radius; a housing in another unit of length is far from it.
const SEAT_RATIO: std::ops::RangeInclusive<f64> = 0.25..=4.0;
const SEAT: &str = "0.25 to 4: are housing and gears in the same unit of length?";
const DIRECTION: &str = "unit vectors at right angles, to 1e-6";

fn positive(what: impl Fn() -> String, value: f64) -> Checked {
    PlanetaryError::check(value > 0.0 && value.is_finite(), what, value, POSITIVE)
}

fn not_negative(what: impl Fn() -> String, value: f64) -> Checked {
    PlanetaryError::check(value >= 0.0 && value.is_finite(), what, value, NOT_NEGATIVE)
}

fn finite(what: impl Fn() -> String, values: &[f64]) -> Checked {
    values.iter().try_for_each(|&value| PlanetaryError::check(value.is_finite(), &what, value, FINITE))
}

fn unit(what: impl Fn() -> String, vector: [f64; 3]) -> Checked {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    PlanetaryError::check((length - 1.0).abs() < DIRECTION_TOLERANCE, what, length, DIRECTION)
}

fn springs(what: impl Fn() -> String, stiffness: &[f64], damping: &[f64]) -> Checked {
    for &value in stiffness {
        PlanetaryError::check(value >= 0.0, || format!("{} stiffness", what()), value, "0 to infinity")?;
    }
    damping.iter().try_for_each(|&value| not_negative(|| format!("{} damping", what()), value))
}

impl RigidBody {
    fn check(&self, what: BodyId) -> Checked {
        let name = |part: &'static str| move || format!("{what}: {part}");
        positive(name("mass"), self.mass)?;
        positive(name("polar inertia"), self.polar)?;
        positive(name("transverse inertia"), self.transverse)?;
        finite(name("position and spin"), &[self.position.as_slice(), &[self.spin_ratio]].concat())?;
        unit(name("axis"), self.axis)
    }
}

impl Mesh {
    fn check(&self, name: &str) -> Checked {
        finite(|| format!("{name}: cycle offset"), &[self.cycle_offset])?;
        not_negative(|| format!("{name}: damping"), self.damping)?;
        positive(|| format!("{name}: force of full damping"), self.damping_force)?;
        let Some(coast) = &self.coast else { return Ok(()) };
        finite(|| format!("{name}: coast cycle offset"), &[coast.cycle_offset])?;
        not_negative(|| format!("{name}: backlash"), coast.backlash)
    }
}

impl PlanetaryStage {
    fn check(&self) -> Checked {
        let teeth = f64::from(self.ring_teeth);
        PlanetaryError::check(self.ring_teeth >= 3, || "teeth of the ring".into(), teeth, "3 or more")?;
        for (what, value) in [
            ("centre distance", self.centre_distance),
            ("base radius of the sun", self.sun_base_radius),
            ("base radius of the planets", self.planet_base_radius),
            ("base radius of the ring", self.ring_base_radius),
        ] {
            positive(|| what.into(), value)?;
        }
        finite(|| "height of the planetary stage".into(), &[self.height])?;
        for (what, value) in [("sun", self.sun_pressure_angle), ("ring", self.ring_pressure_angle)] {
            let good = (0.0..std::f64::consts::FRAC_PI_2).contains(&value);
            PlanetaryError::check(good, || format!("pressure angle at the {what}"), value, "0 to less than pi/2 rad")?;
        }
        PlanetaryError::check(!self.planets.is_empty(), || "number of planets".into(), 0.0, "1 or more")?;
        for (index, planet) in self.planets.iter().enumerate() {
            let id = BodyId::Planet(index);
            finite(|| format!("{id}: angle"), &[planet.angle])?;
            springs(|| format!("{id}: bearing"), &planet.bearing_stiffness, &planet.bearing_damping)?;
            planet.sun_mesh.check(&format!("sun-{id}"))?;
            planet.ring_mesh.check(&format!("ring-{id}"))?;
        }
        Ok(())
    }
}

impl BevelStage {
    fn check(&self) -> Checked {
        self.mesh.check("bevel mesh")?;
        finite(|| "point of the bevel mesh".into(), &self.point)?;
        positive(|| "bevel mesh cycles per turn of the carrier".into(), self.cycles_per_turn)?;
        unit(|| "normal of the bevel mesh".into(), self.normal)
    }
}

impl Bearing {
    fn check(&self, spec: &TransmissionSpec) -> Checked {
        let what = || format!("bearing `{}`", self.name);
        springs(what, &self.stiffness, &self.damping)?;
        finite(|| format!("{}: position", what()), &self.position)?;
        for (i, &axis) in self.axes.iter().enumerate() {
            unit(|| format!("{}: axis", what()), axis)?;
            for other in &self.axes[..i] {
                let product: f64 = axis.iter().zip(other).map(|(a, b)| a * b).sum();
                let good = product.abs() < DIRECTION_TOLERANCE;
                PlanetaryError::check(good, || format!("{}: cosine between axes", what()), product, DIRECTION)?;
            }
        }
        let body = |id: BodyId| match spec.body(id) {
            Some(_) => Ok(()),
            None => Err(missing(what(), id.to_string(), spec.body_ids().iter().map(ToString::to_string))),
        };
        body(self.body)?;
        match &self.anchor {
            Anchor::Ground => Ok(()),
            Anchor::Body(id) => body(*id),
            Anchor::Port(name) => {
                let ports = spec.housing.iter().flat_map(|housing| &housing.ports).map(|port| port.name.clone());
                if ports.clone().any(|port| port == *name) { Ok(()) } else { Err(missing(what(), name.clone(), ports)) }
            }
        }
    }
}

fn missing(what: String, name: String, there: impl Iterator<Item = String>) -> PlanetaryError {
    PlanetaryError::Missing { what, name, there: there.collect::<Vec<_>>().join(", ") }
}

fn check_housing(housing: &ElasticBody) -> Checked {
    let modes = housing.frequencies.len();
    let shape = |what: String, found: usize, needed: usize| {
        if found == needed { Ok(()) } else { Err(PlanetaryError::Shape { what, found, needed }) }
    };
    shape("table of damping ratios of the housing".into(), housing.damping_ratios.len(), modes)?;
    for &frequency in &housing.frequencies {
        positive(|| "circular frequency of the housing".into(), frequency)?;
    }
    for &ratio in &housing.damping_ratios {
        not_negative(|| "damping ratio of the housing".into(), ratio)?;
    }
    for port in &housing.ports {
        let what = || format!("port `{}`", port.name);
        shape(format!("columns of {}", what()), port.shapes.ncols(), modes)?;
        shape(format!("rows of {}", what()), port.shapes.nrows(), 6)?;
        finite(what, &port.position)?;
        (0..modes).try_for_each(|k| finite(what, port.shapes.col_as_slice(k)))?;
    }
    if let Some(seat) = &housing.ring_seat {
        positive(|| "radius of the ring seat".into(), seat.radius)?;
        shape("columns of the ring seat".into(), seat.shapes.ncols(), modes)?;
        shape("rows of the ring seat".into(), seat.shapes.nrows(), 3 * (2 * seat.harmonics + 1))?;
        (0..modes).try_for_each(|k| finite(|| "ring seat".into(), seat.shapes.col_as_slice(k)))?;
    }
    for sensor in &housing.sensors {
        shape(format!("shape of sensor `{}`", sensor.name), sensor.shape.len(), modes)?;
        finite(|| format!("sensor `{}`", sensor.name), &sensor.shape)?;
    }
    Ok(())
}

impl TransmissionSpec {
    /// Checks every number and name.
    ///
    /// # Errors
    /// The first that is not allowed.
    pub fn validate(&self) -> Checked {
        self.stage.check()?;
        if let Some(bevel) = &self.bevel {
            bevel.check()?;
        }
        for id in self.body_ids() {
            if let Some(body) = self.body(id) {
                body.check(id)?;
            }
        }
        for (id, body) in [(BodyId::Sun, &self.sun), (BodyId::Carrier, &self.carrier)] {
            let ([x, y, _], [a, b, _]) = (body.position, body.axis);
            let off = x.hypot(y);
            PlanetaryError::check(
                off <= ON_AXIS,
                || format!("{id}: distance from the main axis"),
                off,
                "0 m, to 1e-9",
            )?;
            let tilt = a.hypot(b);
            let allowed = "0, to 1e-6: along the main axis";
            PlanetaryError::check(tilt <= DIRECTION_TOLERANCE, || format!("{id}: tilt of the axis"), tilt, allowed)?;
        }
        if let Some(housing) = &self.housing {
            check_housing(housing)?;
            if let Some(seat) = &housing.ring_seat {
                let ratio = seat.radius / self.stage.ring_base_radius;
                let what = || "radius of the ring seat over the ring's base radius".into();
                PlanetaryError::check(SEAT_RATIO.contains(&ratio), what, ratio, SEAT)?;
            }
        }
        self.bearings.iter().try_for_each(|bearing| bearing.check(self))?;
        match self.drive {
            Some(id) if self.body(id).is_none() => {
                let there = self.body_ids();
                Err(missing("prescribed rotation".into(), id.to_string(), there.iter().map(ToString::to_string)))
            }
            _ => Ok(()),
        }
    }
}

impl RunRequest {
    /// Checks speeds, loads and options.
    ///
    /// # Errors
    /// The first that is not allowed.
    pub(super) fn validate(&self, time_step: f64) -> Checked {
        match self.turning {
            Turning::Steady { carrier_speed, steps_per_cycle } => {
                positive(|| "speed of the carrier".into(), carrier_speed)?;
                let steps = steps_per_cycle as f64;
                let good = (4..=100_000).contains(&steps_per_cycle);
                PlanetaryError::check(good, || "steps per mesh cycle".into(), steps, "4 to 100,000")?;
            }
            Turning::Standing { time_step } => positive(|| "time step".into(), time_step)?,
        }
        not_negative(|| "output torque".into(), self.output_torque)?;
        finite(|| "mesh cycles travelled".into(), &[self.travelled])?;
        let stages = self.stages as f64;
        PlanetaryError::check((1..=4).contains(&self.stages), || "stages of a step".into(), stages, "1 to 4")?;
        let Some(band) = &self.band else { return Ok(()) };
        band.check(time_step)
    }
}

impl TransmissionState {
    /// Checks a state for a transmission of so many coordinates and forces of connections.
    pub(super) fn check(&self, coordinates: usize, connections: usize) -> Checked {
        for (what, values, needed) in [
            ("position", &self.position, coordinates),
            ("velocity", &self.velocity, coordinates),
            ("connection", &self.connection, connections),
        ] {
            let what = || format!("{what} of the state to start from");
            if values.len() != needed {
                return Err(PlanetaryError::Shape { what: what(), found: values.len(), needed });
            }
            finite(what, values)?;
        }
        Ok(())
    }
}
