//! Tables of statics.

use std::collections::BTreeSet;

use fecm::statics::{CrackTip, PairState, PositionResult};

use super::Statics;
use super::damage::{self, Effect};
use super::stress::{GEARS, Stresses};
use crate::table::{
    Column, FilledTable, MEGAPASCAL, MICROMETRE, MILLIMETRE, NEWTON, NEWTON_METRE, NEWTON_PER_MICROMETRE, PLAIN,
    STRESS_INTENSITY, Table, TableInfo, column, each,
};

/// All tables of a case; `origin` is added to mesh cycles.
#[must_use]
pub fn tables<'a>(results: &'a Statics, effects: &'a [Effect], origin: f64) -> Vec<FilledTable<'a>> {
    let mut all = vec![series(results.positions(), &results.stresses, origin)];
    all.extend(results.map.as_ref().map(|map| force_deflection(&map.results, origin)));
    if !effects.is_empty() {
        all.push(damage::table(effects));
    }
    for (index, damaged) in results.damaged.iter().enumerate() {
        let number = index + 1;
        let (positions, stresses) = (damaged.positions(), &damaged.stresses);
        all.push(series(positions, stresses, origin).named("", &format!("_damage_{number}")));
        if !stresses.tips.is_empty() {
            all.push(crack_front(positions, stresses, origin).named("", &format!("_{number}")));
        }
    }
    all
}

/// What the tables hold.
#[must_use]
pub fn schemas() -> Vec<TableInfo> {
    let none = Stresses::default();
    let all = [series(&[], &none, 0.0), force_deflection(&[], 0.0), damage::table(&[]), crack_front(&[], &none, 0.0)];
    all.iter().map(|table| table.schema().clone()).collect()
}

/// A position and its number.
type Row<'a> = (usize, &'a PositionResult);

