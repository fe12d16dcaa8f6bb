"""The same invariant holds with pymodbus underneath, which alone does not keep it."""

from __future__ import annotations

import random

import pytest

from hal.clock import RealClock
from hal.connect import make_bus
from hal.errors import BadInput, PortFault, WireFault
from hal.framing import seal
from hal.pdu import read_registers, write_and_read, write_register, write_registers
from hal.profile import load_profile


@pytest.fixture
def bus(slave):
    bus = make_bus(load_profile("virtual"), slave.port, RealClock(), backend="pymodbus", margin_s=0.03)
    bus.open()
    yield bus
    bus.close()


def test_reads_and_writes(bus) -> None:
    assert bus.transact(read_registers(1, 3, 100, 3), retries=3).words == (100, 101, 102)
    assert bus.transact(read_registers(1, 4, 5, 1)).words == (5,)
    assert bus.transact(write_and_read(1, 0, (1, 2), 40, 2)).words == (40, 41)
    assert bus.transact(write_registers(1, 9, (4, 5))).pdu == bytes.fromhex("10 0009 0002")
    assert bus.transact(write_register(1, 9, 4)).pdu == bytes.fromhex("06 0009 0004")


def test_a_late_answer_is_never_the_next_one(slave, bus) -> None:
    bus.transact(read_registers(1, 3, 7, 1), retries=3)
    first = len(slave.requests)
    slave.script = lambda i, f: ("late", 1) if i == first else ("ok",)
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 1000, 2))
    assert bus.transact(read_registers(1, 3, 2000, 2), retries=5).words == (2000, 2001)


@pytest.mark.parametrize("wrong", ["04 04 0037 0038", "03 02 0037", "10 0000 0001"])
def test_answers_that_pymodbus_would_take_are_refused(slave, bus, wrong) -> None:
    bus.transact(read_registers(1, 3, 7, 1), retries=3)
    slave.script = lambda i, f: ("raw", seal(1, bytes.fromhex(wrong)))
    with pytest.raises(WireFault):
        bus.transact(read_registers(1, 3, 0x37, 2))


def test_faults_in_a_row_give_nothing_wrong(slave, bus) -> None:
    rng = random.Random(5)
    faults = [("late", 1), ("drop",), ("truncate", 2), ("flip", 11), ("noise", b"\x01\x03")]
    slave.script = lambda i, f: rng.choice(faults) if rng.random() < 0.3 else ("ok",)
    right = 0
    for address in range(60):
        try:
            words = bus.transact(read_registers(1, 3, 1000 * (address % 50), 2)).words
        except WireFault:
            continue
        assert words == (1000 * (address % 50), 1000 * (address % 50) + 1)
        right += 1
    assert right > 15


def test_a_port_that_is_not_there_and_a_backend_that_is_not_there() -> None:
    profile = load_profile("virtual")
    with pytest.raises(PortFault, match="there is no port"):
        make_bus(profile, "/dev/ttyNOPE", RealClock(), backend="pymodbus").open()
    with pytest.raises(BadInput, match="unknown backend 'other'; there are native, pymodbus"):
        make_bus(profile, "/dev/ttyNOPE", RealClock(), backend="other")
