//! CSV, TSV and other columns of text, streamed.
//!
//! Layout is found from the first lines: data begin at the first line that splits into numbers
//! and is followed by a line of as many columns that is not all text. Of tab, semicolon, comma and blanks, and of
//! decimal point and comma, the first pair that gives most columns wins, so `1,5;2,5` is two columns and
//! `1,5` alone is two, too (state [`TextOptions::decimal_comma`] for a single column). Names come from the last
//! header line with as many cells, or the one before when that one holds units.
//!
//! Blank lines and comments (`#`, `%`, `//`, `!`) are passed over anywhere. Empty cells and `nan`, `na`,
//! `n/a`, `null`, `none`, `inf`, `-` are missing values: NaN. Quotes about cells are taken off. Memory: one
//! buffer of 1 MiB, grown to the longest line, which may have 64 MiB.

use super::number;
use super::{BlockReader, ReadError, check_columns, numbered};
use std::io::Read;

const BUFFER: usize = 1 << 20;
const LONGEST_LINE: usize = 64 << 20;
/// Bytes in which the data must begin.
const HEADER_LIMIT: usize = 1 << 18;

/// What is known about a text file; `None` is found out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TextOptions {
    /// Delimiter; a blank stands for any run of blanks and tabs.
    pub delimiter: Option<u8>,
    /// Numbers have a decimal comma.
    pub decimal_comma: Option<bool>,
    /// Lines before the data (names are taken from the last of them).
    pub header_lines: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Format {
    delimiter: u8,
    decimal: u8,
}

/// Streaming reader of text.
#[derive(Debug)]
pub struct TextReader<R> {
    source: R,
    buffer: Vec<u8>,
    /// Unread bytes are `buffer[start..end]`.
    start: usize,
    end: usize,
    ended: bool,
    /// Number of the line at `start`, from 1.
    line: u64,
    format: Format,
    names: Vec<String>,
    row: Vec<f64>,
}

impl<R: Read> TextReader<R> {
    /// Finds the layout and stops before the first data line.
    ///
    /// # Errors
    /// [`ReadError::Format`] when no data are found within the first 256 KiB; reading failed.
    pub fn new(source: R, options: &TextOptions) -> Result<Self, ReadError> {
        let mut reader = Self {
            source,
            buffer: vec![0; BUFFER],
            start: 0,
            end: 0,
            ended: false,
            line: 1,
            format: Format { delimiter: b',', decimal: b'.' },
            names: Vec::new(),
            row: Vec::new(),
        };
        while !reader.ended && reader.end < HEADER_LIMIT {
            reader.fill()?;
        }
        let head = &reader.buffer[..reader.end];
        if head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) {
            return Err(format_error("the text is UTF-16; save it as UTF-8"));
        }
        let skip = if head.starts_with(&[0xef, 0xbb, 0xbf]) { 3 } else { 0 };
        let layout = find_layout(&head[skip..], reader.ended, options)
            .ok_or_else(|| format_error("no line of numbers in the first 256 KiB"))?;
        reader.start = skip + layout.offset;
        reader.line = layout.line;
        reader.format = layout.format;
        reader.names = layout.names;
        Ok(reader)
    }

    /// Moves unread bytes to the front and reads more.
    fn fill(&mut self) -> Result<(), ReadError> {
        if self.start > 0 {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
        }
        if self.end == self.buffer.len() {
            if self.buffer.len() >= LONGEST_LINE {
                return Err(format_error("a line is longer than 64 MiB"));
            }
            self.buffer.resize(2 * self.buffer.len(), 0);
        }
        match self.source.read(&mut self.buffer[self.end..]) {
            Ok(0) => self.ended = true,
            Ok(count) => self.end += count,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e.into()),
        }
        Ok(())
    }

    /// Range of the next line without its end, and the start of the one after it.
    fn next_line(&mut self) -> Result<Option<(usize, usize, usize)>, ReadError> {
        let mut searched = 0;
        loop {
            let unread = &self.buffer[self.start..self.end];
            if let Some(i) = memchr::memchr(b'\n', &unread[searched..]) {
                let stop = self.start + searched + i;
                return Ok(Some((self.start, stop, stop + 1)));
            }
            searched = unread.len();
            if self.ended {
                return Ok((searched > 0).then_some((self.start, self.end, self.end)));
            }
            self.fill()?;
        }
    }
}

impl<R: Read> BlockReader for TextReader<R> {
    fn channels(&self) -> &[String] {
        &self.names
    }

    fn rate(&self) -> Option<f64> {
        None
    }

