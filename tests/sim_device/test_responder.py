"""The slave's end of a line: in order, one at a time, and stopped at once."""

from __future__ import annotations

import threading

from sim_device.crc import sealed
from sim_device.faults import WireFaults
from tests.sim_device.wire import Wire

READ = sealed(bytes.fromhex("01 03 00 10 00 02"))
IDENTIFY = bytes.fromhex("01 08 00 00 12 34")


def test_a_late_reply_holds_up_what_was_asked_behind_it(start) -> None:  # type: ignore[no-untyped-def]
    device = start(faults=WireFaults(late=1.0, late_from=1.0, late_to=1.0, timeout_s=0.02))
    with Wire(device.port) as wire:
        wire.send(READ)
        wire.send(sealed(IDENTIFY))
        assert wire.receive(9) == sealed(bytes.fromhex("01 03 04 00 00 00 00"))
        assert wire.receive(8) == sealed(IDENTIFY)
    assert device.line_faults.injected["late"] == 2


def test_a_device_in_the_middle_of_a_late_reply_can_be_stopped(start) -> None:  # type: ignore[no-untyped-def]
    device = start(faults=WireFaults(late=1.0, late_from=600.0, late_to=600.0, timeout_s=1.0))
    with Wire(device.port) as wire:
        wire.send(READ)
        threads = threading.active_count()
        device.close()
        assert threading.active_count() == threads - 1


def test_several_requests_in_one_write_are_all_answered(start) -> None:  # type: ignore[no-untyped-def]
    with Wire(start().port) as wire:
        wire.send(3 * READ)
        assert wire.receive(27) == 3 * sealed(bytes.fromhex("01 03 04 00 00 00 00"))
