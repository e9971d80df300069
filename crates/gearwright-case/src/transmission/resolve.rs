//! From keys to gears, bodies, bearings, sensors and severities in SI units; faults told at their keys.

use std::f64::consts::TAU;
use std::path::Path;

use fecm::statics::PairModelOptions;
use gear_geom::{CentralMember, Gear, PlanetaryTrain, PlanetaryTrainSpec, TrainError, TrainSpeeds};

use planetary::stage::mean_force;

use super::bevel::{BevelStage, bevel};
use super::damage::{Severity, severities};
use super::housing::{HousingPlan, plan};
use super::notes::notes;
use super::schema::{Bearing, Body, Supported, Transmission};
use crate::document::Node;
use crate::fault::Fault;
use crate::geometry::geometry_fault;
use crate::notes::Notes;
use crate::spur_pair::notes::{pitch_error_faults, plane_faults};
use crate::spur_pair::resolve::{contact_options, face_model, fill_defaults, member_options, spec};
use crate::spur_pair::schema::Form;

const MM: f64 = 1e-3;
const UM: f64 = 1e-6;
/// Position error of a pin, at most.
const MAX_PIN_ERROR_UM: f64 = 1000.0;
/// Steps of a run, at most.
const MOST_STEPS: f64 = 1e8;

/// A transmission case, ready to run.
#[derive(Debug, Clone)]
pub struct TransmissionCase {
    /// The case with every default filled in.
    pub inputs: Transmission,
    /// The planetary train.
    pub train: PlanetaryTrain,
    /// Models of the sun-planet and of the planet-ring pair.
    pub pairs: [PairModelOptions; 2],
    /// Speeds.
    pub speeds: TrainSpeeds,
    /// Whether planets are equally spaced.
    pub equally_spaced: bool,
    /// Bodies.
    pub bodies: Bodies,
    /// Sensors: those of sections first, then those around the housing.
    pub sensors: Vec<Place>,
    /// Sensors whose signals are written in full.
    pub named_sensors: usize,
    /// Bevel stage before the sun.
    pub bevel: Option<BevelStage>,
    /// Elastic housing.
    pub housing: Option<HousingPlan>,
    /// Damaged states to run after the healthy one.
    pub severities: Vec<Severity>,
    /// Samples of records, and steps of time.
    pub sampling: Sampling,
    /// Errors of the teeth of sun, planets and ring, from tooth 0 on (m); empty for none.
    pub tooth_errors: [Vec<f64>; 3],
    /// Radial and tangential position error of each planet's pin (m); empty for none.
    pub pin_errors: Vec<[f64; 2]>,
    /// Warnings and assumptions.
    pub notes: Notes,
}

/// Samples of records, and steps of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Band of the records (Hz).
    pub band: f64,
    /// Samples of a mesh cycle of the planetary stage.
    pub samples_per_cycle: usize,
    /// Time steps from one sample to the next.
    pub steps_per_sample: usize,
}

/// Samples per period of the highest frequency of the band.
const SAMPLES_PER_PERIOD: f64 = 2.56;
/// Longest step by default, as an angle of the highest frequency of the band (rad): three stages move a mode that only connections hold by its sixth power over
/// 100,800, 2e-4 at the band, and others less.
const LONGEST_STEP: f64 = 1.65;
/// Steps of a mesh cycle by default, at least: tooth pairs come and go within.
const FEWEST_STEPS: f64 = 40.0;

impl Sampling {
    fn new(inputs: &Transmission, mesh_frequency: f64) -> Self {
        let band = inputs.signals.band_hz;
        let samples = (SAMPLES_PER_PERIOD * band / mesh_frequency).ceil().max(2.0);
        let steps = (TAU * band / mesh_frequency / LONGEST_STEP).max(FEWEST_STEPS);
        let by_default = (steps / samples).ceil().max(1.0);
        Self {
            band,
            samples_per_cycle: samples as usize,
            steps_per_sample: inputs.numerics.steps_per_sample.map_or(by_default as usize, |given| given as usize),
        }
    }

    /// Steps of a mesh cycle.
    #[must_use]
    pub fn steps_per_cycle(&self) -> usize {
        self.samples_per_cycle * self.steps_per_sample
    }
}

/// Rigid bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bodies {
    /// Sun.
    pub sun: BodyValues,
    /// One planet.
    pub planet: BodyValues,
    /// Carrier.
    pub carrier: BodyValues,
}

/// A rigid body.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BodyValues {
    /// kg.
    pub mass: f64,
    /// About its axis (kg m^2).
    pub polar: f64,
    /// About a diameter (kg m^2).
    pub transverse: f64,
    /// Place of the centre of mass along the axis (m).
    pub centre: f64,
}

