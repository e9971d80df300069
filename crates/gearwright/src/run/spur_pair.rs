//! Statics of a spur gear pair.

use std::path::Path;
use std::time::Instant;

use anyhow::anyhow;
use fecm::statics::{PairModel, PositionResult};
use gearwright_case::SpurPairCase;
use gearwright_plot::{Chart, statics as figures};
use gearwright_results::statics::damage::Effect;
use gearwright_results::statics::{Statics, summary, tables};
use gearwright_store::ResultsFolder;
use gearwright_study::spur_pair::{Computed, compute};
use gearwright_study::{RunObserver, grids};

use super::{Finished, Unusable, save_tables};

/// Runs a spur-pair case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &SpurPairCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let computed = compute(case, observer)?;
    let results = &computed.results;
    observer.stage("writing results");
    let started = Instant::now();
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let extrema = summary::results(results.positions(), &results.stresses, origin);
    let effects = results.effects(origin);
    save_tables(&folder, tables::tables(results, &effects, origin))?;
    write_damage(case, &folder, &computed, &effects)?;
    if case.inputs.output.vtu {
        write_grids(case, &folder, &computed.model, results.positions(), "")?;
    }
    if case.inputs.output.plots {
        draw(case, &folder, results)?;
    }
    let times = summary::Times { output: started.elapsed().as_secs_f64(), ..results.times };
    let whole = summary::Summary {
        program: "gearwright",
        version: env!("CARGO_PKG_VERSION"),
        inputs: &case.inputs,
        notes: &case.notes,
        geometry: summary::geometry(&case.pair),
        results: extrema.clone(),
        damage: &effects,
        work: summary::work(&results.stats, &results.series().collect::<Vec<_>>()),
        time_s: times,
    };
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    let screen = summary::screen(case, &extrema, &effects, &results.stats, &times);
    let (count, total) = results.unusable();
    let unusable = Unusable { count, total, what: "positions" };
    Ok(Finished { folder: folder.publish()?, screen, unusable })
}

/// Comparison plots and grids of the damaged pairs.
fn write_damage(
    case: &SpurPairCase,
    folder: &ResultsFolder,
    computed: &Computed,
    effects: &[Effect],
) -> anyhow::Result<()> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let results = &computed.results;
    let healthy = results.positions();
    let solved = || results.damaged.iter().map(|d| (d, d.positions()));
    let (Some((worst, worst_series)), Some(worst_model)) = (solved().next_back(), computed.damaged.last()) else {
        return Ok(());
    };
    if case.inputs.output.plots {
        let title = case.inputs.title.as_str();
        let named: Vec<(&str, &[PositionResult])> = std::iter::once(("healthy", healthy))
            .chain(solved().map(|(d, series)| (d.label.as_str(), series)))
            .collect();
        let file = |name: &str| folder.file(name);
        let save = |chart: Chart, name: &str| chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"));
        let ste = |r: &PositionResult| Some(r.static_transmission_error * 1e6);
        save(figures::compared(title, "Transmission error (µm)", &named, origin, ste), "damage_transmission_error")?;
        let stiffness = |r: &PositionResult| r.local_stiffness().map(|k| k * 1e-6);
        save(
            figures::compared(title, "Mesh stiffness, local slope (N/µm)", &named, origin, stiffness),
            "damage_mesh_stiffness",
        )?;
        let average = |r: &PositionResult| r.stiffness_average_slope.map(|k| k * 1e-6);
        save(
            figures::compared(title, "Mesh stiffness, average slope (N/µm)", &named, origin, average),
            "damage_average_stiffness",
        )?;
        let factors: Vec<_> = solved()
            .filter(|(d, _)| !d.stresses.tips.is_empty())
            .map(|(d, s)| (d.label.as_str(), s, &d.stresses))
            .collect();
        if !factors.is_empty() {
            save(figures::crack_opening(title, &factors, origin), "damage_stress_intensity")?;
        }
        if let Some(chart) = figures::crack_growth(title, effects) {
            save(chart, "damage_stress_intensity_by_length")?;
        }
        let largest = |member| results.stresses.largest_root(healthy, member, 0, origin).map(|root| root.stress_mpa);
        if let Some(chart) = figures::root_tension_growth(title, [0, 1].map(largest), effects) {
            save(chart, "damage_root_stress_by_length")?;
        }
        let heading = format!("Largest pressure on the pinion flank (MPa), {}", worst.label);
        let map = figures::flank_pressure(
            &heading,
            worst_series,
            &case.pair,
            worst.symmetric,
            |pair| worst.touches(&case.pair, pair),
            |face, roll| worst.depth_at(&case.pair, face, roll),
        );
        if let Some(map) = map {
            map.save(&file, "damage_flank_pressure").map_err(|e| anyhow!("plot damage_flank_pressure: {e}"))?;
        }
    }
    if case.inputs.output.vtu {
        write_grids(case, folder, worst_model, worst_series, "damage_")?;
    }
    Ok(())
}

