"""Any profile can be emulated: two units, other scales and orders, what real modules lack, virtual time."""

from __future__ import annotations

from datetime import date

import pytest

from hal.clock import RealClock
from hal.errors import BadInput
from hal.profile import Profile, parse_profile
from sim_device.device import Options
from tests.sim_device.wire import Wire

# An analog output for the transducer (12 bit, 4-20 mA for 3-15 psi, coil watchdog), an analog input for the LVDT.
TWO_MODULES = {
    "name": "two",
    "travel_in": 0.5,
    "safe_command": 3.0,
    "limits": {"command_min": 3.0, "command_max": 15.0},
    "devices": {
        "ao": {
            "id": 5,
            "write_fc": 6,
            "address_base": 1,
            "resync": {"method": "read", "address": 211, "count": 2},
            "identity": {"address": 211, "expect": [0x4024, 0]},
            "watchdog": {
                "timeout_s": 1.0,
                "clear": 1,
                "timeout": {"address": 489, "raw": [0, 255], "eng": [0.0, 25.5]},
                "enable": {"address": 261, "table": "coil"},
                "status": {"address": 270, "table": "coil"},
                "safe_value": {
                    "address": 97,
                    "raw": [0, 4095],
                    "eng": [4.0, 20.0],
                    "transmitter": {"signal": [4.0, 20.0], "value": [3.0, 15.0]},
                },
            },
        },
        "ai": {"id": 6, "read_fc": 4, "word_order": "CDAB", "max_read": 8},
    },
    "signals": {
        "command": {
            "device": "ao",
            "address": 33,
            "raw": [0, 4095],
            "eng": [4.0, 20.0],
            "unit": "psi",
            "transmitter": {"signal": [4.0, 20.0], "value": [3.0, 15.0]},
        },
        "readback": {
            "device": "ao",
            "table": "input",
            "address": 65,
            "raw": [0, 4095],
            "eng": [3.0, 15.0],
            "unit": "psi",
        },
        "position": {"device": "ai", "address": 0, "raw": [0, 65535], "eng": [-10.0, 10.0], "unit": "V"},
        "pressure": {"device": "ai", "address": 2, "type": "f32", "unit": "psi"},
        "aux": {
            "humidity": {"device": "ai", "address": 4, "type": "f32"},
            "flow": {"device": "ai", "address": 6, "sentinels": [32767]},
        },
    },
    "calibration": {"id": "t", "made": date(2026, 1, 1), "points": [[-10.0, 0.0], [10.0, 0.5]]},
}


@pytest.fixture(scope="module")
def two() -> Profile:
    return parse_profile(TWO_MODULES, "two.toml")


@pytest.fixture
def wire(start, two):  # type: ignore[no-untyped-def]
    with Wire(start(profile=two).port) as wire:
        yield wire


