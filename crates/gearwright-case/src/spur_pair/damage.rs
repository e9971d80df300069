//! Damage of a case: severities from its sections, with every fault at its key.

use std::path::Path;

use fecm::mesh::SectorMesh;
use gear_geom::{
    CrackFront, CrackLength, CrackPath, CrackStart, FlankSide, Gear, GearPair, MeasuredDeviation, Pit, PitShape,
    ProfileMeasure, RootCrack, ToothDamage,
};
use nalgebra::Vector2;

use super::resolve::read_deviation;
use super::schema::{
    BrokenCorner, Crack, CrackSide, Damage, FaceEnd, HeightAlong, LandmarkName, Member, Model, Pit as PitKeys,
    SpurPair, Values, Wear,
};
use crate::document::Node;
use crate::fault::Fault;

/// Damages named one by one in a legend.
const MOST_LABELS: usize = 2;
const MM: f64 = 1e-3;
const UM: f64 = 1e-6;

/// One severity of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Severity {
    /// What distinguishes it, for legends.
    pub label: String,
    /// Damage of the pinion and of the gear.
    pub damage: [Vec<ToothDamage>; 2],
}

/// Severities of a case, in order; none for a healthy one. Files are looked for in `folder`.
pub fn severities(
    inputs: &SpurPair,
    pair: &GearPair,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Vec<Severity> {
    let lists: Vec<_> = inputs.damage.iter().map(|damage| values_of(damage.shapes())).collect();
    let count = count(&lists, document, faults);
    if inputs.damage.is_empty() || !faults.is_empty() {
        return Vec::new();
    }
    (0..count).filter_map(|k| severity(inputs, pair, k, document, folder, faults)).collect()
}

/// What of a damage section describes the damage itself, wherever it is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shapes<'a> {
    /// A root crack.
    pub crack: Option<&'a Crack>,
    /// A pit.
    pub pit: Option<&'a PitKeys>,
    /// Wear.
    pub wear: Option<&'a Wear>,
    /// A broken corner.
    pub broken_corner: Option<&'a BrokenCorner>,
}

/// The tooth that is damaged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Site<'a> {
    /// The pair it is judged in.
    pub pair: &'a GearPair,
    /// Which gear of the pair.
    pub member: gear_geom::Member,
    /// Whether the model has a face along which damage may vary.
    pub solid: bool,
    /// Where files are looked for.
    pub folder: &'a Path,
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

