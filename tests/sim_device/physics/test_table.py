from __future__ import annotations

from pathlib import Path

from sim_device.physics.table import markdown, refreshed

DOC = Path(__file__).parents[3] / "docs" / "virtual-valves.md"


def test_the_tables_in_the_documentation_are_those_of_the_code() -> None:
    text = DOC.read_text(encoding="utf-8")
    assert text == refreshed(text), "docs/virtual-valves.md is stale; write refreshed(text) into it"
    assert markdown("thesis") in text and markdown("reference") in text


def test_a_row_says_name_stage_sizes_claim_and_forms() -> None:
    row = next(line for line in markdown("thesis").splitlines() if line.startswith("| `ep_calibration`"))
    assert row.startswith("| `ep_calibration` | ep | ± 0.01 / 0.03 / 0.1 psi | ") and row.endswith("| zero, span |")


def test_text_outside_the_marks_is_left_alone() -> None:
    assert refreshed("a <!-- note --> b\n") == "a <!-- note --> b\n"
    assert refreshed("a\n<!-- thesis -->\nold\n<!-- end -->\nz\n").endswith("|\n<!-- end -->\nz\n")
