from __future__ import annotations

import numpy as np
import pytest

from sim_device.physics.offline import record
from sim_device.valve import Outputs


class Follower:
    """Its pressure is the command of the interval that ends now; its position counts the intervals' seconds."""

    def __init__(self) -> None:
        self.last_s: float | None = None

    def advance(self, to_time_s: float, command: float) -> Outputs:
        length_s = 0.0 if self.last_s is None else to_time_s - self.last_s
        self.last_s = to_time_s
        return Outputs(command, length_s, 20.0, 22.0)


def test_the_command_of_a_row_is_in_force_over_the_interval_that_ends_there() -> None:
    pressure, position = record(Follower(), [5.0, 5.5, 7.0], [3.0, 4.0, 9.0])
    assert np.array_equal(pressure, [3.0, 4.0, 9.0])
    assert np.array_equal(position, [0.0, 0.5, 1.5])


def test_rows_must_match() -> None:
    with pytest.raises(ValueError, match="shorter"):
        record(Follower(), [0.0, 1.0], [3.0])
