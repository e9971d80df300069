//! MAT v5 files: vectors and matrices of real numbers, compressed or not, read block by block.
//!
//! Channels are the arrays of the longest time axis (the longer axis of each array), matrices giving one a column `name(1)`,
//! `name(2)`, ..; other arrays are left out, and named in [`BlockReader::notes`]. A scalar named `fs`, `rate`, `rate_hz`, `sample_rate` or the like (any
//! case) is the sampling rate. v7.3 files are HDF5 and not read.
//!
//! Layout: "MAT-File Format" (The MathWorks), level 5: a header of 128 bytes, then elements of a tag (type, bytes) and data; an array
//! is an element of elements (flags, dimensions, name, numbers), which `-v7` wraps into a zlib stream. Numbers are stored by columns,
//! so that every channel has a reader of its own: at its place in the file, or, compressed, a decompressor. A compressed matrix of
//! several columns is inflated into memory once, up to `MAX_INFLATED` in one file; beyond, every column has a decompressor that passes over the
//! columns before it, for at most `MAX_STREAMS` of them.

use super::stretch::{Kind, Place, Scalar, Stretch, StretchReader};
use super::{BlockReader, ReadError, is_rate_name};
use flate2::read::ZlibDecoder;
use std::cell::RefCell;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::rc::Rc;
use std::sync::Arc;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Bytes before the first element.
const HEADER: u64 = 128;
/// Bytes of a compressed stream read at a time.
const BUFFER: usize = 1 << 15;
/// Longest name of an array (63 in the present program), and most dimensions.
const LONGEST: usize = 4096;

/// An array of real numbers with two axes.
struct Array {
    name: String,
    rows: u64,
    columns: u64,
    scalar: Scalar,
    /// First number, in bytes from the start of the array's element (inflated, if it is compressed).
    start: u64,
}

/// Where an array's element lies.
#[derive(Clone, Copy)]
struct Spot {
    at: u64,
    compressed: bool,
}

impl Spot {
    fn source<R: Read + Seek + 'static>(self, file: &Rc<RefCell<R>>) -> Box<dyn Read> {
        let place = Place::new(file, self.at);
        if self.compressed {
            Box::new(ZlibDecoder::new(BufReader::with_capacity(BUFFER, place)))
        } else {
            Box::new(place)
        }
    }
}