/// The position to show: the one asked for, or the largest transmission error.
fn snapshot<'a>(case: &SpurPairCase, series: &'a [PositionResult]) -> Option<&'a PositionResult> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    match case.inputs.output.snapshot_mesh_cycle {
        Some(wanted) => {
            let distance = |r: &PositionResult| (r.mesh_cycle + origin - wanted).abs();
            series.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
        }
        None => series.iter().max_by(|a, b| a.static_transmission_error.total_cmp(&b.static_transmission_error)),
    }
}

fn write_grids(
    case: &SpurPairCase,
    folder: &ResultsFolder,
    model: &PairModel,
    series: &[PositionResult],
    prefix: &str,
) -> anyhow::Result<()> {
    let Some(position) = snapshot(case, series) else { return Ok(()) };
    let file = |name: &str| folder.file(&format!("{prefix}{name}.vtu"));
    let (pinion, wheel) = rayon::join(|| grids::body(model, position, 0), || grids::body(model, position, 1));
    pinion?.write(&file("pinion"))?;
    wheel?.write(&file("gear"))?;
    grids::pressure(model, position.mesh_cycle, &position.patches).write(&file("contact_pressure"))?;
    Ok(())
}

fn draw(case: &SpurPairCase, folder: &ResultsFolder, results: &Statics) -> anyhow::Result<()> {
    let (series, stresses) = (results.positions(), &results.stresses);
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let title = case.inputs.title.as_str();
    let file = |name: &str| folder.file(name);
    let save = |chart: Chart, name: &str| chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"));
    save(figures::transmission_error(title, series, origin), "transmission_error")?;
    save(figures::mesh_stiffness(title, series, origin), "mesh_stiffness")?;
    save(figures::per_pair(title, "Force on the tooth pair (N)", series, origin, |p| p.force), "tooth_forces")?;
    save(figures::per_pair(title, "Share of the load", series, origin, |p| p.share), "load_sharing")?;
    save(
        figures::per_pair(title, "Tooth-pair stiffness (N/µm)", series, origin, |p| p.stiffness * 1e-6),
        "tooth_pair_stiffness",
    )?;
    save(figures::per_pair(title, "Peak pressure (MPa)", series, origin, |p| p.peak_pressure * 1e-6), "peak_pressure")?;
    save(figures::per_pair(title, "Contact width (mm)", series, origin, |p| p.contact_width * 1e3), "contact_width")?;
    if !stresses.roots.is_empty() {
        save(figures::root_tension(title, series, stresses, origin), "root_stress")?;
    }
    if let Some(map) = figures::flank_pressure(
        "Largest pressure on the pinion flank (MPa)",
        series,
        &case.pair,
        results.stats.symmetric,
        |_| true,
        |_, _| 0.0,
    ) {
        map.save(&file, "flank_pressure").map_err(|e| anyhow!("plot flank_pressure: {e}"))?;
    }
    if let Some(map) = &results.map {
        save(figures::torque_curves(title, &map.results, origin), "transmission_error_by_torque")?;
        save(figures::force_deflection(title, &map.results, origin), "force_deflection")?;
    }
    Ok(())
}
