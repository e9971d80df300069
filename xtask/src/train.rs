//! The dissertation's transmission (chapter 5) in numbers, for studies of the crate `planetary`.
//!
//! Printed there: gears (Table 5.1), teeth, spiral, shaft angle, face and tooth thickness of the bevel stage, 6060 rpm, 6106 N m (section 5.2). Chosen: the
//! default housing of [`Casing`], stiffness and damping of bearings, masses of shafts and carrier, damping of meshes, crowning of the bevel teeth.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use anyhow::{Context, ensure};
use fecm::{FaceModel, PairModel, PairModelOptions};
use gear_geom::{
    BevelPair, BevelPlacement, BevelSpec, GearPair, Hand, MeshSite, PlanetaryTrain, PlanetaryTrainSpec, TrainError,
};
use nalgebra::{Point3, Unit, Vector3};
use planetary::elastic::ElasticBody;
use planetary::engine::{
    Anchor, Band, Bearing, BevelStage, BodyId, CoastFlank, Mesh, Planet, PlanetaryStage, RigidBody, RunRequest, STAGES,
    Start, TransmissionSpec, Turning,
};
use planetary::housing::{Casing, ReducedHousing, ReductionOptions};
use planetary::mesh::{BevelSlices, MeshLaw, MeshTable, SlicedMesh, TableOptions, virtual_table};

#[path = "../../crates/gear-geom/tests/common/train.rs"]
mod gears;

/// Torque on the carrier (N m).
pub const TORQUE: f64 = 6106.0;
/// Speed of the bevel pinion (rad/s).
const PINION_SPEED: f64 = 6060.0 * TAU / 60.0;
const BEVEL_TEETH: [u32; 2] = [19, 71];
/// Mesh cycles between one planet at a place and the next.
pub const CYCLES_PER_PASS: usize = 33;
/// Positions of tables.
pub const POSITIONS: usize = 128;
/// Steps from one sample to the next.
pub const STEPS_PER_SAMPLE: usize = 2;
/// Band of the records (Hz): that of section 5.2.
pub const BAND: f64 = 10e3;
/// Samples of a mesh cycle: 2.56 a period of the band.
pub const SAMPLES: usize = 45;
/// Highest force of tables, in mean forces of the mesh.
const HIGHEST: f64 = 4.0;
/// Damping over stiffness of meshes and bearings (s).
const MESH_DAMPING: f64 = 2e-6;
const BEARING_DAMPING: f64 = 1e-5;
/// Crowning of the bevel teeth (m), and slices.
const SLICES: BevelSlices = BevelSlices { count: 12, crown: 20e-6 };

/// Speed of the carrier (rad/s).
pub fn carrier_speed() -> f64 {
    PINION_SPEED * f64::from(BEVEL_TEETH[0]) / f64::from(BEVEL_TEETH[1]) * 27.0 / 126.0
}

/// The gears, planets at these angles (rad).
pub fn train(planet_angles: Vec<f64>) -> Result<PlanetaryTrain, TrainError> {
    PlanetaryTrain::new(&PlanetaryTrainSpec { planet_angles, ..gears::dissertation_spec() })
}

/// Angles of planets at equal distances (rad).
pub fn equal(planets: u32) -> Vec<f64> {
    (0..planets).map(|n| TAU * f64::from(n) / f64::from(planets)).collect()
}

/// Mean force of a mesh of the planetary stage with so many planets (N).
pub fn mean_force(train: &PlanetaryTrain) -> f64 {
    TORQUE * 27.0 / 126.0 / train.planets() as f64 / train.spec().sun.base_radius()
}

/// Contact model of a pair of the stage.
pub fn model(train: &PlanetaryTrain, site: MeshSite, face: FaceModel) -> anyhow::Result<PairModel> {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    if matches!(face, FaceModel::Solid { .. }) {
        // what motion needs
        (options.contact.cells_per_half_width, options.contact.face_cells) = (4.0, 24);
    }
    Ok(PairModel::new(train.pair(site), &options)?)
}

