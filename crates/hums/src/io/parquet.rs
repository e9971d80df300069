//! Parquet files: columns of numbers, read row group by row group.
//!
//! Channels are the columns of whole numbers, floats, truth values (0 and 1) and times of day (s since 1970); texts, lists, decimals
//! and other columns are left out. A missing value is a gap. A file whose own metadata have a key `fs`, `rate`, .. (as in MAT files)
//! states its sampling rate. Memory is a page of each column.
//!
//! Pages are read by the crate `parquet` of Apache Arrow; compressions: none, Snappy, gzip, LZ4, Zstandard.

use super::{BlockReader, ReadError, check_columns, is_rate_name};
use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What a column's number says.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Meaning {
    /// Itself.
    Number,
    /// Itself, without sign.
    Unsigned,
    /// Times this: a time in s.
    Seconds(f64),
}

/// A column that is a channel.
struct Channel {
    column: usize,
    meaning: Meaning,
    /// Definition level of a value that is there.
    full: i16,
    reader: Option<ColumnReader>,
}

/// Streaming reader of Parquet.
pub struct ParquetRecording<R: ChunkReader> {
    file: SerializedFileReader<R>,
    names: Vec<String>,
    rate: Option<f64>,
    channels: Vec<Channel>,
    /// Row groups begun.
    groups: usize,
    /// Rows of the present group not yet read.
    left: usize,
    bytes: Arc<AtomicU64>,
}

impl<R: ChunkReader + 'static> ParquetRecording<R> {
    /// Reads the footer; adds the sizes of row groups to `bytes` as they are begun.
    ///
    /// # Errors
    /// [`ReadError::Format`] when it is not Parquet or has no column of numbers.
    pub fn new(file: R, bytes: &Arc<AtomicU64>) -> Result<Self, ReadError> {
        let file = guarded(|| SerializedFileReader::new(file)).map_err(|e| fault("its footer", &e))?;
        for (k, group) in file.metadata().row_groups().iter().enumerate() {
            let start =
                |column: &ColumnChunkMetaData| column.dictionary_page_offset().unwrap_or(column.data_page_offset());
            if group.columns().iter().any(|column| start(column) < 0 || column.compressed_size() < 0) {
                return Err(parquet_error(format!("row group {} lies before the start of the file", k + 1)));
            }
        }
        let metadata = file.metadata().file_metadata();
        let (mut names, mut channels) = (Vec::new(), Vec::new());
        for (column, descriptor) in metadata.schema_descr().columns().iter().enumerate() {
            if let Some(meaning) = meaning(descriptor) {
                names.push(descriptor.path().parts().join("."));
                channels.push(Channel { column, meaning, full: descriptor.max_def_level(), reader: None });
            }
        }
        if channels.is_empty() {
            return Err(parquet_error("no column of numbers".into()));
        }
        let stated = metadata.key_value_metadata().into_iter().flatten().filter(|pair| is_rate_name(&pair.key));
        let rate = stated
            .filter_map(|pair| pair.value.as_ref()?.trim().parse().ok())
            .find(|r: &f64| *r > 0.0 && r.is_finite());
        Ok(Self { names, rate, channels, groups: 0, left: 0, bytes: Arc::clone(bytes), file })
    }

    /// Begins the next row group; `false` when there is none.
    fn next_group(&mut self) -> Result<bool, ReadError> {
        if self.groups >= self.file.num_row_groups() {
            return Ok(false);
        }
        let whole = |e| fault(&format!("row group {}", self.groups + 1), &e);
        let group = self.file.get_row_group(self.groups).map_err(whole)?;
        let metadata = group.metadata();
        self.left = usize::try_from(metadata.num_rows())
            .map_err(|_| parquet_error(format!("row group {} has {} rows", self.groups + 1, metadata.num_rows())))?;
        let size = u64::try_from(metadata.compressed_size()).unwrap_or(0);
        for channel in &mut self.channels {
            let reader = guarded(|| group.get_column_reader(channel.column));
            channel.reader = Some(reader.map_err(whole)?);
        }
        self.bytes.fetch_add(size, Ordering::Relaxed);
        self.groups += 1;
        Ok(true)
    }
}

fn parquet_error(reason: String) -> ReadError {
    ReadError::Format { format: "Parquet", reason }
}

