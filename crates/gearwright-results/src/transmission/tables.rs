//! Tables of a transmission.

use std::borrow::Cow;

use hums::spectrum::{Spectrum, Window};
use planetary::engine::{BearingRecord, MeshRecord, NaturalMode};

use super::{Findings, Row as Indicator, Sensor, State};
use crate::table::{
    Column, FilledTable, HERTZ, MICROMETRE, NEWTON, PLAIN, SECOND, STANDARD_GRAVITY, Table, TableInfo, Unit, column,
    each,
};

/// Name of a sensor or mesh in a column.
#[must_use]
pub fn column_name(name: &str) -> String {
    name.trim().to_lowercase().replace([' ', '-'], "_")
}

/// All tables of a case; with `around` signals of all sensors about the housing as well.
///
/// # Errors
/// Signals without a spectrum.
pub fn tables(findings: &Findings, around: bool) -> hums::Result<Vec<FilledTable<'_>>> {
    let sensors: Vec<(usize, &Sensor)> = findings.shown(around).collect();
    let mut all = Vec::new();
    for state in &findings.states {
        let suffix = state.suffix();
        let of_state = of_state(findings, state, &sensors)?;
        all.extend(of_state.into_iter().map(|table| table.named("", &suffix)));
    }
    all.extend([load_sharing(&findings.states), bearings(&findings.states)]);
    all.push(natural_frequencies(&findings.modes, &findings.parts));
    all.extend((!findings.housing.is_empty()).then(|| housing_frequencies(&findings.housing)));
    all.extend((!findings.sensors.is_empty()).then(|| indicators(&findings.states, &findings.sensors)));
    Ok(all)
}

/// What the tables hold.
#[must_use]
pub fn schemas() -> Vec<TableInfo> {
    let clock = Clock { time_step: 0.0, samples_per_turn: 1 };
    let average = average(clock, &[], 0, &[]).named("average_", "");
    let all = [
        meshes(clock, &[]),
        acceleration(clock, Vec::new()),
        difference(clock, Vec::new()),
        average,
        spectrum(0.0, Vec::new(), Vec::new()),
        load_sharing(&[]),
        bearings(&[]),
        natural_frequencies(&[], &[]),
        housing_frequencies(&[]),
        indicators(&[], &[]),
    ];
    all.iter().map(|table| table.schema().clone()).collect()
}

/// From samples to time and carrier turns.
#[derive(Debug, Clone, Copy)]
struct Clock {
    time_step: f64,
    samples_per_turn: usize,
}

impl Clock {
    fn time<'a>(self) -> Column<'a, usize> {
        column("time", SECOND, "Time from the start of the record.", move |k: &usize| *k as f64 * self.time_step)
    }

    fn turn<'a>(self) -> Column<'a, usize> {
        column("carrier_turn", PLAIN, "Turns of the carrier.", move |k: &usize| {
            *k as f64 / self.samples_per_turn as f64
        })
    }
}

/// Signals of one length under their keys.
type Signals<'a> = Vec<(String, Cow<'a, [f64]>)>;

/// A table with a family of columns of signals.
fn with_signals<'a>(
    table: Table<'a, usize>,
    (name, unit, text): (&'static str, Unit, &'static str),
    signals: Signals<'a>,
) -> Table<'a, usize> {
    let (keys, values): (Vec<String>, Vec<Cow<'a, [f64]>>) = signals.into_iter().unzip();
    table.and_each(keys, vec![each(name, unit, text, move |sample: &usize, key| values[key][*sample])])
}

fn length(signals: &Signals<'_>) -> usize {
    signals.first().map_or(0, |(_, values)| values.len())
}

