//! Figures of transmissions.

use hums::indicator::Indicator;
use hums::spectrum::{Spectrum, Window};

use super::recording::Figure;
use super::{COLOURS, Chart, Line, Mark, MarkedChart, Pattern, polar, thinned};
use gearwright_results::transmission::{Averaging, Findings, Sensor, State};

/// Spectra are drawn up to this frequency (Hz): what 50 steps a mesh cycle resolve of a helicopter's transmission.
const HIGHEST: f64 = 10e3;
/// Sideband pairs that the approximate difference signal of the figures loses.
const PAIRS: usize = 1;
const PATTERNS: [Pattern; 4] = [Pattern::Solid, Pattern::Dashed, Pattern::DashDotted, Pattern::Dotted];
/// Indicators that get a figure over the states, and the signal they are computed from: as recorded or averaged, or a difference signal.
const BY_STATE: [(&str, &str); 11] = [
    ("rms", "raw"),
    ("crest_factor", "raw"),
    ("kurtosis", "raw"),
    ("energy_operator", "raw"),
    ("rms", "difference"),
    ("fm4", "difference"),
    ("m8a", "difference"),
    ("energy_ratio", "difference"),
    ("rms", "exact_difference"),
    ("fm4", "exact_difference"),
    ("m8a", "exact_difference"),
];

fn line(name: &str, index: usize, points: Vec<(f64, f64)>) -> Line {
    let (pattern, colour) = (PATTERNS[index % PATTERNS.len()], COLOURS[index % COLOURS.len()]);
    Line { name: name.into(), points: thinned(&points), pattern, colour }
}

fn chart(title: String, labels: [&str; 2], lines: Vec<Line>) -> Chart {
    let [x_label, y_label] = labels.map(str::to_owned);
    Chart { title, x_label, y_label, lines, from_zero: false, logarithmic: false }
}

fn marked(chart: Chart, x_range: Option<(f64, f64)>, marks: Vec<Mark>) -> Figure {
    let y_up_to = marks.iter().filter(|mark| !mark.upright).map(|mark| mark.at).reduce(f64::max);
    Figure::Chart(MarkedChart { chart, marks, bands: Vec::new(), x_range, y_up_to })
}

/// All figures with their names.
#[must_use]
pub fn all(title: &str, findings: &Findings) -> Vec<(String, Figure)> {
    let mut figures = Vec::new();
    let sensors: Vec<(usize, &Sensor)> = findings.shown(false).collect();
    for (number, &(index, sensor)) in sensors.iter().enumerate() {
        let name = |what: &str| if sensors.len() > 1 { format!("{what}_{}", number + 1) } else { what.to_owned() };
        let drawing = Drawing { title: heading(title, &sensor.name), findings, index };
        figures.extend(drawing.all().into_iter().map(|(what, figure)| (name(&what), figure)));
    }
    figures.extend(around(findings));
    figures.push(("mesh_forces".into(), mesh_forces(title, findings)));
    figures
}

fn heading(title: &str, rest: &str) -> String {
    if title.is_empty() { rest.to_owned() } else { format!("{title}: {rest}") }
}

/// Figures of one sensor.
struct Drawing<'a> {
    title: String,
    findings: &'a Findings,
    index: usize,
}

