//! Transmissions shared by the tests of the engine.
#![allow(dead_code, reason = "each test file uses some")]

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use faer::Mat;
use planetary::elastic::{ElasticBody, Port, RingSeat, Sensor};
use planetary::engine::{
    Anchor, Bearing, BevelStage, BodyId, CoastFlank, Mesh, Planet, PlanetaryStage, RigidBody, TransmissionSpec,
};
use planetary::mesh::{MeshLaw, MeshResponse};

pub const STANDING_AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Teeth of the dissertation's train (Table 5.1).
pub const TEETH: [u32; 3] = [27, 35, 99];
/// Its centre distance (m).
pub const CENTRE: f64 = 0.0889;

/// A spring that only pushes, whose stiffness may vary over the mesh cycle: `k (1 + depth cos(2 pi c))`.
#[derive(Debug, Clone, Copy)]
pub struct Spring {
    pub stiffness: f64,
    pub depth: f64,
}

impl MeshLaw for Spring {
    fn response(&self, mesh_cycle: f64, approach: f64) -> MeshResponse {
        let stiffness = self.stiffness * (1.0 + self.depth * (TAU * mesh_cycle).cos());
        if approach >= 0.0 { MeshResponse { force: stiffness * approach, stiffness } } else { MeshResponse::default() }
    }
}

pub fn mesh(stiffness: f64, depth: f64, cycle_offset: f64) -> Mesh {
    Mesh { law: Arc::new(Spring { stiffness, depth }), cycle_offset, damping: 0.0, damping_force: 1.0, coast: None }
}

/// The same with coast flanks behind a backlash (m).
pub fn with_coast(mut mesh: Mesh, backlash: f64) -> Mesh {
    mesh.coast = Some(CoastFlank { law: Arc::clone(&mesh.law), cycle_offset: 0.0, backlash });
    mesh
}

pub fn disk(mass: f64, polar: f64) -> RigidBody {
    RigidBody { position: [0.0; 3], axis: [0.0, 0.0, 1.0], mass, polar, transverse: 0.6 * polar, spin_ratio: 0.0 }
}

/// A bearing in the plane of the gears; nothing moves out of it.
pub fn plane_bearing(name: &str, body: BodyId, anchor: Anchor, in_plane: f64, rotation: f64) -> Bearing {
    let inf = f64::INFINITY;
    Bearing {
        name: name.into(),
        body,
        anchor,
        position: [0.0; 3],
        axes: STANDING_AXES,
        stiffness: [in_plane, in_plane, inf, inf, inf, rotation],
        damping: [0.0; 6],
    }
}

/// The dissertation's planetary stage with spring meshes, sun driven, sun and carrier in bearings on the ground, no housing.
pub fn train(angles: &[f64], depth: f64) -> TransmissionSpec {
    let [sun, planet, ring] = TEETH.map(f64::from);
    let base = |teeth: f64| 0.0352 / sun * teeth;
    let planets = angles
        .iter()
        .map(|&angle| {
            let turned = angle / TAU;
            Planet {
                angle,
                mass: 0.8537,
                polar: 0.0009,
                transverse: 0.0006,
                spin_ratio: 1.0 - ring / planet,
                bearing_stiffness: [4e8, 4e8, 1e8, 1e5, 1e5],
                bearing_damping: [400.0, 400.0, 400.0, 1.0, 1.0],
                sun_mesh: mesh(5e8, depth, sun * turned),
                ring_mesh: mesh(6e8, depth, ring * turned),
            }
        })
        .collect();
    let stage = PlanetaryStage {
        ring_teeth: TEETH[2],
        centre_distance: CENTRE,
        height: 0.0,
        sun_base_radius: base(sun),
        planet_base_radius: base(planet),
        ring_base_radius: base(ring),
        sun_pressure_angle: ((base(sun) + base(planet)) / CENTRE).acos(),
        ring_pressure_angle: ((base(ring) - base(planet)) / CENTRE).acos(),
        planets,
    };
    let bearing = |name: &str, body, height: f64, stiffness: [f64; 6]| Bearing {
        name: name.into(),
        body,
        anchor: Anchor::Ground,
        position: [0.0, 0.0, height],
        axes: STANDING_AXES,
        stiffness,
        damping: stiffness.map(|k| 2e-6 * k),
    };
    TransmissionSpec {
        stage,
        sun: RigidBody { spin_ratio: 1.0 + ring / sun, ..disk(2.0, 0.002) },
        carrier: RigidBody { position: [0.0, 0.0, 0.03], spin_ratio: 1.0, ..disk(8.0, 0.06) },
        bevel: None,
        bearings: vec![
            bearing("sun", BodyId::Sun, -0.1, [2e8, 2e8, 1e8, 1e5, 1e5, 0.0]),
            bearing("carrier", BodyId::Carrier, 0.1, [5e8, 5e8, 3e8, 1e6, 1e6, 0.0]),
        ],
        housing: None,
        drive: Some(BodyId::Sun),
    }
}

