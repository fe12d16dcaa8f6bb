"""The bench of slow sampling draws the valve that it says, and counts what held."""

from __future__ import annotations

import numpy as np

from bench.identify_slow import coverage, drawn
from tests.control.toy_valve import Toy, respond


def test_the_records_are_those_of_the_equations() -> None:
    truth, recording = drawn("mixed", 2.0, 3, measured=True)
    toy = Toy(*(truth[name] for name in ("ep.tau", "a1", "a2", "k", "k", "tau", "rate_limit", "travel")))
    rows = slice(0, 120)
    _, stem = respond(toy, recording.time_s[rows], recording.command[rows])
    assert np.max(np.abs(stem - recording.position[rows])) < 0.004  # five times the noise, and the toy's own steps


def test_a_rate_limit_that_steps_of_a_percent_never_reach_is_not_found() -> None:
    found = coverage("one_percent", 2.0, range(1, 2), measured=True)
    assert "rate_limit" not in found  # before: 0.0078 in/s for 0.088 in/s, half width 0.3 %
    assert found["tau"][0][0]