impl Drawing<'_> {
    fn all(&self) -> Vec<(String, Figure)> {
        let mut figures = vec![("acceleration".to_owned(), self.acceleration()), ("spectrum".into(), self.spectrum())];
        if self.findings.states.len() > 1 {
            for (k, period) in self.findings.periods.iter().enumerate() {
                let name = period.averaging.name();
                figures.push((format!("exact_difference_{name}"), self.difference(k, true)));
                figures.push((format!("exact_difference_spectrum_{name}"), self.difference_spectrum(k)));
                figures.push((format!("approximate_difference_{name}"), self.difference(k, false)));
            }
            figures.extend(self.by_state());
        }
        figures.push(("fm4_by_sidebands".into(), self.by_sidebands()));
        figures
    }

    /// A line for each state, unbroken: signals are too dense for dashes.
    fn lines(&self, points: impl Fn(&State) -> Option<Vec<(f64, f64)>>) -> Vec<Line> {
        let states = self.findings.states.iter().enumerate();
        let unbroken =
            |k: usize, state: &State| Some(Line { pattern: Pattern::Solid, ..line(&state.name, k, points(state)?) });
        states.filter_map(|(k, state)| unbroken(k, state)).collect()
    }

    fn over_turns(&self, signal: &[f64]) -> Vec<(f64, f64)> {
        signal.iter().enumerate().map(|(k, x)| (self.findings.turn(k), *x)).collect()
    }

    fn acceleration(&self) -> Figure {
        let mut lines = self.lines(|state| Some(self.over_turns(&state.signals[self.index])));
        // the worst behind, the healthy one in front
        lines.reverse();
        let end = self.findings.states.first().map(|state| self.findings.turn(state.run.len()));
        marked(
            chart(self.title.clone(), ["Carrier turns", "Acceleration (g)"], lines),
            end.map(|end| (0.0, end)),
            vec![],
        )
    }

    fn amplitudes(signal: &[f64], time_step: f64) -> Option<Vec<(f64, f64)>> {
        let spectrum = Spectrum::of(signal, Window::Rectangular).ok()?;
        let lines = spectrum.frequencies(1.0 / time_step).into_iter().zip(spectrum.amplitudes()).skip(1);
        Some(lines.take_while(|(frequency, _)| *frequency <= HIGHEST).collect())
    }

    fn spectrum(&self) -> Figure {
        let healthy = self.findings.states.iter().take(1).enumerate();
        let lines = healthy.filter_map(|(k, state)| {
            Some(line(&state.name, k, Self::amplitudes(&state.signals[self.index], state.run.sample_time)?))
        });
        let labels = ["Frequency (Hz)", "Amplitude (g)"];
        marked(Chart { from_zero: true, ..chart(self.title.clone(), labels, lines.collect()) }, None, vec![])
    }

    fn difference(&self, period: usize, exact: bool) -> Figure {
        let lines = self.lines(|state| {
            let averaged = state.judged[self.index].averages.get(period)?;
            let signal = if exact {
                averaged.exact.as_ref()?
            } else {
                averaged.approximate.get(PAIRS).or(averaged.approximate.last())?
            };
            Some(self.over_turns(signal))
        });
        let kind = if exact { "Exact difference signal (g)" } else { "Approximate difference signal (g)" };
        let samples = self.findings.periods[period].samples;
        let title = format!("{}, averaged over {}", self.title, period_name(self.findings.periods[period].averaging));
        marked(chart(title, ["Carrier turns", kind], lines), Some((0.0, self.findings.turn(samples))), vec![])
    }

    fn difference_spectrum(&self, period: usize) -> Figure {
        let lines = self.lines(|state| {
            let exact = state.judged[self.index].averages.get(period)?.exact.as_ref()?;
            Self::amplitudes(exact, state.run.sample_time)
        });
        let title = format!("{}, averaged over {}", self.title, period_name(self.findings.periods[period].averaging));
        let labels = ["Frequency (Hz)", "Exact difference signal (g)"];
        marked(Chart { from_zero: true, ..chart(title, labels, lines) }, None, vec![])
    }

    fn by_sidebands(&self) -> Figure {
        let averaging = self.findings.shortest();
        let lines = self.lines(|state| {
            let pairs = state.judged[self.index].averages.first()?.approximate.len();
            let value = |k: usize| {
                Some((k as f64, state.judged[self.index].value(averaging, &format!("difference_{k}"), "fm4")?))
            };
            Some((0..pairs).filter_map(value).collect())
        });
        let title = format!("{}, averaged over {}", self.title, period_name(averaging));
        marked(chart(title, ["Sideband pairs removed", "FM4"], lines), None, gaussian("fm4"))
    }

    /// Indicators over the states, healthy first, by averaging.
    fn by_state(&self) -> Vec<(String, Figure)> {
        let averages = std::iter::once(Averaging::None).chain(self.findings.periods.iter().map(|p| p.averaging));
        let averages: Vec<Averaging> = averages.collect();
        let figure = |&(indicator, kind): &(&str, &str)| {
            let lines = averages.iter().enumerate().map(|(index, &averaging)| {
                let signal = match (kind, averaging) {
                    ("raw", Averaging::None) => "raw".to_owned(),
                    ("raw", _) => "tsa".to_owned(),
                    ("difference", _) => format!("difference_{PAIRS}"),
                    (exact, _) => exact.to_owned(),
                };
                let value = |state: &State| state.judged[self.index].value(averaging, &signal, indicator);
                let states = self.findings.states.iter().enumerate();
                let points = states.filter_map(|(k, state)| Some((k as f64, value(state)?))).collect();
                let name = match averaging {
                    Averaging::None => "no average".to_owned(),
                    other => format!("over {}", period_name(other)),
                };
                line(&name, index, points)
            });
            let lines: Vec<Line> = lines.filter(|line| !line.points.is_empty()).collect();
            let label = format!("{} of the {} signal", indicator.replace('_', " "), kind.replace('_', " "));
            let labels = ["State (0: healthy)", label.as_str()];
            let marks = if kind == "raw" { Vec::new() } else { gaussian(indicator) };
            let figure = marked(chart(self.title.clone(), labels, lines), None, marks);
            (format!("indicator_{indicator}_{kind}"), figure)
        };
        BY_STATE.iter().map(figure).collect()
    }
}

