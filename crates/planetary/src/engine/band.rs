//! Records of a stated band.
//!
//! A record is the convolution of the motion in continuous time with a kernel, sampled every few steps: a low-pass of linear phase without delay, the inverse transform of a
//! rectangle under a Kaiser window (J. F. Kaiser, R. W. Schafer, *IEEE Trans. ASSP* 28, 1980, 105-107), lowered to end at 0. Within a step the motion is the polynomial of its
//! stages, and the integral over it is exact; the acceleration of a sensor is filtered as its rate with the derivative of the kernel, so that jumps of forces and of
//! accelerations between steps need no special care. So nothing above the band folds back into a record, whatever the step resolves.
//!
//! | symbol | is |
//! |---|---|
//! | `B` | the band (Hz): up to it the response is 1 to 1e-3 |
//! | `f_s` | rate of the samples (Hz), more than twice `B`; from `f_s - B` on the response is below 1e-3, from `f_s / 2` on what would fold back lies above the band |

use fecm::element::lagrange::gauss_rule;

use super::stages::{Stages, lagrange};
use crate::error::PlanetaryError;

/// Attenuation of the stop band (dB), and of ripples in the band.
const ATTENUATION: f64 = 80.0;
/// Part of half the sample rate that the band may fill at most.
const FILL: f64 = 0.95;
/// Points of the rule for the integral of the kernel over a step.
const POINTS: usize = 12;

/// Band of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Highest frequency that is recorded as it is (Hz).
    pub frequency: f64,
    /// Steps from one sample to the next, one or more.
    pub steps_per_sample: usize,
}

impl Band {
    /// Steps before and after a sample that it depends on, for a time step (s).
    #[must_use]
    pub fn lead_steps(&self, time_step: f64) -> usize {
        let transition = 0.5 / (self.steps_per_sample as f64 * time_step) - self.frequency;
        let length = (ATTENUATION - 7.95) / (14.36 * transition.max(f64::MIN_POSITIVE));
        (0.5 * length / time_step).ceil() as usize
    }

    pub(super) fn check(&self, time_step: f64) -> Result<(), PlanetaryError> {
        let steps = self.steps_per_sample as f64;
        let good = (1..=10_000).contains(&self.steps_per_sample);
        PlanetaryError::check(good, || "steps per sample".into(), steps, "1 to 10,000")?;
        let fill = 2.0 * self.frequency * steps * time_step;
        let what = || "band over half the sample rate".into();
        PlanetaryError::check(fill > 1e-3 && fill <= FILL, what, fill, "0.001 to 0.95")
    }

    /// Response of the filter at a frequency (Hz): the factor of an amplitude.
    #[must_use]
    pub fn response(&self, time_step: f64, frequency: f64) -> f64 {
        let half = self.lead_steps(time_step);
        let kernel = Kernel::new(self, time_step, half);
        let turn = 2.0 * std::f64::consts::PI * frequency * time_step;
        kernel.integrate(half, |x| (turn * x).cos())
    }
}

/// Low-pass kernel.
struct Kernel {
    step: f64,
    cut_off: f64,
    half: f64,
    shape: f64,
    scale: f64,
}

impl Kernel {
    fn new(band: &Band, step: f64, half: usize) -> Self {
        let cut_off = 0.5 * (band.frequency + 0.5 / (band.steps_per_sample as f64 * step));
        let shape = 0.1102 * (ATTENUATION - 8.7);
        let mut kernel = Self { step, cut_off, half: half as f64 * step, shape, scale: 1.0 };
        kernel.scale = 1.0 / kernel.integrate(half, |_| 1.0);
        kernel
    }

    /// Value at a time from the sample, in steps.
    fn at(&self, steps: f64) -> f64 {
        let time = steps * self.step;
        let part = time / self.half;
        if part.abs() >= 1.0 {
            return 0.0;
        }
        let window = (bessel_i0(self.shape * (1.0 - part * part).sqrt()) - 1.0) / (bessel_i0(self.shape) - 1.0);
        let x = 2.0 * std::f64::consts::PI * self.cut_off * time;
        let sinc = if x == 0.0 { 1.0 } else { x.sin() / x };
        self.scale * 2.0 * self.cut_off * sinc * window
    }

    /// Integral over time of the kernel times a function of the time in steps.
    fn integrate(&self, half: usize, f: impl Fn(f64) -> f64) -> f64 {
        let rule = gauss_rule(POINTS);
        let first = -(half as i64);
        let sum = |m: i64| -> f64 {
            rule.iter().map(|(x, w)| (m as f64 + 0.5 * (x + 1.0), 0.5 * w)).map(|(x, w)| w * self.at(x) * f(x)).sum()
        };
        (first..-first).map(sum).sum::<f64>() * self.step
    }
}

/// Modified Bessel function of the first kind of order 0, by its series.
fn bessel_i0(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= (0.5 * x / k) * (0.5 * x / k);
        sum += term;
        k += 1.0;
    }
    sum
}

