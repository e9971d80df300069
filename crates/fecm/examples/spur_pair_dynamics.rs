//! Dynamic transmission error of the dissertation's nonunity pair at 4000 rpm, rigid bodies, over some mesh cycles in steady state.
//!
//! `cargo run --release -p fecm --example spur_pair_dynamics [plane-stress|3d] [rpm] [cells per half width] [face cells] [mesh cycles]`

mod nonunity;

use fecm::dynamics::{Damping, DynamicsOptions, DynamicsRequest, PairDynamics, RotorInertia, RotorOptions, Support};
use fecm::{ContactOptions, FaceModel, PairModel, PairModelOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |k: usize, default: f64| std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(default);
    let pair = nonunity::pair()?;
    let face = match std::env::args().nth(1).as_deref() {
        Some("plane-stress") => FaceModel::PlaneStress,
        _ => PairModelOptions::default().face,
    };
    let contact = ContactOptions {
        cells_per_half_width: argument(3, 4.0),
        face_cells: argument(4, 24.0) as usize,
        ..ContactOptions::default()
    };
    let model = PairModel::new(&pair, &PairModelOptions { face, contact, ..PairModelOptions::default() })?;
    println!("condensation {:?}", model.stats().condensation_time);
    // Table 3.2: inertias of pinion and gear; 2 zeta omega of the impulse tests of section 4.3
    let rotor = |mass, polar, rotation| {
        RotorOptions::on_ideal_bearings(RotorInertia { mass, polar, transverse: 0.5 * polar }, rotation)
    };
    let options = DynamicsOptions {
        operator_memory: 1 << 31,
        ..DynamicsOptions::new(
            [rotor(0.9, 8e-4, Support::Fixed), rotor(1.5, 0.005, Support::Free)],
            Damping {
                mass_proportional: 2.0 * 0.048 * 2.0 * std::f64::consts::PI * 2370.73,
                stiffness_proportional: 0.0,
                modal_ratio: 0.0,
            },
        )
    };
    let cycles = argument(5, 40.0) as usize;
    let request = DynamicsRequest::running(argument(2, 4000.0) * std::f64::consts::PI / 30.0, 50, 424.0);
    let run = PairDynamics::new(&model, &options)?.run(&request, 50 * cycles, &())?;
    let last = &run.records[run.records.len() - 50..];
    for record in last.iter().step_by(5) {
        println!(
            "{:8.3}  {:8.3} um  {:9.1} N  {:?}",
            record.mesh_cycle,
            record.transmission_error * 1e6,
            record.mesh_force,
            record.pairs
        );
    }
    // amplitude at the mesh frequency over the last cycle
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (k, record) in last.iter().enumerate() {
        let phase = 2.0 * std::f64::consts::PI * k as f64 / 50.0;
        cosine += record.transmission_error * phase.cos() / 25.0;
        sine += record.transmission_error * phase.sin() / 25.0;
    }
    println!("amplitude at the mesh frequency {:.3} um", 1e6 * f64::hypot(cosine, sine));
    println!("energy {:?}", run.energy);
    println!("{:?}", run.stats);
    Ok(())
}
