//! Meshes the default housing, reduces it, and prints what a transmission gets: `cargo run --release -p planetary --example housing [element size, mm]`.

use std::time::Instant;

use planetary::housing::{Casing, ReductionOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut casing = Casing::default();
    if let Some(size) = std::env::args().nth(1) {
        casing.density.element_size = 1e-3 * size.parse::<f64>()?;
    }
    let started = Instant::now();
    let housing = casing.housing()?;
    let inertia = housing.mesh.inertia()?;
    println!("{} nodes, {} elements, {:.3} kg", housing.mesh.nodes.len(), housing.mesh.elements.len(), inertia.mass);
    println!("centre of mass {:.4?} m; meshed in {:.2} s", inertia.centre, started.elapsed().as_secs_f64());
    let started = Instant::now();
    let structure = housing.structure()?;
    println!("factored in {:.2} s: {} entries", started.elapsed().as_secs_f64(), structure.factor_entries());
    drop(structure);
    let started = Instant::now();
    let reduced = housing.reduce(&ReductionOptions::default())?;
    println!("reduced in {:.2} s: {:?}", started.elapsed().as_secs_f64(), reduced.stats);
    for (k, frequency) in reduced.body.frequencies.iter().take(20).enumerate() {
        println!("{:3} {:9.2} Hz", k + 1, frequency / std::f64::consts::TAU);
    }
    for port in &reduced.body.ports {
        println!("port {} at {:.4?} m", port.name, port.position);
    }
    Ok(())
}
