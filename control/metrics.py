"""How good a trial was: steady error, settling against what physics allows, overshoot, wear, air, limit cycles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from control.design import DesignModel
from control.observer import follow
from control.scenarios import Scenario
from control.trial import Trace

FloatArray = npt.NDArray[np.float64]
BAND_PERCENT = 0.5  # settled: within this share of travel for the rest of the hold
CYCLE_PERCENT = 0.6  # a limit cycle leaves a band of +-0.3 %, turns three times or more, and does not end


@dataclass(frozen=True, slots=True)
class HoldScore:
    """One hold. Percent of travel, seconds. `ratio` is settling time over the floor (None where it did not settle, or
    where there was no step); `cycle` is the peak-to-peak of a limit cycle, 0 for none."""

    steady: float
    ripple: float
    settling_s: float | None
    floor_s: float
    overshoot: float
    cycle: float

    @property
    def ratio(self) -> float | None:
        return None if self.settling_s is None or self.floor_s <= 0.0 else self.settling_s / self.floor_s


@dataclass(frozen=True, slots=True)
class Score:
    """One trial. `steady` is the worst |mean error| of the last quarter of a hold, `peak` the worst momentary error
    there, `ratio` the median over the settled steps, `unsettled` the share of steps that never settled; `stem_in` is
    the way that the stem went [in], `air_psi` what was let in (sum of pressure rises) [psi]."""

    steady: float
    peak: float
    settling_s: float
    ratio: float
    worst_ratio: float
    unsettled: float
    overshoot: float
    cycle: float
    stem_in: float
    air_psi: float


def score(trace: Trace, scenario: Scenario, valve: DesignModel) -> Score:
    """Scores a trial; `valve` has the numbers of the valve as it really is: the floor is computed for it."""
    judged_in = trace.position_in if scenario.reading_only else trace.truth_in
    holds = _holds(trace, judged_in, scenario, valve)
    steps = [h for h in holds if h.floor_s > 0.0]
    ratios = [h.ratio for h in steps if h.ratio is not None] or [float("nan")]
    settled = [h.settling_s for h in steps if h.settling_s is not None] or [float("nan")]
    return Score(
        steady=max(h.steady for h in holds),
        peak=max(h.ripple for h in holds),
        settling_s=float(np.median(settled)),
        ratio=float(np.median(ratios)),
        worst_ratio=float(np.max(ratios)),
        unsettled=sum(h.settling_s is None for h in steps) / max(len(steps), 1),
        overshoot=max(h.overshoot for h in holds),
        cycle=max(h.cycle for h in holds),
        stem_in=float(np.abs(np.diff(trace.truth_in)).sum()),
        air_psi=float(np.clip(np.diff(_smooth(trace.pressure_psi, 3)), 0.0, None).sum()),
    )


def _holds(trace: Trace, judged_in: FloatArray, scenario: Scenario, valve: DesignModel) -> list[HoldScore]:
    scores, row = [], 0
    for part in scenario.segments:
        n = round(part.duration_s / trace.period_s)
        if part.is_hold:
            part_in = _smooth(judged_in, 9)[row : row + n] if scenario.reading_only else judged_in[row : row + n]
            start = (float(trace.pressure_psi[row]), float(part_in[0]))
            scores.append(score_hold(part_in, part.end_in, start, trace.period_s, valve))
        row += n
    return scores


def score_hold(
    part_in: FloatArray, target_in: float, start: tuple[float, float], period_s: float, valve: DesignModel
) -> HoldScore:
    """One hold at `target_in`, which began at pressure and position `start`."""
    error = 100.0 * (part_in - target_in) / valve.travel
    last = error[-max(error.size // 4, 1) :]
    outside = np.nonzero(np.abs(error) > BAND_PERCENT)[0]
    settling_s = 0.0 if outside.size == 0 else float((outside[-1] + 1) * period_s)
    floor_s = floor(valve, start[0], start[1], target_in)
    beyond = error * (1.0 if target_in >= start[1] else -1.0)
    return HoldScore(
        steady=abs(float(last.mean())),
        ripple=float(np.abs(last).max()),
        settling_s=None if outside.size and outside[-1] >= error.size - 1 else settling_s,
        floor_s=floor_s + period_s if floor_s > 0.0 else 0.0,
        overshoot=max(float(beyond.max()), 0.0) if floor_s > 0.0 else 0.0,
        cycle=limit_cycle(error[error.size // 4 :]) if np.ptp(error[-error.size // 3 :]) > CYCLE_PERCENT else 0.0,
    )


def floor(valve: DesignModel, pressure_psi: float, position_in: float, target_in: float) -> float:
    """The time [s] in which no controller can be faster: full supply (or none) until the stem enters the band.

    The design equations with command 20 or 0 psi from rest at `position_in`. `score_hold` adds one tick, because a
    command cannot go out before the tick after the reading.
    """
    band_in = 0.01 * BAND_PERCENT * valve.travel
    if abs(target_in - position_in) <= band_in:
        return 0.0
    closing = target_in > position_in
    command_psi = 20.0 if closing else 0.0
    k, h, p, w, x = valve.compliance, 0.01, pressure_psi, min(max(position_in, 0.0), valve.travel), position_in
    for step in range(10_000):
        if abs(target_in - x) <= band_in:
            return step * h
        p += (command_psi - p) * (h / valve.ep_tau_s if valve.ep_tau_s > h else 1.0)
        w = min(max(k * (p - valve.a1), min(k * (p - valve.a2), w), 0.0), valve.travel)
        x = follow(x, w, valve.tau_s, valve.rate_limit, h)
    return float("inf")


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