/// Options of a table.
pub fn table_options(train: &PlanetaryTrain, positions: usize) -> TableOptions {
    TableOptions { positions_per_cycle: positions, ..TableOptions::up_to(HIGHEST * mean_force(train)) }
}

/// Tables of both meshes of the stage, plane stress unless the face says otherwise.
pub fn tables(train: &PlanetaryTrain, face: FaceModel, positions: usize) -> anyhow::Result<[Arc<dyn MeshLaw>; 2]> {
    let make = |site| -> anyhow::Result<Arc<dyn MeshLaw>> {
        let options = table_options(train, positions);
        Ok(Arc::new(MeshTable::from_contact(&model(train, site, face)?, &options, &())?))
    };
    Ok([make(MeshSite::SunPlanet)?, make(MeshSite::PlanetRing)?])
}

fn bevel_pair() -> anyhow::Result<BevelPair> {
    Ok(BevelPair::new(&BevelSpec {
        teeth: BEVEL_TEETH,
        shaft_angle: 95_f64.to_radians(),
        // of the thicknesses and a backlash of 0.15 mm
        module: 9.75e-3 / PI,
        facewidth: 30.48e-3,
        spiral_angle: 30_f64.to_radians(),
        pinion_hand: Hand::Left,
        pressure_angle: 20_f64.to_radians(),
        thickness: [6.24e-3, 3.36e-3],
    })?)
}

/// Law of the bevel mesh.
pub fn bevel_law() -> anyhow::Result<Arc<dyn MeshLaw>> {
    let pair = bevel_pair()?;
    let table = virtual_table(&pair, &TableOptions::up_to(HIGHEST * bevel_force(&pair)), &())?;
    Ok(Arc::new(SlicedMesh::bevel(&pair, Arc::new(table), &SLICES)?))
}

/// Mean transverse force of the bevel mesh (N).
fn bevel_force(pair: &BevelPair) -> f64 {
    TORQUE * carrier_speed() / PINION_SPEED / pair.mean_radii()[0] / pair.transverse_pressure_angle().cos()
}

/// The default housing with the two sensors of section 5.2 only, elements of this size (m).
pub fn casing(element_size: f64) -> Casing {
    let mut casing = Casing::default();
    casing.density.element_size = element_size;
    casing.sensors.retain(|sensor| ["input", "tooth_0"].contains(&sensor.name.as_str()));
    casing
}

/// Element size of the default housing (m).
pub fn element_size() -> f64 {
    Casing::default().density.element_size
}

/// Meshes and reduces a housing.
pub fn reduced(casing: &Casing, options: &ReductionOptions) -> anyhow::Result<ReducedHousing> {
    Ok(casing.housing()?.reduce(options)?)
}

/// Motion at the usual speed and load: time steps from one sample to the next, planet passes to settle, one recorded.
pub fn request(steps_per_sample: usize, settle_passes: usize) -> RunRequest {
    let steps_per_cycle = SAMPLES * steps_per_sample;
    let band = Band { frequency: BAND, steps_per_sample };
    let lead = band.lead_steps(TAU / 99.0 / carrier_speed() / steps_per_cycle as f64);
    let settle_steps = (settle_passes * CYCLES_PER_PASS * steps_per_cycle).max(lead);
    RunRequest {
        turning: Turning::Steady { carrier_speed: carrier_speed(), steps_per_cycle },
        output_torque: TORQUE,
        // records begin at the same place
        travelled: -(settle_steps as f64) / steps_per_cycle as f64,
        start: Start::Equilibrium,
        settle_steps,
        samples: CYCLES_PER_PASS * SAMPLES,
        band: Some(band),
        record_motion: false,
        stages: STAGES,
    }
}

/// What a transmission is made of.
#[derive(Clone)]
pub struct Scene {
    /// Gears.
    pub train: PlanetaryTrain,
    /// Laws of the sun's and the ring's meshes.
    pub laws: [Arc<dyn MeshLaw>; 2],
    /// Law of the bevel mesh; without, the sun is driven.
    pub bevel: Option<Arc<dyn MeshLaw>>,
    /// Places of the bearings, by the names of the housing's ports.
    pub places: Vec<(String, [f64; 3])>,
    /// Elastic housing.
    pub housing: Option<ElasticBody>,
}

