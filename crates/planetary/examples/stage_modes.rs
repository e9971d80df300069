//! Natural modes of a planetary stage whose meshes are springs, at rest under load.
//!
//! `cargo run --release -p planetary --example stage_modes [planets]`

use std::f64::consts::TAU;
use std::sync::Arc;

use planetary::engine::{
    Anchor, Bearing, BodyId, Load, Mesh, Planet, PlanetaryStage, RigidBody, Transmission, TransmissionSpec,
};
use planetary::mesh::LinearMesh;

/// Teeth of sun, planet and ring, and their centre distance (m).
const TEETH: [f64; 3] = [27.0, 35.0, 99.0];
const CENTRE_DISTANCE: f64 = 0.0889;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let planets = std::env::args().nth(1).map_or(Ok(3), |text| text.parse())?;
    let transmission = Transmission::new(&stage(planets)?)?;
    let load = Load { travelled: 0.0, output_torque: 6106.0, carrier_speed: 36.4 };
    let rest = transmission.equilibrium(&load)?;
    for (name, force) in transmission.mesh_names().iter().zip(&rest.mesh_forces) {
        println!("{name:16} {force:8.1} N");
    }
    let bodies: Vec<String> = transmission.bodies().iter().map(ToString::to_string).collect();
    println!("\n       Hz  part of the kinetic energy in: {}", bodies.join(", "));
    for mode in transmission.natural_modes(&load)? {
        let parts: Vec<String> = mode.energy[..bodies.len()].iter().map(|part| format!("{part:5.2}")).collect();
        println!("{:9.1}  {}", mode.frequency, parts.join(" "));
    }
    Ok(())
}

fn stage(count: usize) -> Result<TransmissionSpec, Box<dyn std::error::Error>> {
    let [z_s, z_p, z_r] = TEETH;
    let base_radius = |teeth: f64| 35.2e-3 * teeth / z_s;
    let mesh = |stiffness: f64, cycle_offset: f64| -> Result<Mesh, Box<dyn std::error::Error>> {
        let law = Arc::new(LinearMesh::constant(stiffness)?);
        Ok(Mesh { law, cycle_offset, damping: 1000.0, damping_force: 100.0, coast: None })
    };
    let planets = (0..count).map(|index| {
        let angle = TAU * index as f64 / count as f64;
        Ok(Planet {
            angle,
            mass: 0.85,
            polar: 1.6e-3,
            transverse: 0.9e-3,
            spin_ratio: 1.0 - z_r / z_p,
            bearing_stiffness: [4e8, 4e8, 1e8, 1e5, 1e5],
            bearing_damping: [400.0, 400.0, 100.0, 1.0, 1.0],
            sun_mesh: mesh(5.4e8, -z_s * angle / TAU)?,
            ring_mesh: mesh(7e8, z_r * angle / TAU)?,
        })
    });
    let stage = PlanetaryStage {
        ring_teeth: z_r as u32,
        centre_distance: CENTRE_DISTANCE,
        height: 0.0,
        sun_base_radius: base_radius(z_s),
        planet_base_radius: base_radius(z_p),
        ring_base_radius: base_radius(z_r),
        sun_pressure_angle: ((base_radius(z_s) + base_radius(z_p)) / CENTRE_DISTANCE).acos(),
        ring_pressure_angle: ((base_radius(z_r) - base_radius(z_p)) / CENTRE_DISTANCE).acos(),
        planets: planets.collect::<Result<_, Box<dyn std::error::Error>>>()?,
    };
    let body = |mass, polar, spin_ratio| RigidBody {
        position: [0.0; 3],
        axis: [0.0, 0.0, 1.0],
        mass,
        polar,
        transverse: 0.6 * polar,
        spin_ratio,
    };
    let bearing = |name: &str, body, height, stiffness: [f64; 6]| Bearing {
        name: name.into(),
        body,
        anchor: Anchor::Ground,
        position: [0.0, 0.0, height],
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        stiffness,
        damping: stiffness.map(|k| 1e-5 * k),
    };
    Ok(TransmissionSpec {
        stage,
        sun: body(2.0, 2e-3, 1.0 + z_r / z_s),
        carrier: body(8.0, 0.06, 1.0),
        bevel: None,
        bearings: vec![
            bearing("sun", BodyId::Sun, -0.1, [2e8, 2e8, 1e8, 1e5, 1e5, 0.0]),
            bearing("carrier", BodyId::Carrier, 0.1, [5e8, 5e8, 3e8, 1e6, 1e6, 0.0]),
        ],
        housing: None,
        drive: Some(BodyId::Sun),
    })
}
