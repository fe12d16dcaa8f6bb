"""The position sensor: stem on the fine grid in, reading at the sample instants out.

Order of the parts: what it picks up of the speed, a coupling that slips, linkage play, curvature, gain and zero with
drift, low-pass, mean, refresh (hold), resolution.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from logs.recording import FloatArray
from twin.kernels.active import acts
from twin.kernels.lag import elapsed_s, lagged
from twin.kernels.mean import running_mean
from twin.kernels.second_order import swinging
from twin.kernels.sensor_slots import (
    KNOTS,
    S_AT_OPEN,
    S_BOW,
    S_CORE,
    S_CYCLE_COS,
    S_CYCLE_S,
    S_CYCLE_SIN,
    S_DAMPING,
    S_DRIFT_AMP,
    S_DRIFT_RATE,
    S_DRIFT_TAU_S,
    S_FROM,
    S_GAIN,
    S_HOLD_PHASE_S,
    S_HOLD_S,
    S_JUMP,
    S_JUMP_S,
    S_KINK,
    S_KINK_AT,
    S_KNOTS,
    S_LAG2_S,
    S_LAG3_S,
    S_LAG_S,
    S_LEADS_S,
    S_LEAVES,
    S_MASS_DAMPING,
    S_MASS_NATURAL_S,
    S_NATURAL_S,
    S_OTHER,
    S_PLAY,
    S_ROOT,
    S_ROOT_SINCE_S,
    S_STEP,
    S_SWING,
    S_TABLE,
    S_THRICE_S,
    S_TRAVEL,
    S_WANDER_S,
    S_WAVE,
    S_WINDOW_S,
    S_WINDOWS,
    S_ZERO,
    TABLE,
)
from twin.kernels.sinking import core_of, first_core
from twin.kernels.slipping import slipped, slips

#: The pieces of a natural cubic spline are linear in its knots: (4, pieces, knots), for knots 1 apart.
_CARDINAL = CubicSpline(np.arange(KNOTS + 1.0), np.eye(KNOTS + 1), bc_type="natural").c
#: What makes a reading depend on more than where the stem is.
_FILTERS = np.array([S_LAG_S, S_LAG2_S, S_LAG3_S, S_THRICE_S, S_NATURAL_S, S_MASS_NATURAL_S, S_WINDOW_S])
_TABLE = np.arange(S_TABLE, S_TABLE + TABLE)
_TABLE_AT = np.linspace(0.0, 1.0, TABLE + 2)
#: What bends its static curve.
_CURVES = np.array([S_BOW, S_SWING, S_LEAVES, S_OTHER, S_KINK, S_WAVE, *_TABLE])


def sensor_kernel(
    time_s: FloatArray,
    stem: FloatArray,
    offsets: np.ndarray,
    c: FloatArray,
    out: FloatArray,
    taken_s: FloatArray | None = None,
) -> None:
    """Fills `out` (shape (n,)) with the reading; `taken_s`: when each was taken, where that is not at its row."""
    if c[S_LEADS_S] != 0.0:
        stem = leading(elapsed_s(time_s, offsets), stem, c[S_LEADS_S])
    if slips(c):
        stem = stem - slipped(elapsed_s(time_s, offsets), stem, c)
    core = stem
    if c[S_PLAY] > 0.0:
        core, _ = core_of(elapsed_s(time_s, offsets), stem, c, first_core(c, stem[0], c[S_CORE]))
    if filters(c):
        t = elapsed_s(time_s, offsets)
        late = static_reading(core, t, c)
        for lag_s in lags_s(c):
            late = lagged(time_s, offsets, late, lag_s)
        for natural_s, damping in swings(c):
            late = swinging(time_s, offsets, late, natural_s, damping)
        for _ in range(int(c[S_WINDOWS])):
            late = running_mean(t, late, c[S_WINDOW_S])
        out[:] = late[offsets] if taken_s is None else np.interp(taken_s, t, late)
    elif taken_s is None:
        out[:] = static_reading(core[offsets], time_s - time_s[0], c)
    else:
        out[:] = static_reading(np.interp(taken_s, elapsed_s(time_s, offsets), core), taken_s, c)
    if c[S_HOLD_S] > 0.0:
        _refresh(time_s, c, out)
    if c[S_STEP] > 0.0:
        out[:] = np.round(out / c[S_STEP]) * c[S_STEP]


def filters(c: FloatArray) -> bool:
    """Whether the reading depends on more than where the stem is."""
    return acts(c, _FILTERS)


def lags_s(c: FloatArray) -> list[float]:
    """The lags between stem and reading, one behind the other [s]; 0: none."""
    return [*c[[S_LAG_S, S_LAG2_S, S_LAG3_S]], *[c[S_THRICE_S]] * 3]


def swings(c: FloatArray) -> list[tuple[float, float]]:
    """Those of second order: 1 / natural frequency [s], 0 without, and damping ratio."""
    return [(c[S_NATURAL_S], c[S_DAMPING]), (c[S_MASS_NATURAL_S], c[S_MASS_DAMPING])]


def leading(t: FloatArray, stem: FloatArray, lead_s: float) -> FloatArray:
    """The stem, and `lead_s` times how fast it moved over the step before each point, 0 at the first."""
    return stem + lead_s * np.append(0.0, np.diff(stem) / np.diff(t))


def static_reading(x: FloatArray, t: FloatArray, c: FloatArray) -> FloatArray:
    """Static curve of the reading plus its drifting zero [position]; `t` in s since the first row."""
    y = x + curvature(x, c) if curved(c) else x
    if c[S_GAIN] != 1.0 or c[S_ZERO] != 0.0:
        y = c[S_GAIN] * y + c[S_ZERO]
    if c[S_DRIFT_RATE] != 0.0:
        y = y + c[S_DRIFT_RATE] * t
    if c[S_DRIFT_AMP] != 0.0:
        y = y - c[S_DRIFT_AMP] * np.expm1(-t / c[S_DRIFT_TAU_S])
    if c[S_ROOT] != 0.0:
        y = y + c[S_ROOT] * (np.sqrt(c[S_ROOT_SINCE_S] + t) - np.sqrt(c[S_ROOT_SINCE_S]))
    if c[S_JUMP] != 0.0:
        y = y + np.where(t >= c[S_JUMP_S], c[S_JUMP], 0.0)
    if c[S_CYCLE_S] > 0.0:
        phase = 2.0 * np.pi / c[S_CYCLE_S] * t
        y = y + c[S_CYCLE_COS] * (1.0 - np.cos(phase)) + c[S_CYCLE_SIN] * np.sin(phase)
    if c[S_WANDER_S] > 0.0:
        y = y + _wandering(t, c)
    return y


def curved(c: FloatArray) -> bool:
    """Whether the reading is anything but proportional to the position."""
    return acts(c, _CURVES)


def curvature(x: FloatArray, c: FloatArray) -> FloatArray:
    """Excess of the reading over the position `x` [position], before gain and zero."""
    xi = x / c[S_TRAVEL]
    bend = xi * (1.0 - xi) * (4.0 * c[S_BOW] + 10.4 * c[S_SWING] * (1.0 - 2.0 * xi))
    if c[S_LEAVES] != 0.0:
        way, reach = (c[S_FROM] - xi, c[S_FROM]) if c[S_AT_OPEN] != 0.0 else (xi - c[S_FROM], 1.0 - c[S_FROM])
        bend = bend + c[S_LEAVES] * np.square(np.maximum(way, 0.0) / reach)
    if c[S_OTHER] != 0.0:
        bend = bend + c[S_OTHER] * np.square(np.maximum(1.0 - c[S_FROM] - xi, 0.0) / (1.0 - c[S_FROM]))
    if c[S_KINK] != 0.0:
        bend = bend + c[S_KINK] * np.minimum(xi / c[S_KINK_AT], (1.0 - xi) / (1.0 - c[S_KINK_AT]))
    if c[S_WAVE] != 0.0:
        bend = bend + c[S_WAVE] * np.sin(2.0 * np.pi * xi)
    if acts(c, _TABLE):
        bend = bend + np.interp(xi, _TABLE_AT, np.concatenate([[0.0], c[_TABLE], [0.0]]))
    return np.asarray(c[S_TRAVEL] * bend)


def _wandering(t: FloatArray, c: FloatArray) -> FloatArray:
    """The zero that goes smoothly through its knots, from 0 at the start; after the last knot it stays."""
    pieces = _CARDINAL @ np.concatenate([[0.0], c[S_KNOTS : S_KNOTS + KNOTS]])
    zero = np.empty_like(t)
    _piecewise(t, c[S_WANDER_S], pieces, zero)
    return zero


@njit(cache=True, nogil=True, error_model="numpy")
def _piecewise(t: FloatArray, piece_s: float, pieces: FloatArray, out: FloatArray) -> None:
    """Fills `out` with cubic `pieces` (4, n), each `piece_s` long and in units of that; after the last it stays."""
    for i in range(t.size):
        u = min(t[i] / piece_s, float(pieces.shape[1]))
        k = min(int(u), pieces.shape[1] - 1)
        d = u - k
        out[i] = ((pieces[0, k] * d + pieces[1, k]) * d + pieces[2, k]) * d + pieces[3, k]


@njit(cache=True, nogil=True, error_model="numpy")
def report_on_change(readings: FloatArray, band: float) -> None:
    """Holds the readings (n,), in place, until one is more than `band` away from the one held."""
    for i in range(1, readings.size):
        if abs(readings[i] - readings[i - 1]) <= band:
            readings[i] = readings[i - 1]


@njit(cache=True, nogil=True, error_model="numpy")
def _refresh(time_s: FloatArray, c: FloatArray, out: FloatArray) -> None:
    """Holds the reading between refreshes at phase + n * period; the value is that of the refresh instant."""
    period = c[S_HOLD_S]
    source = out.copy()
    k = 0
    for i in range(time_s.size):
        t = time_s[i] - time_s[0]
        at = np.floor((t - c[S_HOLD_PHASE_S]) / period) * period + c[S_HOLD_PHASE_S]
        while k + 1 < time_s.size and time_s[k + 1] - time_s[0] <= at:
            k += 1
        if at <= 0.0 or k + 1 >= time_s.size:
            out[i] = source[k]
            continue
        share = (at - (time_s[k] - time_s[0])) / (time_s[k + 1] - time_s[k])
        out[i] = source[k] + share * (source[k + 1] - source[k])
