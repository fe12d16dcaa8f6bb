"""The counters of function 8."""

from __future__ import annotations

import pytest

from sim_device.diagnostics import Diagnostics


def test_every_counter_counts_its_own() -> None:
    counters = Diagnostics()
    counters.saw_frame()
    counters.saw_damage(3)
    counters.addressed(answered=True)
    counters.addressed(answered=False)
    counters.refused(2)
    counters.refused(6)
    values = {sub: counters.sub_function(sub, 0) for sub in range(11, 19)}
    assert values == {11: 1, 12: 3, 13: 2, 14: 2, 15: 1, 16: 0, 17: 1, 18: 0}


@pytest.mark.parametrize("clearing", [1, 10])
def test_clearing_and_restarting_clear_and_echo(clearing: int) -> None:
    counters = Diagnostics()
    counters.saw_frame()
    assert counters.sub_function(clearing, 0xFF00) == 0xFF00
    assert counters.sub_function(11, 0) == 0


def test_counters_wrap_at_16_bits_and_unknown_sub_functions_are_none() -> None:
    counters = Diagnostics()
    counters.saw_damage(0x10002)
    assert counters.sub_function(12, 0) == 2
    assert counters.sub_function(3, 0) is None
    assert counters.sub_function(2, 0) == 0