    fn read_block(&mut self, samples: usize, columns: &mut [Vec<f64>]) -> Result<usize, ReadError> {
        check_columns(self.names.len(), columns)?;
        let mut count = 0;
        while count < samples {
            let Some((from, to, next)) = self.next_line()? else {
                break;
            };
            let line = strip_cr(&self.buffer[from..to]);
            let width = columns.len();
            if fast_row(line, self.format, width, &mut self.row)
                || slow_row(line, self.format, width, self.line, &mut self.row)?
            {
                for (column, x) in columns.iter_mut().zip(&self.row) {
                    column.push(*x);
                }
                count += 1;
            }
            self.start = next;
            self.line += 1;
        }
        Ok(count)
    }
}

fn format_error(reason: &str) -> ReadError {
    ReadError::Format { format: "text", reason: reason.into() }
}

fn strip_cr(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

/// A line of plain numbers; `false` sends it to [`slow_row`].
#[inline]
fn fast_row(line: &[u8], format: Format, width: usize, row: &mut Vec<f64>) -> bool {
    row.clear();
    let mut at = 0;
    for column in 0..width {
        while line.get(at) == Some(&b' ') {
            at += 1;
        }
        let Some((value, length)) = number::parse(&line[at..], format.decimal) else {
            return false;
        };
        row.push(value);
        at += length;
        if column + 1 < width {
            if line.get(at) != Some(&format.delimiter) {
                return false;
            }
            at += 1;
        }
    }
    at == line.len()
}

/// Any line: `Ok(false)` for blanks and comments.
fn slow_row(line: &[u8], format: Format, width: usize, number: u64, row: &mut Vec<f64>) -> Result<bool, ReadError> {
    row.clear();
    if is_blank(line) || comment(line).is_some() {
        return Ok(false);
    }
    let mut cells = split(line, format.delimiter);
    // A delimiter at the end of the line makes an empty cell that is no column.
    if cells.len() == width + 1 && cells.last().is_some_and(|c| c.is_empty()) {
        cells.pop();
    }
    if cells.len() != width {
        return Err(ReadError::Row { line: number, found: cells.len(), expected: width });
    }
    for (i, cell) in cells.iter().enumerate() {
        let Some(value) = cell_value(cell, format.decimal) else {
            let text = String::from_utf8_lossy(cell).chars().take(40).collect();
            return Err(ReadError::Cell { line: number, column: i + 1, text });
        };
        row.push(value);
    }
    Ok(true)
}

fn is_blank(line: &[u8]) -> bool {
    line.iter().all(u8::is_ascii_whitespace)
}

/// What follows a comment mark.
fn comment(line: &[u8]) -> Option<&[u8]> {
    let line = line.trim_ascii_start();
    line.strip_prefix(b"//")
        .or_else(|| line.strip_prefix(b"#"))
        .or_else(|| line.strip_prefix(b"%"))
        .or_else(|| line.strip_prefix(b"!"))
}

fn split(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
    let trim = |cell: &'_ [u8]| -> std::ops::Range<usize> {
        let front = cell.len() - cell.trim_ascii_start().len();
        front..front + cell.trim_ascii().len()
    };
    let unquote = |cell| {
        let bare: &[u8] = cell;
        let bare = &bare[trim(bare)];
        bare.strip_prefix(b"\"").and_then(|c| c.strip_suffix(b"\"")).map_or(bare, <[u8]>::trim_ascii)
    };
    if delimiter == b' ' {
        let words = line.split(u8::is_ascii_whitespace);
        return words.filter(|w| !w.is_empty()).map(unquote).collect();
    }
    line.split(|b| *b == delimiter).map(unquote).collect()
}

/// A number, NaN for a missing value, `None` for anything else.
fn cell_value(cell: &[u8], decimal: u8) -> Option<f64> {
    if let Some((value, length)) = number::parse(cell, decimal)
        && length == cell.len()
    {
        return Some(value);
    }
    let bare = cell.strip_prefix(b"-").unwrap_or(cell);
    let missing: [&[u8]; 9] = [b"", b"nan", b"na", b"n/a", b"null", b"none", b"inf", b"infinity", b"1.#qnan"];
    missing.iter().any(|word| bare.eq_ignore_ascii_case(word)).then_some(f64::NAN)
}

struct Layout {
    offset: usize,
    line: u64,
    format: Format,
    names: Vec<String>,
}

/// Columns of a data line, if it is one: numbers and missing values, one number at least.
fn data_width(line: &[u8], format: Format) -> Option<usize> {
    if is_blank(line) || comment(line).is_some() {
        return None;
    }
    let mut cells = split(line, format.delimiter);
    if cells.len() > 1 && cells.last().is_some_and(|c| c.is_empty()) {
        cells.pop();
    }
    let values: Option<Vec<f64>> = cells.iter().map(|c| cell_value(c, format.decimal)).collect();
    values.filter(|v| v.iter().any(|x| x.is_finite())).map(|v| v.len())
}

