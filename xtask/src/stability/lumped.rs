//! Lumped parameters: damping, speed, load, stiff supports, grazing, chatter.

use lpm::{
    Curve, Excitation, GearPair, Input, Method, Model, Options, Response, Sampling, Separation, ShootingOptions, State,
    SteadyOptions, Supports,
};

use super::{Answer, Table};

const SAMPLING: Sampling = Sampling { per_cycle: 100, energy: true };

/// All cases.
pub fn cases() -> Table {
    let mut table = Table::new(
        "lpm",
        "The dissertation's pair (Table 3.2) on a rectangular stiffness of 533 and 806 N/um. Energy: work in less work out and stored, over the turnover.",
        &[("energy", 1e-4)],
    );
    grid(&mut table);
    stiff_supports(&mut table);
    corners(&mut table);
    refusals(&mut table);
    table
}

fn excitation() -> anyhow::Result<Excitation> {
    let stiffness = Curve::rectangular(533e6, 806e6, 0.2, 0.64)?;
    Ok(Excitation::new(&stiffness, &Curve::rectangular(11.8e-6, 18.3e-6, 0.84, 0.36)?)?)
}

/// One row per damping ratio and torque: every input, support and speed within it.
fn grid(table: &mut Table) {
    for ratio in [0.0, 0.05, 1.0] {
        for torque in [0.0, 1e-9, 424.0] {
            let case = format!(
                "damping ratio {ratio}, torque {torque} N m: both inputs, rigid and eliminated supports, 1 Hz to 50 kHz mesh frequency"
            );
            table.answered(case, || {
                let mut all = Vec::new();
                for input in [Input::Prescribed, Input::Free] {
                    let mut pair = GearPair::table_3_2(input);
                    pair.mesh_damping = pair.damping_for_ratio(ratio, 806e6);
                    (pair.pinion.torque, pair.gear.torque) = (torque * 35.2 / 45.63, torque);
                    for supports in [Supports::Rigid, Supports::Eliminated] {
                        let model = Model::new(&pair, &excitation()?, supports)?;
                        for frequency in [1.0, 30.0, 1000.0, 2400.0, 50_000.0] {
                            let start = model.equilibrium(0.0);
                            all.push(model.simulate(frequency, &start, 1, &SAMPLING, &Options::default())?);
                        }
                    }
                }
                Ok(answer(&all))
            });
        }
    }
}

fn stiff_supports(table: &mut Table) {
    for stiffness in [1e8, 1e10, 1e12, 1e14] {
        for (name, supports) in [("integrated", Supports::Integrated), ("eliminated", Supports::Eliminated)] {
            table.answered(format!("supports of {stiffness:.0e} N/m, {name}, 1000 and 2400 Hz"), || {
                let mut pair = GearPair::table_3_2(Input::Prescribed);
                pair.pinion.support_stiffness = stiffness;
                pair.gear.support_stiffness = stiffness;
                let model = Model::new(&pair, &excitation()?, supports)?;
                let run = |frequency| {
                    let options = Options::with_tolerance(1e-8);
                    model.simulate(frequency, &model.equilibrium(0.0), 3, &SAMPLING, &options)
                };
                Ok(answer(&[run(1000.0)?, run(2400.0)?]))
            });
        }
    }
}

fn corners(table: &mut Table) {
    for excess in [-1e-8, 0.0, 1e-8, 1e-4] {
        table.answered(format!("amplitude {excess:+.0e} beyond grazing contact"), || Ok(answer(&[grazing(excess)?])));
    }
    for method in Method::ALL {
        table.answered(format!("all methods: {}, 1800 Hz, 5 mesh cycles", method.name()), || {
            let model = Model::new(&GearPair::table_3_2(Input::Prescribed), &excitation()?, Supports::Rigid)?;
            let options = Options { method: Some(method), ..Options::default() };
            Ok(answer(&[model.simulate(1800.0, &model.equilibrium(0.0), 5, &SAMPLING, &options)?]))
        });
    }
    table.answered("rattle across the backlash without load", || {
        let excitation = Excitation::new(&Curve::constant(600e6)?, &Curve::constant(0.0)?)?;
        let mut pair = GearPair::oscillator(2.4, 0.0, 0.0);
        pair.backlash = Some(80e-6);
        let model = Model::new(&pair, &excitation, Supports::Rigid)?;
        let start = State { position: [-40e-6, 0.0, 0.0], velocity: [0.3, 0.0, 0.0] };
        Ok(answer(&[model.simulate(500.0, &start, 5, &SAMPLING, &Options::default())?]))
    });
    table.answered("steady state at resonance, both branches from wrong starts", || {
        let model = Model::new(&GearPair::table_3_2(Input::Prescribed), &excitation()?, Supports::Rigid)?;
        let mut all = Vec::new();
        for start in [0.0, 1e-3, -1e-3] {
            let state = State { position: [start, 0.0, 0.0], ..State::default() };
            let orbit = model.steady_state(2000.0, &state, &SteadyOptions::default())?;
            all.push(model.simulate(2000.0, &orbit.state, 4, &SAMPLING, &Options::default())?);
        }
        Ok(answer(&all))
    });
    // the printed rule of separation with a negative error: the damped bounce has no end of events
    table.refused("chatter: contact by deflection, negative error, strong damping", || {
        let excitation = Excitation::new(&Curve::constant(600e6)?, &Curve::constant(-5e-6)?)?;
        let mut pair = GearPair::oscillator(2.4, 60_000.0, 9292.0);
        pair.separation = Separation::DeflectionVanishes;
        let model = Model::new(&pair, &excitation, Supports::Rigid)?;
        let start = State { position: [2e-6, 0.0, 0.0], ..State::default() };
        Ok(answer(&[model.simulate(100.0, &start, 3, &SAMPLING, &Options::default())?]))
    });
}

