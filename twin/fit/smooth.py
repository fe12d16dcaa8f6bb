"""The measured pressure made fit for a play: raw noise would ratchet it.

The converter model carries the fast part; what the (smoothed) measurement adds is used only as far as it stands out of
its own noise. Where the model explains the pressure, the play is driven by the model and sees no noise at all.
Source: the principle of Wiener, Extrapolation, Interpolation, and Smoothing of Stationary Time Series (1949).
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from logs.recording import FloatArray
from twin.fit.channel import pressure_fine
from twin.fit.trial import Trial
from twin.plant import Plant
from twin.where.smoother import smooth_pressure

WIDTH_S = 1.0


def smoothed_pressure(
    plant: Plant,
    trial: Trial,
    sigma: float,
    correlation_samples: float = 1.0,
    width_s: float = WIDTH_S,
    careful: bool = True,
) -> FloatArray:
    """Smoothed measured pressure on the fine grid. `sigma`: standard deviation of the pressure noise per sample.

    Without `careful` all that the smoothed measurement adds is believed; the difference of the two shows how much the
    pressure is in doubt.
    """
    model = pressure_fine(plant, trial)
    measured = trial.recording.pressure
    if measured is None:
        return model
    period_s = trial.recording.period_s
    at_rows = model[trial.grid.offsets]
    extra = smooth_pressure(measured, at_rows, sigma, period_s, correlation_samples, width_s) - at_rows
    width = max(width_s / period_s, 0.5)
    noise = sigma**2 * min(1.0, correlation_samples / (2.0 * np.sqrt(np.pi) * width))
    trusted = extra * _trust(extra, noise, period_s) if careful else extra
    correction: FloatArray = np.interp(np.arange(trial.grid.n_fine), trial.grid.offsets, trusted)
    return model + correction


def _trust(extra: FloatArray, noise: float, period_s: float) -> FloatArray:
    """Local Wiener gain: 0 where the addition is no larger than its own noise, near 1 where it is."""
    power = gaussian_filter1d(extra**2, max(5.0 / period_s, 2.0), mode="nearest")
    gain: FloatArray = np.clip(1.0 - 2.5 * noise / np.maximum(power, 1e-300), 0.0, 1.0)
    return gain