/// The decoder panics on some damaged files; here that is an error like others.
fn guarded<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, ParquetError> {
    std::panic::catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(ParquetError::General("the file is damaged: its decoder gave up".into())))
}

fn fault(place: &str, error: &ParquetError) -> ReadError {
    parquet_error(format!("{place}: {error}"))
}

/// `None` for a column that is no channel.
fn meaning(column: &ColumnDescriptor) -> Option<Meaning> {
    if column.max_rep_level() > 0 {
        return None;
    }
    let unit = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    };
    let whole = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Integer(kind)), _) if !kind.is_signed => Some(Meaning::Unsigned),
        (Some(LogicalType::Integer(_)), _) => Some(Meaning::Number),
        (Some(LogicalType::Timestamp(kind)), _) => Some(Meaning::Seconds(unit(&kind.unit))),
        (Some(LogicalType::Time(kind)), _) => Some(Meaning::Seconds(unit(&kind.unit))),
        (Some(_), _) => None,
        (None, ConvertedType::UINT_8 | ConvertedType::UINT_16 | ConvertedType::UINT_32 | ConvertedType::UINT_64) => {
            Some(Meaning::Unsigned)
        }
        (None, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) => Some(Meaning::Seconds(1e-3)),
        (None, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) => Some(Meaning::Seconds(1e-6)),
        (None, ConvertedType::DECIMAL | ConvertedType::DATE) => None,
        (None, _) => Some(Meaning::Number),
    };
    match column.physical_type() {
        Type::INT32 | Type::INT64 => whole,
        Type::FLOAT | Type::DOUBLE | Type::BOOLEAN => Some(Meaning::Number),
        Type::INT96 | Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY => None,
    }
}

impl Channel {
    /// Appends `rows` values.
    fn read(&mut self, rows: usize, out: &mut Vec<f64>) -> Result<usize, ParquetError> {
        let (meaning, full) = (self.meaning, self.full);
        match &mut self.reader {
            Some(ColumnReader::BoolColumnReader(r)) => take(r, rows, full, out, |x| f64::from(u8::from(x))),
            Some(ColumnReader::FloatColumnReader(r)) => take(r, rows, full, out, f64::from),
            Some(ColumnReader::DoubleColumnReader(r)) => take(r, rows, full, out, |x| x),
            Some(ColumnReader::Int32ColumnReader(r)) => take(r, rows, full, out, |x| match meaning {
                Meaning::Number => x.into(),
                Meaning::Unsigned => x.cast_unsigned().into(),
                Meaning::Seconds(unit) => f64::from(x) * unit,
            }),
            Some(ColumnReader::Int64ColumnReader(r)) => take(r, rows, full, out, |x| match meaning {
                Meaning::Number => x as f64,
                Meaning::Unsigned => x.cast_unsigned() as f64,
                Meaning::Seconds(unit) => x as f64 * unit,
            }),
            _ => Ok(0),
        }
    }
}

fn take<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    full: i16,
    out: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<usize, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let (records, found, _) = reader.read_records(rows, Some(&mut levels), None, &mut values)?;
    if found == records {
        out.extend(values.into_iter().map(number));
    } else {
        let mut values = values.into_iter().map(number);
        out.extend(
            levels.iter().map(|level| if *level == full { values.next().unwrap_or(f64::NAN) } else { f64::NAN }),
        );
    }
    Ok(records)
}

impl<R: ChunkReader + 'static> BlockReader for ParquetRecording<R> {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        self.rate
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let mut done = 0;
        while done < samples {
            if self.left == 0 {
                if self.next_group()? {
                    continue;
                }
                break;
            }
            let here = self.left.min(samples - done);
            for ((channel, name), out) in self.channels.iter_mut().zip(&self.names).zip(columns.iter_mut()) {
                let place = || format!("row group {}, column \"{name}\"", self.groups);
                let before = out.len();
                let records = guarded(|| channel.read(here, out)).map_err(|e| fault(&place(), &e))?;
                if records != here || out.len() - before != here {
                    return Err(parquet_error(format!("{} ends {} rows early", place(), here - records.min(here))));
                }
            }
            self.left -= here;
            done += here;
        }
        Ok(done)
    }
}
