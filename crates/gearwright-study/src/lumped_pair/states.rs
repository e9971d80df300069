//! States of a pair: curves of each, by a static analysis where asked for, and the model they make.

use anyhow::{Context, anyhow, bail};
use fecm::statics::{PairModel, StaticsRequest};
use lpm::{Excitation, GearPair, Model};

use gearwright_results::lumped::{State, Treatment};

use super::supports;
use crate::{AsObserver, RunObserver};
use gearwright_case::lumped_pair::curves::{Curves, Points};
use gearwright_case::lumped_pair::resolve::{DamagedState, Damping, HEALTHY, Source};
use gearwright_case::{LumpedPairCase, SpurPairCase};

/// A state before its model is made.
struct Drawn {
    name: String,
    curves: Curves,
    damaged_cycles: Option<(usize, usize)>,
}

/// All states, the healthy one first, and how their supports are treated.
///
/// # Errors
/// Those of static analyses and models.
pub fn build(case: &LumpedPairCase, observer: &dyn RunObserver) -> anyhow::Result<(Vec<State>, Treatment)> {
    let healthy = healthy(case, observer)?;
    let mut pair: GearPair = case.pair;
    pair.mesh_damping = match case.damping {
        Damping::Absolute(damping) => damping,
        Damping::Ratio(ratio) => pair.damping_for_ratio(ratio, healthy.stiffness.mean()),
    };
    let mut drawn = vec![Drawn { name: HEALTHY.into(), curves: healthy, damaged_cycles: None }];
    for state in &case.damaged {
        for (name, damaged) in damaged(case, state, &drawn[0].curves, observer)? {
            let rotation = case.rotation.ok_or_else(|| anyhow!("damaged states need the number of teeth"))?;
            let first = state.first.unwrap_or_else(|| damaged.first.rem_euclid(rotation as i64) as usize);
            let until = first + damaged.stiffness.period();
            if until > rotation {
                bail!(
                    "state \"{name}\" changes the mesh cycles {first} to {until}, beyond the rotation of {rotation}: \
                     set its mesh_cycle"
                );
            }
            let whole = drawn[0].curves.with_damage(rotation, first, &damaged);
            let curves = whole.with_context(|| format!("the curves of state \"{name}\" do not fit the rotation"))?;
            drawn.push(Drawn { name, curves, damaged_cycles: Some((first, until)) });
        }
    }
    let excitations = drawn.iter().map(|state| {
        let excitation = Excitation::new(&state.curves.stiffness, &state.curves.error);
        excitation.with_context(|| format!("state \"{}\" cannot be modelled", state.name))
    });
    let excitations = excitations.collect::<anyhow::Result<Vec<_>>>()?;
    let treatment = supports::treatment(case, &pair, &excitations)?;
    let state = |(drawn, excitation): (Drawn, &Excitation)| {
        let Drawn { name, curves, damaged_cycles } = drawn;
        let model = Model::new(&pair, excitation, treatment.supports);
        let model = model.with_context(|| format!("state \"{name}\" cannot be modelled"))?;
        Ok(State { name, curves, model, damaged_cycles })
    };
    let states = drawn.into_iter().zip(&excitations).map(state).collect::<anyhow::Result<_>>()?;
    Ok((states, treatment))
}

/// Curves of the healthy pair.
fn healthy(case: &LumpedPairCase, observer: &dyn RunObserver) -> anyhow::Result<Curves> {
    match &case.healthy {
        Source::Known(curves) => Ok((**curves).clone()),
        Source::Weakened { .. } => bail!("the healthy state has no stiffness of its own"),
        Source::SpurPair(statics) => {
            observer.stage("contact statics");
            let model = condensed(statics)?;
            let mut points = solve(&model, statics, observer)?;
            if alike(statics) {
                points.keep_one_cycle();
            }
            curves(points, case, HEALTHY)
        }
    }
}

/// Names and curves of a damaged state: one, or one for each severity of its spur-pair case.
fn damaged(
    case: &LumpedPairCase,
    state: &DamagedState,
    healthy: &Curves,
    observer: &dyn RunObserver,
) -> anyhow::Result<Vec<(String, Curves)>> {
    let name = &state.name;
    match &state.source {
        Source::Known(curves) => Ok(vec![(name.clone(), (**curves).clone())]),
        Source::Weakened { factor, cycles } => Ok(vec![(name.clone(), healthy.weakened(*factor, *cycles)?)]),
        Source::SpurPair(statics) => {
            let mut model = condensed(statics)?;
            if statics.severities.is_empty() {
                observer.stage(&format!("contact statics, {name}"));
                let points = solve(&model, statics, observer)?;
                return Ok(vec![(name.clone(), curves(points, case, name)?)]);
            }
            let mut all = Vec::new();
            for severity in &statics.severities {
                let name = if statics.severities.len() == 1 { name.clone() } else { severity.label.clone() };
                observer.stage(&format!("contact statics, {name}"));
                // derived from the severity before: what they have in common is computed once
                model = model.with_damage(&severity.damage).with_context(|| format!("{name} cannot be modelled"))?;
                let points = solve(&model, statics, observer)?;
                let curves = curves(points, case, &name)?;
                all.push((name, curves));
            }
            Ok(all)
        }
    }
}

/// Whether all teeth of a pair are alike, so that one mesh cycle tells all.
fn alike(statics: &SpurPairCase) -> bool {
    let gears = [&statics.inputs.pinion, &statics.inputs.gear];
    gears.iter().all(|gear| gear.modification.pitch_errors_um.is_empty())
}

fn condensed(statics: &SpurPairCase) -> anyhow::Result<PairModel> {
    PairModel::new(&statics.pair, &statics.options).context("the gears cannot be modelled")
}

fn curves(points: Points, case: &LumpedPairCase, name: &str) -> anyhow::Result<Curves> {
    points
        .curves(case.interpolation)
        .map_err(|message| anyhow!("the static analysis of state \"{name}\" is no periodic curve: {message}"))
}

/// Points of a spur-pair case at its mesh cycles and torque.
fn solve(model: &PairModel, statics: &SpurPairCase, observer: &dyn RunObserver) -> anyhow::Result<Points> {
    let request =
        StaticsRequest::new(statics.mesh_cycles.clone(), [statics.inputs.load.torque_n_m]).with_stiffness_difference();
    let solved = model.solve(&request, &AsObserver(observer)).context("the contact cannot be solved")?;
    let series = solved.results.first().ok_or_else(|| anyhow!("no positions were solved"))?;
    Points::from_statics(series, statics.inputs.analysis.mesh_cycle_origin).map_err(|message| anyhow!(message))
}
