//! Indicators of the phenomenon-based model on all routes, and their sensitivities (D 4.5, 4.6,
//! Figure 4.10): `cargo run --release -p hums --example phenomenon`.

use hums::indicator::basic::{kurtosis, m8a, rms};
use hums::phenomenon::{DampedSine, simplified_indicators};

fn main() -> hums::Result<()> {
    let (mesh_cycles, mesh_frequency) = (27, 1800.0);
    let duration = f64::from(mesh_cycles) / mesh_frequency;
    let model = DampedSine { amplitude: 2.798, delay: 0.475_303e-3, natural_frequency: 2733.33, damping: 0.039_92 };
    println!(
        "A_1 {:.4} A_2 {:.4} A_3 {:.4} um, delta {:.6}, 2 f_d T = {:.4}",
        model.extremum(1),
        model.extremum(2),
        model.extremum(3),
        model.log_decrement(),
        2.0 * model.damped_frequency() * duration
    );
    println!("{:<28} {:>10} {:>10} {:>12}", "route", "RMS, um", "FM4", "M8A");
    let show = |name: &str, rms: f64, fm4: f64, m8a: f64| {
        println!("{name:<28} {rms:>10.6} {fm4:>10.4} {m8a:>12.2}");
    };
    for per_cycle in [50, 500, 5000] {
        let y = model.samples(mesh_cycles as usize * per_cycle, per_cycle as f64 * mesh_frequency)?;
        let name = format!("samples, {per_cycle} a mesh cycle");
        show(&name, rms(&y)?, kurtosis(&y)?, m8a(&y)?);
    }
    let both_ends = model.samples(mesh_cycles as usize * 50 + 1, 50.0 * mesh_frequency)?;
    let (r, k, m) = (rms(&both_ends)?, kurtosis(&both_ends)?, m8a(&both_ends)?);
    show("1351 samples, both ends", r, k, m);
    let exact = model.exact_indicators(duration)?;
    show("exact integrals", exact.rms, exact.fm4, exact.m8a);
    let at_zero = DampedSine { delay: 0.0, ..model }.exact_indicators(duration)?;
    show("exact integrals, t_d = 0", at_zero.rms, at_zero.fm4, at_zero.m8a);
    for n in [model.half_cycles(duration), model.half_cycles(duration) - 1] {
        let form = model.density(n)?.indicators()?;
        show(&format!("density (4.13), n = {n}"), form.rms, form.fm4, form.m8a);
        let (rms, fm4, m8a) = (form.rms, form.fm4, form.m8a);
        println!(
            "    differs from exact (t_d = 0): {:.3} %, {:.3} %, {:.3} %",
            100.0 * (rms / at_zero.rms - 1.0),
            100.0 * (fm4 / at_zero.fm4 - 1.0),
            100.0 * (m8a / at_zero.m8a - 1.0)
        );
        let simple = simplified_indicators(model.extremum(1), model.log_decrement(), n as f64)?;
        show(&format!("simplified (4.14), n = {n}"), simple.rms, simple.fm4, simple.m8a);
    }

    println!("\nsensitivity (4.14): damping ratio, RMS (um), FM4, M8A at n = 2 f_d T");
    for damping in [0.02, 0.03, 0.04, 0.05, 0.06] {
        let m = DampedSine { damping, ..model };
        let n = 2.0 * m.damped_frequency() * duration;
        let form = simplified_indicators(m.extremum(1), m.log_decrement(), n)?;
        show(&format!("{damping}"), form.rms, form.fm4, form.m8a);
    }
    println!("sensitivity (4.14): natural frequency (Hz)");
    for natural_frequency in [2000.0, 2500.0, 3000.0, 3500.0] {
        let m = DampedSine { natural_frequency, ..model };
        let n = 2.0 * m.damped_frequency() * duration;
        let form = simplified_indicators(m.extremum(1), m.log_decrement(), n)?;
        show(&format!("{natural_frequency}"), form.rms, form.fm4, form.m8a);
    }
    Ok(())
}
