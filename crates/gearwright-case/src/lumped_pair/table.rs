//! Curves from a CSV table: columns by name, cells checked one by one.

use std::path::Path;

use super::curves::Points;
use super::schema::Table;
use crate::input;

/// Reads the points of a table.
///
/// # Errors
/// Says which column is missing or which cell is no number.
pub fn read(table: &Table, folder: &Path) -> Result<Points, String> {
    let path = folder.join(&table.file);
    let unreadable = |e: csv::Error| format!("{} cannot be read: {e}", path.display());
    let bytes = input::read(&path, input::MAX_TABLE).map_err(|e| unreadable(e.into()))?;
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(&bytes[..]);
    let header = reader.headers().map_err(unreadable)?.clone();
    let column = |name: &str| {
        header.iter().position(|h| h == name).ok_or_else(|| {
            format!("{} has no column \"{name}\"; it has {}", table.file, header.iter().collect::<Vec<_>>().join(", "))
        })
    };
    let columns = [&table.mesh_cycle_column, &table.stiffness_column, &table.ste_column].map(|name| column(name));
    let [cycle, stiffness, error] = columns;
    let (cycle, stiffness, error) = (cycle?, stiffness?, error?);
    let shares: Vec<(i32, usize)> = header
        .iter()
        .enumerate()
        .filter_map(|(index, name)| {
            let pair = name.strip_prefix("pair_")?.strip_suffix("_share")?.parse().ok()?;
            Some((pair, index))
        })
        .collect();
    let mut points = Points::default();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(unreadable)?;
        let number = |column: usize| {
            let cell = record.get(column).unwrap_or_default();
            cell.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
                format!("{}, row {}, column \"{}\": {cell:?} is not a number", table.file, row + 2, &header[column])
            })
        };
        points.mesh_cycle.push(number(cycle)?);
        points.stiffness.push(number(stiffness)? * 1e6);
        points.error.push(number(error)? * 1e-6);
        for &(pair, column) in &shares {
            points.shares.entry(pair).or_default().push(number(column)?);
        }
    }
    Ok(points)
}
