//! From keys to gears: defaults filled in, units converted (here and nowhere else), geometry checked, faults told at their keys.

use std::path::Path;

use fecm::statics::{ContactOptions, MemberOptions, PairModelOptions};
use fecm::{BoreCondition, FaceModel, MeshDensity, SolverKind};
use gear_geom::{
    EndRelief, FilletSpec, FlankModification, GearKind, GearPair, GearSpec, MeasuredDeviation, ProfileRelief,
    ToothThickness,
};

use super::damage::{Severity, severities};
use super::notes::{notes as notes_on, pitch_error_faults, plane_faults};
use super::schema::{
    FilletShape, Form, Gear, HubCondition, Material, Mesh, Model, Modification, Numerics, ReliefShape, Solver, SpurPair,
};
use crate::document::Node;
use crate::fault::Fault;
use crate::geometry::geometry_fault;
use crate::input;
use crate::notes::Notes;

const MM: f64 = 1e-3;
const UM: f64 = 1e-6;

/// A spur-pair case, ready to run.
#[derive(Debug, Clone)]
pub struct SpurPairCase {
    /// The case with every default filled in.
    pub inputs: SpurPair,
    /// Gears in mesh.
    pub pair: GearPair,
    /// Model options.
    pub options: PairModelOptions,
    /// Mesh cycles to solve, counted from the pitch point.
    pub mesh_cycles: Vec<f64>,
    /// Torques of the force-deflection map (N m), ascending; empty for none.
    pub map_torques: Vec<f64>,
    /// Damaged pairs to compute after the healthy one.
    pub severities: Vec<Severity>,
    /// Warnings and assumptions.
    pub notes: Notes,
}

/// Resolves a case; `folder` is where files it refers to are looked for.
///
/// # Errors
/// All faults that can be told together.
pub fn resolve(mut inputs: SpurPair, document: &Node, folder: &Path) -> Result<SpurPairCase, Vec<Fault>> {
    let mut faults = Vec::new();
    if inputs.pinion.form == Some(Form::Internal) {
        faults.push(document.fault("pinion.form", "the pinion is external; give the ring as the gear"));
    }
    fill_defaults(&mut inputs.pinion, &inputs.mesh, Form::External);
    fill_defaults(&mut inputs.gear, &inputs.mesh, Form::External);
    let specs = [("pinion", &inputs.pinion), ("gear", &inputs.gear)]
        .map(|(name, gear)| spec(name, gear, &inputs.mesh, document, folder, &mut faults));
    for ((name, gear), made) in [("pinion", &inputs.pinion), ("gear", &inputs.gear)].into_iter().zip(&specs) {
        plane_faults(name, gear, made.as_ref(), inputs.analysis.model, document, &mut faults);
        pitch_error_faults(name, gear, document, &mut faults);
    }
    let options = options(&inputs, document, &mut faults);
    let mesh_cycles = mesh_cycles(&inputs, document, &mut faults);
    let map_torques = map_torques(&inputs, document, &mut faults);
    let [pinion, wheel] = specs;
    let mut gears = Vec::new();
    for (name, spec) in [("pinion", pinion), ("gear", wheel)] {
        let Some(spec) = spec else { continue };
        match gear_geom::Gear::new(&spec) {
            Ok(gear) => gears.push(gear),
            Err(errors) => faults.extend(errors.0.iter().map(|e| geometry_fault(document, Some(name), e))),
        }
    }
    if !faults.is_empty() || gears.len() != 2 {
        return Err(faults);
    }
    let wheel = gears.remove(1);
    let pinion = gears.remove(0);
    match GearPair::new(pinion, wheel, inputs.mesh.centre_distance_mm * MM) {
        Ok(pair) => {
            let severities = severities(&inputs, &pair, document, folder, &mut faults);
            if !faults.is_empty() {
                return Err(faults);
            }
            let notes = Notes::default();
            let mut case = SpurPairCase { inputs, pair, options, mesh_cycles, map_torques, severities, notes };
            case.notes = notes_on(&case, document);
            Ok(case)
        }
        Err(errors) => Err(errors.0.iter().map(|e| geometry_fault(document, None, e)).collect()),
    }
}

