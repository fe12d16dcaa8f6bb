"""What is asked about where the numbers found are those of no valve."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.identify import identify
from tests.control.test_identify import sweep


@pytest.mark.thorough
def test_milliseconds_taken_for_seconds_are_asked_about() -> None:
    plain = sweep(0.5)
    found = identify([replace(plain, time_s=1000.0 * plain.time_s)])
    assert any("(--units time=ms)?" in note for note in found.notes)
    assert not any("--units" in note for note in identify([plain]).notes)
