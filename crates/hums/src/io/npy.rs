//! NPY arrays: whole numbers and floats of 1 to 8 bytes, one or two axes; the longer axis is time.
//!
//! An array in which all channels of one instant lie together is streamed; one that holds a channel
//! after the other is read whole.

use super::{BlockReader, MemoryReader, ReadError, Recording, check_columns, numbered};
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar};
use std::io::Read;

/// Opens an array.
///
/// # Errors
/// [`ReadError::Format`] when it is not an NPY file of numbers with one or two axes.
pub fn open<R: Read + 'static>(mut source: R) -> Result<Box<dyn BlockReader>, ReadError> {
    let header = NpyHeader::from_reader(&mut source).map_err(|e| npy_error(format!("bad header: {e}")))?;
    let decode = Decoder::new(&header.dtype())?;
    let (samples, channels, interleaved) = match *header.shape() {
        [n] => (n, 1, true),
        [a, b] if a >= b => (a, b, header.order() == Order::C),
        [a, b] => (b, a, header.order() == Order::Fortran),
        ref shape => return Err(npy_error(format!("{} axes", shape.len()))),
    };
    let bytes = samples.checked_mul(channels).and_then(|n| n.checked_mul(decode.size as u64));
    let (Some(bytes), Ok(width)) = (bytes, usize::try_from(channels)) else {
        return Err(npy_error("the array is larger than memory can address".into()));
    };
    if width > 65_536 || (width == 0 && samples > 0) {
        return Err(npy_error(format!("{width} channels")));
    }
    if interleaved {
        return Ok(Box::new(NpyStream { names: numbered(width), source, decode, left: samples, bytes: Vec::new() }));
    }
    let mut raw = Vec::new();
    source.take(bytes).read_to_end(&mut raw)?;
    if raw.len() as u64 != bytes {
        return Err(npy_error("the file ends before the array does".into()));
    }
    let per_channel = samples as usize * decode.size;
    let channels = raw
        .chunks_exact(per_channel.max(1))
        .map(|part| part.chunks_exact(decode.size).map(|b| decode.value(b)).collect())
        .collect();
    Ok(Box::new(MemoryReader::new(Recording { names: numbered(width), rate: None, channels })))
}

fn npy_error(reason: String) -> ReadError {
    ReadError::Format { format: "NPY", reason }
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

#[derive(Debug, Clone, Copy)]
struct Decoder {
    kind: Kind,
    size: usize,
    big: bool,
}

impl Decoder {
    fn new(dtype: &DType) -> Result<Self, ReadError> {
        let unsupported = || npy_error(format!("elements of type {}", dtype.descr()));
        let DType::Plain(ty) = dtype else {
            return Err(unsupported());
        };
        let (kind, sizes): (_, &[u64]) = match ty.type_char() {
            TypeChar::Float => (Kind::Float, &[4, 8]),
            TypeChar::Int => (Kind::Signed, &[1, 2, 4, 8]),
            TypeChar::Uint => (Kind::Unsigned, &[1, 2, 4, 8]),
            _ => return Err(unsupported()),
        };
        if !sizes.contains(&ty.size_field()) {
            return Err(unsupported());
        }
        Ok(Self { kind, size: ty.size_field() as usize, big: ty.endianness() == Endianness::Big })
    }

    fn value(self, bytes: &[u8]) -> f64 {
        // Little-endian, sign-extended into eight bytes.
        let mut wide = [0; 8];
        for (i, b) in bytes.iter().enumerate().take(8) {
            let at = if self.big { bytes.len() - 1 - i } else { i };
            wide[at] = *b;
        }
        let bits = u64::from_le_bytes(wide);
        let unused = 64 - 8 * self.size as u32;
        match self.kind {
            Kind::Unsigned => bits as f64,
            Kind::Signed => (((bits << unused) as i64) >> unused) as f64,
            Kind::Float if self.size == 4 => f64::from(f32::from_bits(bits as u32)),
            Kind::Float => f64::from_bits(bits),
        }
    }
}

struct NpyStream<R> {
    source: R,
    decode: Decoder,
    names: Vec<String>,
    left: u64,
    bytes: Vec<u8>,
}

impl<R: Read> BlockReader for NpyStream<R> {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        None
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let (size, width) = (self.decode.size, columns.len());
        let mut done = 0;
        while done < samples && self.left > 0 && width > 0 {
            let count = (samples - done).min(4096).min(self.left as usize);
            self.bytes.resize(count * width * size, 0);
            self.source.read_exact(&mut self.bytes).map_err(|e| npy_error(format!("the array breaks off: {e}")))?;
            for (c, column) in columns.iter_mut().enumerate() {
                column.extend(
                    self.bytes
                        .chunks_exact(width * size)
                        .map(|frame| self.decode.value(&frame[c * size..(c + 1) * size])),
                );
            }
            done += count;
            self.left -= count as u64;
        }
        Ok(done)
    }
}