/// Spells out the defaults that depend on other keys; `form` is that of a gear that does not say.
pub(crate) fn fill_defaults(gear: &mut Gear, mesh: &Mesh, form: Form) {
    let module = mesh.module_mm;
    let form = *gear.form.get_or_insert(form);
    gear.tip_round_mm.get_or_insert(0.02 * module);
    if gear.tooth_thickness_mm.is_none() {
        gear.profile_shift.get_or_insert(0.0);
    }
    let natural = if form == Form::External { FilletShape::Rack } else { FilletShape::Shaper };
    let fillet = &mut gear.fillet;
    let shape = *fillet.shape.get_or_insert(natural);
    fillet.radius_mm.get_or_insert(if shape == FilletShape::Shaper { 0.2 } else { 0.38 } * module);
    if shape == FilletShape::Shaper {
        fillet.cutter_teeth.get_or_insert((gear.teeth / 4).max(6));
        fillet.cutter_addendum_modules.get_or_insert(1.25);
    }
}

/// A gear in SI units.
pub(crate) fn spec(
    name: &str,
    gear: &Gear,
    mesh: &Mesh,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<GearSpec> {
    if gear.tooth_thickness_mm.is_some() && gear.profile_shift.is_some() {
        let message = "give either tooth_thickness_mm or profile_shift, not both";
        faults.push(document.fault(&format!("{name}.profile_shift"), message));
    }
    let kind = if gear.form == Some(Form::Internal) { GearKind::Internal } else { GearKind::External };
    let radius = gear.fillet.radius_mm.unwrap_or_default() * MM;
    let fillet = match gear.fillet.shape {
        Some(FilletShape::Circular) => FilletSpec::Circular { radius },
        Some(FilletShape::Shaper) => FilletSpec::Shaper {
            teeth: gear.fillet.cutter_teeth.unwrap_or_default(),
            addendum: gear.fillet.cutter_addendum_modules.unwrap_or_default(),
            tip_radius: radius,
        },
        _ => FilletSpec::Rack { tip_radius: radius },
    };
    let mut spec = GearSpec::standard(gear.teeth, mesh.module_mm * MM);
    spec.kind = kind;
    spec.pressure_angle = mesh.pressure_angle_deg.to_radians();
    spec.thickness = match (gear.tooth_thickness_mm, gear.profile_shift) {
        (Some(thickness), _) => ToothThickness::AtReference(thickness * MM),
        (None, shift) => ToothThickness::ProfileShift(shift.unwrap_or_default()),
    };
    spec.tip_radius = 0.5 * gear.tip_diameter_mm * MM;
    spec.root_radius = 0.5 * gear.root_diameter_mm * MM;
    spec.rim_radius = 0.5 * gear.bore_diameter_mm * MM;
    spec.facewidth = gear.facewidth_mm * MM;
    spec.fillet = fillet;
    spec.tip_round = gear.tip_round_mm.unwrap_or_default() * MM;
    spec.pitch_errors = gear.modification.pitch_errors_um.iter().map(|e| e * UM).collect();
    // relief ends where the plain involute does
    let plain = gear_geom::Gear::new(&spec).ok();
    let ends = plain.map(|gear| [gear.form_radius(), gear.tip_radius()].map(|r| gear.roll_distance(r)));
    let base = spec.reference_radius() * spec.pressure_angle.cos();
    let section = format!("{name}.modification");
    spec.modification = modification(&section, &gear.modification, base, ends, document, folder, faults)?;
    Some(spec)
}

fn shape(shape: ReliefShape) -> gear_geom::ReliefShape {
    match shape {
        ReliefShape::Linear => gear_geom::ReliefShape::Linear,
        ReliefShape::Parabolic => gear_geom::ReliefShape::Parabolic,
    }
}

fn modification(
    section: &str,
    written: &Modification,
    base: f64,
    ends: Option<[f64; 2]>,
    document: &Node,
    folder: &Path,
    faults: &mut Vec<Fault>,
) -> Option<FlankModification> {
    let before = faults.len();
    let mut relief = |name: &str, amount: f64, start: Option<f64>, growth: ReliefShape, end: Option<f64>| {
        if amount == 0.0 {
            return None;
        }
        let key = format!("{section}.{name}_start_deg");
        let Some(start) = start else {
            faults.push(
                document
                    .fault(&key, format!("this key is required with {name}_um: the roll angle where relief begins")),
            );
            return None;
        };
        let start_roll = start.to_radians() * base;
        let end_roll = end?;
        let (low, high) = ends.map_or((0.0, 0.0), |[a, b]| (a.min(b), a.max(b)));
        if start_roll <= low || start_roll >= high {
            let degrees = |roll: f64| (roll / base).to_degrees();
            let message = format!(
                "must lie on the involute: between {:.3} and {:.3} degrees of roll",
                degrees(low),
                degrees(high)
            );
            faults.push(document.fault(&key, message));
            return None;
        }
        Some(ProfileRelief { amount: amount * UM, start_roll, end_roll, shape: shape(growth) })
    };
    let tip_relief = relief(
        "tip_relief",
        written.tip_relief_um,
        written.tip_relief_start_deg,
        written.tip_relief_shape,
        ends.map(|e| e[1]),
    );
    let root_relief = relief(
        "root_relief",
        written.root_relief_um,
        written.root_relief_start_deg,
        written.root_relief_shape,
        ends.map(|e| e[0]),
    );
    let end_relief = match (written.end_relief_um, written.end_relief_length_mm) {
        (0.0, _) => None,
        (amount, Some(length)) => {
            Some(EndRelief { amount: amount * UM, length: length * MM, shape: shape(written.end_relief_shape) })
        }
        (_, None) => {
            let message = "this key is required with end_relief_um: the length of the relieved part at each end";
            faults.push(document.fault(&format!("{section}.end_relief_length_mm"), message));
            None
        }
    };
    let measured = written.deviation_table.as_ref().and_then(|name| {
        read_deviation(&folder.join(name), base)
            .map_err(|message| faults.push(document.fault(&format!("{section}.deviation_table"), message)))
            .ok()
    });
    (faults.len() == before).then_some(FlankModification {
        tip_relief,
        root_relief,
        lead_crown: written.lead_crown_um * UM,
        end_relief,
        lead_slope: written.lead_slope_um * UM,
        measured,
    })
}

/// Reads a deviation table: face positions (mm) in the first row, roll angles (degrees) in the first column, removed material (um).
pub(super) fn read_deviation(file: &Path, base: f64) -> Result<MeasuredDeviation, String> {
    let bytes = input::read(file, input::MAX_TABLE).map_err(|e| format!("the table cannot be read: {e}"))?;
    let mut format = csv::ReaderBuilder::new();
    let mut reader = format.has_headers(false).comment(Some(b'#')).trim(csv::Trim::All).from_reader(&bytes[..]);
    let mut table = MeasuredDeviation::default();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|e| format!("the table cannot be read: {e}"))?;
        let number = |column: usize, cell: &str| {
            cell.parse::<f64>()
                .map_err(|_| format!("row {}, column {} of the table is {cell:?}, not a number", row + 1, column + 1))
        };
        let cells = record.iter().enumerate().skip(1);
        if row == 0 {
            table.face = cells.map(|(c, cell)| number(c, cell).map(|z| z * MM)).collect::<Result<_, _>>()?;
        } else {
            table.roll.push(number(0, &record[0])?.to_radians() * base);
            table.removed.push(cells.map(|(c, cell)| number(c, cell).map(|d| d * UM)).collect::<Result<_, _>>()?);
        }
    }
    if table.is_valid() {
        Ok(table)
    } else {
        Err("the table must be full, with ascending face positions in its first row and roll angles in its first column".into())
    }
}

