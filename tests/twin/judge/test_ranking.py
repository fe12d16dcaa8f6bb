"""The ranking after a verdict: nobody is believed whom the verdict does not believe."""

from __future__ import annotations

from types import SimpleNamespace

from twin.diagnosis import Cause, Ranked
from twin.judge.ranking import ranked
from twin.judge.verdict import Judgement

LINES = (Ranked("creep", 0.9, None), Ranked("stiction", 0.9, None), Ranked("dead_time", 0.0, None))


def found(*accepted: str) -> SimpleNamespace:
    """A result whose single hypotheses leave less and less, with some accepted."""
    left = {"creep": 6.0, "stiction": 5.0, "dead_time": 4.0, "ep_tau": 2.0}
    fits = [SimpleNamespace(names=(name,), mse=mse) for name, mse in left.items()]
    decision = SimpleNamespace(findings=SimpleNamespace(fits=fits, none=SimpleNamespace(mse=8.0)))
    return SimpleNamespace(decisions=(decision,), causes=accepted)


def test_a_gap_that_is_unexplained_rejects_everyone_and_ranks_by_what_is_left() -> None:
    judgement = Judgement("unexplained", (), LINES, ())
    lines = ranked(found("creep", "stiction"), judgement, {"stiction": 3.9, "creep": 4.1, "ep_tau": 5.0})  # type: ignore[arg-type]
    assert [line.name for line in lines] == ["stiction", "creep", "ep_tau", "dead_time"]
    assert all(line.rejected and line.probability == 0.0 for line in lines)


def test_what_was_taken_back_loses_its_probability_and_the_others_keep_theirs() -> None:
    causes = (Cause("stiction", "actuator", 0.9),)
    lines = ranked(found("creep", "stiction"), Judgement("effect", causes, LINES, ()), {})  # type: ignore[arg-type]
    assert [(line.name, line.probability, line.rejected) for line in lines] == [
        ("stiction", 0.9, False),
        ("dead_time", 0.0, False),
        ("creep", 0.0, True),
    ]


def test_when_all_that_was_taken_for_a_cause_is_taken_back_nobody_is_left() -> None:
    lines = ranked(found("creep"), Judgement("no_gap", (), LINES, ()), {})  # type: ignore[arg-type]
    assert {line.name for line in lines} == {"creep", "stiction", "dead_time"}
    assert all(line.rejected and line.probability == 0.0 for line in lines)


def test_candidates_of_no_probability_go_by_fit_and_not_by_name() -> None:
    lines = (Ranked("creep", 0.0, None), Ranked("dead_time", 0.0, None), Ranked("ep_tau", 0.0, None))
    order = [line.name for line in ranked(found(), Judgement("no_gap", (), lines, ()), {})]  # type: ignore[arg-type]
    assert order == ["ep_tau", "dead_time", "creep"]


def test_what_the_readings_show_by_themselves_stays_beside_an_unexplained_gap() -> None:
    judgement = Judgement("unexplained", (), (Ranked("sensor_dropouts", 0.97, None), *LINES), ())
    first, *others = ranked(found("stiction"), judgement, {})  # type: ignore[arg-type]
    assert (first.name, first.probability, first.rejected) == ("sensor_dropouts", 0.97, False)
    assert all(line.rejected for line in others)
