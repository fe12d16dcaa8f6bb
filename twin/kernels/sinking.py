"""A loose linkage between the stem and the core: the core goes along from the ends of the play, or sinks to one.

It may be worn where the stem is most, and tighter elsewhere; or soft, so that a part of its pull is there sooner.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from logs.recording import FloatArray
from twin.kernels.active import acts
from twin.kernels.play import plain_play
from twin.kernels.sensor_slots import LESS, S_LESS, S_PLAY, S_SHARE, S_SINKS_S, S_SOONER, S_TRAVEL

#: Where the core stands: pulled by all of the linkage, and by what of a soft one pulls sooner [position].
CoreState = tuple[float, float]

_LESS = np.arange(S_LESS, S_LESS + LESS)


def core_of(t: FloatArray, stem: FloatArray, c: FloatArray, start: CoreState) -> tuple[FloatArray, CoreState]:
    """Where the core is, at times `t` [s] like `stem`, from `start`, and what it stands at then.

    Without play it is where the stem is. A soft linkage pulls with a part of itself from a narrower play on.
    """
    if c[S_PLAY] <= 0.0:
        return stem, start
    core = _pulled(t, stem, c, start[0])
    if c[S_SOONER] <= 0.0:
        return core, (float(core[-1]), start[1])
    sooner = np.empty_like(stem)
    plain_play(stem, 0.5 * c[S_SOONER] * c[S_PLAY], start[1], sooner)
    share = share_sooner(c)
    return (1.0 - share) * core + share * sooner, (float(core[-1]), float(sooner[-1]))


def share_sooner(c: FloatArray) -> float:
    """What of a soft linkage's pull is there from its narrower play on [-]."""
    return 0.5 + float(c[S_SHARE])


def core_at_first(c: FloatArray, state: CoreState) -> float:
    """Where a core stands that is pulled so [position]."""
    share = share_sooner(c)
    return (1.0 - share) * state[0] + share * state[1]


def _pulled(t: FloatArray, stem: FloatArray, c: FloatArray, start: float) -> FloatArray:
    core = np.empty_like(stem)
    if acts(c, _LESS):
        _worn(stem, 0.5 * c[S_PLAY], 0.5 * c[_LESS], c[S_TRAVEL], start, core)
    elif c[S_SINKS_S] == 0.0:
        plain_play(stem, 0.5 * c[S_PLAY], start, core)
    else:
        _sinking(t, stem, 0.5 * c[S_PLAY], c[S_SINKS_S], start, core)
    return core


def soft_reach(c: FloatArray) -> float:
    """How far from the stem a soft linkage may leave the core [position]; 0 for any other."""
    share = share_sooner(c)
    return 0.5 * float(c[S_PLAY] * (1.0 - share + share * c[S_SOONER])) if c[S_SOONER] > 0.0 else 0.0


def first_core(c: FloatArray, stem: float, core: float) -> CoreState:
    """Where a core begins that is said to be at `core`; not a number: wherever it had the time to go."""
    half = _half_at(stem, 0.5 * float(c[S_PLAY]), 0.5 * c[_LESS], float(c[S_TRAVEL]))
    at = stem + sunk_by(c) if np.isnan(core) else max(stem - half, min(stem + half, core))
    if c[S_SOONER] <= 0.0:
        return at, at
    reach = half * float(c[S_SOONER])
    sooner = max(stem - reach, min(stem + reach, at))
    share = share_sooner(c)
    wide = (at - share * sooner) / (1.0 - share)
    return max(stem - half, min(stem + half, wide)), sooner


def sunk_by(c: FloatArray) -> float:
    """How far from the stem a core stands that has had the time to sink to one end of the play [position]."""
    return float(np.copysign(0.5 * c[S_PLAY], c[S_SINKS_S])) if c[S_PLAY] > 0.0 and c[S_SINKS_S] != 0.0 else 0.0


@njit(cache=True, inline="always", nogil=True, error_model="numpy")
def _half_at(x: float, half: float, less: FloatArray, travel: float) -> float:
    """Half the play with the stem at `x`; `less`: by how much narrower at places from end to end, straight between."""
    q = min(max(x / travel, 0.0), 1.0) * (less.size - 1)
    i = min(int(q), less.size - 2)
    here: float = half - less[i] - (q - i) * (less[i + 1] - less[i])
    return here


@njit(cache=True, nogil=True, error_model="numpy")
def _worn(stem: FloatArray, half: float, less: FloatArray, travel: float, start: float, out: FloatArray) -> None:
    """Fills `out`: a core that the stem takes along from the ends of a play that goes by where the stem is."""
    e = start
    for f in range(stem.size):
        here = _half_at(stem[f], half, less, travel)
        e = out[f] = max(stem[f] - here, min(stem[f] + here, e))


@njit(cache=True, nogil=True, error_model="numpy")
def _sinking(t: FloatArray, stem: FloatArray, half: float, sinks_s: float, start: float, out: FloatArray) -> None:
    """Fills `out`: within `half` of the stem, and on the way to `half` beyond it in the sense of `sinks_s` [s]."""
    end = half if sinks_s > 0.0 else -half
    e = max(stem[0] - half, min(stem[0] + half, start))
    out[0] = e
    for f in range(1, t.size):
        e = max(stem[f] - half, min(stem[f] + half, e))
        e += (stem[f] + end - e) * -np.expm1((t[f - 1] - t[f]) / abs(sinks_s))
        out[f] = e
