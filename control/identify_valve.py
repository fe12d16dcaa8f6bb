"""Second stage: the valve's numbers by an output-error fit, given a pressure that is fit to drive the play.

A coarse search over play width, slope, offset and lag starts it, so that no first guess is needed; a least-squares fit
that false readings cannot pull ends it. Whether a travel stop and a rate limit are in the record at all is decided by
fitting with and without them. Where no pressure was measured, so is whether the record shows the converter's lag: the
play between the two lags tells them apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from control.identify_least_squares import Problem, minimise
from control.identify_model import EP, RATE, TAU, TRAVEL, stem
from control.identify_starts import NEVER, first_guesses
from control.identify_track import Track, reach_of, thinned
from logs.recording import FloatArray

DOUBT_S = 0.02  # of the converter's lag, from which on it may be taken for a rate limit
GAIN_FOR_A_NUMBER = 12.0  # fall of the cost, in units of the noise variance times memory, that a number must bring


@dataclass(frozen=True, slots=True)
class ValveFit:
    """`numbers` is (a1, a2, k1, k2, tau, rate, travel, ep_tau); `rate` and `travel` are `NEVER` where they play no
    part, `ep_tau` is NaN where the pressure is the tracks' own.

    `play_starts` holds the play output at the first row of each track.
    """

    numbers: FloatArray
    play_starts: FloatArray
    cost: float

    def predict(self, tracks: Sequence[Track]) -> list[FloatArray]:
        """The stem at the rows of each track."""
        starts = zip(tracks, self.play_starts, strict=True)
        return [stem(t.grid, t.driven(self.ep_tau_s), self.numbers, t.start, float(w0))[0] for t, w0 in starts]

    @property
    def ep_tau_s(self) -> float | None:
        return None if np.isnan(self.numbers[EP]) else float(self.numbers[EP])

    def residual(self, tracks: Sequence[Track]) -> FloatArray:
        """Readings minus prediction over all good rows of all tracks."""
        pairs = zip(tracks, self.predict(tracks), strict=True)
        return np.concatenate([(t.position - x)[t.good] for t, x in pairs])


@dataclass(frozen=True, slots=True)
class Freedom:
    """Which numbers are fitted. `separate` lets the two curves have slopes of their own, `ep` the converter its lag."""

    rate: bool
    travel: bool
    separate: bool = False
    ep: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        slopes = ("k1", "k2") if self.separate else ("compliance",)
        limits = ("rate_limit",) * self.rate + ("travel",) * self.travel
        return ("a1", "a2", *slopes, "tau", *limits) + ("ep.tau",) * self.ep

    def unpack(self, values: FloatArray) -> FloatArray:
        """The eight numbers from the fitted ones, in the order of `names`."""
        named = dict(zip(self.names, values, strict=True))
        k1 = named.get("compliance", named.get("k1"))
        k2 = named.get("compliance", named.get("k2"))
        rate, travel, ep = named.get("rate_limit", NEVER), named.get("travel", NEVER), named.get("ep.tau", np.nan)
        return np.array([named["a1"], named["a2"], k1, k2, named["tau"], rate, travel, ep], dtype=float)

    def pack(self, numbers: FloatArray) -> FloatArray:
        a1, a2, k1, k2, tau, rate, travel, ep = numbers
        slopes = [k1, k2] if self.separate else [0.5 * (k1 + k2)]
        return np.array([a1, a2, *slopes, tau] + [rate] * self.rate + [travel] * self.travel + [ep] * self.ep)


def fit_valve(tracks: Sequence[Track]) -> tuple[ValveFit, Freedom]:
    """The best fit over all tracks, and which numbers it needed."""
    rough = [thinned(track) for track in tracks]
    guesses = _coarse(rough)
    fits = [_refine(rough, each, Freedom(False, bool(each[TRAVEL] < NEVER)), rounds=8) for each in guesses]
    ep = all(track.command is not None for track in tracks)
    if ep:
        starts = [*guesses, min(fits, key=lambda each: each.cost).numbers]
        fits = [_with_converter(rough, each) for each in starts]
    fit, freedom = _settle_freedom(rough, min(fits, key=lambda each: each.cost), ep)
    return _refine(tracks, fit.numbers, freedom, rounds=12, play_starts=fit.play_starts), freedom


def _with_converter(tracks: Sequence[Track], numbers: FloatArray) -> ValveFit:
    """The better of two fits whose converter has a lag, from smaller shares on: without a play either lag would do."""
    options = []
    for share in (0.1, 0.3):
        start = numbers.copy()
        start[EP], start[TAU] = share * numbers[TAU], (1.0 - share) * numbers[TAU]
        options.append(_refine(tracks, start, Freedom(False, bool(start[TRAVEL] < NEVER), ep=True), rounds=8))
    return min(options, key=lambda each: each.cost)


def _settle_freedom(tracks: Sequence[Track], fit: ValveFit, ep: bool) -> tuple[ValveFit, Freedom]:
    """Fits with every combination of rate limit, stop and, where there is no pressure, converter, and keeps the
    plainest that loses nothing.
    """
    speed, top = top_speed(tracks, fit), reach_of(tracks).top
    found: dict[Freedom, ValveFit] = {}
    for rate, stop, lags in product((False, True), (False, True), (False, True) if ep else (False,)):
        freedom, options = Freedom(rate, stop, ep=lags), []
        for share in (0.4, 0.8) if rate else (1.0,):
            numbers = fit.numbers.copy()
            numbers[RATE] = share * speed if rate else NEVER
            numbers[TRAVEL] = top if stop else NEVER
            numbers[EP] = numbers[EP] if lags else np.nan
            options.append(_refine(tracks, numbers, freedom, rounds=10))
        found[freedom] = min(options, key=lambda each: each.cost)
    full = Freedom(True, True, ep=ep)
    worth = GAIN_FOR_A_NUMBER * _variance(found[full].residual(tracks))
    for freedom in sorted(found, key=lambda each: (len(each.names), each.rate)):
        lacking = len(full.names) - len(freedom.names)
        if _least_cost(tracks, found[freedom], freedom) - found[full].cost < worth * lacking:
            return found[freedom], freedom
    return found[full], full


def _least_cost(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> float:
    """The cost without a rate limit under the converter's lag that suits it best.

    A lag that the pressure does not tell bends the steps as a rate limit would: no limit is found for that alone.
    """
    if freedom.rate or max(track.lag_doubt_s for track in tracks) < DOUBT_S:
        return fit.cost
    moved = [[track.lag_moved(way) for track in tracks] for way in (-1.0, 1.0)]
    return min(fit.cost, *(_refine(each, fit.numbers, freedom, rounds=8).cost for each in moved))


def refit_separate(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> tuple[ValveFit, Freedom]:
    """The same fit with a slope for each curve."""
    separate = replace(freedom, separate=True)
    return _refine(tracks, fit.numbers, separate, rounds=12, play_starts=fit.play_starts), separate


def refitted(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> ValveFit:
    """The same numbers fitted to other tracks, from where a fit has ended."""
    return _refine(tracks, fit.numbers, freedom, rounds=12, play_starts=fit.play_starts)


def jacobian(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> FloatArray:
    """d prediction / d fitted number, shape (good rows, numbers + tracks); the last columns are the play's starts."""
    values = np.concatenate((freedom.pack(fit.numbers), fit.play_starts))
    steps = _steps(tracks, freedom, len(tracks))
    pairs = [
        (values + step * unit, values - step * unit) for step, unit in zip(steps, np.eye(values.size), strict=True)
    ]
    moved = [_residual(tracks, below, freedom) - _residual(tracks, above, freedom) for above, below in pairs]
    return np.column_stack([each / (2.0 * step) for each, step in zip(moved, steps, strict=True)])