/// Tables of a state.
fn of_state<'a>(
    findings: &'a Findings,
    state: &'a State,
    sensors: &[(usize, &'a Sensor)],
) -> hums::Result<Vec<FilledTable<'a>>> {
    let clock = Clock { time_step: state.run.sample_time, samples_per_turn: findings.samples_per_turn };
    let mut all = vec![meshes(clock, &state.run.meshes)];
    if sensors.is_empty() {
        return Ok(all);
    }
    let mesh_frequency = findings.mesh_frequency;
    let of_sensors = |signal: &dyn Fn(usize) -> Option<&'a [f64]>| -> Signals<'a> {
        let named = |(k, sensor): &(usize, &Sensor)| Some((column_name(&sensor.name), Cow::from(signal(*k)?)));
        sensors.iter().filter_map(named).collect()
    };
    let signals = of_sensors(&|k| Some(&state.signals[k]));
    all.push(acceleration(clock, signals.clone()));
    all.push(spectra(clock, mesh_frequency, signals)?);
    let differences = of_sensors(&|k| state.judged[k].exact.as_deref());
    if !differences.is_empty() {
        all.push(difference(clock, differences.clone()));
        all.push(spectra(clock, mesh_frequency, differences)?.named("difference_", ""));
    }
    for (period, kind) in findings.periods.iter().enumerate() {
        let name = format!("_{}", kind.averaging.name());
        all.push(average(clock, sensors, period, std::slice::from_ref(state)).named("", &name));
        let differences = of_sensors(&|k| state.judged[k].averages[period].exact.as_deref());
        if !differences.is_empty() {
            all.push(spectra(clock, mesh_frequency, differences)?.named("difference_", &name));
        }
    }
    Ok(all)
}

fn acceleration<'a>(clock: Clock, signals: Signals<'a>) -> FilledTable<'a> {
    let samples = length(&signals);
    let table = Table::new("acceleration", "Signals of the sensors.", vec![clock.time(), clock.turn()]);
    with_signals(table, ("<sensor>", STANDARD_GRAVITY, "Acceleration at the sensor."), signals).with(0..samples)
}

fn difference<'a>(clock: Clock, signals: Signals<'a>) -> FilledTable<'a> {
    let samples = length(&signals);
    let text = "Signals less those of the healthy state.";
    let table = Table::new("difference", text, vec![clock.time(), clock.turn()]);
    with_signals(table, ("<sensor>", STANDARD_GRAVITY, "Difference at the sensor."), signals).with(0..samples)
}

/// Averages of a state, one at most.
fn average<'a>(clock: Clock, sensors: &[(usize, &'a Sensor)], period: usize, state: &'a [State]) -> FilledTable<'a> {
    const TSA: (&str, Unit, &str) = ("<sensor>_tsa", STANDARD_GRAVITY, "Synchronous average.");
    const APPROXIMATE: (&str, Unit, &str) = (
        "<sensor>_difference_<pairs>",
        STANDARD_GRAVITY,
        "Average without the mesh harmonics and this number of sideband pairs at each.",
    );
    const EXACT: (&str, Unit, &str) =
        ("<sensor>_exact_difference", STANDARD_GRAVITY, "Average less that of the healthy state.");
    let text =
        "Synchronous average over a period (`average_planet_pass`, `average_carrier`), and its difference signals.";
    let mut table = Table::new("average", text, vec![clock.turn()]);
    let mut samples = 0;
    let Some(state) = state.first() else {
        for family in [TSA, APPROXIMATE, EXACT] {
            table = with_signals(table, family, Vec::new());
        }
        return table.with(0..0);
    };
    for (k, sensor) in sensors {
        let (averaged, name) = (&state.judged[*k].averages[period], column_name(&sensor.name));
        samples = averaged.average.len();
        let approximate = averaged.approximate.iter().enumerate();
        let approximate =
            approximate.map(|(pairs, signal)| (format!("{name}_difference_{pairs}"), Cow::from(signal))).collect();
        let exact = averaged.exact.iter().map(|exact| (name.clone(), Cow::from(exact))).collect();
        table = with_signals(table, TSA, vec![(name.clone(), Cow::from(&averaged.average))]);
        table = with_signals(table, APPROXIMATE, approximate);
        table = with_signals(table, EXACT, exact);
    }
    table.with(0..samples)
}

/// One-sided amplitudes of signals of one length.
fn spectra<'a>(clock: Clock, mesh_frequency: f64, signals: Signals<'a>) -> hums::Result<FilledTable<'a>> {
    let mut amplitudes = Vec::new();
    let mut frequencies = Vec::new();
    for (name, signal) in signals {
        let spectrum = Spectrum::of(&signal, Window::Rectangular)?;
        frequencies = spectrum.frequencies(1.0 / clock.time_step);
        amplitudes.push((name, Cow::from(spectrum.amplitudes())));
    }
    Ok(spectrum(mesh_frequency, frequencies, amplitudes))
}

