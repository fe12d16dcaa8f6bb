"""How often the 95 % intervals of closure and where-map hold the truth: `python bench/interval_coverage.py`.

Residuals with a known memory are drawn again and again, as long as so many memories, and handed to the functions that
a diagnosis uses. `waves` are first-order autoregressions, `dwells` stay where they are for a chance time, as the error
of a stem that waits in its deadband does. Printed: the share of intervals that hold the truth [%], over all that a draw
has, and in brackets the median width. A record of few memories is a small sample, however many rows it has.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.signal import lfilter

from logs.recording import FloatArray
from twin.diagnosis import Share
from twin.where.closure import closure
from twin.where.strata import bin_shares, class_shares
from twin.where.telescope import stage_shares, two_stage_terms

MEMORY = 20.0  # rows: 1 + 2 x the sum of the residual's correlations
MEMORIES = (20, 60, 200, 1000)  # per record
NOISE = 1.0
FLOOR_ERROR = 0.05
_SIZES = np.array([1.0, 3.0, 5.0])  # of the error in each of three strata
_BINS = np.array([2.0, 2.0, 2.0, 4.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0])

Draw = Callable[[np.random.Generator, int], FloatArray]
Found = Iterator[tuple[Share, float]]  # what was said, and the truth


def waves(dice: np.random.Generator, rows: int) -> FloatArray:
    """A stationary first-order autoregression of variance 1 and the memory `MEMORY`."""
    phi = (MEMORY - 1.0) / (MEMORY + 1.0)
    shocks = np.sqrt(1.0 - phi**2) * dice.standard_normal(rows)
    series, _ = lfilter([1.0], [1.0, -phi], shocks, zi=[phi * dice.standard_normal()])
    return np.asarray(series, dtype=np.float64)


def dwells(dice: np.random.Generator, rows: int) -> FloatArray:
    """Levels of variance 1 that last for a geometric time; the same memory."""
    changes = np.cumsum(dice.random(rows) < 2.0 / (1.0 + MEMORY))
    return np.asarray(dice.standard_normal(int(changes[-1]) + 1)[changes], dtype=np.float64)


def closed(dice: np.random.Generator, rows: int, slow: Draw, left: float) -> Found:
    """A model that leaves the share `left` of the error's size, in part of the same shape; the floor as measured."""
    error, noise = slow(dice, rows), NOISE * dice.standard_normal(rows)
    rest = 0.5 * error + np.sqrt(0.75) * slow(dice, rows)
    floor = NOISE * (1.0 + FLOOR_ERROR * dice.standard_normal())
    share = closure(4.0 * error + noise, 4.0 * left * rest + noise, floor, floor_relative_error=FLOOR_ERROR)
    if share is not None:
        yield share, 1.0 - left**2


def stages(dice: np.random.Generator, rows: int, slow: Draw) -> Found:
    """Two stages that cancel in part."""
    pressure, stem = slow(dice, rows), slow(dice, rows)
    ep, rest = 4.0 * pressure, 2.0 * (np.sqrt(0.91) * stem - 0.3 * pressure)
    noise = NOISE * dice.standard_normal(rows)
    shares = stage_shares(
        ep + rest + noise, two_stage_terms(ep + rest + noise, 0.0 * ep, ep), NOISE, "actuator_or_sensor"
    )
    truth = {"ep": (16.0 - 2.4) / (20.0 - 4.8), "actuator_or_sensor": (4.0 - 2.4) / (20.0 - 4.8)}
    yield from ((share, truth[name]) for name, share in (shares or {}).items())


def strata(dice: np.random.Generator, rows: int, slow: Draw) -> Found:
    """Three strata that take turns for a chance time of three memories, as directions of motion do."""
    classes = np.zeros(rows, dtype=np.int64)
    start, now = 0, 0
    while start < rows:
        stop = start + 1 + int(dice.geometric(1.0 / (3.0 * MEMORY)))
        now = (now + 1 + int(dice.integers(2))) % 3
        classes[start:stop] = now
        start = stop
    error = slow(dice, rows) * _SIZES[classes] + NOISE * dice.standard_normal(rows)
    shares = class_shares(error, classes, ("a", "b", "c"), NOISE)
    truth = dict(zip("abc", _SIZES**2 / np.sum(_SIZES**2), strict=True))
    yield from ((share, float(truth[name])) for name, share in (shares or {}).items())


def times(dice: np.random.Generator, rows: int, slow: Draw) -> Found:
    """Tenths of the record's time, one of which has twice the error."""
    time = np.arange(rows) / rows
    error = slow(dice, rows) * _BINS[(10 * np.arange(rows)) // rows] + NOISE * dice.standard_normal(rows)
    bins = bin_shares(error, time, np.linspace(0.0, 1.0, 11), NOISE)
    truth = _BINS**2 / np.sum(_BINS**2)
    yield from ((one.share, float(true)) for one, true in zip(bins or (), truth, strict=False))


Case = Callable[[np.random.Generator, int, Draw], Found]
CASES: dict[str, Case] = {
    "closure of 0.91": lambda dice, rows, slow: closed(dice, rows, slow, 0.3),
    "closure of 0.36": lambda dice, rows, slow: closed(dice, rows, slow, 0.8),
    "stages": stages,
    "strata": strata,
    "times": times,
}


def held(case: Case, slow: Draw, rows: int, draws: int) -> tuple[float, float]:
    """Share of the intervals that hold the truth, and their median width."""
    found = [one for seed in range(draws) for one in case(np.random.default_rng([seed, rows]), rows, slow)]
    inside = [share.ci95[0] <= truth <= share.ci95[1] for share, truth in found]
    return float(np.mean(inside)), float(np.median([share.ci95[1] - share.ci95[0] for share, _ in found]))


def table(draws: int, names: Sequence[str]) -> Iterator[str]:
    """A line per case and kind of residual: percent held, and the width in brackets, per length of the record."""
    yield f"memories per record:       {''.join(f'{count:>15d}' for count in MEMORIES)}"
    for name in names:
        for slow in (waves, dwells):
            cells = (held(CASES[name], slow, int(count * MEMORY), draws) for count in MEMORIES)
            yield f"{name + ', ' + slow.__name__:27s}" + "".join(f"{100 * p:8.1f} ({w:.3f})" for p, w in cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=300)
    parser.add_argument("--case", choices=list(CASES), action="append")
    asked = parser.parse_args()
    for line in table(asked.draws, asked.case or list(CASES)):
        print(line, flush=True)


if __name__ == "__main__":
    main()
