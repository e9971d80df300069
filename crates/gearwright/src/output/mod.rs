//! Result files: tables, summary, ParaView files, and the folder that holds them.

pub mod damage;
pub mod dynamics_summary;
pub mod dynamics_tables;
pub mod folder;
pub mod geometry;
pub mod lumped_summary;
pub mod lumped_tables;
pub mod recording;
pub mod recording_detection;
pub mod recording_summary;
pub mod stress;
pub mod summary;
pub mod tables;
pub mod transmission_summary;
pub mod transmission_tables;
pub mod vtu;
