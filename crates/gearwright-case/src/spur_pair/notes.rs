//! Notes on a spur-pair case: keys without effect, physics, assumptions. What gears, teeth and damage share with other kinds is here, too.

use fecm::pairing::Pairing;
use gear_geom::GearSpec;

use super::damage::Shapes;
use super::resolve::SpurPairCase;
use super::schema::{FilletShape, Gear, HubCondition, Member, Model};
use crate::document::Node;
use crate::fault::Fault;
use crate::notes::Notes;
use crate::physics::{self, NamedPair};

/// Why keys of the face do nothing in a plane model.
pub(crate) const PLANE: &str = "teeth are plane (analysis.model); only \"3d\" has a face";

/// Notes on a resolved case.
pub(super) fn notes(case: &SpurPairCase, document: &Node) -> Notes {
    let mut notes = Notes::default();
    let inputs = &case.inputs;
    for (name, gear) in [("pinion", &inputs.pinion), ("gear", &inputs.gear)] {
        gear_keys(name, gear, document, &mut notes);
    }
    contact_keys(
        "numerics",
        inputs.analysis.model,
        inputs.damage.iter().any(|d| d.crack.is_some()),
        document,
        &mut notes,
    );
    let mut idle = |section: &str, keys: &[&str], because: &str| notes.without_effect(document, section, keys, because);
    if inputs.load.map_torques == 0 {
        idle("load", &["map_from_n_m"], "there is no force-deflection map; give map_torques");
    }
    if inputs.load.map_torques == 1 {
        idle("load", &["map_from_n_m"], "a map of one torque is at torque_n_m");
    }
    if !inputs.analysis.stiffness_by_differences {
        idle("numerics", &["slope_step_percent"], "analysis.stiffness_by_differences is false");
    }
    if !inputs.output.vtu {
        idle("output", &["snapshot_mesh_cycle"], "output.vtu is false");
    }
    idle("material", &["density_kg_per_m3"], "statics have no inertia; kinds that refer to this file use it");
    for (index, damage) in inputs.damage.iter().enumerate() {
        damage_keys(&format!("damage[{}]", index + 1), damage.shapes(), document, &mut notes);
    }
    teeth_out_of_mesh(case, document, &mut notes);
    let radius = case.pair.wheel().base_radius();
    let scene = NamedPair {
        pair: &case.pair,
        options: &case.options,
        names: ["pinion", "gear"],
        load_key: "load.torque_n_m",
        force: inputs.load.torque_n_m / radius,
    };
    physics::judge(&scene, document, &mut notes);
    for (name, gear, bore) in
        [("pinion", case.pair.pinion(), case.options.pinion.bore), ("gear", case.pair.wheel(), case.options.wheel.bore)]
    {
        physics::rim(name, gear, bore, document, &mut notes);
    }
    assume(case, &mut notes);
    notes
}

fn assume(case: &SpurPairCase, notes: &mut Notes) {
    let (options, pair) = (&case.options, &case.pair);
    let gears = [("pinion", options.pinion.bore), ("gear", options.wheel.bore)];
    physics::assume(options.face, &gears, &[pair.pinion().facewidth().min(pair.wheel().facewidth())], notes);
}

/// Keys of a gear without effect.
pub(crate) fn gear_keys(name: &str, gear: &Gear, document: &Node, notes: &mut Notes) {
    let mut idle = |section: &str, keys: &[&str], because: &str| {
        notes.without_effect(document, &format!("{name}.{section}"), keys, because);
    };
    if gear.fillet.shape != Some(FilletShape::Shaper) {
        idle(
            "fillet",
            &["cutter_teeth", "cutter_addendum_modules"],
            "only a shaper cutter has it (fillet.shape = \"shaper\")",
        );
    }
    if gear.hub.condition != HubCondition::Elastic {
        idle("hub", &["stiffness_n_per_mm3"], "only an elastic hub has it (hub.condition = \"elastic\")");
    }
    let modification = &gear.modification;
    for (amount, keys) in [
        (modification.tip_relief_um, ["tip_relief_start_deg", "tip_relief_shape"]),
        (modification.root_relief_um, ["root_relief_start_deg", "root_relief_shape"]),
        (modification.end_relief_um, ["end_relief_length_mm", "end_relief_shape"]),
    ] {
        if amount == 0.0 {
            let relief = keys[0].split("_relief").next().unwrap_or_default();
            idle("modification", &keys, &format!("{relief}_relief_um is 0"));
        }
    }
}

