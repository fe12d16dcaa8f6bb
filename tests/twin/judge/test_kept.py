"""A cause that has to stay, whatever unseen data say, does not keep another one that they do without."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import twin.judge.hearing
from control.design import DesignModel
from logs.recording import Recording
from tests.twin.test_floor import RULES, findings_of
from twin.choose.decide import Decision, decide
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.fit.case import make_case
from twin.judge.gap import GapParts
from twin.judge.hearing import Hearing
from twin.record.sensing import Sensing

BOTH = ("creep", "lvdt_drift")


@pytest.mark.parametrize(("missed", "left"), [({"creep"}, {"creep"}), (set(BOTH), set(BOTH)), (set(), {"lvdt_drift"})])
def test_of_two_idle_causes_the_one_that_is_not_missed_goes(
    monkeypatch: pytest.MonkeyPatch, missed: set[str], left: set[str]
) -> None:
    record = Recording("r", 0.1 * np.arange(400.0), np.full(400, 9.0), np.full(400, 0.3))
    case = make_case([record], DesignModel())
    findings = findings_of({BOTH: (1.0, 1000.0), BOTH[:1]: (1.0, 990.0), BOTH[1:]: (1.0, 980.0)}, 50.0)
    channel: Any = findings.channel
    channel.name, channel.half, channel.trials = "position", 0.0, ()
    pair = next(f for f in findings.fits if len(f.names) == 2)
    decision = replace(decide(findings, RULES), accepted=pair, explained=True, rest=0.0)

    def gone(less: Decision, more: Decision) -> bool:
        return bool(missed & (set(more.names) - set(less.names)))

    errors = [case.sigma_y * np.full(8, level) for level in (8.0, 6.0, 1.0)]
    without = {"creep": 0.0, "lvdt_drift": 1e-12}  # nothing is lost; creep is asked about first
    monkeypatch.setattr(twin.judge.hearing, "_missed", gone)
    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", lambda *_: GapParts(*errors, without, {}))  # type: ignore[arg-type]
    hearing = Hearing(case, findings.none, Sensing((), {}, 0.0), 0.0, Weights(), False)
    result = StageResult(case, (decision,), case.trials)
    result, judgement, _ = hearing._needed(result, hearing.judgement(result), lambda *_: None, case.sigma_y)
    assert {c.name for c in judgement.causes} == left
    assert set(result.decisions[0].names) == left
