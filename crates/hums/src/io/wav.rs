//! WAV recordings: 8 to 32 bits whole numbers (scaled by `2^-(bits-1)` to -1..1, exact), 32 and 64 bits
//! float; RIFF and, beyond 4 GiB, RF64.
//!
//! Layout: "Multimedia Programming Interface and Data Specifications 1.0" (IBM, Microsoft 1991), its
//! extensible format, and EBU Tech 3306 (RF64). A data chunk whose length was never filled in (0, or all ones:
//! the recorder was switched off) reaches to the end of the file. Decoded here block by block, at memory speed.

use super::{BlockReader, ReadError, check_columns, numbered};
use std::io::Read;

/// Streaming reader of WAV.
pub struct WavRecording<R> {
    source: R,
    rate: f64,
    layout: Layout,
    /// Bytes of samples not yet read; `None`: to the end of the file.
    left: Option<u64>,
    names: Vec<String>,
    bytes: Vec<u8>,
}

/// How one sample is stored, little endian.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Layout {
    /// 8 bits from 0 to 255.
    Unsigned,
    /// 16 bits.
    Short,
    /// 24 bits, in three bytes or in the low three of four.
    Medium(usize),
    /// 32 bits.
    Long,
    /// 32 bits float.
    Float,
    /// 64 bits float.
    Double,
}

impl Layout {
    fn new(tag: u16, bits: u16, bytes: u16) -> Option<Self> {
        match (tag, bits, bytes) {
            (PCM, 8, 1) => Some(Self::Unsigned),
            (PCM, 16, 2) => Some(Self::Short),
            (PCM, 24, 3 | 4) => Some(Self::Medium(bytes.into())),
            (PCM, 32, 4) => Some(Self::Long),
            (FLOAT, 32, 4) => Some(Self::Float),
            (FLOAT, 64, 8) => Some(Self::Double),
            _ => None,
        }
    }

    fn bytes(self) -> usize {
        match self {
            Self::Unsigned => 1,
            Self::Short => 2,
            Self::Medium(bytes) => bytes,
            Self::Long | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// Appends every `stride`-th sample from byte `at` on.
    fn decode(self, frames: &[u8], at: usize, stride: usize, out: &mut Vec<f64>) {
        let width = self.bytes();
        let samples = frames.chunks_exact(stride).map(|frame| &frame[at..at + width]);
        match self {
            Self::Unsigned => out.extend(samples.map(|s| (f64::from(s[0]) - 128.0) / 128.0)),
            Self::Short => out.extend(samples.map(|s| f64::from(i16::from_le_bytes([s[0], s[1]])) / 32_768.0)),
            // The sign comes from the third byte: shifted up, then back.
            Self::Medium(_) => out.extend(
                samples.map(|s| f64::from(i32::from_le_bytes([0, s[0], s[1], s[2]]) >> 8) / f64::from(1_u32 << 23)),
            ),
            Self::Long => out.extend(
                samples.map(|s| f64::from(i32::from_le_bytes([s[0], s[1], s[2], s[3]])) / f64::from(1_u32 << 31)),
            ),
            Self::Float => out.extend(samples.map(|s| f64::from(f32::from_le_bytes([s[0], s[1], s[2], s[3]])))),
            Self::Double => {
                out.extend(samples.map(|s| f64::from_le_bytes([s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7]])))
            }
        }
    }
}

impl<R: Read> WavRecording<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`ReadError::Format`] when it is not a WAV file of samples.
    pub fn new(mut source: R) -> Result<Self, ReadError> {
        let [form, _, kind] = words(&mut source)?;
        if !matches!(&form, b"RIFF" | b"RF64") || &kind != b"WAVE" {
            return Err(wav_error("it does not begin with RIFF and WAVE".into()));
        }
        let (mut format, mut long_data) = (None, None);
        loop {
            let [name, length] = words(&mut source)?;
            let length = u32::from_le_bytes(length);
            match &name {
                b"data" => {
                    let Some(format) = format else {
                        return Err(wav_error("its data come before their format".into()));
                    };
                    let left = match (length, long_data) {
                        (u32::MAX, Some(bytes)) => Some(bytes),
                        (0 | u32::MAX, _) => None,
                        (bytes, _) => Some(bytes.into()),
                    };
                    let Format { rate, channels, layout } = format;
                    return Ok(Self { source, rate, layout, left, names: numbered(channels), bytes: Vec::new() });
                }
                b"fmt " => format = Some(Format::read(&chunk::<R, 40>(&mut source, length)?, length)?),
                b"ds64" => {
                    // The sizes of the file and of the data, 8 bytes each.
                    let sizes = chunk::<R, 16>(&mut source, length)?;
                    long_data = sizes[8..].try_into().ok().map(u64::from_le_bytes);
                }
                _ => drop(chunk::<R, 0>(&mut source, length)?),
            }
        }
    }
}

