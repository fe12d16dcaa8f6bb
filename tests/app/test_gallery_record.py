"""Which record of several a figure shows."""

from __future__ import annotations

from itertools import permutations

from app.gallery.record import typical


def test_the_record_nearest_the_median_is_shown_and_of_two_the_lower_key_on_any_machine() -> None:
    assert typical({1: 5.0, 2: 1.0, 3: 2.0}) == 3
    for last in (-4e-13, 0.0, 4e-13):
        values = {4: 99.6 + last, 21: 99.7, 7: 99.0, 9: 99.9}
        assert all(typical(dict(some)) == 4 for some in permutations(values.items()))
    assert typical({4: 99.6, 21: 99.7, 7: 99.0, 9: 99.9, 2: 99.68}) == 2
