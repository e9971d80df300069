//! Time integration against solutions in closed form.

mod support;

use std::f64::consts::TAU;
use std::sync::Arc;

use faer::Mat;
use planetary::elastic::{ElasticBody, RingSeat};
use planetary::engine::{Band, Mesh, RunRequest, STAGES, Start, Transmission, TransmissionSpec, Turning};
use planetary::mesh::{MeshLaw, MeshResponse};
use support::{mesh, train};

/// Speed of the carrier (rad/s) and mesh frequency (Hz).
const SPEED: f64 = 36.4;
const MESH_FREQUENCY: f64 = SPEED / TAU * 99.0;
/// Force of a mesh that does not depend on the approach: mean and amplitudes of harmonics of the mesh cycle (N).
const FORCE: [f64; 4] = [5000.0, 400.0, -250.0, 120.0];
const MODES: usize = 60;

#[derive(Debug)]
struct Given;

impl MeshLaw for Given {
    fn response(&self, mesh_cycle: f64, _: f64) -> MeshResponse {
        let wave = |(j, f): (usize, &f64)| f * (TAU * j as f64 * mesh_cycle).cos();
        MeshResponse { force: FORCE.iter().enumerate().map(wave).sum(), stiffness: 0.0 }
    }
}

/// A ring that only breathes and turns, with modes from 150 Hz to 15 kHz, and one planet that does not move.
fn housing() -> (TransmissionSpec, ElasticBody) {
    let mut spec = train(&[0.7], 0.0);
    for bearing in &mut spec.bearings {
        bearing.stiffness = [f64::INFINITY; 6];
    }
    // the input holds the sun
    spec.bearings[0].stiffness[5] = 0.0;
    let planet = &mut spec.stage.planets[0];
    planet.bearing_stiffness = [f64::INFINITY; 5];
    planet.sun_mesh = mesh(1e9, 0.0, 0.0);
    planet.ring_mesh = Mesh { law: Arc::new(Given), ..mesh(0.0, 0.0, 0.0) };
    let body = ElasticBody {
        frequencies: (0..MODES).map(|k| TAU * (150.0 + 250.0 * k as f64 + 0.3 * (k * k) as f64 / 4.0)).collect(),
        damping_ratios: (0..MODES).map(|k| 1e-4 * (1 + k % 7) as f64).collect(),
        ring_seat: Some(RingSeat {
            radius: 0.15,
            z: 0.0,
            harmonics: 0,
            shapes: Mat::from_fn(3, MODES, |row, k| 0.2 * (0.4 + 1.7 * row as f64 + 0.9 * k as f64).sin()),
        }),
        sensors: vec![planetary::elastic::Sensor {
            name: "ring".into(),
            position: [0.15, 0.0, 0.0],
            direction: [1.0, 0.0, 0.0],
            shape: (0..MODES).map(|k| 0.2 * (1.0 + 0.3 * k as f64).cos()).collect(),
        }],
        ..ElasticBody::default()
    };
    spec.housing = Some(body.clone());
    (spec, body)
}

/// Position, rate and acceleration of a coordinate at a time, from rest under the force at the start; `push` is its force per unit of the mesh's.
fn exact(w: f64, zeta: f64, push: f64, time: f64) -> [f64; 3] {
    // particular solution a cos + b sin of each harmonic
    let (mut q, mut v, mut a, mut q_0, mut v_0) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (j, force) in FORCE.iter().enumerate() {
        let nu = TAU * MESH_FREQUENCY * j as f64;
        let (real, imaginary) = (w * w - nu * nu, 2.0 * zeta * w * nu);
        let size = push * force / (real * real + imaginary * imaginary);
        let (c, s) = (size * real, size * imaginary);
        let (sin, cos) = (nu * time).sin_cos();
        q += c * cos + s * sin;
        v += nu * (s * cos - c * sin);
        a -= nu * nu * (c * cos + s * sin);
        q_0 += c;
        v_0 += nu * s;
    }
    let start = push * FORCE.iter().sum::<f64>() / (w * w) - q_0;
    let damped = w * (1.0 - zeta * zeta).sqrt();
    let (b, decay) = ((-v_0 + zeta * w * start) / damped, (-zeta * w * time).exp());
    let (sin, cos) = (damped * time).sin_cos();
    let free = decay * (start * cos + b * sin);
    let rate = decay * ((damped * b - zeta * w * start) * cos - (damped * start + zeta * w * b) * sin);
    [q + free, v + rate, a - 2.0 * zeta * w * rate - w * w * free]
}

/// Force of each coordinate per unit of the mesh's force on the ring.
fn pushes(spec: &TransmissionSpec, body: &ElasticBody) -> Vec<f64> {
    let (stage, seat) = (&spec.stage, body.ring_seat.as_ref().unwrap());
    let (sin, cos) = stage.ring_pressure_angle.sin_cos();
    let ratio = stage.ring_base_radius / cos / seat.radius;
    (0..MODES).map(|k| -(-sin * seat.shapes[(0, k)] + cos * ratio * seat.shapes[(1, k)])).collect()
}

