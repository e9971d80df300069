"""Reference values for tests/scipy.rs: `python scipy_reference.py > scipy_reference.txt`.

Written with scipy 1.17.1 and numpy 2.4.6. Every line: name, colon, values with 17 digits.
"""

import numpy as np
from scipy import interpolate, signal, stats

rng = np.random.default_rng(20240607)
n = 600
t = np.arange(n) / 5120.0
x = (
    0.7
    + 1.3 * np.sin(2 * np.pi * 311.0 * t + 0.4)
    + rng.normal(0.0, 0.8, n)
    + np.where(np.arange(n) % 97 == 13, 4.0, 0.0)
)


def put(name, values):
    print(name + ": " + " ".join(f"{v:.17g}" for v in np.atleast_1d(values)))


put("signal", x)
put("mean", x.mean())
put("variance", x.var())
put("rms", np.sqrt(np.mean(x**2)))
put("skewness", stats.skew(x))
put("kurtosis", stats.kurtosis(x, fisher=False))
sigma = x.std()
put("m6a", stats.moment(x, 6) / sigma**6)
put("m8a", stats.moment(x, 8) / sigma**8)
put("s_2.5", np.mean(np.abs(x - x.mean()) ** 2.5) / sigma**2.5)
teager = x**2 - np.roll(x, 1) * np.roll(x, -1)
put("energy_operator", stats.kurtosis(teager, fisher=False))
put("envelope", np.abs(signal.hilbert(x)))
put("odd_envelope", np.abs(signal.hilbert(x[:599])))
f, p = signal.welch(x, 5120.0, window="hann", nperseg=128, noverlap=64, detrend="constant")
put("welch_frequencies", f)
put("welch_density", p)
put("flattop", signal.windows.flattop(64, sym=False))
put("amplitudes", np.abs(np.fft.rfft(x)) * np.r_[1.0, np.full(n // 2 - 1, 2.0), 1.0] / n)
put("detrended", signal.detrend(x))
where = np.sort(rng.uniform(0.0, n - 1.0, 200))
put("spline_positions", where)
put("spline_values", interpolate.CubicSpline(np.arange(n), x)(where))
put("quantiles", np.quantile(x, [0.0, 0.05, 0.5, 0.9, 0.999, 1.0]))
scores_healthy, scores_damaged = x[:200], x[200:400] + 0.5
u = stats.mannwhitneyu(scores_damaged, scores_healthy).statistic
put("area_under_roc", u / (200 * 200))
