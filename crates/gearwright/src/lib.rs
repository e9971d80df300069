//! The gearwright application: case files (`gearwright-case`) in, result files out.
//!
//! | module | holds |
//! |---|---|
//! | [`run`] | a case from start to published results |
//! | [`cli`] | commands and progress; the only module that writes to the terminal |
//!
//! A case, from text to gears in mesh; [`run::run`] would compute it into a folder:
//!
//! ```
//! use gearwright_case::{self as case, Case, kind, template};
//!
//! let kind = kind::find("spur-pair").ok_or("no such kind")?;
//! let text = template::commented(kind);
//! let Case::SpurPair(case) = case::from_text(&text, "example.toml".as_ref())? else { return Err("another kind".into()) };
//! assert_eq!(case.pair.pinion().teeth(), 25);
//!
//! // a mistake is told with its line and what is allowed
//! let faults = case::from_text(&text.replace("teeth = 25", "teeth = 3"), "example.toml".as_ref()).unwrap_err().to_string();
//! assert!(faults.contains("pinion.teeth"), "{faults}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cli;
pub mod run;
