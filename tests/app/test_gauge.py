"""Calibrating beside the bench: the valve waits where it is told to, until somebody has typed what the gauge shows."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from app import gauge
from app.cli import run
from hal.clock import RealClock
from hal.profile import load_profile
from sim_device.server import VirtualDevice
from sim_device.valve import Outputs


class Prompt:
    """A valve without any lag: 0.05 in for every psi."""

    def advance(self, to_time_s: float, command: float) -> Outputs:
        return Outputs(command, 0.05 * command, 20.0, 22.0)


@pytest.fixture
def device(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[VirtualDevice]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setattr(gauge, "_TICK_S", 0.001)
    with VirtualDevice(load_profile("virtual"), Prompt(), RealClock()) as device:
        yield device


def typed(monkeypatch: pytest.MonkeyPatch, text: str, at_terminal: bool = False) -> None:
    ours, theirs = os.pipe()
    os.write(theirs, text.encode())
    os.close(theirs)
    lines = os.fdopen(ours)
    monkeypatch.setattr(lines, "isatty", lambda: at_terminal)
    monkeypatch.setattr(sys, "stdin", lines)


def test_the_valve_is_moved_from_reading_to_reading_and_vented_at_the_end(
    device: VirtualDevice, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    typed(monkeypatch, "0.11\nhalf\n0.21\n0.41\n", at_terminal=True)
    words = ["calibrate", "--port", device.port, "--at", "2,4,8", "--out", str(tmp_path / "new.toml")]
    assert run(words) == 0
    said = capsys.readouterr()
    assert "the valve will go to 2,4,8 psi, wait at each, then go to its safe command" in said.out
    assert "'half' is not a number" in said.err
    assert device.rig.command == 0.0
    calibration = load_profile(tmp_path / "new.toml").calibration
    assert calibration is not None
    # The old calibration took -8 V for 0 in and 8 V for 0.5625 in.
    assert [p[0] for p in calibration.points] == pytest.approx(
        [-8 + 16 * x / 0.5625 for x in (0.1, 0.2, 0.4)], abs=1e-3
    )
    assert [p[1] for p in calibration.points] == [0.11, 0.21, 0.41]


@pytest.mark.parametrize("moved", [["--at", "2,4,8"], []])
def test_a_line_of_a_pipe_that_is_no_position_ends_it_without_a_calibration(
    device: VirtualDevice,
    moved: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The next line may have been meant for the next place of the valve."""
    typed(monkeypatch, "0.11\nhalf\n0.21\n0.41\n")
    out = tmp_path / "new.toml"
    assert run(["calibrate", "--port", device.port, *moved, "--out", str(out)]) == 2
    assert "'half' is not a number, and what follows may belong to another reading" in capsys.readouterr().err
    assert device.rig.command == 0.0 and not out.exists()


def test_the_operator_may_end_early(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    typed(monkeypatch, "0.1\n0.2\n\n")
    assert run(["calibrate", "--port", device.port, "--at", "2,4,8,12"]) == 0
    assert "2 points from 2 readings" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--port", "x", "--at", "4,up"], "--at '4,up' must look like"),
        (["--port", "x", "--at", "4,99"], "99 psi is outside the limits, 0 to 20 psi"),
        (["--at", "4,8"], "give either READINGS.csv, or --port"),
        (["readings.csv", "--at", "4,8"], "give either READINGS.csv, or --port"),
    ],
)
def test_what_cannot_be_is_one_sentence(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calibrate", *words]) == 2
    assert sentence in capsys.readouterr().err