/// Places of the bearings in a housing.
pub fn places(body: &ElasticBody) -> Vec<(String, [f64; 3])> {
    body.ports.iter().map(|port| (port.name.clone(), port.position)).collect()
}

impl Scene {
    /// As the engine takes it.
    pub fn spec(&self) -> anyhow::Result<TransmissionSpec> {
        let gears = self.train.spec();
        let [z_s, z_p, z_r] = [&gears.sun, &gears.planet, &gears.ring].map(|gear| f64::from(gear.teeth()));
        let force = mean_force(&self.train);
        let dampings = self.laws.each_ref().map(|law| MESH_DAMPING * mean_stiffness(law.as_ref(), force));
        let mesh = |site: MeshSite, planet: usize| -> anyhow::Result<Mesh> {
            let index = usize::from(site == MeshSite::PlanetRing);
            let (offset, pair) = (self.train.mesh_offset(site, planet)?, self.train.pair(site));
            Ok(Mesh {
                law: Arc::clone(&self.laws[index]),
                cycle_offset: offset,
                damping: dampings[index],
                damping_force: 0.01 * force,
                coast: Some(coast(&self.laws[index], pair, offset)),
            })
        };
        let bearing_stiffness = [4e8, 4e8, 1e8, 1e5, 1e5];
        let planets = gears.planet_angles.iter().enumerate().map(|(index, &angle)| {
            let (sun_mesh, ring_mesh) = (mesh(MeshSite::SunPlanet, index)?, mesh(MeshSite::PlanetRing, index)?);
            Ok(Planet {
                angle,
                mass: 0.9,
                polar: 1.7e-3,
                transverse: 1e-3,
                spin_ratio: 1.0 - z_r / z_p,
                bearing_stiffness,
                bearing_damping: bearing_stiffness.map(|k| BEARING_DAMPING * k),
                sun_mesh,
                ring_mesh,
            })
        });
        let stage = PlanetaryStage {
            ring_teeth: gears.ring.teeth(),
            centre_distance: gears.centre_distance,
            height: 0.0,
            sun_base_radius: gears.sun.base_radius(),
            planet_base_radius: gears.planet.base_radius(),
            ring_base_radius: gears.ring.base_radius(),
            sun_pressure_angle: self.train.pair(MeshSite::SunPlanet).working_pressure_angle(),
            ring_pressure_angle: self.train.pair(MeshSite::PlanetRing).working_pressure_angle(),
            planets: planets.collect::<anyhow::Result<_>>()?,
        };
        let turning = |height: f64, mass: f64, polar: f64, transverse: f64, spin_ratio: f64| RigidBody {
            position: [0.0, 0.0, height],
            axis: [0.0, 0.0, 1.0],
            mass,
            polar,
            transverse,
            spin_ratio,
        };
        let mut bearings = Vec::new();
        for (port, body, stiffness) in [
            ("shaft_upper", BodyId::Sun, [5e8, 5e8, 2e8, 1e6, 1e6, 0.0]),
            ("shaft_lower", BodyId::Sun, [5e8, 5e8, 2e8, 1e6, 1e6, 0.0]),
            ("mast_lower", BodyId::Carrier, [8e8, 8e8, 5e8, 2e6, 2e6, 0.0]),
            ("mast_upper", BodyId::Carrier, [8e8, 8e8, 5e8, 2e6, 2e6, 0.0]),
        ] {
            bearings.push(self.bearing(port, body, Vector3::z(), stiffness)?);
        }
        let bevel = self.bevel.as_ref().map(|law| self.bevel_stage(law, &mut bearings)).transpose()?;
        Ok(TransmissionSpec {
            stage,
            sun: turning(-0.08, 6.0, 0.036, 0.045, (z_s + z_r) / z_s),
            carrier: turning(0.05, 8.0, 0.05, 0.045, 1.0),
            drive: Some(if bevel.is_some() { BodyId::BevelPinion } else { BodyId::Sun }),
            bevel,
            bearings,
            housing: self.housing.clone(),
        })
    }

