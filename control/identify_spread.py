"""How far the fitted numbers may be off: for noise of the position, and for noise of the pressure that drove the play.

The second is no ordinary noise: a play keeps the peaks of what drives it. So the smoothed pressure is disturbed by
noise like its own, and the change of the prediction is carried through the fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from control.identify_interval import covariance
from control.identify_track import Track
from control.identify_valve import Freedom, ValveFit, jacobian
from logs.recording import FloatArray


def spread_of(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> tuple[FloatArray, int]:
    """Covariance of the fitted numbers (then the starts of the play), shape (p, p), and its degrees of freedom."""
    slopes, residual = jacobian(tracks, fit, freedom), fit.residual(tracks)
    spread, rows = covariance(slopes, residual)
    count = min(len(track.doubts) for track in tracks)
    active = np.isfinite(np.diag(spread))
    if not count or not active.any():
        return spread, rows
    size = np.linalg.norm(slopes[:, active], axis=0)
    scaled = slopes[:, active] / size
    back = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12, hermitian=True)
    total = np.zeros((size.size, size.size))
    for number in range(count):
        moved = [replace(track, pressure=track.pressure + track.doubts[number]) for track in tracks]
        change = residual - fit.residual(moved)  # of the prediction
        shift = back @ (scaled.T @ change) / size
        total += np.outer(shift, shift) / count
    spread[np.ix_(active, active)] += total
    # What the smoothing could not tell from noise may as well last for a whole curve, and then it moves its onset.
    spread[[0, 1], [0, 1]] += np.mean([np.var(doubt) for track in tracks for doubt in track.doubts])
    return spread, rows