/// Whether a line can be the second data line: as many cells, not all of them text. One bad cell
/// must be reported later, not make a header of the lines before it.
fn may_follow(line: &[u8], format: Format, width: usize) -> bool {
    let cells = split(line, format.delimiter);
    let dangling = cells.len() == width + 1 && cells.last().is_some_and(|c| c.is_empty());
    (cells.len() == width || dangling) && cells[..width].iter().any(|c| cell_value(c, format.decimal).is_some())
}

fn find_layout(head: &[u8], complete: bool, options: &TextOptions) -> Option<Layout> {
    // (offset, line) of every line; the last is cut off unless the file ends there.
    let mut lines = Vec::new();
    let mut at = 0;
    while at < head.len() {
        let stop = memchr::memchr(b'\n', &head[at..]).map(|i| at + i);
        match stop {
            Some(stop) => {
                lines.push((at, strip_cr(&head[at..stop])));
                at = stop + 1;
            }
            None => {
                if complete {
                    lines.push((at, strip_cr(&head[at..])));
                }
                break;
            }
        }
    }
    let formats: Vec<Format> = [b'\t', b';', b',', b' ']
        .into_iter()
        .flat_map(|delimiter| [b'.', b','].map(|decimal| Format { delimiter, decimal }))
        .filter(|f| f.delimiter != f.decimal)
        .filter(|f| options.delimiter.is_none_or(|d| d == f.delimiter))
        .filter(|f| options.decimal_comma.is_none_or(|c| c == (f.decimal == b',')))
        .chain(options.delimiter.map(|delimiter| Format {
            delimiter,
            decimal: if options.decimal_comma == Some(true) { b',' } else { b'.' },
        }))
        .collect();
    let first = options.header_lines.unwrap_or(0);
    for (i, (offset, line)) in lines.iter().enumerate().skip(first) {
        let mut best: Option<(usize, Format)> = None;
        for format in &formats {
            if let Some(width) = data_width(line, *format)
                && best.is_none_or(|(most, _)| width > most)
            {
                best = Some((width, *format));
            }
        }
        let Some((width, format)) = best else {
            continue;
        };
        let next = lines[i + 1..].iter().find(|(_, l)| !is_blank(l) && comment(l).is_none());
        if next.is_some_and(|(_, l)| !may_follow(l, format, width)) {
            continue;
        }
        let header: Vec<&[u8]> = lines[..i].iter().map(|(_, l)| *l).collect();
        return Some(Layout { offset: *offset, line: i as u64 + 1, format, names: names(&header, format, width) });
    }
    None
}

fn names(header: &[&[u8]], format: Format, width: usize) -> Vec<String> {
    let cells = |line: &[u8]| -> Option<Vec<String>> {
        // A lone comment is prose, not the name of a lone column.
        let line = match comment(line) {
            Some(_) if width == 1 => return None,
            Some(rest) => rest,
            None => line,
        };
        let mut cells = split(line, format.delimiter);
        if cells.len() == width + 1 && cells.last().is_some_and(|c| c.is_empty()) {
            cells.pop();
        }
        let full = cells.len() == width && cells.iter().any(|c| !c.is_empty());
        full.then(|| cells.iter().map(|c| String::from_utf8_lossy(c).into_owned()).collect())
    };
    let mut candidates = header.iter().rev().filter(|l| !is_blank(l)).map(|l| cells(l));
    let last = candidates.next().flatten();
    let chosen = match last {
        Some(line) if line.iter().all(|c| is_unit(c)) => candidates.next().flatten().unwrap_or(line),
        Some(line) => line,
        None => return numbered(width),
    };
    chosen
        .into_iter()
        .enumerate()
        .map(|(i, name)| if name.is_empty() { format!("channel {}", i + 1) } else { name })
        .collect()
}

fn is_unit(cell: &str) -> bool {
    let bracketed = (cell.starts_with('[') && cell.ends_with(']')) || (cell.starts_with('(') && cell.ends_with(')'));
    let units = [
        "", "-", "s", "ms", "us", "g", "v", "mv", "m/s2", "m/s^2", "mm/s", "m/s", "hz", "rpm", "1/min", "um", "mm",
        "m", "n", "nm", "deg", "rad", "pa", "bar", "degc",
    ];
    bracketed || units.contains(&cell.to_ascii_lowercase().as_str())
}
