//! What tests share: gears of pairs, plane bodies.
// every test binary uses a part of it
#![allow(dead_code, unused_imports)]

pub mod bodies;
pub mod flank;
pub mod pairs;

pub use pairs::{TORQUE, gear, pair};
