//! Confusion table of the damage classifier over a grid of cracks and pits, without and with noise.

use std::fmt::Write as _;

use anyhow::bail;
use fecm::statics::{PairModel, StaticsRequest};
use gear_geom::{Damage, Member, Pit, ProfileMeasure, RootCrack, ToothDamage};
use gearwright_case::spur_pair::damage::Severity;
use gearwright_case::{self as case, SpurPairCase};
use hums::damage_type::{AFFECTED, CurveFeatures, DamageClassifier, DamageType, SeverityFeature};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::reproduce::root;

const REPORT: &str = "docs/reports/damage-classifier.md";
/// The pair, and the six pits that are the reference.
const CASE: &str = "pitted-pitch.toml";
/// Mesh cycles from the pitch point, and positions in one.
const CYCLES: (f64, f64, f64) = (-1.0, 1.2, 50.0);
/// Severities of the reference cracks: fraction of the chord.
const REFERENCE_CRACKS: [f64; 8] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
/// Severities of the cracks to be told.
const CRACKS: [f64; 9] = [0.05, 0.08, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75];
/// Sizes of the pits to be told (mm): between the reference's, and wider, higher, narrower ones.
const PITS: [(f64, f64); 10] = [
    (4.0, 0.87),
    (9.0, 1.96),
    (14.5, 3.05),
    (18.5, 3.65),
    (24.0, 4.46),
    (20.0, 1.5),
    (8.0, 4.0),
    (28.0, 2.0),
    (12.0, 6.0),
    (30.0, 6.5),
];
/// Shifts of the pits' centre from the pitch point (mm of roll distance).
const SHIFTS: [f64; 4] = [-1.2, 0.0, 0.7, 1.4];
/// Sizes (mm) and shifts of the pits that bound what may be a crack; none of them is to be told.
const BOUNDING_PITS: [(f64, f64); 4] = [(6.0, 1.6), (6.0, 5.0), (23.0, 1.6), (23.0, 5.0)];
const BOUNDING_SHIFTS: [f64; 3] = [-1.8, 0.9, 1.8];
/// Noise, relative to the local value.
const NOISES: [f64; 5] = [0.0, 0.002, 0.005, 0.01, 0.02];
const DRAWS: u64 = 200;

/// A damage whose type and severity are known.
struct Sample {
    name: String,
    damage: DamageType,
    /// Per cent of the chord or of the active flank.
    severity: f64,
    curve: Vec<f64>,
}

/// The healthy pair, to which damage is done.
struct Scene {
    case: SpurPairCase,
    model: PairModel,
}

impl Scene {
    fn new() -> anyhow::Result<Self> {
        let case = case::load_spur_pair(&root().join("configs").join(CASE))?;
        let model = PairModel::new(&case.pair, &case.options)?;
        Ok(Self { case, model })
    }

    /// Transmission error (um).
    fn curve(&self, model: &PairModel) -> anyhow::Result<Vec<f64>> {
        let (from, to, per_cycle) = CYCLES;
        let count = ((to - from) * per_cycle).round() as u32;
        let request = StaticsRequest::new(
            (0..=count).map(|k| from + f64::from(k) / per_cycle).collect::<Vec<_>>(),
            [self.case.inputs.load.torque_n_m],
        );
        let series = model.solve(&request, &())?;
        Ok(series.results.iter().flatten().map(|r| r.static_transmission_error * 1e6).collect())
    }

    /// With damage of tooth 0 of the pinion.
    fn damaged(&self, damage: Damage) -> anyhow::Result<Vec<f64>> {
        self.curve(&self.model.with_damage(&[vec![ToothDamage { tooth: 0, damage }], vec![]])?)
    }

    fn crack(&self, fraction: f64) -> anyhow::Result<Sample> {
        let severity = 100.0 * fraction;
        let crack = RootCrack::along_chord(self.case.pair.working_side(Member::Pinion), fraction);
        let curve = self.damaged(Damage::Crack(crack))?;
        Ok(Sample { name: format!("crack {severity:.0} %"), damage: DamageType::Crack, severity, curve })
    }

