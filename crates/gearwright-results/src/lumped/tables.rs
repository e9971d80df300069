//! CSV tables of lumped-parameter dynamics; one row per sample and state, units in the column names, converted here.

use std::path::Path;

use lpm::{BranchPoint, ContactPhase, Measure, Stability};

use super::{BranchResult, DamageResult, DamageSpeeds, ImpulseResult, State, SweepResult, TimeResponse};

/// Points per mesh cycle of `curves.csv`.
const CURVE_POINTS: usize = 100;

fn number(value: f64) -> String {
    format!("{value:.9e}")
}

fn um(value: f64) -> String {
    number(value * 1e6)
}

fn write(path: &Path, header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(header)?;
    for row in rows {
        table.write_record(row)?;
    }
    table.flush()?;
    Ok(())
}

/// `curves.csv`: mesh stiffness and static transmission error of every state over its period.
///
/// # Errors
/// I/O errors.
pub fn curves(path: &Path, states: &[State]) -> Result<(), csv::Error> {
    let header = ["state", "mesh_cycle", "mesh_stiffness_local_n_per_um", "ste_um"];
    let rows = states.iter().flat_map(|state| {
        let excitation = state.model.excitation();
        (0..CURVE_POINTS * excitation.period()).map(move |i| {
            let t = i as f64 / CURVE_POINTS as f64;
            let (k, e) = (excitation.mesh_stiffness().value(t), excitation.transmission_error().value(t));
            vec![state.name.clone(), number(t), number(k * 1e-6), um(e)]
        })
    });
    write(path, &header, rows)
}

/// `response.csv`.
///
/// # Errors
/// I/O errors.
pub fn response(path: &Path, all: &[TimeResponse]) -> Result<(), csv::Error> {
    let header = [
        "state",
        "mesh_cycle",
        "time_s",
        "dte_um",
        "dte_rate_mm_per_s",
        "mesh_deflection_um",
        "mesh_force_n",
        "pinion_bearing_force_n",
        "gear_bearing_force_n",
    ];
    let rows = all.iter().flat_map(|one| {
        let r = &one.response;
        (0..r.mesh_cycle.len()).map(move |i| {
            vec![
                one.state.clone(),
                number(r.mesh_cycle[i]),
                number(r.mesh_cycle[i] / r.mesh_frequency),
                um(r.transmission_error[i]),
                number(r.velocity[i] * 1e3),
                um(r.mesh_deflection[i]),
                number(r.mesh_force[i]),
                number(r.pinion_bearing_force[i]),
                number(r.gear_bearing_force[i]),
            ]
        })
    });
    write(path, &header, rows)
}

/// `spectrum.csv`: amplitudes of the dynamic transmission error.
///
/// # Errors
/// I/O errors.
pub fn spectrum(path: &Path, all: &[TimeResponse]) -> Result<(), csv::Error> {
    let header = ["state", "frequency_hz", "mesh_order", "amplitude_um", "phase_rad"];
    let rows = all.iter().flat_map(|one| {
        let s = &one.spectrum;
        (0..s.frequency.len()).map(move |i| {
            let order = s.frequency[i] / one.response.mesh_frequency;
            let values = [number(s.frequency[i]), number(order), um(s.amplitude[i]), number(s.phase[i])];
            std::iter::once(one.state.clone()).chain(values).collect()
        })
    });
    write(path, &header, rows)
}

/// `contact_loss.csv`: stretches without drive contact.
///
/// # Errors
/// I/O errors.
pub fn contact_loss(path: &Path, all: &[TimeResponse]) -> Result<(), csv::Error> {
    let header = ["state", "from_mesh_cycle", "to_mesh_cycle", "contact"];
    let rows = all.iter().flat_map(|one| {
        one.response.separations.iter().map(move |s| {
            let contact = if s.phase == ContactPhase::Coast { "coast flanks" } else { "none" };
            vec![one.state.clone(), number(s.start), number(s.end), contact.into()]
        })
    });
    write(path, &header, rows)
}

/// `tooth_forces.csv`: force on every loaded tooth pair.
///
/// # Errors
/// I/O errors.
pub fn tooth_forces(path: &Path, all: &[TimeResponse]) -> Result<(), csv::Error> {
    let header = ["state", "tooth_pair", "mesh_cycle", "force_n"];
    let rows = all.iter().flat_map(|one| {
        one.tooth_forces.iter().map(move |&(sample, pair, force)| {
            vec![one.state.clone(), pair.to_string(), number(one.response.mesh_cycle[sample]), number(force)]
        })
    });
    write(path, &header, rows)
}

const MEASURE: [&str; 7] =
    ["peak_to_peak_um", "rms_um", "mean_um", "largest_um", "smallest_um", "dynamic_factor", "fraction_without_contact"];

fn measure(m: &Measure) -> [String; 7] {
    [
        um(m.peak_to_peak),
        um(m.rms),
        um(m.mean),
        um(m.maximum),
        um(m.minimum),
        number(m.dynamic_factor),
        number(m.separated_fraction),
    ]
}

/// `sweep.csv`.
///
/// # Errors
/// I/O errors.
pub fn sweep(path: &Path, all: &[SweepResult]) -> Result<(), csv::Error> {
    let header = [&["state", "direction", "mesh_frequency_hz"][..], &MEASURE, &["motion"]].concat();
    let rows = all.iter().flat_map(|one| {
        one.points.iter().map(move |p| {
            let direction = if one.up { "up" } else { "down" };
            let motion = p.multiple.map_or("not periodic".into(), |n| format!("period {n}"));
            let mut row = vec![one.state.clone(), direction.into(), number(p.mesh_frequency)];
            row.extend(measure(&p.measure));
            row.push(motion);
            row
        })
    });
    write(path, &header, rows)
}

