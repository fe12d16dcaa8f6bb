"""Second stage: the valve's numbers by an output-error fit, given a pressure that is fit to drive the play.

A coarse search over play width, slope, offset and lag starts it, so that no first guess is needed; a least-squares fit
that false readings cannot pull ends it. Whether a travel stop and a rate limit are in the record at all is decided by
fitting with and without them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from control.identify_least_squares import Problem, minimise
from control.identify_model import RATE, TRAVEL, Grid, make_grid, stem
from control.identify_readings import fast_noise
from control.identify_starts import NEVER, Reach, first_guesses
from logs.recording import FloatArray

ROUGH_S = 0.2  # sampling that is good enough for a first guess
FEWEST_KEPT = 30  # rows, however close together they are
GAIN_FOR_A_NUMBER = 12.0  # fall of the cost, in units of the noise variance times memory, that a number must bring


@dataclass(frozen=True, slots=True)
class Track:
    """One record ready to be fitted: its grid, the driving pressure on it, and the position readings, shape (n,)."""

    grid: Grid
    pressure: FloatArray
    position: FloatArray
    good: np.ndarray
    start: float  # the position at the first row
    doubts: tuple[FloatArray, ...] = ()  # what the pressure may be off by, on the grid


def first_position(time_s: FloatArray, position: FloatArray, good: np.ndarray) -> float:
    """The position at the first row: a line through the good readings of the first second, or the first five."""
    when, values = time_s[good], position[good]
    count = min(when.size, max(5, int(np.searchsorted(when, when[0] + 1.0))))
    slope, start = np.polyfit(when[:count] - time_s[0], values[:count], 1)
    steady = abs(slope) * (when[count - 1] - time_s[0]) < 6.0 * fast_noise(values)
    return float(np.mean(values[:count]) if steady else start)


@dataclass(frozen=True, slots=True)
class ValveFit:
    """`numbers` is (a1, a2, k1, k2, tau, rate, travel); `rate` and `travel` are `NEVER` where they play no part.

    `play_starts` holds the play output at the first row of each track.
    """

    numbers: FloatArray
    play_starts: FloatArray
    cost: float

    def predict(self, tracks: Sequence[Track]) -> list[FloatArray]:
        """The stem at the rows of each track."""
        starts = zip(tracks, self.play_starts, strict=True)
        return [stem(t.grid, t.pressure, self.numbers, t.start, float(w0))[0] for t, w0 in starts]

    def residual(self, tracks: Sequence[Track]) -> FloatArray:
        """Readings minus prediction over all good rows of all tracks."""
        pairs = zip(tracks, self.predict(tracks), strict=True)
        return np.concatenate([(t.position - x)[t.good] for t, x in pairs])


@dataclass(frozen=True, slots=True)
class Freedom:
    """Which numbers are fitted. `separate` lets the two curves have slopes of their own."""

    rate: bool
    travel: bool
    separate: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        slopes = ("k1", "k2") if self.separate else ("compliance",)
        return ("a1", "a2", *slopes, "tau") + ("rate_limit",) * self.rate + ("travel",) * self.travel

    def unpack(self, values: FloatArray) -> FloatArray:
        """The seven numbers from the fitted ones, in the order of `names`."""
        slopes = 2 if self.separate else 1
        numbers = np.array([values[0], values[1], values[2], values[1 + slopes], values[2 + slopes], NEVER, NEVER])
        place = 3 + slopes
        if self.rate:
            numbers[RATE] = values[place]
            place += 1
        if self.travel:
            numbers[TRAVEL] = values[place]
        return numbers

    def pack(self, numbers: FloatArray) -> FloatArray:
        a1, a2, k1, k2, tau, rate, travel = numbers
        slopes = [k1, k2] if self.separate else [0.5 * (k1 + k2)]
        return np.array([a1, a2, *slopes, tau] + [rate] * self.rate + [travel] * self.travel)


def thinned(track: Track, least_period_s: float = ROUGH_S) -> Track:
    """The same record with rows and sub-steps as coarse as a first guess allows.

    Positions may be missing with a period of their own: of the rows that could be kept those are that have the most.
    """
    time_s = track.grid.time_s
    stride = max(1, int(least_period_s / max(float(np.median(np.diff(time_s))), 1e-6)))
    stride = min(stride, max(1, time_s.size // FEWEST_KEPT))
    keep = max((slice(first, None, stride) for first in range(stride)), key=lambda rows: int(track.good[rows].sum()))
    grid = make_grid(time_s[keep], 0.25 * least_period_s)
    pressure = np.interp(grid.fine_time_s, track.grid.fine_time_s, track.pressure)
    return Track(grid, pressure, track.position[keep], track.good[keep], track.start)


def fit_valve(tracks: Sequence[Track], starts: Sequence[FloatArray] = ()) -> tuple[ValveFit, Freedom]:
    """The best fit over all tracks, and which numbers it needed. `starts` are further first guesses (7 numbers)."""
    rough = [thinned(track) for track in tracks]
    guesses = [*(np.array(start) for start in starts), *_coarse(rough)]
    fits = [_refine(rough, each, Freedom(False, bool(each[TRAVEL] < NEVER)), rounds=8) for each in guesses]
    fit, freedom = _settle_freedom(rough, min(fits, key=lambda each: each.cost))
    return _refine(tracks, fit.numbers, freedom, rounds=12, play_starts=fit.play_starts), freedom


def _settle_freedom(tracks: Sequence[Track], fit: ValveFit) -> tuple[ValveFit, Freedom]:
    """Fits with every combination of rate limit and stop, and keeps the plainest that loses nothing."""
    speed, top = top_speed(tracks, fit), reach_of(tracks).top
    found: dict[tuple[bool, bool], ValveFit] = {}
    for rate, stop in product((False, True), repeat=2):
        options = []
        for share in (0.4, 0.8) if rate else (1.0,):
            numbers = fit.numbers.copy()
            numbers[RATE] = share * speed if rate else NEVER
            numbers[TRAVEL] = top if stop else NEVER
            options.append(_refine(tracks, numbers, Freedom(rate, stop), rounds=10))
        found[rate, stop] = min(options, key=lambda each: each.cost)
    full = found[True, True]
    worth = GAIN_FOR_A_NUMBER * _variance(full.residual(tracks))
    for rate, stop in ((False, False), (False, True), (True, False)):
        lacking = (not rate) + (not stop)
        if found[rate, stop].cost - full.cost < worth * lacking:
            return found[rate, stop], Freedom(rate, stop)
    return full, Freedom(True, True)


def refit_separate(tracks: Sequence[Track], fit: ValveFit, freedom: Freedom) -> tuple[ValveFit, Freedom]:
    """The same fit with a slope for each curve."""
    separate = Freedom(freedom.rate, freedom.travel, separate=True)
    return _refine(tracks, fit.numbers, separate, rounds=12, play_starts=fit.play_starts), separate


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
    cost = float(np.sum(np.minimum(rest**2, 25.0 * _variance(rest))))
    count = len(freedom.names)
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
    low += [1e-4 * reach] * freedom.rate + [0.5 * top] * freedom.travel + [-2.0 * reach] * len(tracks)
    high += [1e3 * reach] * freedom.rate + [2.0 * top] * freedom.travel + [top + 2.0 * reach] * len(tracks)
    return np.array(low), np.array(high)


def _steps(tracks: Sequence[Track], freedom: Freedom, count: int) -> FloatArray:
    """A small change of each fitted number: a ten-thousandth of its natural size."""
    seen = reach_of(tracks)
    span, reach = seen.span, seen.width
    slopes = 2 if freedom.separate else 1
    sizes = [span, span, *[reach / span] * slopes, 1.0] + [reach / 5.0] * freedom.rate + [reach] * freedom.travel
    return 1e-4 * np.array(sizes + [reach] * count)


def reach_of(tracks: Sequence[Track]) -> Reach:
    """How far pressure and position go in all of the tracks together."""
    return Reach(
        min(float(t.pressure.min()) for t in tracks),
        max(float(t.pressure.max()) for t in tracks),
        min(float(np.percentile(t.position[t.good], 0.5)) for t in tracks),
        max(float(np.percentile(t.position[t.good], 99.5)) for t in tracks),
    )


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
