//! Kind `transmission`: vibration of a planetary transmission on bearings in an elastic housing.

pub mod bevel;
pub mod damage;
pub mod housing;
mod notes;
pub mod resolve;
pub mod schema;
pub mod stage_schema;

use super::kind::CaseKind;
use super::{Case, as_written};

pub use resolve::TransmissionCase;

/// The kind, its schema and its example.
pub const KIND: CaseKind = CaseKind {
    name: "transmission",
    about: "vibration of a planetary transmission: gears on bearings, elastic housing, sensors, damaged teeth",
    schema: || schemars::schema_for!(schema::Transmission).to_value(),
    resolve: |text, document, folder| {
        let written = as_written(text)?;
        resolve::resolve(written, document, folder).map(|case| Case::Transmission(Box::new(case)))
    },
    example: EXAMPLE,
};

/// Values of the example: a stage with three planets on bearings that stand on the ground, and a cracked tooth of the ring.
const EXAMPLE: &[(&str, &str)] = &[
    ("kind", "\"transmission\""),
    ("title", "\"Planetary stage, 27/35/99 teeth\""),
    ("mesh.module_mm", "2.8677419354838712"),
    ("mesh.pressure_angle_deg", "24.6"),
    ("mesh.centre_distance_mm", "88.9"),
    ("train.planets", "3"),
    ("sun.teeth", "27"),
    ("sun.tooth_thickness_mm", "4.52"),
    ("sun.tip_diameter_mm", "84.05"),
    ("sun.root_diameter_mm", "70.76"),
    ("sun.bore_diameter_mm", "62.23"),
    ("sun.fillet.radius_mm", "0.86"),
    ("sun.facewidth_mm", "34.93"),
    ("planet.teeth", "35"),
    ("planet.tooth_thickness_mm", "4.18"),
    ("planet.tip_diameter_mm", "104.98"),
    ("planet.root_diameter_mm", "91.54"),
    ("planet.bore_diameter_mm", "77.9"),
    ("planet.fillet.radius_mm", "0.55"),
    ("planet.facewidth_mm", "31.75"),
    ("ring.teeth", "99"),
    ("ring.tooth_thickness_mm", "6.92"),
    ("ring.tip_diameter_mm", "271.75"),
    ("ring.root_diameter_mm", "284.2"),
    ("ring.bore_diameter_mm", "296.55"),
    ("ring.fillet.shape", "\"circular\""),
    ("ring.fillet.radius_mm", "0.5"),
    ("ring.facewidth_mm", "25.4"),
    ("bearing.on", "\"sun\""),
    ("bearing.radial_stiffness_n_per_m", "1e8"),
    ("bearing.axial_stiffness_n_per_m", "1e8"),
    ("bearing.tilt_stiffness_n_m_per_rad", "1e6"),
    ("bearing[2].on", "\"planet\""),
    ("bearing[2].radial_stiffness_n_per_m", "2e8"),
    ("bearing[2].axial_stiffness_n_per_m", "1e8"),
    ("bearing[2].tilt_stiffness_n_m_per_rad", "1e5"),
    ("bearing[3].on", "\"carrier\""),
    ("bearing[3].radial_stiffness_n_per_m", "4e8"),
    ("bearing[3].axial_stiffness_n_per_m", "4e8"),
    ("bearing[3].tilt_stiffness_n_m_per_rad", "4e6"),
    ("damage.on", "\"ring\""),
    ("damage.angle_deg", "35.6"),
    ("damage.crack.length_percent", "[20.0, 50.0, 80.0]"),
    ("run.speed_rpm", "1621.7"),
    ("run.torque_n_m", "6106.0"),
];