/// Weights of the stages of the steps around a sample.
#[derive(Debug, Clone)]
pub(super) struct BandWeights {
    /// Steps before and after a sample.
    pub half: usize,
    pub steps_per_sample: usize,
    stages: usize,
    /// For values, a step after the other.
    values: Vec<f64>,
    /// For rates, to give accelerations.
    rates: Vec<f64>,
}

impl BandWeights {
    pub fn new(band: &Band, stages: &Stages, step: f64) -> Self {
        let (half, s) = (band.lead_steps(step), stages.count);
        let kernel = Kernel::new(band, step, half);
        let rule = gauss_rule(POINTS);
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        for m in -(half as i64)..half as i64 {
            for i in 0..s {
                let (mut value, mut rate) = (0.0, 0.0);
                for (x, w) in &rule {
                    let (x, w) = (0.5 * (x + 1.0), 0.5 * w);
                    let (polynomial, derivative) = lagrange(&stages.nodes, i, x);
                    // the kernel is even
                    let own = w * kernel.at(m as f64 + x);
                    value += step * own * polynomial;
                    rate += own * derivative;
                }
                let end = |at: f64, x: f64| kernel.at(at) * lagrange(&stages.nodes, i, x).0;
                // the integral of w'(t_k - t) v(t), by parts
                rate -= end(m as f64 + 1.0, 1.0) - end(m as f64, 0.0);
                values.push(value);
                rates.push(rate);
            }
        }
        Self { half, steps_per_sample: band.steps_per_sample, stages: s, values, rates }
    }
}

/// Channels of values and of accelerations of one length, filtered.
#[derive(Debug)]
pub(super) struct BandRecorder {
    weights: BandWeights,
    /// Steps taken.
    steps: usize,
    samples: usize,
    /// Samples under way, the first first: values, then accelerations.
    open: std::collections::VecDeque<Vec<f64>>,
    /// Samples begun.
    begun: usize,
}

impl BandRecorder {
    /// For so many samples.
    pub fn new(weights: BandWeights, samples: usize) -> Self {
        Self { weights, steps: 0, samples, open: std::collections::VecDeque::new(), begun: 0 }
    }

    /// Takes the stages of a step: values of channels and rates of others, one stage after the other. Gives a sample that is complete: values, then accelerations.
    pub fn take(&mut self, values: &[f64], rates: &[f64]) -> Option<Vec<f64>> {
        let BandWeights { half, steps_per_sample: every, stages: s, .. } = self.weights;
        let (channels, others) = (values.len() / s, rates.len() / s);
        while self.begun < self.samples && self.begun * every <= self.steps {
            self.open.push_back(vec![0.0; channels + others]);
            self.begun += 1;
        }
        let first = self.begun - self.open.len();
        for (k, sample) in self.open.iter_mut().enumerate() {
            // steps since the first that this sample depends on
            let m = self.steps - (first + k) * every;
            let (own, derived) = sample.split_at_mut(channels);
            for i in 0..s {
                let at = m * s + i;
                super::dense::axpy(own, self.weights.values[at], &values[i * channels..(i + 1) * channels]);
                super::dense::axpy(derived, self.weights.rates[at], &rates[i * others..(i + 1) * others]);
            }
        }
        self.steps += 1;
        let is_complete = !self.open.is_empty() && self.steps == first * every + 2 * half;
        if is_complete { self.open.pop_front() } else { None }
    }

    /// Steps that all samples together need.
    pub fn steps_needed(weights: &BandWeights, samples: usize) -> usize {
        samples.checked_sub(1).map_or(0, |last| last * weights.steps_per_sample + 2 * weights.half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The band passes, what would fold into it does not; accelerations of a tone are those of its rates.
    #[test]
    fn analytic_response() {
        let (step, stages) = (3.0e-5, Stages::new(3));
        let band = Band { frequency: 10e3, steps_per_sample: 1 };
        for (frequency, expected) in [(0.0, 1.0), (3e3, 1.0), (9.99e3, 1.0), (1.0 / step - 10e3, 0.0), (4e4, 0.0)] {
            let response = band.response(step, frequency);
            assert!((response - expected).abs() < 1e-3, "{frequency}: {response}");
        }
        let weights = BandWeights::new(&band, &stages, step);
        let w = 2.0 * std::f64::consts::PI * 4e3;
        let mut recorder = BandRecorder::new(weights.clone(), 40);
        let mut found = Vec::new();
        for n in 0..BandRecorder::steps_needed(&weights, 40) {
            let times = stages.nodes.iter().map(|x| (n as f64 + x) * step);
            let (value, rate): (Vec<f64>, Vec<f64>) = times.map(|t| ((w * t).sin(), w * (w * t).cos())).unzip();
            found.extend(recorder.take(&value, &rate));
        }
        assert_eq!(found.len(), 40);
        for (k, sample) in found.iter().enumerate() {
            let exact = (w * (k + weights.half) as f64 * step).sin();
            assert!((sample[0] - exact).abs() < 1e-3, "{k}: {} {exact}", sample[0]);
            assert!((sample[1] / (w * w) + exact).abs() < 1e-3, "{k}: {} {exact}", sample[1]);
        }
    }
}
