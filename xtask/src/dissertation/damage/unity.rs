//! Sections 2.2 to 2.4, 3.2.3, 3.2.4.1 and 3.2.5.1: the unity pair.

use fecm::statics::PositionResult;
use gear_geom::{Member, Pit};

use super::scene::{Scene, peak_to_peak};
use crate::dissertation::Findings;

/// Depth of the pits of section 2.3 (m).
const DEPTH: Option<f64> = Some(10e-6);
/// Sizes of the pits in approach and recess (mm).
const SMALL: [(f64, f64); 4] = [(4.0, 0.71), (8.0, 2.32), (12.0, 3.93), (16.0, 7.14)];
/// Sizes of the pits at the pitch point (mm).
const LARGE: [(f64, f64); 4] = [(4.0, 1.43), (8.0, 4.75), (12.0, 8.08), (16.0, 14.72)];

/// Table, centre of the pits, sizes, mesh cycles, printed increases by size and mesh cycle (%).
type Table<'a> = (&'static str, f64, &'a [(f64, f64)], &'a [f64], &'a [&'a [f64]]);

pub fn compare(found: &mut Findings) -> anyhow::Result<()> {
    let scene = Scene::new("unity-pair.toml", 0.8, 2.8, None)?;
    let landmarks = scene.case.pair.landmarks(Member::Pinion);
    let (sap, pitch, eap) = (landmarks.sap.roll_distance, landmarks.pitch.roll_distance, landmarks.eap.roll_distance);
    let (approach, recess) = (0.5 * (sap + pitch), 0.5 * (pitch + eap));
    let tables: [Table; 3] = [
        (
            "Table 2.1",
            pitch,
            &LARGE,
            &[1.4, 1.74, 2.08],
            &[&[0.0, 6.56, 0.0], &[3.03, 22.36, 0.11], &[13.89, 37.32, 12.27], &[33.97, 49.27, 34.49]],
        ),
        ("Table 2.2", approach, &SMALL, &[1.36, 1.62], &[&[2.57, 0.0], &[9.30, 0.0], &[19.00, 19.76], &[39.56, 43.67]]),
        ("Table 2.3", recess, &SMALL, &[1.88, 2.14], &[&[0.0, 2.37], &[0.0, 9.46], &[0.0, 19.15], &[38.59, 39.72]]),
    ];
    for (place, centre, sizes, cycles, printed) in tables {
        for ((width, height), printed) in sizes.iter().zip(printed) {
            let damaged = scene.pitted(scene.pit(centre, *width, *height, DEPTH))?;
            for (cycle, printed) in cycles.iter().zip(*printed) {
                let quantity = format!("pit {width} x {height} mm, STE increase at {cycle} (%)");
                found.number(place, quantity, *printed, scene.increase(&damaged, *cycle));
            }
        }
    }
    peak_to_peak_over_area(found, &scene, &[approach, pitch, recess])?;
    contact_shares(found, &scene);
    irregular_pit(found, &scene)?;
    cracks(found)
}

/// Figure 2.11: sizes between those of the tables, by linear interpolation.
fn peak_to_peak_over_area(found: &mut Findings, scene: &Scene, centres: &[f64; 3]) -> anyhow::Result<()> {
    let landmarks = scene.case.pair.landmarks(Member::Pinion);
    let rolls = [landmarks.sap.roll_distance, landmarks.eap.roll_distance];
    let width = scene.case.pair.pinion().facewidth();
    let curve = |centre: f64, sizes: &[(f64, f64); 4]| -> anyhow::Result<Vec<(f64, f64)>> {
        let mut points = Vec::new();
        for k in 0..=9 {
            let (whole, part) = (k / 3, f64::from(k % 3) / 3.0);
            let (from, to) = (sizes[whole as usize], sizes[(whole as usize + 1).min(3)]);
            let mix = |a: f64, b: f64| a + part * (b - a);
            let pit = scene.pit(centre, mix(from.0, to.0), mix(from.1, to.1), DEPTH);
            let area = 100.0 * pit.area_fraction(width, rolls);
            points.push((area, peak_to_peak(&scene.pitted(pit)?)));
        }
        Ok(points)
    };
    let healthy = peak_to_peak(&scene.healthy);
    for (name, centre, printed) in [("approach", centres[0], 9.2), ("recess", centres[2], 16.0)] {
        let points = curve(centre, &SMALL)?;
        let flat = points.iter().take_while(|(_, value)| *value < 1.005 * healthy).last();
        let quantity = format!("peak-to-peak STE within 0.5 % of healthy up to this area, {name} (%)");
        found.number("Figure 2.11", quantity, printed, flat.map_or(0.0, |p| p.0));
        let beyond: Vec<f64> = points.iter().map(|p| p.1).skip_while(|v| *v < 1.005 * healthy).collect();
        let rises = beyond.windows(2).all(|pair| pair[1] > pair[0]);
        let values =
            format!("{:.2} to {:.2} um", beyond.first().unwrap_or(&healthy), beyond.last().unwrap_or(&healthy));
        found.claim("Figure 2.11", format!("peak-to-peak STE rises beyond, {name}"), values, rises);
    }
    let points = curve(centres[1], &LARGE)?;
    let rises = points.windows(2).all(|pair| pair[1].1 > pair[0].1);
    let values = format!("{:.2} um healthy, {:.2} to {:.2} um", healthy, points[0].1, points[points.len() - 1].1);
    found.claim("Figure 2.11", "peak-to-peak STE rises monotonically, pitch".into(), values, rises);
    Ok(())
}

