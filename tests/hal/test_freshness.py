from __future__ import annotations

import pytest

from hal.freshness import Freshness
from hal.sample import Quality


@pytest.mark.parametrize(
    ("last", "now", "quality"),
    [
        (None, 7, Quality.GOOD),
        (7, 8, Quality.GOOD),
        (7, 7, Quality.STALE),
        (7, 500, Quality.GOOD),
        (65535, 0, Quality.GOOD),
        (60000, 100, Quality.GOOD),
        (57344, 8191, Quality.GOOD),
        (57343, 8191, Quality.RESTARTED),
        (57344, 8192, Quality.RESTARTED),
        (500, 0, Quality.RESTARTED),
        (8, 7, Quality.RESTARTED),
    ],
)
def test_what_a_sequence_number_says(last, now, quality) -> None:
    freshness = Freshness(last)
    assert freshness.judge(now) == quality
    assert freshness.last == now