const PCM: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xfffe;

struct Format {
    rate: f64,
    channels: usize,
    layout: Layout,
}

impl Format {
    fn read(bytes: &[u8; 40], length: u32) -> Result<Self, ReadError> {
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let rate = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]);
        let (channels, align, bits) = (word(2), word(12), word(14));
        let tag = if word(0) == EXTENSIBLE && length >= 40 { word(24) } else { word(0) };
        let width = align.checked_div(channels).unwrap_or(0);
        match Layout::new(tag, bits, width) {
            Some(layout) if rate > 0 && align == channels * width => {
                Ok(Self { rate: rate.into(), channels: channels.into(), layout })
            }
            _ => Err(wav_error(format!(
                "format {tag}, {channels} channels of {bits} bits in {width} bytes, {rate} Hz; known are whole numbers of 8, 16, 24 and 32 bits (format 1) and floats of 32 and 64 bits (format 3)"
            ))),
        }
    }
}

fn words<R: Read, const N: usize>(source: &mut R) -> Result<[[u8; 4]; N], ReadError> {
    let mut words = [[0; 4]; N];
    for word in &mut words {
        source.read_exact(word).map_err(|e| match e.kind() {
            std::io::ErrorKind::UnexpectedEof => wav_error("it ends before its data".into()),
            _ => e.into(),
        })?;
    }
    Ok(words)
}

/// The first `N` bytes of a chunk (zeros beyond its end); the source then stands behind the chunk.
fn chunk<R: Read, const N: usize>(source: &mut R, length: u32) -> Result<[u8; N], ReadError> {
    let mut bytes = [0; N];
    let kept = N.min(length as usize);
    source.read_exact(&mut bytes[..kept])?;
    // Chunks begin at even bytes.
    let rest = u64::from(length) + u64::from(length % 2) - kept as u64;
    std::io::copy(&mut source.by_ref().take(rest), &mut std::io::sink())?;
    Ok(bytes)
}

fn wav_error(reason: String) -> ReadError {
    ReadError::Format { format: "WAV", reason }
}

/// Bytes decoded at a time, so that they stay in the cache.
const PIECE: usize = 1 << 16;

impl<R: Read> BlockReader for WavRecording<R> {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        Some(self.rate)
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let width = self.layout.bytes();
        let stride = width * columns.len();
        let mut count = 0;
        while count < samples {
            let mut here = (samples - count).min((PIECE / stride).max(1)) * stride;
            if let Some(left) = self.left {
                here = here.min(usize::try_from(left).unwrap_or(usize::MAX));
            }
            self.bytes.clear();
            let got = self.source.by_ref().take(here as u64).read_to_end(&mut self.bytes)?;
            if let Some(left) = &mut self.left {
                if got < here {
                    return Err(wav_error(format!("it ends {} bytes early", *left - got as u64)));
                }
                *left -= got as u64;
            }
            // An incomplete last frame is dropped.
            let frames = got / stride;
            if frames == 0 {
                break;
            }
            for (channel, column) in columns.iter_mut().enumerate() {
                self.layout.decode(&self.bytes, channel * width, stride, column);
            }
            count += frames;
        }
        Ok(count)
    }
}
