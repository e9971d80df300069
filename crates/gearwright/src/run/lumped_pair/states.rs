//! States of a pair: curves of each, by a static analysis where asked for, and the model they make.

use anyhow::{Context, anyhow, bail};
use fecm::statics::{PairModel, StaticsRequest};
use lpm::{Excitation, GearPair, Model};

use crate::case::lumped_pair::curves::{Curves, Points};
use crate::case::lumped_pair::resolve::{Damping, HEALTHY, Source};
use crate::case::{LumpedPairCase, SpurPairCase};
use crate::run::{AsObserver, RunObserver};

/// A state, ready to run.
#[derive(Debug, Clone)]
pub struct State {
    /// Name.
    pub name: String,
    /// Its curves.
    pub curves: Curves,
    /// Its model.
    pub model: Model,
    /// Mesh cycles that damage changes, from and to; `None` for the healthy state.
    pub damaged_cycles: Option<(usize, usize)>,
}

/// All states, the healthy one first.
///
/// # Errors
/// Those of static analyses and models.
pub fn build(case: &LumpedPairCase, observer: &dyn RunObserver) -> anyhow::Result<Vec<State>> {
    let healthy = found(case, &case.healthy, None, HEALTHY, observer)?;
    let mut pair: GearPair = case.pair;
    pair.mesh_damping = match case.damping {
        Damping::Absolute(damping) => damping,
        Damping::Ratio(ratio) => pair.damping_for_ratio(ratio, healthy.stiffness.mean()),
    };
    let model = |curves: &Curves, name: &str| {
        let excitation = Excitation::new(&curves.stiffness, &curves.error);
        excitation
            .and_then(|e| Model::new(&pair, &e, case.supports))
            .with_context(|| format!("state \"{name}\" cannot be modelled"))
    };
    let mut states =
        vec![State { name: HEALTHY.into(), model: model(&healthy, HEALTHY)?, curves: healthy, damaged_cycles: None }];
    for state in &case.damaged {
        let healthy = &states[0].curves;
        let damaged = found(case, &state.source, Some(healthy), &state.name, observer)?;
        let rotation = case.rotation.ok_or_else(|| anyhow!("damaged states need the number of teeth"))?;
        let first = state.first.unwrap_or_else(|| damaged.first.rem_euclid(rotation as i64) as usize);
        let until = first + damaged.stiffness.period();
        if until > rotation {
            bail!(
                "state \"{}\" changes the mesh cycles {first} to {until}, beyond the rotation of {rotation}: set its mesh_cycle",
                state.name
            );
        }
        let whole = healthy
            .with_damage(rotation, first, &damaged)
            .with_context(|| format!("the curves of state \"{}\" do not fit the rotation", state.name))?;
        states.push(State {
            model: model(&whole, &state.name)?,
            name: state.name.clone(),
            curves: whole,
            damaged_cycles: Some((first, until)),
        });
    }
    Ok(states)
}

fn found(
    case: &LumpedPairCase,
    source: &Source,
    healthy: Option<&Curves>,
    name: &str,
    observer: &dyn RunObserver,
) -> anyhow::Result<Curves> {
    match source {
        Source::Known(curves) => Ok((**curves).clone()),
        Source::Weakened { factor, cycles } => {
            let healthy = healthy.ok_or_else(|| anyhow!("the healthy state has no stiffness of its own"))?;
            Ok(healthy.weakened(*factor, *cycles)?)
        }
        Source::SpurPair(statics) => {
            observer.stage(&format!("contact statics, {name}"));
            let points = solve(statics, observer)?;
            points
                .curves(case.interpolation)
                .map_err(|message| anyhow!("the static analysis of state \"{name}\" is no periodic curve: {message}"))
        }
    }
}

/// Curves of a spur-pair case at its mesh cycles and torque.
fn solve(statics: &SpurPairCase, observer: &dyn RunObserver) -> anyhow::Result<Points> {
    let model = PairModel::new(&statics.pair, &statics.options).context("the gears cannot be modelled")?;
    let request = StaticsRequest {
        mesh_cycles: statics.mesh_cycles.clone(),
        torques: vec![statics.inputs.load.torque_n_m],
        stiffness_difference: false,
        keep_pressure: false,
    };
    let solved = model.solve(&request, &AsObserver(observer)).context("the contact cannot be solved")?;
    let series = solved.results.first().ok_or_else(|| anyhow!("no positions were solved"))?;
    Points::from_statics(series, statics.inputs.analysis.mesh_cycle_origin).map_err(|message| anyhow!(message))
}
