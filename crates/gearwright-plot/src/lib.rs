//! Figures: line charts, flank maps and drawings as SVG and PNG. The only place that names the plotting library.

mod dashes;
pub mod drawing;
pub mod dynamics;
pub mod lumped;
pub mod polar;
pub mod recording;
pub mod statics;
pub mod transmission;

use std::path::Path;

use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::prelude::{
    ColorMap, Heatmap, Layout, LegendPosition, LinePlot, LineStyle, MarkerShape, Plot, PolarMode, PolarPlot,
    ReferenceLine, ScatterPlot, ShadedRegion,
};
use kuva::render::render::{Scene, render_multiple};

/// Line patterns, told apart without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pattern {
    /// Unbroken.
    #[default]
    Solid,
    /// Dashed.
    Dashed,
    /// Dotted.
    Dotted,
    /// Dash-dotted.
    DashDotted,
    /// Circles at the points, no line.
    Circles,
    /// Squares at the points, no line.
    Squares,
    /// Crosses at the points, no line.
    Crosses,
}

impl Pattern {
    /// Lengths of dashes and gaps (px); `None` for an unbroken line and for markers.
    fn dashes(self) -> Option<&'static str> {
        match self {
            Self::Dashed => Some("8 5"),
            Self::Dotted => Some("1.6 4"),
            Self::DashDotted => Some("9 4 1.6 4"),
            _ => None,
        }
    }
}

/// One line of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
    /// Pattern.
    pub pattern: Pattern,
    /// Colour.
    pub colour: &'static str,
}

/// Colours of lines in order: black first, then distinct for colour-blind readers (Okabe and Ito).
pub const COLOURS: [&str; 10] =
    ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255", "#999933", "#6a3d9a"];

/// A chart of lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// Abscissa with unit.
    pub x_label: String,
    /// Ordinate with unit.
    pub y_label: String,
    /// Lines.
    pub lines: Vec<Line>,
    /// Whether the ordinate starts at zero.
    pub from_zero: bool,
    /// Whether both axes are logarithmic.
    pub logarithmic: bool,
}

/// A straight line across a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Where.
    pub at: f64,
    /// Whether it stands upright at an abscissa; otherwise it lies at an ordinate.
    pub upright: bool,
    /// Label; empty for none.
    pub label: String,
    /// Colour.
    pub colour: &'static str,
    /// Whether it is dotted; otherwise dashed.
    pub dotted: bool,
}

/// A stretch of the abscissa that is shaded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// From.
    pub from: f64,
    /// To.
    pub to: f64,
    /// Colour.
    pub colour: &'static str,
}

/// A chart with marks and shaded bands, and limits of its axes where they are not the lines' own.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedChart {
    /// The chart.
    pub chart: Chart,
    /// Marks.
    pub marks: Vec<Mark>,
    /// Bands.
    pub bands: Vec<Band>,
    /// Abscissae from and to.
    pub x_range: Option<(f64, f64)>,
    /// An ordinate that must be in sight.
    pub y_up_to: Option<f64>,
}

/// A map of a quantity over a flank.
#[derive(Debug, Clone, PartialEq)]
pub struct FlankMap {
    /// Heading.
    pub title: String,
    /// Quantity with unit.
    pub quantity: String,
    /// Face positions from and to (mm).
    pub face: (f64, f64),
    /// Roll distances from and to (mm).
    pub roll: (f64, f64),
    /// Values, rows from the smallest roll distance up, columns along the face.
    pub values: Vec<Vec<f64>>,
    /// Named roll distances (mm).
    pub landmarks: Vec<(String, f64)>,
    /// Places on the rim of damage: face position and roll distance (mm).
    pub rim: Vec<(f64, f64)>,
}

/// Pixels per unit of the PNG files.
const PNG_SCALE: f32 = 2.0;

/// Columns of a line chart: more points would not be seen.
const COLUMNS: usize = 900;

/// At most two points a column, its extremes in their order: nothing that would be seen is lost.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 2 * COLUMNS {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(2 * COLUMNS);
    for part in points.chunks(points.len().div_ceil(COLUMNS)) {
        let by = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        if let (Some(low), Some(high)) = (part.iter().min_by(by), part.iter().max_by(by)) {
            kept.extend(if low.0 <= high.0 { [*low, *high] } else { [*high, *low] });
        }
    }
    kept
}

