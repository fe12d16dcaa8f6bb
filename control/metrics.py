"""How good a trial was: steady error, settling against what physics allows, overshoot, wear, air, limit cycles."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from control.design import DesignModel
from control.fastest import Supply, fastest_s
from control.scenarios import TRAVEL_IN, Scenario
from control.trial import Trace

FloatArray = npt.NDArray[np.float64]
CLOSE = 1.2 + 1e-9  # what the goal allows in times of the floor
BAND_PERCENT = 0.5  # settled: within this share of travel for the rest of the hold
GOAL_PERCENT = 0.3  # of travel, for the worst steady error
CYCLE_PERCENT = 0.3  # three standard deviations of one nominal reading (0.0006 in)


@dataclass(frozen=True, slots=True)
class HoldScore:
    """One hold. Percent of travel, seconds. `ratio` is settling time over the floor (None where it did not settle, or
    where there was no step); `cycle` is the peak-to-peak of a limit cycle, 0 for none. `error` is the mean error with
    its sign."""

    error: float
    ripple: float
    settling_s: float | None
    floor_s: float
    overshoot: float
    cycle: float

    @property
    def steady(self) -> float:
        return abs(self.error)

    @property
    def ratio(self) -> float | None:
        return None if self.settling_s is None or self.floor_s <= 0.0 else self.settling_s / self.floor_s


@dataclass(frozen=True, slots=True)
class Score:
    """One trial. `steady` is the worst |mean error| of the last quarter of a hold, `later` that without the first hold,
    `peak` the worst momentary error there, `ratio` the median over the settled steps, `close` the share of all steps
    that settle within 1.2 floors, `unsettled` the share that never settled; `stem_in` is the way that the stem went
    [in], `air_psi` what was let in (sum of pressure rises) [psi]."""

    steady: float
    peak: float
    settling_s: float
    ratio: float
    worst_ratio: float
    close: float
    unsettled: float
    overshoot: float
    cycle: float
    stem_in: float
    air_psi: float
    later: float = float("nan")


def score(trace: Trace, scenario: Scenario, valve: DesignModel) -> Score:
    """Scores a trial; `valve` has the numbers of the valve as it really is: the floor is computed for it."""
    holds = hold_scores(trace, scenario, valve)
    steps = [h for h in holds if h.floor_s > 0.0]
    ratios = [h.ratio for h in steps if h.ratio is not None] or [float("nan")]
    settled = [h.settling_s for h in steps if h.settling_s is not None] or [float("nan")]
    return Score(
        steady=max(h.steady for h in holds),
        peak=max(h.ripple for h in holds),
        settling_s=float(np.median(settled)),
        ratio=float(np.median(ratios)),
        worst_ratio=float(np.max(ratios)),
        close=sum(h.ratio is not None and h.ratio <= CLOSE for h in steps) / max(len(steps), 1),
        unsettled=sum(h.settling_s is None for h in steps) / max(len(steps), 1),
        overshoot=max(h.overshoot for h in holds),
        cycle=max(h.cycle for h in holds),
        stem_in=float(np.abs(np.diff(trace.truth_in)).sum()),
        later=max(h.steady for h in holds[1:] or holds),
        air_psi=float(np.clip(np.diff(_smooth(trace.pressure_psi, 3)), 0.0, None).sum()),
    )


def hold_scores(trace: Trace, scenario: Scenario, valve: DesignModel) -> list[HoldScore]:
    """One score per hold of the scenario, in order. Where the gauge's gain is wrong, what counts is the noise-free
    reading, the true stem times that gain: no controller can know better, and noise is not counted as an error."""
    judged_in = trace.truth_in * scenario.reading_gain
    scores, row, rests = [], 0, True
    for part in scenario.segments:
        n = round(part.duration_s / trace.period_s)
        if part.is_hold:
            part_in = judged_in[row : row + n]
            start = (float(trace.pressure_psi[row]), float(part_in[0]))
            found = score_hold(part_in, part.end_in, start, trace.period_s, valve, scenario.supply)
            scores.append(found if rests else replace(found, floor_s=0.0))  # the floor is for a step from rest
        row, rests = row + n, part.is_hold
    return scores


def score_hold(
    part_in: FloatArray,
    target_in: float,
    start: tuple[float, float],
    period_s: float,
    valve: DesignModel,
    supply: Supply = Supply(),  # noqa: B008 (frozen)
) -> HoldScore:
    """One hold at `target_in`, which began at pressure and position `start`.

    The floor is the physical minimum plus one tick, because a command cannot go out before the tick after the reading,
    rounded up to a tick, because settling is seen at ticks.
    """
    error = 100.0 * (part_in - target_in) / TRAVEL_IN
    last = last_quarter(error)
    least_s = fastest_s(valve, supply, start, target_in, 0.01 * BAND_PERCENT * TRAVEL_IN)
    beyond = error * (1.0 if target_in >= start[1] else -1.0)
    return HoldScore(
        error=float(last.mean()),
        ripple=float(np.abs(last).max()),
        settling_s=settling_s(error, period_s),
        floor_s=math.ceil(least_s / period_s + 1.0 - 1e-9) * period_s if 0.0 < least_s < math.inf else 0.0,
        overshoot=max(float(beyond.max()), 0.0) if least_s > 0.0 else 0.0,
        cycle=hold_cycle(error),
    )


def last_quarter(error_percent: FloatArray) -> FloatArray:
    """The errors of a hold that count as steady."""
    return error_percent[-max(error_percent.size // 4, 1) :]


def settling_s(error_percent: FloatArray, period_s: float) -> float | None:
    """When the error comes within `BAND_PERCENT` for the rest of the hold [s]; None where it does not."""
    outside = np.flatnonzero(np.abs(error_percent) > BAND_PERCENT)
    if outside.size == 0:
        return 0.0
    return None if outside[-1] == error_percent.size - 1 else float((outside[-1] + 1) * period_s)


def hold_cycle(error_percent: FloatArray) -> float:
    """Peak to peak [percent of travel] of a hold's limit cycle: after its first quarter, and still there in its last
    third; 0 where there is none."""
    if np.ptp(error_percent[-error_percent.size // 3 :]) <= CYCLE_PERCENT:
        return 0.0
    return limit_cycle(error_percent[error_percent.size // 4 :])


def limit_cycle(error_percent: FloatArray) -> float:
    """Peak to peak [percent of travel] of an oscillation that turns at least three times; 0 where there is none."""
    swing = float(np.ptp(error_percent))
    if swing < CYCLE_PERCENT:
        return 0.0
    turns, direction, extreme = 0, 0, float(error_percent[0])
    for value in error_percent:
        if direction >= 0 and value < extreme - 0.4 * swing:
            turns, direction, extreme = turns + 1, -1, float(value)
        elif direction <= 0 and value > extreme + 0.4 * swing:
            turns, direction, extreme = turns + 1, 1, float(value)
        elif (value - extreme) * direction > 0.0 or direction == 0:
            extreme = float(value) if direction else extreme
    return swing if turns >= 3 else 0.0


def _smooth(values: FloatArray, width: int) -> FloatArray:
    """A centred moving average of `width` rows; the ends use what there is."""
    kernel = np.ones(width)
    smooth: FloatArray = np.convolve(values, kernel, "same") / np.convolve(np.ones_like(values), kernel, "same")
    return smooth