fn series<'a>(results: &'a [PositionResult], stresses: &'a Stresses, origin: f64) -> FilledTable<'a> {
    let pairs: BTreeSet<i32> = results.iter().flat_map(|r| r.pairs.iter().map(|p| p.pair)).collect();
    let pairs: Vec<i32> = pairs.into_iter().collect();
    let names: Vec<String> = pairs.iter().map(i32::to_string).collect();
    let columns = vec![
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", move |(_, r): &Row<'_>| r.mesh_cycle + origin),
        column("torque", NEWTON_METRE, "Torque on the gear.", |(_, r): &Row<'_>| r.torque),
        column("ste", MICROMETRE, "Static transmission error.", |(_, r): &Row<'_>| r.static_transmission_error),
        column("no_load_te", MICROMETRE, "Transmission error without load.", |(_, r): &Row<'_>| {
            r.no_load_transmission_error
        }),
        column("mesh_force", NEWTON, "Force along the line of action.", |(_, r): &Row<'_>| r.mesh_force),
        column(
            "mesh_stiffness_average",
            NEWTON_PER_MICROMETRE,
            "Force over deflection from no load.",
            |(_, r): &Row<'_>| r.stiffness_average_slope,
        ),
        column("mesh_stiffness_local", NEWTON_PER_MICROMETRE, "Slope of force over deflection.", |(_, r): &Row<'_>| {
            r.local_stiffness()
        }),
        column(
            "mesh_stiffness_tangent",
            NEWTON_PER_MICROMETRE,
            "The same from the cells in contact, without differences.",
            |(_, r): &Row<'_>| r.stiffness_local_slope,
        ),
        column("pairs_in_contact", PLAIN, "Loaded tooth pairs.", |(_, r): &Row<'_>| r.loaded_pairs().count()),
        column("peak_pressure", MEGAPASCAL, "Largest contact pressure.", |(_, r): &Row<'_>| r.peak_pressure()),
    ];
    let status = vec![
        column("status", PLAIN, "How the position ended.", |(_, r): &Row<'_>| r.status.name()),
        column("torque_residual", PLAIN, "Residual of the torque, relative.", |(_, r): &Row<'_>| {
            r.stats.torque_residual
        }),
        column("kkt_violation", PLAIN, "Violation of the contact conditions, relative.", |(_, r): &Row<'_>| {
            r.stats.solver.kkt_violation
        }),
        column("cells", PLAIN, "Contact cells.", |(_, r): &Row<'_>| r.stats.cells),
        column("pivots", PLAIN, "Cells that entered or left the contact.", |(_, r): &Row<'_>| r.stats.solver.pivots),
    ];
    let mut table =
        Table::new("series", "One row per position; in `series_damage_N` with the Nth severity of damage.", columns)
            .and_each(names.clone(), of_pairs(&pairs));
    for (names, columns) in stress_columns(stresses, &pairs, names) {
        table = table.and_each(names, columns);
    }
    table.and(status).with(results.iter().enumerate())
}

/// Columns of tooth pairs; 0 where they do not touch.
fn of_pairs<'a>(pairs: &[i32]) -> Vec<Column<'a, Row<'a>>> {
    let of = |value: fn(&PairState) -> f64| {
        let pairs = pairs.to_vec();
        move |(_, r): &Row<'a>, key: usize| r.pairs.iter().find(|p| p.pair == pairs[key]).map_or(0.0, value)
    };
    vec![
        each("pair_<pair>_force", NEWTON, "Force on the tooth pair.", of(|p| p.force)),
        each("pair_<pair>_share", PLAIN, "Its share of the load.", of(|p| p.share)),
        each("pair_<pair>_stiffness", NEWTON_PER_MICROMETRE, "Its stiffness.", of(|p| p.stiffness)),
        each(
            "pair_<pair>_contact_width",
            MILLIMETRE,
            "Width of its contact along the profile.",
            of(|p| p.contact_width),
        ),
        each("pair_<pair>_peak_pressure", MEGAPASCAL, "Its largest contact pressure.", of(|p| p.peak_pressure)),
    ]
}

/// Names of keys and the columns that stand for each.
type Family<'a> = (Vec<String>, Vec<Column<'a, Row<'a>>>);

/// Columns of what is read from the stresses: root stresses 0 without load; the factors where `K_I` is largest along the front.
fn stress_columns<'a>(stresses: &'a Stresses, pairs: &[i32], names: Vec<String>) -> Vec<Family<'a>> {
    let root = |member: usize, side: usize| {
        let pairs = pairs.to_vec();
        move |(position, _): &Row<'a>, key: usize| {
            let roots = stresses.roots.get(*position).into_iter().flatten();
            let mut own = roots.filter(|root| root.member == member && root.pair == pairs[key]);
            own.next().map_or(0.0, |root| [root.tension.stress, root.compression.stress][side])
        }
    };
    let roots = vec![
        each(
            "pair_<pair>_pinion_root_tension",
            MEGAPASCAL,
            "Largest tension at the root of the pinion's tooth.",
            root(0, 0),
        ),
        each("pair_<pair>_pinion_root_compression", MEGAPASCAL, "Largest compression there.", root(0, 1)),
        each(
            "pair_<pair>_gear_root_tension",
            MEGAPASCAL,
            "Largest tension at the root of the gear's tooth.",
            root(1, 0),
        ),
        each("pair_<pair>_gear_root_compression", MEGAPASCAL, "Largest compression there.", root(1, 1)),
    ];
    let factor = |value: fn(&CrackTip) -> f64| {
        let cracked: Vec<(usize, i32)> = stresses.cracked().into_iter().collect();
        move |(position, _): &Row<'a>, key: usize| {
            let front = stresses.tips.get(*position).into_iter().flatten();
            let own = front.filter(|tip| (tip.member, tip.tooth) == cracked[key]);
            own.max_by(|a, b| a.k_one.total_cmp(&b.k_one)).map_or(0.0, value)
        }
    };
    let factors = vec![
        each(
            "<tooth>_k_one",
            STRESS_INTENSITY,
            "Stress-intensity factor K_I, the largest along the front.",
            factor(|tip| tip.k_one),
        ),
        each("<tooth>_k_two", STRESS_INTENSITY, "Stress-intensity factor K_II there.", factor(|tip| tip.k_two)),
    ];
    let closing: Vec<(usize, i32)> = stresses.closing().into_iter().collect();
    let of_closing = closing.clone();
    let faces = vec![each(
        "<tooth>_crack_face_force",
        NEWTON,
        "Force between the faces of its crack.",
        move |(position, _): &Row<'a>, key: usize| {
            let all = stresses.faces.get(*position).into_iter().flatten();
            all.filter(|face| (face.0, face.1) == of_closing[key]).map(|face| face.2).sum::<f64>()
        },
    )];
    let tooth = |&(member, tooth): &(usize, i32)| format!("{}_tooth_{tooth}", GEARS[member]);
    vec![
        (if stresses.roots.is_empty() { Vec::new() } else { names }, roots),
        (stresses.cracked().iter().map(tooth).collect(), factors),
        (closing.iter().map(tooth).collect(), faces),
    ]
}

