"""The ranking of the candidates after a verdict: what the verdict does not believe has no probability."""

from __future__ import annotations

from collections.abc import Mapping

from twin.choose.stages import StageResult
from twin.diagnosis import Ranked
from twin.judge.verdict import Judgement


def ranked(result: StageResult, judgement: Judgement, alone: Mapping[str, float]) -> tuple[Ranked, ...]:
    """The candidates by probability, those of one probability by the error that they leave on their own.

    `alone`: held-out RMS [% of travel] per candidate. A candidate that was accepted on the rows that it was fitted to,
    and then taken back, is rejected; where a gap is unexplained all are that were tried, since none accounts for it.
    What the readings themselves show (false ones, coarse ones) was not tried, and stays.
    """
    probability = {line.name: line.probability for line in judgement.ranking}
    named = {cause.name for cause in judgement.causes}
    taken_back = set(result.causes) - named
    if judgement.verdict == "unexplained" or (taken_back and not named):
        tried = {name for d in result.decisions for one in d.findings.fits for name in one.names}
        taken_back |= tried & {*probability, *alone}
    left = _left(result)
    believed = {**dict.fromkeys(taken_back, 0.0), **{n: p for n, p in probability.items() if n not in taken_back}}

    def place(name: str) -> tuple[float, float, float, str]:
        return -believed[name], alone.get(name, float("inf")), left.get(name, float("inf")), name

    return tuple(Ranked(n, believed[n], alone.get(n), n in taken_back) for n in sorted(believed, key=place))


def _left(result: StageResult) -> dict[str, float]:
    """What the best hypothesis of one cause leaves of the squares of its channel, per name."""
    left: dict[str, float] = {}
    for decision in result.decisions:
        for one in decision.findings.fits:
            if len(one.names) == 1:
                share = one.mse / max(decision.findings.none.mse, 1e-12)
                left[one.names[0]] = min(share, left.get(one.names[0], float("inf")))
    return left
