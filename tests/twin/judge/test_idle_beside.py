"""What a cause beside another one has to explain on data that no fit has seen."""

from __future__ import annotations

import numpy as np
import pytest

from twin.judge.gap import GapParts, passes_for_noise


@pytest.mark.parametrize(("left", "error"), [(0.014, 1.25), (0.004, 0.5), (0.02, 2.3)])
def test_what_passes_for_noise_goes_by_the_noise_or_by_what_is_left(left: float, error: float) -> None:
    """Of a travel of 1 with 1 % noise: a quarter more than the smaller of the two; where more is left than
    noise, 15 % more than that."""
    level = np.full(8, left)
    parts = GapParts(level * 5.0, level * 3.0, level, {}, {})
    assert passes_for_noise(parts, 1.0, 1.0) == pytest.approx(error)
    slips = GapParts(level * 5.0, level * 3.0, level, {}, {}, driven=(0.1, 0.01))
    assert passes_for_noise(slips, 1.0, 1.0) <= 1.25
