"""What goes wrong at a port, as the operator meets it: one clear sentence, an exit code, and nothing lost."""

from __future__ import annotations

import errno
import os
import random
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from app.cli import run
from hal.clock import RealClock
from hal.errors import SafetyTrip
from hal.modbus_bench import ModbusBench
from hal.profile import FOLDER, load_profile
from hal.readback import ReadbackCheck
from logs.run import read_run
from sim_device.physics.catalog import make_physics
from sim_device.server import VirtualDevice

PROFILE = (FOLDER / "virtual.toml").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def state_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def device(tmp_path: Path) -> Iterator[VirtualDevice]:
    link = tmp_path / "port"
    with VirtualDevice(load_profile("virtual"), make_physics("thesis", 1), RealClock(), link=link) as device:
        yield device


class AtOnce(RealClock):
    """A clock for whom waiting is the moment in which a device comes back, or in which time flies."""

    def __init__(self, device: VirtualDevice | None) -> None:
        self._device = device
        self._ahead_s = 0.0

    def now_s(self) -> float:
        return super().now_s() + self._ahead_s

    def sleep_until(self, time_s: float) -> None:
        device, self._device = self._device, None
        if device is not None:
            device.__enter__()
        self._ahead_s += max(0.0, time_s - self.now_s())


def unplug_after(monkeypatch: pytest.MonkeyPatch, device: VirtualDevice, method: str, calls: int) -> None:
    """The device's port goes away before the call that follows `calls` calls of `method`."""
    real, left = getattr(ModbusBench, method), [calls]

    def watched(bench: ModbusBench, *words: object) -> object:
        left[0] -= 1
        if left[0] == -1:
            device.close()
        return real(bench, *words)

    monkeypatch.setattr(ModbusBench, method, watched)


