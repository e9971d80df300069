//! Drawings from the model: meshes of gears, tooth surfaces with damage, the lumped-parameter scheme.

use std::f64::consts::TAU;

use fecm::MeshDensity;
use fecm::mesh::{PlaneMesh, SectorMesh};
use fecm::statics::{PairModel, StaticsRequest};
use gear_geom::{Damage, FlankSide, Gear, Member, PitShape, ProfileMeasure, RootCrack};
use gearwright_case::SpurPairCase;
use gearwright_case::spur_pair::damage::Severity;
use gearwright_plot::drawing::{Align, Drawing, Label, Stroke};
use gearwright_plot::{Pattern, statics as plots};
use nalgebra::{Point2, Rotation2};

use crate::reproduce::context::Context;
use crate::reproduce::drawn::{Drawn, Panel, Picture, colour::*};

const MM: f64 = 1e3;

type Polyline = Vec<(f64, f64)>;

/// Edges of the elements (mm), cut at an inner radius (m), after a map of the nodes.
fn edges(mesh: &PlaneMesh, beyond: f64, place: impl Fn(usize, Point2<f64>) -> Point2<f64>) -> Vec<Polyline> {
    let n = mesh.order + 1;
    let corner = |element: &[u32], k: usize| {
        let node = element[k] as usize;
        // what lies further in is drawn on the circle
        let own = mesh.nodes[node];
        let out = (beyond / own.coords.norm().max(1e-12)).max(1.0);
        let p = place(node, Point2::from(own.coords * out));
        (p.x * MM, p.y * MM)
    };
    let outline = |element: &[u32]| -> Polyline {
        let last = n - 1;
        let along = (0..n).chain((1..n).map(|j| j * n + last)).chain((0..last).rev().map(|i| last * n + i));
        along.chain((0..last).rev().map(|j| j * n)).map(|k| corner(element, k)).collect()
    };
    let is_near =
        |element: &&[u32]| element.iter().any(|n| mesh.nodes[*n as usize].coords.norm() > beyond * (1.0 + 1e-9));
    mesh.elements().filter(is_near).map(outline).collect()
}

/// Meshes of both gears in mesh, the crack (if any) on tooth 0 of the pinion.
fn pair_mesh(case: &SpurPairCase, title: &str) -> anyhow::Result<Drawing> {
    let density = MeshDensity { order: 2, density: 0.6 };
    let mut drawing = Drawing { title: title.into(), scale_bar: Some((20.0, "20 mm".into())), ..Drawing::default() };
    for (member, colour, name) in [(Member::Pinion, "#26418f", "pinion"), (Member::Wheel, "#3c6e3c", "gear")] {
        let gear = case.pair.gear(member);
        let sector = SectorMesh::new(gear, &density, name)?;
        let (centre, first) = (case.pair.centre(member), case.pair.tooth_angle(member, 0, 0.0));
        let mut lines = Vec::new();
        for tooth in 0..gear.teeth() {
            let turn = Rotation2::new(first + TAU * f64::from(tooth) / f64::from(gear.teeth()));
            lines.extend(edges(&sector.mesh, 0.0, |_, p| centre + turn * p.coords));
        }
        drawing.strokes.push(Stroke::thin(lines).styled(colour, 0.35));
        let mark = if member == Member::Pinion { "C" } else { "T" };
        drawing.labels.push(Label::new((centre.x * MM, centre.y * MM), mark, Align::Middle));
    }
    Ok(drawing)
}

fn gear_pair(context: &Context, file: &str, about: &str) -> anyhow::Result<Drawn> {
    let case = context.spur_pair(file)?;
    let mut drawn = Drawn::default();
    drawn.panels.push(Panel::drawing("", about, pair_mesh(&case, "")?));
    drawn.note("The mesh is drawn coarser than it is computed with. C: bore held; T: torque.");
    Ok(drawn)
}

/// Figure 2.1.
pub fn unity_mesh(context: &Context) -> anyhow::Result<Drawn> {
    gear_pair(context, "unity-pair.toml", "Finite-element mesh of the unity pair.")
}

/// Figure 7.1.
pub fn nonunity_mesh(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = gear_pair(context, "nonunity-pair.toml", "Finite-element mesh of the nonunity pair.")?;
    drawn.panels[0].letter = "a";
    drawn.panels.push(Panel::drawing("b", "Lumped-parameter model.", lumped_scheme()));
    Ok(drawn)
}

