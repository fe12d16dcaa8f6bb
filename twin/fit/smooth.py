"""The measured pressure made fit for a play: raw noise would ratchet it.

The converter model carries the fast part; what the (smoothed) measurement adds is used only as far as it stands out of
its own noise. Where the model explains the pressure, the play is driven by the model and sees no noise at all.
Source: the principle of Wiener, Extrapolation, Interpolation, and Smoothing of Stationary Time Series (1949).
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d, minimum_filter1d

from logs.recording import FloatArray
from twin.fit.channel import pressure_fine
from twin.fit.trial import Trial
from twin.model.plant import Plant
from twin.where.smoother import WHITE, smooth_pressure

#: What smoothing adds to the model drives a valve as far as its square is more than so many variances of its noise.
CAREFUL, BELIEVING = 3.0, 0.0
#: The pressure stays within so many standard deviations of the readings of so many rows before and after.
_OUTSIDE, _AROUND = 4.0, 3


def smoothed_pressure(
    plant: Plant, trial: Trial, sigma: float, correlation: FloatArray = WHITE, care: float = CAREFUL
) -> FloatArray:
    """Smoothed measured pressure on the fine grid. `sigma`: standard deviation of the pressure noise per sample.

    `correlation`: of that noise, at lags of 0, 1, ... rows. `care`: how many times its noise what the measurement adds
    has to be to be believed. With `BELIEVING` all of it is; the difference shows how much is in doubt.
    """
    model = pressure_fine(plant, trial)
    measured = trial.recording.pressure
    if measured is None:
        return model
    period_s, at_rows = trial.recording.period_s, model[trial.grid.offsets]
    smooth, noise = smooth_pressure(measured, at_rows, sigma, period_s, correlation)
    extra = smooth - at_rows
    trusted = extra * _trust(extra, care * noise, period_s) if care > 0.0 else extra
    fine = np.arange(trial.grid.n_fine)
    correction: FloatArray = np.interp(fine, trial.grid.offsets, trusted)
    row = np.searchsorted(trial.grid.offsets, fine, side="right") - 1
    corrected = model + correction
    for low, high in (_no_further(corrected, model, trial.grid.offsets), _bounds(measured, sigma)):
        corrected = np.clip(corrected, low[row], high[row])
    return corrected


def _no_further(corrected: FloatArray, model: FloatArray, rows: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """How low and high `corrected`, both on the fine grid, may be from each of the `rows` to the next: shape (n,) each.

    As low and high as in these two rows, and beyond them as far as `model` goes itself. What a model that is a little
    late lacks on the way up would otherwise be added to where it has arrived, and a play keeps so short a peak, too.
    """
    following = np.append(rows[1:], rows[-1])
    low, high = np.minimum(model[rows], model[following]), np.maximum(model[rows], model[following])
    below, above = low - np.minimum.reduceat(model, rows), np.maximum.reduceat(model, rows) - high
    lower = np.minimum(corrected[rows], corrected[following]) - np.maximum(below, 0.0)
    return lower, np.maximum(corrected[rows], corrected[following]) + np.maximum(above, 0.0)


def noise_left(plant: Plant, trial: Trial, sigma: float, correlation: FloatArray = WHITE) -> FloatArray:
    """Variance of what smoothing leaves of the readings' own noise at each row, shape (n,); see `smoothed_pressure`."""
    measured, model = trial.recording.pressure, pressure_fine(plant, trial)[trial.grid.offsets]
    if measured is None:
        return np.zeros(trial.recording.n)
    return smooth_pressure(measured, model, sigma, trial.recording.period_s, correlation)[1]


def _bounds(measured: FloatArray, sigma: float) -> tuple[FloatArray, FloatArray]:
    """How low and high the pressure may have been about each row, for all that was read: shape (n,) each.

    Where the model steps a little too early or late, what the measurement adds rings; a dip that never was would move
    a play for good.
    """
    known = np.isfinite(measured)
    size = 2 * _AROUND + 1
    low = minimum_filter1d(np.where(known, measured, np.inf), size, mode="nearest") - _OUTSIDE * sigma
    high = maximum_filter1d(np.where(known, measured, -np.inf), size, mode="nearest") + _OUTSIDE * sigma
    bridged = np.isinf(low) | np.isinf(high)
    return np.where(bridged, -np.inf, low), np.where(bridged, np.inf, high)


def _trust(extra: FloatArray, noise: FloatArray, period_s: float) -> FloatArray:
    """Local Wiener gain: 0 where the addition is no larger than its own noise, near 1 where it is."""
    width, known = max(5.0 / period_s, 2.0), np.isfinite(noise)
    added, left = np.where(known, np.square(extra), 0.0), np.where(known, noise, 0.0)
    # both over the same rows: a row whose average is short adds more, and has more noise
    power, expected = (gaussian_filter1d(values, width, mode="nearest") for values in (added, left))
    gain: FloatArray = np.clip(1.0 - expected / np.maximum(power, 1e-300), 0.0, 1.0)
    return gain
