"""docs/register-map.md says what the device does."""

from __future__ import annotations

import re
from pathlib import Path

from sim_device.device import VIRTUAL_TIME

PAGE = (Path(__file__).parents[2] / "docs" / "register-map.md").read_text(encoding="utf-8")


def test_the_table_is_the_layout_of_the_default_device(start) -> None:  # type: ignore[no-untyped-def]
    cells = start().units[1].server.registers.cells
    built = sorted((cell.address, cell.kind, cell.name, "read, write" if cell.write else "read") for cell in cells)
    rows = re.findall(r"^\| (\d+) \| (\w+) \| ([\w.]+) \| (read|read, write) \|", PAGE, flags=re.MULTILINE)
    assert [(int(address), kind, name, access) for address, kind, name, access in rows] == built


def test_the_functions_and_the_simulation_registers_are_the_device_s(start) -> None:  # type: ignore[no-untyped-def]
    functions = set(start().units[1].server.functions)
    assert functions == {3, 4, 6, 8, 16, 22, 23, 43}
    section = PAGE.partition("## Functions")[2].partition("\n##")[0]
    assert all(re.search(rf"\b{number}\b", section) for number in functions | {1, 5, 15})
    assert f"{VIRTUAL_TIME} (0x{VIRTUAL_TIME:X})" in PAGE
