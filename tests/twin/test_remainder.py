"""What re-tuned numbers explain nearly as well is not explained by a cause, where much is left."""

from __future__ import annotations

import pytest

from tests.twin.test_upheld import NAMED, NOTHING_SEEN, parts
from twin.diagnosis import Cause
from twin.remainder import no_better_than_numbers
from twin.upheld import upheld


@pytest.mark.parametrize(
    ("retuned", "after", "verdict"),
    [
        (8.9, 8.5, "unexplained"),  # a cause beside which the numbers do nearly all
        (8.9, 7.0, "effect"),
        (2.6, 2.4, "effect"),  # what is left is not clear
    ],
)
def test_a_cause_has_to_do_more_than_other_numbers(retuned: float, after: float, verdict: str) -> None:
    assert upheld(parts(31.2, retuned, after), NAMED, 1.0, NOTHING_SEEN, True)[1].verdict == verdict


@pytest.mark.parametrize(("name", "told"), [("stiction", False), ("dead_time", True)])
def test_neither_jumps_nor_what_the_pressure_tells_are_asked(name: str, told: bool) -> None:
    assert not no_better_than_numbers(8.9, 8.5, 1.0, [Cause(name, "actuator", 0.9, None, {})], told)
    assert no_better_than_numbers(8.9, 8.5, 1.0, [Cause("creep", "actuator", 0.9, None, {})], False)
