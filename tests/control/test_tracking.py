"""How a held target is judged."""

from __future__ import annotations

import numpy as np
import pytest

from control.tracking import judge


def test_error_swing_and_settling_time() -> None:
    time_s = np.arange(0.0, 40.0, 0.1)
    position = 0.3 - 0.3 * np.exp(-time_s / 2.7) + 0.002
    result = judge(time_s, position, 0.3, 0.5625)
    assert result.final_error_in == pytest.approx(0.002, abs=1e-4)
    assert result.swing_in < 1e-3
    assert result.settled_s == pytest.approx(2.7 * np.log(0.3 / (0.02 * 0.5625 + 0.002)), abs=0.2)


def test_a_hunting_valve_never_settles() -> None:
    time_s = np.arange(0.0, 40.0, 0.1)
    result = judge(time_s, 0.3 + 0.05 * np.sin(time_s), 0.3, 0.5625)
    assert result.settled_s is None
    assert result.swing_in == pytest.approx(0.1, abs=0.01)
