//! Figures 5.2 to 5.4, 6.2 and 6.3: the transmission without damage.

use super::*;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::Drawn;
use crate::reproduce::vibration::Vibration;

const EXPERIMENT: &str = "The measured accelerations beside them in the dissertation are of other authors and are not printed as numbers: model part only.";
/// Pairs of planet-pass sidebands that a cluster is shown and judged with.
const CLUSTER: f64 = 8.0;

fn record<'a>(vibration: &'a Vibration, sensor: &str) -> anyhow::Result<&'a [f64]> {
    Ok(&vibration.healthy()?.shown[vibration.sensor(sensor)?])
}

/// Lines about a frequency.
fn cluster(vibration: &Vibration, spectrum: &[(f64, f64)], centre: f64) -> Vec<(f64, f64)> {
    let reach = (CLUSTER + 0.5) * vibration.clock.pass_hz();
    spectrum.iter().copied().filter(|l| (l.0 - centre).abs() <= reach).collect()
}

/// Part of a cluster's power that lies at whole planet-pass frequencies from its centre.
fn at_planet_passes(vibration: &Vibration, cluster: &[(f64, f64)], centre: f64) -> f64 {
    let pass = vibration.clock.pass_hz();
    let whole = |frequency: f64| {
        let orders = (frequency - centre) / pass;
        (orders - orders.round()).abs() < 1e-3
    };
    let power = |lines: &mut dyn Iterator<Item = &(f64, f64)>| lines.map(|l| l.1 * l.1).sum::<f64>();
    power(&mut cluster.iter().filter(|l| whole(l.0))) / power(&mut cluster.iter()).max(f64::MIN_POSITIVE)
}

fn spectrum_values(drawn: &mut Drawn, spectrum: &[(f64, f64)]) {
    let (frequency, amplitude) = largest(spectrum);
    drawn.value("healthy, largest line", amplitude);
    drawn.value("healthy, frequency of the largest line", frequency);
}

fn clusters(
    drawn: &mut Drawn,
    vibration: &Vibration,
    spectrum: &[(f64, f64)],
    panels: &[(&'static str, &str, f64)],
    colour: &'static str,
) {
    let mut worst: f64 = 1.0;
    for (letter, about, centre) in panels {
        let lines = cluster(vibration, spectrum, *centre);
        worst = worst.min(at_planet_passes(vibration, &lines, *centre));
        drawn.panels.push(spectrum_panel(letter, about, vec![solid("", colour, lines)]));
    }
    let found = format!("at least {:.2} % of a cluster's power lies there", 100.0 * worst);
    drawn.claim("sidebands at planet passes", worst > 0.95, found);
}

/// Figure 5.2.
pub fn accelerations(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let points = vibration.clock.over_turns(record(&vibration, INPUT_PORT)?);
    let mut drawn = Drawn::default();
    drawn.panels.push(time_panel(
        "a",
        "Three turns of the carrier, sensor near the input port.",
        vec![solid("", PURPLE, points)],
    ));
    drawn.note(MODEL);
    drawn.note(EXPERIMENT);
    Ok(drawn)
}

/// Figure 5.3.
pub fn spectra(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let spectrum = vibration.clock.spectrum(record(&vibration, INPUT_PORT)?, HIGHEST)?;
    let mut drawn = Drawn::default();
    spectrum_values(&mut drawn, &spectrum);
    drawn.panels.push(spectrum_panel(
        "a",
        "Spectrum, sensor near the input port.",
        vec![solid("", PURPLE, spectrum.clone())],
    ));
    let mesh = vibration.clock.mesh_hz;
    let panels = [
        ("c", "About the mesh frequency of the planetary stage.", mesh),
        ("d", "About its second harmonic.", 2.0 * mesh),
    ];
    clusters(&mut drawn, &vibration, &spectrum, &panels, PURPLE);
    drawn.note(MODEL);
    drawn.note(EXPERIMENT);
    Ok(drawn)
}

/// Figure 5.4.
pub fn near_the_tooth(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(RING)?;
    let record = record(&vibration, RING_TOOTH)?;
    let spectrum = vibration.clock.spectrum(record, HIGHEST)?;
    let mut drawn = Drawn::default();
    spectrum_values(&mut drawn, &spectrum);
    let points = vibration.clock.over_turns(record);
    drawn.panels.push(time_panel(
        "a",
        "Three turns of the carrier, sensor beside the ring tooth to be damaged.",
        vec![solid("", BLACK, points)],
    ));
    drawn.panels.push(spectrum_panel("b", "Its spectrum.", vec![solid("", BLACK, spectrum)]));
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.2.
pub fn stretches(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let record = record(&vibration, INPUT_PORT)?;
    let mut drawn = Drawn::default();
    let third = 1.0 / vibration.clock.planets as f64;
    for (letter, about, to) in [
        ("a", "Three turns of the carrier.", 3.0),
        ("b", "The first planet pass.", third),
        ("c", "The first turn.", 1.0),
    ] {
        let points = over_turns(&vibration.clock, record, (0.0, to));
        drawn.panels.push(time_panel(letter, about, vec![solid("", BLUE, points)]));
    }
    drawn.note(MODEL);
    drawn.note(EXPERIMENT);
    Ok(drawn)
}

/// Figure 6.3.
pub fn stage_spectra(context: &Context) -> anyhow::Result<Drawn> {
    let vibration = context.vibration(SUN)?;
    let spectrum = vibration.clock.spectrum(record(&vibration, INPUT_PORT)?, HIGHEST)?;
    let mut drawn = Drawn::default();
    spectrum_values(&mut drawn, &spectrum);
    drawn.panels.push(spectrum_panel("a", "Spectrum.", vec![solid("", BLUE, spectrum.clone())]));
    let (mesh, bevel) = (vibration.clock.mesh_hz, vibration.clock.bevel_hz);
    let panels = [
        ("b", "About the mesh frequency of the planetary stage.", mesh),
        ("c", "About its second harmonic.", 2.0 * mesh),
        ("d", "About the mesh frequency of the bevel stage.", bevel),
    ];
    clusters(&mut drawn, &vibration, &spectrum, &panels, BLUE);
    drawn.note(MODEL);
    drawn.note(EXPERIMENT);
    Ok(drawn)
}