/// In words.
#[must_use]
pub fn stability(kind: Stability) -> &'static str {
    match kind {
        Stability::Stable => "stable",
        Stability::Saddle => "unstable, saddle",
        Stability::Flip => "unstable, period doubling",
        Stability::Torus => "unstable, torus",
    }
}

/// `branch.csv`: points and turning points in order along the branch.
///
/// # Errors
/// I/O errors.
pub fn branch(path: &Path, all: &[BranchResult]) -> Result<(), csv::Error> {
    let header =
        [&["state", "mesh_frequency_hz"][..], &MEASURE, &["stability", "largest_multiplier", "turning_point"]].concat();
    let rows = all.iter().flat_map(|one| {
        let turning: Vec<*const BranchPoint> =
            one.branch.turning_points.iter().map(|t| std::ptr::from_ref(&t.point)).collect();
        one.branch.curve().into_iter().map(move |p| {
            let turns = turning.contains(&std::ptr::from_ref(p));
            let largest = p.multipliers.first().map_or(0.0, lpm::Multiplier::modulus);
            let mut row = vec![one.state.clone(), number(p.mesh_frequency)];
            row.extend(measure(&p.measure));
            row.extend([stability(p.stability).into(), number(largest), turns.to_string()]);
            row
        })
    });
    write(path, &header, rows)
}

/// `impulse.csv`: what each impulse test reads; empty cells where nothing oscillates.
///
/// # Errors
/// I/O errors.
pub fn impulse(path: &Path, all: &[ImpulseResult]) -> Result<(), csv::Error> {
    let header =
        ["state", "mesh_cycle", "natural_frequency_hz", "damped_frequency_hz", "damping_ratio", "contact_lost"];
    let rows = all.iter().map(|one| {
        let read = match &one.test {
            Some(t) => [
                number(t.natural_frequency),
                number(t.damped_frequency),
                number(t.damping_ratio),
                (!t.response.separations.is_empty()).to_string(),
            ],
            None => std::array::from_fn(|_| String::new()),
        };
        [one.state.clone(), number(one.mesh_cycle)].into_iter().chain(read).collect()
    });
    write(path, &header, rows)
}

/// `impulse_response.csv`.
///
/// # Errors
/// I/O errors.
pub fn impulse_response(path: &Path, all: &[ImpulseResult]) -> Result<(), csv::Error> {
    let header = ["state", "mesh_cycle", "time_s", "dte_um", "mesh_force_n"];
    let rows = all.iter().flat_map(|one| {
        one.test.iter().flat_map(move |t| {
            let r = &t.response;
            (0..r.mesh_cycle.len()).map(move |i| {
                let time = r.mesh_cycle[i] / r.mesh_frequency;
                let values = [one.mesh_cycle, time, r.transmission_error[i] * 1e6, r.mesh_force[i]];
                std::iter::once(one.state.clone()).chain(values.map(number)).collect()
            })
        })
    });
    write(path, &header, rows)
}

/// `damage_response.csv`: healthy, damaged, their difference, and the same at vanishing speed.
///
/// # Errors
/// I/O errors.
pub fn damage_response(path: &Path, all: &[DamageResult]) -> Result<(), csv::Error> {
    let header = [
        "state",
        "mesh_frequency_hz",
        "mesh_cycle",
        "dte_healthy_um",
        "dte_damaged_um",
        "difference_um",
        "static_difference_um",
    ];
    let rows = all.iter().flat_map(|one| {
        let r = &one.response;
        (0..r.difference.len()).map(move |i| {
            let (healthy, damaged) = (&r.healthy.response, &r.damaged.response);
            vec![
                one.state.clone(),
                number(one.mesh_frequency),
                number(damaged.mesh_cycle[i]),
                um(healthy.transmission_error[i]),
                um(damaged.transmission_error[i]),
                um(r.difference[i]),
                um(r.static_difference[i]),
            ]
        })
    });
    write(path, &header, rows)
}

/// `damage_spectrum.csv`.
///
/// # Errors
/// I/O errors.
pub fn damage_spectrum(path: &Path, all: &[DamageResult]) -> Result<(), csv::Error> {
    let header = ["state", "mesh_frequency_hz", "frequency_hz", "amplitude_um"];
    let rows = all.iter().flat_map(|one| {
        let s = &one.response.spectrum;
        (0..s.frequency.len()).map(move |i| {
            let values = [one.mesh_frequency, s.frequency[i], s.amplitude[i] * 1e6];
            std::iter::once(one.state.clone()).chain(values.map(number)).collect()
        })
    });
    write(path, &header, rows)
}

/// `damage_over_speed.csv`: the largest line of the damage-induced spectrum at every speed.
///
/// # Errors
/// I/O errors.
pub fn damage_speeds(path: &Path, all: &[DamageSpeeds]) -> Result<(), csv::Error> {
    let header = [
        "state",
        "mesh_frequency_hz",
        "frequency_of_largest_line_hz",
        "largest_amplitude_um",
        "peak_to_peak_um",
        "static_amplitude_um",
    ];
    let rows = all.iter().flat_map(|one| {
        one.rows.iter().map(move |&[frequency, at, amplitude, peak]| {
            vec![one.state.clone(), number(frequency), number(at), um(amplitude), um(peak), um(one.static_amplitude)]
        })
    });
    write(path, &header, rows)
}
