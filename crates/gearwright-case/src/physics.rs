//! Estimates of load and rim of a gear pair, for notes of `gearwright check`: closed forms, good to some ten percent.
//!
//! | estimate | formula | limit |
//! |---|---|---|
//! | contact pressure at the pitch point | `p_0 = sqrt(w E* / (pi rho))`, one pair carries all (Johnson, *Contact Mechanics*, 4.45) | 1.28 % of Young's modulus |
//! | bending stress in the root | `6 F cos(a) h / (b s^2)`, largest over the fillet, load at the outer point of single contact (Lewis) | 0.75 % of Young's modulus |
//! | deflection of the teeth | `w / c'`, `c' = 14 N/(mm um)` for steel (ISO 6336-1) | 0.05 modules |
//! | rim thickness factor `Y_B` | ISO 6336-3:2019, 9.5 | `s_R / h_t = 1.2`, of a ring `s_R / m_n = 3.5` |
//!
//! For steel the limits of stress are the static ones of case-hardened gears: `sigma_H,lim Z_NT = 1650 MPa x 1.6` (ISO 6336-2, -5) and
//! `sigma_FE Y_NT / Y_S`, about 1500 MPa (ISO 6336-3, -5). The model is linear elastic and does not know them.

use fecm::statics::PairModelOptions;
use fecm::{BoreCondition, FaceModel};
use gear_geom::{Gear, GearKind, GearPair, Member, OutlineSegment};

use super::document::Node;
use super::notes::Notes;

const MM: f64 = 1e-3;
const MPA: f64 = 1e6;
/// Contact pressure over Young's modulus.
const PRESSURE_LIMIT: f64 = 0.0128;
/// Bending stress over Young's modulus.
const BENDING_LIMIT: f64 = 0.0075;
/// Deflection of the teeth over the module.
const DEFLECTION_LIMIT: f64 = 0.05;
/// Single stiffness of a tooth pair of steel (N/m^2 of face and deflection), and the modulus it is for (Pa).
const TOOTH_STIFFNESS: (f64, f64) = (14e9, 206e9);
/// Points along a fillet.
const FILLET_POINTS: u32 = 64;

/// A pair of gears with its keys.
pub(super) struct NamedPair<'a> {
    /// Its geometry.
    pub pair: &'a GearPair,
    /// Material and hubs.
    pub options: &'a PairModelOptions,
    /// Sections of pinion and wheel.
    pub names: [&'a str; 2],
    /// Key that loads it.
    pub load_key: &'a str,
    /// Normal force of the mesh (N).
    pub force: f64,
}

/// Warns of findings of the geometry and of overload.
pub(super) fn judge(scene: &NamedPair<'_>, document: &Node, notes: &mut Notes) {
    for finding in scene.pair.findings() {
        let text = finding.to_string().replace("pinion", scene.names[0]).replace("wheel", scene.names[1]);
        notes.warn(document, "", text);
    }
    overload(scene, document, notes);
}

/// Warns of load beyond what the teeth can bear.
pub(super) fn overload(scene: &NamedPair<'_>, document: &Node, notes: &mut Notes) {
    let NamedPair { pair, options, names, load_key, force } = scene;
    let materials = [options.pinion.material, options.wheel.material];
    let modulus = materials[0].young_modulus.min(materials[1].young_modulus);
    let width = pair.pinion().facewidth().min(pair.wheel().facewidth());
    let line_load = force / width;
    let mut warn = |what: &str, value: String, limit: String| {
        let message = format!(
            "{}-{}: {what} is about {value}, more than {limit}; the model is linear elastic, results hold in proportion only",
            names[0], names[1]
        );
        notes.warn(document, load_key, message);
    };
    let pressure = hertz_pressure(scene, line_load);
    if pressure > PRESSURE_LIMIT * modulus {
        let limit = format!(
            "{:.0} MPa, the static limit of case-hardened steel scaled to this Young's modulus (ISO 6336-2)",
            PRESSURE_LIMIT * modulus / MPA
        );
        warn("the contact pressure at the pitch point", format!("{:.0} MPa", pressure / MPA), limit);
    }
    for (name, member) in names.iter().zip([Member::Pinion, Member::Wheel]) {
        let stress = root_bending(pair, member) * line_load;
        if stress > BENDING_LIMIT * modulus {
            let limit = format!(
                "{:.0} MPa, the static limit of case-hardened steel scaled to this Young's modulus (ISO 6336-3)",
                BENDING_LIMIT * modulus / MPA
            );
            warn(&format!("the bending stress in the root of the {name}"), format!("{:.0} MPa", stress / MPA), limit);
        }
    }
    let deflection = line_load / (TOOTH_STIFFNESS.0 * modulus / TOOTH_STIFFNESS.1);
    let module = pair.pinion().module();
    if deflection > DEFLECTION_LIMIT * module {
        let limit = format!("{DEFLECTION_LIMIT} modules, where teeth still deform linearly");
        warn("the deflection of the teeth", format!("{:.3} mm", deflection / MM), limit);
    }
}

/// Largest pressure of a line contact at the pitch point (Pa).
fn hertz_pressure(scene: &NamedPair<'_>, line_load: f64) -> f64 {
    let pair = scene.pair;
    let roll = pair.pitch_roll();
    let other = pair.partner_roll(Member::Pinion, roll);
    let curvature = 1.0 / roll + pair.wheel().kind().sigma() / other;
    let give = |m: fecm::Material| (1.0 - m.poisson_ratio.powi(2)) / m.young_modulus;
    let modulus = 1.0 / (give(scene.options.pinion.material) + give(scene.options.wheel.material));
    (line_load * modulus * curvature.abs() / std::f64::consts::PI).sqrt()
}