/// Planets at equal angles from this one.
pub fn equal(count: usize, first: f64) -> Vec<f64> {
    (0..count).map(|index| first + TAU * index as f64 / count as f64).collect()
}

/// A rigid ring that moves in its plane, as an elastic body: stiffness and mass along `x` and `y`, stiffness and moment of inertia about `z`. One port
/// on the axis, two sensors at right angles.
pub fn rigid_ring(radius: f64, translation: [f64; 2], rotation: [f64; 2], damping_ratio: f64) -> ElasticBody {
    let ([k, m], [k_r, j]) = (translation, rotation);
    let (unit, turn) = (1.0 / m.sqrt(), 1.0 / j.sqrt());
    // rows of the seat: radial 1, cos, sin; tangential; axial
    let mut shapes = Mat::zeros(9, 3);
    (shapes[(1, 0)], shapes[(5, 0)]) = (unit, -unit);
    (shapes[(2, 1)], shapes[(4, 1)]) = (unit, unit);
    shapes[(3, 2)] = radius * turn;
    let mut port = Mat::zeros(6, 3);
    (port[(0, 0)], port[(1, 1)], port[(5, 2)]) = (unit, unit, turn);
    let sensor = |name: &str, position, direction, shape: [f64; 3]| Sensor {
        name: name.into(),
        position,
        direction,
        shape: shape.to_vec(),
    };
    ElasticBody {
        frequencies: vec![(k / m).sqrt(), (k / m).sqrt(), (k_r / j).sqrt()],
        damping_ratios: vec![damping_ratio; 3],
        ports: vec![Port { name: "axis".into(), position: [0.0; 3], shapes: port }],
        ring_seat: Some(RingSeat { radius, z: 0.0, harmonics: 1, shapes }),
        sensors: vec![
            sensor("east", [radius, 0.0, 0.0], [1.0, 0.0, 0.0], [unit, 0.0, 0.0]),
            sensor("north", [0.0, radius, 0.0], [0.0, 1.0, 0.0], [0.0, unit, 0.0]),
        ],
    }
}

pub fn degrees(angle: f64) -> f64 {
    angle * PI / 180.0
}

/// An elastic body of no particular form, of so many coordinates from 200 Hz on: ports on the axis and aside, a seat of eight harmonics, two sensors. Its
/// shapes are smooth in the number of the coordinate, and no two ports alike.
pub fn any_housing(modes: usize) -> ElasticBody {
    let unit = 1.0 / 40.0_f64.sqrt();
    let wave = |row: usize, mode: usize, seed: f64| (seed + 1.3 * row as f64 + 2.1 * (mode as f64 + 1.0).sqrt()).sin();
    let shapes = |rows: usize, seed: f64, rotations: bool| {
        Mat::from_fn(rows, modes, |row, mode| {
            let size = if rotations && row >= 3 { 5.0 } else { 1.0 };
            unit * size * wave(row, mode, seed)
        })
    };
    let port = |name: &str, position, seed| Port { name: name.into(), position, shapes: shapes(6, seed, true) };
    let sensor = |name: &str, angle: f64| Sensor {
        name: name.into(),
        position: [0.16 * angle.cos(), 0.16 * angle.sin(), 0.0],
        direction: [angle.cos(), angle.sin(), 0.0],
        shape: (0..modes).map(|mode| unit * wave(0, mode, angle)).collect(),
    };
    ElasticBody {
        frequencies: (0..modes).map(|mode| TAU * (200.0 + 45.0 * mode as f64)).collect(),
        damping_ratios: vec![0.02; modes],
        ports: vec![
            port("top", [0.0, 0.0, 0.1], 0.3),
            port("bottom", [0.0, 0.0, -0.1], 1.1),
            port("inboard", [0.15, 0.0, -0.12], 2.0),
            port("outboard", [0.25, 0.0, -0.12], 2.9),
        ],
        ring_seat: Some(RingSeat { radius: 0.15, z: 0.0, harmonics: 8, shapes: shapes(3 * 17, 0.7, false) }),
        sensors: vec![sensor("near", 0.4), sensor("far", 2.6)],
    }
}