/// Sections 2.2 and 3.2.3: how much of a mesh cycle two pairs carry.
fn contact_shares(found: &mut Findings, scene: &Scene) {
    let cycle = 50;
    let double = |r: &&PositionResult| r.loaded_pairs().count() > 1;
    let share = 100.0 * scene.healthy.iter().take(cycle).filter(double).count() as f64 / cycle as f64;
    found.number("D2.2", "mesh cycle with two pairs: 0.88 to 1.62 (%)".into(), 74.0, share);
    let claim = "two pairs for more than 80 % of the mesh cycle".into();
    found.claim("D3.2.3", claim, format!("{share:.0} %"), share > 80.0);
}

/// Figure 3.4: its outline is not printed; five ellipses of one's own between HPSTC and EAP, off mid-face.
fn irregular_pit(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let landmarks = scene.case.pair.landmarks(Member::Pinion);
    let Some(hpstc) = landmarks.hpstc else { return Ok(()) };
    let (low, high) = (hpstc.roll_distance, landmarks.eap.roll_distance);
    let at = |part: f64| low + part * (high - low);
    // face position (mm), part of the way from HPSTC to EAP, width and height (mm)
    let ellipses = [
        (-2.0, 0.15, 4.0, 0.8),
        (0.5, 0.25, 5.0, 1.0),
        (2.5, 0.2, 3.0, 0.7),
        (-0.5, 0.35, 3.5, 0.8),
        (1.5, 0.4, 2.5, 0.6),
    ];
    let shapes = ellipses
        .iter()
        .flat_map(|(face, part, width, height)| scene.pit_at(face * 1e-3, at(*part), *width, *height, None).shapes);
    let damaged = scene.pitted(Pit { shapes: shapes.collect(), depth: None })?;
    let (_, first, last) = scene.affected(&damaged);
    // in the figure the pitch point is at 0.75
    let (first, last) = (first - 1.0, last - 1.0);
    let value = format!("{first:.2} to {last:.2}");
    let claim =
        "irregular pit of five ellipses in the recess (outline not printed: our own) felt between 1 and 1.3 only";
    found.claim("Figure 3.4", claim.into(), value, first > 0.9 && last < 1.4);
    Ok(())
}

/// Figure 3.11: 100 N m; the cracks' lengths are not printed.
fn cracks(found: &mut Findings) -> anyhow::Result<()> {
    let scene = Scene::new("unity-pair.toml", 1.75, 2.75, Some(100.0))?;
    // 1.2 of the figure, whose pitch point is taken at 0.75
    let k = scene.at(2.2);
    let width = |results: &[PositionResult], pair: i32| {
        results[k].pairs.iter().find(|p| p.pair == pair).map_or(0.0, |p| p.contact_width * 1e3)
    };
    let place = "D3.2.5.1";
    found.number(place, "contact width at 1.2, healthy (mm)".into(), 0.22, width(&scene.healthy, 0));
    let mut last = [width(&scene.healthy, 0), width(&scene.healthy, 1)];
    let mut shifts = true;
    for (name, fraction, printed) in [("a-b-c, taken as 50 %", 0.5, 0.15), ("a-b-c-d, taken as 80 %", 0.8, 0.09)] {
        let damaged = scene.cracked(0, fraction)?;
        let now = [width(&damaged, 0), width(&damaged, 1)];
        found.number(place, format!("contact width at 1.2, crack {name} (mm)"), printed, now[0]);
        shifts &= now[0] < last[0] && now[1] > last[1];
        last = now;
    }
    let claim = "contact narrows on the cracked tooth and widens on the next with crack length".into();
    found.claim(place, claim, format!("{:.3} and {:.3} mm at 80 %", last[0], last[1]), shifts);
    Ok(())
}
