//! Frequencies of the rotorcraft transmission that follow from its tooth numbers.

use std::f64::consts::TAU;

use anyhow::Context as _;

use super::transmission::RING;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Table};

/// Table 5.1.
pub fn planetary(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.transmission(RING)?;
    let (train, speeds) = (&case.train, case.speeds);
    let bevel = case.bevel_mesh_frequency().context("the case has no bevel stage")?;
    let (planets, gears) = (train.planets() as f64, train.spec());
    let [sun, planet, ring] = [&gears.sun, &gears.planet, &gears.ring].map(|gear| f64::from(gear.teeth()));
    let rpm = |speed: f64| speed * 60.0 / TAU;
    let values = [
        ("bevel mesh frequency", "Hz", bevel),
        ("sun speed", "rpm", rpm(speeds.sun)),
        ("sun frequency", "Hz", speeds.sun / TAU),
        ("carrier speed", "rpm", rpm(speeds.carrier)),
        ("carrier frequency", "Hz", speeds.carrier / TAU),
        ("planet-pass speed", "rpm", 60.0 * speeds.planet_pass_frequency),
        ("planet-pass frequency", "Hz", speeds.planet_pass_frequency),
        ("planetary mesh frequency", "Hz", speeds.mesh_frequency),
        ("mesh cycles per planet pass", "", ring / planets),
        ("mesh cycles per carrier turn", "", ring),
        ("ring and sun teeth over planets", "", (ring + sun) / planets),
        ("mesh cycles per planet turn against the carrier", "", planet),
        ("carrier turns until the same tooth of sun and ring meet", "", train.sun_ring_period() as f64),
        ("carrier turns until all teeth meet again", "", train.hunting_period() as f64),
    ];
    let mut drawn = Drawn::default();
    let mut rows = Vec::new();
    for (name, unit, value) in values {
        drawn.value(name, value);
        rows.push(vec![name.to_owned(), format!("{value:.4}"), unit.to_owned()]);
    }
    drawn.tables.push(Table { head: ["quantity", "computed", "unit"].map(String::from).to_vec(), rows });
    Ok(drawn)
}
