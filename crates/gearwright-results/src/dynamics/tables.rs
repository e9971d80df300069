//! Tables of dynamics; one row per step.

use lpm::Spectrum;

use super::{BLOW_STEPS, Blow, Difference, Dynamics, Response, Sample, Speed, coordinate_names};
use crate::table::{
    FilledTable, HERTZ, MICROMETRE, MICRORADIAN, NEWTON, NEWTON_METRE, PLAIN, RADIAN, REVOLUTIONS_PER_MINUTE, SECOND,
    Table, TableInfo, Unit, column, each,
};

/// Tables of a speed.
#[must_use]
pub fn at_speed(speed: &Speed) -> Vec<FilledTable<'_>> {
    let mut all = Vec::new();
    for one in &speed.responses {
        let suffix = one.suffix();
        all.push(response(Some(one)).named("", &suffix));
        all.push(spectrum(Some((&one.spectrum, speed.mesh_frequency))).named("", &suffix));
        if let Some(exact) = &one.difference {
            all.push(difference(Some((one, exact))).named("", &suffix));
            all.push(spectrum(Some((&exact.spectrum, speed.mesh_frequency))).named("difference_", &suffix));
        }
    }
    all.extend([tooth_forces(&speed.responses), contact_loss(&speed.responses)]);
    all
}

/// All tables of a case; those of several speeds in folders of their own.
#[must_use]
pub fn tables(results: &Dynamics) -> Vec<FilledTable<'_>> {
    let mut all = Vec::new();
    for (row, speed) in results.speeds.iter().enumerate() {
        let folder = results.folder(row);
        all.extend(at_speed(speed).into_iter().map(|table| table.named(&folder, "")));
    }
    all.extend((results.speeds.len() > 1).then(|| over_speed(&results.speeds)));
    if !results.blows.is_empty() {
        all.extend([impulse(&results.blows), impulse_response(&results.blows)]);
    }
    all
}

/// What the tables hold.
#[must_use]
pub fn schemas() -> Vec<TableInfo> {
    let all = [
        response(None),
        spectrum(None),
        difference(None),
        tooth_forces(&[]),
        contact_loss(&[]),
        over_speed(&[]),
        impulse(&[]),
        impulse_response(&[]),
    ];
    all.iter().map(|table| table.schema().clone()).collect()
}

