"""Who is in dispute with a cause: its confusion sets, or what comes next where that was weighed and not rejected."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from tests.twin.next.test_propose import PAIR, judged, proposed
from tests.twin.next.two_lags import result
from twin.next.rivals import disputes


def test_a_runner_up_that_was_taken_back_or_was_never_weighed_is_no_rival(monkeypatch: pytest.MonkeyPatch) -> None:
    found = result(*PAIR)
    taken_back = SimpleNamespace(**{**vars(found.decisions[0]), "names": ("sensor_lag",), "explained": False})
    both = SimpleNamespace(case=found.case, decisions=(*found.decisions, taken_back))
    unsure = judged("dead_time", probability=0.8)
    assert disputes(both, unsure) == []  # type: ignore[arg-type]
    proposal = proposed(both, unsure)
    assert proposal.file is None and "sensor lag" not in proposal.next.why
    monkeypatch.setattr("twin.next.rivals.comparable", lambda decision: [decision.accepted])
    assert disputes(found, unsure) == []  # type: ignore[arg-type]


def test_what_several_sets_say_of_a_cause_counts_together() -> None:
    sets = (PAIR, ("dead_time", "additional_lag"))
    (one,) = disputes(result(*PAIR, "additional_lag"), judged("dead_time", confusable=sets))  # type: ignore[arg-type]
    assert [rival.name for rival in one.rivals] == ["sensor_lag", "additional_lag"]
    assert not one.runner_up