    fn place(&self, port: &str) -> anyhow::Result<Vector3<f64>> {
        let found = self.places.iter().find(|(name, _)| name == port);
        Ok(found.with_context(|| format!("the housing has no port {port}"))?.1.into())
    }

    /// A bearing about an axis, along it third.
    fn bearing(&self, port: &str, body: BodyId, axis: Vector3<f64>, stiffness: [f64; 6]) -> anyhow::Result<Bearing> {
        let first = axis.cross(&Vector3::new(0.6, 0.8, 0.0)).normalize();
        let anchor = if self.housing.is_some() { Anchor::Port(port.to_owned()) } else { Anchor::Ground };
        Ok(Bearing {
            name: port.to_owned(),
            body,
            anchor,
            position: self.place(port)?.into(),
            axes: [first, axis.cross(&first), axis].map(Into::into),
            stiffness,
            damping: stiffness.map(|k| BEARING_DAMPING * k),
        })
    }

    /// The bevel gear is one body with the sun; the pinion's axis is that of its bearings.
    fn bevel_stage(&self, law: &Arc<dyn MeshLaw>, bearings: &mut Vec<Bearing>) -> anyhow::Result<BevelStage> {
        let pair = bevel_pair()?;
        let (inner, outer) = (self.place("pinion_inner")?, self.place("pinion_outer")?);
        let axis = (outer - inner).normalize();
        let apex = inner - axis * (inner.xy().norm() / axis.xy().norm());
        ensure!(apex.xy().norm() < 1e-3, "the pinion's axis misses the main axis at {apex:?}");
        let apex = Vector3::new(0.0, 0.0, apex.z);
        // the teeth of the gear look up
        let line = pair.line_of_action(&BevelPlacement {
            apex: Point3::from(apex),
            gear_axis: -Vector3::z_axis(),
            toward_pinion: axis,
            gear_turns_positive: false,
        })?;
        let axis: Vector3<f64> = Unit::into_inner(line.pinion_axis);
        for port in ["pinion_inner", "pinion_outer"] {
            bearings.push(self.bearing(port, BodyId::BevelPinion, axis, [4e8, 4e8, 3e8, 2e5, 2e5, 0.0])?);
        }
        let cycles_per_turn = f64::from(BEVEL_TEETH[1]) * 126.0 / 27.0;
        let turns = cycles_per_turn / f64::from(BEVEL_TEETH[0]);
        let force = bevel_force(&pair) / pair.base_spiral_angle().cos();
        Ok(BevelStage {
            pinion: RigidBody {
                position: (apex + 0.15 * axis).into(),
                axis: axis.into(),
                mass: 2.0,
                polar: 8e-4,
                transverse: 6e-3,
                spin_ratio: -line.arms[0].signum() * turns,
            },
            gear: None,
            mesh: Mesh {
                law: Arc::clone(law),
                cycle_offset: 0.0,
                damping: MESH_DAMPING * mean_stiffness(law.as_ref(), force),
                damping_force: 0.01 * force,
                coast: None,
            },
            point: line.point.coords.into(),
            normal: line.normal.into_inner().into(),
            cycles_per_turn,
        })
    }
}

fn coast(law: &Arc<dyn MeshLaw>, pair: &GearPair, offset: f64) -> CoastFlank {
    CoastFlank { law: Arc::clone(law), cycle_offset: pair.coast_cycle(offset), backlash: pair.normal_backlash() }
}

/// Mean over a cycle of the stiffness of a mesh at a force (N/m).
fn mean_stiffness(law: &dyn MeshLaw, force: f64) -> f64 {
    let at = |cycle: f64| {
        let (mut low, mut high) = (-1e-3, 1e-2);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if law.response(cycle, middle).force < force { &mut low } else { &mut high }) = middle;
        }
        law.response(cycle, high).stiffness
    };
    (0..16).map(|k| at(f64::from(k) / 16.0)).sum::<f64>() / 16.0
}