fn journal(layout: Layout) -> Layout {
    layout
        .with_width(720.0)
        .with_height(460.0)
        .with_title_size(15)
        .with_label_size(14)
        .with_tick_size(12)
        .with_body_size(12)
        .with_box_axes()
        .with_show_grid(false)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

/// Writes a scene as `name.svg` and `name.png`.
fn save(mut scene: Scene, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
    // XML has no place for control characters, which names in files may hold
    let svg = SvgBackend.render_scene(&scene).replace(|c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t'), "");
    write(&folder(&format!("{name}.svg")), svg.as_bytes())?;
    // the raster backend begins its dashes anew at every point of a line
    dashes::cut(&mut scene);
    let png = PngBackend::new().with_scale(PNG_SCALE).render_scene(&scene)?;
    write(&folder(&format!("{name}.png")), &png)
}

impl Line {
    fn draw(&self) -> Plot {
        let marker = match self.pattern {
            Pattern::Circles => Some(MarkerShape::Circle),
            Pattern::Squares => Some(MarkerShape::Square),
            Pattern::Crosses => Some(MarkerShape::Cross),
            _ => None,
        };
        if let Some(marker) = marker {
            let plot = ScatterPlot::new().with_data(self.points.clone()).with_color(self.colour).with_marker(marker);
            let plot = plot.with_size(4.0);
            return if self.name.is_empty() { plot } else { plot.with_legend(self.name.clone()) }.into();
        }
        let plot = LinePlot::new().with_data(self.points.clone()).with_color(self.colour).with_stroke_width(1.8);
        let plot = match self.pattern.dashes() {
            Some(dashes) => plot.with_line_style(LineStyle::Custom(dashes.into())),
            None => plot,
        };
        if self.name.is_empty() { plot } else { plot.with_legend(self.name.clone()) }.into()
    }
}

impl Chart {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        let (plots, layout) = self.draw();
        save(render_multiple(plots, layout), folder, name)
    }

    fn draw(&self) -> (Vec<Plot>, Layout) {
        let plots: Vec<Plot> = self.lines.iter().map(Line::draw).collect();
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(self.title.clone())
            .with_x_label(self.x_label.clone())
            .with_y_label(self.y_label.clone())
            .with_legend_position(LegendPosition::OutsideRightTop);
        if self.from_zero {
            layout = layout.with_y_axis_min(0.0);
        }
        if self.logarithmic {
            layout = layout.with_log_scale();
        }
        (plots, journal(layout))
    }
}

impl MarkedChart {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        let (plots, layout) = self.draw();
        save(render_multiple(plots, layout), folder, name)
    }

    fn draw(&self) -> (Vec<Plot>, Layout) {
        let (plots, mut layout) = self.chart.draw();
        if let Some((from, to)) = self.x_range {
            layout = layout.with_x_axis_min(from).with_x_axis_max(to);
        }
        if let Some(wanted) = self.y_up_to {
            let ordinates = || self.chart.lines.iter().flat_map(|line| &line.points).map(|point| point.1);
            let (low, high) =
                (ordinates().fold(f64::INFINITY, f64::min), ordinates().fold(f64::NEG_INFINITY, f64::max));
            if high < wanted {
                layout = layout.with_y_axis_max(wanted + 0.05 * (wanted - low));
            }
        }
        for band in &self.bands {
            let region = ShadedRegion::vertical(band.from, band.to).with_color(band.colour).with_opacity(0.2);
            layout = layout.with_shaded_region(region);
        }
        for mark in &self.marks {
            let line = if mark.upright { ReferenceLine::vertical(mark.at) } else { ReferenceLine::horizontal(mark.at) };
            let mut line = line.with_color(mark.colour).with_stroke_width(0.8);
            line = line.with_dasharray(if mark.dotted { "1 3" } else { "5 3" });
            layout = layout.with_reference_line(if mark.label.is_empty() {
                line
            } else {
                line.with_label(mark.label.clone())
            });
        }
        (plots, layout)
    }
}

/// Closed lines about a centre.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarChart {
    /// Heading.
    pub title: String,
    /// Lines of angle (degrees, anticlockwise from the right) and radius; patterns are not drawn.
    pub lines: Vec<Line>,
    /// Radii of the centre and of the rim.
    pub radii: (f64, f64),
}

impl PolarChart {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        let (plots, layout) = self.draw();
        save(render_multiple(plots, layout), folder, name)
    }

    fn draw(&self) -> (Vec<Plot>, Layout) {
        let mut plot = PolarPlot::new().with_theta_start(90.0).with_clockwise(false);
        plot = plot.with_r_min(self.radii.0).with_r_max(self.radii.1).with_legend(true);
        for line in &self.lines {
            let (angles, radii): (Vec<f64>, Vec<f64>) = line.points.iter().copied().unzip();
            plot = if line.name.is_empty() {
                plot.with_series_line(radii, angles)
            } else {
                plot.with_series_labeled(radii, angles, line.name.clone(), PolarMode::Line)
            }
            .with_color(line.colour);
        }
        let plots: Vec<Plot> = vec![plot.into()];
        let layout = Layout::auto_from_plots(&plots).with_title(self.title.clone());
        (plots, journal(layout).with_legend_position(LegendPosition::OutsideRightTop))
    }
}

impl FlankMap {
    /// Writes `name.svg` and `name.png`.
    ///
    /// # Errors
    /// What the file system or the renderer says.
    pub fn save(&self, folder: &dyn Fn(&str) -> std::path::PathBuf, name: &str) -> Result<(), String> {
        let (plots, layout) = self.draw();
        save(render_multiple(plots, layout), folder, name)
    }

    fn draw(&self) -> (Vec<Plot>, Layout) {
        let map = Heatmap::new()
            .with_data(self.values.clone())
            .with_x_range(self.face.0, self.face.1)
            .with_y_range(self.roll.0, self.roll.1)
            .with_cell_size(1.0)
            .with_color_map(ColorMap::Inferno)
            .with_legend(self.quantity.clone());
        let mut plots: Vec<Plot> = vec![map.into()];
        if !self.rim.is_empty() {
            let dots = ScatterPlot::new().with_data(self.rim.clone()).with_color("#7fdfff").with_size(1.0);
            plots.push(dots.into());
        }
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(self.title.clone())
            .with_x_label("Face position (mm)")
            .with_y_label("Roll distance (mm)");
        for (label, roll) in &self.landmarks {
            layout = layout
                .with_reference_line(ReferenceLine::horizontal(*roll).with_color("#ffffff").with_label(label.clone()));
        }
        (plots, journal(layout))
    }
}
