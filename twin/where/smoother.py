"""Measured pressure with its noise taken off and its edges left on, fit to drive a model with play.

A play ratchets on noise: driven by a raw reading it creeps to the outermost excursions. A plain filter would round the
steps instead. So only what the reading adds to the model's pressure is filtered, at every sample as widely as the
reading allows. Source: Lepski, "On a problem of adaptive estimation in Gaussian white noise", 1990 (choice of width).
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from logs.recording import FloatArray

_WIDTHS_S = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)  # standard deviations of the bell; "about 1 s" is where plain data ends up
_DIFFER = 4.0


def smooth_pressure(
    measured: FloatArray,
    model: FloatArray,
    noise_sigma: float,
    period_s: float,
    correlation_samples: float = 1.0,
    widest_s: float = 1.0,
) -> FloatArray:
    """A(c) + lowpass(p - A(c)), without delay, shape (n,): `model` is A(c), the pressure the model has for the command.

    At each sample the widest bell (standard deviation up to `widest_s`) is used whose average does not differ from any
    narrower one by more than four sigmas of their noise. Missing readings are bridged by their neighbours.
    """
    known = np.isfinite(measured)
    if not known.any():
        return model.copy()
    excess = np.where(known, measured - model, 0.0)
    weight = known.astype(np.float64)
    bridge = np.interp(np.arange(excess.size), np.flatnonzero(known), excess[known])
    chosen = np.where(known, excess, bridge)
    if noise_sigma <= 0.0:
        return model + chosen
    levels: list[tuple[FloatArray, float, float]] = [(chosen, noise_sigma, noise_sigma)]
    open_here = np.ones(excess.size, dtype=bool)
    for width_s in [w for w in _WIDTHS_S if w <= widest_s] + [widest_s]:
        width = width_s / period_s
        if width < 0.3:
            continue
        total = gaussian_filter1d(excess * weight, width, mode="nearest")
        mass = gaussian_filter1d(weight, width, mode="nearest")
        level = np.where(mass > 1e-3, total / np.maximum(mass, 1e-3), bridge)
        # independent readings under a bell: 2 sqrt(pi) width, fewer when the noise has memory
        white = noise_sigma * min(1.0, np.sqrt(1.0 / (2.0 * np.sqrt(np.pi) * width)))
        sigma = noise_sigma * min(1.0, np.sqrt(correlation_samples / (2.0 * np.sqrt(np.pi) * width)))
        clash = np.zeros(excess.size, dtype=bool)
        for narrow, narrow_sigma, narrow_white in levels[1:]:
            # of a memory that was made too long nothing would be left for two narrow bells to differ by
            spread = max(narrow_sigma**2 - sigma**2, narrow_white**2 - white**2, 0.01 * sigma**2)
            clash |= np.abs(level - narrow) > _DIFFER * np.sqrt(spread)
        # one clash shuts the whole bell: its neighbours average over the same edge
        open_here &= ~np.asarray(maximum_filter1d(clash.astype(np.int8), 2 * round(width) + 1), dtype=bool)
        chosen = np.where(open_here, level, chosen)
        levels.append((level, sigma, white))
    return model + chosen