/// Where a sensor sits.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Name.
    pub name: String,
    /// Angle (rad).
    pub angle: f64,
    /// Height above mid-face (m).
    pub height: f64,
}

impl TransmissionCase {
    /// Mesh frequency of the bevel stage, if there is one (Hz).
    #[must_use]
    pub fn bevel_mesh_frequency(&self) -> Option<f64> {
        let pinion = self.inputs.bevel.as_ref()?.pinion_teeth;
        Some(self.inputs.run.speed_rpm / 60.0 * f64::from(pinion))
    }

    /// Mean force of one mesh of the planetary stage (N).
    #[must_use]
    pub fn mean_force(&self) -> f64 {
        mean_force(&self.train, self.inputs.run.torque_n_m)
    }
}

/// Resolves a case; `folder` is where files it refers to are looked for.
///
/// # Errors
/// All faults that can be told together.
pub fn resolve(mut inputs: Transmission, document: &Node, folder: &Path) -> Result<TransmissionCase, Vec<Fault>> {
    let mut faults = Vec::new();
    let gears = gears(&mut inputs, document, folder, &mut faults);
    let pairs = pair_options(&inputs, document, &mut faults);
    let angles = planet_angles(&mut inputs, document, &mut faults);
    bearings(&inputs, document, &mut faults);
    let (sensors, named_sensors) = sensors(&mut inputs, document, &mut faults);
    let pin_errors = pin_errors(&inputs, document, &mut faults);
    let Some(([sun, planet, ring], tooth_errors)) = gears else { return Err(faults) };
    let train = PlanetaryTrain::new(&PlanetaryTrainSpec {
        sun,
        planet,
        ring,
        centre_distance: inputs.mesh.centre_distance_mm * MM,
        planet_angles: angles.clone(),
        ring_tooth_angle: inputs.train.ring_tooth_deg.to_radians(),
        sun_tooth_angle: inputs.train.sun_tooth_deg.to_radians(),
    });
    let train = match train {
        Ok(train) => train,
        Err(error) => {
            faults.extend(train_faults(document, &error));
            return Err(faults);
        }
    };
    let bodies = bodies(&mut inputs, &train);
    let severities = severities(&inputs, &train, document, folder, &mut faults);
    let housing = plan(&inputs, &sensors, document, folder, &mut faults);
    let stage = bevel(&inputs, document, &mut faults);
    let input_speed = inputs.run.speed_rpm * TAU / 60.0;
    let sun_speed = stage.as_ref().map_or(input_speed, |stage| stage.pair.gear_speed(input_speed));
    let speeds = train.speeds([(CentralMember::Sun, sun_speed), (CentralMember::Ring, 0.0)]);
    let speeds = speeds.map_err(|error| faults.push(document.fault("run.speed_rpm", error.to_string())));
    let equal = TAU / angles.len() as f64;
    let step = |pair: &[f64]| (pair[1] - pair[0] - equal).abs() < 1e-9;
    let sampling = speeds.as_ref().ok().map(|speeds| Sampling::new(&inputs, speeds.mesh_frequency));
    if let Some(sampling) = &sampling {
        let run = &inputs.run;
        let turns =
            f64::from(run.carrier_turns) + f64::from(run.settling_planet_passes) / f64::from(inputs.train.planets);
        let steps = sampling.steps_per_cycle() as f64 * f64::from(inputs.ring.teeth) * turns;
        if steps > MOST_STEPS {
            let message = format!(
                "makes {steps:e} time steps; at most {MOST_STEPS:e}: record fewer turns, or a lower signals.band_hz"
            );
            faults.push(document.fault("run.carrier_turns", message));
        }
        let fewest = sampling.steps_per_cycle();
        if !(4..=100_000).contains(&fewest) {
            let message = format!("makes {fewest} time steps of a mesh cycle; allowed: 4 to 100,000");
            faults.push(document.fault("signals.band_hz", message));
        }
    }
    match speeds.ok().zip(sampling) {
        Some((speeds, sampling)) if faults.is_empty() => {
            let mut case = TransmissionCase {
                train,
                pairs,
                speeds,
                equally_spaced: angles.windows(2).all(step),
                bodies,
                sensors,
                named_sensors,
                bevel: stage,
                housing,
                severities,
                sampling,
                inputs,
                tooth_errors,
                pin_errors,
                notes: Notes::default(),
            };
            case.notes = notes(&case, document);
            Ok(case)
        }
        _ => Err(faults),
    }
}

