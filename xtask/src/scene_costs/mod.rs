//! What each kind of scene leaves out and what that saves: the same question asked with and without, in processor time.
//!
//! Processor time of the whole process on all threads (Linux: `/proc/self/stat`), because other work on the machine lengthens wall time. A
//! measurement is repeated until it has taken a second; the table has the mean.

mod transmission;

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;
use fecm::body::{BodyOptions, GearBody};
use fecm::dynamics::{Damping, DynamicsOptions, DynamicsRequest, PairDynamics, RotorInertia, RotorOptions, Support};
use fecm::{FaceModel, PairModel, PairModelOptions, StaticsRequest};
use gear_geom::{Damage, FlankSide, Gear, GearPair, RootCrack, ToothDamage};
use gearwright_case::{self as case, SpurPairCase};

const REPORT: &str = "docs/reports/scene-costs.md";
const POSITIONS: u32 = 20;
const CYCLES: usize = 20;
/// Clock ticks a second in `/proc/self/stat`.
const TICKS: f64 = 100.0;

/// One thing left out.
struct Saving {
    left_out: &'static str,
    when: &'static str,
    /// What was asked with and without it.
    asked: String,
    with: Measured,
    without: Measured,
}

/// Processor time and a result to compare.
struct Measured {
    seconds: f64,
    /// Largest transmission error (um), largest force of a mesh (N), or not comparable.
    error: Option<f64>,
}

/// Measures all scenes and writes the report.
pub fn run() -> anyhow::Result<()> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let case = case::load_spur_pair(&root.join("configs/nonunity-pair.toml"))?;
    let plane = PairModelOptions { face: FaceModel::PlaneStress, ..case.options.clone() };
    let crack = RootCrack::along_chord(FlankSide::Upper, 0.2);
    let cracked = PairModelOptions {
        damage: [vec![ToothDamage { tooth: 0, damage: Damage::Crack(crack) }], vec![]],
        ..case.options.clone()
    };
    let full = statics(&case, &case.pair, &case.options)?;
    let statics_asked = format!("{POSITIONS} positions of a mesh cycle, meshing and condensation included");
    let running = format!("{CYCLES} mesh cycles of 50 steps at 4000 rpm");
    let mut savings = vec![
        Saving {
            left_out: "The third dimension",
            when: "`model = \"plane-stress\"` or `\"plane-strain\"`; nothing may vary along the face",
            asked: statics_asked.clone(),
            with: statics(&case, &case.pair, &case.options)?,
            without: statics(&case, &case.pair, &plane)?,
        },
        Saving {
            left_out: "Half of the face",
            when: "by itself, where flanks and damage are alike on both halves",
            asked: format!("{statics_asked}; with: a lead slope of 1e-15 m breaks the symmetry"),
            with: statics(&case, &sloped(&case.pair)?, &case.options)?,
            without: full,
        },
        Saving {
            left_out: "Teeth that the contact does not reach",
            when: "by itself: coupling between teeth is kept as far as they can share load",
            asked: "compliance of both gears; with: coupling of all teeth".into(),
            with: bodies(&case, None)?,
            without: bodies(&case, Some(case.pair.contact_ratio().ceil() as usize + 1))?,
        },
        Saving {
            left_out: "Cracks",
            when: "by itself, where there are none: a crack adds a sector and an update of the ring",
            asked: format!("{statics_asked}; with: a root crack of 20 %"),
            with: statics(&case, &case.pair, &cracked)?,
            without: statics(&case, &case.pair, &case.options)?,
        },
    ];
    let model = PairModel::new(&case.pair, &dynamic_contact(&case.options))?;
    for (left_out, when, with, without) in [
        (
            "Elastic modes in motion",
            "`elastic_modes = 0`, the default: teeth and rim deform as at rest",
            (30, 1 << 31),
            (0, 1 << 31),
        ),
        (
            "Contact operators of cycles alike",
            "by itself: cycles in which only healthy teeth meet share theirs",
            (0, 1),
            (0, 1 << 31),
        ),
    ] {
        savings.push(Saving {
            left_out,
            when,
            asked: match with.0 {
                0 => format!("{running}; with: operators forgotten"),
                modes => format!("{running}; with: {modes} modes of each gear"),
            },
            with: motion(&case, &model, with)?,
            without: motion(&case, &model, without)?,
        });
    }
    let of_transmissions = transmission::savings()?;
    std::fs::write(root.join(REPORT), report(&savings, &model, &of_transmissions))
        .with_context(|| format!("{REPORT} cannot be written"))?;
    println!("wrote {REPORT}");
    Ok(())
}

fn statics(case: &SpurPairCase, pair: &GearPair, options: &PairModelOptions) -> anyhow::Result<Measured> {
    let request = StaticsRequest::one_cycle(POSITIONS, case.inputs.load.torque_n_m);
    measured(|| {
        let series = PairModel::new(pair, options)?.solve(&request, &())?;
        Ok(series.results[0].iter().map(|r| 1e6 * r.static_transmission_error).reduce(f64::max))
    })
}

/// The pair with a lead slope far too small to matter.
fn sloped(pair: &GearPair) -> anyhow::Result<GearPair> {
    let mut spec = pair.wheel().spec().clone();
    spec.modification.lead_slope = 1e-15;
    Ok(GearPair::new(pair.pinion().clone(), Gear::new(&spec)?, pair.centre_distance())?)
}

