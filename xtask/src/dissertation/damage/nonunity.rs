//! Sections 3.2.2 (modified pair), 3.2.4.2, 3.2.5.2 and 3.3 (unmodified pair).

use fecm::statics::PositionResult;
use gear_geom::{Member, Pit, ProfileMeasure};

use super::scene::{Scene, largest, least};
use crate::dissertation::Findings;

/// Width of the pits of sections 3.2.4.2.1 and .2 (m).
const WIDTH: f64 = 9.525e-3;

pub fn compare_modified(found: &mut Findings) -> anyhow::Result<()> {
    let scene = Scene::new("nonunity-pair-modified.toml", 0.0, 2.0, None)?;
    let mut add =
        |quantity: &str, printed: f64, computed: f64| found.number("D3.2.2", quantity.into(), printed, computed);
    let average = |r: &PositionResult| r.stiffness_average_slope;
    let cracked = scene.cracked(0, 0.5)?;
    add("50 % crack, STE increase at 0.4 (%)", 3.74, scene.increase(&cracked, 0.4));
    add("50 % crack, STE increase at 0.78 (%)", 17.89, scene.increase(&cracked, 0.78));
    add("average-slope stiffness, healthy, least (N/um)", 291.53, least(&scene.healthy, average));
    add("average-slope stiffness, 50 % crack, least (N/um)", 232.97, least(&cracked, average));
    let pitted = scene.pitted(scene.pit(scene.case.pair.pitch_roll(), 12.7, 2.76, None))?;
    let worst = (0..pitted.len()).map(|k| scene.increase(&pitted, scene.cycles[k] + scene.origin)).fold(0.0, f64::max);
    add("pit 12.7 x 2.76 mm, largest STE increase (%)", 43.55, worst);
    add("average-slope stiffness, pit, at 0.72 (N/um)", 246.53, average(&pitted[scene.at(0.72)]).unwrap_or(0.0) * 1e-6);
    Ok(())
}

pub fn compare(found: &mut Findings) -> anyhow::Result<()> {
    let scene = Scene::new("nonunity-pair.toml", 0.0, 2.0, None)?;
    found.number("D3.2.4.2.3", "healthy, largest STE (um)".into(), 18.2583, largest(&scene.healthy));
    growing_lengths(found, &scene)?;
    pitch_pits(found, &scene)?;
    edge_pits(found, &scene)?;
    cracks(found, &scene)?;
    severities(found, &scene)
}

/// Sections 3.2.4.2.1 and .2: lengths in roll distance, fractions of a region of single or double contact.
fn growing_lengths(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let landmarks = scene.case.pair.landmarks(Member::Pinion);
    let (Some(low), Some(high)) = (landmarks.lpstc, landmarks.hpstc) else { return Ok(()) };
    let [sap, low, high, eap] = [landmarks.sap, low, high, landmarks.eap].map(|l| l.roll_distance);
    let pitted = |ends: [f64; 2], fraction: f64| {
        let (centre, length) = (0.5 * (ends[0] + ends[1]), fraction * (ends[1] - ends[0]));
        scene.pitted(Pit::ellipse(0.0, centre, WIDTH, length, ProfileMeasure::RollDistance))
    };
    let local = |r: &PositionResult| r.stiffness_local_slope;
    let saturated = pitted([low, high], 0.7)?;
    let rise = 100.0 * (largest(&saturated) / largest(&scene.healthy) - 1.0);
    let drop = 100.0 * (1.0 - least(&saturated, local) / least(&scene.healthy, local));
    found.number("D3.2.4.2.1", "pit of 70 % of single contact, increase of the largest STE (%)".into(), 15.92, rise);
    found.number("D3.2.4.2.1", "the same, decrease of the least stiffness (%)".into(), 15.35, drop);
    // place, region, mesh cycle where it is read (none: the largest), length of saturation
    let cases = [
        ("D3.2.4.2.1", "single contact", [low, high], None, 0.7),
        ("D3.2.4.2.2", "approach, at 0.35", [sap, low], Some(0.35), 0.6),
        ("D3.2.4.2.2", "recess, at 1.34", [high, eap], Some(1.34), 0.6),
    ];
    for (place, region, ends, cycle, saturation) in cases {
        let effect = |fraction: f64| -> anyhow::Result<f64> {
            let damaged = pitted(ends, fraction)?;
            Ok(match cycle {
                Some(cycle) => scene.increase(&damaged, cycle),
                None => 100.0 * (largest(&damaged) / largest(&scene.healthy) - 1.0),
            })
        };
        let [first, half, whole] = [effect(0.2)?, effect(saturation)?, effect(1.0)?];
        let claim = format!("{region}: STE rises up to {:.0} % length and no more", 100.0 * saturation);
        let value = format!("{first:.2} % at 20 %, {half:.2} % there, {whole:.2} % at 100 %");
        found.claim(place, claim, value, half > 1.5 * first && (whole - half).abs() < 0.15 * half);
    }
    Ok(())
}

