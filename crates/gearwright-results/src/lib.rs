//! Results of gearwright as data, and what is made of them: tables, summaries, grids.
//!
//! | module | holds |
//! |---|---|
//! | [`statics`] | transmission error, stiffness, pressure, stresses of a pair |
//! | [`lumped`] | responses, sweeps, branches of a lumped-parameter pair |
//! | [`dynamics`] | responses of a finite-element/contact-mechanics pair |
//! | [`transmission`] | vibration of a planetary transmission, its signals and indicators |
//! | [`recording`] | indicators, thresholds, alarms and detection of recordings |
//! | [`table`] | columns: name, unit, documentation, value |
//! | [`vtu`] | grids for ParaView |

pub mod dynamics;
pub mod lumped;
pub mod recording;
pub mod statics;
pub mod table;
pub mod transmission;
pub mod vtu;

use table::TableInfo;

/// Kinds of cases and what the tables of each hold.
#[must_use]
pub fn schemas() -> Vec<(&'static str, Vec<TableInfo>)> {
    vec![
        ("spur-pair", statics::tables::schemas()),
        ("lumped-pair", lumped::tables::schemas()),
        ("dynamics", dynamics::tables::schemas()),
        ("transmission", transmission::tables::schemas()),
    ]
}