fn spectrum<'a>(mesh_frequency: f64, frequencies: Vec<f64>, amplitudes: Signals<'a>) -> FilledTable<'a> {
    let lines = frequencies.len();
    let orders = frequencies.clone();
    let columns = vec![
        column("frequency", HERTZ, "Frequency of the line.", move |k: &usize| frequencies[*k]),
        column("mesh_order", PLAIN, "Frequency over the planetary mesh frequency.", move |k: &usize| {
            orders[*k] / mesh_frequency
        }),
    ];
    let text = "One-sided amplitudes of the signals; in `difference_spectrum` of the difference signals, in \
                `difference_spectrum_PERIOD` of those of the averages.";
    let table = Table::new("spectrum", text, columns);
    with_signals(table, ("<sensor>", STANDARD_GRAVITY, "Amplitude at the sensor."), amplitudes).with(0..lines)
}

fn meshes(clock: Clock, meshes: &[MeshRecord]) -> FilledTable<'_> {
    let columns = vec![
        each("<mesh>_force", NEWTON, "Force on the drive flanks.", |k: &usize, mesh| meshes[mesh].force[*k]),
        each("<mesh>_coast_flank_force", NEWTON, "Force on the coast flanks.", |k: &usize, mesh| {
            meshes[mesh].coast_force[*k]
        }),
        each("<mesh>_approach", MICROMETRE, "Approach of the gears along the line of action.", |k: &usize, mesh| {
            meshes[mesh].approach[*k]
        }),
    ];
    let keys = meshes.iter().map(|mesh| column_name(&mesh.name)).collect();
    let samples = meshes.first().map_or(0, |mesh| mesh.force.len());
    Table::new("meshes", "Force and approach of every mesh.", vec![clock.time(), clock.turn()])
        .and_each(keys, columns)
        .with(0..samples)
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

/// Columns of [`statistics`].
fn statistics_columns<'a, R: 'a>(unit: Unit, of: fn(&R) -> [f64; 4]) -> Vec<Column<'a, R>> {
    vec![
        column("mean", unit, "Mean over the record.", move |row| of(row)[0]),
        column("standard_deviation", unit, "Standard deviation.", move |row| of(row)[1]),
        column("least", unit, "Least value.", move |row| of(row)[2]),
        column("greatest", unit, "Greatest value.", move |row| of(row)[3]),
    ]
}

