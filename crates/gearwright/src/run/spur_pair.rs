//! Statics of a spur gear pair.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use fecm::statics::{PairModel, PositionResult, StaticsRequest, StaticsSeries};
use gear_geom::Member;

use crate::output::folder::ResultsFolder;
use crate::output::stress::Stresses;
use crate::output::{damage, geometry, summary, tables};
use crate::plot::statics as figures;
use gearwright_case::SpurPairCase;

use super::{AsObserver, Finished, RunObserver};

/// Runs a spur-pair case into `target`.
///
/// # Errors
/// Model errors, and anything the file system says. Nothing is left at `target` then.
pub fn run(case: &SpurPairCase, target: &Path, observer: &dyn RunObserver) -> anyhow::Result<Finished> {
    let folder = ResultsFolder::create(target)?;
    let mut times = summary::Times::default();
    observer.stage("condensing both gears");
    let model = PairModel::new(&case.pair, &case.options).context("the gears cannot be modelled")?;
    let stats = model.stats();
    times.condensation = stats.condensation_time.as_secs_f64();

    observer.stage("contact over the mesh cycle");
    let request = StaticsRequest {
        mesh_cycles: case.mesh_cycles.clone(),
        torques: vec![case.inputs.load.torque_n_m],
        stiffness_difference: case.inputs.analysis.stiffness_by_differences,
        keep_pressure: true,
    };
    let solved = model.solve(&request, &AsObserver(observer)).context("the contact cannot be solved")?;
    times.contact = solved.time.as_secs_f64();
    let series = solved.results.first().ok_or_else(|| anyhow!("no positions were solved"))?;

    let map = if case.map_torques.is_empty() {
        None
    } else {
        observer.stage("force-deflection map");
        let request = StaticsRequest {
            mesh_cycles: case.mesh_cycles.clone(),
            torques: case.map_torques.clone(),
            stiffness_difference: false,
            keep_pressure: false,
        };
        let map = model.solve(&request, &AsObserver(observer)).context("the force-deflection map cannot be solved")?;
        times.map = map.time.as_secs_f64();
        Some(map)
    };

    let mut damaged = Vec::new();
    for severity in &case.severities {
        observer.stage(&severity.label);
        // derived from the severity before: what a first unsymmetric one had to make anew is shared by the rest
        let before = damaged.last().map_or(&model, |d: &Damaged| &d.model);
        let damaged_model =
            before.with_damage(&severity.damage).with_context(|| format!("{} cannot be modelled", severity.label))?;
        let series = damaged_model
            .solve_from(&request, (&model, &solved), &AsObserver(observer))
            .with_context(|| format!("the contact with {} cannot be solved", severity.label))?;
        times.damage += damaged_model.stats().condensation_time.as_secs_f64() + series.time.as_secs_f64();
        let stresses = read(case, &damaged_model, series.results.first(), &mut times)?;
        damaged.push(Damaged { label: severity.label.clone(), model: damaged_model, series, stresses });
    }

    if observer.is_cancelled() {
        bail!("stopped; nothing was written");
    }
    observer.stage("stresses");
    let stresses = read(case, &model, solved.results.first(), &mut times)?;
    observer.stage("writing results");
    let started = Instant::now();
    let results = summary::results(series, &stresses, case.inputs.analysis.mesh_cycle_origin);
    write_tables(case, &folder, series, &stresses, map.as_ref())?;
    let effects = write_damage(case, &folder, (series, &stresses), &damaged)?;
    if case.inputs.output.vtu {
        write_grids(case, &folder, &model, series)?;
    }
    if case.inputs.output.plots {
        draw(case, &folder, series, &stresses, map.as_ref(), stats.symmetric)?;
    }
    times.output = started.elapsed().as_secs_f64();
    let all: Vec<&StaticsSeries> =
        std::iter::once(&solved).chain(map.as_ref()).chain(damaged.iter().map(|d| &d.series)).collect();
    let whole = summary::Summary {
        program: "gearwright",
        version: env!("CARGO_PKG_VERSION"),
        inputs: &case.inputs,
        geometry: summary::geometry(&case.pair),
        results: results.clone(),
        damage: &effects,
        work: summary::work(&stats, &all),
        time_s: times,
    };
    std::fs::write(folder.file("summary.json"), serde_json::to_string_pretty(&whole)?)?;
    let screen = summary::screen(case, &results, &effects, &stats, &times);
    let unusable = all.iter().flat_map(|s| s.results.iter().flatten()).filter(|r| !r.status.is_usable()).count();
    Ok(Finished { folder: folder.publish()?, screen, unusable })
}

/// One severity, computed.
struct Damaged {
    label: String,
    model: PairModel,
    series: StaticsSeries,
    stresses: Stresses,
}

/// Reads the stresses of a series.
fn read(
    case: &SpurPairCase,
    model: &PairModel,
    series: Option<&Vec<PositionResult>>,
    times: &mut summary::Times,
) -> anyhow::Result<Stresses> {
    let started = Instant::now();
    let series = series.map_or(&[][..], Vec::as_slice);
    let stresses = Stresses::of(model, series, case.inputs.output.root_stress).context("stresses cannot be read")?;
    times.stress += started.elapsed().as_secs_f64();
    Ok(stresses)
}

impl Damaged {
    /// Whether a tooth pair has a damaged tooth.
    fn touches(&self, pair: i32) -> bool {
        let (options, steps) = (self.model.options(), self.model.pairing().tooth_steps());
        (0..2).any(|member| {
            let teeth = i64::from(self.model.pairing().gear(member).teeth());
            let own = i64::from(pair) * i64::from(steps[member]);
            options.damage[member].iter().any(|damage| (own - damage.tooth).rem_euclid(teeth) == 0)
        })
    }