def test_two_units_on_one_line_share_one_valve(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("05 06 00 20 08 00", 6) == "05 06 00 20 08 00"  # 2048 of 4095: 9.0015 psi
    assert wire.ask("05 04 00 40 00 01", 5) == "05 04 02 08 00"
    reply = bytes.fromhex(wire.ask("06 04 00 00 00 01", 5))
    assert int.from_bytes(reply[3:5], "big") == round(65535 * 0.090015 / 0.5)
    assert wire.ask("06 04 00 02 00 02", 7) == "06 04 04 06 00 41 10"  # 9.001465 psi, words swapped


def test_a_unit_has_only_its_own_registers(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("06 03 00 20 00 01", 3) == "06 83 02"
    assert wire.ask("05 04 00 02 00 01", 3) == "05 84 02"


def test_what_the_module_lacks_is_exception_1(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("05 17 00 20 00 01 00 20 00 01 02 00 00", 3) == "05 97 01"
    assert wire.ask("05 10 00 20 00 01 02 00 00", 3) == "05 90 01"
    assert wire.ask("05 08 00 00 12 34", 3) == "05 88 01"
    assert wire.ask("05 2b 0e 01 00", 3) == "05 ab 01"
    assert wire.ask("06 01 00 00 00 01", 3) == "06 81 01"
    assert wire.ask("06 04 00 00 00 09", 3) == "06 84 03"  # more than it can read at once


def test_constant_registers_identify_the_module(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("05 03 00 d2 00 02", 7) == "05 03 04 40 24 00 00"


def test_the_watchdog_behind_coils(wire, clock) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("05 01 01 04 00 01", 4) == "05 01 01 00"
    wire.ask("05 06 00 60 01 00", 6)  # safe value: 256 counts
    wire.ask("05 06 01 e8 00 0a", 6)  # 1.0 s
    wire.ask("05 05 01 04 ff 00", 6)
    wire.ask("05 06 00 20 08 00", 6)
    clock.sleep_until(clock.now_s() + 0.9)
    wire.ask("06 04 00 00 00 01", 5)  # the neighbour's traffic does not feed it
    clock.sleep_until(clock.now_s() + 0.2)
    assert wire.ask("05 01 01 0d 00 01", 4) == "05 01 01 01"
    assert wire.ask("05 04 00 40 00 01", 5) == "05 04 02 01 00"
    wire.ask("05 06 00 20 08 00", 6)
    assert wire.ask("05 04 00 40 00 01", 5) == "05 04 02 01 00"
    assert wire.ask("05 05 01 0d 00 00", 3) == "05 85 03"  # only the clearing value clears
    wire.ask("05 05 01 0d ff 00", 6)
    assert wire.ask("05 01 01 0d 00 01", 4) == "05 01 01 00"


def test_a_channel_that_the_valve_does_not_have_says_so(wire) -> None:  # type: ignore[no-untyped-def]
    assert wire.ask("06 04 00 04 00 02", 7) == "06 04 04 00 00 7f c0"  # NaN
    assert wire.ask("06 04 00 06 00 01", 5) == "06 04 02 7f ff"  # the sentinel


def test_a_profile_that_cannot_be_laid_out_is_named(start) -> None:  # type: ignore[no-untyped-def]
    crowded = {**TWO_MODULES, "signals": {**TWO_MODULES["signals"]}}  # type: ignore[dict-item]
    crowded["signals"]["pressure"] = {"device": "ao", "address": 211, "type": "f32", "unit": "psi"}
    with pytest.raises(BadInput, match=r"device 'ao' cannot be laid out: 'identity.0' and '\w+' share register 210"):
        start(profile=parse_profile(crowded, "crowded.toml"))


def test_a_master_in_another_process_moves_virtual_time(start, clock) -> None:  # type: ignore[no-untyped-def]
    with Wire(start(options=Options(simulation_block=True)).port) as wire:
        now_us = int(1e6 * clock.now_s())
        assert wire.ask("01 03 f0 00 00 04", 11) == "01 03 08 " + now_us.to_bytes(8, "big").hex(" ")
        wire.ask("01 10 f0 00 00 04 08 " + (now_us + 2_500_000).to_bytes(8, "big").hex(" "), 6)
        assert clock.now_s() == pytest.approx(102.5)
        wire.ask("01 10 f0 00 00 04 08 " + now_us.to_bytes(8, "big").hex(" "), 6)
        assert clock.now_s() == pytest.approx(102.5)  # time does not run backwards


def test_virtual_time_is_off_by_default_and_needs_a_stepped_clock(start, profile, valve) -> None:  # type: ignore[no-untyped-def]
    from sim_device.server import VirtualDevice

    with Wire(start().port) as wire:
        assert wire.ask("01 03 f0 00 00 04", 3) == "01 83 02"
    with pytest.raises(BadInput, match="real time"):
        VirtualDevice(profile, valve, RealClock(), options=Options(simulation_block=True))


def test_a_slow_daq_repeats_its_sample_and_its_sequence(start, clock) -> None:  # type: ignore[no-untyped-def]
    with Wire(start(options=Options(refresh_s=0.1)).port) as wire:
        wire.ask("01 10 00 00 00 02 04 40 e8 00 00", 6)
        clock.sleep_until(100.05)
        assert wire.ask("01 03 00 12 00 04", 11) == "01 03 08 00 00 00 00 00 00 00 00"
        clock.sleep_until(100.10)
        assert wire.ask("01 03 00 12 00 04", 11) == "01 03 08 00 01 00 00 40 e8 00 00"