/// Number of severities of sections with these lists; lists of unlike lengths are faults.
pub(crate) fn count(sections: &[Vec<(&'static str, &Values)>], document: &Node, faults: &mut Vec<Fault>) -> usize {
    let length = |values: &Values| if let Values::Each(list) = values { list.len() } else { 1 };
    for (index, section) in sections.iter().enumerate() {
        for (name, _) in section.iter().filter(|(_, values)| length(values) == 0) {
            faults.push(
                document.fault(&format!("damage[{}].{name}", index + 1), "is an empty list: give at least one value"),
            );
        }
    }
    let count = sections.iter().flatten().map(|(_, values)| length(values)).max().unwrap_or(1);
    for (index, section) in sections.iter().enumerate() {
        for (name, values) in section {
            if let Values::Each(list) = values
                && list.len() != count
            {
                let message =
                    format!("all lists of a sweep have the same length, here {count}; this one has {}", list.len());
                faults.push(document.fault(&format!("damage[{}].{name}", index + 1), message));
            }
        }
    }
    count
}

/// Keys that may hold lists.
pub(crate) fn values_of(damage: Shapes<'_>) -> Vec<(&'static str, &Values)> {
    let crack = damage
        .crack
        .iter()
        .flat_map(|c| [("crack.length_percent", &c.length_percent), ("crack.length_mm", &c.length_mm)]);
    let pit = damage.pit.iter().flat_map(|p| [("pit.width_mm", &p.width_mm), ("pit.height_mm", &p.height_mm)]);
    let wear = damage.wear.iter().flat_map(|w| [("wear.depth_um", &w.depth_um), ("wear.scale", &w.scale)]);
    let optional = crack.chain(pit).chain(wear);
    let corner = damage.broken_corner.iter().flat_map(|corner| {
        [("broken_corner.length_mm", &corner.length_mm), ("broken_corner.height_mm", &corner.height_mm)]
    });
    optional.filter_map(|(name, values)| values.as_ref().map(|values| (name, values))).chain(corner).collect()
}

/// Value of a severity.
pub(crate) fn at(values: &Values, severity: usize) -> f64 {
    match values {
        Values::One(value) => *value,
        Values::Each(list) => list[severity],
    }
}

fn severity(
    inputs: &SpurPair,
    pair: &GearPair,
    index: usize,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<Severity> {
    let mut damage = [Vec::new(), Vec::new()];
    let mut labels = Vec::new();
    for (section, keys) in inputs.damage.iter().enumerate() {
        let path = format!("damage[{}]", section + 1);
        let before = faults.len();
        let mut fault = |key: &str, message: String| {
            let key = if key.is_empty() { path.clone() } else { format!("{path}.{key}") };
            faults.push(document.fault(&key, message));
        };
        let member = if keys.on == Member::Pinion { gear_geom::Member::Pinion } else { gear_geom::Member::Wheel };
        let gear = pair.gear(member);
        if keys.tooth >= gear.teeth() {
            fault("tooth", format!("this gear has teeth 0 to {}", gear.teeth() - 1));
        }
        let solid = inputs.analysis.model == Model::Solid;
        let made = damage_of(keys.shapes(), Site { pair, member, solid, folder }, index, &mut fault);
        if faults.len() > before {
            return None;
        }
        let slot = usize::from(keys.on == Member::Gear);
        damage[slot].push(ToothDamage { tooth: i64::from(keys.tooth), damage: made? });
        labels.push(label(keys.shapes(), index));
    }
    Some(Severity { label: joined(&labels), damage })
}

/// Label of a severity of several damages; many sections are one shape made of parts.
pub(crate) fn joined(labels: &[String]) -> String {
    if labels.len() > MOST_LABELS { format!("{} and {} more", labels[0], labels.len() - 1) } else { labels.join(", ") }
}

/// One damage of a severity, with every fault at its key below the section's.
pub(crate) fn damage_of(
    shapes: Shapes<'_>,
    site: Site<'_>,
    index: usize,
    fault: &mut impl FnMut(&str, String),
) -> Option<gear_geom::Damage> {
    let Site { pair, member, solid, folder } = site;
    let gear = pair.gear(member);
    match (shapes.crack, shapes.pit, shapes.wear, shapes.broken_corner) {
        (Some(crack), None, None, None) => {
            let loaded = pair.working_side(member);
            let side = match crack.side {
                CrackSide::Drive => loaded,
                CrackSide::Coast => loaded.other(),
            };
            let made = root_crack(crack, gear, side, index, fault);
            if made.as_ref().is_some_and(|crack| !solid && !crack.front.is_through()) {
                let message = "this crack varies along the face: it needs analysis.model = \"3d\"";
                fault("crack.front_percent", message.into());
            }
            if crack.side == CrackSide::Coast && made.as_ref().is_some_and(|crack| !crack.front.is_through()) {
                let message = "the faces of a crack that varies along the face carry no contact: only side = \"drive\"";
                fault("crack.side", message.into());
            }
            // the coarsest mesh tells whether the crack stays in the tooth
            let density = fecm::MeshDensity { order: 1, density: 1.0 };
            let mesh = |crack| SectorMesh::with_crack(gear, &density, Some(crack), "gear");
            if let Some(Err(error)) = made.as_ref().map(mesh) {
                fault("crack", error.to_string());
            }
            made.map(gear_geom::Damage::Crack)
        }
        (None, Some(_), None, None) if !solid => {
            fault("pit", "a pit varies along the face: it needs analysis.model = \"3d\"".into());
            None
        }
        (None, Some(keys), None, None) => pit(keys, pair, member, index, fault).map(gear_geom::Damage::Pit),
        (None, None, Some(keys), None) => {
            let made = wear(keys, gear, index, folder, fault);
            if made.as_ref().is_some_and(|table| !solid && table.face.len() > 1) {
                fault("wear.table", "this wear varies along the face: it needs analysis.model = \"3d\"".into());
            }
            made.map(gear_geom::Damage::Wear)
        }
        (None, None, None, Some(_)) if !solid => {
            let message = "a broken corner varies along the face: it needs analysis.model = \"3d\"";
            fault("broken_corner", message.into());
            None
        }
        (None, None, None, Some(keys)) => broken_corner(keys, gear, index, fault).map(gear_geom::Damage::BrokenCorner),
        _ => {
            fault("", "give either a crack or a pit or wear or a broken corner, each in a section of its own".into());
            None
        }
    }
}

/// What distinguishes a severity.
pub(crate) fn label(damage: Shapes<'_>, index: usize) -> String {
    let show = |values: &Option<Values>| values.as_ref().map(|v| at(v, index));
    if let Some(keys) = damage.crack {
        let crack = if keys.front_percent.is_empty() { "crack" } else { "crack up to" };
        match (show(&keys.length_percent), show(&keys.length_mm)) {
            (Some(percent), _) => format!("{crack} {percent} %"),
            (_, length) => format!("{crack} {} mm", length.unwrap_or_default()),
        }
    } else if let Some(pit) = damage.pit {
        match (show(&pit.width_mm), show(&pit.height_mm)) {
            (Some(width), Some(height)) => format!("pit {width} x {height} mm"),
            _ => "pit".into(),
        }
    } else if let Some(wear) = damage.wear {
        match (show(&wear.depth_um), show(&wear.scale)) {
            (Some(depth), _) => format!("wear {depth} µm"),
            (_, Some(scale)) => format!("wear x {scale}"),
            _ => "wear".into(),
        }
    } else if let Some(corner) = damage.broken_corner {
        format!("corner {} x {} mm", at(&corner.length_mm, index), at(&corner.height_mm, index))
    } else {
        String::new()
    }
}

/// Front of a crack and its longest length as a share of the length that the case gives.
fn crack_front(keys: &Crack, gear: &Gear, fault: &mut impl FnMut(&str, String)) -> Option<(CrackFront, f64)> {
    let (percent, face) = (&keys.front_percent, &keys.front_face_mm);
    if percent.is_empty() && face.is_empty() {
        return Some((CrackFront::default(), 1.0));
    }
    let half = 0.5 * gear.facewidth() / MM;
    let ends = [-half, half];
    let face: &[f64] = if face.is_empty() { &ends } else { face };
    if face.len() != percent.len() {
        let places = face.len();
        let allowed = "two values, one at each end of the face, or as many as front_face_mm";
        fault("crack.front_percent", format!("{} values at {places} places: give {allowed}", percent.len()));
        return None;
    }
    if let Some(value) = percent.iter().find(|value| !(0.0..=100.0).contains(*value)) {
        fault("crack.front_percent", format!("must be 0 to 100 percent of the crack's length; {value} is not"));
        return None;
    }
    if let Some(place) = face.iter().find(|place| place.abs() > half * (1.0 + 1e-9)) {
        fault("crack.front_face_mm", format!("must be on the face, -{half} to {half} mm; {place} is not"));
        return None;
    }
    let places: Vec<(f64, f64)> = face.iter().zip(percent).map(|(z, percent)| (z * MM, percent / 100.0)).collect();
    CrackFront::from_lengths(&places).map_err(|error| fault("crack.front_face_mm", error.to_string())).ok()
}

fn crack_start(keys: &Crack, fault: &mut impl FnMut(&str, String)) -> Option<CrackStart> {
    match (keys.start_tangent_deg, keys.start_radius_mm) {
        (None, None) => Some(CrackStart::MiddleOfFillet),
        (Some(angle), None) => Some(CrackStart::Tangent(angle.to_radians())),
        (None, Some(radius)) => Some(CrackStart::Radius(radius * MM)),
        (Some(_), Some(_)) => {
            fault("crack", "give either start_tangent_deg or start_radius_mm".into());
            None
        }
    }
}

fn crack_path(keys: &Crack, fault: &mut impl FnMut(&str, String)) -> Option<CrackPath> {
    let (across, inward) = (&keys.path_across_mm, &keys.path_inward_mm);
    if across.len() != inward.len() {
        let counts = format!("{} and {} values", across.len(), inward.len());
        fault("crack.path_across_mm", format!("and path_inward_mm have {counts}: give one of each for every point"));
        return None;
    }
    match (keys.direction_deg, across.is_empty()) {
        (None, true) => Some(CrackPath::Chord),
        (Some(angle), true) => Some(CrackPath::Straight(angle.to_radians())),
        (None, false) => Some(CrackPath::Through(across.iter().zip(inward).map(|(a, b)| [a * MM, b * MM]).collect())),
        (Some(_), false) => {
            fault("crack", "give either direction_deg or path_across_mm and path_inward_mm".into());
            None
        }
    }
}

fn root_crack(
    keys: &Crack,
    gear: &Gear,
    side: FlankSide,
    index: usize,
    fault: &mut impl FnMut(&str, String),
) -> Option<RootCrack> {
    let (front, longest) = crack_front(keys, gear, fault)?;
    let length = match (&keys.length_percent, &keys.length_mm) {
        (Some(percent), None) => {
            let percent = at(percent, index);
            let has_path = !keys.path_across_mm.is_empty();
            let most = if has_path { 100.0 } else { 97.0 };
            if !(0.0..=most).contains(&percent) {
                fault("crack.length_percent", format!("must be 0 to {most}; {percent} is not"));
                return None;
            }
            let fraction = longest * percent / 100.0;
            if has_path { CrackLength::Path(fraction) } else { CrackLength::Chord(fraction) }
        }
        (None, Some(length)) => {
            let length = at(length, index);
            if !(length >= 0.0 && length.is_finite()) {
                fault("crack.length_mm", format!("must be 0 or more; {length} is not"));
                return None;
            }
            CrackLength::Length(longest * length * MM)
        }
        _ => {
            fault("crack", "give either length_percent or length_mm".into());
            return None;
        }
    };
    Some(RootCrack { side, start: crack_start(keys, fault)?, path: crack_path(keys, fault)?, length, front })
}

fn pit(
    keys: &PitKeys,
    pair: &GearPair,
    member: gear_geom::Member,
    index: usize,
    fault: &mut impl FnMut(&str, String),
) -> Option<Pit> {
    let landmarks = pair.landmarks(member);
    let shape = if keys.corners_face_mm.is_empty() && keys.corners_roll_distance_mm.is_empty() {
        let roll = match (keys.at, keys.roll_distance_mm) {
            (Some(_), Some(_)) => {
                fault("pit", "give either at or roll_distance_mm".into());
                return None;
            }
            (_, Some(roll)) => roll * MM,
            (name, None) => {
                let landmark = match name.unwrap_or(LandmarkName::Pitch) {
                    LandmarkName::Sap => Some(landmarks.sap),
                    LandmarkName::Lpstc => landmarks.lpstc,
                    LandmarkName::Pitch => Some(landmarks.pitch),
                    LandmarkName::Hpstc => landmarks.hpstc,
                    LandmarkName::Eap => Some(landmarks.eap),
                };
                let Some(landmark) = landmark else {
                    fault("pit.at", "a pair with a contact ratio of 2 or more has no single-tooth contact".into());
                    return None;
                };
                landmark.roll_distance
            }
        };
        let mut size = |name: &str, values: &Option<Values>| match values.as_ref().map(|v| at(v, index)) {
            Some(value) if value >= 0.0 && value.is_finite() => Some(value * MM),
            Some(value) => {
                fault(name, format!("must be 0 or more; {value} is not"));
                None
            }
            None => {
                fault(name, "this key is required for an ellipse".into());
                None
            }
        };
        let size = Vector2::new(size("pit.width_mm", &keys.width_mm)?, size("pit.height_mm", &keys.height_mm)?);
        let measure = match keys.height_along {
            HeightAlong::Flank => ProfileMeasure::ArcLength { base_radius: pair.gear(member).base_radius() },
            HeightAlong::LineOfAction => ProfileMeasure::RollDistance,
        };
        PitShape::Ellipse { centre: Vector2::new(keys.face_mm * MM, roll), size, measure }
    } else {
        let (face, roll) = (&keys.corners_face_mm, &keys.corners_roll_distance_mm);
        if face.len() != roll.len() || face.len() < 3 {
            fault(
                "pit",
                "a polygon needs corners_face_mm and corners_roll_distance_mm of the same length, 3 or more".into(),
            );
            return None;
        }
        PitShape::Polygon(face.iter().zip(roll).map(|(x, y)| Vector2::new(x * MM, y * MM)).collect())
    };
    let [face, roll] = shape.bounds();
    let half = 0.5 * pair.gear(member).facewidth();
    let ends = [landmarks.sap.roll_distance, landmarks.eap.roll_distance];
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    if face[0] > half || face[1] < -half || roll[0] > high || roll[1] < low {
        let (low, high) = (low / MM, high / MM);
        let half = half / MM;
        fault(
            "pit",
            format!("lies off the active flank: face -{half} to {half} mm, roll distance {low:.3} to {high:.3} mm"),
        );
        return None;
    }
    Some(Pit { shapes: vec![shape], depth: keys.depth_um.map(|depth| depth * UM) })
}

fn wear(
    keys: &Wear,
    gear: &Gear,
    index: usize,
    folder: &Path,
    fault: &mut impl FnMut(&str, String),
) -> Option<MeasuredDeviation> {
    let within = |value: f64, most: f64| (0.0..=most).contains(&value);
    match (&keys.depth_um, &keys.table) {
        (Some(depth), None) => {
            let depth = at(depth, index);
            if keys.scale.is_some() {
                fault("wear.scale", "this key goes with wear.table".into());
                return None;
            }
            if !within(depth, 1e5) {
                fault("wear.depth_um", format!("must be 0 to 100000; {depth} is not"));
                return None;
            }
            Some(MeasuredDeviation { roll: vec![0.0], face: vec![0.0], removed: vec![vec![depth * UM]] })
        }
        (None, Some(name)) => {
            let scale = keys.scale.as_ref().map_or(1.0, |values| at(values, index));
            if !within(scale, 1e5) {
                fault("wear.scale", format!("must be 0 to 100000; {scale} is not"));
                return None;
            }
            let mut table = read_deviation(&folder.join(name), gear.base_radius())
                .map_err(|message| fault("wear.table", message))
                .ok()?;
            if let Some(depth) = table.removed.iter().flatten().find(|depth| **depth < 0.0) {
                fault("wear.table", format!("wear takes material away: {} um is not allowed", depth / UM));
                return None;
            }
            table.removed.iter_mut().flatten().for_each(|depth| *depth *= scale);
            Some(table)
        }
        _ => {
            fault("wear", "give either depth_um or table".into());
            None
        }
    }
}

fn broken_corner(
    keys: &BrokenCorner,
    gear: &Gear,
    index: usize,
    fault: &mut impl FnMut(&str, String),
) -> Option<gear_geom::BrokenCorner> {
    let measure = ProfileMeasure::ArcLength { base_radius: gear.base_radius() };
    let [form, tip] = [gear.form_radius(), gear.tip_radius()].map(|radius| measure.at(gear.roll_distance(radius)));
    let mut size = |name: &str, values: &Values, most: f64, what: &str| {
        let value = at(values, index) * MM;
        if (0.0..=most).contains(&value) {
            return Some(value);
        }
        fault(name, format!("must be 0 to {:.3} ({what}); {} is not", most / MM, value / MM));
        None
    };
    let length = size("broken_corner.length_mm", &keys.length_mm, gear.facewidth(), "the facewidth");
    let height = size("broken_corner.height_mm", &keys.height_mm, (tip - form).abs(), "the arc length of the flank");
    Some(gear_geom::BrokenCorner::new(gear, keys.face_end == FaceEnd::Positive, length?, height?))
}
