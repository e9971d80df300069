//! Healthy pairs at rest: extreme geometry and load.

use fecm::statics::{PairModel, PairModelOptions, PositionResult, PositionStatus, StaticsRequest};
use fecm::{BoreCondition, FaceModel, SolverKind};
use gear_geom::GearPair;

use super::pairs::{Proportions, USUAL};
use super::{Answer, Table};

/// What every static answer states.
pub const RESIDUALS: &[(&str, f64)] = &[("equilibrium", 1e-9), ("violation", 1e-9), ("complementarity", 1e-9)];
const SOLID: FaceModel = FaceModel::Solid { order: 4 };

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "fecm: healthy pairs at rest",
        "25 and 31 teeth of module 6 mm but for what is named, 3-D unless named, five positions of the mesh cycle, teeth loaded with 100 N per mm of face \
         and mm of module. Equilibrium: moments of the contact forces against the torque; violation: of forces and gaps that must not be negative; \
         complementarity: force times gap; each relative, worst position.",
        RESIDUALS,
    );
    for width in [1e-3, 4e-3, 200e-3, 500e-3] {
        add(&mut table, format!("facewidth {} mm", width * 1e3), Proportions { facewidth: width, ..USUAL }, 1.0, SOLID);
    }
    for module in [0.2e-3, 1e-3, 30e-3] {
        let proportions = Proportions { module, facewidth: 3.0 * module, ..USUAL };
        add(&mut table, format!("module {} mm", module * 1e3), proportions, 1.0, SOLID);
    }
    for teeth in [[12, 12], [12, 240], [20, 400], [400, 20], [200, 400]] {
        // fewer than 17 teeth are undercut unless the pressure angle is larger
        let proportions = Proportions { teeth, pressure_angle: 25.0, ..USUAL };
        add(&mut table, format!("{} and {} teeth, 25 deg", teeth[0], teeth[1]), proportions, 1.0, SOLID);
    }
    for torque in [0.0, 1e-6, 1e-3, 10.0] {
        for (name, face) in [("3-D", SOLID), ("plane strain", FaceModel::PlaneStrain)] {
            add(&mut table, format!("torque {torque} x nominal, {name}"), USUAL, torque, face);
        }
    }
    for torque in [1e3, 1e6] {
        table.answered(format!("torque {torque:.0e} x nominal: beyond small strain"), || {
            let pair = USUAL.pair()?;
            let model = model(&pair, FaceModel::PlaneStrain)?;
            let results = solve(&model, torque * USUAL.nominal_torque(&pair))?;
            let all = results.iter().all(|at| at.status == PositionStatus::Overloaded);
            // not a solution, and said so: no residuals
            Ok(finite(Answer::new(statuses(&results), vec![]), &results).with(all, "not told as overloaded"))
        });
    }
    for bore in [0.80, 0.86, 0.88] {
        add(&mut table, format!("bore of {bore} reference radii"), Proportions { bore, ..USUAL }, 1.0, SOLID);
    }
    add(&mut table, "contact ratio 1.05", Proportions { apart: 0.62, ..USUAL }, 1.0, SOLID);
    add(&mut table, "contact ratio 2.2", Proportions { addendum: 1.25, teeth: [60, 80], ..USUAL }, 1.0, SOLID);
    let high = Proportions { addendum: 1.45, teeth: [90, 140], pressure_angle: 17.0, ..USUAL };
    add(&mut table, "contact ratio 2.9", high, 1.0, SOLID);
    for teeth in [[21, 63], [30, 60], [20, 200]] {
        let proportions = Proportions { teeth, module: 3e-3, facewidth: 20e-3, ..USUAL };
        table.answered(format!("ring, {} and {} teeth", teeth[0], teeth[1]), || {
            let pair = proportions.internal_pair()?;
            let results = solve(&model(&pair, SOLID)?, 0.2 * proportions.nominal_torque(&pair))?;
            Ok(answer(&results, true))
        });
    }
    solvers(&mut table);
    refusals(&mut table);
    table
}

fn add(table: &mut Table, case: impl Into<String>, proportions: Proportions, torque: f64, face: FaceModel) {
    table.answered(case, || {
        let pair = proportions.pair()?;
        let results = solve(&model(&pair, face)?, torque * proportions.nominal_torque(&pair))?;
        Ok(answer(&results, torque > 0.0))
    });
}

