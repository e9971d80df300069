//! Vibration of a whole geared transmission: a planetary stage with moving planets, an optional spiral bevel stage before it, bearings, carrier
//! and an elastic housing with sensors on it.
//!
//! | module | holds |
//! |---|---|
//! | [`mesh`] | force over approach of a tooth mesh, from contact mechanics or given |
//! | [`elastic`] | an elastic body as others see it: modes, ports, ring seat, sensors |
//! | [`housing`] | finite elements of a housing, and its reduction to an elastic body |
//! | [`engine`] | bodies and connections put together, in equilibrium, in free vibration, in time |

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, clippy::print_stderr)
)]

pub mod elastic;
pub mod engine;
pub mod error;
pub mod housing;
pub mod mesh;

pub use error::PlanetaryError;
