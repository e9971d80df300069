//! Small numerics that several gear crates share. No units, no files, no gears.
//!
//! | module | content |
//! |---|---|
//! | `fft` (feature) | plans of Fourier transforms of `f64` |
//! | [`number`] | greatest common divisor, least common multiple |
//! | [`roots`] | bisection |
//! | [`spline`] | cubic splines (not-a-knot, periodic) and Hermite cubics |
//!
//! ```
//! use gear_numerics::{number::lcm, roots::bisect};
//!
//! let (low, high) = bisect([0.0, 2.0], 60, |x| x * x < 2.0);
//! assert!(low <= 2.0_f64.sqrt() && 2.0_f64.sqrt() <= high && high - low < 1e-15);
//! // mesh cycles after which the same teeth of a 27/35 pair meet again
//! assert_eq!(lcm(27, 35), 945);
//! ```

#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout))]

#[cfg(feature = "fft")]
pub mod fft;
pub mod number;
pub mod roots;
pub mod spline;