fn options(inputs: &SpurPair, document: &Node, faults: &mut Vec<Fault>) -> PairModelOptions {
    let numerics = &inputs.numerics;
    let mut member =
        |name: &str, gear: &Gear| member_options((name, gear), &inputs.material, numerics, document, faults);
    PairModelOptions {
        damage: [Vec::new(), Vec::new()],
        pinion: member("pinion", &inputs.pinion),
        wheel: member("gear", &inputs.gear),
        face: face_model(inputs.analysis.model, numerics),
        contact: contact_options(numerics),
    }
}

/// Material, mesh and hub of a gear.
pub(crate) fn member_options(
    (name, gear): (&str, &Gear),
    material: &Material,
    numerics: &Numerics,
    document: &Node,
    faults: &mut Vec<Fault>,
) -> MemberOptions {
    let bore = match (gear.hub.condition, gear.hub.stiffness_n_per_mm3) {
        (HubCondition::Rigid, _) => BoreCondition::RigidHub,
        (HubCondition::Tractions, _) => BoreCondition::Tractions,
        (HubCondition::Elastic, Some(stiffness)) => BoreCondition::ElasticHub { stiffness: stiffness * 1e9 },
        (HubCondition::Elastic, None) => {
            let message = "this key is required with an elastic hub: spring stiffness per area";
            faults.push(document.fault(&format!("{name}.hub.stiffness_n_per_mm3"), message));
            BoreCondition::RigidHub
        }
    };
    let material = fecm::Material {
        young_modulus: material.young_modulus_gpa * 1e9,
        poisson_ratio: material.poisson_ratio,
        density: material.density_kg_per_m3,
    };
    let mesh = MeshDensity { order: numerics.element_order as usize, density: numerics.mesh_density };
    MemberOptions { material, mesh, bore }
}