/// Opens a file.
///
/// # Errors
/// [`ReadError::Format`] when it is not MAT v5, is damaged, or has no array of real numbers.
pub fn open<R: Read + Seek + 'static>(mut source: R) -> Result<Box<dyn BlockReader>, ReadError> {
    let length = source.seek(SeekFrom::End(0))?;
    source.seek(SeekFrom::Start(0))?;
    let big = header(&mut source, length)?;
    let file = Rc::new(RefCell::new(source));
    let (mut rate, mut arrays) = (None, Vec::new());
    let mut at = HEADER;
    while at + 8 <= length {
        let mut place = Place::new(&file, at);
        let tag = Tag::read(&mut place, big).map_err(|e| broken(at, &e.to_string()))?;
        let (kind, bytes) = (tag.kind, tag.bytes);
        let data = at + 8;
        if bytes > length - data {
            let reason =
                format!("its element is {bytes} bytes long, the file ends {} bytes after its tag", length - data);
            return Err(broken(at, &reason));
        }
        let spot = Spot { at: if kind == COMPRESSED { data } else { at }, compressed: kind == COMPRESSED };
        if kind == COMPRESSED || kind == MATRIX {
            let mut source = Counted { source: spot.source(&file), count: 0 };
            if let Some(array) = array(&mut source, big).map_err(|reason| broken(at, &reason))? {
                if array.rows * array.columns > 1 {
                    arrays.push((spot, array));
                } else if is_rate_name(&array.name) {
                    let mut bytes = vec![0; array.scalar.size];
                    source.source.read_exact(&mut bytes).map_err(|e| broken(at, &e.to_string()))?;
                    rate = Some(array.scalar.value(&bytes)).filter(|r| *r > 0.0 && r.is_finite()).or(rate);
                }
            }
        }
        // Compressed elements are not padded; others say their padded length.
        at = data + bytes;
    }
    let Some(samples) = arrays.iter().map(|(_, a)| a.rows.max(a.columns)).max() else {
        return Err(mat_error("no vector or matrix of real numbers".into()));
    };
    let (mut names, mut stretches) = (Vec::new(), Vec::new());
    let mut inflated = 0;
    for (spot, array) in arrays.iter().filter(|(_, a)| a.rows.max(a.columns) == samples) {
        let count = array.rows.min(array.columns);
        if names.len() as u64 + count > MOST_CHANNELS {
            return Err(mat_error(format!("more than {MOST_CHANNELS} channels")));
        }
        names.extend((1..=count).map(|c| if count == 1 { array.name.clone() } else { format!("{}({c})", array.name) }));
        let by_columns = array.rows >= array.columns;
        let per_stretch = array.rows * array.scalar.size as u64;
        let parts = if by_columns { count } else { 1 };
        let bytes = parts * per_stretch;
        let whole = if spot.compressed && parts > 1 && inflated + bytes <= MAX_INFLATED {
            inflated += bytes;
            Some(inflate(spot.source(&file), array, bytes)?)
        } else {
            None
        };
        if spot.compressed && whole.is_none() && parts > MAX_STREAMS {
            return Err(mat_error(format!(
                "the compressed array \"{}\" has {parts} columns of {per_stretch} bytes: more than {MAX_INFLATED} bytes, and more than {MAX_STREAMS} columns; save it uncompressed (-v6)",
                array.name
            )));
        }
        for c in 0..parts {
            if let Some(whole) = &whole {
                let mut part = std::io::Cursor::new(Arc::clone(whole));
                part.set_position(c * per_stretch);
                stretches.push(Stretch {
                    skip: 0,
                    source: Box::new(part),
                    scalar: array.scalar,
                    width: 1,
                    checked: false,
                });
                continue;
            }
            stretches.push(Stretch {
                skip: if spot.compressed { array.start + c * per_stretch } else { 0 },
                source: if spot.compressed {
                    spot.source(&file)
                } else {
                    Box::new(Place::new(&file, spot.at + array.start + c * per_stretch))
                },
                scalar: array.scalar,
                width: if by_columns { 1 } else { count as usize },
                checked: spot.compressed && c + 1 == parts,
            });
        }
    }
    let notes = arrays.iter().filter(|(_, a)| a.rows.max(a.columns) != samples).map(|(_, a)| {
        format!(
            "array \"{}\" of {} by {} is left out: the longest arrays have {samples} samples",
            a.name, a.rows, a.columns
        )
    });
    let notes = notes.collect();
    Ok(Box::new(StretchReader::new(FORMAT, names, rate, stretches, samples).with_notes(notes)))
}

/// The numbers of a compressed array, inflated; the stream is read to its end, whose checksum covers them.
fn inflate(mut source: Box<dyn Read>, array: &Array, bytes: u64) -> Result<Arc<[u8]>, ReadError> {
    let fault = |e: std::io::Error| mat_error(format!("the compressed numbers of \"{}\" are damaged: {e}", array.name));
    std::io::copy(&mut (&mut source).take(array.start), &mut std::io::sink()).map_err(fault)?;
    let mut whole = Vec::new();
    (&mut source).take(bytes).read_to_end(&mut whole).map_err(fault)?;
    if (whole.len() as u64) < bytes {
        return Err(fault(std::io::ErrorKind::UnexpectedEof.into()));
    }
    std::io::copy(&mut source, &mut std::io::sink()).map_err(fault)?;
    Ok(whole.into())
}

/// Channels at most.
const MOST_CHANNELS: u64 = 65_536;
/// Bytes of compressed matrices kept inflated in memory, of one file.
const MAX_INFLATED: u64 = 1 << 28;
/// Decompressors (some 50 KiB each) that run at a time.
const MAX_STREAMS: u64 = 1024;

const FORMAT: &str = "MAT v5";

fn mat_error(reason: String) -> ReadError {
    ReadError::Format { format: FORMAT, reason }
}

fn broken(at: u64, reason: &str) -> ReadError {
    mat_error(format!("element at byte {at}: {reason}"))
}

/// Whether numbers begin with their most significant byte.
fn header<R: Read>(source: &mut R, length: u64) -> Result<bool, ReadError> {
    let mut head = [0; HEADER as usize];
    if length < HEADER {
        return Err(mat_error(format!("{length} bytes long, shorter than its header of {HEADER}")));
    }
    source.read_exact(&mut head)?;
    let big = match &head[126..] {
        b"IM" => false,
        b"MI" => true,
        _ => return Err(mat_error("bytes 127 and 128 are neither IM nor MI (a MAT v4 file, or no MAT file)".into())),
    };
    let version = if big { [head[124], head[125]] } else { [head[125], head[124]] };
    match version {
        [1, _] => Ok(big),
        [2, _] => Err(mat_error("this is v7.3 (HDF5); save it with -v7".into())),
        [a, b] => Err(mat_error(format!("version {a}.{b}, known is 1.0"))),
    }
}