/// Figure 2.4.
pub fn pit_scheme(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.spur_pair("unity-pits-pitch.toml")?;
    let mut drawn = Drawn::default();
    let one = case.severities.iter().skip(1).take(1).map(|s| (s, RED, Pattern::Solid));
    let mut drawing = flank(&case, Member::Pinion, one);
    let middle = ProfileMeasure::ArcLength { base_radius: case.pair.pinion().base_radius() };
    let height = middle.at(case.pair.pitch_roll()) * MM;
    let half = 0.5 * case.pair.pinion().facewidth() * MM;
    let lines = vec![vec![(0.0, 0.0), (0.0, height + 1.0)], vec![(-half, height), (1.0, height)]];
    drawing.strokes.push(Stroke::thin(lines).styled(BLUE, 1.0).patterned(Pattern::DashDotted));
    drawing.labels.push(Label::new((0.4, height - 3.4), "t = 0 at mid-face", Align::Start));
    drawing.labels.push(Label::new((-half + 0.4, height + 0.55), "s of the pit's centre", Align::Start));
    drawn.panels.push(Panel::drawing(
        "",
        "A tooth flank with an elliptical pit: face position t, place along the profile s.",
        drawing,
    ));
    Ok(drawn)
}

/// A flank with its landmarks and pits, arc length over face position (mm); roll distance where a pit is measured in it.
pub fn flank<'a>(
    case: &SpurPairCase,
    member: Member,
    pits: impl Iterator<Item = (&'a Severity, &'static str, Pattern)>,
) -> Drawing {
    let (gear, landmarks) = (case.pair.gear(member), case.pair.landmarks(member));
    let half = 0.5 * gear.facewidth() * MM;
    let mut measure = ProfileMeasure::ArcLength { base_radius: gear.base_radius() };
    let mut strokes = Vec::new();
    for (severity, colour, pattern) in pits {
        let mut outlines = Vec::new();
        let own = severity.damage.iter().flatten().filter_map(|d| match &d.damage {
            Damage::Pit(pit) => Some(pit),
            _ => None,
        });
        for shape in own.flat_map(|pit| &pit.shapes) {
            if let PitShape::Ellipse { centre, size, measure: along } = shape {
                measure = *along;
                let point = |k: usize| {
                    let (sin, cos) = (TAU * k as f64 / 120.0).sin_cos();
                    let x = (centre.x + 0.5 * size.x * cos) * MM;
                    (x.clamp(-half, half), (measure.at(centre.y) + 0.5 * size.y * sin) * MM)
                };
                outlines.push((0..=120).map(point).collect());
            }
        }
        let style = Stroke::thin(outlines).styled(colour, 1.8).patterned(pattern).named(&severity.label);
        strokes.push(style);
    }
    // a wide face is drawn higher than to scale, so that its landmarks stand apart
    let reach = (measure.at(landmarks.eap.roll_distance) - measure.at(landmarks.sap.roll_distance)) * MM;
    let stretch = (0.9 * half / reach).max(1.0);
    for line in strokes.iter_mut().flat_map(|s: &mut Stroke| &mut s.lines) {
        line.iter_mut().for_each(|p| p.1 *= stretch);
    }
    let place = |roll: f64| measure.at(roll) * MM * stretch;
    let marks = [
        ("SAP", Some(landmarks.sap)),
        ("LPSTC", landmarks.lpstc),
        ("pitch", Some(landmarks.pitch)),
        ("HPSTC", landmarks.hpstc),
        ("EAP", Some(landmarks.eap)),
    ];
    let (low, high) = (place(landmarks.sap.roll_distance), place(landmarks.eap.roll_distance));
    let frame = vec![(-half, low), (half, low), (half, high), (-half, high), (-half, low)];
    let mut drawing = Drawing { scale_bar: Some((5.0, scale_text(measure, stretch))), ..Drawing::default() };
    drawing.strokes.push(Stroke::thin(vec![frame]).styled(BLACK, 1.4).filled("#f3f0ea"));
    for (name, landmark) in marks {
        let Some(landmark) = landmark else { continue };
        let y = place(landmark.roll_distance);
        drawing.strokes.push(Stroke::thin(vec![vec![(-half, y), (half, y)]]).styled(GREY, 0.9));
        drawing.labels.push(Label::new((half * 1.02, y), name, Align::Start));
    }
    drawing.strokes.extend(strokes);
    drawing.border = [0.0, 0.22 * half, 0.3, 0.3];
    drawing
}