/// Sun, planet and ring, and the errors of their teeth.
fn gears(
    inputs: &mut Transmission,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<([Gear; 3], [Vec<f64>; 3])> {
    let mut made = Vec::new();
    for (name, form) in [("sun", Form::External), ("planet", Form::External), ("ring", Form::Internal)] {
        let gear = match name {
            "sun" => &mut inputs.sun,
            "planet" => &mut inputs.planet,
            _ => &mut inputs.ring,
        };
        if gear.form.is_some_and(|found| found != form) {
            let needed = if form == Form::External { "external" } else { "internal" };
            faults.push(document.fault(&format!("{name}.form"), format!("the {name} is {needed}: leave this key out")));
        }
        fill_defaults(gear, &inputs.mesh, form);
        let written = spec(name, gear, &inputs.mesh, document, folder, faults);
        plane_faults(name, gear, written.as_ref(), inputs.analysis.model, document, faults);
        pitch_error_faults(name, gear, document, faults);
        let Some(mut spec) = written else { continue };
        // checked with the gear, then kept apart: the pairs of a train are those of perfect teeth
        let checked = Gear::new(&spec);
        let errors = std::mem::take(&mut spec.pitch_errors);
        match checked.and_then(|_| Gear::new(&spec)) {
            Ok(gear) => made.push((gear, by_tooth(&errors, spec.teeth()))),
            Err(errors) => faults.extend(errors.0.iter().map(|e| geometry_fault(document, Some(name), e))),
        }
    }
    let (gears, errors): (Vec<Gear>, Vec<Vec<f64>>) = made.into_iter().unzip();
    Some((gears.try_into().ok()?, errors.try_into().ok()?))
}

/// Errors of all teeth of a gear from a list that repeats; empty without any.
fn by_tooth(errors: &[f64], teeth: u32) -> Vec<f64> {
    if errors.iter().all(|error| *error == 0.0) {
        return Vec::new();
    }
    errors.iter().copied().cycle().take(teeth as usize).collect()
}

/// Radial and tangential position errors of the pins (m); empty for none.
fn pin_errors(inputs: &Transmission, document: &Node, faults: &mut Vec<Fault>) -> Vec<[f64; 2]> {
    let train = &inputs.train;
    let count = train.planets as usize;
    let lists = [("pin_radial_um", &train.pin_radial_um), ("pin_tangential_um", &train.pin_tangential_um)];
    for (key, list) in lists {
        if !list.is_empty() && list.len() != count {
            let message = format!("has {} values for {count} planets", list.len());
            faults.push(document.fault(&format!("train.{key}"), message));
        }
        if let Some(error) = list.iter().find(|error| !(error.abs() <= MAX_PIN_ERROR_UM)) {
            let message = format!("must be -{MAX_PIN_ERROR_UM} to {MAX_PIN_ERROR_UM} um; {error} is not");
            faults.push(document.fault(&format!("train.{key}"), message));
        }
    }
    if lists.iter().all(|(_, list)| list.iter().all(|error| *error == 0.0)) {
        return Vec::new();
    }
    let at = |list: &[f64], planet: usize| list.get(planet).copied().unwrap_or_default() * UM;
    (0..count).map(|planet| [at(&train.pin_radial_um, planet), at(&train.pin_tangential_um, planet)]).collect()
}

fn pair_options(inputs: &Transmission, document: &Node, faults: &mut Vec<Fault>) -> [PairModelOptions; 2] {
    let [sun, planet, ring] = [("sun", &inputs.sun), ("planet", &inputs.planet), ("ring", &inputs.ring)]
        .map(|gear| member_options(gear, &inputs.material, &inputs.contact, document, faults));
    let options = |pinion, wheel| PairModelOptions {
        damage: [Vec::new(), Vec::new()],
        pinion,
        wheel,
        face: face_model(inputs.analysis.model, &inputs.contact),
        contact: contact_options(&inputs.contact),
    };
    [options(sun, planet), options(planet, ring)]
}

/// Angles of the planets (rad), ascending from the first.
fn planet_angles(inputs: &mut Transmission, document: &Node, faults: &mut Vec<Fault>) -> Vec<f64> {
    let train = &mut inputs.train;
    let count = train.planets as usize;
    if train.planet_angles_deg.is_empty() {
        let angle = |k: usize| train.first_planet_deg + 360.0 * k as f64 / count as f64;
        let angles: Vec<f64> = (0..count).map(angle).collect();
        train.planet_angles_deg.clone_from(&angles);
        // exact thirds of a turn, not sums of rounded degrees
        let first = train.first_planet_deg.to_radians();
        return (0..count).map(|k| first + TAU * k as f64 / count as f64).collect();
    }
    let angles = &train.planet_angles_deg;
    if angles.len() != count {
        let message = format!("has {} angles for {count} planets", angles.len());
        faults.push(document.fault("train.planet_angles_deg", message));
    }
    if angles.windows(2).any(|pair| !(pair[1] > pair[0])) || angles.iter().any(|angle| !(angle.abs() <= 720.0)) {
        let message = "must ascend, each from -720 to 720 degrees";
        faults.push(document.fault("train.planet_angles_deg", message));
    }
    angles.iter().map(|angle| angle.to_radians()).collect()
}

/// Every body is held in every direction by its bearings together.
fn bearings(inputs: &Transmission, document: &Node, faults: &mut Vec<Fault>) {
    for (index, bearing) in inputs.bearing.iter().enumerate() {
        let at = |key: &str| format!("bearing[{}].{key}", index + 1);
        if bearing.on == Supported::Planet && bearing.port.is_some() {
            faults.push(document.fault(&at("port"), "a planet's bearing sits on the carrier's pin"));
        }
        if bearing.port.is_some() && inputs.housing.is_none() {
            faults.push(document.fault(&at("port"), "there is no [housing]; leave this key out, or add one"));
        }
    }
    let mut bodies = vec![(Supported::Sun, "sun"), (Supported::Planet, "planet"), (Supported::Carrier, "carrier")];
    let gear_apart = inputs.bevel.as_ref().is_some_and(|bevel| bevel.spline.is_some());
    for (on, name, there) in [
        (Supported::BevelPinion, "bevel-pinion", inputs.bevel.is_some()),
        (Supported::BevelGear, "bevel-gear", gear_apart),
    ] {
        if there {
            bodies.push((on, name));
        } else if let Some(index) = inputs.bearing.iter().position(|bearing| bearing.on == on) {
            let message = format!("there is no {name} of its own: that takes a section [bevel]");
            faults.push(document.fault(&format!("bearing[{}].on", index + 1), message));
        }
    }
    for (on, name) in bodies {
        let own: Vec<&Bearing> = inputs.bearing.iter().filter(|bearing| bearing.on == on).collect();
        let mut fault = |message: &str| faults.push(document.fault("bearing", format!("{name}: {message}")));
        let splined = inputs.bevel.as_ref().and_then(|bevel| bevel.spline).filter(|_| on == Supported::Sun);
        if own.is_empty() && splined.is_none() {
            fault(&format!("no bearing carries it; add a section [[bearing]] with on = \"{name}\""));
            continue;
        }
        if on == Supported::Planet && own.len() > 1 {
            fault("a planet has one bearing on its pin; give the stiffness of all its rows together");
        }
        let axial = splined.is_some_and(|spline| spline.axial_stiffness_n_per_m > 0.0);
        if !axial && !own.iter().any(|bearing| bearing.axial_stiffness_n_per_m > 0.0) {
            fault("nothing holds it along its axis; give one of its bearings axial_stiffness_n_per_m");
        }
        if on == Supported::Planet && !own.iter().any(|bearing| bearing.radial_stiffness_n_per_m > 0.0) {
            fault("nothing holds it on its pin; give its bearing radial_stiffness_n_per_m");
        }
        let radial = own.iter().filter(|bearing| bearing.radial_stiffness_n_per_m > 0.0);
        let places: Vec<f64> = radial.map(|bearing| bearing.place_mm).collect();
        let two = places.iter().any(|place| (place - places[0]).abs() > 0.0);
        let tilt = splined.is_some_and(|spline| spline.tilt_stiffness_n_m_per_rad > 0.0);
        if !two && !tilt && !own.iter().any(|bearing| bearing.tilt_stiffness_n_m_per_rad > 0.0) {
            fault(
                "nothing holds it against tilt; give tilt_stiffness_n_m_per_rad, or a second bearing at another place_mm",
            );
        }
    }
}

/// Sensors in order, and how many of them have sections of their own.
fn sensors(inputs: &mut Transmission, document: &Node, faults: &mut Vec<Fault>) -> (Vec<Place>, usize) {
    if inputs.housing.is_none() {
        for (key, given) in [("sensor", !inputs.sensor.is_empty()), ("around", inputs.around.is_some())] {
            if given {
                faults.push(document.fault(key, "sensors sit on a housing; add a section [housing]"));
            }
        }
    }
    let place = |name: &str, degrees: f64, height: f64| Place {
        name: name.to_owned(),
        angle: degrees.to_radians(),
        height: height * MM,
    };
    let mut places: Vec<Place> =
        inputs.sensor.iter().map(|sensor| place(&sensor.name, sensor.angle_deg, sensor.height_mm)).collect();
    for (index, sensor) in inputs.sensor.iter().enumerate() {
        if sensor.name.trim().is_empty() || inputs.sensor[..index].iter().any(|other| other.name == sensor.name) {
            let message = "every sensor needs a name of its own";
            faults.push(document.fault(&format!("sensor[{}].name", index + 1), message));
        }
    }
    let named = places.len();
    if let Some(around) = &mut inputs.around {
        let count = *around.count.get_or_insert(inputs.ring.teeth);
        if around.leave_out_deg.len() % 2 == 1 || around.leave_out_deg.iter().any(|angle| !(angle.abs() <= 720.0)) {
            let message = "must hold pairs of angles from -720 to 720 degrees, from and to";
            faults.push(document.fault("around.leave_out_deg", message));
        }
        let left_out = |degrees: f64| {
            let within = |pair: &[f64]| (degrees - pair[0]).rem_euclid(360.0) <= (pair[1] - pair[0]).rem_euclid(360.0);
            around.leave_out_deg.chunks_exact(2).any(within)
        };
        let angles = (0..count).map(|k| around.first_deg + 360.0 * f64::from(k) / f64::from(count));
        places.extend(angles.filter(|angle| !left_out(*angle)).map(|angle| {
            let degrees = angle.rem_euclid(360.0);
            place(&format!("{degrees:.2} deg"), degrees, around.height_mm)
        }));
    }
    (places, named)
}

/// Fills in what was left out of the bodies.
fn bodies(inputs: &mut Transmission, train: &PlanetaryTrain) -> Bodies {
    let density = inputs.material.density_kg_per_m3;
    let spec = train.spec();
    let of_gear = |gear: &Gear| {
        let inertia = gear.inertia(density);
        (inertia.mass, inertia.polar, gear.facewidth())
    };
    let radius = spec.centre_distance + 0.5 * spec.planet.rim_radius();
    let mass = density * std::f64::consts::PI * radius * radius * spec.planet.facewidth();
    let carrier = (mass, 0.5 * mass * radius * radius, spec.planet.facewidth());
    Bodies {
        sun: fill(&mut inputs.bodies.sun, of_gear(&spec.sun)),
        planet: fill(&mut inputs.bodies.planet, of_gear(&spec.planet)),
        carrier: fill(&mut inputs.bodies.carrier, carrier),
    }
}

/// A body with defaults of mass, moment of inertia and width.
fn fill(body: &mut Body, (mass, polar, width): (f64, f64, f64)) -> BodyValues {
    let mass = *body.mass_kg.get_or_insert(mass);
    let polar = *body.inertia_kg_m2.get_or_insert(polar);
    let transverse = *body.transverse_inertia_kg_m2.get_or_insert(0.5 * polar + mass * width * width / 12.0);
    BodyValues { mass, polar, transverse, centre: *body.centre_mm.get_or_insert(0.0) * MM }
}

/// A fault of the train at the key it comes from.
fn train_faults(document: &Node, error: &TrainError) -> Vec<Fault> {
    let one = |key: &str, message: String| vec![document.fault(key, message)];
    match error {
        TrainError::Pair { pair, source } => {
            let names = if pair.starts_with("sun") { ["sun", "planet"] } else { ["planet", "ring"] };
            let told = source.0.iter().map(|error| {
                let mut fault = geometry_fault(document, None, error);
                let key = fault.key.replace("pinion.", &format!("{}.", names[0]));
                let key = key.replace("gear.", &format!("{}.", names[1]));
                if key != fault.key {
                    fault = document.fault(&key, fault.message);
                }
                fault.message = format!("{pair}: {}", fault.message);
                fault
            });
            told.collect()
        }
        TrainError::Assembly { planet, angle, sun_teeth, ring_teeth, step, nearest } => {
            let message = format!(
                "planet {} at {:.4} degrees does not fit between sun and ring: angles between planets must be multiples of 360 / ({sun_teeth} + \
                 {ring_teeth}) = {:.4} degrees; the nearest place is {:.4} degrees",
                planet + 1,
                angle.to_degrees(),
                step.to_degrees(),
                nearest.to_degrees()
            );
            one(
                if document.find("train.planet_angles_deg").is_some() {
                    "train.planet_angles_deg"
                } else {
                    "train.planets"
                },
                message,
            )
        }
        TrainError::Collision { first, second, overlap } => {
            let message = format!(
                "planets {} and {} run into each other: their tip circles overlap by {:.3} mm",
                first + 1,
                second + 1,
                overlap / MM
            );
            one("train.planets", message)
        }
        other => one("train", other.to_string()),
    }
}
