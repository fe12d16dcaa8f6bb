"""The watchdog's registers, as a profile places them."""

from __future__ import annotations

from typing import Any

import pytest

from hal.profile import Profile, parse_profile
from sim_device.registers import Cell
from sim_device.rig import EMERGENCY, HEALTHY, TIMED_OUT, Rig
from sim_device.watchdog import watchdog_cells

REGISTERS = {
    "timeout": {"address": 10, "raw": [0, 255], "eng": [0.0, 25.5]},
    "enable": {"address": 11},
    "status": {"address": 12},
    "safe_value": {"address": 13, "type": "f32"},
    "emergency": {"address": 15},
}


def make_profile(**watchdog: Any) -> Profile:
    return parse_profile(
        {
            "name": "watched",
            "travel_in": 0.5,
            "limits": {"command_min": 0.0, "command_max": 20.0},
            "devices": {"unit": {"id": 1, "watchdog": watchdog}},
            "signals": {
                "command": {"address": 0, "type": "f32", "unit": "psi"},
                "position": {"address": 2, "type": "f32", "unit": "in"},
            },
        },
        "watched",
    )


@pytest.fixture
def rig(valve, clock) -> Rig:  # type: ignore[no-untyped-def]
    return Rig(valve, clock, safe_command=0.0)


def cells_of(profile: Profile, rig: Rig | None) -> dict[str, Cell]:
    return {cell.name.removeprefix("watchdog."): cell for cell in watchdog_cells(profile, rig, "unit")}


def write(cell: Cell, raw: float) -> None:
    assert cell.write is not None and cell.accepts(raw)
    cell.write(raw)


def test_a_profile_without_a_watchdog_has_no_such_registers(rig: Rig) -> None:
    profile = make_profile(timeout_s=1.0)
    bare = profile.model_copy(
        update={"devices": {"unit": profile.devices["unit"].model_copy(update={"watchdog": None})}}
    )
    assert watchdog_cells(bare, rig, "unit") == []


def test_a_switch_of_its_own_starts_off_with_the_timeout_preset(rig: Rig) -> None:
    cells = cells_of(make_profile(timeout_s=1.5, **REGISTERS), rig)
    assert (rig.watchdog.enabled, cells["timeout"].read(), cells["enable"].read()) == (False, 15.0, 0.0)
    write(cells["enable"], 1)
    assert rig.watchdog.enabled


def test_without_a_switch_the_timeout_is_the_switch(rig: Rig) -> None:
    registers = {name: place for name, place in REGISTERS.items() if name != "enable"}
    cells = cells_of(make_profile(timeout_s=1.5, **registers), rig)
    assert rig.watchdog.expires_s == float("inf")
    write(cells["timeout"], 20)
    assert rig.watchdog.expires_s == pytest.approx(102.0)


def test_the_safe_value_is_what_goes_out(rig: Rig, clock) -> None:  # type: ignore[no-untyped-def]
    cells = cells_of(make_profile(**REGISTERS), rig)
    write(cells["safe_value"], 3.5)
    write(cells["emergency"], 1)
    assert (rig.command, cells["status"].read(), cells["emergency"].read()) == (3.5, EMERGENCY, 1.0)
    write(cells["status"], 1)
    assert (rig.watchdog.status, rig.command) == (HEALTHY, 3.5)


def test_no_emergency_is_no_emergency(rig: Rig) -> None:
    write(cells_of(make_profile(**REGISTERS), rig)["emergency"], 0)
    assert rig.watchdog.status == HEALTHY


@pytest.mark.parametrize(
    ("name", "raw"),
    [
        ("timeout", -1.0),
        ("enable", 2.0),
        ("status", 0.0),
        ("status", 2.0),
        ("safe_value", 20.1),
        ("safe_value", -0.1),
        ("safe_value", float("nan")),
        ("emergency", 2.0),
    ],
)
def test_values_that_cannot_be_are_not_accepted(rig: Rig, name: str, raw: float) -> None:
    assert not cells_of(make_profile(**REGISTERS), rig)[name].accepts(raw)


def test_another_clearing_value(rig: Rig) -> None:
    cells = cells_of(make_profile(clear=7, **REGISTERS), rig)
    rig.watchdog.trip(TIMED_OUT)
    assert not cells["status"].accepts(1)
    write(cells["status"], 7)
    assert rig.watchdog.status == HEALTHY


def test_on_a_unit_that_drives_nothing_the_registers_only_remember() -> None:
    cells = cells_of(make_profile(**REGISTERS), None)
    write(cells["timeout"], 20)
    assert cells["timeout"].read() == 20
    write(cells["emergency"], 1)
    assert cells["status"].read() == 0
