//! Tables: columns with name, unit, documentation and value, from which headers, rows, CSV files and the reference of every column follow.
//!
//! Values are in SI units; a [`Unit`] converts them and names them in the column (`ste` in micrometres is `ste_um`). Where one column stands for
//! several, its name has a part in angle brackets (`pair_<pair>_force`), and the table is given the keys that take its place.
//!
//! ```
//! use gearwright_results::table::{HERTZ, MICROMETRE, Table, column};
//!
//! let table = Table::new("peaks", "One row per peak.", vec![
//!     column("frequency", HERTZ, "Where it is.", |peak: &(f64, f64)| peak.0),
//!     column("amplitude", MICROMETRE, "How large it is.", |peak: &(f64, f64)| peak.1),
//! ]);
//! let mut text = Vec::new();
//! table.with([(900.0, 2e-6)].into_iter()).write(&mut text)?;
//! assert_eq!(String::from_utf8(text)?, "frequency_hz,amplitude_um\n9.000000000e2,2.000000000e0\n");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod unit;

use std::io;
use std::path::Path;

use serde::Serialize;

pub use unit::*;

/// Decimals of numbers unless a table says otherwise.
const DECIMALS: usize = 9;

/// One value.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A quantity in SI units.
    Number(f64),
    /// A count or a number of an item.
    Integer(i64),
    /// Words.
    Text(String),
    /// Yes or no.
    Flag(bool),
    /// No value.
    Empty,
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<i32> for Cell {
    fn from(value: i32) -> Self {
        Self::Integer(value.into())
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        i64::try_from(value).map_or(Self::Empty, Self::Integer)
    }
}

impl From<u64> for Cell {
    fn from(value: u64) -> Self {
        i64::try_from(value).map_or(Self::Empty, Self::Integer)
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl From<&str> for Cell {
    fn from(value: &str) -> Self {
        Self::Text(value.to_owned())
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// What one column, or a family of columns, holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnInfo {
    /// Name with unit; a family has a part in angle brackets.
    pub name: String,
    /// Symbol of the unit; empty without one.
    pub unit: &'static str,
    /// Documentation.
    pub text: &'static str,
}

/// Value of a column in a row; the number counts the keys of a family.
type Value<'a, R> = Box<dyn Fn(&R, usize) -> Cell + 'a>;

/// A column of a table of rows `R`.
pub struct Column<'a, R> {
    name: &'static str,
    unit: Unit,
    text: &'static str,
    value: Value<'a, R>,
}

/// A column by name without unit, documentation and value (SI).
pub fn column<'a, R, C: Into<Cell>>(
    name: &'static str,
    unit: Unit,
    text: &'static str,
    value: impl Fn(&R) -> C + 'a,
) -> Column<'a, R> {
    Column { name, unit, text, value: Box::new(move |row, _| value(row).into()) }
}

/// A family of columns: as [`column()`], the value depends on the number of the key as well.
pub fn each<'a, R, C: Into<Cell>>(
    name: &'static str,
    unit: Unit,
    text: &'static str,
    value: impl Fn(&R, usize) -> C + 'a,
) -> Column<'a, R> {
    Column { name, unit, text, value: Box::new(move |row, key| value(row, key).into()) }
}

impl<R> Column<'_, R> {
    fn info(&self) -> ColumnInfo {
        ColumnInfo { name: self.unit.joined(self.name), unit: self.unit.symbol, text: self.text }
    }
}

/// Columns that stand together for every key, or once.
struct Group<'a, R> {
    keys: Option<Vec<String>>,
    columns: Vec<Column<'a, R>>,
}

/// A table of rows `R` without rows.
pub struct Table<'a, R> {
    name: String,
    text: &'static str,
    decimals: Option<usize>,
    groups: Vec<Group<'a, R>>,
}

/// What a table holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableInfo {
    /// Name of its file without ending; a part in angle brackets varies.
    pub name: String,
    /// Documentation.
    pub text: &'static str,
    /// Its columns.
    pub columns: Vec<ColumnInfo>,
}

