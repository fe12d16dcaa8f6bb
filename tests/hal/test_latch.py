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


def test_every_port_has_its_own(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_folder() == tmp_path / "lostmotion"
    one, other = Latch.of_port("/dev/ttyUSB0"), Latch.of_port("tcp://1.2.3.4:502")
    assert one.path.parent == other.path.parent == state_folder()
    assert one != other
