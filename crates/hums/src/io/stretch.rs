//! Numbers in binary files, and samples that lie in stretches of a file: interleaved, or a channel after the other.
//!
//! A stretch is a run of frames of equal width, one number a channel. Interleaved channels are one stretch; matrices stored by
//! columns are a stretch for each channel, all read in step, each at its own place of the one file ([`Place`]). Memory is a piece
//! of each stretch.
//! Verified by `tests/io.rs`.

use super::{BlockReader, ReadError, check_columns};
use std::cell::RefCell;
use std::io::{Read, Seek, SeekFrom};
use std::rc::Rc;

/// How a number is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Signed,
    Unsigned,
}

/// A number of 1, 2, 4 or 8 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scalar {
    pub kind: Kind,
    pub size: usize,
    /// The most significant byte comes first.
    pub big: bool,
}

impl Scalar {
    /// `None` for a size that the kind does not have.
    pub fn new(kind: Kind, size: usize, big: bool) -> Option<Self> {
        let sizes: &[usize] = if kind == Kind::Float { &[4, 8] } else { &[1, 2, 4, 8] };
        sizes.contains(&size).then_some(Self { kind, size, big })
    }

    /// Value of one number.
    pub fn value(self, bytes: &[u8]) -> f64 {
        // Little-endian, zero-extended into eight bytes.
        let mut wide = [0; 8];
        for (i, b) in bytes.iter().enumerate().take(8) {
            let at = if self.big { bytes.len() - 1 - i } else { i };
            wide[at] = *b;
        }
        self.of_bits(u64::from_le_bytes(wide))
    }

    fn of_bits(self, bits: u64) -> f64 {
        let unused = 64 - 8 * self.size as u32;
        match self.kind {
            Kind::Unsigned => bits as f64,
            Kind::Signed => (((bits << unused) as i64) >> unused) as f64,
            Kind::Float if self.size == 4 => f64::from(f32::from_bits(bits as u32)),
            Kind::Float => f64::from_bits(bits),
        }
    }

    /// Appends the number at byte `at` of every frame of `stride` bytes.
    fn decode(self, frames: &[u8], at: usize, stride: usize, out: &mut Vec<f64>) {
        let numbers = frames.chunks_exact(stride).map(|frame| &frame[at..at + self.size]);
        // The usual widths at memory speed; the rest byte by byte.
        match (self.kind, numbers.clone().next().map(<[u8]>::len), self.big) {
            (Kind::Float, Some(8), false) => out.extend(numbers.map(|b| f64::from_le_bytes(fixed(b)))),
            (Kind::Float, Some(4), false) => out.extend(numbers.map(|b| f64::from(f32::from_le_bytes(fixed(b))))),
            (Kind::Signed, Some(2), false) => out.extend(numbers.map(|b| f64::from(i16::from_le_bytes(fixed(b))))),
            (Kind::Signed, Some(4), false) => out.extend(numbers.map(|b| f64::from(i32::from_le_bytes(fixed(b))))),
            _ => out.extend(numbers.map(|b| self.value(b))),
        }
    }
}

fn fixed<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}

/// A place in a file that others read, too.
pub(super) struct Place<R> {
    file: Rc<RefCell<R>>,
    at: u64,
}

impl<R> Place<R> {
    pub fn new(file: &Rc<RefCell<R>>, at: u64) -> Self {
        Self { file: Rc::clone(file), at }
    }
}

impl<R: Read + Seek> Read for Place<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let mut file = self.file.borrow_mut();
        file.seek(SeekFrom::Start(self.at))?;
        let count = file.read(buffer)?;
        self.at += count as u64;
        Ok(count)
    }
}

/// Channels whose numbers alternate from where `source` stands.
pub(super) struct Stretch {
    /// Bytes of the source before the first number.
    pub skip: u64,
    pub source: Box<dyn Read>,
    pub scalar: Scalar,
    /// Channels in it.
    pub width: usize,
    /// Whether the source ends with a checksum of what is read here: then it is read to its end.
    pub checked: bool,
}

/// Bytes of a stretch decoded at a time.
const PIECE: usize = 1 << 17;

/// A recording of one or several stretches.
pub(super) struct StretchReader {
    format: &'static str,
    names: Vec<String>,
    rate: Option<f64>,
    stretches: Vec<Stretch>,
    total: u64,
    done: u64,
    bytes: Vec<u8>,
    notes: Vec<String>,
}

impl StretchReader {
    /// `total` samples of each channel.
    pub fn new(
        format: &'static str,
        names: Vec<String>,
        rate: Option<f64>,
        stretches: Vec<Stretch>,
        total: u64,
    ) -> Self {
        Self { format, names, rate, stretches, total, done: 0, bytes: Vec::new(), notes: Vec::new() }
    }

    /// With what the file holds besides.
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }
}

impl BlockReader for StretchReader {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        self.rate
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let begin = columns.first().map_or(0, Vec::len);
        let left = usize::try_from(self.total - self.done).unwrap_or(usize::MAX);
        let wanted = samples.min(left);
        let mut first = 0;
        for stretch in &mut self.stretches {
            let stride = stretch.width * stretch.scalar.size;
            let mut done = 0;
            while done < wanted {
                let here = (wanted - done).min((PIECE / stride).max(1));
                let fault = |e: std::io::Error| match e.kind() {
                    std::io::ErrorKind::UnexpectedEof | std::io::ErrorKind::InvalidData => {
                        let (name, total) = (&self.names[first], self.total);
                        let (from, to) = (self.done + done as u64 + 1, self.done + (done + here) as u64);
                        let reason = format!("it breaks off in samples {from} to {to} of {total} of \"{name}\": {e}");
                        ReadError::Format { format: self.format, reason }
                    }
                    _ => e.into(),
                };
                if stretch.skip > 0 {
                    let skipped = std::io::copy(&mut (&mut stretch.source).take(stretch.skip), &mut std::io::sink());
                    stretch.skip -= skipped.map_err(fault)?;
                    if stretch.skip > 0 {
                        return Err(fault(std::io::ErrorKind::UnexpectedEof.into()));
                    }
                }
                self.bytes.resize(here * stride, 0);
                stretch.source.read_exact(&mut self.bytes).map_err(fault)?;
                for (c, column) in columns[first..first + stretch.width].iter_mut().enumerate() {
                    stretch.scalar.decode(&self.bytes, c * stretch.scalar.size, stride, column);
                }
                done += here;
            }
            if stretch.checked && self.done + wanted as u64 == self.total && wanted > 0 {
                std::io::copy(&mut stretch.source, &mut std::io::sink()).map_err(|e| {
                    let reason = format!("the compressed numbers of \"{}\" are damaged: {e}", self.names[first]);
                    ReadError::Format { format: self.format, reason }
                })?;
            }
            first += stretch.width;
        }
        self.done += wanted as u64;
        debug_assert!(columns.iter().all(|c| c.len() == begin + wanted));
        Ok(wanted)
    }
}
