from __future__ import annotations

import pytest

from hal.bus import RtuBus
from hal.clock import SteppedClock
from hal.device import Device, Identity
from hal.errors import BenchFault
from hal.framing import seal
from hal.identity import check_identity, read_objects
from hal.line import RtuLine
from hal.profile import Serial
from hal.transport import SerialTransport

SERIAL = Serial(pacing="none")
FIRST = bytes.fromhex("2B 0E 02 82 FF 01 01 00 04") + b"ACME"
SECOND = bytes.fromhex("2B 0E 02 82 00 00 01 01 03") + b"X-1"


@pytest.fixture
def bus(slave):
    right = slave.reply
    slave.reply = lambda f: seal(1, SECOND if f[4] else FIRST) if f[1] == 43 else right(f)
    bus = RtuBus(RtuLine(SerialTransport(slave.port, SERIAL), SERIAL, SteppedClock()), (), margin_s=1.0)
    bus.open()
    yield bus
    bus.close()


def test_objects_come_in_several_answers(bus) -> None:
    assert read_objects(bus, 1) == {"vendor_name": "ACME", "product_code": "X-1"}


def test_the_right_device_passes_and_another_does_not(bus) -> None:
    right = Device(id=1, identity=Identity(objects={"product_code": "X-1"}))
    assert check_identity(bus, right, "p")["vendor_name"] == "ACME"
    with pytest.raises(BenchFault, match=r"unit 1 on p is not the device .*: product_code is 'X-1', not 'Y'"):
        check_identity(bus, Device(id=1, identity=Identity(objects={"product_code": "Y"})), "p")


def test_constant_registers_identify_too(bus) -> None:
    right = Device(id=1, address_base=1, identity=Identity(address=211, expect=(210, 211)))
    assert check_identity(bus, right, "p") == {"register_211": "0x00d2 0x00d3"}
    with pytest.raises(BenchFault, match=r"register 211 holds \[210, 211\], not \[16407, 0\]"):
        check_identity(bus, Device(id=1, address_base=1, identity=Identity(address=211, expect=(16407, 0))), "p")


def test_a_device_that_does_not_say_who_it_is(slave, bus) -> None:
    slave.reply = lambda f: seal(1, bytes((f[1] | 0x80, 1)))
    with pytest.raises(BenchFault, match="does not tell who it is"):
        check_identity(bus, Device(id=1, identity=Identity(objects={"vendor_name": "ACME"})), "p")


def test_no_identity_is_no_question(slave, bus) -> None:
    assert check_identity(bus, Device(id=1), "p") == {}
    assert slave.requests == []