fn scale_text(measure: ProfileMeasure, stretch: f64) -> String {
    let along = match measure {
        ProfileMeasure::ArcLength { .. } => "arc length on the flank",
        ProfileMeasure::RollDistance => "distance along the line of action",
    };
    let times = if stretch > 1.0 { format!(", {stretch:.2} times as high") } else { String::new() };
    format!("5 mm; across: face, upward: {along}{times}")
}

/// Figure 3.5.
pub fn pitted_regions(context: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    let files = ["pitted-approach.toml", "pitted-single-contact.toml", "pitted-recess.toml"];
    let cases = files.map(|file| context.spur_pair(file));
    let [approach, single, recess] = cases;
    let (approach, single, recess) = (approach?, single?, recess?);
    let ends = |case: &SpurPairCase, colour: &'static str| {
        let (first, last) = (case.severities.first().cloned(), case.severities.last().cloned());
        [(first, colour, Pattern::Dashed), (last, colour, Pattern::Solid)]
    };
    let all: Vec<_> = [ends(&approach, BLUE), ends(&single, BLACK), ends(&recess, RED)].into_iter().flatten().collect();
    let pits = all.iter().filter_map(|(s, colour, pattern)| s.as_ref().map(|s| (s, *colour, *pattern)));
    let drawing = flank(&single, Member::Pinion, pits);
    let about = "Active flank of the pinion with the smallest (dashed) and largest (solid) pit of each region.";
    drawn.panels.push(Panel::drawing("", about, drawing));
    let landmarks = single.pair.landmarks(Member::Pinion);
    if let (Some(low), Some(high)) = (landmarks.lpstc, landmarks.hpstc) {
        let length = |a: gear_geom::Landmark, b: gear_geom::Landmark| (b.roll_distance - a.roll_distance) * MM;
        drawn.value("LPSTC to HPSTC", length(low, high));
        drawn.value("SAP to LPSTC", length(landmarks.sap, low));
        drawn.value("HPSTC to EAP", length(high, landmarks.eap));
    }
    drawn.note("The printed lengths of the regions are distances along the line of action, and so are the heights of these pits.");
    Ok(drawn)
}

/// Figure 3.1.
pub fn nonunity_model(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.spur_pair("nonunity-modified-cracked.toml")?;
    let mut drawn = Drawn::default();
    drawn.panels.push(Panel::drawing(
        "a",
        "Mesh of the nonunity pair; C: bore held, T: torque.",
        pair_mesh(&case, "")?,
    ));
    let pitted = context.spur_pair("nonunity-modified-pitted.toml")?;
    let healthy = PairModel::new(&case.pair, &case.options)?;
    // one pair in contact, with the tooth of interest in it
    let request = StaticsRequest::new([0.0], [case.inputs.load.torque_n_m]).keeping_pressure();
    let damaged = |case: &SpurPairCase| -> anyhow::Result<PairModel> {
        let severity = case.severities.first().ok_or_else(|| anyhow::anyhow!("the case has no damage"))?;
        Ok(healthy.with_damage(&severity.damage)?)
    };
    let with_crack = damaged(&case)?;
    let mut deformed = |letter: &'static str, about: &str, model: &PairModel| -> anyhow::Result<()> {
        drawn.panels.push(Panel::drawing(letter, about, deformed_tooth(model, &request)?));
        Ok(())
    };
    deformed("b", "Deformation of a healthy pinion tooth, exaggerated; grey: at rest.", &healthy)?;
    deformed("c", "The same with a root crack through half the tooth.", &with_crack)?;
    for (letter, about, model) in
        [("d", "Contact pressure on a healthy tooth.", &healthy), ("e", "The same with a pit.", &damaged(&pitted)?)]
    {
        let solved = model.solve(&request, &())?;
        let results = solved.results.first().map_or(&[][..], Vec::as_slice);
        let map =
            plots::flank_pressure("Pressure (MPa)", results, &case.pair, model.stats().symmetric, |_| true, |_, _| 0.0);
        let map = map.ok_or_else(|| anyhow::anyhow!("no contact at the position of panel {letter}"))?;
        drawn.panels.push(Panel { letter, about: about.into(), picture: Picture::Map(map) });
    }
    drawn.note("Where the crack runs is not printed: it follows the chord from fillet to fillet here.");
    Ok(drawn)
}

/// Radius down to which a tooth is shown (m): something of the rim with it.
fn below_root(gear: &Gear) -> f64 {
    gear.root_radius() - 0.8 * gear.module()
}