/// The contact solvers on one scene.
fn solvers(table: &mut Table) {
    for (name, solver) in [("Lemke", SolverKind::Lemke), ("active set", SolverKind::ActiveSet)] {
        table.answered(format!("solver {name}, plane strain"), || {
            let pair = USUAL.pair()?;
            let mut options = options(FaceModel::PlaneStrain);
            options.contact.solver = solver;
            let results = solve(&PairModel::new(&pair, &options)?, USUAL.nominal_torque(&pair))?;
            Ok(answer(&results, true))
        });
    }
}

fn refusals(table: &mut Table) {
    let with = |change: fn(&mut PairModelOptions), torque: f64| -> anyhow::Result<Answer> {
        let pair = USUAL.pair()?;
        let mut options = options(FaceModel::PlaneStrain);
        change(&mut options);
        Ok(answer(&solve(&PairModel::new(&pair, &options)?, torque)?, true))
    };
    table.refused("torque NaN", || with(|_| {}, f64::NAN));
    table.refused("torque negative", || with(|_| {}, -1.0));
    table.refused("Young's modulus 0", || with(|o| o.pinion.material.young_modulus = 0.0, 1.0));
    table.refused("Poisson's ratio 0.5", || with(|o| o.pinion.material.poisson_ratio = 0.5, 1.0));
    table.refused("no contact cells", || with(|o| o.contact.cells_per_half_width = 0.0, 1.0));
    table.answered("bore loaded without a hub", || with(|o| o.pinion.bore = BoreCondition::Tractions, 100.0));
}

/// Options of all cases: fewer cells along the face than the default.
pub fn options(face: FaceModel) -> PairModelOptions {
    let mut options = PairModelOptions { face, ..PairModelOptions::default() };
    options.contact.face_cells = 12;
    options
}

/// A pair with them.
pub fn model(pair: &GearPair, face: FaceModel) -> anyhow::Result<PairModel> {
    Ok(PairModel::new(pair, &options(face))?)
}

/// Five positions.
pub fn solve(model: &PairModel, torque: f64) -> anyhow::Result<Vec<PositionResult>> {
    let request = StaticsRequest::new([0.0, 0.2, 0.4, 0.6, 0.8], [torque]).keeping_pressure();
    Ok(model.solve(&request, &())?.results.into_iter().flatten().collect())
}

fn statuses(results: &[PositionResult]) -> String {
    let count = |status: PositionStatus| (status.name(), results.iter().filter(|at| at.status == status).count());
    let found = PositionStatus::ALL.map(count).into_iter().filter(|(_, count)| *count > 0);
    found.map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}

fn finite(answer: Answer, results: &[PositionResult]) -> Answer {
    let numbers = results.iter().flat_map(|at| {
        [at.static_transmission_error, at.no_load_transmission_error, at.mesh_force, at.rotation]
            .into_iter()
            .chain([at.stiffness_average_slope, at.stiffness_local_slope].into_iter().flatten())
    });
    let pressures = || results.iter().flat_map(|at| at.patches.iter().flat_map(|p| p.pressure.iter().flatten()));
    let least = pressures().copied().fold(0.0, f64::min);
    answer
        .with_finite("results", numbers)
        .with_finite("pressures", pressures().copied())
        .with(least >= 0.0, format!("a pressure of {least:.1e} Pa"))
}

/// Solutions, with load or without.
pub fn answer(results: &[PositionResult], loaded: bool) -> Answer {
    let worst = |value: fn(&PositionResult) -> f64| {
        results.iter().map(value).fold(0.0_f64, |w, v| if v.is_nan() { v } else { w.max(v) })
    };
    let residuals = vec![
        Some(worst(|at| at.stats.torque_residual)),
        Some(worst(|at| at.stats.solver.kkt_violation)),
        Some(worst(|at| at.stats.solver.complementarity)),
    ];
    let usable = results.iter().all(|at| at.status.is_usable());
    let stiff =
        results.iter().all(|at| at.stiffness_local_slope.is_some_and(|k| k > 0.0) && at.loaded_pairs().count() > 0);
    let deflected = results.iter().all(|at| at.static_transmission_error - at.no_load_transmission_error > -1e-15);
    finite(Answer::new(statuses(results), residuals), results)
        .with(usable, "not solved")
        .with(!loaded || stiff, "no stiffness under load")
        .with(deflected, "load opens the teeth")
}