/// Counts what is read.
struct Counted {
    source: Box<dyn Read>,
    count: u64,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.count += count as u64;
        Ok(count)
    }
}

/// Tag of an element.
struct Tag {
    kind: u32,
    bytes: u64,
    /// Data of a small element, which are part of its tag.
    small: Option<[u8; 4]>,
}

impl Tag {
    fn read(source: &mut impl Read, big: bool) -> std::io::Result<Self> {
        let mut raw = [0; 8];
        source.read_exact(&mut raw)?;
        let [a, b, c, d, e, f, g, h] = raw;
        let word = |bytes| if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) };
        let (kind, rest) = (word([a, b, c, d]), [e, f, g, h]);
        Ok(match kind >> 16 {
            0 => Self { kind, bytes: word(rest).into(), small: None },
            bytes => Self { kind: kind & 0xffff, bytes: bytes.into(), small: Some(rest) },
        })
    }

    /// The element's data, padding passed over.
    fn data(&self, source: &mut impl Read) -> Result<Vec<u8>, String> {
        let bytes = usize::try_from(self.bytes).unwrap_or(usize::MAX);
        if bytes > LONGEST {
            return Err(format!("{bytes} bytes of dimensions or name, at most {LONGEST} are allowed"));
        }
        if let Some(small) = self.small {
            return small.get(..bytes).map(<[u8]>::to_vec).ok_or_else(|| format!("{bytes} bytes in a tag of 4"));
        }
        let mut data = vec![0; bytes.next_multiple_of(8)];
        source.read_exact(&mut data).map_err(|e| e.to_string())?;
        data.truncate(bytes);
        Ok(data)
    }
}

/// Reads an array's element up to its numbers; `None` for one that is no matrix of real numbers.
fn array(source: &mut Counted, big: bool) -> Result<Option<Array>, String> {
    let tag = |source: &mut Counted| Tag::read(source, big).map_err(|e| e.to_string());
    let word = |bytes: &[u8]| match (bytes.first_chunk().copied(), big) {
        (Some(four), true) => u32::from_be_bytes(four),
        (Some(four), false) => u32::from_le_bytes(four),
        (None, _) => 0,
    };
    let outer = tag(source)?;
    if outer.kind != MATRIX || outer.bytes < 8 {
        return Ok(None);
    }
    let flags = tag(source)?.data(source)?;
    let (class, complex) = (word(&flags) & 0xff, word(&flags) & 0x800 != 0);
    // Double, single and whole numbers of 8 to 64 bits; others are texts, cells, structures, sparse.
    if !(6..=15).contains(&class) || complex {
        return Ok(None);
    }
    let axes = tag(source)?.data(source)?;
    let axes: Vec<u64> = axes.chunks_exact(4).map(|four| word(four).into()).collect();
    let name = tag(source)?.data(source)?;
    let name = String::from_utf8_lossy(&name).into_owned();
    let [rows, columns] = axes[..] else { return Ok(None) };
    if rows == 0 || columns == 0 {
        return Ok(None);
    }
    let numbers = tag(source)?;
    let (kind, size) = match numbers.kind {
        1 => (Kind::Signed, 1),
        2 => (Kind::Unsigned, 1),
        3 => (Kind::Signed, 2),
        4 => (Kind::Unsigned, 2),
        5 => (Kind::Signed, 4),
        6 => (Kind::Unsigned, 4),
        7 => (Kind::Float, 4),
        9 => (Kind::Float, 8),
        12 => (Kind::Signed, 8),
        13 => (Kind::Unsigned, 8),
        other => return Err(format!("array \"{name}\" holds numbers of the unknown type {other}")),
    };
    let scalar = Scalar { kind, size, big };
    if source.count.saturating_add(numbers.bytes) > outer.bytes.saturating_add(16) {
        return Err(format!(
            "array \"{name}\" says {} bytes of numbers in an element of {}",
            numbers.bytes, outer.bytes
        ));
    }
    if rows.checked_mul(columns).and_then(|n| n.checked_mul(size as u64)) != Some(numbers.bytes) {
        return Err(format!(
            "array \"{name}\" of {rows} by {columns} numbers of {size} bytes has {} bytes",
            numbers.bytes
        ));
    }
    // A small element's numbers stand in its tag.
    let start = source.count - if numbers.small.is_some() { 4 } else { 0 };
    if let Some(small) = numbers.small {
        source.source = Box::new(std::io::Cursor::new(small));
    }
    Ok(Some(Array { name, rows, columns, scalar, start }))
}
