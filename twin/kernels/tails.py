"""Slow tails of what moves the stem: a part of the motion that comes late, or what gives way behind the stem."""

from __future__ import annotations

import numpy as np

from logs.recording import FloatArray
from twin.kernels.inputs import Plays, Tables
from twin.kernels.lag import elapsed_s, lagged
from twin.kernels.play import common_start, play_target
from twin.kernels.valve_slots import (
    V_CREEP1,
    V_CREEP1_TAU_S,
    V_CREEP2,
    V_CREEP2_TAU_S,
    V_HIGH,
    V_LOW,
    V_REMEMBERS,
    V_STRETCHED,
    V_STRETCHES,
    V_TARGET_CREEPS,
    stem_stops,
)

#: `V_TARGET_CREEPS` of a target that may be pressed on beyond the stops, before its tail.
PRESSED = 2.0
_CREEPS = ((V_CREEP1, V_CREEP1_TAU_S), (V_CREEP2, V_CREEP2_TAU_S))


def creep_tails(time_s: FloatArray, offsets: np.ndarray, c: FloatArray, held: float, out: FloatArray) -> None:
    """Replaces part of the motion by its slow tails: of the stem, or of its target where these are apart.

    `held`: what the tails still have of what was before, at the first row [position].
    """
    shares = [(c[share], c[tau]) for share, tau in _CREEPS if c[share] != 0.0]
    if not shares:
        return
    out += sum(share * (lagged(time_s, offsets, out, tau_s) - out) for share, tau_s in shares)
    if held != 0.0:
        t, whole = elapsed_s(time_s, offsets), sum(share for share, _ in shares)
        out += held * sum(share / whole * np.exp(-t / max(tau_s, 1e-9)) for share, tau_s in shares)


def stops_of_pull(c: FloatArray) -> tuple[float, float]:
    """Between what the target is held before its tails: further up where excess pressure is to press it on, by as much
    as comes late, so that the stem is at its stop at once."""
    low, high = float(c[V_LOW]), float(c[V_HIGH])
    return (low, low + (high - low) / (1.0 - _late(c))) if c[V_TARGET_CREEPS] == PRESSED else (low, high)


def _late(c: FloatArray) -> float:
    return float(sum(c[share] for share, _ in _CREEPS))


def within_stops(c: FloatArray, target: FloatArray) -> None:
    """Ends a target that creeps at the stops of the stem, if what creeps may be pressed on beyond them."""
    if c[V_TARGET_CREEPS] == PRESSED:
        np.clip(target, *stem_stops(c), out=target)


def unstretched(c: FloatArray, start: tuple[float, float]) -> tuple[float, float]:
    """The start (stem, play output) without what has given way behind it by then."""
    if c[V_STRETCHES] == 0.0:
        return start
    longer = 1.0 + c[V_STRETCHED] * float(sum(c[share] for share, _ in _CREEPS))
    return start[0] / longer, start[1] / longer


def stretch_tails(time_s: FloatArray, offsets: np.ndarray, c: FloatArray, out: FloatArray) -> None:
    """Adds to the motion what gives way behind it, as far as the stops let the stem go."""
    t, missing = elapsed_s(time_s, offsets), (c[V_STRETCHED] - 1.0) * out[0]
    tails = [(c[share], c[tau]) for share, tau in _CREEPS if c[share] != 0.0]
    more = [share * (lagged(time_s, offsets, out, tau_s) + missing * np.exp(-t / tau_s)) for share, tau_s in tails]
    np.clip(np.add(out, sum(more)), *stem_stops(c), out=out)


def held_by_tails(
    force: FloatArray, widening: FloatArray, c: FloatArray, tables: Tables, plays: Plays, start: tuple[float, float]
) -> float:
    """How far from where the pressure has it slow tails hold a stem that is at rest, at the first row [position].

    They still have what was before the recording, where the readings show it; no more than all of the travel in each.
    """
    whole = _late(c)
    if whole <= 0.0 or c[V_REMEMBERS] == 0.0 or c[V_STRETCHES] != 0.0:
        return 0.0
    stops = stops_of_pull(c)
    at = common_start(float(force[0]), float(widening[0]), stops, tables, *plays, start[1])
    target = float(play_target(force[:1], widening[:1], stops, tables, *plays, at)[0])
    least, most = whole * (stops[0] - target), whole * (stops[1] - target)
    return float(min(max(start[0] - target, least), most))
