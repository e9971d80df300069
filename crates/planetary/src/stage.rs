//! A planetary stage from its gears: what [`PlanetaryTrain`] knows (teeth, radii, pressure angles, phases) joined with laws of the meshes and values of
//! the planets.

use std::sync::Arc;

use gear_geom::{MeshSite, PlanetaryTrain};

use crate::PlanetaryError;
use crate::engine::{CoastFlank, Mesh, Planet, PlanetaryStage};
use crate::mesh::MeshLaw;

/// Force, as a part of the mean, from which on the damping of a mesh is full.
const FULL_DAMPING: f64 = 0.01;
/// Positions at which the mean stiffness of a mesh is taken.
const POSITIONS: usize = 16;

/// Laws of the meshes of a stage.
#[derive(Debug, Clone)]
pub struct StageLaws {
    /// Sun with each planet; a planet without a law of its own has that of sound teeth.
    pub sun: Vec<Arc<dyn MeshLaw>>,
    /// Ring with each planet; the same.
    pub ring: Vec<Arc<dyn MeshLaw>>,
    /// Sound teeth of sun and planets, and of planets and ring: coast flanks.
    pub sound: [Arc<dyn MeshLaw>; 2],
}

impl StageLaws {
    /// All teeth sound.
    #[must_use]
    pub fn sound(sun: Arc<dyn MeshLaw>, ring: Arc<dyn MeshLaw>) -> Self {
        Self { sun: Vec::new(), ring: Vec::new(), sound: [sun, ring] }
    }

    fn of(&self, site: MeshSite, planet: usize) -> &Arc<dyn MeshLaw> {
        let own = match site {
            MeshSite::SunPlanet => &self.sun,
            MeshSite::PlanetRing => &self.ring,
        };
        own.get(planet).unwrap_or(&self.sound[usize::from(site == MeshSite::PlanetRing)])
    }
}

/// Values of a stage that are not geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageValues {
    /// Torque on the carrier (N m), for the mean force of the meshes.
    pub output_torque: f64,
    /// Damping of meshes over their mean stiffness (s).
    pub mesh_damping: f64,
    /// Mass of a planet (kg).
    pub planet_mass: f64,
    /// Moment of inertia of a planet about its axis (kg m^2).
    pub planet_polar: f64,
    /// Moment of inertia of a planet about a diameter (kg m^2).
    pub planet_transverse: f64,
    /// Stiffness of a planet's bearing: two radial, axial (N/m), two tilting (N m/rad).
    pub bearing_stiffness: [f64; 5],
    /// Its damping over its stiffness (s).
    pub bearing_damping: f64,
}

/// Mean force of one mesh of a stage whose ring stands (N), for a torque on the carrier (N m).
///
/// The sun's torque is `T_c Z_s / (Z_s + Z_r)`, shared by the planets; the ring's force is the same by the planet's balance.
#[must_use]
pub fn mean_force(train: &PlanetaryTrain, output_torque: f64) -> f64 {
    let spec = train.spec();
    let [z_s, z_r] = [&spec.sun, &spec.ring].map(|gear| f64::from(gear.teeth()));
    output_torque * z_s / (z_s + z_r) / spec.sun.base_radius() / train.planets() as f64
}

impl PlanetaryStage {
    /// The stage of a train, in the plane `z = 0`.
    ///
    /// # Errors
    /// Those of the train's phases.
    pub fn of_train(train: &PlanetaryTrain, laws: &StageLaws, values: &StageValues) -> Result<Self, PlanetaryError> {
        let gears = train.spec();
        let [z_p, z_r] = [&gears.planet, &gears.ring].map(|gear| f64::from(gear.teeth()));
        let force = mean_force(train, values.output_torque);
        let dampings = laws.sound.each_ref().map(|law| values.mesh_damping * mean_stiffness(law.as_ref(), force));
        let mesh = |site: MeshSite, planet: usize| -> Result<Mesh, PlanetaryError> {
            let index = usize::from(site == MeshSite::PlanetRing);
            let (offset, pair) = (train.mesh_offset(site, planet)?, train.pair(site));
            Ok(Mesh {
                law: Arc::clone(laws.of(site, planet)),
                cycle_offset: offset,
                damping: dampings[index],
                damping_force: (FULL_DAMPING * force).max(f64::MIN_POSITIVE),
                coast: Some(CoastFlank {
                    law: Arc::clone(&laws.sound[index]),
                    cycle_offset: pair.coast_cycle(offset),
                    backlash: pair.normal_backlash().max(0.0),
                }),
            })
        };
        let planets = gears.planet_angles.iter().enumerate().map(|(index, &angle)| {
            Ok(Planet {
                angle,
                mass: values.planet_mass,
                polar: values.planet_polar,
                transverse: values.planet_transverse,
                spin_ratio: 1.0 - z_r / z_p,
                bearing_stiffness: values.bearing_stiffness,
                bearing_damping: values.bearing_stiffness.map(|k| values.bearing_damping * k),
                sun_mesh: mesh(MeshSite::SunPlanet, index)?,
                ring_mesh: mesh(MeshSite::PlanetRing, index)?,
            })
        });
        Ok(Self {
            ring_teeth: gears.ring.teeth(),
            centre_distance: gears.centre_distance,
            height: 0.0,
            sun_base_radius: gears.sun.base_radius(),
            planet_base_radius: gears.planet.base_radius(),
            ring_base_radius: gears.ring.base_radius(),
            sun_pressure_angle: train.pair(MeshSite::SunPlanet).working_pressure_angle(),
            ring_pressure_angle: train.pair(MeshSite::PlanetRing).working_pressure_angle(),
            planets: planets.collect::<Result<_, PlanetaryError>>()?,
        })
    }
}

/// Mean over a cycle of the stiffness of a mesh at a force (N/m).
#[must_use]
pub fn mean_stiffness(law: &dyn MeshLaw, force: f64) -> f64 {
    let at = |cycle: f64| law.response(cycle, approach_at(law, cycle, force)).stiffness;
    (0..POSITIONS).map(|k| at(k as f64 / POSITIONS as f64)).sum::<f64>() / POSITIONS as f64
}

/// Approach (m) at which a mesh carries a force, by doubling and bisection.
#[must_use]
pub fn approach_at(law: &dyn MeshLaw, cycle: f64, force: f64) -> f64 {
    let carries = |approach: f64| law.response(cycle, approach).force >= force;
    let mut high = 1e-7;
    while !carries(high) && high < 1.0 {
        high *= 2.0;
    }
    // teeth in the way of rigid involutes touch before the approach is 0
    let mut low = -high;
    while carries(low) && low > -1.0 {
        low *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *(if carries(middle) { &mut high } else { &mut low }) = middle;
    }
    high
}