/// A linear mesh whose one harmonic of error takes the force to zero, and beyond by a part.
fn grazing(excess: f64) -> anyhow::Result<Response> {
    let (mass, stiffness, damping, force, frequency) = (2.4, 600e6, 3000.0, 9292.0, 2300.0);
    let omega = std::f64::consts::TAU * frequency;
    let (real, imaginary) = (stiffness - mass * omega * omega, damping * omega);
    let square = real * real + imaginary * imaginary;
    let deflection = (stiffness * real / square - 1.0).hypot(stiffness * imaginary / square);
    let amplitude = (1.0 + excess) * force / stiffness / deflection;
    let error = Curve::fourier(20e-6, &[(amplitude, 0.0)])?;
    let excitation = Excitation::new(&Curve::constant(stiffness)?, &error)?;
    let model = Model::new(&GearPair::oscillator(mass, damping, force), &excitation, Supports::Rigid)?;
    // the motion that just touches the boundary, not the one beyond it that waiting would find
    let options = Options::with_tolerance(1e-12);
    let shooting = ShootingOptions { integration: options, tolerance: 1e-11, ..ShootingOptions::default() };
    let orbit = model.shoot(frequency, &model.equilibrium(0.0), &shooting)?;
    Ok(model.simulate(frequency, &orbit.state, 5, &SAMPLING, &options)?)
}

fn refusals(table: &mut Table) {
    let usual = |frequency: f64, change: fn(&mut GearPair)| -> anyhow::Result<Answer> {
        let mut pair = GearPair::table_3_2(Input::Free);
        change(&mut pair);
        let model = Model::new(&pair, &excitation()?, Supports::Rigid)?;
        Ok(answer(&[model.simulate(frequency, &model.equilibrium(0.0), 1, &SAMPLING, &Options::default())?]))
    };
    table.refused("mesh frequency 0", || usual(0.0, |_| {}));
    table.refused("mesh frequency NaN", || usual(f64::NAN, |_| {}));
    table.refused("base radius 0", || usual(1000.0, |p| p.pinion.base_radius = 0.0));
    table.refused("inertia NaN", || usual(1000.0, |p| p.gear.inertia = f64::NAN));
    table.refused("backlash of 10 um under a deflection of 15.5 um", || {
        let excitation = Excitation::new(&Curve::constant(600e6)?, &Curve::constant(0.0)?)?;
        let pair = GearPair { backlash: Some(10e-6), ..GearPair::oscillator(2.4, 0.0, 9292.0) };
        Model::new(&pair, &excitation, Supports::Rigid)?;
        Ok(Answer::new("taken", vec![]))
    });
    table.refused("stiffness 0", || {
        Excitation::new(&Curve::constant(0.0)?, &Curve::constant(0.0)?)?;
        Ok(Answer::new("taken", vec![]))
    });
}

fn answer(all: &[Response]) -> Answer {
    let share = |r: &Response| {
        let energy = r.energy?;
        Some(if energy.turnover > 0.0 { (energy.residual / energy.turnover).abs() } else { energy.residual.abs() })
    };
    let worst = all.iter().filter_map(share).fold(0.0_f64, |w, v| if v.is_nan() { v } else { w.max(v) });
    let events: usize = all.iter().map(|r| r.events.len()).sum();
    let numbers = all.iter().flat_map(|r| {
        [&r.transmission_error, &r.velocity, &r.mesh_deflection, &r.mesh_force, &r.pinion_bearing_force]
            .into_iter()
            .chain([&r.gear_bearing_force])
            .flatten()
            .copied()
            .chain([r.peak_to_peak(), r.rms(), r.dynamic_factor()])
    });
    let runs = if all.len() == 1 { "1 run".into() } else { format!("{} runs", all.len()) };
    Answer::new(format!("{runs}, {events} changes of contact"), vec![Some(worst)]).with_finite("results", numbers)
}
