"""Pure delay between command and pressure, read from the whole response to whatever commands there were.

One lag with delay d, gain and offset, solved exactly for a held command:  p[i] = e p[i-1] + w1 u[i-m-1] + w0 u[i-m].
The delay is the one of least squared error with lag, gain and offset refitted for each; its interval is where that
error rises by the 95 % point of chi-square. Source: Björklund, "A survey and comparison of time-delay estimation
methods in linear systems", Linköping 2003 (explicit one-parameter methods with a first-order model).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.signal import lfilter
from scipy.stats import chi2

from logs.recording import FloatArray
from twin.diagnosis import Estimate
from twin.events.evidence import Evidence, nothing

_MOST = 20_000  # readings: enough for a thousandth of a sampling period on ordinary records


def delay(
    time_s: FloatArray,
    command: FloatArray,
    pressure: FloatArray,
    noise_sigma: float,
    correlation_samples: float = 1.0,
    longest_s: float = 2.0,
) -> Evidence:
    """Evidence for `dead_time`; `command[i]` is in force over the interval that ends at `time_s[i]`.

    Estimates: `delay` [s] and the `lag` [s] that goes with it. A second, short lag looks like a delay below about one
    sampling period.
    """
    known = np.isfinite(pressure)
    if known.sum() < 100 or float(np.ptp(command)) <= 10.0 * noise_sigma:
        return nothing("dead_time", "the command hardly moves: no delay could show")
    fit = _Fit.prepared(time_s[known][:_MOST], command[known][:_MOST], pressure[known][:_MOST])
    longest = min(longest_s, 0.2 * float(fit.u.size) * fit.dt)
    grid = np.arange(0.0, longest + 1e-12, max(0.5 * fit.dt, longest / 40))
    lags = np.geomspace(max(0.02, 0.1 * fit.dt), 5.0, 12)
    table = np.array([[fit.error(float(d), float(lag)) for lag in lags] for d in grid])
    row, column = np.unravel_index(int(table.argmin()), table.shape)
    value, lag, least = fit.best(float(grid[row]), float(lags[column]))
    none, _ = fit.profile(0.0, float(lags[table[0].argmin()]))
    # what one lag cannot explain counts as noise as well: a mere misfit of the lag must not look like certainty
    variance = max(noise_sigma**2, least / fit.u.size) * correlation_samples
    ratio = max(0.0, (none - least) / (2.0 * variance))
    half = _half_width(fit, value, lag, least, variance)
    low, high = value - half, value + half
    estimates = {"delay": Estimate(value, (max(low, 0.0), high), "s"), "lag": Estimate(lag, (lag, lag), "s")}
    return Evidence("dead_time", ratio, float(chi2.sf(2.0 * ratio, 1)) / 2.0 if ratio > 0 else 1.0, estimates)


@dataclass(frozen=True, slots=True)
class _Fit:
    dt: float
    u: FloatArray
    p: FloatArray

    @classmethod
    def prepared(cls, time_s: FloatArray, command: FloatArray, pressure: FloatArray) -> _Fit:
        """The signals on an even grid, about their means."""
        dt = float(np.median(np.diff(time_s)))
        at = np.arange(time_s[0], time_s[-1] + 0.25 * dt, dt)
        rows = np.clip(np.searchsorted(time_s, at - 1e-6 * dt), 0, time_s.size - 1)
        return cls(dt, command[rows], np.interp(at, time_s, pressure))

    def error(self, delay_s: float, lag_s: float) -> float:
        """Least squared error over gain and offset."""
        x = self.response(delay_s, lag_s)
        x, y = x - x.mean(), self.p - self.p.mean()
        power = _dot(x, x)
        return _dot(y, y) - (_dot(x, y) ** 2 / power if power > 0 else 0.0)

    def response(self, delay_s: float, lag_s: float) -> FloatArray:
        whole, part = divmod(delay_s, self.dt)
        rest = np.exp(-(self.dt - part) / lag_s)
        decay = np.exp(-self.dt / lag_s)
        late = _shifted(self.u, int(whole))
        drive = (1.0 - rest) * late + (rest - decay) * _shifted(late, 1)
        return np.asarray(lfilter([1.0], [1.0, -decay], drive, zi=[decay * self.u[0]])[0])

    def best(self, delay_s: float, lag_s: float) -> tuple[float, float, float]:
        """Delay and lag of least squared error near the given ones, and that error."""
        found = minimize(
            lambda x: self.error(abs(float(x[0])), float(np.exp(x[1]))),
            [delay_s + 0.1 * self.dt, np.log(lag_s)],
            method="Nelder-Mead",
            options={
                "initial_simplex": [
                    [delay_s, np.log(lag_s)],
                    [delay_s + self.dt, np.log(lag_s)],
                    [delay_s, np.log(1.5 * lag_s)],
                ],
                "xatol": 1e-4 * self.dt,
                "maxfev": 200,
            },
        )
        return abs(float(found.x[0])), float(np.exp(found.x[1])), float(found.fun)

    def profile(self, delay_s: float, lag_s: float) -> tuple[float, float]:
        """Least squared error over the lag, started near `lag_s`, and that lag."""
        bounds = (np.log(max(lag_s / 3.0, 1e-3)), np.log(lag_s * 3.0))
        found = minimize_scalar(
            lambda x: self.error(delay_s, float(np.exp(x))), bounds=bounds, method="bounded", options={"xatol": 1e-3}
        )
        return float(found.fun), float(np.exp(found.x))


def _dot(x: FloatArray, y: FloatArray) -> float:
    """A dot product on this thread alone: for so short a sum a pool of threads costs more than it saves."""
    return float(np.einsum("i,i->", x, y))


def _half_width(fit: _Fit, delay_s: float, lag: float, least: float, variance: float) -> float:
    """Half the 95 % interval from the curvature of the squared error at the minimum."""
    step = 0.25 * fit.dt
    rise = 0.5 * sum(fit.profile(max(delay_s + s, 0.0), lag)[0] - least for s in (-step, step))
    return float(step * np.sqrt(3.84 * variance / rise)) if rise > 0 else fit.dt


def _shifted(u: FloatArray, rows: int) -> FloatArray:
    return u if rows == 0 else np.concatenate([np.full(rows, u[0]), u[:-rows]])
