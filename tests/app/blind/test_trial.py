from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.blind import trial
from app.blind.trial import Order, run_trial
from control.plan import Plan
from control.step import Step
from logs.recording import Recording
from sim_device.sealed import reveal


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A test sequence of a minute: enough for the order of events."""
    plan = Plan(0.1, tuple(Step(0.0, level, 0.0, 15.0) for level in (12.0, 6.0, 11.0, 7.0)))
    monkeypatch.setattr(Order, "plan", property(lambda _: plan))


def test_the_seal_is_broken_only_after_the_diagnosis_is_on_disk(
    short: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    order = Order(9, "frozen-9", "thesis", tmp_path / "trial", keep=True)
    seen: list[Recording] = []
    real = trial._diagnosed

    def watched(order_: Order, record: Recording) -> object:
        seen.append(record)
        assert not (order_.folder / "diagnosis.json").exists()
        sealed = json.loads((order_.folder / "sealed.json").read_text())
        assert set(sealed) == {"format", "commitment", "families"}
        return real(order_, record)

    monkeypatch.setattr(trial, "_diagnosed", watched)
    line = run_trial(order)
    assert line["label"]["kind"] == reveal("frozen-9", ("thesis",)).kind
    (record,) = seen
    # what the diagnosis is given holds no word about what is wrong
    assert record.n == line["rows"] and np.ptp(record.position) > 0.1
    start = json.loads((order.folder / "record" / "run.json").read_text())
    assert start["virtual"]["physics"] == "thesis, sealed" and "frozen" not in json.dumps(start["virtual"])
    assert (order.folder / "diagnosis.json").exists() and (order.folder / "model.toml").exists()