impl<'a, R: 'a> Table<'a, R> {
    /// A table by the name of its file without ending, documentation and columns.
    #[must_use]
    pub fn new(name: &str, text: &'static str, columns: Vec<Column<'a, R>>) -> Self {
        Self { name: name.into(), text, decimals: Some(DECIMALS), groups: vec![Group { keys: None, columns }] }
    }

    /// Further columns.
    #[must_use]
    pub fn and(mut self, columns: Vec<Column<'a, R>>) -> Self {
        self.groups.push(Group { keys: None, columns });
        self
    }

    /// Further columns that stand together for every key.
    #[must_use]
    pub fn and_each(mut self, keys: Vec<String>, columns: Vec<Column<'a, R>>) -> Self {
        self.groups.push(Group { keys: Some(keys), columns });
        self
    }

    /// Numbers with other decimals; `None`: as many as it takes to read them back to the bit.
    #[must_use]
    pub fn decimals(mut self, decimals: Option<usize>) -> Self {
        self.decimals = decimals;
        self
    }

    /// What it holds.
    #[must_use]
    pub fn info(&self) -> TableInfo {
        let columns = self.groups.iter().flat_map(|group| group.columns.iter().map(Column::info)).collect();
        TableInfo { name: self.name.clone(), text: self.text, columns }
    }

    /// With rows.
    #[must_use]
    pub fn with(self, rows: impl Iterator<Item = R> + 'a) -> FilledTable<'a> {
        let schema = self.info();
        let mut columns = Vec::new();
        for group in &self.groups {
            for key in keys(group) {
                for column in &group.columns {
                    let mut info = column.info();
                    if let Some((_, key)) = key {
                        info.name = in_place(&info.name, key);
                    }
                    columns.push(info);
                }
            }
        }
        let (name, text, decimals, groups) = (self.name, self.text, self.decimals, self.groups);
        let cells = move |row: R| -> Vec<Cell> {
            let mut cells = Vec::new();
            for group in &groups {
                for key in 0..group.keys.as_ref().map_or(1, Vec::len) {
                    for column in &group.columns {
                        cells.push(column.unit.convert((column.value)(&row, key)));
                    }
                }
            }
            cells
        };
        FilledTable { schema, info: TableInfo { name, text, columns }, decimals, rows: Box::new(rows.map(cells)) }
    }
}

fn keys<'g, R>(group: &'g Group<'_, R>) -> Vec<Option<(usize, &'g str)>> {
    match &group.keys {
        None => vec![None],
        Some(keys) => keys.iter().enumerate().map(|(index, key)| Some((index, key.as_str()))).collect(),
    }
}

/// A name whose part in angle brackets, or from the first of them to the last, is replaced.
fn in_place(name: &str, key: &str) -> String {
    match (name.find('<'), name.rfind('>')) {
        (Some(from), Some(to)) if from < to => format!("{}{key}{}", &name[..from], &name[to + 1..]),
        _ => name.to_owned(),
    }
}

/// A table with its rows; quantities are in the units of its columns.
pub struct FilledTable<'a> {
    schema: TableInfo,
    info: TableInfo,
    decimals: Option<usize>,
    rows: Box<dyn Iterator<Item = Vec<Cell>> + 'a>,
}

impl<'a> FilledTable<'a> {
    /// What it holds.
    #[must_use]
    pub fn info(&self) -> &TableInfo {
        &self.info
    }

    /// What it holds, families of columns as one.
    #[must_use]
    pub fn schema(&self) -> &TableInfo {
        &self.schema
    }

    /// Under another name: with something before or behind its own.
    #[must_use]
    pub fn named(mut self, before: &str, behind: &str) -> Self {
        self.info.name = format!("{before}{}{behind}", self.info.name);
        self
    }

    /// Its rows, in the units of its columns.
    pub fn rows(self) -> impl Iterator<Item = Vec<Cell>> + 'a {
        self.rows
    }

    /// Writes it as CSV.
    ///
    /// # Errors
    /// I/O errors.
    pub fn write(self, to: impl io::Write) -> Result<(), csv::Error> {
        let mut table = csv::Writer::from_writer(to);
        table.write_record(self.info.columns.iter().map(|column| &column.name))?;
        for row in self.rows {
            table.write_record(row.into_iter().map(|cell| text(cell, self.decimals)))?;
        }
        table.flush()?;
        Ok(())
    }

    /// Writes its file, `name.csv` in a folder.
    ///
    /// # Errors
    /// I/O errors.
    pub fn save(self, folder: &Path) -> Result<(), csv::Error> {
        let path = folder.join(format!("{}.csv", self.info.name));
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        let file = std::fs::File::create(path)?;
        self.write(file)
    }
}

/// A value as it is written.
fn text(cell: Cell, decimals: Option<usize>) -> String {
    match cell {
        Cell::Number(value) => match decimals {
            Some(decimals) => format!("{value:.decimals$e}"),
            None => format!("{value:?}"),
        },
        Cell::Integer(value) => value.to_string(),
        Cell::Text(text) => text,
        Cell::Flag(flag) => flag.to_string(),
        Cell::Empty => String::new(),
    }
}
