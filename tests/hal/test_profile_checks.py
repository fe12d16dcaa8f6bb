"""Profiles whose parts do not fit together; what is wrong with one key stands in `test_profile.py`."""

from __future__ import annotations

import pytest

from hal.errors import BadInput
from hal.profile import parse_profile
from tests.hal.test_profile import changed


def test_a_limit_of_pressure_that_leaves_no_command_is_refused() -> None:
    content = changed("limits.pressure_max_psi", 2.0)
    assert parse_profile(content, "mine.toml").limits.pressure_max_psi == 2.0
    content |= {"safe_command": 3.0, "limits": content["limits"] | {"command_min": 3.0}}
    with pytest.raises(BadInput, match=r"limits.pressure_max_psi 2 is below safe_command 3 psi, at which a run"):
        parse_profile(content, "mine.toml")


def test_a_travel_in_another_unit_is_noticed_wherever_something_speaks_of_inches() -> None:
    content = changed("travel_in", 14.2875)
    sentence = r"travel_in 14.2875 is {} times the range of {}; give it in inches"
    limits = sentence.format("21.3", "limits.position_min_in to position_max_in, -0.05 to 0.62 in")
    with pytest.raises(BadInput, match=limits):
        parse_profile(content, "mine.toml")
    del content["limits"]["position_max_in"]
    with pytest.raises(BadInput, match=sentence.format("25.4", "calibration.points, 0 to 0.5625 in")):
        parse_profile(content, "mine.toml")
    del content["calibration"]
    content["signals"]["position"] |= {"unit": "in", "eng": [0.0, 0.7]}
    with pytest.raises(BadInput, match=sentence.format("20.4", "signals.position, 0 to 0.7 in")):
        parse_profile(content, "mine.toml")
    in_mm = {"type": "f32", "raw": [0, 1], "eng": [0.0, 0.0393701], "address": 900}
    content["signals"]["position"] |= in_mm  # a float has no ends
    assert parse_profile(content, "mine.toml").travel_in == 14.2875