def _refine(
    tracks: Sequence[Track],
    numbers: FloatArray,
    freedom: Freedom,
    *,
    rounds: int,
    play_starts: FloatArray | None = None,
) -> ValveFit:
    at = np.array([t.start for t in tracks]) if play_starts is None else play_starts
    start = np.concatenate((freedom.pack(numbers), at))
    steps = _steps(tracks, freedom, len(tracks))
    low, high = _bounds(tracks, freedom)
    rest = _residual(tracks, np.clip(start, low, high), freedom)
    soft = 3.0 * max(np.sqrt(_variance(rest)), 1e-4 * reach_of(tracks).width)
    problem = Problem(lambda values: _residual(tracks, values, freedom), low, high, steps, soft)
    found, _ = minimise(problem, start, rounds=rounds)
    rest = _residual(tracks, found, freedom)
    count = len(freedom.names)
    cost = float(np.sum(np.minimum(rest**2, 25.0 * _variance(rest))))
    return ValveFit(freedom.unpack(found[:count]), found[count:], cost)


def _residual(tracks: Sequence[Track], values: FloatArray, freedom: Freedom) -> FloatArray:
    count = len(freedom.names)
    return ValveFit(freedom.unpack(values[:count]), values[count:], 0.0).residual(tracks)


def _variance(rest: FloatArray) -> float:
    return max((1.4826 * float(np.median(np.abs(rest)))) ** 2, 1e-30)


def _bounds(tracks: Sequence[Track], freedom: Freedom) -> tuple[FloatArray, FloatArray]:
    seen = reach_of(tracks)
    span, reach, top = seen.span, seen.width, seen.top
    slope = reach / span
    slopes = 2 if freedom.separate else 1
    lowest = seen.p_low - span - seen.away / (0.05 * slope)
    low = [lowest, lowest, *[0.05 * slope] * slopes, 1e-3]
    high = [seen.p_high + span, seen.p_high + span, *[200.0 * slope] * slopes, 300.0]
    low += [1e-4 * reach] * freedom.rate + [0.5 * top] * freedom.travel
    low += [1e-3] * freedom.ep + [-2.0 * reach] * len(tracks)
    high += [1e3 * reach] * freedom.rate + [2.0 * top] * freedom.travel
    high += [300.0] * freedom.ep + [top + 2.0 * reach] * len(tracks)
    return np.array(low), np.array(high)


def _steps(tracks: Sequence[Track], freedom: Freedom, count: int) -> FloatArray:
    """A small change of each fitted number: a ten-thousandth of its natural size."""
    seen = reach_of(tracks)
    span, reach = seen.span, seen.width
    slopes = 2 if freedom.separate else 1
    sizes = [span, span, *[reach / span] * slopes, 1.0] + [reach / 5.0] * freedom.rate + [reach] * freedom.travel
    return 1e-4 * np.array(sizes + [1.0] * freedom.ep + [reach] * count)


def top_speed(tracks: Sequence[Track], fit: ValveFit) -> float:
    """The highest speed of the stem in the fit."""
    pairs = zip(tracks, fit.predict(tracks), strict=True)
    return max(1e-9, *(float(np.max(np.abs(np.diff(x)) / np.diff(t.grid.time_s), initial=0.0)) for t, x in pairs))


def _coarse(tracks: Sequence[Track]) -> list[FloatArray]:
    """First guesses, those first that miss least; a guess far off is no worse than one that shows no motion."""
    reach = reach_of(tracks)
    starts = np.array([t.start for t in tracks])

    def cost(numbers: FloatArray) -> float:
        rest = np.abs(ValveFit(numbers, starts, 0.0).residual(tracks))
        return float(np.mean(np.minimum(rest, 0.3 * reach.width) ** 2))

    return first_guesses(reach, cost)