fn load_sharing(states: &[State]) -> FilledTable<'_> {
    type Row<'a> = (&'a State, &'a MeshRecord, [f64; 4]);
    let columns = vec![
        column("state", PLAIN, "State of the transmission.", |(state, ..): &Row<'_>| state.name.as_str()),
        column("mesh", PLAIN, "Mesh and its number.", |(_, mesh, _): &Row<'_>| mesh.name.as_str()),
        column(
            "share_of_mean",
            PLAIN,
            "Share in the mean force of all meshes of its kind.",
            |(state, mesh, _): &Row<'_>| share(state, &mesh.name),
        ),
    ];
    let counts = vec![
        column("contact_losses", PLAIN, "Losses of contact.", |(_, mesh, _): &Row<'_>| mesh.losses),
        column("steps_apart", PLAIN, "Steps without contact.", |(_, mesh, _): &Row<'_>| mesh.steps_apart),
    ];
    let rows =
        states.iter().flat_map(|state| state.run.meshes.iter().map(move |mesh| (state, mesh, statistics(&mesh.force))));
    Table::new("load_sharing", "Forces of every mesh in every state.", columns)
        .and(statistics_columns(NEWTON, |(.., found): &Row<'_>| *found))
        .and(counts)
        .with(rows)
}

fn bearings(states: &[State]) -> FilledTable<'_> {
    type Row<'a> = (&'a State, &'a BearingRecord, &'static str, [f64; 4]);
    const AXES: [&str; 6] = ["force_1_n", "force_2_n", "force_3_n", "moment_1_n_m", "moment_2_n_m", "moment_3_n_m"];
    let columns = vec![
        column("state", PLAIN, "State of the transmission.", |(state, ..): &Row<'_>| state.name.as_str()),
        column("bearing", PLAIN, "Bearing, named by body and number.", |(_, bearing, ..): &Row<'_>| {
            bearing.name.as_str()
        }),
        column("load", PLAIN, "Load along or about an axis of the bearing, with its unit.", |row: &Row<'_>| row.2),
    ];
    let rows = states.iter().flat_map(|state| {
        state.run.bearings.iter().flat_map(move |bearing| {
            bearing.load.iter().zip(AXES).map(move |(load, axis)| (state, bearing, axis, statistics(load)))
        })
    });
    Table::new("bearings", "Loads of every bearing in every state.", columns)
        .and(statistics_columns(PLAIN, |(.., found): &Row<'_>| *found))
        .with(rows)
}

fn natural_frequencies<'a>(modes: &'a [NaturalMode], parts: &[String]) -> FilledTable<'a> {
    type Row<'a> = (usize, &'a NaturalMode);
    let columns = vec![
        column("mode", PLAIN, "Number of the mode.", |(k, _): &Row<'_>| k + 1),
        column("frequency", HERTZ, "Natural frequency.", |(_, mode): &Row<'_>| mode.frequency),
    ];
    let energy =
        each("energy_<part>", PLAIN, "Share of the part in the kinetic energy.", |(_, mode): &Row<'_>, part| {
            mode.energy[part]
        });
    let keys = parts.iter().map(|part| column_name(part)).collect();
    Table::new("natural_frequencies", "Modes of the transmission and where their kinetic energy is.", columns)
        .and_each(keys, vec![energy])
        .with(modes.iter().enumerate())
}

fn housing_frequencies(housing: &[(f64, f64)]) -> FilledTable<'_> {
    type Row<'a> = (usize, &'a (f64, f64));
    let columns = vec![
        column("mode", PLAIN, "Number of the coordinate.", |(k, _): &Row<'_>| k + 1),
        column("frequency", HERTZ, "Its natural frequency.", |(_, mode): &Row<'_>| mode.0),
        column("damping_ratio", PLAIN, "Its damping ratio.", |(_, mode): &Row<'_>| mode.1),
    ];
    Table::new("housing_frequencies", "Coordinates of the housing alone; the highest are static responses.", columns)
        .with(housing.iter().enumerate())
}

fn indicators<'a>(states: &'a [State], sensors: &'a [Sensor]) -> FilledTable<'a> {
    type Row<'a> = (&'a State, &'a Sensor, &'a Indicator);
    let columns = vec![
        column("state", PLAIN, "State of the transmission.", |(state, ..): &Row<'_>| state.name.as_str()),
        column("sensor", PLAIN, "Sensor.", |(_, sensor, _): &Row<'_>| sensor.name.as_str()),
        column("angle_deg", PLAIN, "Its angle about the main axis.", |(_, sensor, _): &Row<'_>| {
            format!("{:.4}", sensor.angle_deg)
        }),
        column(
            "average",
            PLAIN,
            "Averaging of the signal: `none`, `planet_pass`, `carrier`.",
            |(.., row): &Row<'_>| row.averaging.name(),
        ),
        column("signal", PLAIN, "Signal it is computed from.", |(.., row): &Row<'_>| row.signal.as_str()),
        column("indicator", PLAIN, "Short name of the indicator.", |(.., row): &Row<'_>| row.indicator),
        column("value", PLAIN, "Value.", |(.., row): &Row<'_>| row.value.as_ref().ok().copied()),
        column("reason", PLAIN, "Why there is no value.", |(.., row): &Row<'_>| {
            row.value.as_ref().err().cloned().unwrap_or_default()
        }),
        column("gaussian_value", PLAIN, "Value for Gaussian noise.", |(.., row): &Row<'_>| row.nominal),
    ];
    let rows = states.iter().flat_map(move |state| {
        let judged = state.judged.iter().zip(sensors);
        judged.flat_map(move |(judged, sensor)| judged.rows.iter().map(move |row| (state, sensor, row)))
    });
    Table::new("indicators", "Every indicator of every signal of every sensor in every state.", columns).with(rows)
}
