//! Tables of lumped-parameter dynamics.

use lpm::{BranchPoint, ContactPhase, Measure, Spectrum, Stability};

use super::{BranchResult, DamageResult, DamageSpeeds, ImpulseResult, Lumped, State, SweepResult, TimeResponse};
use crate::table::{
    Column, FilledTable, HERTZ, MICROMETRE, MILLIMETRE_PER_SECOND, NEWTON, NEWTON_PER_MICROMETRE, PLAIN, RADIAN,
    SECOND, Table, TableInfo, column,
};

/// Points per mesh cycle of `curves.csv`.
const CURVE_POINTS: usize = 100;

/// All tables of a case.
#[must_use]
pub fn tables(results: &Lumped) -> Vec<FilledTable<'_>> {
    let found = &results.findings;
    let mut all = vec![curves(&results.states)];
    if !found.time.is_empty() {
        all.extend([response(&found.time), spectrum(&found.time), contact_loss(&found.time)]);
        all.extend(found.time.iter().any(|t| !t.tooth_forces.is_empty()).then(|| tooth_forces(&found.time)));
    }
    all.extend((!found.sweeps.is_empty()).then(|| sweep(&found.sweeps)));
    all.extend((!found.branches.is_empty()).then(|| branch(&found.branches)));
    if !found.impulses.is_empty() {
        all.extend([impulse(&found.impulses), impulse_response(&found.impulses)]);
    }
    if !found.damage.is_empty() {
        all.extend([damage_response(&found.damage), damage_spectrum(&found.damage)]);
    }
    all.extend((!found.damage_speeds.is_empty()).then(|| damage_speeds(&found.damage_speeds)));
    all
}

/// What the tables hold.
#[must_use]
pub fn schemas() -> Vec<TableInfo> {
    let all = [
        curves(&[]),
        response(&[]),
        spectrum(&[]),
        contact_loss(&[]),
        tooth_forces(&[]),
        sweep(&[]),
        branch(&[]),
        impulse(&[]),
        impulse_response(&[]),
        damage_response(&[]),
        damage_spectrum(&[]),
        damage_speeds(&[]),
    ];
    all.iter().map(|table| table.schema().clone()).collect()
}

fn curves(states: &[State]) -> FilledTable<'_> {
    type Row<'a> = (&'a State, f64);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(state, _): &Row<'_>| state.name.as_str()),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(_, at): &Row<'_>| *at),
        column(
            "mesh_stiffness_local",
            NEWTON_PER_MICROMETRE,
            "Mesh stiffness, slope of force over deflection.",
            |(state, at): &Row<'_>| state.model.excitation().mesh_stiffness().value(*at),
        ),
        column("ste", MICROMETRE, "Static transmission error.", |(state, at): &Row<'_>| {
            state.model.excitation().transmission_error().value(*at)
        }),
    ];
    let rows = states.iter().flat_map(|state| {
        let points = CURVE_POINTS * state.model.excitation().period();
        (0..points).map(move |i| (state, i as f64 / CURVE_POINTS as f64))
    });
    Table::new("curves", "Mesh stiffness and static transmission error of every state over its period.", columns)
        .with(rows)
}

fn response(all: &[TimeResponse]) -> FilledTable<'_> {
    type Row<'a> = (&'a TimeResponse, usize);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, _): &Row<'_>| one.state.as_str()),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(one, i): &Row<'_>| one.response.mesh_cycle[*i]),
        column("time", SECOND, "Time from the start of the record.", |(one, i): &Row<'_>| {
            one.response.mesh_cycle[*i] / one.response.mesh_frequency
        }),
        column("dte", MICROMETRE, "Dynamic transmission error.", |(one, i): &Row<'_>| {
            one.response.transmission_error[*i]
        }),
        column("dte_rate", MILLIMETRE_PER_SECOND, "Its rate.", |(one, i): &Row<'_>| one.response.velocity[*i]),
        column("mesh_deflection", MICROMETRE, "Deflection of the mesh.", |(one, i): &Row<'_>| {
            one.response.mesh_deflection[*i]
        }),
        column("mesh_force", NEWTON, "Force of the mesh.", |(one, i): &Row<'_>| one.response.mesh_force[*i]),
        column("pinion_bearing_force", NEWTON, "Force of the pinion's bearing.", |(one, i): &Row<'_>| {
            one.response.pinion_bearing_force[*i]
        }),
        column("gear_bearing_force", NEWTON, "Force of the gear's bearing.", |(one, i): &Row<'_>| {
            one.response.gear_bearing_force[*i]
        }),
    ];
    let rows = all.iter().flat_map(|one| (0..one.response.mesh_cycle.len()).map(move |i| (one, i)));
    Table::new("response", "Response over time, one row per sample and state.", columns).with(rows)
}

