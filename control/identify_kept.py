"""Which fitted numbers go into the design model, and which the record says nothing of and are left at their default."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from control.design import DesignModel
from control.identify_interval import Interval
from control.identify_result import Estimate
from control.identify_spread import with_lag
from control.identify_track import Track, reach_of
from control.identify_valve import Freedom, ValveFit, top_speed
from logs.recording import FloatArray

VAGUE = 0.3  # an interval whose half width is more than this share of the number's size tells nothing
BOTH_WAYS = 0.05  # of the longer way, that the shorter must be before anything can be said of two curves
SHARED = 0.01  # of tau, that the doubt of the E/P lag must add before it is worth a note
VAGUE_ONSET = 0.15  # likewise for a1 and a2, as a share of the range of pressures


@dataclass(frozen=True, slots=True)
class Facts:
    """What the stages have found, and the design whose numbers are kept where they have not."""

    base: DesignModel
    unit_p: str
    unit_x: str
    ep_tau: Interval | None
    fit: ValveFit
    freedom: Freedom
    tracks: Sequence[Track]
    kept_s: float | None  # the lag that was used for a pressure that does not tell it, where one was measured
    lag: FloatArray  # how far each fitted number goes with what is not known of the converter's lag (95 %)

    @property
    def kept_lag_s(self) -> float:
        """The converter's lag that was used where the record does not tell it [s]."""
        return self.base.ep_tau_s if self.kept_s is None else self.kept_s

    @property
    def span(self) -> float:
        """The range of pressures."""
        return max(float(t.pressure.max()) for t in self.tracks) - min(float(t.pressure.min()) for t in self.tracks)

    @property
    def highest(self) -> float:
        """The highest position, without its noise."""
        return max(float(x.max()) for x in self.fit.predict(self.tracks))

    @property
    def away(self) -> float:
        """The lowest position of a stem that never came near fully open, where both curves begin; 0 of one that did."""
        return reach_of(self.tracks).away

    @property
    def both_ways(self) -> bool:
        """Whether the stem went both ways: a record of one stroke shows one curve, whatever the play."""
        moves = [np.diff(x) for x in self.fit.predict(self.tracks)]
        ways = sum(float(np.maximum(m, 0.0).sum()) for m in moves), sum(float(np.maximum(-m, 0.0).sum()) for m in moves)
        return min(ways) > BOTH_WAYS * max(ways)


def settle_numbers(facts: Facts, spread: FloatArray, rows: int, notes: list[str]) -> tuple[DesignModel, list[Estimate]]:
    """The design model and the estimates of its numbers. `spread` is the fit's covariance, `rows` its freedom."""
    from scipy.stats import t as student

    reach = float(student.ppf(0.975, rows))
    values = facts.freedom.pack(facts.fit.numbers)
    found: dict[str, Interval] = {}
    doubtful = _doubtful(facts, values, spread, reach)
    notes += _shared(facts, values, spread, reach)
    spread = with_lag(spread, facts.lag)
    half = reach * np.sqrt(np.diag(spread))
    for name, value, width in zip(facts.freedom.names, values, half[: values.size], strict=True):
        if np.isfinite(width) and name not in doubtful:
            found[name] = Interval(float(value), float(value - width), float(value + width))
    if facts.away and {"a1", "a2"} & found.keys():
        lowest = facts.base.spoken.text(facts.away, facts.unit_x, 4)
        notes.append(
            f"the stem stayed above {lowest}: a1, a2 and the compliance are of its curves as "
            "they would go on below, and hold together only"
        )
    estimates = [*_onsets(facts, found, reach, spread, notes), *_rest(facts, found, notes)]
    by_name = {each.name: each.value for each in estimates}
    design = replace(
        facts.base,
        ep_tau_s=by_name["ep.tau"],
        a1=by_name["a1"],
        a2=by_name["a2"],
        compliance=by_name["compliance"],
        tau_s=by_name["tau"],
        rate_limit=by_name["rate_limit"],
        travel=by_name["travel"],
    )
    return design, estimates


def _shared(facts: Facts, values: FloatArray, spread: FloatArray, reach: float) -> list[str]:
    """What to say where the stem's time constant has most of its doubt from the converter's lag."""
    at = facts.freedom.names.index("tau")
    doubt_s = max(track.lag_doubt_s for track in facts.tracks)
    own, borrowed = reach * float(np.sqrt(spread[at, at])), abs(float(facts.lag[at]))
    if not borrowed > max(own, SHARED * values[at]):
        return []
    ep_s = facts.ep_tau.value if facts.ep_tau is not None else facts.kept_lag_s
    both, half = float(values[at]) + ep_s, float(np.hypot(own, facts.lag[at] + doubt_s))
    return [
        f"tau and the E/P lag add up to {both:.4g} s ({both - half:.4g} .. {both + half:.4g}); how much of it is the "
        "converter's these recordings do not tell any better, which is why the interval of tau is wide: sample faster"
    ]


