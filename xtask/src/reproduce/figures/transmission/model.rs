//! Figures 5.1 and 6.1, and the meshes of cracked teeth: the model, to scale.

use std::f64::consts::TAU;

use anyhow::Context as _;
use gear_geom::{Damage, FlankSide, Gear, Member, MeshSite, OutlineSegment, TrainTooth};
use gearwright_case::TransmissionCase;
use gearwright_plot::drawing::{Align, Drawing, Label, Stroke};
use nalgebra::{Point2, Rotation2, Rotation3, Vector3};
use planetary::housing::surface::Surface;

use super::*;
use crate::reproduce::context::Context;
use crate::reproduce::drawn::Drawn;
use crate::reproduce::figures::scheme;

const MM: f64 = 1e3;
/// Points of a piece of a tooth's outline.
const PARTS: u32 = 6;

type Polyline = Vec<(f64, f64)>;

/// One tooth from mid-space to mid-space (mm), its centre line at an angle.
fn tooth(gear: &Gear, centre: Point2<f64>, angle: f64) -> Polyline {
    let half = gear.half_tooth_outline();
    let points = OutlineSegment::ALL
        .iter()
        .flat_map(|segment| (0..=PARTS).map(|k| half.point(*segment, f64::from(k) / f64::from(PARTS))));
    let upper: Vec<Point2<f64>> = points.collect();
    let lower = upper.iter().map(|p| Point2::new(p.x, -p.y));
    let turn = Rotation2::new(angle);
    let place = |p: Point2<f64>| {
        let p = centre + turn * p.coords;
        (p.x * MM, p.y * MM)
    };
    lower.chain(upper.iter().rev().copied()).map(place).collect()
}

/// All teeth of a gear, tooth 0 at an angle; counter-clockwise.
fn teeth(gear: &Gear, centre: Point2<f64>, first: f64) -> Polyline {
    let pitch = TAU / f64::from(gear.teeth());
    let mut outline: Polyline =
        (0..gear.teeth()).flat_map(|k| tooth(gear, centre, first + pitch * f64::from(k))).collect();
    outline.extend(outline.first().copied());
    outline
}

fn circle(centre: (f64, f64), radius: f64) -> Polyline {
    (0..=120)
        .map(|k| (TAU * f64::from(k) / 120.0).sin_cos())
        .map(|(s, c)| (centre.0 + radius * c, centre.1 + radius * s))
        .collect()
}

/// Angle of the centre line of a tooth at rest (rad).
fn tooth_angle(case: &TransmissionCase, tooth: TrainTooth) -> anyhow::Result<f64> {
    let (train, spec) = (&case.train, case.train.spec());
    let pitch = |gear: &Gear| TAU / f64::from(gear.teeth());
    Ok(match tooth {
        TrainTooth::Sun(k) => train.sun_tooth_angle() + f64::from(k) * pitch(&spec.sun),
        TrainTooth::Ring(k) => spec.ring_tooth_angle + f64::from(k) * pitch(&spec.ring),
        TrainTooth::Planet(planet, k) => planet_tooth(case, planet)? + f64::from(k) * pitch(&spec.planet),
    })
}

/// Angle of a tooth of a planet at rest (rad): its pair with the ring stands in a mirrored frame.
fn planet_tooth(case: &TransmissionCase, planet: usize) -> anyhow::Result<f64> {
    let site = MeshSite::PlanetRing;
    let own = case.train.pair(site).tooth_angle(Member::Pinion, 0, case.train.mesh_offset(site, planet)?);
    Ok(case.train.spec().planet_angles[planet] - own)
}

/// A damaged tooth of the case.
fn damaged_tooth(case: &TransmissionCase) -> anyhow::Result<TrainTooth> {
    let damage = case.severities.first().and_then(|s| s.damage.first()).context("the case has no damage")?;
    Ok(damage.0)
}

/// Outside of the housing at the height of the gears (mm); nothing where the housing is rigid.
fn wall(case: &TransmissionCase) -> Polyline {
    let Some(plan) = &case.housing else { return Vec::new() };
    let surface = Surface::new(&plan.solid.mesh);
    let at = |degree: i32| surface.outermost(&plan.solid.mesh, f64::from(degree).to_radians(), 0.0);
    (0..=180).filter_map(|k| at(2 * k)).map(|p| (p.position[0] * MM, p.position[1] * MM)).collect()
}

/// Shades of faces by how far they turn to the light, dark to bright.
const SHADES: [&str; 8] = ["#6f7782", "#7f8893", "#8f98a3", "#a0a8b2", "#b1b8c1", "#c2c8d0", "#d4d9df", "#e6e9ed"];

