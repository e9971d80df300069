//! Finite-element/contact-mechanics dynamics of a pair.

mod findings;
pub mod summary;
pub mod tables;

pub use findings::*;