/// Largest bending stress along the fillet for a unit load per length of face (1/m), load at the outer point of single contact, or at the tip.
fn root_bending(pair: &GearPair, member: Member) -> f64 {
    let gear = pair.gear(member);
    let landmarks = pair.landmarks(member);
    let roll = landmarks.hpstc.unwrap_or(landmarks.eap).roll_distance;
    // between the normal of the flank and the perpendicular of the tooth's centre line
    let angle = roll / gear.base_radius() - gear.kind().sigma() * gear.base_half_angle();
    let arm = gear.base_radius() / angle.cos();
    let outline = gear.half_tooth_outline();
    let at = |k: u32| {
        let point = outline.point(OutlineSegment::Fillet, f64::from(k) / f64::from(FILLET_POINTS));
        6.0 * angle.cos() * (arm - point.x).abs() / (4.0 * point.y * point.y)
    };
    (0..=FILLET_POINTS).map(at).fold(0.0, f64::max)
}

/// Warns of a thin rim.
pub(super) fn rim(name: &str, gear: &Gear, bore: BoreCondition, document: &Node, notes: &mut Notes) {
    let thickness = (gear.root_radius() - gear.rim_radius()).abs();
    let height = (gear.tip_radius() - gear.root_radius()).abs();
    let (what, ratio, enough, factor) = match gear.kind() {
        GearKind::External => ("tooth heights", thickness / height, 1.2, 1.6 * (2.242 * height / thickness).ln()),
        GearKind::Internal => {
            ("modules", thickness / gear.module(), 3.5, 1.15 * (8.324 * gear.module() / thickness).ln())
        }
    };
    if ratio >= enough {
        return;
    }
    let held = match bore {
        BoreCondition::RigidHub => {
            "here it is bonded to a rigid body and does not bend, so the mesh is too stiff if the real one is not held like that"
        }
        BoreCondition::ElasticHub { .. } => "the springs at the bore decide how far it bends",
        BoreCondition::Tractions => "here it is free at the bore, so the mesh is too soft if the real one is held",
    };
    let message = format!(
        "thin rim: {:.2} mm under the teeth, {ratio:.2} {what}; below {enough} bending of the rim counts (ISO 6336-3, Y_B = {factor:.2}); {held}",
        thickness / MM
    );
    notes.warn(document, &format!("{name}.bore_diameter_mm"), message);
}

/// Assumptions on teeth and hubs of gears that share a face model, with the common facewidth of each of their pairs.
pub(super) fn assume(face: FaceModel, gears: &[(&str, BoreCondition)], widths: &[f64], notes: &mut Notes) {
    let widths = widths.iter().map(|width| format!("{:.2}", width / MM)).collect::<Vec<_>>().join(" and ");
    let plane = |what: &str| format!("teeth in {what}: nothing varies along the common face of {widths} mm");
    notes.assume(
        match face {
            FaceModel::Solid { .. } => "teeth in three dimensions".to_owned(),
            FaceModel::PlaneStress => plane("plane stress (thin gears)"),
            FaceModel::PlaneStrain => plane("plane strain (wide gears)"),
        } + "; linear elastic, no friction, no lubricant",
    );
    for (condition, text) in [
        ("rigid", "bonded at the bore to a rigid body, a ring at its outside"),
        ("elastic", "held at the bore by springs on a rigid body"),
        ("tractions", "without a hub: the torque is spread evenly over the bore"),
    ] {
        let name = |bore: &BoreCondition| match bore {
            BoreCondition::RigidHub => "rigid",
            BoreCondition::ElasticHub { .. } => "elastic",
            BoreCondition::Tractions => "tractions",
        };
        let held: Vec<&str> = gears.iter().filter(|(_, bore)| name(bore) == condition).map(|(gear, _)| *gear).collect();
        if !held.is_empty() {
            let text = if held.contains(&"ring") { text } else { text.trim_end_matches(", a ring at its outside") };
            notes.assume(format!("{}: {text}", held.join(", ")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gear_geom::GearSpec;

    fn pair() -> GearPair {
        let gear = Gear::new(&GearSpec::standard(25, 6e-3).with(|gear| gear.facewidth = 16e-3)).unwrap();
        GearPair::new(gear.clone(), gear, 150.1e-3).unwrap()
    }

    /// Lewis's form factor of a full-depth 20 degree gear of 25 teeth loaded at the tip is 0.340 (Shigley, table 14-2): tip load `F_t / (b m Y)`.
    /// At the outer point of single contact the arm is shorter and the stress lower, by a third to a half.
    #[test]
    fn analytic_root_bending_follows_lewis() {
        let pair = pair();
        let factor = root_bending(&pair, Member::Pinion) * pair.pinion().module();
        let tip = 20_f64.to_radians().cos() / 0.340;
        assert!(factor < 0.85 * tip && factor > 0.45 * tip, "{factor} {tip}");
    }

    /// The pressure of two steel cylinders by Hertz.
    #[test]
    fn analytic_hertz_pressure() {
        let pair = pair();
        let options = PairModelOptions::default();
        let scene = NamedPair { pair: &pair, options: &options, names: ["pinion", "gear"], load_key: "", force: 1.0 };
        let radius = 0.5 * pair.pitch_roll();
        let modulus = options.pinion.material.young_modulus / (2.0 * (1.0 - 0.09));
        let expected = (1e5 * modulus / (std::f64::consts::PI * radius)).sqrt();
        assert!((hertz_pressure(&scene, 1e5) / expected - 1.0).abs() < 2e-3);
    }
}
