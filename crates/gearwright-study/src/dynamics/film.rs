//! Contact pressure over a stretch of the record as a film for ParaView: frames as `.vtu`, and a `.pvd` that names them by mesh cycle.
//!
//! The stretch is run again from the state kept at its first frame, so that pressures need not be held.

use std::fmt::Write as _;
use std::path::PathBuf;

use fecm::dynamics::{InitialState, PairDynamics};
use fecm::statics::PairModel;

use gearwright_results::dynamics::Response;

use super::{Computed, FilmStart};
use crate::grids;
use gearwright_case::DynamicsCase;

/// Steps run between writings.
const PIECE: usize = 50;

/// Writes the films of all states at a speed; `file` places their files.
///
/// # Errors
/// Those of the engine and of the file system.
pub fn write(
    case: &DynamicsCase,
    computed: &Computed,
    speed: usize,
    file: &dyn Fn(&str) -> PathBuf,
) -> anyhow::Result<()> {
    let (responses, starts) = (&computed.results.speeds[speed].responses, &computed.films[speed]);
    for ((state, response), start) in computed.states.iter().zip(responses).zip(starts) {
        of_state(case, &state.model, response, start, file)?;
    }
    Ok(())
}

fn of_state(
    case: &DynamicsCase,
    model: &PairModel,
    response: &Response,
    FilmStart { plan, state }: &FilmStart,
    file: &dyn Fn(&str) -> PathBuf,
) -> anyhow::Result<()> {
    let (Some(film), Some(start), Some(offset)) = (case.inputs.output.film, state, plan.film) else {
        return Ok(());
    };
    let length = ((film.mesh_cycle_to - film.mesh_cycle_from) * plan.cycle as f64).round() as usize + 1;
    let length = length.min(response.samples.len() - offset);
    let first = start.0.step + 1;
    let frames: Vec<i64> = (0..length as i64).step_by(film.every_steps as usize).map(|k| first + k).collect();
    let last = frames.last().map_or(0, |last| (last - start.0.step) as usize);
    let dynamics = PairDynamics::new(model, &case.options)?;
    let request = plan.request(case, InitialState::Given(start.0.clone()), frames);
    let mut runner = dynamics.start(&request)?;
    let suffix = response.suffix();
    std::fs::create_dir_all(file("film"))?;
    let mut sets = String::new();
    let mut done = 0;
    while done < last {
        let piece = PIECE.min(last - done);
        for snapshot in runner.advance(piece, &())?.snapshots {
            let sample = offset + (snapshot.step - first) as usize;
            let name = format!("film/frame{suffix}_{sample:06}.vtu");
            grids::pressure(model, snapshot.mesh_cycle, &snapshot.patches).write(&file(&name))?;
            let cycle = response.mesh_cycle.get(sample).copied().unwrap_or_default();
            let _ = writeln!(sets, "<DataSet timestep=\"{cycle}\" file=\"{name}\"/>");
        }
        done += piece;
    }
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n{sets}\
         </Collection>\n</VTKFile>\n"
    );
    std::fs::write(file(&format!("film{suffix}.pvd")), text)?;
    Ok(())
}