fn spectrum(all: &[TimeResponse]) -> FilledTable<'_> {
    type Row<'a> = (&'a TimeResponse, &'a Spectrum, usize);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, ..): &Row<'_>| one.state.as_str()),
        column("frequency", HERTZ, "Frequency of the line.", |(_, s, i): &Row<'_>| s.frequency[*i]),
        column("mesh_order", PLAIN, "Frequency over the mesh frequency.", |(one, s, i): &Row<'_>| {
            s.frequency[*i] / one.response.mesh_frequency
        }),
        column(
            "amplitude",
            MICROMETRE,
            "One-sided amplitude of the dynamic transmission error.",
            |(_, s, i): &Row<'_>| s.amplitude[*i],
        ),
        column("phase", RADIAN, "Its phase.", |(_, s, i): &Row<'_>| s.phase[*i]),
    ];
    let rows = all.iter().flat_map(|one| (0..one.spectrum.frequency.len()).map(move |i| (one, &one.spectrum, i)));
    Table::new("spectrum", "Spectrum of the dynamic transmission error.", columns).with(rows)
}

fn contact_loss(all: &[TimeResponse]) -> FilledTable<'_> {
    type Row<'a> = (&'a TimeResponse, &'a lpm::Interval);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, _): &Row<'_>| one.state.as_str()),
        column("from_mesh_cycle", PLAIN, "Loss of drive contact.", |(_, s): &Row<'_>| s.start),
        column("to_mesh_cycle", PLAIN, "Return of drive contact.", |(_, s): &Row<'_>| s.end),
        column("contact", PLAIN, "Contact meanwhile: `none`, or `coast flanks`.", |(_, s): &Row<'_>| {
            if s.phase == ContactPhase::Coast { "coast flanks" } else { "none" }
        }),
    ];
    let rows = all.iter().flat_map(|one| one.response.separations.iter().map(move |s| (one, s)));
    Table::new("contact_loss", "Stretches without drive contact.", columns).with(rows)
}

fn tooth_forces(all: &[TimeResponse]) -> FilledTable<'_> {
    type Row<'a> = (&'a TimeResponse, &'a (usize, i32, f64));
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, _): &Row<'_>| one.state.as_str()),
        column("tooth_pair", PLAIN, "Number of the tooth pair.", |(_, f): &Row<'_>| f.1),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(one, f): &Row<'_>| one.response.mesh_cycle[f.0]),
        column("force", NEWTON, "Force on the tooth pair.", |(_, f): &Row<'_>| f.2),
    ];
    let rows = all.iter().flat_map(|one| one.tooth_forces.iter().map(move |force| (one, force)));
    Table::new("tooth_forces", "Force on every loaded tooth pair.", columns).with(rows)
}

