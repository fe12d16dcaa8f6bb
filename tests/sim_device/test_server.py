"""The virtual device on a real pseudo-terminal, byte by byte."""

from __future__ import annotations

import os
import threading

import pytest

from hal.errors import BadInput
from sim_device.crc import sealed
from sim_device.faults import WireFaults
from tests.sim_device.wire import Wire


@pytest.fixture
def wire(start):  # type: ignore[no-untyped-def]
    with Wire(start().port) as wire:
        yield wire


# Register 0: command (float). 16: read-back, 18: sequence, 19: watchdog status, 20: pressure, 22: position (counts).
COMMAND_7_25 = "01 10 00 00 00 02 04 40 e8 00 00"


def test_write_the_command_and_read_the_tick_in_one_transaction(wire) -> None:  # type: ignore[no-untyped-def]
    reply = wire.ask("01 17 00 10 00 09 00 00 00 02 04 40 e8 00 00", 21)
    # position 0.0725 in of 0.5625: -8 + 16 * 0.0725 / 0.5625 = -5.93778 V = -19457 counts of +-10 V
    position = "b3 ff"
    supply, temperature = "9c 40", "08 66"
    assert reply == f"01 17 12 40 e8 00 00 00 01 00 00 40 e8 00 00 {position} {supply} {temperature}"