fn force_deflection(results: &[Vec<PositionResult>], origin: f64) -> FilledTable<'_> {
    let columns = vec![
        column("torque", NEWTON_METRE, "Torque on the gear.", |r: &&PositionResult| r.torque),
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", move |r: &&PositionResult| r.mesh_cycle + origin),
        column("mesh_force", NEWTON, "Force along the line of action.", |r: &&PositionResult| r.mesh_force),
        column("ste", MICROMETRE, "Static transmission error.", |r: &&PositionResult| r.static_transmission_error),
        column("no_load_te", MICROMETRE, "Transmission error without load.", |r: &&PositionResult| {
            r.no_load_transmission_error
        }),
        column(
            "mesh_stiffness_average",
            NEWTON_PER_MICROMETRE,
            "Force over deflection from no load.",
            |r: &&PositionResult| r.stiffness_average_slope,
        ),
        column(
            "mesh_stiffness_local",
            NEWTON_PER_MICROMETRE,
            "Slope of force over deflection.",
            |r: &&PositionResult| r.local_stiffness(),
        ),
        column("pairs_in_contact", PLAIN, "Loaded tooth pairs.", |r: &&PositionResult| r.loaded_pairs().count()),
        column("status", PLAIN, "How the position ended.", |r: &&PositionResult| r.status.name()),
    ];
    Table::new("force_deflection", "One row per torque and position.", columns).with(results.iter().flatten())
}

fn crack_front<'a>(series: &'a [PositionResult], stresses: &'a Stresses, origin: f64) -> FilledTable<'a> {
    type Row<'a> = (&'a PositionResult, &'a CrackTip);
    let columns = vec![
        column("mesh_cycle", PLAIN, "Rotation in base pitches.", move |(r, _): &Row<'_>| r.mesh_cycle + origin),
        column("on", PLAIN, "Gear with the crack.", |(_, tip): &Row<'_>| GEARS[tip.member]),
        column("tooth", PLAIN, "Number of its tooth.", |(_, tip): &Row<'_>| tip.tooth),
        column("face", MILLIMETRE, "Place along the face, from its middle.", |(_, tip): &Row<'_>| tip.face),
        column("k_one", STRESS_INTENSITY, "Stress-intensity factor K_I.", |(_, tip): &Row<'_>| tip.k_one),
        column("k_two", STRESS_INTENSITY, "Stress-intensity factor K_II.", |(_, tip): &Row<'_>| tip.k_two),
    ];
    let rows = series.iter().zip(&stresses.tips).flat_map(|(r, tips)| tips.iter().map(move |tip| (r, tip)));
    Table::new(
        "crack_front",
        "Factors along all fronts at all positions, `crack_front_N` for the Nth severity.",
        columns,
    )
    .with(rows)
}
