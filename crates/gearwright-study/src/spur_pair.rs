//! Statics of a spur gear pair.

use std::time::Instant;

use anyhow::{Context, bail};
use fecm::statics::{PairModel, PositionResult, StaticsRequest, StaticsSeries};
use gearwright_case::SpurPairCase;
use gearwright_results::statics::stress::Stresses;
use gearwright_results::statics::summary::Times;
use gearwright_results::statics::{DamagedPair, Statics};

use super::{AsObserver, RunObserver};

/// A case, computed.
pub struct Computed {
    /// What came out.
    pub results: Statics,
    /// The healthy pair.
    pub model: PairModel,
    /// The pair with each severity of damage.
    pub damaged: Vec<PairModel>,
}

/// Computes a spur-pair case.
///
/// # Errors
/// Model errors; cancellation.
pub fn compute(case: &SpurPairCase, observer: &dyn RunObserver) -> anyhow::Result<Computed> {
    let mut times = Times::default();
    observer.stage("condensing both gears");
    let model = PairModel::new(&case.pair, &case.options).context("the gears cannot be modelled")?;
    times.condensation = model.stats().condensation_time.as_secs_f64();

    observer.stage("contact over the mesh cycle");
    let request = StaticsRequest {
        mesh_cycles: case.mesh_cycles.clone(),
        torques: vec![case.inputs.load.torque_n_m],
        stiffness_difference: case.inputs.analysis.stiffness_by_differences,
        keep_pressure: true,
    };
    let healthy = model.solve(&request, &AsObserver(observer)).context("the contact cannot be solved")?;
    times.contact = healthy.time.as_secs_f64();

    let map = if case.map_torques.is_empty() {
        None
    } else {
        observer.stage("force-deflection map");
        let request = StaticsRequest::new(case.mesh_cycles.clone(), case.map_torques.clone());
        let map = model.solve(&request, &AsObserver(observer)).context("the force-deflection map cannot be solved")?;
        times.map = map.time.as_secs_f64();
        Some(map)
    };

    let (mut models, mut damaged): (Vec<PairModel>, Vec<DamagedPair>) = (Vec::new(), Vec::new());
    for severity in &case.severities {
        observer.stage(&severity.label);
        // derived from the severity before: what a first unsymmetric one had to make anew is shared by the rest
        let before = models.last().unwrap_or(&model);
        let damaged_model =
            before.with_damage(&severity.damage).with_context(|| format!("{} cannot be modelled", severity.label))?;
        let series = damaged_model
            .solve_from(&request, (&model, &healthy), &AsObserver(observer))
            .with_context(|| format!("the contact with {} cannot be solved", severity.label))?;
        times.damage += damaged_model.stats().condensation_time.as_secs_f64() + series.time.as_secs_f64();
        let stresses = read(case, &damaged_model, &series, &mut times)?;
        damaged.push(DamagedPair {
            label: severity.label.clone(),
            damage: damaged_model.options().damage.clone(),
            symmetric: damaged_model.stats().symmetric,
            crack_length: longest_crack(&damaged_model),
            series,
            stresses,
        });
        models.push(damaged_model);
    }

    if observer.is_cancelled() {
        bail!("stopped; nothing was written");
    }
    observer.stage("stresses");
    let stresses = read(case, &model, &healthy, &mut times)?;
    let results = Statics { stats: model.stats(), healthy, stresses, map, damaged, times };
    Ok(Computed { results, model, damaged: models })
}

/// Reads the stresses of a series.
fn read(case: &SpurPairCase, model: &PairModel, series: &StaticsSeries, times: &mut Times) -> anyhow::Result<Stresses> {
    let started = Instant::now();
    let series: &[PositionResult] = series.results.first().map_or(&[], Vec::as_slice);
    let stresses = Stresses::of(model, series, case.inputs.output.root_stress).context("stresses cannot be read")?;
    times.stress += started.elapsed().as_secs_f64();
    Ok(stresses)
}

/// Length of the longest crack of a pair (m).
fn longest_crack(model: &PairModel) -> Option<f64> {
    let of_body = |body: &fecm::body::GearBody| -> Option<f64> {
        let cracks = body.damaged_teeth().filter_map(|tooth| Some(body.sector(tooth).shape.crack.as_ref()?.length));
        cracks.max_by(f64::total_cmp)
    };
    model.bodies().iter().filter_map(|body| of_body(body)).max_by(f64::total_cmp)
}
