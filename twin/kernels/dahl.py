"""Dahl's friction before the lag of the stem, compiled: pressure in, target of the stem out.

Friction F, in units of the half deadband, turns over a distance: dF/dw = (1 - F sgn(dw)) / distance. The pressure at
the springs is what is left of it, so that every change moves the target a little and no play holds it. Without a
distance it is the play. Source: Dahl, The Aerospace Corporation, TOR-0158(3107-18)-1 (1968).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Tables

#: Rounds in which the move of a step is found, and the share of the distance to which it has to be known.
_ROUNDS, _NEAR = 30, 1e-7


@njit(cache=True, nogil=True, error_model="numpy")
def _on_curve(p: float, p_first: float, p_step: float, table: FloatArray) -> tuple[float, float]:
    """Value and slope of a curve given over a uniform grid of pressures, extended by its end slopes."""
    q = (p - p_first) / p_step
    i = min(max(int(q), 0), table.size - 2)
    slope = table[i + 1] - table[i]
    return table[i] + (q - i) * slope, slope / p_step


@njit(cache=True, nogil=True, error_model="numpy")
def _turned(
    p: float, half: float, distance: float, w: float, free: float, sign: float, curve: tuple[float, float, FloatArray]
) -> float:
    """Where the target goes from `w`: up the closing curve (`sign` 1) or down the opening one (-1), at pressure `p`.

    `free`: how far friction is from its bound in that direction, 0 to 2. Newton's steps come from one side: the further
    it goes, the less friction gives way.
    """
    at = w
    for _ in range(_ROUNDS):
        left = half * free * np.exp(-abs(at - w) / distance)
        goal, slope = _on_curve(p + sign * left, curve[0], curve[1], curve[2])
        step = (goal - at) / (1.0 + slope * left / distance)
        at += step
        if abs(step) < _NEAR * distance:
            break
    return at


@njit(cache=True, nogil=True, error_model="numpy")
def _friction_at_start(
    p: float, half: float, w: float, p_first: float, p_step: float, closing: FloatArray, opening: FloatArray
) -> float:
    """Friction with which the target rests at `w`; its bound where the pressure takes the target along."""
    if _on_curve(p, p_first, p_step, closing)[0] >= w:
        return 1.0
    if _on_curve(p, p_first, p_step, opening)[0] <= w:
        return -1.0
    low, high = -1.0, 1.0
    for _ in range(50):
        friction = 0.5 * (low + high)
        if _on_curve(p + half * (1.0 - friction), p_first, p_step, closing)[0] > w:
            low = friction
        else:
            high = friction
    return 0.5 * (low + high)


@njit(cache=True, nogil=True, error_model="numpy")
def _pass(
    force: FloatArray,
    widening: FloatArray,
    stops: tuple[float, float],
    p_first: float,
    p_step: float,
    closing: FloatArray,
    opening: FloatArray,
    half: float,
    distance: float,
    state: FloatArray,
    out: FloatArray,
) -> None:
    low, high = stops
    up, down = (p_first, p_step, closing), (p_first, p_step, opening)
    wide = widening[0]
    w = max(low, min(high, state[0]))
    friction = state[1]
    if np.isnan(friction):
        friction = _friction_at_start(force[0] - wide, half + wide, w, p_first, p_step, closing, opening)
    for f in range(force.size):
        if widening.size > 1:
            wide = widening[f]
        h, before = half + wide, w
        close, open_ = force[f] - wide, force[f] + wide
        if _on_curve(close + h * (1.0 - friction), p_first, p_step, closing)[0] > w:
            w = max(low, min(high, _turned(close, h, distance, w, 1.0 - friction, 1.0, up)))
            friction = 1.0 - (1.0 - friction) * np.exp(-max(w - before, 0.0) / distance)
        elif _on_curve(open_ - h * (1.0 + friction), p_first, p_step, opening)[0] < w:
            w = max(low, min(high, _turned(open_, h, distance, w, 1.0 + friction, -1.0, down)))
            friction = -1.0 + (1.0 + friction) * np.exp(-max(before - w, 0.0) / distance)
        out[f] = w
    state[0], state[1] = w, friction


def dahl_target(
    force: FloatArray,
    widening: FloatArray,
    stops: tuple[float, float],
    tables: Tables,
    half: float,
    distance: float,
    state: FloatArray,
) -> FloatArray:
    """The target, shape of `force`; moves `state` on: the target and the friction (not a number: as it can rest).

    `half`: half deadband of the curves [pressure]; `distance` over which friction turns [position]; `widening` as for
    the plays.
    """
    out = np.empty(force.size)
    p_first, p_step, closing, opening = tables
    _pass(force, widening, stops, p_first, p_step, closing, opening, half, distance, state, out)
    return out