fn bodies(case: &SpurPairCase, reach: Option<usize>) -> anyhow::Result<Measured> {
    measured(|| {
        for (gear, member, name) in
            [(case.pair.pinion(), &case.options.pinion, "pinion"), (case.pair.wheel(), &case.options.wheel, "wheel")]
        {
            let options = BodyOptions {
                mesh: member.mesh,
                face: case.options.face,
                width: gear.facewidth(),
                bore: member.bore,
                profile_order: case.options.contact.profile_order,
                edge_correction: case.options.contact.edge_correction,
                reach: reach.unwrap_or((gear.teeth() as usize - 1) / 2),
                antisymmetric: false,
                cracks: Vec::new(),
            };
            GearBody::new(gear, FlankSide::Upper, &member.material, &options, name)?;
        }
        Ok(None)
    })
}

/// The cells along face and profile that motion needs.
fn dynamic_contact(options: &PairModelOptions) -> PairModelOptions {
    let mut options = options.clone();
    (options.contact.cells_per_half_width, options.contact.face_cells) = (4.0, 24);
    options
}

fn motion(case: &SpurPairCase, model: &PairModel, (modes, memory): (usize, usize)) -> anyhow::Result<Measured> {
    let rotor = |mass, polar, rotation| RotorOptions {
        modes,
        ..RotorOptions::on_ideal_bearings(RotorInertia { mass, polar, transverse: 0.5 * polar }, rotation)
    };
    let options = DynamicsOptions {
        operator_memory: memory,
        ..DynamicsOptions::new(
            [rotor(0.7294, 8e-4, Support::Fixed), rotor(0.8537, 0.005, Support::Free)],
            Damping { mass_proportional: 1430.0, stiffness_proportional: 0.0, modal_ratio: 0.01 },
        )
    };
    let request = DynamicsRequest::running(4000.0 * std::f64::consts::PI / 30.0, 50, case.inputs.load.torque_n_m);
    measured(|| {
        let run = PairDynamics::new(model, &options)?.run(&request, 50 * CYCLES, &())?;
        let last = &run.records[run.records.len() - 50..];
        Ok(last.iter().map(|r| 1e6 * r.transmission_error).reduce(f64::max))
    })
}

fn measured(task: impl Fn() -> anyhow::Result<Option<f64>>) -> anyhow::Result<Measured> {
    let (start, mut runs) = (processor_time()?, 0);
    loop {
        let value = task()?;
        runs += 1;
        let spent = processor_time()? - start;
        if spent >= 1.0 {
            return Ok(Measured { seconds: spent / f64::from(runs), error: value });
        }
    }
}

/// Processor time of this process so far (s).
fn processor_time() -> anyhow::Result<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").context("processor time is read from /proc: Linux only")?;
    // after the name in brackets: state is field 3, user and system time are fields 14 and 15
    let fields: Vec<&str> = stat.rsplit(") ").next().unwrap_or_default().split(' ').collect();
    let ticks = |k: usize| fields.get(k - 3).and_then(|f| f.parse::<f64>().ok()).context("/proc/self/stat");
    Ok((ticks(14)? + ticks(15)?) / TICKS)
}

fn report(savings: &[Saving], model: &PairModel, of_transmissions: &[Saving]) -> String {
    let mut out = String::from(
        "# What a scene leaves out, and what that saves\n\n\
         Written by `cargo xtask scene-costs`: the same question with and without. Processor time, all threads together.\n\n\
         ## Pairs of gears\n\n\
         The nonunity pair of `configs/nonunity-pair.toml`. The largest transmission error (in motion: over the last cycle) says what leaving out changes.\n\n",
    );
    rows(&mut out, savings, "largest error", "µm");
    let stats = model.stats();
    let teeth = model.pairing().pair().pinion().teeth();
    let _ = write!(
        out,
        "\nNot in the table because there is no other way to compute here: teeth that are alike are one tooth. Of the pinion, one sector of {} unknowns is\n\
         factored instead of {teeth}, and {} remain on its cuts.\n\n\
         A scene also does without what its case file does not ask for: no force-deflection map, no plots (`output.plots = false`), no ParaView files\n\
         (`output.vtu = false`). Condensations of gears are not kept on disk between runs: at a few tenths of a second there is nothing worth keeping. Mesh tables and housings of transmissions are.\n",
        stats.pinion.sector_unknowns, stats.pinion.cut_unknowns
    );
    out.push_str(
        "\n## Transmissions\n\n\
         The dissertation's transmission (chapter 5) in the default housing. The largest force of a mesh of the planetary stage says what leaving out changes.\n\n",
    );
    rows(&mut out, of_transmissions, "largest force", "N");
    out
}

fn rows(out: &mut String, savings: &[Saving], quantity: &str, unit: &str) {
    let _ = writeln!(
        out,
        "| left out | when | asked | with (s) | without (s) | saves | {quantity} with / without ({unit}) |\n|---|---|---|---|---|---|---|"
    );
    for s in savings {
        let decimals = if unit == "N" { 0 } else { 3 };
        let values = match (s.with.error, s.without.error) {
            (Some(with), Some(without)) => format!("{with:.decimals$} / {without:.decimals$}"),
            _ => String::new(),
        };
        let (with, without) = (s.with.seconds, s.without.seconds);
        let _ = writeln!(
            out,
            "| {} | {} | {} | {with:.3} | {without:.3} | {:.0} % | {values} |",
            s.left_out,
            s.when,
            s.asked,
            100.0 * (1.0 - without / with)
        );
    }
}
