//! Vibration signals and condition indicators for gear health monitoring.
//!
//! The crate knows signals and nothing of gears' insides: it takes slices of samples, the number of
//! mesh cycles in a period, and a tachometer. Every function states its formula and source; a
//! quantity that is not defined for a signal is an error that says why, never NaN. Units are those of
//! the signal, times in s, frequencies in Hz, angles in turns.
//!
//! In the order of use:
//!
//! | module | what it does |
//! |---|---|
//! | `io` (feature `io`) | recordings from CSV, TSV, WAV, NPY, MAT v5, block by block |
//! | [`quality`] | whether a channel can be judged: dead, gaps, clipped, saturated, dropouts, drift |
//! | [`signal`] | gaps and trends of a record |
//! | [`time_axis`] | time columns: step, missing rows, changes of rate |
//! | [`tachometer`] | pulses with faults to shaft angle |
//! | [`resample`] | values between samples, time to angle |
//! | [`tsa`] | synchronous averages, whole and streamed; the comb filter |
//! | [`separation`] | averages of single planets and of the sun |
//! | [`difference`] | residual, difference, regular and exact difference signals |
//! | [`spectrum`], [`envelope`] | order spectra, PSD, spectrogram, demodulation |
//! | [`moments`] | streaming moments up to order eight |
//! | [`indicator`] | condition indicators: single, in tables, with a memory |
//! | [`threshold`] | limits, rates, receiver operating characteristic, alarms |
//! | [`detectability`] | probability of detection over severity, a90/95 |
//! | [`phenomenon`] | damped-sine model of damage: fit, densities, closed forms, several modes |
//! | [`damage_type`] | crack or pit, and how much of it, from the static transmission error |
//! | [`modal_fit`] | modes from ringing by matrix pencil and Prony |
//!
//! Citations "D n.n" are to the dissertation that the project reproduces: see `docs/references.bib`.
//! Where its print and the derivation disagree, the code follows the derivation (`docs/signals.md` lists
//! the places).
//!
//! From a record and its tachometer to a verdict:
//!
//! ```
//! use hums::difference::RemovalRule;
//! use hums::indicator::{GearAnalyzer, Indicator, SignalKind};
//! use hums::tachometer::{Shaft, repair};
//! use hums::tsa::{TsaOptions, average};
//! use std::f64::consts::TAU;
//!
//! // 4 s of a 27-tooth gear at 10 Hz, 20.48 kHz: mesh vibration, a tone of another shaft, and a knock
//! // as one tooth passes. The tachometer lost a pulse.
//! let (rate, speed) = (20_480.0, 10.0);
//! let record: Vec<f64> = (0..81_920)
//!     .map(|i| {
//!         let turn = i as f64 / rate * speed;
//!         let knock = if (0.50..0.51).contains(&turn.fract()) { 0.8 } else { 0.0 };
//!         (27.0 * TAU * turn).sin() + 0.5 * (8.37 * TAU * turn).sin() + knock
//!     })
//!     .collect();
//! let pulses: Vec<f64> = (0..40).filter(|k| *k != 17).map(|k| k as f64 / speed).collect();
//!
//! let pulses = repair(&pulses)?;
//! assert_eq!(pulses.missing, 1);
//! let shaft = Shaft::from_repaired(&pulses, 1.0)?;
//! let average = average(&record, rate, &shaft, &TsaOptions::per_turn(2048))?;
//! assert_eq!(average.blocks, 38);
//!
//! let analyzer = GearAnalyzer::new(2048, &RemovalRule::sidebands(27, 1))?;
//! let fm4 = analyzer
//!     .analyze(&average.samples)?
//!     .value(Indicator::Fm4, SignalKind::Difference)?;
//! assert!(Some(fm4) > Indicator::Fm4.gaussian_value(), "a knock is not Gaussian: {fm4}");
//! # Ok::<(), hums::HumsError>(())
//! ```

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout))]

pub mod damage_type;
pub mod detectability;
pub mod difference;
mod distribution;
pub mod envelope;
mod error;
pub mod indicator;
#[cfg(feature = "io")]
pub mod io;
pub mod modal_fit;
pub mod moments;
pub mod phenomenon;
pub mod quality;
pub mod resample;
pub mod separation;
pub mod signal;
pub mod spectrum;
pub mod tachometer;
pub mod threshold;
pub mod time_axis;
pub mod tsa;

pub use error::{HumsError, Result};
pub use indicator::basic::{crest_factor, fm4, kurtosis, m6a, m8a, rms};
