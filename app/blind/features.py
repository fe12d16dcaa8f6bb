"""What a diagnosis decided from, channel by channel, as plain numbers: the raw material of calibration."""

from __future__ import annotations

from typing import TYPE_CHECKING

from twin.choose.score import score

if TYPE_CHECKING:
    from twin.choose.decide import Decision
    from twin.diagnose import Outcome
    from twin.fit.fitting import Fit

_KEPT = 8


def decision_features(outcome: Outcome) -> dict[str, object]:
    """Per channel: fits in units of the noise variance, what is left, and the scores of the best hypotheses."""
    return {decision.findings.channel.name: _of(decision) for decision in outcome.result.decisions}


def _of(decision: Decision) -> dict[str, object]:
    findings = decision.findings
    rows, phi = findings.channel.rows, findings.phi
    own = score(decision.accepted, rows, phi)
    ranked = findings.scored()
    size = len(decision.accepted.space.causes)
    rivals = [s for s, f in ranked if len(f.space.causes) == size and f is not decision.accepted]
    return {
        "none_mse": findings.none.mse,
        "retuned_mse": findings.retuned.mse,
        "accepted_mse": decision.accepted.mse,
        "accepted": list(decision.accepted.names),
        "explained": decision.explained,
        "gap": decision.gap,
        "rest": decision.rest,
        "rows": rows,
        "phi": phi,
        "score": own,
        "score_none": score(findings.none, rows, phi),
        "score_gap_to_rival": own - rivals[0] if rivals else None,
        "best": [[list(f.names), f.mse, s] for s, f in ranked[:_KEPT]],
        "best_by_size": [[list(f.names), f.mse, score(f, rows, phi)] for f in _by_size(decision)],
    }


def _by_size(decision: Decision) -> list[Fit]:
    found = [decision.findings.best_of_size(size) for size in (1, 2, 3)]
    return [f for f in found if f is not None]
