"""Command sequences that somebody at a bench would choose: stairs with inner reversals, random steps, slow ramps.

One pass begins and ends with the valve fully open and is run twice, in one record or as two.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

ROW_S = 0.1
REST_PSI, LOW_PSI, HIGH_PSI = 4.5, 5.0, 13.5
_REST_S, _UNRECORDED_S = 15.0, 20.0

Floats = NDArray[np.float64]


class Session(NamedTuple):
    """Commands [psi] of all rows; the first `skipped` rows are run but not recorded; `cuts` are rows of new records."""

    commands_psi: Floats
    skipped: int
    cuts: tuple[int, ...]


def _hold(level_psi: float, duration_s: float) -> Floats:
    return np.full(max(round(duration_s / ROW_S), 1), level_psi)


def _ramp(start_psi: float, end_psi: float, slope_psi_s: float) -> Floats:
    rows = max(round(abs(end_psi - start_psi) / slope_psi_s / ROW_S), 2)
    return np.linspace(start_psi, end_psi, rows)


def inner_stairs(rng: np.random.Generator) -> Floats:
    """Up and down in steps, with shorter ways back and forth in between (inner loops)."""
    dwell_s, step_psi = float(rng.uniform(4.0, 7.0)), float(rng.uniform(0.8, 1.3))
    turns = [LOW_PSI, *(float(level) for level in rng.uniform(6.5, 12.5, 4)), HIGH_PSI, LOW_PSI]
    pieces = []
    for start, end in itertools.pairwise(turns):
        count = max(round(abs(end - start) / step_psi), 1)
        pieces += [_hold(float(level), dwell_s) for level in np.linspace(start, end, count + 1)[1:]]
    return np.concatenate(pieces)


def random_steps(rng: np.random.Generator) -> Floats:
    """Steps of all sizes, some before the stem has settled."""
    count = int(rng.integers(16, 26))
    levels, dwells = rng.uniform(LOW_PSI, HIGH_PSI, count), rng.uniform(2.0, 11.0, count)
    return np.concatenate([_hold(float(level), float(dwell)) for level, dwell in zip(levels, dwells, strict=True)])


def slow_ramps(rng: np.random.Generator) -> Floats:
    """Full stroke and one inner loop, slowly."""
    slope = float(rng.uniform(0.1, 0.2))
    turns = [LOW_PSI, HIGH_PSI, float(rng.uniform(6.0, 7.5)), float(rng.uniform(10.0, 11.5)), LOW_PSI]
    return np.concatenate([_ramp(start, end, slope) for start, end in itertools.pairwise(turns)])


def open_loop(rng: np.random.Generator) -> Session:
    """Two or three kinds of test after each other, 4 to 7 minutes, and all of it again."""
    kinds = [inner_stairs, random_steps, slow_ramps]
    chosen = [kinds[k] for k in rng.permutation(3)[: int(rng.integers(2, 4))]]
    if random_steps not in chosen:
        chosen.append(random_steps)  # without it nothing tells how fast the stem is
    one = np.concatenate([_hold(REST_PSI, _REST_S), *(kind(rng) for kind in chosen), _hold(REST_PSI, _REST_S)])
    unrecorded = _hold(REST_PSI, _UNRECORDED_S)
    commands = np.concatenate([unrecorded, one, one])
    cuts = (unrecorded.size + one.size,) if rng.uniform() < 0.3 else ()
    return Session(commands, unrecorded.size, cuts)


def targets(rng: np.random.Generator) -> Floats:
    """Six desired positions [in], 35 s each: shape (rows,)."""
    return np.concatenate([_hold(float(target), 35.0) for target in rng.uniform(0.05, 0.5, 6)])


class Pi:
    """A PI position controller with anti-windup, as a bench user writes it down."""

    BIAS_PSI, GAIN_PSI_IN, INTEGRAL_PSI_IN_S = 7.3, 8.0, 1.5

    def __init__(self) -> None:
        self._integral_psi = 0.0

    def command_psi(self, target_in: float, reading_in: float) -> float:
        """The next command [psi], within the converter's 3 to 14 psi."""
        error = target_in - reading_in
        wanted = self.BIAS_PSI + self.GAIN_PSI_IN * error + self._integral_psi
        command = min(max(wanted, 3.0), 14.0)
        if command == wanted:
            self._integral_psi += self.INTEGRAL_PSI_IN_S * error * ROW_S
        return command
