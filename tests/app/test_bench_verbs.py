"""The verbs of an operator's day, on the virtual valve and on a virtual device at a port."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator

import pytest
from click.testing import CliRunner, Result

from app.cli import cli
from app.cli import run as run_roof
from hal.clock import RealClock
from hal.latch import Latch
from hal.profile import FOLDER, load_profile
from sim_device.physics.catalog import make_physics
from sim_device.server import VirtualDevice


@pytest.fixture(autouse=True)
def state_of_its_own(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def device() -> Iterator[VirtualDevice]:
    with VirtualDevice(load_profile("virtual"), make_physics("thesis", 1), RealClock()) as device:
        yield device


def lost(*words: str, stdin: str | None = None) -> Result:
    return CliRunner().invoke(cli, list(words), input=stdin, catch_exceptions=False)


def fails(capsys, *words: str) -> tuple[int, str]:
    """Exit code and the one sentence on stderr, through the roof."""
    code = run_roof(list(words))
    sentence = capsys.readouterr().err.strip()
    # What a verb tells of its progress may stand above; the failure is the last line, and the only one of its kind.
    assert sentence.count("lostmotion: ") == 1
    return code, sentence.splitlines()[-1]


def test_ports_lists_plain_values() -> None:
    assert isinstance(json.loads(lost("ports", "--json").output), list)
    assert lost("ports").exit_code == 0


def test_check_looks_and_writes_nothing(device) -> None:
    device.rig.request_command(6.0)
    result = lost("check", "--port", device.port, "--json")
    found = json.loads(result.output)
    assert result.exit_code == 0
    assert all(finding["ok"] for finding in found.values())
    assert found["identity"]["identity"]["product_code"] == "LM-VALVE"
    assert found["calibration"]["id"] == "virtual-two-point"
    assert device.rig.command == 6.0
    assert device.rig.watchdog.timeout_s == 0.0


def test_check_refuses_a_tick_that_the_line_cannot_carry(device, capsys) -> None:
    assert lost("check", "--port", device.port, "--period", "0.009").exit_code == 0
    code, sentence = fails(capsys, "check", "--port", device.port, "--period", "0.008")
    assert (code, sentence) == (1, "lostmotion: the bench is not ready: line")


def test_check_presses_air_on_request() -> None:
    found = json.loads(lost("check", "--leak", "--json").stdout)
    assert found["leak"]["ok"]
    assert abs(found["converter"]["error_psi"]) < 0.1
    assert found["supply"]["lowest_psi"] == pytest.approx(found["supply"]["before_psi"], rel=0.01)


def test_check_tells_a_wrong_converter_from_a_leak_and_a_weak_supply(capsys) -> None:
    code, sentence = fails(capsys, "check", "--leak", "--effect", "ep_calibration=1", "--json")
    assert (code, sentence) == (1, "lostmotion: the bench is not ready: converter")
    code, sentence = fails(capsys, "check", "--leak", "--effect", "supply_cycling=1", "--json")
    assert code == 1
    assert "supply" in sentence


def test_an_expired_calibration_is_no_ready_bench(tmp_path, capsys) -> None:
    gauge = tmp_path / "gauge.csv"
    gauge.write_text("signal,position_in\n-8,0\n8,0.5625\n", encoding="utf-8")
    profile = tmp_path / "mine.toml"
    made = lost("calibrate", str(gauge), "--out", str(profile), "--id", "today", "--json")
    assert json.loads(made.output)["worst_in"] == pytest.approx(0.0, abs=1e-12)
    assert lost("check", "--profile", str(profile)).exit_code == 0
    text = profile.read_text(encoding="utf-8").replace("made = 2", "expires = 2020-02-01\nmade = 2020-01-01 #")
    profile.write_text(text, encoding="utf-8")
    assert fails(capsys, "check", "--profile", str(profile)) == (
        1,
        "lostmotion: the bench is not ready: calibration",
    )


def test_monitor_shows_so_many_readings() -> None:
    rows = [json.loads(line) for line in lost("monitor", "--count", "3", "--json").output.splitlines()]
    assert [row["time_s"] for row in rows] == [0.0, 0.5, 1.0]
    assert {"command_psi", "pressure_psi", "position_in", "supply_psi", "quality"} <= set(rows[0])
    assert len(lost("monitor", "--count", "3").output.splitlines()) == 4


def test_set_says_what_it_will_do_holds_and_goes_safe(device) -> None:
    result = lost("set", "9", "--hold", "0.3", "--period", "0.1", "--port", device.port)
    assert result.output.startswith(
        "the valve will go to 9 psi and be held there for 0.3 s, then go to its safe command"
    )
    assert result.output.rstrip().endswith("the valve is at its safe command")
    assert device.rig.command == 0.0


def test_a_bench_that_holds_says_that_the_valve_is_left(tmp_path) -> None:
    """Nowhere is it promised to go to its safe command, where it does not."""
    profile = tmp_path / "holds.toml"
    text = (FOLDER / "virtual.toml").read_text(encoding="utf-8")
    profile.write_text('safe_direction = "hold"\n' + re.sub(r"(?m)^safe_direction.*$", "", text), encoding="utf-8")
    for words in (["set", "9", "--hold", "1"], ["jog", "+2", "--dwell", "0.5"]):
        said = lost(*words, "--profile", str(profile)).output
        assert "then be left at its last command" in said and "safe command" not in said
        assert said.rstrip().splitlines()[-1].startswith("the valve is left where it is")


def test_set_on_the_virtual_valve_moves_it() -> None:
    lines = lost("set", "12", "--hold", "20", "--period", "10").output.splitlines()
    position = [float(line.split()[3]) for line in lines if line.lstrip()[:1].isdigit()]
    assert position[0] < 0.01
    assert position[-1] == pytest.approx(0.5625, abs=0.05)


def test_jog_walks_in_steps_and_stops_at_the_limits() -> None:
    output = lost("jog", "+2", "=19", "+5", "-1", "--dwell", "0.5").output
    assert [line for line in output.splitlines() if line.startswith("->")] == [
        "-> 2 psi",
        "-> 19 psi",
        "-> 20 psi (the limit; 24 psi is beyond)",
        "-> 19 psi",
    ]


def test_an_emergency_stop_needs_an_acknowledgement(device, capsys) -> None:
    device.rig.request_command(9.0)
    assert "confirmed 0 psi" in lost("vent", "--emergency", "--port", device.port).output
    assert device.rig.command == 0.0
    code, sentence = fails(capsys, "set", "5", "--port", device.port)
    assert code == 1
    assert "emergency stop not acknowledged (operator: lostmotion vent --emergency" in sentence
    assert fails(capsys, "sweep", "hold", "--port", device.port)[0] == 1
    Latch.of_port(device.port).acknowledge()  # the file alone is not enough: the device has latched too
    assert "lostmotion set --acknowledge" in fails(capsys, "set", "5", "--hold", "0.1", "--port", device.port)[1]
    assert lost("set", "--acknowledge", "--port", device.port).exit_code == 0
    assert lost("set", "5", "--hold", "0.1", "--port", device.port).exit_code == 0


def test_an_emergency_stop_reaches_a_run_that_has_the_port_open(device) -> None:
    words = [sys.executable, "-m", "app", "set", "9", "--port", device.port, "--period", "0.1"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        while "good" not in process.stdout.readline():
            assert process.poll() is None
        assert "confirmed 0 psi" in lost("vent", "--emergency", "--port", device.port).output
        assert process.stderr is not None
        assert "emergency stop (operator: lostmotion vent --emergency" in process.stderr.read()
        assert process.wait(20) == 1
    assert device.rig.command == 0.0
    assert device.rig.watchdog.trips == 1, "the device itself has been stopped too"


def test_vent_without_emergency_just_vents(device) -> None:
    device.rig.request_command(9.0)
    assert lost("vent", "--port", device.port).exit_code == 0
    assert device.rig.command == 0.0
    assert lost("set", "5", "--hold", "0.1", "--port", device.port).exit_code == 0


def test_probe_finds_the_device(device, capsys) -> None:
    words = ("probe", "--port", device.port, "--bauds", "115200", "--parities", "N", "--timeout", "0.05", "--json")
    found = json.loads(lost(*words, "--units", "1-2").stdout)
    assert [(unit["unit"], unit["baud"]) for unit in found] == [(1, 115200)]
    assert found[0]["turnaround_ms"] is None, "a pseudo-terminal has no bits"
    slow = lost("probe", "--port", device.port, "--bauds", "300", "--parities", "N", "--units", "1").stdout
    assert "turnaround not measurable: it answers faster than 300 baud" in slow
    assert run_roof([*words, "--units", "9"]) == 1
    assert "nobody answered" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "code", "sentence"),
    [
        (("set",), 2, "give the command to hold"),
        (("set", "21"), 2, "21 psi is outside the limits of profile 'virtual', 0 to 20 psi"),
        (("set", "nan"), 2, "outside the limits"),
        (("jog", "up"), 2, "step 'up' must look like +0.5, -1 or =8"),
        (("check", "--port", "/dev/ttyNOPE"), 1, "there is no port /dev/ttyNOPE"),
        (("check", "--port", "ftp://x"), 2, "unknown kind 'ftp'"),
        (("check", "--profile", "virtul"), 2, "there is no profile 'virtul'"),
        (("monitor", "--port", "/dev/ttyNOPE"), 1, "there is no port"),
        (("vent", "--port", "/dev/ttyNOPE"), 1, "there is no port"),
        (("probe", "--port", "/dev/ttyNOPE"), 1, "there is no port"),
        (("check", "--port", "tcp://127.0.0.1"), 1, "refused, TCP port 502 tried); is the gateway on"),
        (("runs", "/nonexist"), 2, "/nonexist does not exist; name a folder with recorded runs"),
        (("runs", "README.md"), 2, "README.md is a file; name a folder"),
        (("probe", "--port", "x", "--units", "0"), 2, "unit ids go from 1 to 247"),
        (("probe", "--port", "x", "--bauds", "fast"), 2, "--bauds fast"),
        (("probe", "--port", "tcp://h"), 2, "has no speed to look for"),
        (("calibrate",), 2, "give either READINGS.csv, or --port"),
        (("calibrate", "none.csv"), 2, "none.csv cannot be read"),
    ],
)
def test_bad_input_gets_one_sentence_and_its_exit_code(capsys, words, code, sentence) -> None:
    got, said = fails(capsys, *words)
    assert got == code
    assert sentence in said


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_every_signal_leaves_the_valve_at_its_safe_command(device, name) -> None:
    words = [sys.executable, "-m", "app", "set", "9", "--port", device.port, "--period", "0.1"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        while "good" not in process.stdout.readline():  # the first reading: the command has been sent
            assert process.poll() is None
        assert device.rig.command == 9.0
        process.send_signal(getattr(signal, name))
        assert process.wait(20) == 130
    assert device.rig.command == 0.0


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_every_signal_ends_monitoring_and_leaves_the_valve_as_it_is(device, name) -> None:
    device.rig.request_command(7.0)  # somebody else's command
    words = [sys.executable, "-m", "app", "monitor", "--port", device.port, "--period", "0.1", "--json"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert json.loads(process.stdout.readline())["command_psi"] == 7.0
        process.send_signal(getattr(signal, name))
        said = process.communicate(timeout=20)[1]
    assert process.returncode == 130
    assert said.strip() == "lostmotion: interrupted"
    assert device.rig.command == 7.0
