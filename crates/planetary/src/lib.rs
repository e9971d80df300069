//! Vibration of a whole geared transmission: a planetary stage with moving planets, an optional spiral bevel stage before it, bearings, carrier
//! and an elastic housing with sensors on it.
//!
//! | module | holds |
//! |---|---|
//! | [`mesh`] | force over approach of a tooth mesh, from contact mechanics or given |
//! | [`elastic`] | an elastic body as others see it: modes, ports, ring seat, sensors |
//! | [`housing`] | finite elements of a housing, and its reduction to an elastic body |
//! | [`stage`] | a planetary stage from its gears |
//! | [`engine`] | bodies and connections put together, in equilibrium, in free vibration, in time |
//!
//! Three planets on a ring that stands, meshes that are springs: the forces at rest, and in time.
//!
//! ```
//! use std::f64::consts::TAU;
//! use std::sync::Arc;
//!
//! use planetary::engine::{
//!     Anchor, Bearing, BodyId, Load, Mesh, Planet, PlanetaryStage, RigidBody, RunRequest, STAGES, Start, Transmission,
//!     TransmissionSpec, Turning,
//! };
//! use planetary::mesh::{LinearMesh, Periodic};
//!
//! // teeth, base radii (m), centre distance (m)
//! let [z_s, z_p, z_r] = [27.0, 35.0, 99.0];
//! let [r_s, r_p, r_r] = [27.0, 35.0, 99.0].map(|z| 35.2e-3 * z / 27.0);
//! let centre_distance = 88.9e-3;
//!
//! // stiffness over the mesh cycle (N/m): a contact ratio of 1.5, roughly
//! let stiffness = Periodic::Harmonics { mean: 6.5e8, terms: vec![[1.2e8, 0.0]] };
//! let law = Arc::new(LinearMesh::new(stiffness, Periodic::Constant(0.0))?);
//! let mesh = |cycle_offset| Mesh {
//!     law: law.clone(),
//!     cycle_offset,
//!     damping: 2e3,
//!     damping_force: 50.0,
//!     coast: None,
//! };
//! let planets = [0.0, 1.0, 2.0].map(|n| Planet {
//!     angle: TAU * n / 3.0,
//!     mass: 0.85,
//!     polar: 1.6e-3,
//!     transverse: 0.9e-3,
//!     spin_ratio: 1.0 - z_r / z_p,
//!     bearing_stiffness: [4e8, 4e8, 1e8, 1e5, 1e5],
//!     bearing_damping: [4e3, 4e3, 1e3, 1.0, 1.0],
//!     sun_mesh: mesh(-z_s * n / 3.0),
//!     ring_mesh: mesh(z_r * n / 3.0),
//! });
//! let stage = PlanetaryStage {
//!     ring_teeth: 99,
//!     centre_distance,
//!     height: 0.0,
//!     sun_base_radius: r_s,
//!     planet_base_radius: r_p,
//!     ring_base_radius: r_r,
//!     sun_pressure_angle: ((r_s + r_p) / centre_distance).acos(),
//!     ring_pressure_angle: ((r_r - r_p) / centre_distance).acos(),
//!     planets: planets.to_vec(),
//! };
//! let body = |mass, polar, spin_ratio| RigidBody {
//!     position: [0.0; 3],
//!     axis: [0.0, 0.0, 1.0],
//!     mass,
//!     polar,
//!     transverse: polar,
//!     spin_ratio,
//! };
//! let bearing = |body: BodyId| Bearing {
//!     name: body.to_string(),
//!     body,
//!     anchor: Anchor::Ground,
//!     position: [0.0; 3],
//!     axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
//!     stiffness: [2e8, 2e8, 1e8, 1e5, 1e5, 0.0],
//!     damping: [2e3, 2e3, 1e3, 1.0, 1.0, 0.0],
//! };
//! let transmission = Transmission::new(&TransmissionSpec {
//!     stage,
//!     sun: body(2.0, 2e-3, 1.0 + z_r / z_s),
//!     carrier: body(8.0, 0.06, 1.0),
//!     bevel: None,
//!     bearings: vec![bearing(BodyId::Sun), bearing(BodyId::Carrier)],
//!     housing: None,
//!     drive: Some(BodyId::Sun),
//! })?;
//!
//! let (output_torque, carrier_speed) = (6106.0, 36.4);
//! let rest = transmission.equilibrium(&Load { travelled: 0.0, output_torque, carrier_speed })?;
//! // torque of the carrier over the radii of sun and ring, shared by three planets
//! let expected = output_torque / (r_s + r_r) / 3.0;
//! assert!(rest.mesh_forces.iter().all(|force| (force / expected - 1.0).abs() < 1e-6));
//!
//! // ten mesh cycles to settle, five recorded
//! let run = transmission.run(
//!     &RunRequest {
//!         turning: Turning::Steady { carrier_speed, steps_per_cycle: 50 },
//!         output_torque,
//!         travelled: 0.0,
//!         start: Start::Equilibrium,
//!         settle_steps: 500,
//!         samples: 250,
//!         band: None,
//!         record_motion: false,
//!         stages: STAGES,
//!     },
//!     &(),
//! )?;
//! let ring = &run.meshes[3];
//! assert_eq!(ring.name, "ring-planet 1");
//! let mean = ring.force.iter().sum::<f64>() / 250.0;
//! assert!((mean / expected - 1.0).abs() < 0.05 && ring.losses == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)
)]

pub mod elastic;
pub mod engine;
pub mod error;
pub mod housing;
pub mod mesh;
pub mod stage;

pub use error::PlanetaryError;