    /// A pit, its severity the part of the loaded flank.
    fn pit(&self, name: String, pit: &Pit) -> anyhow::Result<Sample> {
        let landmarks = self.case.pair.landmarks(Member::Pinion);
        let rolls = [landmarks.sap.roll_distance, landmarks.eap.roll_distance];
        let width = self.case.pair.pinion().facewidth().min(self.case.pair.wheel().facewidth());
        let severity = 100.0 * pit.area_fraction(width, rolls);
        Ok(Sample { name, damage: DamageType::Pit, severity, curve: self.damaged(Damage::Pit(pit.clone()))? })
    }

    /// A pit of a size at a distance from the pitch point (mm), its height an arc length.
    fn pit_at(&self, shift: f64, (width, height): (f64, f64)) -> anyhow::Result<Sample> {
        let measure = ProfileMeasure::ArcLength { base_radius: self.case.pair.pinion().base_radius() };
        let roll = self.case.pair.pitch_roll() + shift * 1e-3;
        let pit = Pit::ellipse(0.0, roll, width * 1e-3, height * 1e-3, measure);
        self.pit(format!("pit {width} x {height} mm at {shift:+} mm"), &pit)
    }

    /// The pits of the case file.
    fn reference_pits(&self) -> anyhow::Result<Vec<Sample>> {
        let one = |severity: &Severity| match &severity.damage[0][..] {
            [ToothDamage { damage: Damage::Pit(pit), .. }] => self.pit(severity.label.clone(), pit),
            _ => bail!("configs/{CASE} has other damage than one pit"),
        };
        self.case.severities.iter().map(one).collect()
    }
}

/// Computes the curves and writes the report.
///
/// # Errors
/// The crates', the file system's.
pub fn run() -> anyhow::Result<()> {
    let scene = Scene::new()?;
    let cracks = REFERENCE_CRACKS.iter().map(|&f| scene.crack(f)).collect::<Result<Vec<_>, _>>()?;
    let pits = scene.reference_pits()?;
    let mut bounds = Vec::new();
    for shift in BOUNDING_SHIFTS {
        for size in BOUNDING_PITS {
            bounds.push(scene.pit_at(shift, size)?);
        }
    }
    let mut samples = CRACKS.iter().map(|&f| scene.crack(f)).collect::<Result<Vec<_>, _>>()?;
    for shift in SHIFTS {
        for size in PITS {
            samples.push(scene.pit_at(shift, size)?);
        }
    }
    let healthy = scene.curve(&scene.model)?;
    let step = 1.0 / CYCLES.2;
    let mut text = String::from(TEXT);
    for noise in NOISES {
        let study = Study { healthy: &healthy, step, cracks: &cracks, pits: &pits, bounds: &bounds, samples: &samples };
        section(&mut text, &study, noise)?;
    }
    std::fs::write(root().join(REPORT), text)?;
    println!("written: {REPORT}");
    Ok(())
}

const TEXT: &str = "# Damage type and severity from the transmission error\n\n\
Written by `cargo xtask damage-classifier`. `hums::damage_type` on the nonunity pair (3-D, 424 N m): references from cracks of 10 to 80 % of the chord\n\
and the six pits of Figure 3.9, with twelve pits at other places as bounds of what may be a crack; then cracks and pits of other sizes, shapes and centres than\n\
all of these. Severities of cracks are per cent of the chord, of pits per cent of the active flank. Noise is normal, independent from position to position, relative to the local value; the excess that counts as\n\
affected is then 1 % or three standard deviations, whichever is more, and rises below that count as none.\n";

struct Study<'a> {
    healthy: &'a [f64],
    step: f64,
    cracks: &'a [Sample],
    pits: &'a [Sample],
    bounds: &'a [Sample],
    samples: &'a [Sample],
}

