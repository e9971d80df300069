//! Work-precision study: error against run time of every integration method offered.
//!
//! Each row runs one method at one tolerance on one problem and compares the sampled transmission error with a
//! reference: the same equations at a far tighter tolerance, by the exponential method for one coordinate, and by the explicit method,
//! which resolves every motion of the supports, for three. Error is the largest difference over the peak-to-peak value.
//!
//! | problem | coordinates | what it shows |
//! |---|---|---|
//! | smooth | 1 | Fourier excitation, contact kept |
//! | contact loss | 1 | the same, set off so that contact is lost and regained |
//! | rectangular wave | 1 | coefficients constant between jumps, contact lost |
//! | supports of 1e8 to 1e14 N/m | 3 | stiff supports; `eliminated` rows hold its model error too |
//!
//! Everything but the run time is the same on every machine. Tests: `tests/precision.rs`.

use crate::curve::Curve;
use crate::error::{LpmError, check};
use crate::excitation::Excitation;
use crate::integrate::{Method, Options};
use crate::model::{GearPair, Input, Model, State, Supports};
use crate::response::{Response, Sampling};
use std::time::Instant;

/// Support stiffnesses of the study (N/m).
pub const SUPPORT_STIFFNESSES: [f64; 4] = [1e8, 1e10, 1e12, 1e14];
/// Mesh frequency of the study (Hz): the dissertation's 4000 rpm.
const FREQUENCY: f64 = 1800.0;
/// Mesh cycles of a run.
const CYCLES: usize = 8;
const SAMPLING: Sampling = Sampling { per_cycle: 50, energy: false };

/// One run of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkPrecision {
    /// Problem, as in the table of the module.
    pub problem: String,
    /// Support stiffness (N/m) where supports are elastic.
    pub support_stiffness: Option<f64>,
    /// Treatment of supports.
    pub supports: Supports,
    /// Method.
    pub method: Method,
    /// Relative tolerance asked for.
    pub tolerance: f64,
    /// Largest error over the peak-to-peak value of the reference.
    pub error: f64,
    /// Shortest time of a run (s), sampling included.
    pub seconds: f64,
    /// Steps, accepted and rejected.
    pub steps: u64,
    /// Contact events.
    pub events: u64,
}

struct Problem {
    name: String,
    stiffness: Option<f64>,
    /// The model the reference and all methods run.
    model: Model,
    /// One-coordinate stand-in.
    eliminated: Option<Model>,
    start: State,
}

fn problems() -> Result<Vec<Problem>, LpmError> {
    let smooth = Excitation::new(
        &Curve::fourier(680e6, &[(-120e6, 30e6), (20e6, 15e6)])?,
        &Curve::fourier(14.5e-6, &[(3e-6, -0.5e-6), (-0.4e-6, 0.0)])?,
    )?;
    let jumps = Excitation::new(
        &Curve::rectangular(533e6, 806e6, 0.2, 0.64)?,
        &Curve::rectangular(11.8e-6, 18.3e-6, 0.84, 0.36)?,
    )?;
    let pair = GearPair { mesh_damping: 3434.0, ..GearPair::table_3_2(Input::Prescribed) };
    let at = |x: f64| State { position: [x, 0.0, 0.0], ..State::default() };
    let mut all = Vec::new();
    for (name, excitation, x) in
        [("smooth", &smooth, 15e-6), ("contact loss", &smooth, 60e-6), ("rectangular wave", &jumps, 60e-6)]
    {
        all.push(Problem {
            name: name.into(),
            stiffness: None,
            model: Model::new(&pair, excitation, Supports::Rigid)?,
            eliminated: None,
            start: at(x),
        });
    }
    for stiffness in SUPPORT_STIFFNESSES {
        let mut pair = pair;
        (pair.pinion.support_stiffness, pair.gear.support_stiffness) = (stiffness, stiffness);
        let model = Model::new(&pair, &smooth, Supports::Integrated)?;
        all.push(Problem {
            name: format!("supports of {stiffness:.0e} N/m"),
            stiffness: Some(stiffness),
            start: model.equilibrium(0.0),
            eliminated: Some(Model::new(&pair, &smooth, Supports::Eliminated)?),
            model,
        });
    }
    Ok(all)
}

fn run(model: &Model, start: &State, method: Method, tolerance: f64) -> Result<Response, LpmError> {
    let options = Options { method: Some(method), ..Options::with_tolerance(tolerance) };
    model.simulate(FREQUENCY, start, CYCLES, &SAMPLING, &options)
}

/// Runs every method at every tolerance (1e-12 to 0.1) on every problem, each run repeated for `seconds` (0: once) to time it.
///
/// Newmark's method at tight tolerances takes very many steps; runs of it below 1e-9 are left out.
///
/// # Errors
/// [`LpmError::OutOfRange`] for a tolerance outside its range; errors of the integration, as [`Model::simulate`].
pub fn work_precision(tolerances: &[f64], seconds: f64) -> Result<Vec<WorkPrecision>, LpmError> {
    check(seconds >= 0.0, "time per run", seconds, "s", "zero or positive")?;
    for &t in tolerances {
        check((1e-12..=0.1).contains(&t), "tolerance", t, "-", "between 1e-12 and 0.1")?;
    }
    let mut rows = Vec::new();
    for p in problems()? {
        let best = if p.model.coordinates() == 1 { Method::Magnus } else { Method::DormandPrince };
        let reference = run(&p.model, &p.start, best, 1e-13)?;
        let mut entries: Vec<(&Model, State, Method)> = Method::ALL
            .into_iter()
            .filter(|m| p.model.coordinates() == 1 || *m != Method::Magnus)
            .map(|m| (&p.model, p.start, m))
            .collect();
        if let Some(m) = &p.eliminated {
            entries.push((m, m.equilibrium(0.0), Method::Magnus));
        }
        for (model, start, method) in entries {
            for &tolerance in tolerances {
                if method == Method::Newmark && tolerance < 1e-9 {
                    continue;
                }
                let clock = Instant::now();
                let (mut shortest, mut outcome) = (f64::INFINITY, None);
                while outcome.is_none() || clock.elapsed().as_secs_f64() < seconds {
                    let own = Instant::now();
                    let r = run(model, &start, method, tolerance)?;
                    shortest = own.elapsed().as_secs_f64().min(shortest);
                    outcome = Some(r);
                }
                let Some(r) = outcome else { continue };
                rows.push(WorkPrecision {
                    problem: p.name.clone(),
                    support_stiffness: p.stiffness,
                    supports: model.supports(),
                    method,
                    tolerance,
                    error: difference(&r, &reference),
                    seconds: shortest,
                    steps: r.stats.steps + r.stats.rejected,
                    events: r.stats.events,
                });
            }
        }
    }
    Ok(rows)
}

fn difference(a: &Response, b: &Response) -> f64 {
    let largest =
        a.transmission_error.iter().zip(&b.transmission_error).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    largest / b.peak_to_peak()
}
