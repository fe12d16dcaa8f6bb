"""When the pressure begins to answer a step of the command, and the clock at which it does, if there is one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from logs.recording import FloatArray, Recording

#: A step is used if it is so many times what a pressure reading differs from the one before by chance.
_CLEAR = 15.0
#: Shares of a step whose instants tell when a lag began, and by how many of their distances that is before the first.
_EARLY, _LATE = 0.2, 0.5
_BEFORE = float(np.log(1.0 / (1.0 - _EARLY)) / np.log((1.0 - _EARLY) / (1.0 - _LATE)))
#: Answers without which nothing is said of a clock; what most of the delays differ by, of which some are false; and the
#: cycles, over that, that are looked at: of delays that are spread evenly over a cycle it is 0.8 of it.
_FEWEST = 8
_MOST = (0.1, 0.9)
_CYCLES = (0.9, 2.5)
#: Rows for which a command has to be held; what delays have to differ by, in rows, to be no chance of the sampling; so
#: many answers of a recording, over so many times that difference, tell a cycle well enough.
_HELD, _ROWS = 3, 1.0
_ENOUGH, _LASTS = 60, 2000.0


@dataclass(frozen=True, slots=True)
class Onsets:
    """Instants [s since the first row] at which steps were commanded and at which each was answered, in order; the
    recording has a row every `period_s`."""

    commanded_s: FloatArray
    answered_s: FloatArray
    period_s: float

    @property
    def delays_s(self) -> FloatArray:
        return self.answered_s - self.commanded_s


def onsets(recording: Recording) -> Onsets:
    """The first clear steps that were answered by half before the next; none without a pressure."""
    found: list[tuple[float, float]] = []
    p, u, t = recording.pressure, recording.command, recording.time_s - recording.time_s[0]
    if p is not None and p.size > 2:
        least = _CLEAR * float(np.nanmedian(np.abs(np.diff(p)))) + 1e-9
        changes = np.append(np.flatnonzero(np.diff(u) != 0.0) + 1, u.size)
        for at, end in _held(changes):
            step = u[at] - p[at - 1]
            if abs(step) >= least and len(found) < _ENOUGH:
                begun = _begun(t[at - 1 : end], (p[at - 1 : end] - p[at - 1]) / step)
                found += [(float(t[at - 1]), begun)] if begun is not None and np.isfinite(begun) else []
    commanded, answered = np.array(found).reshape(-1, 2).T
    return Onsets(commanded, answered, recording.period_s)


def _held(changes: npt.NDArray[np.int64]) -> list[tuple[int, int]]:
    """The rows in which a command came, and the next one did, of those that were held; a ramp has none."""
    held = np.flatnonzero(np.diff(changes) >= _HELD)
    return [(int(changes[k]), int(changes[k + 1])) for k in held]


def _begun(t: FloatArray, share: FloatArray) -> float | None:
    """When a lag began of which these shares are done; None where it has not come far enough, or is not known."""
    instants = []
    for level in (_EARLY, _LATE):
        above = np.flatnonzero(share >= level)
        if not above.size or above[0] == 0:
            return None
        k = int(above[0])
        instants.append(float(t[k - 1] + (t[k] - t[k - 1]) * (level - share[k - 1]) / (share[k] - share[k - 1])))
    begun: float = instants[0] - _BEFORE * (instants[1] - instants[0])
    return begun


def clocks(found: Sequence[Onsets], most: int) -> list[tuple[float, list[float]]]:
    """The likeliest cycles [s], at which the answers of each recording keep step, with the phase in each [cycles].

    A spectrum of the instants (Rayleigh's test: Mardia, Jupp, Directional Statistics (Wiley 2000), ch. 6) for cycles
    as long as the delays say: within one every command is seen.
    """
    delays = np.concatenate([one.delays_s for one in found])
    spread = float(np.diff(np.quantile(delays, _MOST))[0]) if delays.size else 0.0
    if delays.size < _FEWEST or spread <= _ROWS * max(one.period_s for one in found):
        return []
    told = [a[a <= a[0] + _LASTS * spread] if (a := one.answered_s).size else a for one in found]
    lasts_s = max(float(np.ptp(a)) for a in told if a.size)
    rates = np.arange(1.0 / (_CYCLES[1] * spread), 1.0 / (_CYCLES[0] * spread), 0.1 / max(lasts_s, spread))
    turns = [np.exp(-2j * np.pi * rates[:, None] * a[None, :]).sum(axis=1) for a in told]
    strength = np.sum(np.abs(turns), axis=0)
    peaks = [k for k in np.argsort(-strength) if strength[k] == strength[max(k - 5, 0) : k + 6].max()][:most]
    return [(float(1.0 / rates[k]), [float(-np.angle(one[k]) / (2.0 * np.pi)) % 1.0 for one in turns]) for k in peaks]
