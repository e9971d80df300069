//! Frequencies of the rotorcraft transmission that follow from its tooth numbers.

use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Table};

/// Teeth: bevel pinion, bevel gear, sun, planet, ring.
const TEETH: [f64; 5] = [19.0, 71.0, 27.0, 35.0, 99.0];
const PLANETS: f64 = 3.0;
/// Speed of the bevel pinion (rpm).
const INPUT: f64 = 6060.0;

/// Table 5.1.
pub fn planetary(_: &Context) -> anyhow::Result<Drawn> {
    let [bevel_pinion, bevel_gear, sun, planet, ring] = TEETH;
    let sun_speed = INPUT * bevel_pinion / bevel_gear;
    let carrier = sun_speed * sun / (ring + sun);
    let mesh = (sun_speed - carrier) * sun / 60.0;
    let values = [
        ("bevel mesh frequency", "Hz", INPUT * bevel_pinion / 60.0),
        ("sun speed", "rpm", sun_speed),
        ("sun frequency", "Hz", sun_speed / 60.0),
        ("carrier speed", "rpm", carrier),
        ("carrier frequency", "Hz", carrier / 60.0),
        ("planet-pass speed", "rpm", PLANETS * carrier),
        ("planet-pass frequency", "Hz", PLANETS * carrier / 60.0),
        ("planetary mesh frequency", "Hz", mesh),
        ("mesh cycles per planet pass", "", ring / PLANETS),
        ("mesh cycles per carrier turn", "", ring),
        ("ring and sun teeth over planets", "", (ring + sun) / PLANETS),
        ("mesh cycles per planet turn against the carrier", "", planet),
    ];
    let mut drawn = Drawn::default();
    let mut rows = Vec::new();
    for (name, unit, value) in values {
        drawn.value(name, value);
        rows.push(vec![name.to_owned(), format!("{value:.4}"), unit.to_owned()]);
    }
    drawn.tables.push(Table { head: ["quantity", "computed", "unit"].map(String::from).to_vec(), rows });
    drawn.note("From the printed tooth numbers and input speed alone; the table's dimensions are input of the planetary model, which is not built yet.");
    Ok(drawn)
}
