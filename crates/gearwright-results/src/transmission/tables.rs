//! CSV tables of a transmission; units in the column names, converted here.

use std::path::Path;

use hums::spectrum::{Spectrum, Window};

use super::{Findings, Sensor, State};

fn number(value: f64) -> String {
    format!("{value:.9e}")
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

/// Name of a sensor or mesh in a column.
#[must_use]
pub fn column(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '-'], "_")
}

/// Columns of one length under their names; rows begin with `first`.
fn columns(
    path: &Path,
    first: &[&str],
    start: impl Fn(usize) -> Vec<f64>,
    all: &[(String, Vec<f64>)],
) -> Result<(), csv::Error> {
    let header: Vec<String> = names(first).into_iter().chain(all.iter().map(|(name, _)| name.clone())).collect();
    let length = all.first().map_or(0, |(_, values)| values.len());
    let rows = (0..length).map(|k| {
        let values = start(k).into_iter().chain(all.iter().map(|(_, values)| values[k]));
        values.map(number).collect()
    });
    write(path, &header, rows)
}

/// `acceleration.csv`: signals of the sensors.
///
/// # Errors
/// I/O errors.
pub fn acceleration(
    path: &Path,
    findings: &Findings,
    state: &State,
    sensors: &[(usize, &Sensor)],
) -> Result<(), csv::Error> {
    let all: Vec<_> =
        sensors.iter().map(|(k, sensor)| (format!("{}_g", column(&sensor.name)), state.signals[*k].clone())).collect();
    let start = |k: usize| vec![k as f64 * state.run.sample_time, findings.turn(k)];
    columns(path, &["time_s", "carrier_turn"], start, &all)
}

/// `difference.csv`: signals less those of the healthy state.
///
/// # Errors
/// I/O errors.
pub fn difference(
    path: &Path,
    findings: &Findings,
    state: &State,
    sensors: &[(usize, &Sensor)],
) -> Result<(), csv::Error> {
    let exact =
        |k: usize, sensor: &Sensor| Some((format!("{}_g", column(&sensor.name)), state.judged[k].exact.clone()?));
    let all: Vec<_> = sensors.iter().filter_map(|(k, sensor)| exact(*k, sensor)).collect();
    let start = |k: usize| vec![k as f64 * state.run.sample_time, findings.turn(k)];
    columns(path, &["time_s", "carrier_turn"], start, &all)
}

/// `average_planet_pass.csv`, `average_carrier.csv`: synchronous average, approximate difference signals by the number of sideband pairs they lose,
/// and exact difference signal.
///
/// # Errors
/// I/O errors.
pub fn average(
    path: &Path,
    findings: &Findings,
    state: &State,
    period: usize,
    sensors: &[(usize, &Sensor)],
) -> Result<(), csv::Error> {
    let all: Vec<_> = sensors
        .iter()
        .flat_map(|(k, sensor)| {
            let (averaged, name) = (&state.judged[*k].averages[period], column(&sensor.name));
            let approximate = averaged.approximate.iter().enumerate();
            let approximate = approximate.map(|(k, signal)| (format!("{name}_difference_{k}_g"), signal.clone()));
            let exact = averaged.exact.iter().map(|exact| (format!("{name}_exact_difference_g"), exact.clone()));
            std::iter::once((format!("{name}_tsa_g"), averaged.average.clone()))
                .chain(approximate)
                .chain(exact)
                .collect::<Vec<_>>()
        })
        .collect();
    columns(path, &["carrier_turn"], |k| vec![findings.turn(k)], &all)
}

/// One-sided amplitudes of signals of one length; `mesh_frequency` (Hz) gives orders.
///
/// # Errors
/// I/O errors; signals without a spectrum are errors of data.
pub fn spectra(path: &Path, time_step: f64, mesh_frequency: f64, signals: &[(String, &[f64])]) -> anyhow::Result<()> {
    let mut all = Vec::new();
    let mut frequencies = Vec::new();
    for (name, signal) in signals {
        let spectrum = Spectrum::of(signal, Window::Rectangular)?;
        frequencies = spectrum.frequencies(1.0 / time_step);
        all.push((format!("{}_g", column(name)), spectrum.amplitudes()));
    }
    let start = |k: usize| vec![frequencies[k], frequencies[k] / mesh_frequency];
    columns(path, &["frequency_hz", "mesh_order"], start, &all)?;
    Ok(())
}

/// `meshes.csv`: force and approach of every mesh.
///
/// # Errors
/// I/O errors.
pub fn meshes(path: &Path, findings: &Findings, state: &State) -> Result<(), csv::Error> {
    let all: Vec<_> = state
        .run
        .meshes
        .iter()
        .flat_map(|mesh| {
            let name = column(&mesh.name);
            let approach = mesh.approach.iter().map(|x| x * 1e6).collect();
            [
                (format!("{name}_force_n"), mesh.force.clone()),
                (format!("{name}_coast_flank_force_n"), mesh.coast_force.clone()),
                (format!("{name}_approach_um"), approach),
            ]
        })
        .collect();
    let start = |k: usize| vec![k as f64 * state.run.sample_time, findings.turn(k)];
    columns(path, &["time_s", "carrier_turn"], start, &all)
}

