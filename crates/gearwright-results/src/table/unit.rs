//! Units of columns: the only place where results leave SI units.

use std::f64::consts::PI;

use super::Cell;

/// Unit of a column.
#[derive(Debug, Clone, Copy)]
pub struct Unit {
    /// End of the column's name; empty for none.
    pub suffix: &'static str,
    /// Symbol.
    pub symbol: &'static str,
    from_si: fn(f64) -> f64,
}

impl Unit {
    const fn new(suffix: &'static str, symbol: &'static str, from_si: fn(f64) -> f64) -> Self {
        Self { suffix, symbol, from_si }
    }

    /// A quantity in this unit, from SI.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        (self.from_si)(value)
    }

    /// The same unit for values that are in it already.
    #[must_use]
    pub const fn given(self) -> Self {
        Self { from_si: |value| value, ..self }
    }

    /// A name with the unit at its end.
    #[must_use]
    pub fn joined(&self, name: &str) -> String {
        if self.suffix.is_empty() { name.to_owned() } else { format!("{name}_{}", self.suffix) }
    }

    pub(super) fn convert(&self, cell: Cell) -> Cell {
        match cell {
            Cell::Number(value) => Cell::Number(self.of(value)),
            other => other,
        }
    }
}

macro_rules! units {
    ($($name:ident $suffix:literal $symbol:literal $doc:literal $from_si:expr;)*) => {
        $(#[doc = $doc] pub const $name: Unit = Unit::new($suffix, $symbol, $from_si);)*
    };
}

units! {
    PLAIN "" "" "No unit, or that of the input." |x| x;
    SECOND "s" "s" "Seconds." |x| x;
    HERTZ "hz" "Hz" "Hertz." |x| x;
    METRE "m" "m" "Metres." |x| x;
    MILLIMETRE "mm" "mm" "Millimetres." |x| x * 1e3;
    MICROMETRE "um" "µm" "Micrometres." |x| x * 1e6;
    MILLIMETRE_PER_SECOND "mm_per_s" "mm/s" "Millimetres per second." |x| x * 1e3;
    STANDARD_GRAVITY "g" "g" "Accelerations that are in standard gravities already." |x| x;
    NEWTON "n" "N" "Newtons." |x| x;
    NEWTON_METRE "n_m" "N m" "Newton metres." |x| x;
    NEWTON_PER_MICROMETRE "n_per_um" "N/µm" "Newtons per micrometre." |x| x * 1e-6;
    MEGAPASCAL "mpa" "MPa" "Megapascals." |x| x * 1e-6;
    STRESS_INTENSITY "mpa_sqrt_m" "MPa √m" "Megapascals times square root of metres." |x| x * 1e-6;
    DEGREE "deg" "°" "Degrees." f64::to_degrees;
    RADIAN "rad" "rad" "Radians." |x| x;
    MICRORADIAN "urad" "µrad" "Microradians." |x| x * 1e6;
    REVOLUTIONS_PER_MINUTE "rpm" "rpm" "Revolutions per minute." |x| x * 30.0 / PI;
    PERCENT "percent" "%" "Percent." |x| 100.0 * x;
}
