//! Drawings to scale: outlines, meshes, schematics and tooth surfaces, as SVG and PNG.
//!
//! Coordinates are data units with y up; both axes share one scale unless the drawing says otherwise.

use std::fmt::Write as _;

use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

use super::Pattern;

/// Text size (px).
const TEXT: u32 = 13;
/// Free space around the drawing (px).
const MARGIN: f64 = 30.0;

/// Many polylines of one look: a mesh is one of these.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Name in the key below the drawing; empty for none.
    pub name: String,
    /// Polylines.
    pub lines: Vec<Vec<(f64, f64)>>,
    /// Colour of the line.
    pub colour: &'static str,
    /// Colour inside, if any: closes the polylines.
    pub fill: Option<&'static str>,
    /// Pattern.
    pub pattern: Pattern,
    /// Width (px).
    pub width: f64,
}

impl Stroke {
    /// Thin black lines without a name.
    #[must_use]
    pub fn thin(lines: Vec<Vec<(f64, f64)>>) -> Self {
        Self { name: String::new(), lines, colour: "#000000", fill: None, pattern: Pattern::Solid, width: 0.5 }
    }

    /// The same in another colour and width.
    #[must_use]
    pub fn styled(self, colour: &'static str, width: f64) -> Self {
        Self { colour, width, ..self }
    }

    /// The same with a name in the key.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The same in another pattern.
    #[must_use]
    pub fn patterned(self, pattern: Pattern) -> Self {
        Self { pattern, ..self }
    }

    /// The same with its inside filled.
    #[must_use]
    pub fn filled(self, colour: &'static str) -> Self {
        Self { fill: Some(colour), ..self }
    }
}

/// Where a label's text begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// At its place.
    Start,
    /// Centred on it.
    Middle,
    /// Ends there.
    End,
}

/// A text in the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Where.
    pub at: (f64, f64),
    /// What.
    pub text: String,
    /// Which part of the text stands there.
    pub align: Align,
}

impl Label {
    /// A label.
    #[must_use]
    pub fn new(at: (f64, f64), text: &str, align: Align) -> Self {
        Self { at, text: text.into(), align }
    }
}

/// A drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Heading.
    pub title: String,
    /// Strokes, the first at the bottom.
    pub strokes: Vec<Stroke>,
    /// Texts.
    pub labels: Vec<Label>,
    /// A bar of this length and with this text below, as a scale.
    pub scale_bar: Option<(f64, String)>,
    /// Data units added left, right, below and above for labels outside the strokes.
    pub border: [f64; 4],
}

impl Drawing {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        super::save(self.scene(), folder, name)
    }

    /// Extent of the strokes and the border: left, right, bottom, top.
    fn extent(&self) -> [f64; 4] {
        let points = || self.strokes.iter().flat_map(|s| s.lines.iter().flatten());
        let limit = |value: fn(&(f64, f64)) -> f64, pick: fn(f64, f64) -> f64, start: f64| {
            points().map(value).filter(|v| v.is_finite()).fold(start, pick)
        };
        let mut extent = [
            limit(|p| p.0, f64::min, f64::INFINITY),
            limit(|p| p.0, f64::max, f64::NEG_INFINITY),
            limit(|p| p.1, f64::min, f64::INFINITY),
            limit(|p| p.1, f64::max, f64::NEG_INFINITY),
        ];
        if extent[0] > extent[1] {
            extent = [0.0, 1.0, 0.0, 1.0];
        }
        [extent[0] - self.border[0], extent[1] + self.border[1], extent[2] - self.border[2], extent[3] + self.border[3]]
    }

    fn scene(&self) -> Scene {
        let [left, right, bottom, top] = self.extent();
        let (wide, high) = ((right - left).max(1e-12), (top - bottom).max(1e-12));
        let scale = (720.0 / wide).min(560.0 / high);
        let named: Vec<&Stroke> = self.strokes.iter().filter(|s| !s.name.is_empty()).collect();
        let head = if self.title.is_empty() { MARGIN } else { MARGIN + 24.0 };
        let width = (wide * scale + 2.0 * MARGIN).max(420.0);
        let bar = if self.scale_bar.is_some() { 26.0 } else { 0.0 };
        let key = 20.0 * named.len() as f64;
        let body = head + high * scale + 14.0;
        let mut scene = Scene::new(width, body + bar + key + 12.0);
        let shift = 0.5 * (width - wide * scale);
        let place = |p: (f64, f64)| (shift + (p.0 - left) * scale, head + (top - p.1) * scale);
        for stroke in &self.strokes {
            scene.add(path(stroke, stroke.lines.iter().map(|line| line.iter().map(|p| place(*p)).collect())));
        }
        for label in &self.labels {
            let at = place(label.at);
            // the middle of the letters at the place
            scene.add(text((at.0, at.1 + 0.35 * f64::from(TEXT)), &label.text, label.align, false));
        }
        if !self.title.is_empty() {
            scene.add(text((0.5 * width, 26.0), &self.title, Align::Middle, true));
        }
        if let Some((length, name)) = &self.scale_bar {
            let (x, y) = (shift, body + 8.0);
            let end = x + length * scale;
            let ends = [vec![(x, y), (end, y)], vec![(x, y - 4.0), (x, y + 4.0)], vec![(end, y - 4.0), (end, y + 4.0)]];
            scene.add(path(&Stroke::thin(Vec::new()).styled("#000000", 1.2), ends.into_iter()));
            scene.add(text((end + 8.0, y + 4.0), name, Align::Start, false));
        }
        for (row, stroke) in named.iter().enumerate() {
            let y = body + bar + 20.0 * row as f64 + 6.0;
            scene.add(path(stroke, std::iter::once(vec![(MARGIN, y), (MARGIN + 34.0, y)])));
            scene.add(text((MARGIN + 42.0, y + 4.0), &stroke.name, Align::Start, false));
        }
        scene
    }
}

fn path(stroke: &Stroke, lines: impl Iterator<Item = Vec<(f64, f64)>>) -> Primitive {
    let mut d = String::new();
    for line in lines {
        for (k, (x, y)) in line.iter().enumerate() {
            // writing to a string cannot fail
            let _ = write!(d, "{}{x:.2},{y:.2}", if k == 0 { 'M' } else { 'L' });
        }
        if stroke.fill.is_some() {
            d.push('Z');
        }
    }
    Primitive::Path(Box::new(PathData {
        d,
        fill: stroke.fill.map(Into::into),
        stroke: stroke.colour.into(),
        stroke_width: stroke.width,
        opacity: None,
        stroke_dasharray: stroke.pattern.dashes().map(Into::into),
    }))
}

fn text(at: (f64, f64), content: &str, align: Align, bold: bool) -> Primitive {
    Primitive::Text {
        x: at.0,
        y: at.1,
        content: content.into(),
        size: if bold { TEXT + 2 } else { TEXT },
        anchor: match align {
            Align::Start => TextAnchor::Start,
            Align::Middle => TextAnchor::Middle,
            Align::End => TextAnchor::End,
        },
        rotate: None,
        bold,
        color: None,
    }
}
