//! All figures and tables of the dissertation that hold computed results, and drawings of the model, in their order.

use super::context::Context;
use super::drawn::Drawn;
use super::figures::{chapter2, chapter3, chapter4, kinematics, lumped, scheme};

/// Why there are no figures of finite-element dynamics.
const FE_DYNAMICS: &str = "needs dynamics of the finite-element/contact model, which this program does not have yet";
/// Why there are no figures of the transmission.
const PLANETARY: &str = "needs the planetary transmission, which this program does not have yet";

/// How a figure is made.
pub enum Work {
    /// By this function.
    Compute(fn(&Context) -> anyhow::Result<Drawn>),
    /// Not at all, for this reason.
    Missing(&'static str),
}

/// A figure or table.
pub struct Figure {
    /// Its number in the dissertation; tables begin with T.
    pub id: &'static str,
    /// Title, in our words.
    pub title: &'static str,
    /// What it shows, in our words.
    pub about: &'static str,
    /// Case files in `configs/` that it is computed from.
    pub cases: &'static [&'static str],
    /// How it is made.
    pub work: Work,
}

const fn computed(
    id: &'static str,
    title: &'static str,
    about: &'static str,
    cases: &'static [&'static str],
    compute: fn(&Context) -> anyhow::Result<Drawn>,
) -> Figure {
    Figure { id, title, about, cases, work: Work::Compute(compute) }
}

const fn missing(id: &'static str, title: &'static str, about: &'static str, reason: &'static str) -> Figure {
    Figure { id, title, about, cases: &[], work: Work::Missing(reason) }
}

