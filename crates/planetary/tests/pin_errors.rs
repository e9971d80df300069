//! Load sharing of planets whose pins are off their places, against closed forms.
//!
//! With rigid pins, carrier and ring, a planet turns until both its meshes carry the same force `F`, and their approaches add up:
//! `F / k_s + F / k_r = d - e_i`, `e_i = (cos a_s + cos a_r) t_i + (sin a_s - sin a_r) r_i`, `d` the same for all planets. So with the sun held
//! `F_i = mean - k (e_i - mean e)`, `1 / k = 1 / k_s + 1 / k_r`. A sun that floats moves until the forces on it balance: what of `e` is a first harmonic of the
//! planets' angle costs nothing. Three planets then share evenly, whatever their pins (K_gamma = 1).

mod support;

use std::f64::consts::TAU;
use std::sync::Arc;

use gear_geom::MeshSite;
use planetary::engine::{Load, Transmission};
use planetary::mesh::{OffsetMesh, pin_offset};
use support::{equal, train};

const TORQUE: f64 = 6106.0;

/// Forces of the sun meshes and the ring meshes at rest.
fn forces(errors: &[[f64; 2]], sun_stiffness: f64) -> Vec<f64> {
    let inf = f64::INFINITY;
    let mut spec = train(&equal(errors.len(), 0.3), 0.0);
    let angles = [spec.stage.sun_pressure_angle, spec.stage.ring_pressure_angle];
    for (planet, &error) in spec.stage.planets.iter_mut().zip(errors) {
        planet.bearing_stiffness = [inf, inf, 1e8, inf, inf];
        for (mesh, site, angle) in [
            (&mut planet.sun_mesh, MeshSite::SunPlanet, angles[0]),
            (&mut planet.ring_mesh, MeshSite::PlanetRing, angles[1]),
        ] {
            mesh.law = Arc::new(OffsetMesh::new(mesh.law.clone(), pin_offset(site, angle, error)).unwrap());
        }
    }
    spec.bearings[0].stiffness = [sun_stiffness, sun_stiffness, 1e8, inf, inf, 0.0];
    spec.bearings[1].stiffness = [inf, inf, 1e8, inf, inf, 0.0];
    let load = Load { travelled: 0.2, output_torque: TORQUE, carrier_speed: 0.0 };
    Transmission::new(&spec).unwrap().equilibrium(&load).unwrap().mesh_forces
}

#[test]
fn analytic_load_sharing_with_pin_errors() {
    let stiffness = 1.0 / (1.0 / 5e8 + 1.0 / 6e8);
    let stage = train(&[0.0], 0.0).stage;
    let (s, r) = (stage.sun_pressure_angle, stage.ring_pressure_angle);
    for (count, known) in [(3, 0.0), (4, 0.25), (5, 0.4)] {
        let mut errors = vec![[0.0; 2]; count];
        errors[0] = [3e-6, 5e-6];
        let e = (s.cos() + r.cos()) * 5e-6 + (s.sin() - r.sin()) * 3e-6;
        let mean = TORQUE * 27.0 / 126.0 / count as f64 / stage.sun_base_radius;
        for floating in [false, true] {
            let found = forces(&errors, if floating { 0.0 } else { f64::INFINITY });
            for planet in 0..count {
                let off = if planet == 0 { 1.0 } else { 0.0 };
                let angle = TAU * planet as f64 / count as f64;
                let first = if floating { 2.0 / count as f64 * angle.cos() } else { 0.0 };
                let expected = mean - stiffness * e * (off - 1.0 / count as f64 - first);
                for force in [found[planet], found[count + planet]] {
                    assert!((force / expected - 1.0).abs() < 1e-6, "{count} {floating} {planet}: {force} {expected}");
                }
            }
            // of a floating sun's planets the one that is off loses this part of `k e`: none of three, a quarter of four, 0.4 of five
            if floating {
                assert!(((mean - found[0]) / (stiffness * e) - known).abs() < 1e-6, "{count}");
            }
        }
    }
}
