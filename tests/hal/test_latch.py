from __future__ import annotations

import pytest

from hal.errors import SafetyTrip
from hal.latch import Latch, state_folder


def test_engaged_until_acknowledged(tmp_path) -> None:
    latch = Latch(tmp_path / "deep" / "stop.json")
    assert latch.engaged() is None
    latch.check()
    latch.engage("smoke")
    assert "smoke" in str(latch.engaged())
    with pytest.raises(SafetyTrip, match=r"smoke.*lostmotion set --acknowledge"):
        latch.check()
    latch.acknowledge()
    latch.acknowledge()
    latch.check()


@pytest.mark.parametrize("content", [b"", b"{}", b"[1]", b"null", b"\xff\xfe"])
def test_a_damaged_file_counts_as_engaged(tmp_path, content) -> None:
    path = tmp_path / "stop.json"
    path.write_bytes(content)
    with pytest.raises(SafetyTrip):
        Latch(path).check()


def test_one_bench_with_two_names_is_stopped_by_either(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    device, link = tmp_path / "ttyS7", tmp_path / "by-id"
    device.touch()
    link.symlink_to(device)
    running, stopped = Latch.of_port(str(link)), Latch.of_port(str(device))
    assert not running.is_set()
    stopped.engage("smoke")
    assert running.is_set()
    assert "smoke" in str(running.engaged())
    link.unlink()
    link.symlink_to(tmp_path / "ttyS8")  # plugged in anew: the bench behind this name has another device now
    stopped.acknowledge()
    running.engage("fire")
    assert "fire" in str(Latch.of_port(str(link)).engaged())


def test_a_host_by_name_and_by_number_is_one_bench(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    Latch.of_port("tcp://127.0.0.1:5533").engage("smoke")
    assert Latch.of_port("tcp://localhost:5533").is_set()
    assert not Latch.of_port("tcp://localhost:5534").is_set()
    assert not Latch.of_port("tcp://no.such.host.invalid:5533").is_set()


def test_every_port_has_its_own(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_folder() == tmp_path / "lostmotion"
    one, other = Latch.of_port("/dev/ttyUSB0"), Latch.of_port("tcp://1.2.3.4:502")
    assert one.path.parent == other.path.parent == state_folder()
    assert one != other
