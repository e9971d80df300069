//! Vibration signals and condition indicators for gear health monitoring.
//!
//! The crate knows signals and nothing of gears' insides: it takes slices of samples, the number of
//! mesh cycles in a period, and a tachometer. Every function states its formula and source; a
//! quantity that is not defined for a signal is an error that says why, never NaN.
//!
//! | module | what it does |
//! |---|---|
//! | [`signal`] | gaps, clipping, trends of a record |
//! | [`moments`] | streaming moments up to order eight |
//! | [`indicator`] | condition indicators and tables of them |
//! | [`difference`] | residual, difference, regular and exact difference signals |
//! | [`spectrum`], [`envelope`] | order spectra, PSD, spectrogram, demodulation |
//!
//! Citations "D n.n" are to the dissertation that the project reproduces: see `docs/references.bib`.
//!
//! ```
//! use hums::difference::RemovalRule;
//! use hums::indicator::{GearAnalyzer, Indicator, SignalKind};
//! use std::f64::consts::TAU;
//!
//! // One revolution of a 27-tooth gear: mesh vibration, and a knock as one tooth passes.
//! let average: Vec<f64> = (0..2048)
//!     .map(|i| {
//!         let turn = i as f64 / 2048.0;
//!         let knock = if (0.50..0.51).contains(&turn) { 0.8 } else { 0.0 };
//!         (27.0 * TAU * turn).sin() + knock
//!     })
//!     .collect();
//! let analyzer = GearAnalyzer::new(2048, &RemovalRule::sidebands(27, 1))?;
//! let fm4 = analyzer.analyze(&average)?.value(Indicator::Fm4, SignalKind::Difference)?;
//! assert!(fm4 > 3.0, "a knock is not Gaussian: {fm4}");
//! # Ok::<(), hums::HumsError>(())
//! ```

#![cfg_attr(
    not(test),
    warn(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::print_stdout
    )
)]

pub mod difference;
pub mod envelope;
mod error;
pub mod indicator;
#[cfg(feature = "io")]
pub mod io;
pub mod modal_fit;
pub mod moments;
pub mod phenomenon;
pub mod resample;
pub mod separation;
pub mod signal;
pub mod spectrum;
mod spline;
pub mod tachometer;
pub mod threshold;
pub mod tsa;

pub use error::{HumsError, Result};
