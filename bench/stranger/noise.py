"""What every session adds: sensor noise, and in a rough one a polling jitter and a slowly wandering pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bench.stranger.excite import ROW_S
from bench.stranger.kernel import STEP_S

POSITION_IN = 0.0007
_STEPS = round(ROW_S / STEP_S)


class Noise(NamedTuple):
    """White noise of the readings, and whether the session is rough."""

    position_in: float = POSITION_IN
    pressure_psi: float = 0.015
    rough: bool = False


QUIET = Noise(0.0, 0.0)


def steps_per_row(noise: Noise, rows: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Steps of the plant between polls, shape (rows,): regular, or with a jitter of 3 ms."""
    if not noise.rough:
        return np.full(rows, _STEPS, dtype=np.int64)
    return np.clip(np.rint(_STEPS + rng.normal(0.0, 3.0, rows)), 0.8 * _STEPS, 1.2 * _STEPS).astype(np.int64)


def wander_psi(noise: Noise, rows: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Slow wander of the converter's pressure [psi], shape (rows,): 0.01 psi over half a minute, or none."""
    if not noise.rough:
        return np.zeros(rows)
    keep = float(np.exp(-ROW_S / 30.0))
    kicks = rng.normal(0.0, 0.01 * np.sqrt(1.0 - keep * keep), rows)
    wandering = np.zeros(rows)
    for row in range(1, rows):
        wandering[row] = keep * wandering[row - 1] + kicks[row]
    return wandering
