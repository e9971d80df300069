//! Error against run time of every integration method, as CSV.
//!
//! `cargo run --release -p lpm --example work_precision`

use lpm::{LpmError, work_precision};

fn main() -> Result<(), LpmError> {
    let tolerances: Vec<f64> = (2..=11).map(|i| 10f64.powi(-i)).collect();
    println!("problem,supports,method,tolerance,relative_error,run_time_us,steps,events");
    for r in work_precision(&tolerances, 0.005)? {
        println!(
            "{},{:?},{},{:.0e},{:.3e},{:.1},{},{}",
            r.problem,
            r.supports,
            r.method.name(),
            r.tolerance,
            r.error,
            r.seconds * 1e6,
            r.steps,
            r.events
        );
    }
    Ok(())
}