/// Columns of what is measured of a periodic motion.
fn measure<'a, R: 'a>(of: impl Fn(&R) -> &Measure + Copy + 'a) -> Vec<Column<'a, R>> {
    vec![
        column("peak_to_peak", MICROMETRE, "Largest minus smallest dynamic transmission error.", move |r| {
            of(r).peak_to_peak
        }),
        column("rms", MICROMETRE, "Root mean square about the mean.", move |r| of(r).rms),
        column("mean", MICROMETRE, "Mean.", move |r| of(r).mean),
        column("largest", MICROMETRE, "Largest value.", move |r| of(r).maximum),
        column("smallest", MICROMETRE, "Smallest value.", move |r| of(r).minimum),
        column("dynamic_factor", PLAIN, "Largest over mean mesh force.", move |r| of(r).dynamic_factor),
        column("fraction_without_contact", PLAIN, "Part of the period without drive contact.", move |r| {
            of(r).separated_fraction
        }),
    ]
}

fn sweep(all: &[SweepResult]) -> FilledTable<'_> {
    type Row<'a> = (&'a SweepResult, &'a lpm::SweepPoint);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, _): &Row<'_>| one.state.as_str()),
        column(
            "direction",
            PLAIN,
            "Direction of the sweep: `up` or `down`.",
            |(one, _): &Row<'_>| {
                if one.up { "up" } else { "down" }
            },
        ),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(_, p): &Row<'_>| p.mesh_frequency),
    ];
    let motion = column("motion", PLAIN, "Period of the motion in periods of the excitation.", |(_, p): &Row<'_>| {
        p.multiple.map_or("not periodic".to_owned(), |n| format!("period {n}"))
    });
    let rows = all.iter().flat_map(|one| one.points.iter().map(move |p| (one, p)));
    Table::new("sweep", "Motion at the speeds of every sweep.", columns)
        .and(measure(|(_, p): &Row<'_>| &p.measure))
        .and(vec![motion])
        .with(rows)
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

fn branch(all: &[BranchResult]) -> FilledTable<'_> {
    type Row<'a> = (&'a BranchResult, &'a BranchPoint, bool);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, ..): &Row<'_>| one.state.as_str()),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(_, p, _): &Row<'_>| p.mesh_frequency),
    ];
    let behind = vec![
        column("stability", PLAIN, "Stability of the periodic solution.", |(_, p, _): &Row<'_>| stability(p.stability)),
        column("largest_multiplier", PLAIN, "Modulus of the largest Floquet multiplier.", |(_, p, _): &Row<'_>| {
            p.multipliers.first().map_or(0.0, lpm::Multiplier::modulus)
        }),
        column("turning_point", PLAIN, "Whether the branch turns here.", |(_, _, turns): &Row<'_>| *turns),
    ];
    let rows = all.iter().flat_map(|one| {
        let turning: Vec<*const BranchPoint> =
            one.branch.turning_points.iter().map(|t| std::ptr::from_ref(&t.point)).collect();
        one.branch.curve().into_iter().map(move |p| (one, p, turning.contains(&std::ptr::from_ref(p))))
    });
    Table::new("branch", "Points and turning points in order along the branch of periodic solutions.", columns)
        .and(measure(|(_, p, _): &Row<'_>| &p.measure))
        .and(behind)
        .with(rows)
}

fn impulse(all: &[ImpulseResult]) -> FilledTable<'_> {
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |one: &&ImpulseResult| one.state.as_str()),
        column("mesh_cycle", PLAIN, "Position at which the gears stand.", |one: &&ImpulseResult| one.mesh_cycle),
        column("natural_frequency", HERTZ, "Undamped natural frequency.", |one: &&ImpulseResult| {
            one.test.as_ref().map(|t| t.natural_frequency)
        }),
        column("damped_frequency", HERTZ, "Frequency of the decay.", |one: &&ImpulseResult| {
            one.test.as_ref().map(|t| t.damped_frequency)
        }),
        column("damping_ratio", PLAIN, "Damping ratio.", |one: &&ImpulseResult| {
            one.test.as_ref().map(|t| t.damping_ratio)
        }),
        column("contact_lost", PLAIN, "Whether contact was lost.", |one: &&ImpulseResult| {
            one.test.as_ref().map(|t| !t.response.separations.is_empty())
        }),
    ];
    Table::new("impulse", "Reading of every impulse test; empty where nothing oscillates.", columns).with(all.iter())
}

