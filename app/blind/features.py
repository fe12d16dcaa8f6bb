"""What a diagnosis decided from, channel by channel, as plain numbers: the raw material of calibration."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from twin.choose.decide import Decision
    from twin.diagnose import Outcome
    from twin.fit.fitting import Fit
    from twin.search.findings import Findings

_KEPT = 8


def decision_features(outcome: Outcome) -> dict[str, object]:
    """Per channel: fits in units of the noise variance, what is left, and the scores of the best hypotheses."""
    return {decision.findings.channel.name: _of(decision) for decision in outcome.result.decisions}


def tempered(outcome: Outcome, temperatures: Sequence[float]) -> dict[str, dict[str, float]]:
    """What each accepted cause would have been believed at other temperatures: temperature -> name -> probability."""
    from twin.choose.weigh import Weights, weigh

    said: dict[str, dict[str, float]] = {}
    for temperature in temperatures:
        weighed = [(d, weigh(d, Weights(temperature=temperature))) for d in outcome.result.decisions if d.explained]
        said[f"{temperature:g}"] = {name: w.probability[name] for d, w in weighed for name in d.names}
    return said


def _of(decision: Decision) -> dict[str, object]:
    findings, accepted = decision.findings, decision.accepted
    ranked = findings.scored()
    own = findings.score(accepted)
    size = len(accepted.names)
    rivals = [score for score, fit in ranked if len(fit.names) == size and fit is not accepted]
    return {
        "none_mse": findings.none.mse,
        "retuned_mse": findings.retuned.mse,
        "accepted_mse": accepted.mse,
        "accepted": list(accepted.names),
        "explained": decision.explained,
        "gap": decision.gap,
        "rest": decision.rest,
        "rows": findings.channel.rows,
        "phi": findings.phi,
        "score": own,
        "score_none": findings.score(findings.none),
        "score_gap_to_rival": own - rivals[0] if rivals else None,
        "without": {name: _line(*_without(ranked, name)) for name in accepted.names},
        "best": [_line(fit, score) for score, fit in ranked[:_KEPT]],
        "best_by_size": [_line(fit, findings.score(fit)) for fit in _by_size(findings)],
    }


def _without(ranked: Sequence[tuple[float, Fit]], name: str) -> tuple[Fit, float]:
    """The likeliest hypothesis that does without a cause; `none` always does."""
    return next((fit, score) for score, fit in ranked if name not in fit.names)


def _line(fit: Fit, score: float) -> dict[str, object]:
    return {"names": list(fit.names), "mse": fit.mse, "score": score}


def _by_size(findings: Findings) -> list[Fit]:
    """The best hypothesis of each size."""
    found = [findings.best_of_size(size) for size in (1, 2, 3)]
    return [fit for fit in found if fit is not None]
