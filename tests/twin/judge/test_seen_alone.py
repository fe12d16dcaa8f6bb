"""What the readings themselves show is not all of an answer, where more is wrong than that can be."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.twin.judge.test_upheld import NAMED, parts
from twin.diagnosis import Cause as Named
from twin.judge.upheld import upheld
from twin.record.sensing import Sensing


@pytest.mark.parametrize(("before", "verdict"), [(1.5, "effect"), (2.5, "unexplained")])
def test_the_steps_of_a_reading_do_not_explain_more_than_they_hide(before: float, verdict: str) -> None:
    """Steps of 2 round by 1 at most, beside noise of 1."""
    seen = Sensing((), {"sensor_quantization": {}}, 2.0)
    steps = replace(NAMED, causes=(Named("sensor_quantization", "sensor", 0.97, None, {}),))
    assert upheld(parts(before, before, before), steps, 1.0, seen, True)[1].verdict == verdict
    both = replace(steps, causes=(*steps.causes, *NAMED.causes))
    assert upheld(parts(before, before, 1.0), both, 1.0, seen, True)[1] is both
