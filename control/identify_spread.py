"""How far the fitted numbers may be off: for noise of the position, and for noise of the pressure that drove the play.

The second is no ordinary noise: a play keeps the peaks of what drives it. So the smoothed pressure is disturbed by
noise like its own, and the change of the prediction is carried through the fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from control.identify_interval import covariance
from control.identify_model import EP, TAU
from control.identify_response import LONGEST_S, SURE_95
from control.identify_track import Track
from control.identify_valve import Freedom, ValveFit, jacobian
from logs.recording import FloatArray


def lag_shift(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> FloatArray:
    """How far each fitted number (then the starts of the play) goes, shape (p,), if the converter's lag is longer by
    its doubt: half of a 95 % interval, of which the readings of the stem say nothing.
    """
    slopes, residual = jacobian(tracks, fit, freedom), fit.residual(tracks)
    size = np.linalg.norm(slopes, axis=0)
    shift = np.zeros(size.size)
    active = size > 1e-10 * max(float(size.max(initial=0.0)), 1e-300)
    if not active.any() or all(track.later is None for track in tracks):
        return shift
    scaled = slopes[:, active] / size[active]
    back = np.linalg.pinv(scaled.T @ scaled, rcond=1e-12, hermitian=True)
    change = residual - fit.residual([track.lag_moved(1.0) for track in tracks])  # of the prediction
    shift[active] = -(back @ (scaled.T @ change)) / size[active]
    return shift


def with_lag(spread: FloatArray, shift: FloatArray) -> FloatArray:
    """A covariance (p, p) and what `lag_shift` (p,) adds to it."""
    return spread + np.outer(shift, shift) / SURE_95**2


def with_lag_doubt(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom, ep_tau_s: float) -> list[Track]:
    """The tracks with a doubt of the lag, where no pressure was measured and the fit keeps `ep_tau_s`.

    It is what the stem says of that lag, beside all other numbers: how far it would go from there, and its interval;
    no more than to `LONGEST_S` where the stem does not lean to more. A lag longer than the stem's own would be named as
    that, so the two share what they add up to.
    """
    if freedom.ep or any(track.command is None for track in tracks):
        return list(tracks)
    told, kept = replace(freedom, ep=True), fit.numbers.copy()
    kept[EP] = ep_tau_s
    slopes, residual = jacobian(tracks, replace(fit, numbers=kept), told), fit.residual(tracks)
    at = told.names.index("ep.tau")
    size = np.linalg.norm(slopes, axis=0)
    doubt_s = 0.5 * (float(kept[TAU]) + ep_tau_s)
    spread, _ = covariance(slopes, residual)
    if np.isfinite(spread[at, at]):
        scaled = slopes / np.where(size > 0.0, size, 1.0)
        step = np.linalg.lstsq(scaled, residual, rcond=1e-9)[0][at] / size[at]
        lean_s, half_s = abs(float(step)), SURE_95 * float(np.sqrt(spread[at, at]))
        most_s = np.inf if lean_s > half_s else max(LONGEST_S - ep_tau_s, ep_tau_s)
        doubt_s = min(doubt_s, lean_s + half_s, most_s)
    return [replace(t, later=t.driven(ep_tau_s + doubt_s), lag_doubt_s=doubt_s) for t in tracks]


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
