//! Error against run time of the numerics on offer, with the defaults marked.

mod damage;
mod dynamics;
mod dynamics_lumped;
mod hums;
mod report;
mod statics;
mod transmission;

use clap::ValueEnum;

/// What to study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// Transmission error and mesh stiffness of the static contact.
    Statics,
    /// Increase of the transmission error by a crack and a pit, stress-intensity factor.
    Damage,
    /// Transmission error in motion, difference signal of a pit.
    Dynamics,
    /// Integration methods of the lumped-parameter dynamics.
    DynamicsLumped,
    /// Interpolation of synchronous averages, windows and segments of spectra.
    Hums,
    /// Time steps, mesh tables and housing of a planetary transmission.
    Transmission,
}

/// Runs a study, or all of them one after the other, and writes their reports.
pub fn run(study: Option<Study>) -> anyhow::Result<()> {
    let Some(study) = study else {
        return Study::value_variants().iter().try_for_each(|&study| run(Some(study)));
    };
    match study {
        Study::Statics => statics::run(),
        Study::Damage => damage::run(),
        Study::Dynamics => dynamics::run(),
        Study::DynamicsLumped => dynamics_lumped::run(),
        Study::Hums => hums::run(),
        Study::Transmission => transmission::run(),
    }
}