fn request(steps_per_cycle: usize, samples: usize, stages: usize) -> RunRequest {
    RunRequest {
        turning: Turning::Steady { carrier_speed: SPEED, steps_per_cycle },
        output_torque: 100.0,
        travelled: 0.0,
        start: Start::Equilibrium,
        settle_steps: 0,
        samples,
        band: None,
        record_motion: false,
        stages,
    }
}

#[test]
fn analytic_housing_under_a_known_force() {
    let (spec, body) = housing();
    let transmission = Transmission::new(&spec).unwrap();
    let (steps, cycles) = (50, 40);
    let run = transmission.run(&request(steps, cycles * steps, STAGES), &()).unwrap();
    let time = cycles as f64 / MESH_FREQUENCY;
    let first = 6 * transmission.bodies().len();
    for (k, push) in pushes(&spec, &body).into_iter().enumerate() {
        let (w, zeta) = (body.frequencies[k], body.damping_ratios[k]);
        let [q, v, _] = exact(w, zeta, push, time);
        // of the size of its motion: static deflection and free vibration
        let size = (push * FORCE[0] / (w * w)).abs() + q.abs() + v.abs() / w;
        let error = (run.state.position[first + k] - q).abs().max((run.state.velocity[first + k] - v).abs() / w);
        assert!(error < 1e-6 * size, "{} Hz: {error:e} of {size:e}", w / TAU);
    }
}

/// A sensor in its band: what the filter passes of the exact acceleration, whatever the step.
#[test]
fn analytic_band_of_a_sensor() {
    let (spec, body) = housing();
    let transmission = Transmission::new(&spec).unwrap();
    let push = pushes(&spec, &body);
    let shape = &body.sensors[0].shape;
    let exactly = |time: f64| -> f64 {
        (0..MODES).map(|k| shape[k] * exact(body.frequencies[k], body.damping_ratios[k], push[k], time)[2]).sum()
    };
    for (steps_per_sample, stages) in [(1, 3), (2, 3), (2, 2)] {
        let (per_cycle, samples) = (90, 300);
        let band = Band { frequency: 19e3, steps_per_sample };
        let step = 1.0 / (MESH_FREQUENCY * (per_cycle * steps_per_sample) as f64);
        let settle_steps = band.lead_steps(step);
        let own =
            RunRequest { band: Some(band), settle_steps, ..request(per_cycle * steps_per_sample, samples, stages) };
        let run = transmission.run(&own, &()).unwrap();
        assert_eq!((run.len(), run.first_step), (samples, settle_steps as i64));
        let (mut error, mut size) = (0.0, 0.0);
        for (k, value) in run.sensors[0].acceleration.iter().enumerate() {
            let time = step * (run.first_step + (k * steps_per_sample) as i64) as f64;
            error += (value - exactly(time)).powi(2);
            size += exactly(time).powi(2);
        }
        // all modes lie in the band, where the response is 1 to 1e-3
        let relative = (error / size).sqrt();
        assert!(relative < 2e-3, "{steps_per_sample} {stages}: {relative}");
    }
}

/// Any step, any bearing: forces stay finite and near their mean, and what rows of any stiffness hold stays put.
#[test]
fn extreme_steps_and_bearings() {
    for steps in [10, 50, 200, 1000] {
        for stiffness in [1e5, 1e8, 1e11, 1e13, f64::INFINITY] {
            let mut spec = train(&[0.1, 1.9, 4.4], 0.15);
            for planet in &mut spec.stage.planets {
                planet.bearing_stiffness = [stiffness; 5];
                planet.bearing_damping = [if stiffness.is_finite() { 1e-5 * stiffness } else { 0.0 }; 5];
                planet.sun_mesh = support::with_coast(Mesh { damping: 1e3, ..planet.sun_mesh.clone() }, 1e-4);
                planet.ring_mesh = support::with_coast(Mesh { damping: 1e3, ..planet.ring_mesh.clone() }, 1e-4);
            }
            let own = RunRequest { output_torque: 6106.0, ..request(steps, (12 * steps).min(3000), STAGES) };
            let run = Transmission::new(&spec).unwrap().run(&own, &()).unwrap();
            let expected = 6106.0 / (spec.stage.sun_base_radius + spec.stage.ring_base_radius) / 3.0;
            let most = run.meshes.iter().flat_map(|mesh| &mesh.force).fold(0.0_f64, |most, f| most.max(*f));
            assert!(most < 4.0 * expected, "{steps} {stiffness:e}: {most} {expected}");
            let stats = run.stats;
            assert!(stats.fallbacks * 100 <= stats.steps, "{steps} {stiffness:e}: {stats:?}");
        }
    }
}