def test_write_and_read_on_their_own(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask(COMMAND_7_25, 6) == "01 10 00 00 00 02"
    assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 40 e8 00 00"
    assert wire.ask("01 04 00 14 00 02", 7) == "01 04 04 40 e8 00 00"


@pytest.mark.parametrize(
    ("request_hex", "reply"),
    [
        ("01 07", "01 87 01"),
        ("01 03 00 40 00 01", "01 83 02"),
        ("01 06 00 10 00 00", "01 86 02"),
        ("01 03 00 10 00 00", "01 83 03"),
        ("01 10 00 00 00 02 04 42 c8 00 00", "01 90 03"),  # 100 psi
        ("01 10 00 00 00 02 04 7f c0 00 00", "01 90 03"),  # NaN
    ],
)
def test_exceptions(wire, request_hex: str, reply: str) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask(request_hex, 3) == reply


def test_a_valve_that_cannot_go_on_answers_exception_4_and_stays_on_the_line(start, valve) -> None:  # type: ignore[no-untyped-def]
    device = start()
    with Wire(device.port) as wire:
        healthy = valve.advance

        def broken(to_time_s: float, command: float) -> object:
            raise ArithmeticError("diverged")

        valve.advance = broken
        assert wire.ask("01 03 00 14 00 02", 3) == "01 83 04"
        valve.advance = healthy
        assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 00 00 00 00"


def test_silence_for_others_for_broadcast_and_for_damaged_requests(wire) -> None:  # type: ignore[no-untyped-def]
    wire.send(sealed(bytes.fromhex("02 03 00 10 00 02")))
    wire.send(sealed(bytes.fromhex("00 10 00 00 00 02 04 40 e8 00 00")))
    wire.send(sealed(bytes.fromhex("00 03 00 10 00 02")))
    wire.send(bytes.fromhex("01 03 00 10 00 02 12 34"))
    assert wire.ask("01 03 00 00 00 02", 7) == "01 03 04 40 e8 00 00"  # the broadcast was obeyed
    assert not wire.waiting()


def test_the_line_keeps_counters(wire) -> None:  # type: ignore[no-untyped-def]
    wire.ask("01 03 00 40 00 01", 3)
    wire.send(sealed(bytes.fromhex("02 03 00 10 00 02")))
    assert wire.ask("01 08 00 0b 00 00", 6) == "01 08 00 0b 00 03"  # seen on the line
    assert wire.ask("01 08 00 0e 00 00", 6) == "01 08 00 0e 00 03"  # meant for this unit
    assert wire.ask("01 08 00 0d 00 00", 6) == "01 08 00 0d 00 01"  # exceptions
    assert wire.ask("01 08 00 00 a5 37", 6) == "01 08 00 00 a5 37"


def test_identification_names_the_device(wire) -> None:  # type: ignore[no-untyped-def]
    wire.send(sealed(bytes.fromhex("01 2b 0e 01 00")))
    head = wire.receive(8)
    assert head.hex(" ") == "01 2b 0e 01 82 00 00 03"
    assert wire.receive(2 + 11 + 2 + 8) == b"\x00\x0bLost Motion\x01\x08LM-VALVE"


def test_the_watchdog_over_the_wire(wire, clock) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("01 06 00 20 00 14", 6) == "01 06 00 20 00 14"  # 2.0 s
    wire.ask(COMMAND_7_25, 6)
    clock.sleep_until(clock.now_s() + 2.5)
    assert wire.ask("01 03 00 10 00 06", 15) == "01 03 0c 00 00 00 00 00 01 00 01 00 00 00 00"
    wire.ask(COMMAND_7_25, 6)
    assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 00 00 00 00"
    assert wire.ask("01 06 00 13 00 01", 6) == "01 06 00 13 00 01"
    wire.ask(COMMAND_7_25, 6)
    assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 40 e8 00 00"


def test_emergency_over_the_wire(wire) -> None:  # type: ignore[no-untyped-def]
    wire.ask(COMMAND_7_25, 6)
    wire.ask("01 06 00 02 00 01", 6)
    wire.ask(COMMAND_7_25, 6)
    assert wire.ask("01 03 00 10 00 04", 11) == "01 03 08 00 00 00 00 00 01 00 02"


def test_noise_and_silence_lose_no_request(start) -> None:  # type: ignore[no-untyped-def]
    with Wire(start(idle_reset_s=0.002).port) as wire:
        for noise in ("55", "01 03 00", "01 10 00 00 00 7b f6 00 01", "01 03 00 10 00 02 12 34"):
            wire.send(bytes.fromhex(noise))
            threading.Event().wait(0.01)  # the silence is what is being tested
            assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 00 00 00 00"


def test_wire_faults_reach_the_wire(start) -> None:  # type: ignore[no-untyped-def]
    device = start(faults=WireFaults(local_echo=True, exception=1.0))
    with Wire(device.port) as wire:
        request = sealed(bytes.fromhex("01 03 00 10 00 02"))
        wire.send(request)
        assert wire.receive(13) == request + sealed(b"\x01\x83\x06")
    assert device.line_faults.injected["exception"] == 1


def test_a_paced_line_is_as_slow_as_its_baud(start) -> None:  # type: ignore[no-untyped-def]
    from hal.clock import RealClock

    clock = RealClock()
    with Wire(start(pace_baud=19200).port) as wire:
        began_s = clock.now_s()
        wire.ask("01 03 00 10 00 02", 7)
        assert clock.now_s() - began_s >= (8 + 3.5 + 9) * 10 / 19200


def test_the_port_outlives_a_master_and_the_link_dies_with_the_device(start, tmp_path) -> None:  # type: ignore[no-untyped-def]
    link = tmp_path / "valve"
    device = start(link=link)
    assert device.port == str(link)
    for _ in range(2):
        with Wire(device.port) as wire:
            assert wire.ask("01 03 00 10 00 02", 7) == "01 03 04 00 00 00 00"
    threads = threading.active_count()
    device.close()
    device.close()
    assert not os.path.lexists(link)
    assert threading.active_count() == threads - 1


def test_bytes_that_a_cooked_terminal_would_swallow(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("01 08 00 00 0d 11", 6) == "01 08 00 00 0d 11"
    assert wire.ask("01 08 00 00 13 04", 6) == "01 08 00 00 13 04"
    assert wire.ask("01 08 00 00 1a 03", 6) == "01 08 00 00 1a 03"


def test_faults_and_pacing_are_refused_where_they_mean_nothing(start) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match="'bit_flip': it is a fault of serial lines"):
        start(tcp="127.0.0.1:0", faults=WireFaults(bit_flip=0.1))
    with pytest.raises(BadInput, match="needs Modbus TCP"):
        start(tcp="rtu+tcp://127.0.0.1:0", faults=WireFaults(wrong_transaction=0.1))
    with pytest.raises(BadInput, match="the least is 300"):
        start(pace_baud=50)
