"""The converter's lag with an overlap band, a quick exhaust or a clog, limited slopes, a sinking supply: compiled."""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.booster import inflow
from twin.kernels.ep_slots import (
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_BAND,
    EP_BAND_MODE,
    EP_CLIP,
    EP_CLOG_DOWN,
    EP_CLOG_UP,
    EP_CRACK,
    EP_DRAW,
    EP_LEAK,
    EP_QUICK,
    EP_RATE_DOWN,
    EP_RATE_UP,
    EP_REFILL_S,
    EP_SHUT,
    EP_STARVED,
    EP_SUBSONIC,
    EP_TANK,
    EP_TANK_CUTS,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
    EP_WANES,
    EP_WANES_BELOW,
)
from twin.kernels.slots import FOREVER


@njit(cache=True, nogil=True, error_model="numpy")
def _edged_step(error: float, edge: float, within: float, beyond: float, h: float) -> float:
    """What is left of an error after `h` seconds; it shrinks at `within` of it and `beyond` of what is above an edge.

    Exact; rates in 1/s.
    """
    if error > edge:
        rate = within + beyond
        rest = edge * beyond / rate
        inside_s = h - np.log((error - rest) / (edge - rest)) / rate
        if inside_s <= 0.0:
            outside: float = rest + (error - rest) * np.exp(-rate * h)
            return outside
        error, h = edge, inside_s
    inside: float = error * np.exp(-within * h)
    return inside


@njit(cache=True, nogil=True, error_model="numpy")
def _given(p: float, c: FloatArray) -> float:
    """Share of the lag's flow that a weak supply gives at a pressure: by ISO 6358, or falling evenly to none over the
    last EP_STARVED below the supply."""
    if c[EP_STARVED] > 0.0:
        even: float = min(1.0, max(0.0, (c[EP_CLIP] - p) / c[EP_STARVED]))
        return even
    absolute = c[EP_ATMOSPHERE] - c[EP_AMBIENT]
    choked: float = min(1.0, c[EP_SUBSONIC] * inflow(p + absolute, c[EP_CLIP] + absolute))
    return choked


@njit(cache=True, nogil=True, error_model="numpy")
def _let_through(p: float, v: float, steps: float, c: FloatArray) -> float:
    """Share of the lag's flow that a weak supply gives, on the mean over a step; it is `steps` lags long without it."""
    clip, first = c[EP_CLIP], _given(p, c)
    share: float = first
    for _ in range(3):
        middle = min(clip, v - (v - p) * np.exp(-0.5 * steps * share))
        end = min(clip, v - (v - p) * np.exp(-steps * share))
        share = (first + 4.0 * _given(middle, c) + _given(end, c)) / 6.0
    return share


@njit(cache=True, nogil=True, error_model="numpy")
def _clogged_step(error: float, tau_s: float, clog: float, h: float) -> float:
    """What is left of an error that drives a flow q against tau q + clog q^2: a lag that grows with the flow, as it is
    in the middle of the step."""
    lag_s = 0.5 * (tau_s + np.sqrt(tau_s * tau_s + 4.0 * clog * error))
    middle = error * np.exp(-0.5 * h / lag_s)
    lag_s = 0.5 * (tau_s + np.sqrt(tau_s * tau_s + 4.0 * clog * middle))
    left: float = error * np.exp(-h / lag_s)
    return left


@njit(cache=True, nogil=True, error_model="numpy")
def _waned(p: float, v: float, h: float, rate: float, c: FloatArray) -> float:
    """The rate of an exhaust that has less pressure to drive it the further the pressure has fallen, as it is in the
    middle of the step."""
    now = rate / (1.0 + c[EP_WANES] * max(c[EP_WANES_BELOW] - p, 0.0))
    middle = v + (p - v) * np.exp(-0.5 * h * now)
    waned: float = rate / (1.0 + c[EP_WANES] * max(c[EP_WANES_BELOW] - middle, 0.0))
    return waned


@njit(cache=True, nogil=True, error_model="numpy")
def _bounded_step(p: float, v: float, h: float, c: FloatArray) -> float:
    """Pressure after `h` seconds of a lag toward `v`: with a band, a quick exhaust or a clog, and with slope limits."""
    mode, error, clog = c[EP_BAND_MODE], abs(v - p), c[EP_CLOG_UP if v > p else EP_CLOG_DOWN]
    if mode == 4.0 and error <= c[EP_BAND]:
        return p
    rate = 1.0 / max(c[EP_TAU_RISE_S] if v > p else c[EP_TAU_FALL_S], 1e-12)
    if v > p and c[EP_SUBSONIC] + c[EP_STARVED] > 0.0:
        rate *= _let_through(p, v, h * rate, c)
    elif v < p and c[EP_WANES] > 0.0:
        rate = _waned(p, v, h, rate, c)
    if mode == 3.0:
        error = _edged_step(error, c[EP_BAND], c[EP_LEAK] * rate, rate, h)
    elif v < p and c[EP_QUICK] > 0.0:
        error = _edged_step(error, c[EP_CRACK], rate, c[EP_QUICK] * rate, h)
    elif clog > 0.0:
        error = _clogged_step(error, 1.0 / rate, clog, h)
    else:
        error *= np.exp(-rate * h)
    if mode == 4.0:
        error = max(error, c[EP_BAND])
    new = v - error if v > p else v + error
    bounded: float = min(c[EP_CLIP], max(p - c[EP_RATE_DOWN] * h, min(p + c[EP_RATE_UP] * h, new)))
    return bounded


@njit(cache=True, nogil=True, error_model="numpy")
def _gated_step(p: float, v: float, h: float, c: FloatArray, state: FloatArray) -> float:
    """Pressure after `h` seconds of a pilot that opens in full at an error of the band, and shuts at a part of it."""
    shut = c[EP_SHUT] * c[EP_BAND]
    if abs(v - p) <= (shut if state[1] > 0.0 else c[EP_BAND]):
        state[1] = 0.0
        return p
    new = _bounded_step(p, v, h, c)
    state[1] = 1.0 if abs(v - new) > shut else 0.0
    return new if state[1] > 0.0 else (v - shut if v > p else v + shut)


@njit(cache=True, nogil=True, error_model="numpy")
def follow_bounded(
    time_s: FloatArray,
    offsets: np.ndarray,
    goal: FloatArray,
    c: FloatArray,
    highest: FloatArray,
    p0: float,
    state: FloatArray,
    out: FloatArray,
) -> None:
    """A lag toward the goal with an overlap band and limited slope, below the `highest` there is, of size 1 or fine.

    Kept: `state` (2,), how far the supply has sunk and whether a pilot that shuts later than it opens is open.
    """
    even = highest.size == 1
    per_row, cuts = goal.size == time_s.size, c[EP_TANK_CUTS] > 0.0
    p = p0
    out[0] = p
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            v, tank = goal[i] if per_row else goal[f], c[EP_TANK] - state[0]
            v = v if cuts else min(v, tank)
            new = _gated_step(p, v, h, c, state) if c[EP_BAND_MODE] == 5.0 else _bounded_step(p, v, h, c)
            new = min(new, tank if cuts else FOREVER, highest[0 if even else f])
            if c[EP_TANK] < FOREVER:
                state[0] = state[0] * np.exp(-h / c[EP_REFILL_S]) + c[EP_DRAW] * max(new - p, 0.0)
            p = new
            out[f] = p
