//! Transmission error, load sharing and mesh stiffness of the dissertation's nonunity pair over one mesh cycle.
//!
//! `cargo run --release -p fecm --example spur_pair_statics [plane-stress|plane-strain|3d]`

mod nonunity;

use fecm::{FaceModel, PairModel, PairModelOptions, StaticsRequest};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pair = nonunity::pair()?;
    let face = match std::env::args().nth(1).as_deref() {
        Some("plane-stress") => FaceModel::PlaneStress,
        Some("plane-strain") => FaceModel::PlaneStrain,
        _ => PairModelOptions::default().face,
    };
    let model = PairModel::new(&pair, &PairModelOptions { face, ..PairModelOptions::default() })?;
    let request = StaticsRequest::one_cycle(50, 424.0).with_stiffness_difference();
    let series = model.solve(&request, &())?;
    println!("mesh cycle  STE (um)  k_l (N/um)  differences  pairs  peak (MPa)  width (mm)");
    for at in &series.results[0] {
        let stiffness = |k: Option<f64>| k.unwrap_or_default() * 1e-6;
        let forces: Vec<String> = at.loaded_pairs().map(|p| format!("{}:{:.0} N", p.pair, p.force)).collect();
        println!(
            "{:10.3}  {:8.4}  {:10.2}  {:11.2}  {}  {:.1}  {:.4}  {:?} cells {} updates {} solves {} pivots {}",
            at.mesh_cycle,
            at.static_transmission_error * 1e6,
            stiffness(at.stiffness_local_slope),
            stiffness(at.stiffness_local_slope_difference),
            forces.join(" "),
            at.peak_pressure() * 1e-6,
            at.pairs.iter().map(|p| p.contact_width).fold(0.0, f64::max) * 1e3,
            at.status,
            at.stats.cells,
            at.stats.geometry_updates,
            at.stats.solver.solves,
            at.stats.solver.pivots,
        );
    }
    println!("condensation {:?}, contact {:?}", model.stats().condensation_time, series.time);
    Ok(())
}