/// Both stages in a housing of so many coordinates: bevel pinion driven, bevel gear on a shaft of its own, joined to the sun by a spline.
pub fn whole(angles: &[f64], modes: usize) -> TransmissionSpec {
    let mut spec = train(angles, 0.1);
    spec.housing = Some(any_housing(modes));
    let speed = (1.0 + 99.0 / 27.0) * 71.0 / 19.0;
    // line of action of a crossed pair whose base radii are 43 and 160 mm
    let (point, normal) = ([0.16, 0.0, -0.12], [0.2, 0.9, (1.0_f64 - 0.04 - 0.81).sqrt()]);
    let pinion =
        RigidBody { position: [0.2, 0.0, -0.12 - 0.04], axis: [-1.0, 0.0, 0.0], spin_ratio: speed, ..disk(3.0, 0.002) };
    let gear = RigidBody { position: [0.0, 0.0, -0.11], spin_ratio: 1.0 + 99.0 / 27.0, ..disk(5.0, 0.03) };
    spec.bevel = Some(BevelStage {
        pinion,
        gear: Some(gear),
        mesh: Mesh { damping: 2000.0, ..mesh(4e8, 0.1, 0.25) },
        point,
        normal,
        cycles_per_turn: speed * 19.0,
    });
    for planet in &mut spec.stage.planets {
        planet.sun_mesh = Mesh { damping: 2000.0, ..with_coast(planet.sun_mesh.clone(), 1e-4) };
        planet.ring_mesh = Mesh { damping: 2000.0, ..with_coast(planet.ring_mesh.clone(), 1e-4) };
    }
    let bearing = |name: &str, body, anchor, position, stiffness: [f64; 6]| Bearing {
        name: name.into(),
        body,
        anchor,
        position,
        axes: STANDING_AXES,
        stiffness,
        damping: stiffness.map(|k| 1e-5 * k),
    };
    let port = |name: &str| Anchor::Port(name.into());
    let (shaft, rod) = ([3e8, 3e8, 3e8, 2e5, 2e5, 0.0], [3e8, 3e8, 3e8, 0.0, 2e5, 2e5]);
    spec.bearings = vec![
        bearing(
            "sun spline",
            BodyId::Sun,
            Anchor::Body(BodyId::BevelGear),
            [0.0, 0.0, -0.05],
            [2e8, 2e8, 1e7, 1e4, 1e4, 5e5],
        ),
        bearing("gear shaft, upper", BodyId::BevelGear, port("bottom"), [0.0, 0.0, -0.09], shaft),
        bearing("gear shaft, lower", BodyId::BevelGear, port("bottom"), [0.0, 0.0, -0.15], shaft),
        bearing("carrier", BodyId::Carrier, port("top"), [0.0, 0.0, 0.1], [5e8, 5e8, 3e8, 1e6, 1e6, 0.0]),
        bearing("pinion, inboard", BodyId::BevelPinion, port("inboard"), [0.15, 0.0, -0.16], rod),
        bearing("pinion, outboard", BodyId::BevelPinion, port("outboard"), [0.25, 0.0, -0.16], rod),
    ];
    spec.drive = Some(BodyId::BevelPinion);
    spec
}