/// Section 3.2.4.2.3: the six pits at the pitch point.
fn pitch_pits(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let place = "D3.2.4.2.3";
    let pitch = scene.case.pair.pitch_roll();
    let mut places = Vec::new();
    let mut values = Vec::new();
    for (width, height) in super::PITCH_PITS {
        let pitted = scene.pitted(scene.pit(pitch, width, height, None))?;
        if width == 6.35 {
            found.number(place, "pit 6.35 x 1.38 mm, largest STE (um)".into(), 19.6505, largest(&pitted));
        }
        places.push(scene.place_of_largest(&pitted));
        values.push(largest(&pitted));
    }
    let rises = values.windows(2).all(|pair| pair[1] > pair[0]);
    let listed = |values: &[f64]| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(", ");
    found.claim(place, "largest STE of the six pits rises with size (um)".into(), listed(&values), rises);
    let lpstc = lpstc(scene);
    let claim = format!("their largest STE lies immediately above the LPSTC (mesh cycle {lpstc:.2})");
    let above = places.iter().all(|&p| p >= lpstc - 0.02 && p < lpstc + 0.2);
    found.claim(place, claim, listed(&places), above);
    Ok(())
}

/// Mesh cycle of the figures at which the contact is at the LPSTC of the pinion.
fn lpstc(scene: &Scene) -> f64 {
    let landmarks = scene.case.pair.landmarks(Member::Pinion);
    let roll = landmarks.lpstc.map_or(landmarks.sap.roll_distance, |l| l.roll_distance);
    scene.origin + (roll - landmarks.pitch.roll_distance) / scene.case.pair.base_pitch()
}

/// Section 3.2.4.2.4: half ellipses on one end of the pinion's loaded face.
fn edge_pits(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let end = 0.5 * scene.case.pair.pinion().facewidth().min(scene.case.pair.wheel().facewidth());
    let pitch = scene.case.pair.pitch_roll();
    for (width, height) in [(7.0, 1.2), (24.5, 3.5)] {
        let pitted = scene.pitted(scene.pit_at(end, pitch, 2.0 * width, height, None))?;
        let increases: Vec<f64> = scene.cycles.iter().map(|c| scene.increase(&pitted, c + scene.origin)).collect();
        let worst = (0..increases.len()).max_by(|a, b| increases[*a].total_cmp(&increases[*b])).unwrap_or(0);
        let at = scene.cycles[worst] + scene.origin;
        let recess = scene.increase(&pitted, 1.25);
        let claim = format!("edge pit {width} x {height} mm: largest difference near the LPSTC, small in the recess");
        let value = format!("{:.1} % at {at:.2}, {recess:.1} % at 1.25", increases[worst]);
        found.claim("D3.2.4.2.4", claim, value, (at - lpstc(scene)).abs() < 0.2 && recess < 0.3 * increases[worst]);
    }
    Ok(())
}

/// Section 3.2.5.2 and Figure 3.12.
fn cracks(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let place = "D3.2.5.2";
    for fraction in [0.2, 0.5, 0.8] {
        let [pinion, gear] = [scene.cracked(0, fraction)?, scene.cracked(1, fraction)?];
        let percent = 100.0 * fraction;
        let (_, first, last) = scene.affected(&pinion);
        found.number(place, format!("{percent:.0} % crack on the pinion, felt from mesh cycle"), 0.05, first);
        found.number(place, format!("{percent:.0} % crack on the pinion, felt to mesh cycle"), 1.7, last);
        let quantity = format!("{percent:.0} % crack on the gear, mesh cycle of the largest STE");
        found.number(place, quantity, 0.7, scene.place_of_largest(&gear));
        let at = scene.place_of_largest(&pinion);
        let claim = format!("{percent:.0} % crack on the pinion: largest STE slightly below mesh cycle 1");
        found.claim(place, claim, format!("{at:.2}"), (0.8..1.0).contains(&at));
        let claim = format!("{percent:.0} % crack: largest STE larger on the gear than on the pinion");
        let (one, other) = (largest(&pinion), largest(&gear));
        found.claim(place, claim, format!("{other:.2} and {one:.2} um"), other > one);
    }
    Ok(())
}

/// Section 3.3 and Figure 3.13.
fn severities(found: &mut Findings, scene: &Scene) -> anyhow::Result<()> {
    let place = "D3.3";
    let pitch = scene.case.pair.pitch_roll();
    // areas of D3.3 divided by the ellipses of Figure 3.9 give the same active area for both
    let middle = scene.pitted(scene.pit(pitch, 16.51, 3.35, None))?;
    found.number(place, "pit of 20.93 % (16.51 x 3.35 mm), largest STE (um)".into(), 28.162, largest(&middle));
    let large = scene.pitted(scene.pit(pitch, 25.4, 4.63, None))?;
    found.number(place, "pit of 44.49 % (25.4 x 4.63 mm), largest STE (um)".into(), 47.2424, largest(&large));
    found.number(place, "the same, affected mesh cycles by the 1 % rule".into(), 1.2, scene.affected(&large).0);
    for (fraction, printed, range) in [(0.242942, 19.7924, 1.45), (0.81, 48.522, 1.62)] {
        let cracked = scene.cracked(0, fraction)?;
        let name = format!("crack of {:.2} %", 100.0 * fraction);
        found.number(place, format!("{name}, largest STE (um)"), printed, largest(&cracked));
        found.number(place, format!("{name}, affected mesh cycles by the 1 % rule"), range, scene.affected(&cracked).0);
    }
    Ok(())
}