/// Mean, standard deviation, least and greatest value.
#[must_use]
pub fn statistics(values: &[f64]) -> [f64; 4] {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    if values.is_empty() { [0.0; 4] } else { [mean, variance.sqrt(), low, high] }
}

/// Share of a mesh in the mean force of all meshes of its kind, and its number of the kind, by its name (`sun-planet 2`).
#[must_use]
pub fn share(state: &State, mesh: &str) -> Option<f64> {
    let kind = |name: &str| name.rsplit_once(' ').map(|(kind, _)| kind.to_owned());
    let own = kind(mesh)?;
    let mean = |name: &str| {
        let mesh = state.run.meshes.iter().find(|mesh| mesh.name == name);
        mesh.map_or(0.0, |mesh| statistics(&mesh.force)[0])
    };
    let all: f64 = state
        .run
        .meshes
        .iter()
        .filter(|other| kind(&other.name).as_ref() == Some(&own))
        .map(|other| mean(&other.name))
        .sum();
    (all > 0.0).then(|| mean(mesh) / all)
}

/// `load_sharing.csv`: forces of every mesh of every state.
///
/// # Errors
/// I/O errors.
pub fn load_sharing(path: &Path, findings: &Findings) -> Result<(), csv::Error> {
    let header = names(&[
        "state",
        "mesh",
        "share_of_mean",
        "mean_n",
        "standard_deviation_n",
        "least_n",
        "greatest_n",
        "contact_losses",
        "steps_apart",
    ]);
    let rows = findings.states.iter().flat_map(|state| {
        state.run.meshes.iter().map(move |mesh| {
            let own = share(state, &mesh.name);
            let mut row = vec![state.name.clone(), mesh.name.clone(), own.map_or(String::new(), number)];
            row.extend(statistics(&mesh.force).map(number));
            row.extend([mesh.losses.to_string(), mesh.steps_apart.to_string()]);
            row
        })
    });
    write(path, &header, rows)
}

/// `bearings.csv`: loads of every bearing of every state, along and about its axes.
///
/// # Errors
/// I/O errors.
pub fn bearings(path: &Path, findings: &Findings) -> Result<(), csv::Error> {
    const AXES: [&str; 6] = ["force_1_n", "force_2_n", "force_3_n", "moment_1_n_m", "moment_2_n_m", "moment_3_n_m"];
    let header = names(&["state", "bearing", "load", "mean", "standard_deviation", "least", "greatest"]);
    let rows = findings.states.iter().flat_map(|state| {
        state.run.bearings.iter().flat_map(move |bearing| {
            bearing.load.iter().zip(AXES).map(move |(load, axis)| {
                let mut row = vec![state.name.clone(), bearing.name.clone(), axis.to_owned()];
                row.extend(statistics(load).map(number));
                row
            })
        })
    });
    write(path, &header, rows)
}

/// `natural_frequencies.csv`: modes of the transmission and where their kinetic energy is.
///
/// # Errors
/// I/O errors.
pub fn natural_frequencies(path: &Path, findings: &Findings) -> Result<(), csv::Error> {
    let mut header = names(&["mode", "frequency_hz"]);
    header.extend(findings.parts.iter().map(|part| format!("energy_{}", column(part))));
    let rows = findings.modes.iter().enumerate().map(|(k, mode)| {
        let values = std::iter::once(mode.frequency).chain(mode.energy.iter().copied());
        std::iter::once((k + 1).to_string()).chain(values.map(number)).collect()
    });
    write(path, &header, rows)
}

/// `housing_frequencies.csv`: coordinates of the housing alone; the highest are static responses.
///
/// # Errors
/// I/O errors.
pub fn housing_frequencies(path: &Path, findings: &Findings) -> Result<(), csv::Error> {
    let header = names(&["mode", "frequency_hz", "damping_ratio"]);
    let rows = findings.housing.iter().enumerate();
    write(path, &header, rows.map(|(k, (f, zeta))| vec![(k + 1).to_string(), number(*f), number(*zeta)]))
}

/// `indicators.csv`: every indicator of every signal of every sensor in every state.
///
/// # Errors
/// I/O errors.
pub fn indicators(path: &Path, findings: &Findings) -> Result<(), csv::Error> {
    let header =
        names(&["state", "sensor", "angle_deg", "average", "signal", "indicator", "value", "reason", "gaussian_value"]);
    let rows = findings.states.iter().flat_map(|state| {
        state.judged.iter().zip(&findings.sensors).flat_map(move |(judged, sensor)| {
            judged.rows.iter().map(move |row| {
                let (value, reason) = match &row.value {
                    Ok(value) => (number(*value), String::new()),
                    Err(reason) => (String::new(), reason.clone()),
                };
                vec![
                    state.name.clone(),
                    sensor.name.clone(),
                    format!("{:.4}", sensor.angle_deg),
                    row.averaging.name().to_owned(),
                    row.signal.clone(),
                    row.indicator.to_owned(),
                    value,
                    reason,
                    row.nominal.map_or(String::new(), number),
                ]
            })
        })
    });
    write(path, &header, rows)
}
