"""Play and stem in one loop where friction is elastic: after a reversal it turns over a distance, element by element.

Maxwell-slip elements in the force balance (Iwan, J. Appl. Mech. 33 (1966) 893; Al-Bender, Lampaert, Swevers, IEEE
Trans. Autom. Control 50 (2005) 1883): each is a spring between stem and packing that slips when it is stretched by its
own distance. As long as springs hold, the stem is stiff, and therefore also quick: a spread of plays, which has the
same curve at rest, does not know that. The small functions stand here once more on purpose: see `coupled.py`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.inputs import Bends, Plays, Tables
from twin.kernels.valve_slots import (
    V_DRAG_CLOSE_S,
    V_DRAG_OPEN_S,
    V_FADES_SQUARED,
    V_GIVE_HIGH,
    V_GIVE_LOW,
    V_PRESLIDING,
    V_RATE_CLOSE,
    V_RATE_OPEN,
    V_RELAX,
    V_RELAX_TAU_S,
    V_STRIBECK,
    V_STRIBECK_SPEED,
    V_TAU_CLOSE_S,
    V_TAU_OPEN_S,
    V_TRAVEL,
    V_WEAR,
)

#: Springs; the k-th slips when stretched by ((k + 1/2) / SPRINGS)^2 of the longest distance: many short, few long.
SPRINGS = 8
_SAME = 1e-9


@njit(cache=True, nogil=True, error_model="numpy")
def stretches(longest: float) -> FloatArray:
    """By how much each spring is stretched when it slips, shape (SPRINGS,) [position]."""
    slips: FloatArray = longest * ((np.arange(SPRINGS) + 0.5) / SPRINGS) ** 2
    return slips


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _curve_at(p: float, grid: tuple[float, float], table: FloatArray) -> float:
    """Linear interpolation at `p` in a table, extended by its end slopes; `grid`: first point, points per unit."""
    q = (p - grid[0]) * grid[1]
    i = min(max(int(q), 0), table.size - 2)
    value: float = table[i] + (q - i) * (table[i + 1] - table[i])
    return value


def elastic_start(
    force: float,
    wide: float,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    _plays: Plays,
    bends: Bends,
    start: tuple[float, float],
) -> tuple[FloatArray, FloatArray]:
    """State (see `elastic_steps`) and stretch of each spring at rest; `start`: (x, w), `stops`: see there.

    The springs hold the stem where it is pulled to `w`, as after a stroke one way and the way back that this needs.
    """
    x = max(stops[2], min(stops[3], start[0]))
    grid, wide = (tables[0], 1.0 / tables[1]), wide + c[V_STRIBECK]
    bottom, top = _curve_at(force - wide, grid, tables[2]), _curve_at(force + wide, grid, tables[3])
    if bends[0].size > 1:
        place = (0.0, (bends[0].size - 1) / c[V_TRAVEL])
        more, less, softer = (_curve_at(x, place, one) for one in bends)
        bottom = softer * _curve_at(force - wide - more, grid, tables[2])
        top = softer * _curve_at(force + wide - less, grid, tables[3])
    friction = max(-1.0, min(1.0, (bottom + top - 2.0 * start[1]) / max(top - bottom, 1e-12)))
    slips = stretches(float(c[V_PRESLIDING]))
    way, back = (1.0 if friction >= 0.0 else -1.0), np.linspace(0.0, slips[-1], 129)
    shares = np.mean(np.clip(1.0 - back[:, None] / slips, -1.0, 1.0), axis=1)
    held = way * np.clip(slips - np.interp(-abs(friction), -shares, back), -slips, slips)
    return np.array([x, 0.0, x, 0.0]), np.ascontiguousarray(held)


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _give(toward: float, held: FloatArray, slips: FloatArray) -> tuple[float, float]:
    """Friction per distance of the springs that still hold on the way `toward` (1, -1) [1/position], and how far the
    first of them does.
    """
    stiff, nearest = 0.0, np.inf
    for j in range(slips.size):
        room = slips[j] - toward * held[j]
        if room > _SAME * slips[j]:
            stiff += 1.0 / slips[j]
            nearest = min(nearest, room)
    return stiff / slips.size, nearest


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _stretched(moved: float, held: FloatArray, slips: FloatArray) -> float:
    """Moves the springs on by `moved`; the friction they make then, -1 to 1."""
    friction = 0.0
    for j in range(slips.size):
        held[j] = max(-slips[j], min(slips[j], held[j] + moved))
        friction += held[j] / slips[j]
    return friction / slips.size


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _faded(quick: float, squared: bool) -> float:
    """What is left of the friction that falls with the speed, of which `quick` is the share of its own."""
    left: float = np.exp(-quick * (quick if squared else 1.0))
    return left


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _ends(pull: float, stops: tuple[float, float, float, float], gives: tuple[float, float]) -> tuple[float, float]:
    """Within what a stem can be pulled: beyond a stop that it lands on softly, by a share of what else would."""
    softly = pull < stops[2] and gives[0] < 1.0, pull > stops[3] and gives[1] < 1.0
    low = max(stops[0], stops[2] + gives[0] * (pull - stops[2])) if softly[0] else stops[0]
    high = min(stops[1], stops[3] + gives[1] * (pull - stops[3])) if softly[1] else stops[1]
    return low, high


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _held_step(
    x: float,
    h: float,
    between: tuple[float, float],
    stops: tuple[float, float, float, float],
    gives: tuple[float, float],
    stays_s: tuple[float, float],
    lags_s: tuple[float, float],
    rates: tuple[float, float],
    held: FloatArray,
    slips: FloatArray,
    friction: float,
) -> tuple[float, float]:
    """The stem after `h`, and the friction then; on the way the springs slip one after the other.

    `between`: the curves, friction against closing and against opening; `stops`: of what it is pulled to, of itself;
    `stays_s`: lags where a stop limits the pull, `lags_s`: where none does.
    """
    left = h
    for _ in range(slips.size + 1):
        pull = 0.5 * ((1.0 + friction) * between[0] + (1.0 - friction) * between[1])
        low, high = _ends(pull, stops, gives)
        target = max(low, min(high, pull))
        toward = 1.0 if target > x else -1.0
        stiff, nearest = _give(toward, held, slips)
        room = max(0.0, stops[3] - x if toward > 0.0 else x - stops[2])
        hold = 1.0 + (0.5 * (between[1] - between[0]) * stiff if target == pull else 0.0)
        tau_s, rate = (stays_s if target != pull else lags_s)[0 if toward > 0.0 else 1], rates[0 if toward > 0.0 else 1]
        far = abs(target - x) / hold
        way = min(far * (1.0 - np.exp(-left * hold / max(tau_s, 1e-12))), rate * left, room)
        if way <= nearest:
            return x + toward * way, _stretched(toward * way, held, slips)
        x, friction = x + toward * nearest, _stretched(toward * nearest, held, slips)
        left -= max(-np.log(1.0 - nearest / far) * tau_s / hold, nearest / rate)
        if left <= 0.0:
            break
    return x, friction


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _decays(h: float, lags_s: tuple[float, float]) -> tuple[float, float]:
    """What is left of a distance after `h`, closing and opening."""
    return np.exp(-h / max(lags_s[0], 1e-12)), np.exp(-h / max(lags_s[1], 1e-12))


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _bend(
    x: float, p: float, wide: float, place: tuple[float, float], more: FloatArray, less: FloatArray, softer: FloatArray
) -> tuple[float, float, float]:
    """Pressure on the closing and on the opening curve, and relative compliance, where the stem is."""
    if more.size < 2:
        return p - wide, p + wide, 1.0
    return p - wide - _curve_at(x, place, more), p + wide - _curve_at(x, place, less), _curve_at(x, place, softer)


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _freely(
    x: float,
    h: float,
    between: tuple[float, float],
    stops: tuple[float, float, float, float],
    gives: tuple[float, float],
    stays: tuple[float, float],
    drags: tuple[float, float],
    rates: tuple[float, float],
    friction: float,
) -> tuple[float, bool]:
    """The stem after `h` where every spring slips already on its way, and whether they do.

    `stays`: decays over `h` toward a stop; `drags`: with the drag, for which a pull at a stop has air to spare.
    """
    closes = friction > 0.0
    pull = between[0] if closes else between[1]
    low, high = _ends(pull, stops, gives)
    target = max(low, min(high, pull))
    if abs(friction) < 1.0 - _SAME or (target < x if closes else target > x):
        return x, False
    if closes:
        way = min((pull - x) * (1.0 - drags[0]), (high - x) * (1.0 - stays[0]))
        return min(max(x, stops[3]), x + min(way, rates[0] * h)), True
    way = max((pull - x) * (1.0 - drags[1]), (low - x) * (1.0 - stays[1]))
    return max(min(x, stops[2]), x + max(way, -rates[1] * h)), True


@njit(cache=True, nogil=True, error_model="numpy")
def elastic_steps(
    time_s: FloatArray,
    offsets: np.ndarray,
    force: FloatArray,
    widening: FloatArray,
    c: FloatArray,
    stops: FloatArray,
    tables: Tables,
    _plays: Plays,
    bends: Bends,
    state: FloatArray,
    held: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the stem and moves `state` (stem, way travelled, relaxed spring, speed) and `held` on."""
    closing, opening, grid, varies = tables[2], tables[3], (tables[0], 1.0 / tables[1]), widening.size > 1
    place, ends = (0.0, (bends[0].size - 1) / c[V_TRAVEL]), (stops[0], stops[1], stops[2], stops[3])
    lags_s, rates = (c[V_TAU_CLOSE_S], c[V_TAU_OPEN_S]), (c[V_RATE_CLOSE], c[V_RATE_OPEN])
    drags_s, slips = (lags_s[0] + c[V_DRAG_CLOSE_S], lags_s[1] + c[V_DRAG_OPEN_S]), stretches(c[V_PRESLIDING])
    gives, squared = (c[V_GIVE_LOW], c[V_GIVE_HIGH]), c[V_FADES_SQUARED] != 0.0
    wear, stribeck, fading, (more_at, less_at, softer_at) = c[V_WEAR], c[V_STRIBECK], c[V_STRIBECK_SPEED], bends
    x, travelled, late, speed, friction = state[0], state[1], state[2], state[3], _stretched(0.0, held, slips)
    out[0], last_h, stays, drags, stay = x, -1.0, (0.0, 0.0), (0.0, 0.0), 1.0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        if abs(h - last_h) > _SAME * h:
            last_h, stays, drags, stay = h, _decays(h, lags_s), _decays(h, drags_s), np.exp(-h / c[V_RELAX_TAU_S])
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            p = 0.5 * (force[f - 1] + force[f]) - c[V_RELAX] * (x - late)
            slow = stribeck * _faded(speed / fading, squared) if stribeck > 0.0 else 0.0
            wide = widening[f if varies else 0] + wear * travelled + slow
            below, above, softer = _bend(x, p, wide, place, more_at, less_at, softer_at)
            between = (softer * _curve_at(below, grid, closing), softer * _curve_at(above, grid, opening))
            out[f], free = _freely(x, h, between, ends, gives, stays, drags, rates, friction)
            if not free:
                out[f], friction = _held_step(x, h, between, ends, gives, lags_s, drags_s, rates, held, slips, friction)
            travelled, speed = travelled + abs(out[f] - x), abs(out[f] - x) / h
            x, late = out[f], out[f] + (late - out[f]) * stay
    state[0], state[1], state[2], state[3] = x, travelled, late, speed
