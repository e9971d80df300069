//! Notes on a transmission case: keys without effect, physics, assumptions.

use gear_geom::MeshSite;

use super::resolve::TransmissionCase;
use super::schema::Transmission;
use crate::document::Node;
use crate::notes::Notes;
use crate::physics::{self, NamedPair};
use crate::spur_pair::notes::{contact_keys, damage_keys, gear_keys};

/// Notes on a resolved case.
pub(super) fn notes(case: &TransmissionCase, document: &Node) -> Notes {
    let mut notes = Notes::default();
    let inputs = &case.inputs;
    for (name, gear) in [("sun", &inputs.sun), ("planet", &inputs.planet), ("ring", &inputs.ring)] {
        gear_keys(name, gear, document, &mut notes);
    }
    let is_cracked = inputs.damage.iter().any(|damage| damage.crack.is_some());
    contact_keys("contact", inputs.analysis.model, is_cracked, document, &mut notes);
    for (index, damage) in inputs.damage.iter().enumerate() {
        damage_keys(&format!("damage[{}]", index + 1), damage.shapes(), document, &mut notes);
    }
    idle_keys(case, document, &mut notes);
    if let Some(housing) = &inputs.housing {
        if housing.mesh.is_some() {
            mesh_keys(inputs, document, &mut notes);
        } else {
            let because = "there is no mesh of your own (housing.mesh)";
            notes.without_effect(document, "housing", &["mesh_units", "ring_seat"], because);
        }
    }
    judge(case, document, &mut notes);
    assume(case, &mut notes);
    notes
}

fn idle_keys(case: &TransmissionCase, document: &Node, notes: &mut Notes) {
    let inputs = &case.inputs;
    let mut idle = |section: &str, keys: &[&str], because: &str| notes.without_effect(document, section, keys, because);
    idle("contact", &["slope_step_percent"], "tables of meshes take the exact tangent");
    if document.find("train.planet_angles_deg").is_some() {
        idle("train", &["first_planet_deg"], "train.planet_angles_deg is given");
    }
    if case.bevel.is_none() {
        idle("bodies", &["bevel_pinion", "bevel_gear"], "there is no [bevel]");
    } else if inputs.bevel.as_ref().is_some_and(|bevel| bevel.spline.is_none()) {
        idle("bodies", &["bevel_gear"], "the gear is part of the sun: there is no [bevel.spline]");
    }
    if case.sensors.is_empty() {
        idle("signals", &["sideband_pairs"], "there are no sensors");
    }
    if inputs.around.is_none() {
        idle("output", &["around_signals"], "there is no [around]");
    }
    let given = |body: &str| {
        ["mass_kg", "inertia_kg_m2"].iter().all(|key| document.find(&format!("bodies.{body}.{key}")).is_some())
    };
    if ["sun", "planet", "carrier"].into_iter().all(given) {
        idle("material", &["density_kg_per_m3"], "mass and inertia of all bodies are given");
    }
}

/// Keys of a casing beside a mesh of the user's.
fn mesh_keys(inputs: &Transmission, document: &Node, notes: &mut Notes) {
    let because = "the housing is a mesh of your own (housing.mesh)";
    let keys = [
        "wall_height_mm",
        "wall_thickness_mm",
        "ring_inner_diameter_mm",
        "young_modulus_gpa",
        "poisson_ratio",
        "density_kg_per_m3",
        "element_size_mm",
    ];
    notes.without_effect(document, "housing", &keys, because);
    let Some(housing) = &inputs.housing else { return };
    for index in 1..=housing.mount.len() {
        let keys = ["angle_deg", "width_deg", "first_segment", "last_segment"];
        notes.without_effect(document, &format!("housing.mount[{index}]"), &keys, because);
    }
    for index in 1..=housing.port.len() {
        notes.without_effect(document, &format!("housing.port[{index}]"), &["segment"], because);
    }
}

fn judge(case: &TransmissionCase, document: &Node, notes: &mut Notes) {
    let names = [["sun", "planet"], ["planet", "ring"]];
    for ((site, options), names) in MeshSite::ALL.into_iter().zip(&case.pairs).zip(names) {
        let pair = case.train.pair(site);
        let scene = NamedPair { pair, options, names, load_key: "run.torque_n_m", force: case.mean_force() };
        physics::judge(&scene, document, notes);
        if site == MeshSite::SunPlanet {
            physics::rim(names[0], pair.pinion(), options.pinion.bore, document, notes);
        }
        physics::rim(names[1], pair.wheel(), options.wheel.bore, document, notes);
    }
}

fn assume(case: &TransmissionCase, notes: &mut Notes) {
    let [sun_planet, planet_ring] = &case.pairs;
    let gears = [("sun", sun_planet.pinion.bore), ("planet", sun_planet.wheel.bore), ("ring", planet_ring.wheel.bore)];
    let spec = case.train.spec();
    let widths = [&spec.sun, &spec.planet, &spec.ring].map(gear_geom::Gear::facewidth);
    physics::assume(sun_planet.face, &gears, &[widths[0].min(widths[1]), widths[1].min(widths[2])], notes);
    let ring = match &case.housing {
        Some(_) => "the ring's teeth sit in the elastic housing",
        None => "the ring stands on rigid ground",
    };
    notes.assume(format!("sun, planets, carrier and shafts are rigid bodies; {ring}"));
    let alike = match (case.tooth_errors.iter().all(Vec::is_empty), case.pin_errors.is_empty()) {
        (true, true) => "; all planets, and all sound teeth of a gear, are alike",
        (true, false) => "; all sound teeth of a gear are alike",
        (false, true) => "; all planets are alike",
        (false, false) => "",
    };
    notes.assume(format!("the input turns uniformly{alike}"));
}
