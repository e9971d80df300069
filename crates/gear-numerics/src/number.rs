//! Whole numbers: which teeth meet when.

pub use num_integer::{gcd, lcm};
