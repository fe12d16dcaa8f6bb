"""Quantities in registers: the inverse of how the HAL reads them, including what cannot be read."""

from __future__ import annotations

import math

import pytest

from hal.profile import Profile
from hal.register import Register
from sim_device.pdu import HOLDING, INPUT, Refused
from sim_device.rig import Rig
from sim_device.signals import make_cell, signal_cells


def test_scaling_is_undone_and_redone(profile: Profile) -> None:
    register = Register.model_validate(
        {"address": 3, "raw": [0, 4095], "eng": [4, 20], "transmitter": {"signal": [4, 20], "value": [3, 15]}}
    )
    got: list[float] = []
    cell = make_cell(profile, "x", register, lambda: 9.0, got.append)
    assert cell.read() == pytest.approx(2047.5)
    assert cell.write is not None
    cell.write(4095)
    assert got == [pytest.approx(15.0)]


def test_what_can_be_written_is_a_holding_register_wherever_it_is_read(profile: Profile) -> None:
    register = Register(address=3, table="input")
    assert make_cell(profile, "x", register, lambda: 0.0).tables == {INPUT}
    assert make_cell(profile, "x", register, lambda: 0.0, lambda _: None).tables == {INPUT, HOLDING}


def test_a_sensor_that_cannot_be_read_is_exception_4(profile: Profile) -> None:
    def broken() -> float:
        raise ZeroDivisionError

    with pytest.raises(Refused) as caught:
        make_cell(profile, "x", Register(address=3), broken).read()
    assert caught.value.code == 4


@pytest.mark.parametrize(
    ("psi", "accepted"), [(0.0, True), (20.0, True), (-0.01, False), (20.01, False), (math.nan, False)]
)
def test_the_transducer_takes_its_range_and_no_more(profile: Profile, valve, clock, psi: float, accepted: bool) -> None:  # type: ignore[no-untyped-def]
    rig = Rig(valve, clock, safe_command=0.0)
    (command,) = (cell for cell in signal_cells(profile, rig, "bench") if cell.name == "command")
    assert command.accepts(psi) is accepted


def test_the_sequence_number_wraps_as_its_register_does(profile: Profile, valve, clock) -> None:  # type: ignore[no-untyped-def]
    rig = Rig(valve, clock, safe_command=0.0)
    (sequence,) = (cell for cell in signal_cells(profile, rig, "bench") if cell.name == "sequence")
    rig.sequence = 0xFFFF
    assert sequence.read() == 0
