"""A converter whose pilot is followed by a booster of limited flow, into a chamber that grows as the stem closes.

Filling is choked and goes at one rate whatever the pressure, until it comes near that of a weak supply; exhausting to
the atmosphere slows down as the pressure falls; a stem that closes makes the chamber larger and takes air, which counts
most where little air can flow. Close to the pilot's pressure the booster opens in proportion.
Source: Richer, Hurmuzlu, J. Dyn. Syst. Meas. Control 122 (2000) 416 (chamber and orifices); ISO 6358-1 (flow).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.ep_slots import (
    EP_AIR,
    EP_AMBIENT,
    EP_ATMOSPHERE,
    EP_BAND,
    EP_BAND_MODE,
    EP_DRAW,
    EP_FULL_DOWN,
    EP_FULL_UP,
    EP_MIDDLE,
    EP_NOMINAL,
    EP_OPEN,
    EP_REFERENCE,
    EP_REFILL_S,
    EP_TANK,
    EP_TAU_FALL_S,
    EP_TAU_RISE_S,
)
from twin.kernels.slots import FOREVER

#: Pressure ratio below which the flow is choked: of a sharp-edged orifice, and near that of valves.
_CHOKED = 0.5
#: Of an interval of a few psi, down to far less than a reading tells.
_HALVINGS = 26

Pair = tuple[float, float]


@njit(cache=True, nogil=True, error_model="numpy")
def outflow(p: float, atmosphere: float) -> float:
    """Flow out through an opening at gauge pressure `p`, up to a factor (ISO 6358-1)."""
    if p <= 0.0:
        return 0.0
    ratio = atmosphere / (p + atmosphere)
    if ratio <= _CHOKED:
        return p + atmosphere
    above = (ratio - _CHOKED) / (1.0 - _CHOKED)
    flow: float = (p + atmosphere) * np.sqrt(max(0.0, 1.0 - above * above))
    return flow


@njit(cache=True, nogil=True, error_model="numpy")
def inflow(p: float, supply: float) -> float:
    """Flow from a supply over what it is while choked; both pressures absolute (ISO 6358-1)."""
    above = max(0.0, (p / supply - _CHOKED) / (1.0 - _CHOKED))
    flow: float = np.sqrt(max(0.0, 1.0 - above * above))
    return flow


@njit(cache=True, nogil=True, error_model="numpy")
def weak_supply(p: float, h: float, chamber: Pair, gives: float, c: FloatArray) -> Pair:
    """Flow through a full opening from a supply that `gives` little, and the pressure that it fills to in `h` from `p`.

    `chamber`: rate at which the stem takes pressure, and volume. The pressure is implicit, since the flow drops steeply
    as it comes near the supply's.
    """
    absolute = c[EP_ATMOSPHERE] - c[EP_AMBIENT]
    supply, p = gives + absolute, p + absolute
    flow = c[EP_FULL_UP] * min(1.0, supply / (c[EP_NOMINAL] + absolute))
    before = p - h * chamber[0] / chamber[1]
    low, high = min(before, supply), min(before + h * flow / chamber[1], supply)
    if high > _CHOKED * supply:
        for _ in range(_HALVINGS):
            q = 0.5 * (low + high)
            if q > before + h * flow / chamber[1] * inflow(q, supply):
                high = q
            else:
                low = q
    return flow * max(inflow(p, supply), inflow(high, supply)), high - absolute


@njit(cache=True, nogil=True, error_model="numpy")
def _chamber_step(p: float, v: Pair, h: float, chamber: Pair, full: Pair, opening: Pair) -> float:
    """Pressure after `h` seconds in which the pilot goes from `v[0]` to `v[1]`.

    `chamber`: rate at which the stem takes pressure, and volume, 1 with the stem half way; `full`: rates through an
    opening that is full, up and down; `opening`: errors at which it is, and up to which it is shut.
    """
    taken, room = chamber
    wide, idle = opening
    slope, left = (v[1] - v[0]) / h, h
    demand = slope * room + taken
    for _ in range(5):
        off = v[1] - slope * left - p
        error = off - max(-idle, min(idle, off))
        if error == 0.0 and idle > 0.0:
            break
        sign = 1.0 if error > 0.0 or (error == 0.0 and demand > 0.0) else -1.0
        flow = max(full[0] if sign > 0.0 else full[1], 1e-9)
        if abs(error) < wide:
            # in proportion to the error, which goes to `behind`: exact for a pilot that goes on evenly
            tau_s, behind = wide * room / flow, wide * demand / flow
            after = behind + (error - behind) * np.exp(-left / tau_s)
            edge = 0.0 if after * sign < 0.0 else sign * wide
            if abs(after) < wide and edge != 0.0:
                reached: float = v[1] - sign * idle - after
                return reached
            left = max(0.0, left - tau_s * np.log((error - behind) / (edge - behind)))
            p = v[1] - slope * left - (sign * idle + 1.001 * edge)
            continue
        rate = (sign * flow - taken) / room
        closing = (rate - slope) * sign
        until = (abs(error) - 0.999 * wide) / closing if closing > 0.0 else left
        if until >= left:
            return p + rate * left
        p, left = p + rate * until, left - until
    return p - taken / room * left if idle > 0.0 else p


@njit(cache=True, nogil=True, error_model="numpy")
def _chamber(gauge: float, x: float, speed: float, c: FloatArray) -> Pair:
    """Rate at which the stem takes pressure, and volume, 1 with the stem half way.

    More air through wider openings is all but the same, with the stem there: the openings are known best so.
    """
    half_way = 1.0 + c[EP_AIR] * c[EP_MIDDLE]
    air = c[EP_AIR] / half_way
    return air * (gauge + c[EP_ATMOSPHERE]) * speed, 1.0 / half_way + air * max(x, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def booster_pass(
    time_s: FloatArray,
    offsets: np.ndarray,
    goal: FloatArray,
    stem: FloatArray,
    c: FloatArray,
    highest: FloatArray,
    state: FloatArray,
    out: FloatArray,
) -> None:
    """Fills `out` (fine) with the pressure; `goal` per row or fine, `stem` fine or of size 1, where it stands still.

    `highest`: what the supply gives, fine or of size 1; `state` (3,): pressure, pilot's pressure, how far the supply
    has sunk; kept.
    """
    per_row, still, even = goal.size == time_s.size, stem.size == 1, highest.size == 1
    p, v, sunk = state[0], state[1], state[2]
    before = out[0] = p
    base = outflow(c[EP_REFERENCE] - c[EP_AMBIENT], c[EP_ATMOSPHERE])
    idle = c[EP_BAND] if c[EP_BAND_MODE] >= 3.0 else 0.0
    for i in range(1, time_s.size):
        h = max((time_s[i] - time_s[i - 1]) / (offsets[i] - offsets[i - 1]), 1e-9)
        for f in range(offsets[i - 1] + 1, offsets[i] + 1):
            u = min(goal[i] if per_row else goal[f], c[EP_TANK] - sunk)
            tau_s = c[EP_TAU_RISE_S] if u > v else c[EP_TAU_FALL_S]
            new_v = u + (v - u) * np.exp(-h / max(tau_s, 1e-12))
            x, speed = (stem[0], 0.0) if still else (0.5 * (stem[f] + stem[f - 1]), (stem[f] - stem[f - 1]) / h)
            # what goes by the pressure goes by that in the middle of the step
            gauge = p + 0.5 * (p - before) - c[EP_AMBIENT]
            chamber = _chamber(gauge, x, speed, c)
            gives = highest[0 if even else f]
            up, most = weak_supply(p, h, chamber, gives, c) if gives < FOREVER else (c[EP_FULL_UP], FOREVER)
            full = (up, c[EP_FULL_DOWN] * outflow(gauge, c[EP_ATMOSPHERE]) / base)
            new = min(most, _chamber_step(p, (v, new_v), h, chamber, full, (c[EP_OPEN], idle)))
            if c[EP_TANK] < FOREVER:
                sunk = sunk * np.exp(-h / c[EP_REFILL_S]) + c[EP_DRAW] * max(new - p, 0.0)
            before, p, v = p, new, new_v
            out[f] = p
    state[0], state[1], state[2] = p, v, sunk
