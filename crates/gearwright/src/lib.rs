//! The gearwright application: case files in, result files out.
//!
//! | module | holds |
//! |---|---|
//! | [`case`] | case files: schema, checks with lines, resolution to SI units |
//! | [`run`] | a case from start to published results |
//! | [`output`] | tables, summary, ParaView files, the results folder |
//! | [`plot`] | figures |
//! | [`cli`] | commands and progress; the only module that writes to the terminal |

pub mod case;
pub mod cli;
pub mod output;
pub mod plot;
pub mod run;