/// The housing's mesh seen from outside and above, parallel projection; nearer faces hide farther ones.
fn housing_view(case: &TransmissionCase) -> Option<Drawing> {
    let mesh = &case.housing.as_ref()?.solid.mesh;
    // looking from the input port's side
    let toward = Rotation3::from_euler_angles(
        0.0,
        0.0,
        case.inputs.bevel.as_ref().map_or(0.0, |b| b.pinion_at_deg - 40.0).to_radians(),
    ) * Vector3::new(1.0, 0.0, 0.45).normalize();
    let right = Vector3::z().cross(&toward).normalize();
    let up = toward.cross(&right);
    let light = (toward + 0.8 * up - 0.5 * right).normalize();
    let mut faces: Vec<(f64, usize, Polyline)> = mesh
        .outer_faces()
        .iter()
        .filter_map(|face| {
            let corners = if face.len() % 3 == 0 { 3 } else { 4 };
            let points: Vec<Vector3<f64>> = face.iter().take(corners).map(|&node| mesh.node(node)).collect();
            let normal = (points[1] - points[0]).cross(&(points[corners - 1] - points[0])).try_normalize(0.0)?;
            if normal.dot(&toward) <= 0.0 {
                return None;
            }
            let shade = (normal.dot(&light).max(0.0) * (SHADES.len() - 1) as f64).round() as usize;
            let depth = points.iter().map(|p| p.dot(&toward)).sum::<f64>() / corners as f64;
            let outline = points.iter().chain(points.first()).map(|p| (p.dot(&right) * MM, p.dot(&up) * MM)).collect();
            Some((depth, shade.min(SHADES.len() - 1), outline))
        })
        .collect();
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let strokes = faces
        .into_iter()
        .map(|(_, shade, outline)| Stroke::thin(vec![outline]).styled("#4a525c", 0.25).filled(SHADES[shade]));
    Some(Drawing { strokes: strokes.collect(), scale_bar: Some((50.0, "50 mm".into())), ..Drawing::default() })
}

/// Top view of gears, housing and sensors, with the damaged tooth.
fn top_view(case: &TransmissionCase) -> anyhow::Result<Drawing> {
    let spec = case.train.spec();
    let origin = Point2::origin();
    let mut strokes = vec![];
    let rim = spec.ring.rim_radius();
    let outside = wall(case);
    let reach = outside.iter().map(|p| p.0.hypot(p.1)).fold(rim * MM, f64::max);
    strokes.push(Stroke::thin(vec![outside.clone()]).styled(GREY, 1.2).filled("#e9e6df"));
    strokes.push(Stroke::thin(vec![circle((0.0, 0.0), rim * MM)]).styled(GREEN, 0.9).filled("#dbe8d5"));
    let ring = teeth(&spec.ring, origin, spec.ring_tooth_angle);
    strokes.push(Stroke::thin(vec![ring]).styled(GREEN, 0.8).filled("#ffffff"));
    for (planet, angle) in spec.planet_angles.iter().enumerate() {
        let centre = Point2::new(angle.cos(), angle.sin()) * spec.centre_distance;
        let outline = teeth(&spec.planet, centre, planet_tooth(case, planet)?);
        strokes.push(Stroke::thin(vec![outline]).styled(ORANGE, 0.8).filled("#fbe6cb"));
        let bore = circle((centre.x * MM, centre.y * MM), spec.planet.rim_radius() * MM);
        strokes.push(Stroke::thin(vec![bore]).styled(ORANGE, 0.8).filled("#ffffff"));
    }
    let sun = teeth(&spec.sun, origin, case.train.sun_tooth_angle());
    strokes.push(Stroke::thin(vec![sun]).styled(BLUE, 0.8).filled("#d5def5"));
    strokes
        .push(Stroke::thin(vec![circle((0.0, 0.0), spec.sun.rim_radius() * MM)]).styled(BLUE, 0.8).filled("#ffffff"));
    let mut labels = Vec::new();
    for sensor in case.sensors.iter().take(case.named_sensors) {
        let (sin, cos) = sensor.angle.sin_cos();
        let colour = if sensor.name == INPUT_PORT { PURPLE } else { BLACK };
        // on the wall in that direction
        let along = |p: &&(f64, f64)| p.0 * cos + p.1 * sin;
        let at = outside.iter().max_by(|a, b| along(a).total_cmp(&along(b))).map_or(reach, |p| along(&p));
        let dot = circle((at * cos, at * sin), 4.0);
        strokes
            .push(Stroke::thin(vec![dot]).styled(colour, 1.0).filled(colour).named(&format!("sensor {}", sensor.name)));
    }
    let damaged = damaged_tooth(case)?;
    let (angle, radius) = match damaged {
        TrainTooth::Ring(_) => (tooth_angle(case, damaged)?, spec.ring.root_radius()),
        TrainTooth::Sun(_) => (tooth_angle(case, damaged)?, spec.sun.tip_radius()),
        TrainTooth::Planet(..) => anyhow::bail!("figures of the dissertation have no damaged planet"),
    };
    let (x, y) = (radius * angle.cos() * MM, radius * angle.sin() * MM);
    let square =
        vec![(x - 4.0, y - 4.0), (x + 4.0, y - 4.0), (x + 4.0, y + 4.0), (x - 4.0, y + 4.0), (x - 4.0, y - 4.0)];
    strokes.push(Stroke::thin(vec![square]).styled(RED, 1.6).named("damaged tooth"));
    for degrees in [0, 90, 180, 270] {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let out = reach + 14.0;
        labels.push(Label::new((out * cos, out * sin - 2.0), &format!("{degrees}°"), Align::Middle));
    }
    let border = [24.0, 24.0, 18.0, 18.0];
    Ok(Drawing { strokes, labels, scale_bar: Some((50.0, "50 mm".into())), border, ..Drawing::default() })
}

