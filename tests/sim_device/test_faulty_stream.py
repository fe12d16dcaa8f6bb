"""A bad Modbus TCP connection, seeded."""

from __future__ import annotations

import pytest

from hal.errors import BadInput
from sim_device.faults import WireFaults
from sim_device.faulty_stream import FaultyStream

PDU = bytes.fromhex("03 04 12 34 56 78")
FRAME = bytes.fromhex("0107 0000 0007 01") + PDU  # Modbus Messaging on TCP/IP V1.0b, section 3.1.3
POSSIBLE = ("late", "drop", "truncate", "wrong_unit", "wrong_function", "wrong_transaction", "exception")


def emitted(times: int = 200, **faults: float) -> list[bytes]:
    stream = FaultyStream(WireFaults(**faults))
    return [stream.emit(0x107, 1, PDU).data for _ in range(times)]


def test_a_good_connection_changes_nothing() -> None:
    assert set(emitted()) == {FRAME}


@pytest.mark.parametrize("name", POSSIBLE)
def test_every_fault_strikes_as_often_as_told(name: str) -> None:
    stream = FaultyStream(WireFaults(**{name: 0.3, "seed": 1}))
    for _ in range(2000):
        stream.emit(1, 1, PDU)
    assert 500 < stream.injected[name] < 700
    assert sum(stream.injected.values()) == stream.injected[name]


def test_what_each_fault_does_to_the_bytes() -> None:
    assert set(emitted(drop=1.0)) == {b""}
    assert all(FRAME.startswith(data) and 0 < len(data) < len(FRAME) for data in emitted(truncate=1.0))
    assert {data.hex(" ") for data in emitted(exception=1.0)} == {"01 07 00 00 00 03 01 83 06"}
    assert {data[6] for data in emitted(wrong_unit=1.0)} == {2}
    assert {data[7] for data in emitted(wrong_function=1.0)} == {4}
    older = emitted(wrong_transaction=1.0)
    assert {int.from_bytes(data[:2]) for data in older} == set(range(0xFF, 0x107))
    assert {data[2:] for data in older} == {FRAME[2:]}


@pytest.mark.parametrize("name", ["noise_before", "noise_after", "bit_flip", "local_echo"])
def test_faults_of_serial_lines_are_refused(name: str) -> None:
    with pytest.raises(BadInput, match=f"'{name}': it is a fault of serial lines"):
        FaultyStream(WireFaults(**{name: True}))