/// Tooth 0 of the pinion and its neighbours' sectors under load.
fn deformed_tooth(model: &PairModel, request: &StaticsRequest) -> anyhow::Result<Drawing> {
    const EXAGGERATION: f64 = 40.0;
    let solved = model.solve(request, &())?;
    let position = solved.results.first().and_then(|r| r.first());
    let position = position.ok_or_else(|| anyhow::anyhow!("the position was not solved"))?;
    let deformation = model.deformation(position, 0)?;
    let body = &model.bodies()[0];
    let mesh = &body.sector(0).shape.mesh;
    let beyond = below_root(model.pairing().gear(0));
    let at_rest = edges(mesh, beyond, |_, p| p);
    // the deformation is told with tooth 0 on the x axis, as the mesh is
    let moved = edges(mesh, beyond, |node, p| p + deformation.at(body, 0, node, 0.0).xy() * EXAGGERATION);
    let upright = |lines: Vec<Polyline>| -> Vec<Polyline> {
        lines.into_iter().map(|line| line.into_iter().map(|(x, y)| (-y, x)).collect()).collect()
    };
    let strokes = vec![
        Stroke::thin(upright(at_rest)).styled("#c8c8c8", 0.5).filled("#e4e4e4"),
        Stroke::thin(upright(moved)).styled("#26418f", 0.5),
    ];
    let scale = format!("2 mm; displacements times {EXAGGERATION:.0}");
    Ok(Drawing { strokes, scale_bar: Some((2.0, scale)), ..Drawing::default() })
}

