"""What lies beyond the steps of a reading is named, though errors of the reading hide it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import twin.judge.hearing
from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judge.test_hearing import accepted
from twin.choose.decide import Decision
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.fit.case import make_case
from twin.judge.gap import GapParts
from twin.judge.hearing import Hearing
from twin.judge.upheld import shows_beyond_steps
from twin.record.sensing import Sensing


def in_steps(before: float, left: float, half: float = 0.02) -> Decision:
    decision = accepted("position", "nonlinear_spring", before, left)
    channel: Any = decision.findings.channel
    channel.half, channel.sigma = half, 0.0002
    return decision


@pytest.mark.parametrize(
    ("before", "left", "half", "shows"),
    [
        (170.0, 0.05, 0.02, True),
        (170.0, 0.05, 0.0, False),  # a reading without steps has unseen rows to speak for it
        (170.0, 3.0, 0.02, False),  # something else is in the gap as well
        (5.0, 0.05, 0.02, False),  # noise takes a reading over an edge now and then
    ],
)
def test_what_no_rounding_explains_speaks_for_a_cause(before: float, left: float, half: float, shows: bool) -> None:
    decision = in_steps(before, left, half)
    assert shows_beyond_steps(decision, decision.findings.none) is shows
    slipped: Any = object()
    assert not shows_beyond_steps(replace(decision, slips=slipped), decision.findings.none)


@pytest.mark.parametrize(("half", "names"), [(0.02, {"sensor_quantization", "nonlinear_spring"}), (0.0, set())])
def test_a_cause_smaller_than_a_step_is_named_beside_the_steps(
    monkeypatch: pytest.MonkeyPatch, half: float, names: set[str]
) -> None:
    """The reading errs by less than rounding does, with the cause and without it."""
    monkeypatch.setattr(twin.judge.hearing, "by_slips", lambda *_: None)
    record = Recording("r", 0.1 * np.arange(400.0), np.full(400, 9.0), np.full(400, 0.3))
    case = make_case([record], DesignModel())
    before, again, after = (case.sigma_y * np.full(8, level) for level in (0.99, 0.9, 0.8))
    without = {"nonlinear_spring": 99.0 * case.sigma_y / case.travel, "sensor_quantization": 99.0}
    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", lambda *_: GapParts(before, again, after, without, {}))
    sensing = Sensing((), {"sensor_quantization": {}}, 0.04)
    decision = in_steps(170.0, 0.05, half)
    hearing = Hearing(case, decision.findings.none, sensing, 0.0, Weights(), False)
    result = StageResult(case, (decision,), case.trials)
    _, judgement, _ = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)
    assert {c.name for c in judgement.causes} == (names or {"sensor_quantization"})
