"""A diagnosis that is terminated leaves what Ctrl-C leaves, and one that leaves nothing says so."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import run
from app.stoppable import stoppable
from hal.signals import Stopped
from tests.app.test_diagnose import columns_of, write
from tests.control.toy_valve import Toy, random_steps, record

NOTHING = "Interrupted before anything was known; nothing was written."


class Unheard(Exception):
    """The signal came to what was there before; without it the tests themselves would be ended."""


@pytest.fixture(params=["SIGTERM", "SIGHUP"])
def number(request: pytest.FixtureRequest) -> Iterator[int]:
    number = getattr(signal, request.param)

    def unheard(*_: object) -> None:
        raise Unheard

    before = signal.signal(number, unheard)
    yield number
    assert signal.getsignal(number) is unheard  # put back, however the job ended
    signal.signal(number, before)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> str:
    """100 s of the design's own valve at 5 Hz."""
    healthy = record(Toy(), np.arange(0.0, 100.0, 0.2), random_steps(100.0, 0.2), noise_p=0.02, noise_x=8e-4)
    return write(tmp_path_factory.mktemp("record") / "x.csv", columns_of(healthy))


def test_a_terminated_diagnosis_leaves_what_is_known(
    file: str, tmp_path: Path, number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("twin.diagnose.judge", lambda *_, **__: signal.raise_signal(number))
    assert run(["diagnose", file, "--out", str(tmp_path)]) == 130
    found: dict[str, Any] = json.loads((tmp_path / "diagnosis.json").read_text())
    assert found["interrupted"] is True
    assert found["gap"]["before"] > 0.0
    said = capsys.readouterr()
    assert "What is known so far" in said.out
    assert said.err.strip() == "lostmotion: interrupted"


def test_a_diagnosis_that_leaves_nothing_says_so(
    file: str, tmp_path: Path, number: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("app.recordings.load_all", lambda *_: signal.raise_signal(number))
    assert run(["diagnose", file, "--out", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err.split("\n\n") == [NOTHING, "lostmotion: interrupted\n"]
    assert not (tmp_path / "out").exists()


def test_who_has_written_something_does_not_say_that_it_is_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(KeyboardInterrupt), stoppable(tmp_path):
        (tmp_path / "run-1").mkdir()
        raise KeyboardInterrupt
    assert capsys.readouterr().err == ""


def test_a_signal_that_somebody_has_switched_off_stays_off(number: int, tmp_path: Path) -> None:
    unheard = signal.signal(number, signal.SIG_IGN)
    with stoppable(tmp_path):
        signal.raise_signal(number)
    signal.signal(number, unheard)
    with pytest.raises(Stopped), stoppable(tmp_path):
        signal.raise_signal(number)
