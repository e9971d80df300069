//! Result files: tables, summary, ParaView files, and the folder that holds them.

pub mod folder;
pub mod geometry;
pub mod summary;
pub mod tables;
pub mod vtu;
