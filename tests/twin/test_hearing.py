"""What the pressure shows by itself does not go down with a guess about the stem."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import twin.hearing
from control.design import DesignModel
from logs.recording import Recording
from tests.twin.test_floor import RULES, findings_of
from twin.case import make_case
from twin.choose.decide import Decision, decide
from twin.choose.weigh import Weights
from twin.gap import GapParts
from twin.hearing import Hearing
from twin.sensing import Sensing
from twin.stages import StageResult


def accepted(channel: str, name: str, before: float) -> Decision:
    findings = findings_of({(name,): (1.0, 1000.0)}, before)
    findings.channel.name, findings.channel.half, findings.channel.trials = channel, 0.0, ()
    return replace(decide(findings, RULES), accepted=findings.fits[0], explained=True, rest=0.0)


@pytest.mark.parametrize(
    ("shown", "before", "verdict", "names"),
    [
        (3000.0, 1.8, "effect", ["supply_saturation"]),
        (3000.0, 2.6, "unexplained", []),  # the stem is clearly off, and nothing is known of that
        (3.5, 1.8, "unexplained", []),
    ],
)
def test_a_guess_about_the_stem_is_left_out_alone(
    monkeypatch: pytest.MonkeyPatch, shown: float, before: float, verdict: str, names: list[str]
) -> None:
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), np.full(400, 9.0))
    case = make_case([record], DesignModel())
    decisions = (accepted("pressure", "supply_saturation", shown), accepted("position", "creep", 3.0))

    def heldout_parts(case: Any, result: StageResult, *rest: Any) -> GapParts:
        """With the guess it is predicted worse than with what the pressure shows alone."""
        after = 0.95 * before if result.decisions[1].names else 0.9 * before
        return GapParts(*(case.sigma_y * np.full(8, level) for level in (before, before, after)), {}, {})

    monkeypatch.setattr(twin.hearing, "heldout_parts", heldout_parts)
    hearing = Hearing(case, decisions[1].findings.none, Sensing((), {}, 0.0), 1.0, Weights(), False)
    result = StageResult(case, decisions, case.trials)
    result, judgement, parts = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)
    assert judgement.verdict == verdict
    assert [c.name for c in judgement.causes] == names
    assert bool(result.decisions[1].names) == (not names)
    assert parts.before[0] == before * case.sigma_y
