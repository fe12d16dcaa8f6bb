"""Without a design everything is diagnosed once more where an answer only says that a number was not found well."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from app.commands import diagnose as verb
from control.design import DesignModel
from logs.recording import Recording
from twin.diagnosis import Cause

STOP = {"reduced_travel": {"form": "upper_stop", "missing": 0.1}}


@pytest.mark.parametrize(
    ("origin", "name", "effects", "again"),
    [
        ("identified from the record", "reduced_travel", STOP, True),
        ("identified from the record", "parameter:tau", {}, True),
        ("identified from the record", "creep", {"creep": {"form": "tail"}}, False),
        ("design.toml", "reduced_travel", STOP, False),  # somebody has said what the travel is
    ],
)
def test_a_stop_or_a_number_is_taken_in_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, origin: str, name: str, effects: dict[str, object], again: bool
) -> None:
    held_against, written = list[DesignModel](), list[object]()

    def diagnosed(_recordings: object, model: DesignModel, *_: object) -> SimpleNamespace:
        held_against.append(model)
        found = (Cause(name, "actuator", 0.75),) if len(held_against) == 1 else ()
        return SimpleNamespace(
            diagnosis=SimpleNamespace(causes=found), model=DesignModel(effects=effects if found else {})
        )

    monkeypatch.setattr("twin.diagnose.diagnose", diagnosed)
    monkeypatch.setattr("twin.write.write_outcome", lambda outcome, *_: written.append(outcome))
    monkeypatch.setattr("app.recordings.without_design", lambda *both: (*both, DesignModel(), origin))
    times = np.arange(100.0)
    outcome = verb._diagnosed([Recording("one", times, times, times)], [], None, tmp_path)
    assert len(held_against) == (2 if again else 1)
    assert written == [outcome] and bool(outcome.diagnosis.causes) is not again
    if again:
        assert held_against[1].travel == pytest.approx((0.9 if effects else 1.0) * DesignModel().travel)
