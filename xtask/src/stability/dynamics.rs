//! Motion in time: steps, speeds, supports, loss of contact, wrong starts, long runs without damping.

use std::f64::consts::PI;

use fecm::FaceModel;
use fecm::dynamics::{
    Damping, DynamicsOptions, DynamicsRequest, DynamicsRun, DynamicsState, InitialState, Integrator, PairDynamics,
    RotorInertia, RotorOptions, StepSolver, Support,
};
use fecm::statics::PairModel;

use super::pairs::USUAL;
use super::statics::model;
use super::{Answer, Table};

const TORQUE: f64 = 200.0;
const UNDAMPED: Damping = Damping { mass_proportional: 0.0, stiffness_proportional: 0.0, modal_ratio: 0.0 };
const DAMPED: Damping = Damping { mass_proportional: 1500.0, ..UNDAMPED };
const RIGID: usize = 0;
/// Inertia that rigid bodies are given.
const INERTIA: RotorInertia = RotorInertia { mass: 2.0, polar: 0.006, transverse: 0.004 };

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "fecm: motion in time",
        "25 and 31 teeth of module 6 mm, plane stress, 200 N m, the pinion's rotation prescribed, rigid bodies and damping of 1500 1/s unless named. Violation \
         and complementarity of the contact forces: worst step. Energy: what bodies hold against the work done on them, over the largest seen; with average acceleration \
         it closes to rounding.",
        &[("violation", 1e-9), ("complementarity", 1e-9), ("energy", 1e-6)],
    );
    let pair_model = match USUAL.pair().map_err(Into::into).and_then(|pair| model(&pair, FaceModel::PlaneStress)) {
        Ok(model) => model,
        Err(error) => {
            table.answered("the pair at rest", || Err(error));
            return table;
        }
    };
    running_cases(&mut table, &pair_model);
    state_cases(&mut table, &pair_model);
    refusals(&mut table, &pair_model);
    table
}

fn running_cases(table: &mut Table, model: &PairModel) {
    for (rpm, steps) in
        [(1.0, 10), (1.0, 1000), (3000.0, 4), (3000.0, 10), (3000.0, 1000), (60_000.0, 10), (60_000.0, 1000)]
    {
        table.answered(format!("{rpm} rpm, {steps} steps per mesh cycle"), || {
            run(model, &options(DAMPED, RIGID), &running(rpm, steps), 3 * steps)
        });
    }
    for stiffness in [1e8, 1e9, 1e12, 1e15] {
        table.answered(format!("bearings of {stiffness:.0e} N/m, 4000 rpm, 10 mesh cycles"), || {
            run(model, &on_bearings(stiffness), &running(4000.0, 50), 500)
        });
    }
    table.refused("bearings of 1e6 N/m: the gears leave each other", || {
        run(model, &on_bearings(1e6), &running(4000.0, 50), 500)
    });
    table.answered("undamped, 3000 rpm, 1000 mesh cycles", || {
        run(model, &options(UNDAMPED, RIGID), &running(3000.0, 50), 50_000)
    });
    table.answered("undamped, 6000 rpm: contact lost and found, 100 mesh cycles", || {
        run(model, &options(UNDAMPED, RIGID), &running(6000.0, 50), 5000)
    });
    for modes in [1, 40] {
        table.answered(format!("{modes} elastic modes of each gear, 4000 rpm, 10 mesh cycles"), || {
            run(model, &elastic(model, modes), &running(4000.0, 50), 500)
        });
    }
    table.refused("hub and elastic gear lighter than the gear's mesh", || {
        let mut options = elastic(model, 40);
        options.rotors[1].inertia.polar *= 0.1;
        run(model, &options, &running(4000.0, 50), 10)
    });
    table.answered("monolithic contact problem (Lemke), 5000 rpm, 4 mesh cycles", || {
        let options = DynamicsOptions { solver: StepSolver::Lemke, ..options(DAMPED, RIGID) };
        run(model, &options, &running(5000.0, 50), 200)
    });
    table.answered("torque 1e-6 N m, 1000 rpm, 4 mesh cycles", || {
        run(model, &options(DAMPED, RIGID), &DynamicsRequest { torque: 1e-6, ..running(1000.0, 50) }, 200)
    });
}