fn section(text: &mut String, study: &Study<'_>, noise: f64) -> anyhow::Result<()> {
    let threshold = AFFECTED.max(3.0 * noise);
    let features = |curve: &[f64]| CurveFeatures::of(study.healthy, curve, study.step, threshold);
    let reference = |samples: &[Sample]| -> Result<Vec<(f64, CurveFeatures)>, hums::HumsError> {
        samples.iter().map(|s| Ok((s.severity, features(&s.curve)?))).collect()
    };
    let classifier = DamageClassifier::new(
        SeverityFeature::PeakRise,
        if noise > 0.0 { threshold } else { 0.0 },
        &reference(study.cracks)?,
        &reference(study.pits)?,
        &study.bounds.iter().map(|sample| features(&sample.curve)).collect::<Result<Vec<_>, _>>()?,
    )?;
    // rows: crack, pit; columns: crack, pit, none
    let mut confusion = [[0_usize; 3]; 2];
    let mut errors = [Vec::new(), Vec::new()];
    let mut rows = String::new();
    let draws = if noise > 0.0 { DRAWS } else { 1 };
    for (index, sample) in study.samples.iter().enumerate() {
        let row = usize::from(sample.damage == DamageType::Pit);
        for draw in 0..draws {
            let curve = noisy(&sample.curve, noise, index as u64 * DRAWS + draw);
            let features = features(&curve)?;
            let diagnosis = classifier.classify(&features)?;
            let column = match diagnosis.damage.map(|d| d.damage) {
                Some(DamageType::Crack) => 0,
                Some(DamageType::Pit) => 1,
                None => 2,
            };
            confusion[row][column] += 1;
            if let Some(found) = diagnosis.damage.filter(|_| column == row) {
                errors[row].push((found.severity - sample.severity).abs());
            }
            if noise == 0.0 {
                let (found, severity) = diagnosis
                    .damage
                    .map_or(("none".to_owned(), 0.0), |d| (format!("{:?}", d.damage).to_lowercase(), d.severity));
                writeln!(
                    rows,
                    "| {} | {:.1} | {:.1} | {:.2} | {:.2} | {found} | {severity:.1} | {:.2} |",
                    sample.name,
                    sample.severity,
                    100.0 * features.peak_rise,
                    features.affected,
                    features.centre,
                    diagnosis.margin
                )?;
            }
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let [crack_error, pit_error] = errors.each_mut().map(median);
    let right = confusion[0][0] + confusion[1][1];
    let all: usize = confusion.iter().flatten().sum();
    writeln!(
        text,
        "\n## Noise {:.1} %\n\n| | said crack | said pit | said none |\n|---|---|---|---|\n| crack | {} | {} | {} |\n| pit | {} | {} | {} |\n\n\
         {:.1} % right; what lies within {:.2} mesh cycles of a crack is called one. Median error of severity where the type is right: cracks {crack_error:.1}, pits {pit_error:.1} percentage points.",
        100.0 * noise,
        confusion[0][0],
        confusion[0][1],
        confusion[0][2],
        confusion[1][0],
        confusion[1][1],
        confusion[1][2],
        100.0 * right as f64 / all as f64,
        classifier.reach(),
    )?;
    println!("noise {noise}: {confusion:?}");
    if !rows.is_empty() {
        write!(
            text,
            "\n| damage | severity (%) | rise of the peak (%) | affected (cycles) | centre (cycles) | said | severity said (%) | margin (cycles) |\n\
             |---|---|---|---|---|---|---|---|\n{rows}"
        )?;
    }
    Ok(())
}

/// Multiplied by normal noise (Box and Muller), the same for the same seed.
fn noisy(curve: &[f64], noise: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let one = |value: &f64| {
        let (u, v) = (1.0 - uniform(), uniform());
        value * (1.0 + noise * (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos())
    };
    curve.iter().map(one).collect()
}