fn response(one: Option<&Response>) -> FilledTable<'_> {
    type Row<'a> = (&'a Response, usize, &'a Sample);
    let columns = vec![
        column("time", SECOND, "Time from the start of the record.", |(one, k, _): &Row<'_>| *k as f64 * one.time_step),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(one, k, _): &Row<'_>| one.mesh_cycle[*k]),
        column("dte", MICROMETRE, "Dynamic transmission error.", |(.., s): &Row<'_>| s.transmission_error),
        column("mesh_force", NEWTON, "Force on the drive flanks.", |(.., s): &Row<'_>| s.mesh_force),
        column("coast_flank_force", NEWTON, "Force on the coast flanks.", |(.., s): &Row<'_>| s.back_force),
    ];
    let coordinates: Vec<(String, usize)> = match one {
        // translations first: index in HUB_COORDINATES below 3
        Some(one) => coordinate_names(&one.coordinates)
            .into_iter()
            .zip(one.coordinates.iter().map(|coordinate| usize::from(coordinate.1 >= 3)))
            .collect(),
        None => [0, 1].map(|kind| ("<coordinate>".to_owned(), kind)).to_vec(),
    };
    let motions: [(&'static str, Unit, &'static str); 2] =
        [("<coordinate>", MICROMETRE, "Translation of a hub."), ("<coordinate>", MICRORADIAN, "Rotation of a hub.")];
    let supports: [(&'static str, Unit, &'static str); 2] = [
        ("<coordinate>_bearing_force", NEWTON, "Force of its support on the ground."),
        ("<coordinate>_bearing_moment", NEWTON_METRE, "Moment of its support on the ground."),
    ];
    let values: [fn(&Sample, usize) -> f64; 2] = [|s, k| s.coordinates[k], |s, k| s.support_forces[k]];
    let mut table =
        Table::new("response", "Transmission error, forces, motions of the hubs, forces of their supports.", columns);
    for (columns, value) in [motions, supports].into_iter().zip(values) {
        for (index, (coordinate, kind)) in coordinates.iter().enumerate() {
            let (name, unit, text) = columns[*kind];
            let of = move |(.., sample): &Row<'_>, _: usize| value(sample, index);
            table = table.and_each(vec![coordinate.clone()], vec![each(name, unit, text, of)]);
        }
    }
    table.with(one.into_iter().flat_map(|one| one.samples.iter().enumerate().map(move |(k, s)| (one, k, s))))
}

fn spectrum(spectrum: Option<(&Spectrum, f64)>) -> FilledTable<'_> {
    type Row<'a> = (&'a Spectrum, f64, usize);
    let columns = vec![
        column("frequency", HERTZ, "Frequency of the line.", |(s, _, i): &Row<'_>| s.frequency[*i]),
        column("mesh_order", PLAIN, "Frequency over the mesh frequency.", |(s, mesh, i): &Row<'_>| {
            s.frequency[*i] / mesh
        }),
        column("amplitude", MICROMETRE, "One-sided amplitude.", |(s, _, i): &Row<'_>| s.amplitude[*i]),
        column("phase", RADIAN, "Its phase.", |(s, _, i): &Row<'_>| s.phase[*i]),
    ];
    let rows = spectrum.into_iter().flat_map(|(s, mesh)| (0..s.frequency.len()).map(move |i| (s, mesh, i)));
    Table::new("spectrum", "Spectrum of the transmission error; in `difference_spectrum` of its difference.", columns)
        .with(rows)
}

fn difference<'a>(exact: Option<(&'a Response, &'a Difference)>) -> FilledTable<'a> {
    type Row<'a> = (&'a Response, usize, f64);
    let columns = vec![
        column("time", SECOND, "Time from the start of the record.", |(one, k, _): &Row<'_>| *k as f64 * one.time_step),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(one, k, _): &Row<'_>| one.mesh_cycle[*k]),
        column("difference", MICROMETRE, "Transmission error, damaged less healthy.", |(.., d): &Row<'_>| *d),
    ];
    let rows = exact.into_iter().flat_map(|(one, d)| d.signal.iter().enumerate().map(move |(k, x)| (one, k, *x)));
    Table::new("difference", "Exact difference signal of a damaged state.", columns).with(rows)
}

fn tooth_forces(all: &[Response]) -> FilledTable<'_> {
    type Row<'a> = (&'a Response, f64, &'a (i32, f64));
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, ..): &Row<'_>| one.state.as_str()),
        column("tooth_pair", PLAIN, "Number of the tooth pair.", |(.., pair): &Row<'_>| pair.0),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(_, cycle, _): &Row<'_>| *cycle),
        column("force", NEWTON, "Force on the tooth pair.", |(.., pair): &Row<'_>| pair.1),
    ];
    let rows = all.iter().flat_map(|one| {
        let samples = one.samples.iter().zip(&one.mesh_cycle);
        samples.flat_map(move |(sample, &cycle)| sample.pairs.iter().map(move |pair| (one, cycle, pair)))
    });
    Table::new("tooth_forces", "Force on every loaded tooth pair of every state.", columns).with(rows)
}

fn contact_loss(all: &[Response]) -> FilledTable<'_> {
    type Row<'a> = (&'a Response, [f64; 2], bool);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, ..): &Row<'_>| one.state.as_str()),
        column("from_mesh_cycle", PLAIN, "First step without drive contact.", |(_, stretch, _): &Row<'_>| stretch[0]),
        column("to_mesh_cycle", PLAIN, "Last step without drive contact.", |(_, stretch, _): &Row<'_>| stretch[1]),
        column("contact", PLAIN, "Contact meanwhile: `none`, or `coast flanks`.", |(.., back): &Row<'_>| {
            if *back { "coast flanks" } else { "none" }
        }),
    ];
    let rows =
        all.iter().flat_map(|one| one.contact_loss().into_iter().map(move |(stretch, back)| (one, stretch, back)));
    Table::new("contact_loss", "Stretches without drive contact.", columns).with(rows)
}