/// All of them.
pub const FIGURES: &[Figure] = &[
    computed(
        "2.1",
        "Mesh of the unity pair",
        "Two like gears of 25 teeth, module 6 mm.",
        &["unity-pair.toml"],
        scheme::unity_mesh,
    ),
    computed(
        "2.2",
        "Transmission error of the unity pair",
        "Static transmission error of the healthy pair over the mesh cycle at 200 N m.",
        &["unity-pits-pitch.toml"],
        chapter2::healthy_error,
    ),
    computed(
        "2.3",
        "Load sharing of the unity pair",
        "Force on, and stiffness of, three successive tooth pairs of the healthy pair.",
        &["unity-pits-pitch.toml"],
        chapter2::healthy_sharing,
    ),
    computed(
        "2.4",
        "An elliptical pit",
        "How a pit is placed and measured on a tooth flank.",
        &["unity-pits-pitch.toml"],
        scheme::pit_scheme,
    ),
    computed(
        "2.5",
        "Pits at the pitch point: transmission error",
        "Four pits at the pitch point of the unity pair, and the transmission error with each.",
        &["unity-pits-pitch.toml"],
        chapter2::pitch_errors,
    ),
    computed(
        "2.6",
        "Pits at the pitch point: load sharing",
        "Tooth forces and tooth-pair stiffnesses with pits at the pitch point.",
        &["unity-pits-pitch.toml"],
        chapter2::pitch_sharing,
    ),
    computed(
        "2.7",
        "Pits in the approach: transmission error",
        "The same four sizes of pit, shorter, in the middle of the approach.",
        &["unity-pits-approach.toml"],
        chapter2::approach_errors,
    ),
    computed(
        "2.8",
        "Pits in the approach: load sharing",
        "Tooth forces and tooth-pair stiffnesses with pits in the approach.",
        &["unity-pits-approach.toml"],
        chapter2::approach_sharing,
    ),
    computed(
        "2.9",
        "Pits in the recess: transmission error",
        "The pits of Figure 2.7 in the middle of the recess.",
        &["unity-pits-recess.toml"],
        chapter2::recess_errors,
    ),
    computed(
        "2.10",
        "Pits in the recess: load sharing",
        "Tooth forces and tooth-pair stiffnesses with pits in the recess.",
        &["unity-pits-recess.toml"],
        chapter2::recess_sharing,
    ),
    computed(
        "2.11",
        "Peak-to-peak transmission error over pit area",
        "What a pit adds to the peak-to-peak transmission error, by place and size.",
        &["unity-pits-pitch.toml", "unity-pits-approach.toml", "unity-pits-recess.toml"],
        chapter2::peak_to_peak,
    ),
    computed(
        "T2.1",
        "Pits at the pitch point: increase of the transmission error",
        "Increase of the transmission error at three places of the mesh cycle.",
        &["unity-pits-pitch.toml"],
        chapter2::pitch_table,
    ),
    computed(
        "T2.2",
        "Pits in the approach: increase of the transmission error",
        "Increase of the transmission error at two places of the mesh cycle.",
        &["unity-pits-approach.toml"],
        chapter2::approach_table,
    ),
    computed(
        "T2.3",
        "Pits in the recess: increase of the transmission error",
        "Increase of the transmission error at two places of the mesh cycle.",
        &["unity-pits-recess.toml"],
        chapter2::recess_table,
    ),
    computed(
        "3.1",
        "Model of the nonunity pair and its damage",
        "Mesh of the pair, deformation of a healthy and a cracked tooth, pressure on a healthy and a pitted one.",
        &["nonunity-modified-cracked.toml", "nonunity-modified-pitted.toml"],
        scheme::nonunity_model,
    ),
    computed(
        "T3.1",
        "Geometry of the nonunity pair",
        "The printed parameters, and what follows from them.",
        &["nonunity-pair.toml"],
        chapter3::geometry,
    ),
    computed(
        "3.2",
        "Force-deflection behaviour of the modified pair",
        "Transmission error by load over the mesh cycle: healthy, with a root crack through half the tooth, with a pit; and the stiffnesses by average and local slope.",
        &["nonunity-modified-cracked.toml", "nonunity-modified-pitted.toml", "nonunity-pair.toml"],
        chapter3::force_deflection,
    ),
    computed(
        "3.3",
        "Mesh stiffness of the healthy unity pair",
        "Average-slope stiffness, compared in the dissertation with a published curve.",
        &["unity-pits-pitch.toml"],
        chapter3::unity_stiffness,
    ),
    computed(
        "3.4",
        "An irregular pit on the unity pair",
        "Average-slope stiffness with a pit of irregular outline, replaced by five ellipses.",
        &["unity-pit-irregular.toml"],
        chapter3::irregular_pit,
    ),
    computed(
        "3.5",
        "Pits of the parametric studies",
        "Places and sizes of the pits of Figures 3.6 to 3.8 on the pinion of the nonunity pair.",
        &["pitted-approach.toml", "pitted-single-contact.toml", "pitted-recess.toml"],
        scheme::pitted_regions,
    ),
    computed(
        "3.6",
        "Pits in single contact",
        "Transmission error and mesh stiffness with pits of 10 to 100 % of the region of single contact.",
        &["pitted-single-contact.toml"],
        chapter3::single_contact_pits,
    ),
    computed(
        "3.7",
        "Pits in double contact, approach",
        "The same for the region of double contact in the approach.",
        &["pitted-approach.toml"],
        chapter3::approach_pits,
    ),
    computed(
        "3.8",
        "Pits in double contact, recess",
        "The same for the region of double contact in the recess.",
        &["pitted-recess.toml"],
        chapter3::recess_pits,
    ),
    computed(
        "3.9",
        "Pits at the pitch line",
        "Six pits growing both ways at the pitch line.",
        &["pitted-pitch.toml"],
        chapter3::pitch_pits,
    ),
    computed(
        "3.10",
        "Pits at one edge",
        "Seven pits growing both ways at the pitch line on one edge of the face.",
        &["pitted-edge.toml"],
        chapter3::edge_pits,
    ),
    computed(
        "3.11",
        "Root cracks on the unity pair",
        "Average-slope stiffness with root cracks of three lengths at 100 N m.",
        &["unity-cracked.toml"],
        chapter3::unity_cracks,
    ),
    computed(
        "3.12",
        "Root cracks on the nonunity pair",
        "Transmission error and stiffness with root cracks of 20, 50 and 80 % on the pinion, and on the gear.",
        &["cracked-pinion.toml", "cracked-gear.toml"],
        chapter3::nonunity_cracks,
    ),
    computed(
        "3.13",
        "Damage type from the transmission error",
        "Largest transmission error, and span of the mesh cycle affected, over the amount of damage.",
        &["pitted-pitch.toml", "cracked-pinion-growth.toml"],
        chapter3::severity,
    ),
    computed(
        "3.14",
        "The lumped-parameter model",
        "Scheme of the model with its three coordinates.",
        &[],
        scheme::lumped_model,
    ),
    computed(
        "T3.2",
        "Parameters of the lumped-parameter model",
        "Which of them follow from the geometry.",
        &["nonunity-pair.toml"],
        chapter3::lumped_parameters,
    ),
    computed(
        "3.15",
        "Dynamic transmission error at 900 Hz",
        "Steady response of the healthy pair, with a pit, and with a root crack, by lumped parameters.",
        &["lumped-900hz.toml", "lumped-900hz-pits.toml"],
        lumped::at_900,
    ),
    computed(
        "3.16",
        "Response with pits at 900 Hz",
        "One rotation of the pinion with three pits on one of its teeth.",
        &["lumped-900hz-pits.toml"],
        lumped::pits_at_900,
    ),
    computed(
        "3.17",
        "Response with root cracks at 900 Hz",
        "One rotation of the pinion with root cracks of 20, 50 and 80 % on one of its teeth.",
        &["lumped-900hz.toml"],
        lumped::cracks_at_900,
    ),
    computed(
        "4.1",
        "The nonunity pair and its natural frequencies",
        "Mesh of the pair; natural frequency and damping ratio at one and two pairs in contact.",
        &["nonunity-pair.toml", "cracked-pinion-plane.toml", "lumped-resonance.toml"],
        scheme::nonunity_frequencies,
    ),
    computed("T4.1", "Geometry of the nonunity pair", "As Table 3.1.", &["nonunity-pair.toml"], chapter3::geometry),
    missing("4.2", "Finite-element response, healthy", "Response and spectrum at 4000 rpm.", FE_DYNAMICS),
    missing(
        "4.3",
        "Finite-element response with root cracks",
        "Response and spectrum at 4000 rpm with root cracks.",
        FE_DYNAMICS,
    ),
    missing("4.4", "Finite-element response with pits", "Response and spectrum at 4000 rpm with pits.", FE_DYNAMICS),
    missing(
        "4.5",
        "Exact difference signals",
        "Damaged minus healthy response, cracks and pits, with spectra.",
        FE_DYNAMICS,
    ),
    missing(
        "T4.2",
        "Condition indicators of exact difference signals",
        "RMS, FM4 and M8A of the signals of Figure 4.5.",
        FE_DYNAMICS,
    ),
    computed(
        "4.6",
        "A damped sine fitted to difference signals",
        "Difference signals of root cracks of 20, 50 and 80 %, and the damped sine fitted to each, in time and frequency.",
        &["lumped-1800hz-growth.toml", "cracked-pinion-plane-growth.toml"],
        chapter4::fitted_signals,
    ),
    computed(
        "4.7",
        "Amplitude and delay over crack length",
        "Parameters of the fitted damped sine.",
        &["lumped-1800hz-growth.toml", "cracked-pinion-plane-growth.toml"],
        chapter4::amplitude_and_delay,
    ),
    computed(
        "4.8",
        "Condition indicators over crack length",
        "RMS, FM4 and M8A of the difference signal, of the damped sine, and in closed form.",
        &["lumped-1800hz-growth.toml", "cracked-pinion-plane-growth.toml"],
        chapter4::indicators,
    ),
    computed(
        "4.9",
        "Probability density of a damped sine",
        "Counted from samples and in closed form, for a few half cycles and for a whole rotation.",
        &[],
        chapter4::densities,
    ),
    computed(
        "4.10",
        "Condition indicators over the pair's properties",
        "RMS, FM4 and M8A in closed form over damping ratio, natural frequency and number of half cycles.",
        &[],
        chapter4::sensitivity,
    ),
    missing("5.1", "Model of the rotorcraft transmission", "Gears, housing and sensors.", PLANETARY),
    computed(
        "T5.1",
        "Frequencies of the rotorcraft transmission",
        "What follows from its tooth numbers and input speed.",
        &[],
        kinematics::planetary,
    ),
    missing("5.2", "Housing accelerations, healthy", "Rotorcraft transmission.", PLANETARY),
    missing("5.3", "Their spectra", "Rotorcraft transmission.", PLANETARY),
    missing("5.4", "Three carrier rotations, healthy", "Rotorcraft transmission.", PLANETARY),
    missing("5.5", "Housing accelerations with a cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("5.6", "Exact difference signals", "Rotorcraft transmission.", PLANETARY),
    missing("5.7", "Approximate difference signals", "Rotorcraft transmission.", PLANETARY),
    missing("T5.2", "FM4 of approximate and exact difference signals", "Rotorcraft transmission.", PLANETARY),
    missing("5.8", "Difference signals with more sidebands removed", "Rotorcraft transmission.", PLANETARY),
    missing("5.9", "FM4 around the housing", "Rotorcraft transmission.", PLANETARY),
    missing("5.10", "FM4 around the housing by place of the damaged tooth", "Rotorcraft transmission.", PLANETARY),
    missing("6.1", "Model of the transmission with a damaged sun tooth", "Rotorcraft transmission.", PLANETARY),
    missing("6.2", "Housing accelerations, healthy", "Rotorcraft transmission.", PLANETARY),
    missing("6.3", "Their spectra", "Rotorcraft transmission.", PLANETARY),
    missing("6.4", "Housing accelerations with a cracked sun tooth", "Rotorcraft transmission.", PLANETARY),
    missing("6.5", "Approximate difference signals", "Rotorcraft transmission.", PLANETARY),
    missing("6.6", "Exact difference signals", "Rotorcraft transmission.", PLANETARY),
    missing("6.7", "FM4 by difference signal and average", "Rotorcraft transmission.", PLANETARY),
    missing("6.8", "FM4 around the housing", "Rotorcraft transmission.", PLANETARY),
    computed(
        "7.1",
        "Models of the nonunity pair",
        "Finite-element mesh and lumped-parameter scheme.",
        &["nonunity-pair.toml"],
        scheme::nonunity_mesh,
    ),
    computed("T7.1", "Geometry of the nonunity pair", "As Table 3.1.", &["nonunity-pair.toml"], chapter3::geometry),
    computed(
        "T7.2",
        "Parameters of the lumped-parameter model",
        "As Table 3.2.",
        &["nonunity-pair.toml"],
        chapter3::lumped_parameters,
    ),
    computed(
        "7.2",
        "Response at 1800 Hz, healthy",
        "Response and spectrum of the healthy pair.",
        &["lumped-resonance.toml"],
        lumped::healthy_at_1800,
    ),
    computed(
        "7.3",
        "Response at 1800 Hz with root cracks",
        "Response over one rotation and spectrum.",
        &["lumped-resonance.toml", "cracked-pinion-plane.toml"],
        lumped::cracks_at_1800,
    ),
    computed(
        "7.4",
        "Peak-to-peak response over speed",
        "Sweeps up and down, healthy and with root cracks.",
        &["lumped-resonance.toml"],
        lumped::resonance,
    ),
    computed(
        "7.5",
        "Two motions at one speed",
        "Lower and upper branch, response and spectrum.",
        &["lumped-1750hz-lower.toml", "lumped-1850hz-upper.toml"],
        lumped::two_branches,
    ),
    computed(
        "7.6",
        "Damage-induced response at 1800 Hz",
        "Damaged minus healthy for a crack of 20 %, and its spectrum.",
        &["lumped-900hz.toml"],
        lumped::damage_response,
    ),
    computed(
        "7.7",
        "Damage-induced response over speed",
        "Largest line of its spectrum, and its value at rest.",
        &["lumped-900hz.toml"],
        lumped::damage_speeds,
    ),
    missing("A.1", "RMS, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("A.2", "Crest factor, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("A.3", "Kurtosis, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("A.4", "Energy operator, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("A.5", "RMS and kurtosis by number of averages", "Rotorcraft transmission.", PLANETARY),
    missing("A.6", "RMS of the difference signal, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing("A.7", "M8A, cracked ring tooth", "Rotorcraft transmission.", PLANETARY),
    missing(
        "B.1",
        "RMS, crest factor, kurtosis and energy operator, cracked sun tooth",
        "Rotorcraft transmission.",
        PLANETARY,
    ),
    missing("B.2", "Indicators of difference signals, cracked sun tooth", "Rotorcraft transmission.", PLANETARY),
    missing("B.3", "Indicators of exact difference signals, cracked sun tooth", "Rotorcraft transmission.", PLANETARY),
];
