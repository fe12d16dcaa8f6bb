"""A bad RTU line, seeded."""

from __future__ import annotations

import pytest

from hal.errors import BadInput
from sim_device.crc import crc16, sealed
from sim_device.faults import FRACTIONS, WireFaults
from sim_device.faulty_line import FaultyLine

REQUEST = sealed(bytes.fromhex("01 03 00 10 00 02"))
REPLY = sealed(bytes.fromhex("01 03 04 12 34 56 78"))


def emitted(faults: WireFaults, times: int = 200) -> list[bytes]:
    line = FaultyLine(faults)
    return [line.emit(REQUEST, REPLY).data for _ in range(times)]


def test_a_good_line_changes_nothing() -> None:
    assert not WireFaults().any
    assert set(emitted(WireFaults())) == {REPLY}


def test_the_same_seed_gives_the_same_faults_and_another_seed_others() -> None:
    mix = {"late": 0.05, "noise_before": 0.05, "bit_flip": 0.03, "drop": 0.02, "truncate": 0.03}
    assert emitted(WireFaults(**mix, seed=4)) == emitted(WireFaults(**mix, seed=4))
    assert emitted(WireFaults(**mix, seed=4)) != emitted(WireFaults(**mix, seed=5))


@pytest.mark.parametrize("name", [name for name in FRACTIONS if name != "wrong_transaction"])
def test_every_fault_strikes_as_often_as_told(name: str) -> None:
    line = FaultyLine(WireFaults(**{name: 0.3, "seed": 1}))
    for _ in range(2000):
        line.emit(REQUEST, REPLY)
    assert 500 < line.injected[name] < 700
    assert sum(line.injected.values()) == line.injected[name]


def test_what_each_fault_does_to_the_bytes() -> None:
    assert set(emitted(WireFaults(drop=1.0))) == {b""}
    assert all(REPLY.startswith(data) and 0 < len(data) < len(REPLY) for data in emitted(WireFaults(truncate=1.0)))
    assert all(
        data.endswith(REPLY) and 1 <= len(data) - len(REPLY) <= 6 for data in emitted(WireFaults(noise_before=1.0))
    )
    assert all(data.startswith(REPLY) and len(data) > len(REPLY) for data in emitted(WireFaults(noise_after=1.0)))
    assert set(emitted(WireFaults(local_echo=True))) == {REQUEST + REPLY}
    for data in emitted(WireFaults(bit_flip=1.0)):
        assert sum((a ^ b).bit_count() for a, b in zip(data, REPLY, strict=True)) == 1


def test_mislabelled_replies_are_intact_frames() -> None:
    (foreign,) = set(emitted(WireFaults(wrong_unit=1.0)))
    (strange,) = set(emitted(WireFaults(wrong_function=1.0)))
    assert (foreign[0], strange[1]) == (2, 4)
    assert crc16(foreign) == crc16(strange) == 0


def test_an_exception_storm_refuses_in_a_row() -> None:
    replies = emitted(WireFaults(exception=0.02, exception_code=6, exception_burst=5, seed=2), 500)
    refused = "".join("x" if data == sealed(b"\x01\x83\x06") else "." for data in replies)
    assert "xxxxx" in refused
    assert "." in refused


def test_late_replies_wait_a_multiple_of_the_timeout() -> None:
    line = FaultyLine(WireFaults(late=1.0, late_from=0.9, late_to=3.5, timeout_s=0.1))
    delays = [line.emit(REQUEST, REPLY).delay_s for _ in range(200)]
    assert 0.09 <= min(delays) < 0.13
    assert 0.30 < max(delays) <= 0.35


def test_frames_without_a_number_cannot_have_a_wrong_one() -> None:
    with pytest.raises(BadInput, match="RTU frames carry no transaction number"):
        FaultyLine(WireFaults(wrong_transaction=0.1))
