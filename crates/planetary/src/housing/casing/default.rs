//! The default housing.
//!
//! Its ring is that of the dissertation (Table 5.1: outer diameter 296.55 mm, face width 25.4 mm, 99 teeth; root radius 141.9 mm). How
//! it is held follows the OH-58A: two pylon supports on the sides, and an isolation mount at the lower rear, on the side of the input (operator's
//! manual TM 55-1520-228-10, paragraphs 2-36 and 2-37). Everything else of the housing is not printed, and is chosen: an aluminium casing of the
//! size that ring and bevel stage ask for, the supports at the ring's height, ribs on the upper cover, stiffness of the mounts as on a test stand.

use fecm::Material;

use super::{
    BearingPart, BossBearing, Casing, CasingDensity, InputPart, MountPart, RingPart, SensorPlace, Swelling, WallPoint,
};
use crate::housing::model::SensorAt;

/// Cast aluminium.
const ALUMINIUM: Material = Material { young_modulus: 71e9, poisson_ratio: 0.33, density: 2770.0 };

/// Middle of the wall: radius, height, thickness (mm).
const WALL: [(f64, f64, f64); 14] = [
    // lower hub, downward
    (44.0, -112.0, 9.0),
    (44.0, -132.0, 9.0),
    (44.0, -152.0, 10.0),
    // bottom
    (138.0, -152.0, 8.0),
    // side, with the input port in the second segment
    (152.3, -137.0, 8.0),
    (152.3, -45.0, 8.0),
    (152.3, -12.7, 8.0),
    (152.3, 12.7, 8.0),
    (152.3, 32.0, 7.0),
    // upper cover
    (134.0, 60.0, 6.5),
    (72.0, 84.0, 7.0),
    (50.0, 92.0, 9.0),
    // upper hub
    (50.0, 112.0, 9.0),
    (50.0, 132.0, 9.0),
];

/// Pitch of the ring's 99 teeth (rad).
const TOOTH: f64 = std::f64::consts::TAU / 99.0;
/// Angle of the ring's damaged tooth (rad), and tooth 0 of the sensors.
const DAMAGED: f64 = 35.6 * DEGREE;
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Angle of the input (rad): near its sensor.
const INPUT: f64 = 30.0 * DEGREE;
/// Teeth of the ring in the middle of the two supports, counted from the damaged one.
const SUPPORTS: [usize; 2] = [23, 73];
/// Teeth on either side of it that the support covers too.
const COVERED: usize = 3;

impl Default for Casing {
    fn default() -> Self {
        let mm = 1e-3;
        let support = |tooth: usize| DAMAGED + TOOTH * tooth as f64;
        let width = TOOTH * (2 * COVERED + 1) as f64;
        let mount = |name: &str, tooth| MountPart {
            name: name.to_owned(),
            angle: support(tooth),
            width,
            segments: [5, 6],
            stiffness: [2e8, 2e8, 2e8],
        };
        let wall: Vec<WallPoint> =
            WALL.iter().map(|&(r, z, t)| WallPoint { r: r * mm, z: z * mm, thickness: t * mm }).collect();
        let length_to =
            |index: usize| -> f64 { wall[..=index].windows(2).map(|w| (w[1].r - w[0].r).hypot(w[1].z - w[0].z)).sum() };
        let pad = |tooth| Swelling {
            angle: support(tooth),
            width,
            along: length_to(6),
            length: 50.0 * mm,
            thickness: 12.0 * mm,
        };
        // between the supports and over them
        let rib = |k: usize| Swelling {
            angle: support(SUPPORTS[0]) + std::f64::consts::TAU * k as f64 / 8.0,
            width: 10.0 * DEGREE,
            along: 0.5 * (length_to(8) + length_to(11)),
            length: length_to(11) - length_to(8),
            thickness: 10.0 * mm,
        };
        let bearing = |name: &str, segment| BearingPart { name: name.to_owned(), segment };
        let boss =
            |name: &str, first: f64, last: f64| BossBearing { name: name.to_owned(), span: [first * mm, last * mm] };
        Self {
            material: ALUMINIUM,
            ring: Some(RingPart { segment: 6, inner_radius: 141.9 * mm, material: Material::STEEL }),
            seat_harmonics: 20,
            swellings: SUPPORTS.map(pad).into_iter().chain((0..8).map(rib)).collect(),
            mounts: vec![
                mount("support_1", SUPPORTS[0]),
                mount("support_2", SUPPORTS[1]),
                MountPart {
                    name: "restraint".to_owned(),
                    angle: INPUT,
                    width: 40.0 * DEGREE,
                    segments: [2, 2],
                    stiffness: [5e7, 5e7, 5e6],
                },
            ],
            bearings: vec![
                bearing("shaft_upper", 0),
                bearing("shaft_lower", 1),
                bearing("mast_lower", 11),
                bearing("mast_upper", 12),
            ],
            input: Some(InputPart {
                segment: 4,
                angle: INPUT,
                width: 36.0 * DEGREE,
                thickness: 10.0 * mm,
                elevation: 5.0 * DEGREE,
                bearings: vec![boss("pinion_inner", 172.0, 187.0), boss("pinion_outer", 207.0, 222.0)],
            }),
            sensors: sensors(),
            density: CasingDensity { element_size: 20.0 * mm, through_wall: 1, through_ring: 1 },
            wall,
        }
    }
}

/// Radial ones at the ring's height: `input` near the input port, `tooth_J` at ring tooth `J` counted from the damaged one, but over the supports.
fn sensors() -> Vec<SensorPlace> {
    let wall = |name: String, angle: f64| SensorPlace {
        name,
        at: SensorAt::Wall { angle: angle.rem_euclid(std::f64::consts::TAU), z: 0.0 },
        direction: None,
    };
    let covered = |tooth: usize| SUPPORTS.iter().any(|support| support.abs_diff(tooth) <= COVERED);
    let teeth = (0..99).filter(|&tooth| !covered(tooth));
    let teeth = teeth.map(|tooth| wall(format!("tooth_{tooth}"), DAMAGED + TOOTH * tooth as f64));
    std::iter::once(wall("input".to_owned(), 33.1 * DEGREE)).chain(teeth).collect()
}
