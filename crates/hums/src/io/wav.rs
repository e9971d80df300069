//! WAV recordings: 8 to 32 bits whole numbers (scaled by `2^-(bits-1)` to -1..1, exact), 32 bits float.

use super::{BlockReader, ReadError, check_columns, numbered};
use hound::{SampleFormat, WavReader};
use std::io::Read;

/// Streaming reader of WAV.
pub struct WavRecording<R> {
    reader: WavReader<R>,
    names: Vec<String>,
    frame: Vec<f64>,
}

impl<R: Read> WavRecording<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// [`ReadError::Format`] when it is not a WAV file of samples.
    pub fn new(source: R) -> Result<Self, ReadError> {
        let reader = WavReader::new(source).map_err(wav_error)?;
        let spec = reader.spec();
        if spec.channels == 0 || !(1..=32).contains(&spec.bits_per_sample) {
            return Err(ReadError::Format {
                format: "WAV",
                reason: format!("{} channels of {} bits", spec.channels, spec.bits_per_sample),
            });
        }
        Ok(Self { names: numbered(spec.channels.into()), frame: Vec::with_capacity(spec.channels.into()), reader })
    }

    fn take<S: hound::Sample>(
        &mut self,
        samples: usize,
        columns: &mut [Vec<f64>],
        value: impl Fn(S) -> f64,
    ) -> Result<usize, ReadError> {
        let width = columns.len();
        let mut count = 0;
        let mut stream = self.reader.samples::<S>();
        while count < samples {
            self.frame.clear();
            for sample in stream.by_ref().take(width) {
                self.frame.push(value(sample.map_err(wav_error)?));
            }
            // An incomplete last frame is dropped.
            if self.frame.len() < width {
                break;
            }
            for (column, x) in columns.iter_mut().zip(&self.frame) {
                column.push(*x);
            }
            count += 1;
        }
        Ok(count)
    }
}

fn wav_error(error: hound::Error) -> ReadError {
    match error {
        hound::Error::IoError(e) => ReadError::Io(e),
        other => ReadError::Format { format: "WAV", reason: other.to_string() },
    }
}

impl<R: Read> BlockReader for WavRecording<R> {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        Some(f64::from(self.reader.spec().sample_rate))
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let spec = self.reader.spec();
        match spec.sample_format {
            SampleFormat::Float => self.take(samples, columns, |x: f32| f64::from(x)),
            SampleFormat::Int => {
                let scale = (-(f64::from(spec.bits_per_sample) - 1.0)).exp2();
                self.take(samples, columns, |x: i32| f64::from(x) * scale)
            }
        }
    }
}
