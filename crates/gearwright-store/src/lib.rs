//! Durable files of a program that computes for hours: results folders, caches, checkpoints.
//!
//! | module | holds |
//! |---|---|
//! | [`folder`] | a results folder: written beside its place, published by exchange, undone or finished after a kill |
//! | [`manifest`] | SHA-256 of every file of a results folder; [`verify`] compares |
//! | [`entry`] | one value in one file, with checksum, key and program hash: caches and checkpoints |
//! | [`digest`] | SHA-256 of bytes, files, serialised keys, and of the running program |
//! | [`lock`] | one writer for each target |
//! | [`file_system`] | every access to the disk; [`fault`] replaces it by one that fails or dies at the n-th call |
//!
//! Promises, each tested by failing and by killing every file-system call in turn (`tests/every_step.rs`):
//! * A target holds complete old results or complete new results. Between the two renames of the exchange neither stands there; the next
//!   start with this target, [`verify`] included, finishes or undoes the exchange.
//! * Files that are not results (or results that were edited) are never removed: they move to the new folder, under another name if theirs
//!   is taken.
//! * What a call returned `Ok` for is on the disk: files and folders are synced.
//! * An entry that is damaged, of another key or of another program is never taken for a value.
//!
//! ```
//! use gearwright_store::{ResultsFolder, verify};
//!
//! let place = std::env::temp_dir().join(format!("gearwright-store-example-{}", std::process::id()));
//! let results = ResultsFolder::create(&place)?;
//! std::fs::write(results.file("series.csv"), "mesh_cycle,ste_um\n0,12.5\n")?;
//! results.publish()?;
//! assert!(verify(&place)?.is_intact());
//!
//! std::fs::write(place.join("series.csv"), "mesh_cycle,ste_um\n0,12.6\n")?;
//! assert_eq!(verify(&place)?.changed, ["series.csv"]);
//! # std::fs::remove_dir_all(&place)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod digest;
pub mod entry;
pub mod error;
pub mod fault;
pub mod file_system;
pub mod folder;
pub mod lock;
pub mod manifest;

pub use digest::{Digest, program};
pub use entry::{Found, Ignored, read_entry, remove_entry, write_entry};
pub use error::StoreError;
pub use folder::{ResultsFolder, verify};
pub use manifest::Verification;
