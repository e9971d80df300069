//! Vibration of a planetary transmission.

mod findings;
pub mod summary;
pub mod tables;

pub use findings::*;