    /// Depth of damage (m) at a place of the pinion's flank, on it or on the flank opposite, of any tooth.
    fn depth_at(&self, face: f64, roll: f64) -> f64 {
        let rolls = [roll, self.model.pairing().pair().partner_roll(Member::Pinion, roll)];
        let of = |member: usize| {
            self.model.options().damage[member].iter().map(move |d| d.damage.depth_at(face, rolls[member]))
        };
        of(0).chain(of(1)).fold(0.0, f64::max)
    }
}

/// Tables, comparison plots and grids of the damaged pairs.
fn write_damage(
    case: &SpurPairCase,
    folder: &ResultsFolder,
    (healthy, sound): (&[PositionResult], &Stresses),
    damaged: &[Damaged],
) -> anyhow::Result<Vec<damage::Effect>> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let solved = || damaged.iter().filter_map(|d| d.series.results.first().map(|series| (d, series.as_slice())));
    let effects: Vec<damage::Effect> = solved()
        .map(|(d, series)| damage::effect(&d.label, healthy, series, (&d.model, &d.stresses), origin))
        .collect();
    let Some((worst, worst_series)) = solved().next_back() else { return Ok(effects) };
    damage::table(&folder.file("damage.csv"), &effects)?;
    for (index, (d, series)) in solved().enumerate() {
        let number = index + 1;
        tables::series(&folder.file(&format!("series_damage_{number}.csv")), series, &d.stresses, origin)?;
        if !d.stresses.tips.is_empty() {
            d.stresses.write_fronts(&folder.file(&format!("crack_front_{number}.csv")), series, origin)?;
        }
    }
    if case.inputs.output.plots {
        let title = case.inputs.title.as_str();
        let named: Vec<(&str, &[PositionResult])> = std::iter::once(("healthy", healthy))
            .chain(solved().map(|(d, series)| (d.label.as_str(), series)))
            .collect();
        let file = |name: &str| folder.file(name);
        let save =
            |chart: crate::plot::Chart, name: &str| chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"));
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
        if let Some(chart) = figures::crack_growth(title, &effects) {
            save(chart, "damage_stress_intensity_by_length")?;
        }
        let largest = |member| sound.largest_root(healthy, member, 0, origin).map(|root| root.stress_mpa);
        if let Some(chart) = figures::root_tension_growth(title, [0, 1].map(largest), &effects) {
            save(chart, "damage_root_stress_by_length")?;
        }
        let heading = format!("Largest pressure on the pinion flank (MPa), {}", worst.label);
        let symmetric = worst.model.stats().symmetric;
        let map = figures::flank_pressure(
            &heading,
            worst_series,
            &case.pair,
            symmetric,
            |pair| worst.touches(pair),
            |face, roll| worst.depth_at(face, roll),
        );
        if let Some(map) = map {
            map.save(&file, "damage_flank_pressure").map_err(|e| anyhow!("plot damage_flank_pressure: {e}"))?;
        }
    }
    if case.inputs.output.vtu
        && let Some(position) = snapshot(case, worst_series)
    {
        let grid = |member: usize| geometry::body(&worst.model, position, member);
        let (pinion, wheel) = rayon::join(|| grid(0), || grid(1));
        pinion?.write(&folder.file("damage_pinion.vtu"))?;
        wheel?.write(&folder.file("damage_gear.vtu"))?;
        geometry::pressure(&worst.model, position.mesh_cycle, &position.patches)
            .write(&folder.file("damage_contact_pressure.vtu"))?;
    }
    Ok(effects)
}

fn write_tables(
    case: &SpurPairCase,
    folder: &ResultsFolder,
    series: &[PositionResult],
    stresses: &Stresses,
    map: Option<&StaticsSeries>,
) -> anyhow::Result<()> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    tables::series(&folder.file("series.csv"), series, stresses, origin)?;
    if let Some(map) = map {
        tables::force_deflection(&folder.file("force_deflection.csv"), &map.results, origin)?;
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
) -> anyhow::Result<()> {
    let Some(position) = snapshot(case, series) else { return Ok(()) };
    let (pinion, wheel) = rayon::join(|| geometry::body(model, position, 0), || geometry::body(model, position, 1));
    pinion?.write(&folder.file("pinion.vtu"))?;
    wheel?.write(&folder.file("gear.vtu"))?;
    geometry::pressure(model, position.mesh_cycle, &position.patches).write(&folder.file("contact_pressure.vtu"))?;
    Ok(())
}

fn draw(
    case: &SpurPairCase,
    folder: &ResultsFolder,
    series: &[PositionResult],
    stresses: &Stresses,
    map: Option<&StaticsSeries>,
    mirrored: bool,
) -> anyhow::Result<()> {
    let origin = case.inputs.analysis.mesh_cycle_origin;
    let title = case.inputs.title.as_str();
    let file = |name: &str| folder.file(name);
    let save = |chart: crate::plot::Chart, name: &str| chart.save(&file, name).map_err(|e| anyhow!("plot {name}: {e}"));
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
        mirrored,
        |_| true,
        |_, _| 0.0,
    ) {
        map.save(&file, "flank_pressure").map_err(|e| anyhow!("plot flank_pressure: {e}"))?;
    }
    if let Some(map) = map {
        save(figures::torque_curves(title, &map.results, origin), "transmission_error_by_torque")?;
        save(figures::force_deflection(title, &map.results, origin), "force_deflection")?;
    }
    Ok(())
}