fn period_name(averaging: Averaging) -> &'static str {
    match averaging {
        Averaging::None => "nothing",
        Averaging::PlanetPass => "planet passes",
        Averaging::Carrier => "carrier turns",
    }
}

/// A mark at the value of an indicator for Gaussian noise, for those of difference signals.
fn gaussian(indicator: &str) -> Vec<Mark> {
    let known = [Indicator::Fm4, Indicator::M8a].into_iter().find(|known| known.name() == indicator);
    let at = known.and_then(Indicator::gaussian_value);
    at.map(|at| Mark { at, upright: false, label: String::new(), colour: COLOURS[4], dotted: false })
        .into_iter()
        .collect()
}

/// ln FM4 about the housing of every damaged state: exact and approximate difference signals, and the value of Gaussian noise.
fn around(findings: &Findings) -> Vec<(String, Figure)> {
    let mut figures = Vec::new();
    let Some(threshold) = Indicator::Fm4.gaussian_value() else { return figures };
    for state in findings.states.iter().filter(|state| state.number.is_some()) {
        for averaging in std::iter::once(Averaging::None).chain(findings.periods.iter().map(|p| p.averaging)) {
            let closed = |signal: &str| {
                let places = findings.sensors.iter().zip(&state.judged).filter(|(sensor, _)| !sensor.named);
                polar::closed(places.filter_map(|(sensor, judged)| {
                    let value = judged.value(averaging, signal, "fm4")?;
                    Some((sensor.angle_deg, value.ln()))
                }))
            };
            let whole =
                |name: &str, colour, points| Line { name: name.into(), points, pattern: Pattern::Solid, colour };
            let exact = closed("exact_difference");
            let limit = exact.iter().map(|(angle, _)| (*angle, threshold.ln())).collect();
            let lines = vec![
                whole("exact", COLOURS[2], exact),
                whole("approximate", COLOURS[1], closed(&format!("difference_{PAIRS}"))),
                whole("threshold", COLOURS[4], polar::rounded(limit)),
            ];
            let of = match averaging {
                Averaging::None => "unaltered".to_owned(),
                other => format!("averaged over {}", period_name(other)),
            };
            let quantity = polar::Quantity {
                name: "ln FM4".into(),
                of: format!("({}, {of})", state.name),
                unit: "",
                rescaled: false,
            };
            // the state and the average take the room of the case's title
            if let Some(chart) = polar::about_housing("", &quantity, lines) {
                figures.push((format!("polar_fm4_{}{}", averaging.name(), state.suffix()), Figure::Polar(chart)));
            }
        }
    }
    figures
}

/// Forces of the meshes of the first planet, and of a bevel stage, over the shortest period, healthy.
fn mesh_forces(title: &str, findings: &Findings) -> Figure {
    let samples = findings.periods.first().map_or(findings.samples_per_turn, |period| period.samples);
    let shown =
        findings.states.iter().take(1).flat_map(|state| {
            state.run.meshes.iter().filter(|mesh| mesh.name.ends_with(" 1") || !mesh.name.contains(' '))
        });
    let lines = shown.enumerate().map(|(k, mesh)| {
        let points = mesh.force.iter().take(samples).enumerate().map(|(k, f)| (findings.turn(k), f * 1e-3));
        line(&mesh.name, k, points.collect())
    });
    let labels = ["Carrier turns", "Mesh force (kN)"];
    let chart = chart(heading(title, "healthy"), labels, lines.collect());
    marked(chart, Some((0.0, findings.turn(samples))), vec![])
}