def _doubtful(facts: Facts, values: FloatArray, spread: FloatArray, reach: float) -> set[str]:
    """The numbers that the record tells too vaguely to be kept.

    Of a curve it is the pressure that counts, at the lowest position that the stem went to: where that is far from
    fully open, onset and slope are one number, and either alone means nothing. Of one stroke there, nothing.
    """
    if facts.away and not facts.both_ways:
        return set(facts.freedom.names)
    variances = np.diag(spread).copy()
    if facts.away:
        way = -facts.away / values[2] ** 2
        variances[:2] = np.maximum(0.0, variances[:2] + 2.0 * way * spread[:2, 2] + way**2 * spread[2, 2])
    half = reach * np.sqrt(variances)
    vague = {name for name, width in zip(("a1", "a2"), half[:2], strict=True) if not width <= VAGUE_ONSET * facts.span}
    for name, value, width in zip(facts.freedom.names[2:], values[2:], half[2 : values.size], strict=True):
        carried = name == "ep.tau" or (name == "compliance" and facts.away and len(vague) < 2)
        if not carried and not width <= VAGUE * abs(value):
            vague.add(name)
    return vague


def _onsets(
    facts: Facts, found: dict[str, Interval], reach: float, spread: FloatArray, notes: list[str]
) -> list[Estimate]:
    """a1, a2 and the deadband; where one curve is not in the record it is put at the default's distance."""
    unit, default_width = facts.unit_p, facts.base.deadband if facts.unit_p == "psi" else 0.0
    a1, a2 = found.get("a1"), found.get("a2")
    if a1 is not None and facts.fit.numbers[1] >= facts.fit.numbers[0]:  # curves that cross act as one
        if facts.both_ways:
            return _no_play(a1, unit, notes)
        a2 = None
    if a1 is not None and a2 is not None:
        half = reach * float(np.sqrt(max(0.0, spread[0, 0] + spread[1, 1] - 2.0 * spread[0, 1])))
        width = a1.value - a2.value
        deadband = Estimate("deadband", width, Interval(width, width - half, width + half), unit, "fit")
        return [Estimate("a1", a1.value, a1, unit, "fit"), Estimate("a2", a2.value, a2, unit, "fit"), deadband]
    kept = "not in the record: default deadband"
    if a1 is not None:
        notes.append("the opening curve is not in the record: go back down past it; the deadband is the default's")
        low = Estimate("a2", a1.value - default_width, None, unit, "kept", kept)
        return [Estimate("a1", a1.value, a1, unit, "fit"), low, Estimate("deadband", default_width, None, unit, "kept")]
    if a2 is not None:
        notes.append("the closing curve is not in the record: go up past it; the deadband is the default's")
        high = Estimate("a1", a2.value + default_width, None, unit, "kept", kept)
        return [
            high,
            Estimate("a2", a2.value, a2, unit, "fit"),
            Estimate("deadband", default_width, None, unit, "kept"),
        ]
    notes.append("neither curve can be told from the record; both are the default's")
    base = facts.base
    return [
        Estimate("a1", base.a1, None, unit, "kept"),
        Estimate("a2", base.a2, None, unit, "kept"),
        Estimate("deadband", base.deadband, None, unit, "kept"),
    ]


def _no_play(a1: Interval, unit: str, notes: list[str]) -> list[Estimate]:
    notes.append("no backlash to be seen: one curve serves both directions, the deadband is 0")
    return [
        Estimate("a1", a1.value, a1, unit, "fit"),
        Estimate("a2", a1.value, a1, unit, "fit"),
        Estimate("deadband", 0.0, Interval(0.0, 0.0, 2.0 * a1.half_width), unit, "fit"),
    ]


def _rest(facts: Facts, found: dict[str, Interval], notes: list[str]) -> list[Estimate]:
    base, unit_x, spoken = facts.base, facts.unit_x, facts.base.spoken
    highest, speed = facts.highest, top_speed(facts.tracks, facts.fit)
    said = {
        "compliance": ("compliance", base.compliance, f"{unit_x}/{facts.unit_p}", "not excited by the record"),
        "tau": ("tau", base.tau_s, "s", "not excited by the record"),
        "rate_limit": (
            "rate limit",
            max(base.rate_limit, 1.2 * speed),
            f"{unit_x}/s",
            f"never reached: it is above {spoken.text(speed, f'{unit_x}/s', 3)}",
        ),
        "travel": (
            "travel",
            max(base.travel, highest),
            unit_x,
            f"the closed stop was never touched: it is above {spoken.text(highest, unit_x, 4)}",
        ),
    }
    estimates = []
    for name, (words, default, unit, why) in said.items():
        if name in found:
            estimates.append(Estimate(name, found[name].value, found[name], unit, "fit"))
        else:
            notes.append(f"{words}: {why}; kept at {spoken.text(default, unit, 4)}")
            estimates.append(Estimate(name, default, None, unit, "kept", why))
    ep = found.get("ep.tau", facts.ep_tau)
    kept = Estimate(
        "ep.tau", facts.kept_lag_s, None, "s", "kept", "not to be told from the record; tau carries its error"
    )
    estimates.append(Estimate("ep.tau", ep.value, ep, "s", "fit") if ep is not None else kept)
    return estimates