fn over_speed(speeds: &[Speed]) -> FilledTable<'_> {
    type Row<'a> = (&'a Speed, &'a Response);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(_, one): &Row<'_>| one.state.as_str()),
        column("speed", REVOLUTIONS_PER_MINUTE, "Speed of the pinion.", |(speed, _): &Row<'_>| speed.speed),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(speed, _): &Row<'_>| speed.mesh_frequency),
        column("mean", MICROMETRE, "Mean transmission error.", |(_, one): &Row<'_>| one.mean()),
        column("rms", MICROMETRE, "Root mean square about the mean.", |(_, one): &Row<'_>| one.rms()),
        column("peak_to_peak", MICROMETRE, "Largest minus smallest.", |(_, one): &Row<'_>| one.peak_to_peak()),
        column("mesh_frequency_amplitude", MICROMETRE, "Amplitude at the mesh frequency.", |(speed, one): &Row<'_>| {
            one.spectrum.amplitude_at(speed.mesh_frequency)
        }),
        column("largest_mesh_force", NEWTON, "Largest force on the drive flanks.", |(_, one): &Row<'_>| {
            one.largest(|sample| sample.mesh_force).0
        }),
        column("fraction_without_contact", PLAIN, "Part of the record without drive contact.", |(_, one): &Row<'_>| {
            one.without_contact()
        }),
        column("difference_rms", MICROMETRE, "Root mean square of the difference signal.", |(_, one): &Row<'_>| {
            one.difference.as_ref().map(|difference| difference.rms)
        }),
        column("steady", PLAIN, "Whether the motion repeats.", |(_, one): &Row<'_>| {
            one.steady.map_or("not looked at".to_owned(), |steady| steady.to_string())
        }),
    ];
    let rows = speeds.iter().flat_map(|speed| speed.responses.iter().map(move |one| (speed, one)));
    Table::new("over_speed", "Motion over speed, one row per speed and state.", columns).with(rows)
}

fn impulse(tests: &[Blow]) -> FilledTable<'_> {
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |test: &&Blow| test.state.as_str()),
        column("mesh_cycle", PLAIN, "Position at which the gears stand.", |test: &&Blow| test.mesh_cycle),
        column("natural_frequency", HERTZ, "Natural frequency.", |test: &&Blow| {
            test.reading.as_ref().map(|r| r.natural_frequency)
        }),
        column(
            "damping_ratio_log_decrement",
            PLAIN,
            "Damping ratio from the logarithmic decrement.",
            |test: &&Blow| test.reading.as_ref().map(|r| r.damping_log_decrement),
        ),
        column("spectrum_peak", HERTZ, "Frequency of the peak of the spectrum.", |test: &&Blow| {
            test.reading.as_ref().map(|r| r.peak_frequency)
        }),
        column("damping_ratio_half_power", PLAIN, "Damping ratio from the half-power width.", |test: &&Blow| {
            test.reading.as_ref().map(|r| r.damping_half_power)
        }),
    ];
    Table::new("impulse", "Reading of every impulse test; empty where nothing oscillates.", columns).with(tests.iter())
}

fn impulse_response(tests: &[Blow]) -> FilledTable<'_> {
    type Row<'a> = (&'a Blow, &'a fecm::dynamics::StepRecord);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(test, _): &Row<'_>| test.state.as_str()),
        column("mesh_cycle", PLAIN, "Position at which the gears stand.", |(test, _): &Row<'_>| test.mesh_cycle),
        column("time", SECOND, "Time from the impulse.", |(_, r): &Row<'_>| r.time),
        column("dte", MICROMETRE, "Dynamic transmission error.", |(_, r): &Row<'_>| r.transmission_error),
        column("mesh_force", NEWTON, "Force on the drive flanks.", |(_, r): &Row<'_>| r.mesh_force),
    ];
    let rows = tests.iter().flat_map(|test| {
        let records = test.reading.iter().flat_map(|reading| reading.run.records.iter().step_by(BLOW_STEPS));
        records.map(move |record| (test, record))
    });
    Table::new("impulse_response", "Decay of every impulse test, every eighth step.", columns).with(rows)
}
