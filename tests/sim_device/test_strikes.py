"""The draw of faults."""

from __future__ import annotations

from sim_device.faults import WireFaults
from sim_device.strikes import Strikes


def test_the_same_seed_meets_the_same_bad_luck() -> None:
    faults = WireFaults(late=0.2, truncate=0.2, drop=0.1, seed=9)
    one, other = Strikes(faults), Strikes(faults)
    assert [(one.delay_s(), one.cut(b"abcdef")) for _ in range(100)] == [
        (other.delay_s(), other.cut(b"abcdef")) for _ in range(100)
    ]
    assert one.counts == other.counts


def test_an_exception_fault_refuses_a_whole_burst() -> None:
    strikes = Strikes(WireFaults(exception=0.02, exception_code=4, exception_burst=5, seed=2))
    said = "".join("x" if strikes.mislabelled(1, b"\x03\x02\x00\x01")[1] == b"\x83\x04" else "." for _ in range(500))
    assert "xxxxx" in said
    assert "." in said
