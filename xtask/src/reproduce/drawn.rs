//! What a figure is made of, before and after it is written.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gearwright_plot::drawing::Drawing;
use gearwright_plot::{Chart, FlankMap, Line, Mark, MarkedChart, Pattern, PolarChart};
use serde::{Deserialize, Serialize};

use super::registry::Figure;

/// A picture.
pub enum Picture {
    /// Lines over an abscissa.
    Chart(MarkedChart),
    /// A quantity over a flank.
    Map(FlankMap),
    /// A drawing to scale.
    Drawing(Drawing),
    /// Closed lines about the housing.
    Polar(PolarChart),
}

impl Picture {
    /// Writes SVG and PNG.
    pub fn save(&self, folder: &dyn Fn(&str) -> PathBuf, name: &str) -> Result<(), String> {
        match self {
            Self::Chart(chart) => chart.save(folder, name),
            Self::Map(map) => map.save(folder, name),
            Self::Drawing(drawing) => drawing.save(folder, name),
            Self::Polar(chart) => chart.save(folder, name),
        }
    }

    /// The data as rows of a table: line, abscissa, ordinate.
    pub fn rows(&self) -> Option<Table> {
        let (lines, head) = match self {
            Self::Chart(MarkedChart { chart, .. }) => (&chart.lines, ["line", &chart.x_label, &chart.y_label]),
            Self::Polar(chart) => (&chart.lines, ["line", "angle (deg)", "radius"]),
            _ => return None,
        };
        let mut rows = Vec::new();
        for line in lines {
            rows.extend(
                line.points.iter().map(|(x, y)| vec![line.name.clone(), format!("{x:.9e}"), format!("{y:.9e}")]),
            );
        }
        Some(Table { head: head.map(String::from).to_vec(), rows })
    }
}

/// A panel of a figure.
pub struct Panel {
    /// Letter, or empty for the only one.
    pub letter: &'static str,
    /// What it shows, in our words.
    pub about: String,
    /// The picture.
    pub picture: Picture,
}

impl Panel {
    /// A chart.
    pub fn chart(letter: &'static str, about: &str, labels: (&str, &str), lines: Vec<Line>) -> Self {
        let chart = Chart {
            title: String::new(),
            x_label: labels.0.into(),
            y_label: labels.1.into(),
            lines,
            from_zero: false,
            logarithmic: false,
        };
        let marked = MarkedChart { chart, marks: Vec::new(), bands: Vec::new(), x_range: None, y_up_to: None };
        Self { letter, about: about.into(), picture: Picture::Chart(marked) }.tight()
    }

    /// A drawing.
    pub fn drawing(letter: &'static str, about: &str, drawing: Drawing) -> Self {
        Self { letter, about: about.into(), picture: Picture::Drawing(drawing) }
    }

    fn marked(&mut self, change: impl FnOnce(&mut MarkedChart)) {
        if let Picture::Chart(chart) = &mut self.picture {
            change(chart);
        }
    }

    /// The same with its ordinate from zero.
    pub fn zero_based(mut self) -> Self {
        self.marked(|c| c.chart.from_zero = true);
        self
    }

    /// The same from the first abscissa to the last.
    pub fn tight(self) -> Self {
        let Picture::Chart(chart) = &self.picture else { return self };
        let abscissae = chart.chart.lines.iter().flat_map(|l| &l.points).map(|p| p.0);
        let (from, to) = abscissae.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if from < to { self.between(from, to) } else { self }
    }

    /// The same between two abscissae.
    pub fn between(mut self, from: f64, to: f64) -> Self {
        self.marked(|c| c.x_range = Some((from, to)));
        self
    }

    /// The same with a mark.
    pub fn mark(mut self, mark: Mark) -> Self {
        self.marked(|c| c.marks.push(mark));
        self
    }
}

/// A line of a chart.
pub fn line(name: &str, colour: &'static str, pattern: Pattern, points: Vec<(f64, f64)>) -> Line {
    Line { name: name.into(), points, pattern, colour }
}

/// The dissertation's colours.
pub mod colour {
    pub const BLACK: &str = "#000000";
    pub const BLUE: &str = "#1f4fd8";
    pub const RED: &str = "#d62020";
    pub const GREEN: &str = "#1a9641";
    pub const ORANGE: &str = "#e6861a";
    pub const PURPLE: &str = "#7b3fb5";
    pub const MAGENTA: &str = "#d01c8b";
    pub const CYAN: &str = "#17a2b8";
    pub const BROWN: &str = "#8c564b";
    pub const GREY: &str = "#8a8a8a";
    pub const OLIVE: &str = "#8f8f00";
}

/// A table.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Headings.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// A figure as computed.
#[derive(Default)]
pub struct Drawn {
    /// Panels.
    pub panels: Vec<Panel>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Values by their keys in the data file of printed numbers.
    pub values: BTreeMap<String, f64>,
    /// What was found of what is said in words, by the same keys.
    pub claims: BTreeMap<String, Found>,
    /// What a reader should know: choices, shifts of origin, what is left out.
    pub notes: Vec<String>,
    /// Wall time (s).
    pub seconds: f64,
}

/// What a computation finds of something said in words.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Whether it holds.
    pub holds: bool,
    /// The numbers behind.
    pub found: String,
}

impl Drawn {
    /// Adds a value.
    pub fn value(&mut self, key: impl Into<String>, value: f64) {
        self.values.insert(key.into(), value);
    }

    /// Adds what was found of something said in words.
    pub fn claim(&mut self, key: impl Into<String>, holds: bool, found: impl Into<String>) {
        self.claims.insert(key.into(), Found { holds, found: found.into() });
    }

    /// Adds a note.
    pub fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }
}

/// A figure as kept on disk.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Saved {
    /// File names without ending, and what they show.
    pub panels: Vec<(String, String)>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Values by key.
    pub values: BTreeMap<String, f64>,
    /// What was found of what is said in words.
    pub claims: BTreeMap<String, Found>,
    /// Notes.
    pub notes: Vec<String>,
    /// Wall time (s).
    pub seconds: f64,
}

/// How a figure ended.
pub enum Outcome {
    /// Written.
    Drawn(Saved),
    /// The error.
    Failed(String),
    /// Not computed, as others were asked for.
    NotAsked,
}

/// A figure and its outcome.
pub struct Done {
    /// The figure.
    pub figure: &'static Figure,
    /// The outcome.
    pub outcome: Outcome,
}
