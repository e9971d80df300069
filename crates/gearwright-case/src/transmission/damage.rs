//! Damaged states of a case: which tooth of which gear, and what is wrong with it.

use std::f64::consts::TAU;
use std::path::Path;

use gear_geom::{Member, MeshSite, PlanetaryTrain, TrainTooth};

use super::schema::{Damage, Member as On, Transmission};
use crate::document::Node;
use crate::fault::Fault;
use crate::spur_pair::damage::{Shapes, Site, at, count, damage_of, joined, label, values_of};
use crate::spur_pair::schema::{Model, Values};

/// A damaged state.
#[derive(Debug, Clone, PartialEq)]
pub struct Severity {
    /// What distinguishes it, for legends.
    pub label: String,
    /// Damaged teeth. Sides of flanks are those of the pair [`own_site`] of the tooth.
    pub damage: Vec<(TrainTooth, gear_geom::Damage)>,
}

/// The pair in which damage of a tooth is described: sun and planet in theirs, the ring in its own.
#[must_use]
pub fn own_site(tooth: TrainTooth) -> (MeshSite, Member) {
    match tooth {
        TrainTooth::Sun(_) => (MeshSite::SunPlanet, Member::Pinion),
        TrainTooth::Planet(..) => (MeshSite::SunPlanet, Member::Wheel),
        TrainTooth::Ring(_) => (MeshSite::PlanetRing, Member::Wheel),
    }
}

impl Damage {
    pub(super) fn shapes(&self) -> Shapes<'_> {
        Shapes {
            crack: self.crack.as_ref(),
            pit: self.pit.as_ref(),
            wear: self.wear.as_ref(),
            broken_corner: self.broken_corner.as_ref(),
        }
    }
}

/// Damaged states of a case, in order; none for a healthy one. Files are looked for in `folder`.
pub fn severities(
    inputs: &Transmission,
    train: &PlanetaryTrain,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Vec<Severity> {
    let before = faults.len();
    let lists: Vec<_> = inputs
        .damage
        .iter()
        .map(|damage| {
            let angles = damage.angle_deg.iter().map(|angles| ("angle_deg", angles));
            values_of(damage.shapes()).into_iter().chain(angles).collect()
        })
        .collect();
    let count = count(&lists, document, faults);
    if inputs.damage.is_empty() || faults.len() > before {
        return Vec::new();
    }
    (0..count).filter_map(|index| severity(inputs, train, index, document, folder, faults)).collect()
}

fn severity(
    inputs: &Transmission,
    train: &PlanetaryTrain,
    index: usize,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<Severity> {
    let (mut damage, mut labels) = (Vec::new(), Vec::new());
    for (section, keys) in inputs.damage.iter().enumerate() {
        let path = format!("damage[{}]", section + 1);
        let before = faults.len();
        let mut fault = |key: &str, message: String| {
            let key = if key.is_empty() { path.clone() } else { format!("{path}.{key}") };
            faults.push(document.fault(&key, message));
        };
        let tooth = tooth(keys, train, index, &mut fault);
        let any = TrainTooth::Sun(0);
        let (site, member) = own_site(tooth.unwrap_or(any));
        let solid = inputs.analysis.model == Model::Solid;
        let site = Site { pair: train.pair(site), member, solid, folder };
        let made = tooth.and_then(|_| damage_of(keys.shapes(), site, index, &mut fault));
        if faults.len() > before {
            return None;
        }
        damage.push((tooth?, made?));
        // where the angle is what changes, it tells states apart
        let place = match &keys.angle_deg {
            Some(angles @ Values::Each(_)) => format!(" at {} deg", at(angles, index)),
            _ => String::new(),
        };
        labels.push(label(keys.shapes(), index) + &place);
    }
    Some(Severity { label: joined(&labels), damage })
}

/// The tooth of a section.
fn tooth(
    keys: &Damage,
    train: &PlanetaryTrain,
    index: usize,
    fault: &mut impl FnMut(&str, String),
) -> Option<TrainTooth> {
    let spec = train.spec();
    let (gear, zero) = match keys.on {
        On::Sun => (&spec.sun, train.sun_tooth_angle()),
        On::Planet => (&spec.planet, 0.0),
        On::Ring => (&spec.ring, spec.ring_tooth_angle),
    };
    let teeth = gear.teeth();
    let number = match (keys.tooth, &keys.angle_deg) {
        (Some(number), None) if number < teeth => number,
        (Some(_), None) => {
            fault("tooth", format!("this gear has teeth 0 to {}", teeth - 1));
            return None;
        }
        (None, Some(_)) if keys.on == On::Planet => {
            fault("angle_deg", "teeth of a planet are given by number: tooth".into());
            return None;
        }
        (None, Some(angles)) => {
            let angle = at(angles, index);
            if !(angle.abs() <= 720.0) {
                fault("angle_deg", format!("must be -720 to 720 degrees; {angle} is not"));
                return None;
            }
            let pitches = (angle.to_radians() - zero) / TAU * f64::from(teeth);
            (pitches.round() as i64).rem_euclid(i64::from(teeth)) as u32
        }
        _ => {
            fault("", "give either tooth or angle_deg".into());
            return None;
        }
    };
    match (keys.on, keys.planet) {
        (On::Sun, None) => Some(TrainTooth::Sun(number)),
        (On::Ring, None) => Some(TrainTooth::Ring(number)),
        (On::Planet, Some(planet)) if planet as usize <= train.planets() => {
            Some(TrainTooth::Planet(planet as usize - 1, number))
        }
        (On::Planet, Some(_)) => {
            fault("planet", format!("there are planets 1 to {}", train.planets()));
            None
        }
        (On::Planet, None) => {
            fault("planet", "this key is required: which planet, from 1".into());
            None
        }
        (_, Some(_)) => {
            fault("planet", "goes with on = \"planet\"".into());
            None
        }
    }
}
