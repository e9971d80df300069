//! MAT v5 files: vectors and matrices of real numbers, read whole.
//!
//! Channels are the arrays of the longest time axis (the longer axis of each array), matrices giving
//! one a column `name(1)`, `name(2)`, ..; shorter arrays are left out. A scalar named `fs`, `rate`,
//! `sample_rate`, `samplerate` or `sampling_rate` (any case) is the sampling rate. v7.3 files are HDF5 and not read.

use super::{MemoryReader, ReadError, Recording};
use matfile::{MatFile, NumericData};
use std::io::Read;

/// Reads a file.
///
/// # Errors
/// [`ReadError::Format`] when it is not MAT v5, or has no array of real numbers.
pub fn read<R: Read>(source: R) -> Result<MemoryReader, ReadError> {
    let file = MatFile::parse(source).map_err(|e| mat_error(e.to_string()))?;
    let mut rate = None;
    let mut arrays = Vec::new();
    for array in file.arrays() {
        let Some(values) = real(array.data()) else {
            continue;
        };
        let [rows, columns] = array.size()[..] else {
            continue;
        };
        if rows.checked_mul(columns) != Some(values.len()) || values.is_empty() {
            continue;
        }
        if values.len() == 1 {
            let names = ["fs", "rate", "sample_rate", "samplerate", "sampling_rate"];
            let name = array.name().to_ascii_lowercase();
            if names.contains(&name.as_str()) && values[0] > 0.0 && values[0].is_finite() {
                rate = Some(values[0]);
            }
            continue;
        }
        arrays.push((array.name().to_owned(), rows, columns, values));
    }
    let Some(samples) = arrays.iter().map(|a| a.1.max(a.2)).max() else {
        return Err(mat_error("no vector or matrix of real numbers".into()));
    };
    let mut recording = Recording { names: Vec::new(), rate, channels: Vec::new() };
    for (name, rows, columns, values) in arrays {
        if rows.max(columns) != samples {
            continue;
        }
        let count = rows.min(columns);
        for c in 0..count {
            // Storage is by columns.
            recording.channels.push(if rows >= columns {
                values[c * rows..(c + 1) * rows].to_vec()
            } else {
                values.iter().skip(c).step_by(rows).copied().collect()
            });
            recording.names.push(if count == 1 { name.clone() } else { format!("{name}({})", c + 1) });
        }
    }
    Ok(MemoryReader::new(recording))
}

fn mat_error(reason: String) -> ReadError {
    ReadError::Format { format: "MAT v5", reason }
}

/// Values of a real array; `None` for a complex one.
fn real(data: &NumericData) -> Option<Vec<f64>> {
    macro_rules! wide {
        ($($kind:ident),*) => {
            match data {
                NumericData::Double { real, imag: None } => Some(real.clone()),
                $(NumericData::$kind { real, imag: None } => {
                    Some(real.iter().map(|x| f64::from(*x)).collect())
                })*
                NumericData::Int64 { real, imag: None } => {
                    Some(real.iter().map(|x| *x as f64).collect())
                }
                NumericData::UInt64 { real, imag: None } => {
                    Some(real.iter().map(|x| *x as f64).collect())
                }
                _ => None,
            }
        };
    }
    wide!(Single, Int8, UInt8, Int16, UInt16, Int32, UInt32)
}
