"""What re-tuned numbers explain nearly as well is not explained by a cause, where much is left."""

from __future__ import annotations

import pytest

from tests.twin.judge.test_upheld import NAMED, NOTHING_SEEN, parts
from twin.diagnosis import Cause, Estimate
from twin.judge.remainder import leaves_too_much, no_better_than_numbers
from twin.judge.upheld import upheld


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


@pytest.mark.parametrize(
    ("numbers", "before", "after", "exact", "much"),
    [
        (10, 10.8, 2.23, False, True),  # 3.5 % of the squares: a core that slips on its rod, as a zero that wanders
        (10, 20.0, 2.23, False, False),  # 1 %
        (10, 9.0, 1.9, False, False),
        (4, 10.8, 2.23, False, False),
    ],
)
def test_a_free_curve_may_leave_less_than_a_law(
    numbers: int, before: float, after: float, exact: bool, much: bool
) -> None:
    known = {f"level_{k}": Estimate(0.1, None, "in") for k in range(numbers)}
    drift = Cause("lvdt_drift", "sensor", 0.9, None, known)
    assert leaves_too_much(before, after, 1.0, [drift], True, exact) is much
