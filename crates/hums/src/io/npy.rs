//! NPY arrays: whole numbers and floats of 1 to 8 bytes, one or two axes; the longer axis is time.
//!
//! Layout: numpy.lib.format, versions 1 to 3. Streamed, whether all channels of one instant lie together or one channel lies after the other.

use super::stretch::{Kind, Place, Scalar, Stretch, StretchReader};
use super::{BlockReader, ReadError, numbered};
use std::cell::RefCell;
use std::io::{Read, Seek};
use std::rc::Rc;

/// Opens an array.
///
/// # Errors
/// [`ReadError::Format`] when it is not an NPY file of numbers with one or two axes.
pub fn open<R: Read + Seek + 'static>(mut source: R) -> Result<Box<dyn BlockReader>, ReadError> {
    let Header { scalar, by_columns, shape } = Header::read(&mut source)?;
    let (samples, channels, interleaved) = match shape[..] {
        [n] => (n, 1, true),
        [a, b] if a >= b => (a, b, !by_columns),
        [a, b] => (b, a, by_columns),
        _ => return Err(npy_error(format!("{} axes, known are one and two", shape.len()))),
    };
    let per_channel = samples.checked_mul(scalar.size as u64);
    let (Some(per_channel), true) = (per_channel, per_channel.and_then(|n| n.checked_mul(channels)).is_some()) else {
        return Err(npy_error(format!("{samples} samples of {channels} channels are more than a file can hold")));
    };
    if channels > MOST_CHANNELS || (channels == 0 && samples > 0) {
        return Err(npy_error(format!("{channels} channels, allowed are 1 to {MOST_CHANNELS}")));
    }
    let start = source.stream_position()?;
    let file = Rc::new(RefCell::new(source));
    let (count, width) = if interleaved { (1, channels) } else { (channels, 1) };
    let stretch = |c| Stretch {
        skip: 0,
        source: Box::new(Place::new(&file, start + c * per_channel)),
        scalar,
        width: width as usize,
        checked: false,
    };
    let stretches = (0..count).map(stretch).collect();
    Ok(Box::new(StretchReader::new(FORMAT, numbered(channels as usize), None, stretches, samples)))
}

/// Channels at most.
const MOST_CHANNELS: u64 = 65_536;

const FORMAT: &str = "NPY";

fn npy_error(reason: String) -> ReadError {
    ReadError::Format { format: FORMAT, reason }
}

/// What the header says.
struct Header {
    scalar: Scalar,
    by_columns: bool,
    shape: Vec<u64>,
}

impl Header {
    /// Reads magic, version, length, and a Python dictionary of three keys, e.g.
    /// `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`.
    fn read(source: &mut impl Read) -> Result<Self, ReadError> {
        let mut begin = [0; 8];
        let short = |_| npy_error("it ends within its header".into());
        source.read_exact(&mut begin).map_err(short)?;
        if begin[..6] != *b"\x93NUMPY" {
            return Err(npy_error("it does not begin with \\x93NUMPY".into()));
        }
        let mut size = [0; 4];
        let bytes = match begin[6] {
            1 => 2,
            2 | 3 => 4,
            version => return Err(npy_error(format!("version {version}, known are 1 to 3"))),
        };
        source.read_exact(&mut size[..bytes]).map_err(short)?;
        let size = u32::from_le_bytes(size);
        if size > LONGEST_HEADER {
            return Err(npy_error(format!("a header of {size} bytes, at most {LONGEST_HEADER} are allowed")));
        }
        let mut text = vec![0; size as usize];
        source.read_exact(&mut text).map_err(short)?;
        let text = String::from_utf8_lossy(&text);
        let lacking = || npy_error(format!("its header {} lacks descr, fortran_order or shape", text.trim()));
        let of = |key: &str| Some(text.split_once(key)?.1.trim_start().strip_prefix(':')?.trim_start());
        let (Some(descr), Some(order), Some(shape)) = (of("'descr'"), of("'fortran_order'"), of("'shape'")) else {
            return Err(lacking());
        };
        let descr = descr.strip_prefix('\'').and_then(|rest| Some(rest.split_once('\'')?.0));
        let by_columns = match (order.starts_with("True"), order.starts_with("False")) {
            (false, false) => return Err(lacking()),
            (by_columns, _) => by_columns,
        };
        let (inside, _) = shape.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(lacking)?;
        let axes = inside.split(',').map(str::trim).filter(|axis| !axis.is_empty());
        let shape = axes.map(|axis| axis.parse().map_err(|_| lacking())).collect::<Result<_, _>>()?;
        let scalar = descr.and_then(scalar).ok_or_else(|| {
            let found = descr.unwrap_or("records");
            npy_error(format!("elements of type {found}; known are i1 to i8, u1 to u8, f4 and f8"))
        })?;
        Ok(Self { scalar, by_columns, shape })
    }
}

/// Bytes of a header at most (it has about 100).
const LONGEST_HEADER: u32 = 1 << 20;

/// Number of a type such as `<f8`.
fn scalar(descr: &str) -> Option<Scalar> {
    let (order, rest) = descr.split_at_checked(1)?;
    let (kind, size) = rest.split_at_checked(1)?;
    let kind = match kind {
        "f" => Kind::Float,
        "i" => Kind::Signed,
        "u" => Kind::Unsigned,
        _ => return None,
    };
    matches!(order, "<" | ">" | "|" | "=").then(|| Scalar::new(kind, size.parse().ok()?, order == ">"))?
}