/// Keys of the contact model without effect.
pub(crate) fn contact_keys(section: &str, model: Model, is_cracked: bool, document: &Node, notes: &mut Notes) {
    if model != Model::Solid {
        notes.without_effect(document, section, &["face_order", "face_cells", "edge_correction"], PLANE);
    }
    if !is_cracked {
        notes.without_effect(document, section, &["crack_face_contact"], "no tooth is cracked");
    }
}

/// Keys of a damage without effect.
pub(crate) fn damage_keys(section: &str, shapes: Shapes<'_>, document: &Node, notes: &mut Notes) {
    if let Some(pit) = shapes.pit
        && !pit.corners_face_mm.is_empty()
    {
        let keys = ["at", "roll_distance_mm", "face_mm", "width_mm", "height_mm", "height_along"];
        notes.without_effect(document, &format!("{section}.pit"), &keys, "the corners of a polygon are given");
    }
}

/// Damaged teeth that carry no load at any of the positions.
fn teeth_out_of_mesh(case: &SpurPairCase, document: &Node, notes: &mut Notes) {
    let pairing = Pairing::new(&case.pair);
    for (index, damage) in case.inputs.damage.iter().enumerate() {
        let member = usize::from(damage.on == Member::Gear);
        let teeth = i64::from(pairing.gear(member).teeth());
        let step = i64::from(pairing.tooth_steps()[member]);
        let has = |pair: i32| (i64::from(pair) * step - i64::from(damage.tooth)).rem_euclid(teeth) == 0;
        let meets = |cycle: &f64| pairing.candidates(*cycle).any(has);
        if !case.mesh_cycles.iter().any(meets) {
            let [from, to] = [case.inputs.analysis.mesh_cycle_from, case.inputs.analysis.mesh_cycle_to];
            let because = format!("this tooth does not come into mesh from mesh cycle {from} to {to}");
            notes.without_effect(document, "", &[&format!("damage[{}]", index + 1)], &because);
        }
    }
}

/// Faults of modifications that a model of the teeth cannot have.
pub(crate) fn plane_faults(
    name: &str,
    gear: &Gear,
    spec: Option<&GearSpec>,
    model: Model,
    document: &Node,
    faults: &mut Vec<Fault>,
) {
    if model == Model::Solid {
        return;
    }
    let modification = &gear.modification;
    for (key, amount) in [
        ("lead_crown_um", modification.lead_crown_um),
        ("end_relief_um", modification.end_relief_um),
        ("lead_slope_um", modification.lead_slope_um),
    ] {
        if amount != 0.0 {
            let message = "lead modifications need 3-D teeth: analysis.model = \"3d\"";
            faults.push(document.fault(&format!("{name}.modification.{key}"), message));
        }
    }
    let measured = spec.and_then(|spec| spec.modification.measured.as_ref());
    if measured.is_some_and(|table| table.face.len() > 1) {
        let message = "this deviation varies along the face: it needs 3-D teeth, analysis.model = \"3d\"";
        faults.push(document.fault(&format!("{name}.modification.deviation_table"), message));
    }
}

/// Faults of lists of pitch errors.
pub(crate) fn pitch_error_faults(name: &str, gear: &Gear, document: &Node, faults: &mut Vec<Fault>) {
    let (given, teeth) = (gear.modification.pitch_errors_um.len(), gear.teeth as usize);
    if given > teeth {
        let message = format!("has {given} values; this gear has {teeth} teeth");
        faults.push(document.fault(&format!("{name}.modification.pitch_errors_um"), message));
    }
}
