"""Held-out scenarios are other ones, of the same kind, and the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from control.held_out import held_out
from control.scenarios import SCENARIOS, TRAVEL_IN


@pytest.mark.parametrize("name", SCENARIOS)
def test_sizes_shrink_and_targets_move(name: str) -> None:
    named, drawn = SCENARIOS[name], held_out(SCENARIOS[name], 5000)
    assert held_out(named, 5000) == drawn != held_out(named, 5001)
    for effect, size in drawn.effects.items():
        assert 0.5 <= size / named.effects[effect] <= 1.0
    targets, before = drawn.targets(0.1), named.targets(0.1)
    assert targets.size == before.size
    assert 0.0 <= targets.min() <= targets.max() <= TRAVEL_IN
    assert 0.0 < np.abs(targets - before).max() <= 0.26 * TRAVEL_IN


def test_the_stops_and_the_size_of_small_steps_stay() -> None:
    assert held_out(SCENARIOS["ladder"], 5).targets(0.1)[[-1, 1800]] == pytest.approx([0.0, TRAVEL_IN])
    named, drawn = (np.diff(s.targets(0.1)) for s in (SCENARIOS["reversals"], held_out(SCENARIOS["reversals"], 5)))
    assert drawn == pytest.approx(named)
