"""Where nobody believes what was accepted for being plainer, the likeliest causes are heard in its place."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import twin.judge.hearing
from logs.recording import Recording
from tests.twin.test_floor import DESIGN, RULES, findings_of
from twin.choose.decide import Decision, decide
from twin.choose.likelier import likelier
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.fit.case import make_case
from twin.fit.space import Cause, make_space
from twin.judge.gap import GapParts
from twin.judge.hearing import Hearing
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.record.sensing import Sensing

PLAIN = ("parameter:deadband",)
Hypotheses = dict[tuple[str, ...], tuple[float, float]]


def plain(rivals: Hypotheses) -> Decision:
    """A wrong deadband was accepted, beside likelier rivals with their (mse, score)."""
    findings = findings_of({PLAIN: (1.25, 400.0), **rivals}, 420.0)
    findings.channel.name, findings.channel.half, findings.channel.trials = "chain", 0.0, ()
    return replace(decide(findings, RULES), accepted=findings.fits[0], explained=True, rest=0.0)


@pytest.mark.parametrize(
    ("rivals", "names"),
    [
        ({("distributed_hysteresis",): (0.99, 520.0)}, ("distributed_hysteresis",)),
        ({("distributed_hysteresis",): (1.2, 520.0)}, None),  # leaves more than the noise
        ({("distributed_hysteresis",): (0.99, 390.0)}, None),  # no likelier
        ({("distributed_hysteresis", "creep"): (0.99, 520.0)}, None),  # claims more
        ({("creep",): (0.99, 520.0), ("stiction",): (0.99, 530.0)}, ("stiction",)),
    ],
)
def test_the_likeliest_of_no_more_causes_that_explains_all_takes_the_place(rivals: Hypotheses, names: Any) -> None:
    other = likelier(plain(rivals))
    assert (other.names if other else None) == names


def test_nothing_from_outside_of_the_vocabulary_does_nor_where_there_is_no_gap() -> None:
    decision = plain({("lvdt_drift",): (0.99, 520.0)})
    assert likelier(replace(decision, explained=False)) is None
    drift = effect("lvdt_drift")
    known, jump = (Cause("lvdt_drift", drift, drift.form(name)) for name in ("linear", "jump"))
    for cause, taken in ((known, True), (jump, False)):
        space = make_space(Plant(DESIGN), (cause,), (), Scales())
        size = len(space.unknowns)
        rival = replace(decision.findings.fits[1], space=space, z=np.full(size, 0.5), normal=1e9 * np.eye(size))
        yardstick: Any = SimpleNamespace(phi=1.0, score=lambda f: 400.0 if f is decision.accepted else 520.0)
        findings = replace(decision.findings, fits=(decision.accepted, rival), yardstick=yardstick)
        assert (likelier(replace(decision, findings=findings)) is not None) is taken


@pytest.mark.parametrize(
    ("left", "after", "verdict"),
    [
        (0.99, 1.01, "effect"),
        (1.2, 1.01, "unexplained"),  # nothing explains it to its noise
        (0.99, 19.8, "unexplained"),  # it goes astray on unseen data
    ],
)
def test_a_number_that_nobody_believes_gives_way_before_the_gap_is_called_unexplained(
    monkeypatch: pytest.MonkeyPatch, left: float, after: float, verdict: str
) -> None:
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), None)
    case = make_case([record], DESIGN)
    rivals = {(name,): (left, score) for name, score in (("creep", 500.0), ("stiction", 510.0))}
    decision = plain({**rivals, ("distributed_hysteresis",): (left, 600.0)})

    def heldout_parts(case: Any, result: StageResult, *rest: Any) -> GapParts:
        levels = (20.0, 7.0, 1.13 if result.decisions[0].names == PLAIN else after)
        return GapParts(*(case.sigma_y * np.full(8, level) for level in levels), {}, {})

    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", heldout_parts)
    monkeypatch.setattr(twin.judge.hearing, "within_tolerance", lambda causes, _: [])
    hearing = Hearing(case, decision.findings.none, Sensing((), {}, 0.0), 0.0, Weights(), False)
    result = StageResult(case, (decision,), case.trials)
    first = hearing.judgement(result)
    assert first.causes[0].probability < 0.45
    kept, told, _ = hearing.held_out(result, first, lambda *_: None, case.sigma_y)
    assert told.verdict == verdict
    assert (kept.decisions[0].names == PLAIN) is (verdict == "unexplained")  # what was not upheld leaves no trace
    assert [c.name for c in told.causes] == (["distributed_hysteresis"] if verdict == "effect" else [])
