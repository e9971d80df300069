//! CSV tables of dynamics; one row per step, units in the column names, converted here.

use std::path::Path;

use lpm::Spectrum;

use super::{BLOW_STEPS, Blow, Difference, Response, Speed, coordinate_names};

fn number(value: f64) -> String {
    format!("{value:.9e}")
}

fn um(value: f64) -> String {
    number(value * 1e6)
}

fn write(path: &Path, header: &[String], rows: impl Iterator<Item = Vec<String>>) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(header)?;
    for row in rows {
        table.write_record(row)?;
    }
    table.flush()?;
    Ok(())
}

fn names(header: &[&str]) -> Vec<String> {
    header.iter().map(|&name| name.to_owned()).collect()
}

/// `response.csv`: transmission error, forces, coordinates of the hubs, forces of the bearings on the ground.
///
/// # Errors
/// I/O errors.
pub fn response(path: &Path, response: &Response) -> Result<(), csv::Error> {
    let mut header = names(&["time_s", "mesh_cycle", "dte_um", "mesh_force_n", "coast_flank_force_n"]);
    // translations first: index in HUB_COORDINATES below 3
    let turns: Vec<bool> = response.coordinates.iter().map(|c| c.1 >= 3).collect();
    let coordinates = coordinate_names(&response.coordinates);
    header
        .extend(coordinates.iter().zip(&turns).map(|(n, turns)| format!("{n}_{}", if *turns { "urad" } else { "um" })));
    let bearings = coordinates.iter().zip(&turns);
    header.extend(bearings.map(|(n, turns)| format!("{n}_bearing_{}", if *turns { "moment_n_m" } else { "force_n" })));
    let rows = response.samples.iter().enumerate().map(|(k, sample)| {
        let mut row = vec![
            number(k as f64 * response.time_step),
            number(response.mesh_cycle[k]),
            um(sample.transmission_error),
            number(sample.mesh_force),
            number(sample.back_force),
        ];
        row.extend(sample.coordinates.iter().map(|&q| um(q)));
        row.extend(sample.support_forces.iter().map(|&f| number(f)));
        row
    });
    write(path, &header, rows)
}

/// `spectrum.csv`: one-sided amplitudes.
///
/// # Errors
/// I/O errors.
pub fn spectrum(path: &Path, spectrum: &Spectrum, mesh_frequency: f64) -> Result<(), csv::Error> {
    let header = names(&["frequency_hz", "mesh_order", "amplitude_um", "phase_rad"]);
    let rows = (0..spectrum.frequency.len()).map(|i| {
        let frequency = spectrum.frequency[i];
        vec![
            number(frequency),
            number(frequency / mesh_frequency),
            um(spectrum.amplitude[i]),
            number(spectrum.phase[i]),
        ]
    });
    write(path, &header, rows)
}

/// `difference.csv`: damaged minus healthy.
///
/// # Errors
/// I/O errors.
pub fn difference(path: &Path, response: &Response, difference: &Difference) -> Result<(), csv::Error> {
    let header = names(&["time_s", "mesh_cycle", "difference_um"]);
    let rows = difference
        .signal
        .iter()
        .enumerate()
        .map(|(k, &value)| vec![number(k as f64 * response.time_step), number(response.mesh_cycle[k]), um(value)]);
    write(path, &header, rows)
}

/// `tooth_forces.csv`: force on every loaded tooth pair of every state.
///
/// # Errors
/// I/O errors.
pub fn tooth_forces(path: &Path, all: &[Response]) -> Result<(), csv::Error> {
    let header = names(&["state", "tooth_pair", "mesh_cycle", "force_n"]);
    let rows = all.iter().flat_map(|response| {
        response.samples.iter().zip(&response.mesh_cycle).flat_map(move |(sample, &cycle)| {
            let row = move |&(pair, force): &(i32, f64)| {
                vec![response.state.clone(), pair.to_string(), number(cycle), number(force)]
            };
            sample.pairs.iter().map(row)
        })
    });
    write(path, &header, rows)
}

/// `contact_loss.csv`: stretches without drive contact, from the first to the last such step.
///
/// # Errors
/// I/O errors.
pub fn contact_loss(path: &Path, all: &[Response]) -> Result<(), csv::Error> {
    let header = names(&["state", "from_mesh_cycle", "to_mesh_cycle", "contact"]);
    let rows = all.iter().flat_map(|response| {
        response.contact_loss().into_iter().map(|([from, to], back)| {
            let contact = if back { "coast flanks" } else { "none" };
            vec![response.state.clone(), number(from), number(to), contact.into()]
        })
    });
    write(path, &header, rows)
}

/// `over_speed.csv`: one row per speed and state.
///
/// # Errors
/// I/O errors.
pub fn over_speed(path: &Path, speeds: &[Speed]) -> Result<(), csv::Error> {
    let header = names(&[
        "state",
        "speed_rpm",
        "mesh_frequency_hz",
        "mean_um",
        "rms_um",
        "peak_to_peak_um",
        "mesh_frequency_amplitude_um",
        "largest_mesh_force_n",
        "fraction_without_contact",
        "difference_rms_um",
        "steady",
    ]);
    let rows = speeds.iter().flat_map(|speed| {
        speed.responses.iter().map(move |response| {
            let steady = response.steady.map_or("not looked at".to_owned(), |steady| steady.to_string());
            vec![
                response.state.clone(),
                number(speed.speed * 30.0 / std::f64::consts::PI),
                number(speed.mesh_frequency),
                um(response.mean()),
                um(response.rms()),
                um(response.peak_to_peak()),
                um(response.spectrum.amplitude_at(speed.mesh_frequency)),
                number(response.largest(|sample| sample.mesh_force).0),
                number(response.without_contact()),
                response.difference.as_ref().map_or(String::new(), |difference| um(difference.rms)),
                steady,
            ]
        })
    });
    write(path, &header, rows)
}

/// `impulse.csv`: what each impulse test reads; empty cells where nothing oscillates.
///
/// # Errors
/// I/O errors.
pub fn impulse(path: &Path, tests: &[Blow]) -> Result<(), csv::Error> {
    let header = names(&[
        "state",
        "mesh_cycle",
        "natural_frequency_hz",
        "damping_ratio_log_decrement",
        "spectrum_peak_hz",
        "damping_ratio_half_power",
    ]);
    let rows = tests.iter().map(|test| {
        let read = match &test.reading {
            Some(r) => {
                [r.natural_frequency, r.damping_log_decrement, r.peak_frequency, r.damping_half_power].map(number)
            }
            None => std::array::from_fn(|_| String::new()),
        };
        [test.state.clone(), number(test.mesh_cycle)].into_iter().chain(read).collect()
    });
    write(path, &header, rows)
}

/// `impulse_response.csv`: the decays, every eighth step.
///
/// # Errors
/// I/O errors.
pub fn impulse_response(path: &Path, tests: &[Blow]) -> Result<(), csv::Error> {
    let header = names(&["state", "mesh_cycle", "time_s", "dte_um", "mesh_force_n"]);
    let rows = tests.iter().flat_map(|test| {
        let records = test.reading.iter().flat_map(|reading| reading.run.records.iter().step_by(BLOW_STEPS));
        records.map(|r| {
            let values = [test.mesh_cycle, r.time, r.transmission_error * 1e6, r.mesh_force];
            std::iter::once(test.state.clone()).chain(values.map(number)).collect()
        })
    });
    write(path, &header, rows)
}
