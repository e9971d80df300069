//! Notes on a recording case: keys without effect.

use super::resolve::{GaussianLimit, HealthyLimit, LimitSource, RecordingCase, TachometerSource};
use crate::document::Node;
use crate::notes::Notes;

/// Endings of files that are not text.
const BINARY: [&str; 4] = ["wav", "npy", "mat", "parquet"];

/// Notes on a resolved case.
pub(super) fn notes(case: &RecordingCase, document: &Node) -> Notes {
    let mut notes = Notes::default();
    let mut idle = |section: &str, keys: &[&str], because: &str| notes.without_effect(document, section, keys, because);
    let ending = case.signal.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    if ending.as_deref().is_some_and(|ending| BINARY.contains(&ending)) {
        idle("signal", &["delimiter", "decimal_comma", "header_lines"], "only text files have it");
    }
    match case.tachometer {
        TachometerSource::Channel(..) => {}
        TachometerSource::File(_) => {
            idle("tachometer", &["level", "hysteresis", "edge"], "the file holds times of pulses")
        }
        TachometerSource::Speed(_) => {
            let keys = ["level", "hysteresis", "edge", "pulses_per_turn"];
            idle("tachometer", &keys, "the speed is constant: there are no pulses");
        }
    }
    if case.inputs.difference.sideband_pairs == 0 && case.inputs.difference.shaft_orders == 0 {
        idle("difference", &["sideband_spacing"], "neither sidebands nor shaft orders are removed");
    }
    let used = match case.limits {
        LimitSource::Gaussian(GaussianLimit::FalseAlarms(_))
        | LimitSource::Healthy(_, HealthyLimit::FalseAlarms(_)) => "false_alarm_rate",
        LimitSource::Gaussian(GaussianLimit::Sigmas(_)) | LimitSource::Healthy(_, HealthyLimit::MeanPlusSigmas(_)) => {
            "sigmas"
        }
        LimitSource::Healthy(_, HealthyLimit::Quantile(_)) => "quantile",
    };
    let unused = ["false_alarm_rate", "sigmas", "quantile"].into_iter().filter(|key| *key != used);
    idle("thresholds", &unused.collect::<Vec<_>>(), &format!("limits are made from thresholds.{used}"));
    if case.signal.is_file()
        || ending.is_some_and(|ending| hums::io::is_recording(std::path::Path::new(&format!("x.{ending}"))))
    {
        idle("thresholds", &["alarm_hits", "alarm_window"], "a single recording has no trend");
        idle("", &["memory"], "a single recording has no trend");
    }
    notes
}
