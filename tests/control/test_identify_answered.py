"""What `identify` says is in the units of the recordings' files; what it finds is not touched by that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.identify import identify
from logs.spoken import Spoken
from tests.control.toy_valve import Toy, random_steps, record

BAR = 0.0689475729


def test_numbers_notes_and_residual_are_told_in_bar_and_mm() -> None:
    command = random_steps(200.0, 0.2, low=4.0, high=10.4, seed=3)  # never closed
    command[command > 10.4] = 10.4
    given = record(Toy(k2=0.21), 0.2 * np.arange(command.size), command)
    plain = identify([given])
    found = identify([replace(given, meta={"written": {"command": "bar", "position": "mm"}})])
    assert found.design == plain.design and found.design.spoken == Spoken("bar", "mm")
    assert [replace(each, note="") for each in found.estimates] == [replace(each, note="") for each in plain.estimates]
    said = found.answered()
    a1, slope = said["a1"], said["compliance"]
    assert (a1.unit, slope.unit) == ("bar", "mm/bar")
    assert a1.value == pytest.approx(plain["a1"].value * BAR, rel=1e-8)
    assert a1.interval is not None and plain["a1"].interval is not None
    assert a1.interval.low == pytest.approx(plain["a1"].interval.low * BAR, rel=1e-8)
    assert slope.value == pytest.approx(plain["compliance"].value * 25.4 / BAR, rel=1e-8)
    assert said.quality.rms == pytest.approx(25.4 * plain.quality.rms)
    notes = " ".join(found.notes)
    assert " psi" not in notes and " in/s" not in notes and " mm" in notes
    assert " psi" in " ".join(plain.notes)
    assert plain.answered() == plain