fn state_cases(table: &mut Table, model: &PairModel) {
    table.answered("started unloaded, 3000 rpm, 20 mesh cycles", || {
        let request = DynamicsRequest { initial: InitialState::Unloaded, ..running(3000.0, 50) };
        run(model, &options(DAMPED, RIGID), &request, 1000)
    });
    // the acceleration given is not that of the forces, so the first step's work is not its energy
    table.answered("started from a wrong state, 3000 rpm, 20 mesh cycles: settles, energy not counted", || {
        let state = DynamicsState {
            step: 0,
            position: vec![-2e-4],
            velocity: vec![0.3],
            acceleration: vec![-50.0],
            contact: vec![10.0],
        };
        let request = DynamicsRequest { initial: InitialState::Given(state), ..running(3000.0, 50) };
        let settled = run(model, &options(DAMPED, RIGID), &request, 1000)?;
        Ok(Answer { residuals: settled.residuals.iter().take(2).copied().collect(), ..settled })
    });
    table.answered("thrown across the backlash: blow on the coast flanks", || {
        let options = options(UNDAMPED, RIGID);
        let mut request = running(100.0, 2000);
        request.torque = 1.0;
        let dynamics = PairDynamics::new(model, &options)?;
        let mut state = dynamics.start(&request)?.state().clone();
        state.velocity[0] = -2.0 * model.pairing().pair().closing_direction();
        request.initial = InitialState::Given(state);
        let run = dynamics.run(&request, 1200, &())?;
        let hit = run.records.iter().any(|r| r.back_force > 0.0);
        Ok(answer(&run).with(hit, "the coast flanks never met"))
    });
}

fn refusals(table: &mut Table, model: &PairModel) {
    let fine = || options(DAMPED, RIGID);
    table.refused("no torque: nothing holds the teeth together", || {
        run(model, &fine(), &DynamicsRequest { torque: 0.0, ..running(1000.0, 50) }, 10)
    });
    table.refused("speed 0", || run(model, &fine(), &running(0.0, 50), 10));
    table.refused("speed NaN", || run(model, &fine(), &running(f64::NAN, 50), 10));
    table.refused("one step per mesh cycle", || run(model, &fine(), &running(1000.0, 1), 10));
    table.refused("torque beyond what teeth bear", || {
        run(model, &fine(), &DynamicsRequest { torque: 1e9, ..running(1000.0, 50) }, 10)
    });
    table.refused("polar inertia 0", || {
        let mut options = fine();
        options.rotors[1].inertia.polar = 0.0;
        run(model, &options, &running(1000.0, 50), 10)
    });
    table.refused("spectral radius 2", || {
        let options = DynamicsOptions { integrator: Integrator::GeneralizedAlpha { spectral_radius: 2.0 }, ..fine() };
        run(model, &options, &running(1000.0, 50), 10)
    });
}

fn on_bearings(stiffness: f64) -> DynamicsOptions {
    let mut options = options(DAMPED, RIGID);
    for rotor in &mut options.rotors {
        rotor.supports[..2].fill(Support::Elastic { stiffness, damping: 800.0 });
    }
    options
}

/// Elastic gears, each with a hub of its own mass besides.
fn elastic(model: &PairModel, modes: usize) -> DynamicsOptions {
    let mut options = options(Damping { modal_ratio: 0.01, ..DAMPED }, modes);
    for (rotor, body) in options.rotors.iter_mut().zip(model.bodies()) {
        let gear = body.inertia();
        rotor.inertia =
            RotorInertia { mass: 2.0 * gear.mass, polar: 2.0 * gear.polar, transverse: 2.0 * gear.transverse };
    }
    options
}

fn options(damping: Damping, modes: usize) -> DynamicsOptions {
    let rotor = |rotation| RotorOptions { modes, ..RotorOptions::on_ideal_bearings(INERTIA, rotation) };
    DynamicsOptions::new([rotor(Support::Fixed), rotor(Support::Free)], damping)
}

fn running(rpm: f64, steps_per_cycle: usize) -> DynamicsRequest {
    DynamicsRequest::running(rpm * PI / 30.0, steps_per_cycle, TORQUE)
}

fn run(
    model: &PairModel,
    options: &DynamicsOptions,
    request: &DynamicsRequest,
    steps: usize,
) -> anyhow::Result<Answer> {
    Ok(answer(&PairDynamics::new(model, options)?.run(request, steps, &())?))
}

fn answer(run: &DynamicsRun) -> Answer {
    let (stats, energy) = (run.stats, run.energy);
    let share = if energy.scale > 0.0 { energy.worst_residual / energy.scale } else { energy.worst_residual };
    let lost = run.contact_loss().len();
    let said = match lost {
        0 => format!("{} steps", stats.steps),
        _ => format!("{} steps, contact lost {lost} times", stats.steps),
    };
    let numbers = run.records.iter().flat_map(|r| {
        let own = [r.transmission_error, r.mesh_force, r.back_force];
        own.into_iter().chain(r.coordinates.iter().copied()).chain(r.support_forces.iter().copied())
    });
    Answer::new(said, vec![Some(stats.worst_kkt), Some(stats.worst_complementarity), Some(share)])
        .with_finite("results", numbers)
        .with(stats.not_converged == 0, format!("{} steps did not converge", stats.not_converged))
}
