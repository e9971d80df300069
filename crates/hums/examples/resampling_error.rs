//! Error against run time of interpolation: `cargo run --release -p hums --example resampling_error`.

use hums::resample::{Interpolation, resample};
use std::f64::consts::PI;
use std::time::Instant;

fn main() -> hums::Result<()> {
    let n = 200_000;
    let at: Vec<f64> = (0..n - 2000).map(|i| 1000.0 + f64::from(i) * 0.997).collect();
    let band = |half_width, beta| Interpolation::BandLimited { half_width, beta };
    println!(
        "{:<44} {:>9} {:>9} {:>9} {:>9} {:>11}",
        "largest error at this share of Nyquist", "0.10", "0.25", "0.50", "0.80", "ns a sample"
    );
    for method in [
        Interpolation::Linear,
        Interpolation::CubicSpline,
        band(4, 5.0),
        band(8, 8.0),
        band(16, 10.0),
        band(24, 12.0),
        band(48, 16.0),
    ] {
        let mut line = format!("{:<44}", format!("{method:?}"));
        let mut best = f64::INFINITY;
        for share in [0.1, 0.25, 0.5, 0.8] {
            let w = share * PI;
            let x: Vec<f64> = (0..n).map(|i| (w * f64::from(i)).sin()).collect();
            let start = Instant::now();
            let y = resample(&x, &at, method)?;
            best = best.min(start.elapsed().as_secs_f64() / at.len() as f64);
            let error = y.iter().zip(&at).map(|(y, p)| (y - (w * p).sin()).abs()).fold(0.0, f64::max);
            line += &format!(" {error:>9.1e}");
        }
        println!("{line} {:>11.1}", best * 1e9);
    }
    Ok(())
}
