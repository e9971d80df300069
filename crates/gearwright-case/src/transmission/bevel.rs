//! The bevel stage of a case: geometry, line of action, bodies.

use gear_geom::{BevelPair, BevelPlacement, BevelSpec, Hand as Spiral, LineOfAction};
use nalgebra::{Point3, Unit, Vector3};

use super::resolve::BodyValues;
use super::schema::{Body, Transmission};
use super::stage_schema::{Facing, Hand};
use crate::document::Node;
use crate::fault::Fault;

const MM: f64 = 1e-3;

/// A bevel stage.
#[derive(Debug, Clone)]
pub struct BevelStage {
    /// Geometry.
    pub pair: BevelPair,
    /// Where the teeth press.
    pub line: LineOfAction,
    /// Where the axes meet (m).
    pub apex: [f64; 3],
    /// The pinion; its centre from the apex outward.
    pub pinion: BodyValues,
    /// The gear, where a spline joins it to the sun; its centre above the gears' mid-face.
    pub gear: Option<BodyValues>,
}

/// The bevel stage of a case; `None` without one, or with faults.
pub fn bevel(inputs: &Transmission, document: &Node, faults: &mut Vec<Fault>) -> Option<BevelStage> {
    let written = inputs.bevel.as_ref()?;
    let before = faults.len();
    let bodies = &inputs.bodies;
    let mut whole = |name: &str, body: &Body| {
        let given = [
            ("mass_kg", body.mass_kg),
            ("inertia_kg_m2", body.inertia_kg_m2),
            ("transverse_inertia_kg_m2", body.transverse_inertia_kg_m2),
        ];
        for (key, _) in given.iter().filter(|(_, value)| value.is_none()) {
            faults.push(document.fault(&format!("bodies.{name}.{key}"), "this key is required with a bevel stage"));
        }
        let [mass, polar, transverse] = given.map(|(_, value)| value.unwrap_or(1.0));
        BodyValues { mass, polar, transverse, centre: body.centre_mm.unwrap_or_default() * MM }
    };
    let pinion = whole("bevel_pinion", &bodies.bevel_pinion);
    let gear = written.spline.map(|_| whole("bevel_gear", &bodies.bevel_gear));
    let pair = BevelPair::new(&BevelSpec {
        teeth: [written.pinion_teeth, written.gear_teeth],
        shaft_angle: written.shaft_angle_deg.to_radians(),
        module: written.module_mm * MM,
        facewidth: written.facewidth_mm * MM,
        spiral_angle: written.spiral_angle_deg.to_radians(),
        pinion_hand: match written.pinion_hand {
            Hand::Left => Spiral::Left,
            Hand::Right => Spiral::Right,
        },
        pressure_angle: written.pressure_angle_deg.to_radians(),
        thickness: [written.pinion_thickness_mm * MM, written.gear_thickness_mm * MM],
    });
    let pair = match pair {
        Ok(pair) => pair,
        Err(errors) => {
            let key = |parameter: &str| match parameter {
                "shaft_angle" => "bevel.shaft_angle_deg",
                "module" => "bevel.module_mm",
                "facewidth" => "bevel.facewidth_mm",
                "spiral_angle" => "bevel.spiral_angle_deg",
                "pressure_angle" => "bevel.pressure_angle_deg",
                "thickness" => "bevel.pinion_thickness_mm",
                _ => "bevel.pinion_teeth",
            };
            faults.extend(errors.0.iter().map(|e| document.fault(key(e.parameter()), e.to_string())));
            return None;
        }
    };
    let apex = [0.0, 0.0, written.apex_mm * MM];
    let up = if written.gear_back == Facing::Up { 1.0 } else { -1.0 };
    let angle = written.pinion_at_deg.to_radians();
    let line = pair.line_of_action(&BevelPlacement {
        apex: Point3::from(apex),
        gear_axis: Unit::new_normalize(Vector3::new(0.0, 0.0, up)),
        toward_pinion: Vector3::new(angle.cos(), angle.sin(), 0.0),
        // the gear turns with the sun, counter-clockwise about +z
        gear_turns_positive: written.gear_back == Facing::Up,
    });
    let line = line.map_err(|errors| faults.push(document.fault("bevel", errors.to_string()))).ok()?;
    (faults.len() == before).then_some(BevelStage { pair, line, apex, pinion, gear })
}