def test_a_sweep_whose_port_is_pulled_out_vents_the_valve_when_it_is_back_and_can_be_gone_on_with(
    device: VirtualDevice, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    unplug_after(monkeypatch, device, "exchange", 5)
    monkeypatch.setattr("hal.reopen.RealClock", lambda: AtOnce(device))
    words = ["--set", "at=12", "--set", "hold_s=1", "--set", "conditioning=false", "--period", "0.05"]
    assert run(["sweep", "hold", *words, "--port", device.port, "--out", str(tmp_path / "a")]) == 1
    said = capsys.readouterr().err.splitlines()
    gone = f"lostmotion: port {tmp_path / 'port'} is gone: unplugged, or the other end has closed it"
    assert said[-1] == f"{gone}; the valve is at its safe command"
    assert "the port is open again" in said
    assert f"go on with: lostmotion sweep --resume {tmp_path / 'a'} --port {device.port}" in said
    assert device.rig.command == 0.0
    stopped = read_run(tmp_path / "a")
    assert (stopped.status, stopped.rows) == ("fail", 5)
    assert "the bench confirmed its safe state" in stopped.reason
    assert run(["sweep", "--resume", str(tmp_path / "a"), "--port", device.port, "--out", str(tmp_path / "b")]) == 0
    assert read_run(tmp_path / "b").status == "success"


def test_a_run_whose_port_stays_away_says_so_and_wants_somebody_to_look(
    device: VirtualDevice, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    unplug_after(monkeypatch, device, "exchange", 5)
    monkeypatch.setattr("hal.reopen.RealClock", lambda: AtOnce(None))
    words = ["run", "--controller", "pi", "--targets", "0.3", "--hold", "5", "--port", device.port]
    assert run([*words, "--out", str(tmp_path / "a")]) == 1
    said = capsys.readouterr().err.splitlines()
    assert "the port did not come back" in said
    assert "the valve did NOT confirm its safe command, last sent " in said[-1]
    assert said[-1].count("the valve") == 1
    assert "Shut off its supply" in said[-1]
    assert read_run(tmp_path / "a").status == "fail"
    with device:
        assert run([*words, "--out", str(tmp_path / "b")]) == 1
        assert "emergency stop not acknowledged" in capsys.readouterr().err


def test_a_full_disk_is_said_with_where_the_valve_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("app.readings.line", full)
    assert run(["set", "9", "--hold", "1"]) == 1
    end = "free the disk and run again; the valve is at its safe command"
    assert capsys.readouterr().err == f"lostmotion: nothing more can be written (No space left on device); {end}\n"
    monkeypatch.setattr("logs.sink.RecordSink.write_rows", full)
    assert run(["sweep", "hold", "--set", "hold_s=30", "--out", str(tmp_path / "r")]) == 1
    said = capsys.readouterr().err.splitlines()[-1]
    assert said == f"lostmotion: {tmp_path / 'r'}: the record can no longer be written (No space left on device); {end}"


def test_a_second_master_ends_a_job_that_says_where_the_valve_is(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def theirs(self: ReadbackCheck, commanded: float, held: float | None) -> None:
        raise SafetyTrip("does somebody else command it?")

    monkeypatch.setattr(ReadbackCheck, "judge", theirs)
    assert run(["set", "9", "--hold", "1", "--port", device.port]) == 1
    assert capsys.readouterr().err == "lostmotion: does somebody else command it?; the valve is at its safe command\n"


def test_a_valve_that_is_to_be_held_is_not_said_to_be_safe(
    device: VirtualDevice, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    profile = tmp_path / "hold.toml"
    profile.write_text(PROFILE.replace('safe_direction = "vent"', 'safe_direction = "hold"'), encoding="utf-8")
    assert run(["set", "9", "--hold", "0.2", "--port", device.port, "--profile", str(profile)]) == 0
    assert capsys.readouterr().out.endswith("the valve is left where it is, last sent 9 psi\n")
    assert device.rig.command == 9.0


def test_monitoring_goes_on_behind_a_port_that_came_back(
    device: VirtualDevice, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    unplug_after(monkeypatch, device, "observe", 2)
    monkeypatch.setattr("hal.reopen.RealClock", lambda: AtOnce(device))
    assert run(["monitor", "--port", device.port, "--count", "4", "--period", "0.01"]) == 0
    out = capsys.readouterr()
    assert out.out.count("good") == 4
    assert "is gone" in out.err


def test_a_busy_port(device: VirtualDevice, capsys: pytest.CaptureFixture[str]) -> None:
    with ModbusBench(load_profile("virtual"), device.port, RealClock(), read_only=True):
        assert run(["check", "--port", device.port]) == 1
    said = capsys.readouterr().err
    assert said == f"lostmotion: port {device.port} is busy: another program has it open; close that one first\n"


def test_vent_at_a_busy_port_says_what_reaches_through(
    device: VirtualDevice, capsys: pytest.CaptureFixture[str]
) -> None:
    with ModbusBench(load_profile("virtual"), device.port, RealClock(), read_only=True):
        assert run(["vent", "--port", device.port]) == 1
    said = capsys.readouterr().err
    assert said.startswith(
        f"lostmotion: port {device.port} is busy: another program has it open; close that one first, "
    )
    assert "or add --emergency, which reaches through" in said


def test_the_wrong_unit_id(device: VirtualDevice, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "p.toml").write_text(PROFILE.replace("\nid = 1\n", "\nid = 9\n"), encoding="utf-8")
    assert run(["sweep", "hold", "--port", device.port, "--profile", str(tmp_path / "p.toml")]) == 1
    said = capsys.readouterr().err
    assert said.startswith("lostmotion: unit 9 on ")
    assert "no answer within" in said
    assert "unit id" in said


@contextmanager
def chatterbox(words: bytes) -> Iterator[str]:
    """Something on a pseudo-terminal that answers whatever it is asked, and no Modbus."""
    ours, theirs = os.openpty()
    tty.setraw(theirs)

    def answer() -> None:
        try:
            while os.read(ours, 256) != b"\0":
                os.write(ours, words)
        except OSError:
            return

    thread = threading.Thread(target=answer, daemon=True)
    thread.start()
    try:
        yield os.ttyname(theirs)
    finally:
        os.write(theirs, b"\0")
        thread.join(5.0)
        os.close(theirs)
        os.close(ours)


@pytest.mark.parametrize("words", [b"HELLO, I AM A PRINTER\r\n", random.Random(1).randbytes(7)], ids=["text", "baud"])
def test_garbage_and_the_wrong_baud(words: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with chatterbox(words) as port:
        assert run(["sweep", "hold", "--port", port, "--out", str(tmp_path / "r")]) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"lostmotion: unit 1 on {port} (115200 8N1): {len(words)} bytes of garbage")
    assert "check baud, parity, unit id and the cable" in said
    assert not (tmp_path / "r").exists(), "no record of a run that never began"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("[limits]\n", "[limits]\nspeed = 3\n", "limits.speed: unknown key; remove it or correct its spelling"),
        ("eng = [-10.0, 10.0]", "eng = [1.0, 1.0]", "eng [1.0, 1.0] is an impossible scale: both ends are the same"),
        ("eng = [-10.0, 10.0]", "eng = [1.0, inf]", "must be finite"),
    ],
)
def test_a_profile_that_makes_no_sense(
    old: str, new: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in PROFILE
    (tmp_path / "p.toml").write_text(PROFILE.replace(old, new), encoding="utf-8")
    assert run(["check", "--profile", str(tmp_path / "p.toml")]) == 2
    said = capsys.readouterr().err
    assert said.startswith("lostmotion: profile ")
    assert sentence in said
    assert said.count("\n") == 1