fn impulse_response(all: &[ImpulseResult]) -> FilledTable<'_> {
    type Row<'a> = (&'a ImpulseResult, &'a lpm::Response, usize);
    let columns = vec![
        column("state", PLAIN, "State of the pair.", |(one, ..): &Row<'_>| one.state.as_str()),
        column("mesh_cycle", PLAIN, "Position at which the gears stand.", |(one, ..): &Row<'_>| one.mesh_cycle),
        column("time", SECOND, "Time from the impulse.", |(_, r, i): &Row<'_>| r.mesh_cycle[*i] / r.mesh_frequency),
        column("dte", MICROMETRE, "Dynamic transmission error.", |(_, r, i): &Row<'_>| r.transmission_error[*i]),
        column("mesh_force", NEWTON, "Force of the mesh.", |(_, r, i): &Row<'_>| r.mesh_force[*i]),
    ];
    let rows = all.iter().flat_map(|one| {
        let responses = one.test.iter().map(|t| &t.response);
        responses.flat_map(move |r| (0..r.mesh_cycle.len()).map(move |i| (one, r, i)))
    });
    Table::new("impulse_response", "Decay of every impulse test.", columns).with(rows)
}

fn damage_response(all: &[DamageResult]) -> FilledTable<'_> {
    type Row<'a> = (&'a DamageResult, usize);
    let columns = vec![
        column("state", PLAIN, "Damaged state.", |(one, _): &Row<'_>| one.state.as_str()),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(one, _): &Row<'_>| one.mesh_frequency),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", |(one, i): &Row<'_>| {
            one.response.damaged.response.mesh_cycle[*i]
        }),
        column("dte_healthy", MICROMETRE, "Dynamic transmission error, healthy.", |(one, i): &Row<'_>| {
            one.response.healthy.response.transmission_error[*i]
        }),
        column("dte_damaged", MICROMETRE, "Dynamic transmission error, damaged.", |(one, i): &Row<'_>| {
            one.response.damaged.response.transmission_error[*i]
        }),
        column("difference", MICROMETRE, "Damaged less healthy.", |(one, i): &Row<'_>| one.response.difference[*i]),
        column("static_difference", MICROMETRE, "The same at vanishing speed.", |(one, i): &Row<'_>| {
            one.response.static_difference[*i]
        }),
    ];
    let rows = all.iter().flat_map(|one| (0..one.response.difference.len()).map(move |i| (one, i)));
    Table::new("damage_response", "Healthy, damaged, and their difference.", columns).with(rows)
}

fn damage_spectrum(all: &[DamageResult]) -> FilledTable<'_> {
    type Row<'a> = (&'a DamageResult, usize);
    let columns = vec![
        column("state", PLAIN, "Damaged state.", |(one, _): &Row<'_>| one.state.as_str()),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(one, _): &Row<'_>| one.mesh_frequency),
        column("frequency", HERTZ, "Frequency of the line.", |(one, i): &Row<'_>| one.response.spectrum.frequency[*i]),
        column("amplitude", MICROMETRE, "Amplitude of the difference.", |(one, i): &Row<'_>| {
            one.response.spectrum.amplitude[*i]
        }),
    ];
    let rows = all.iter().flat_map(|one| (0..one.response.spectrum.frequency.len()).map(move |i| (one, i)));
    Table::new("damage_spectrum", "Spectrum of the damage-induced response.", columns).with(rows)
}

fn damage_speeds(all: &[DamageSpeeds]) -> FilledTable<'_> {
    type Row<'a> = (&'a DamageSpeeds, &'a [f64; 4]);
    let columns = vec![
        column("state", PLAIN, "Damaged state.", |(one, _): &Row<'_>| one.state.as_str()),
        column("mesh_frequency", HERTZ, "Mesh frequency.", |(_, row): &Row<'_>| row[0]),
        column("frequency_of_largest_line", HERTZ, "Frequency of the largest line.", |(_, row): &Row<'_>| row[1]),
        column("largest_amplitude", MICROMETRE, "Its amplitude.", |(_, row): &Row<'_>| row[2]),
        column("peak_to_peak", MICROMETRE, "Largest minus smallest difference.", |(_, row): &Row<'_>| row[3]),
        column(
            "static_amplitude",
            MICROMETRE,
            "Largest amplitude of the difference at vanishing speed.",
            |(one, _): &Row<'_>| one.static_amplitude,
        ),
    ];
    let rows = all.iter().flat_map(|one| one.rows.iter().map(move |row| (one, row)));
    Table::new("damage_over_speed", "The largest line of the damage-induced spectrum at every speed.", columns)
        .with(rows)
}