fn crack_side(case: &TransmissionCase) -> anyhow::Result<FlankSide> {
    let damage = case.severities.first().and_then(|s| s.damage.first()).context("the case has no damage")?;
    match &damage.1 {
        Damage::Crack(crack) => Ok(crack.side),
        _ => anyhow::bail!("the damage is no crack"),
    }
}

/// Root cracks of 20, 50 and 80 % in the damaged tooth.
pub fn cracked_tooth(
    context: &Context,
    file: &str,
    letter: &'static str,
    about: &str,
    colours: [&'static str; 4],
) -> anyhow::Result<Panel> {
    let case = context.transmission(file)?;
    let spec = case.train.spec();
    let gear = match damaged_tooth(&case)? {
        TrainTooth::Ring(_) => &spec.ring,
        TrainTooth::Sun(_) => &spec.sun,
        TrainTooth::Planet(..) => &spec.planet,
    };
    let lengths =
        [(0.2, colours[1], Pattern::Solid), (0.5, colours[2], Pattern::Solid), (0.8, colours[3], Pattern::Solid)];
    Ok(Panel::drawing(letter, about, scheme::cracks(gear, crack_side(&case)?, &lengths)?))
}

/// Figure 5.1.
pub fn ring(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.transmission(RING)?;
    let mut drawn = Drawn::default();
    let housing = housing_view(&case).context("the case has no housing")?;
    drawn.panels.push(Panel::drawing(
        "a",
        "The housing's finite-element mesh, from the side of the input port.",
        housing,
    ));
    drawn.panels.push(Panel::drawing(
        "b",
        "Top view at the start: gears, sensors, damaged ring tooth.",
        top_view(&case)?,
    ));
    drawn.note(MODEL);
    Ok(drawn)
}

/// Figure 6.1.
pub fn sun(context: &Context) -> anyhow::Result<Drawn> {
    let case = context.transmission(SUN)?;
    let spec = case.train.spec();
    let mut drawn = Drawn::default();
    drawn.panels.push(Panel::drawing(
        "a",
        "Top view at the start, with the sensor near the input port.",
        top_view(&case)?,
    ));
    let damaged = tooth_angle(&case, damaged_tooth(&case)?)?;
    let outline = teeth(&spec.sun, Point2::origin(), case.train.sun_tooth_angle());
    let strokes = vec![
        Stroke::thin(vec![outline]).styled(BLUE, 0.9).filled("#d5def5"),
        Stroke::thin(vec![circle((0.0, 0.0), spec.sun.rim_radius() * MM)]).styled(BLUE, 0.9).filled("#ffffff"),
        Stroke::thin(vec![tooth(&spec.sun, Point2::origin(), damaged)]).styled(RED, 1.8).named("damaged tooth"),
    ];
    let drawing = Drawing { strokes, scale_bar: Some((10.0, "10 mm".into())), ..Drawing::default() };
    drawn.panels.push(Panel::drawing("b", "The sun at the start and its damaged tooth.", drawing));
    drawn.note(MODEL);
    Ok(drawn)
}