/// Model along the face.
pub(crate) fn face_model(model: Model, numerics: &Numerics) -> FaceModel {
    match model {
        Model::Solid => FaceModel::Solid { order: numerics.face_order as usize },
        Model::PlaneStress => FaceModel::PlaneStress,
        Model::PlaneStrain => FaceModel::PlaneStrain,
    }
}

/// Contact grid and solver.
pub(crate) fn contact_options(numerics: &Numerics) -> ContactOptions {
    ContactOptions {
        cells_per_half_width: numerics.cells_per_half_width,
        face_cells: numerics.face_cells as usize,
        profile_order: numerics.profile_order as usize,
        edge_correction: numerics.edge_correction,
        slope_step: 0.01 * numerics.slope_step_percent,
        crack_face_contact: numerics.crack_face_contact,
        solver: match numerics.solver {
            Solver::ActiveSet => SolverKind::ActiveSet,
            Solver::Lemke => SolverKind::Lemke,
        },
    }
}

fn mesh_cycles(inputs: &SpurPair, document: &Node, faults: &mut Vec<Fault>) -> Vec<f64> {
    let analysis = &inputs.analysis;
    let span = analysis.mesh_cycle_to - analysis.mesh_cycle_from;
    if !(span >= 0.0) {
        let message = format!("must not be before mesh_cycle_from = {}", analysis.mesh_cycle_from);
        faults.push(document.fault("analysis.mesh_cycle_to", message));
        return Vec::new();
    }
    let steps = (span * f64::from(analysis.positions_per_cycle)).round() as u64;
    if steps > 1_000_000 {
        faults.push(document.fault("analysis.positions_per_cycle", "at most a million positions in all"));
        return Vec::new();
    }
    // a whole number of cycles does not repeat its first position
    let whole = span > 0.0 && (span - span.round()).abs() < 1e-9;
    let count = if whole { steps } else { steps + 1 };
    let start = analysis.mesh_cycle_from - analysis.mesh_cycle_origin;
    (0..count).map(|k| start + k as f64 / f64::from(analysis.positions_per_cycle)).collect()
}

fn map_torques(inputs: &SpurPair, document: &Node, faults: &mut Vec<Fault>) -> Vec<f64> {
    let load = &inputs.load;
    let (from, to, count) = (load.map_from_n_m.unwrap_or(1e-3 * load.torque_n_m), load.torque_n_m, load.map_torques);
    if count > 0 && from >= to {
        faults.push(document.fault("load.map_from_n_m", format!("must be below torque_n_m = {to}")));
        return Vec::new();
    }
    if count == 1 {
        return vec![to];
    }
    (0..count).map(|k| from + (to - from) * f64::from(k) / f64::from(count - 1)).collect()
}