/// A tooth's mesh with cracks of several lengths, drawn as lines along their faces.
pub fn cracks(gear: &Gear, side: FlankSide, lengths: &[(f64, &'static str, Pattern)]) -> anyhow::Result<Drawing> {
    let density = MeshDensity { order: 2, density: 1.0 };
    let upright = |p: &Point2<f64>| (-p.y * MM, p.x * MM);
    let mut drawing = Drawing { scale_bar: Some((1.0, "1 mm".into())), ..Drawing::default() };
    for (index, (fraction, colour, pattern)) in lengths.iter().enumerate().rev() {
        let crack = RootCrack::along_chord(side, *fraction);
        let sector = SectorMesh::with_crack(gear, &density, Some(&crack), "gear")?;
        if index + 1 == lengths.len() {
            let lines = edges(&sector.mesh, below_root(gear), |_, p| p).into_iter();
            let lines = lines.map(|line| line.into_iter().map(|(x, y)| (-y, x)).collect()).collect();
            drawing.strokes.push(Stroke::thin(lines).styled(GREY, 0.4));
        }
        if let Some(faces) = &sector.crack {
            let path = faces.nodes[0].iter().map(|n| upright(&sector.mesh.nodes[*n as usize])).collect();
            let name = format!("{:.0} %, {:.2} mm", 100.0 * fraction, faces.length * MM);
            // thinner over thicker, so that each shows
            let width = 2.0 + 2.0 * index as f64;
            drawing.strokes.push(Stroke::thin(vec![path]).styled(colour, width).patterned(*pattern).named(&name));
        }
    }
    Ok(drawing)
}

/// Figure 4.1.
pub fn nonunity_frequencies(context: &Context) -> anyhow::Result<Drawn> {
    let about = "Finite-element mesh of the nonunity pair.";
    let mut drawn = gear_pair(context, "nonunity-pair.toml", about)?;
    let run = context.lumped("lumped-resonance.toml")?;
    let mut found = Vec::new();
    for test in run.findings.impulses.iter().filter(|t| t.state == run.states[0].name) {
        if let Some(one) = &test.test {
            found.push((one.natural_frequency, one.damping_ratio));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let [one, two] = found[..] {
        let ratio = 1.0 + context.statics("cracked-pinion-plane.toml")?.healthy.double_contact();
        let values = [
            ("natural frequency, one pair", one.0),
            ("damping ratio, one pair", one.1),
            ("natural frequency, two pairs", two.0),
            ("damping ratio, two pairs", two.1),
            ("natural frequency, mean", lpm::mesh_average(one.0, two.0, ratio)?),
            ("damping ratio, mean", lpm::mesh_average(one.1, two.1, ratio)?),
            ("actual contact ratio", ratio),
        ];
        values.into_iter().for_each(|(key, value)| drawn.value(key, value));
    }
    drawn.value("theoretical contact ratio", context.spur_pair("nonunity-pair.toml")?.pair.contact_ratio());
    drawn.note(
        "Natural frequencies and damping ratios are from impulse tests of the lumped-parameter model with the plane-stress curves; the \
         dissertation's are from impulse tests of its finite-element model.",
    );
    Ok(drawn)
}

/// Figure 3.14.
pub fn lumped_model(_: &Context) -> anyhow::Result<Drawn> {
    let mut drawn = Drawn::default();
    drawn.panels.push(Panel::drawing(
        "",
        "Lumped-parameter model of the pair along its line of action.",
        lumped_scheme(),
    ));
    Ok(drawn)
}

fn circle(x: f64, y: f64, r: f64) -> Polyline {
    (0..=90).map(|k| (TAU * f64::from(k) / 90.0).sin_cos()).map(|(s, c)| (x + r * c, y + r * s)).collect()
}

/// A spring from (x, y) to the right over a length.
fn spring(x: f64, y: f64, length: f64) -> Polyline {
    let mut line = vec![(x, y), (x + 0.2 * length, y)];
    line.extend((0..6).map(|k| (x + length * (0.25 + 0.1 * f64::from(k)), y + if k % 2 == 0 { 0.22 } else { -0.22 })));
    line.extend([(x + 0.8 * length, y), (x + length, y)]);
    line
}

/// A damper from (x, y) to the right over a length.
fn damper(x: f64, y: f64, length: f64) -> Vec<Polyline> {
    let (a, b) = (x + 0.4 * length, x + 0.62 * length);
    vec![
        vec![(x, y), (a, y)],
        vec![(b, y + 0.22), (a, y + 0.22), (a, y - 0.22), (b, y - 0.22)],
        vec![(x + 0.53 * length, y + 0.15), (x + 0.53 * length, y - 0.15)],
        vec![(x + 0.53 * length, y), (x + length, y)],
    ]
}

fn lumped_scheme() -> Drawing {
    let mut thin = vec![circle(0.0, 0.0, 1.8), circle(9.0, 0.0, 2.3)];
    let ground = |x: f64, side: f64| -> Vec<Polyline> {
        let ticks = (0..7).map(|k| -1.2 + 0.4 * f64::from(k)).map(|y| vec![(x, y), (x + 0.3 * side, y - 0.3)]);
        std::iter::once(vec![(x, -1.3), (x, 1.3)]).chain(ticks).collect()
    };
    thin.extend(ground(-5.0, -1.0));
    thin.extend(ground(14.5, 1.0));
    thin.push(spring(-5.0, 0.6, 3.5));
    thin.extend(damper(-5.0, -0.6, 3.5));
    thin.push(spring(11.0, 0.6, 3.5));
    thin.extend(damper(11.0, -0.6, 3.5));
    // mesh: a spring with the static error in series, beside the damper
    thin.push(spring(1.6, 0.7, 3.4));
    thin.extend([vec![(5.0, 1.0), (5.0, 0.4)], vec![(5.5, 1.0), (5.5, 0.4)], vec![(5.5, 0.7), (6.8, 0.7)]]);
    thin.extend(damper(1.6, -0.7, 5.2));
    let arrows = |x: f64, y: f64| {
        vec![vec![(x, y), (x + 1.0, y)], vec![(x + 0.75, y + 0.14), (x + 1.0, y), (x + 0.75, y - 0.14)]]
    };
    thin.extend(arrows(0.0, 0.0));
    thin.extend(arrows(9.0, 0.0));
    let strokes = vec![Stroke::thin(thin).styled(BLACK, 1.3)];
    let label = |x: f64, y: f64, text: &str| Label::new((x, y), text, Align::Middle);
    let labels = vec![
        label(-3.25, 1.25, "k_p"),
        label(-3.25, -1.25, "c_p"),
        label(12.75, 1.25, "k_g"),
        label(12.75, -1.25, "c_g"),
        label(3.3, 1.35, "k_l(t)"),
        label(5.25, 1.55, "δ0(t)"),
        label(4.2, -1.35, "c_m"),
        label(0.5, 0.42, "y_p"),
        label(9.5, 0.42, "y_g"),
        label(0.0, -0.75, "m_p, J_p, r_p"),
        label(9.0, -0.8, "m_g, J_g, r_g"),
        label(0.0, 2.25, "T_p, θ_p"),
        label(9.0, 2.75, "T_g, θ_g"),
    ];
    Drawing { strokes, labels, border: [0.4, 0.4, 0.4, 0.9], ..Drawing::default() }
}
