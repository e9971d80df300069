//! One function per figure or table.

pub mod chapter2;
pub mod chapter3;
pub mod chapter4;
pub mod kinematics;
pub mod lumped;
pub mod scheme;
pub mod transmission;
