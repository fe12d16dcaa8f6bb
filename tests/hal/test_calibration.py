from __future__ import annotations

from datetime import date

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from hal.calibration import Calibration

TABLE = ((-8.0, 0.0), (-1.0, 0.2), (8.0, 0.5625))


def make(points=TABLE, **more) -> Calibration:
    return Calibration(id="x", made=date(2026, 1, 2), points=points, **more)


def test_points_are_hit_and_the_line_between_them_is_straight() -> None:
    table = make()
    assert [table.to_in(signal) for signal, _ in TABLE] == pytest.approx([0.0, 0.2, 0.5625])
    assert table.to_in(-4.5) == pytest.approx(0.1)


def test_beyond_the_ends_the_last_segments_go_on() -> None:
    two = make(((-8.0, 0.0), (8.0, 0.5625)))
    assert two.to_in(-9.6) == pytest.approx(-0.05625)
    assert two.to_in(9.6) == pytest.approx(0.61875)


def test_a_falling_signal_is_a_calibration_too() -> None:
    falling = make(((8.0, 0.0), (-8.0, 0.5)))
    assert falling.to_in(0.0) == pytest.approx(0.25)
    assert falling.to_signal(0.25) == pytest.approx(0.0)


@given(st.floats(-12, 12))
def test_the_inverse_is_the_inverse(signal) -> None:
    table = make()
    assert table.to_signal(table.to_in(signal)) == pytest.approx(signal, abs=1e-9)


@pytest.mark.parametrize(
    ("points", "column"),
    [(((0, 0), (0, 1)), "signal"), (((0, 0), (1, 1), (0.5, 2)), "signal"), (((0, 0), (1, 0)), "position")],
)
def test_a_table_that_turns_back_is_refused(points, column) -> None:
    with pytest.raises(ValidationError, match=f"the {column} column of points must rise or fall strictly"):
        make(points)


def test_expiry_counts_from_the_day_after() -> None:
    table = make(expires=date(2026, 6, 1))
    assert not table.expired(date(2026, 6, 1))
    assert table.expired(date(2026, 6, 2))
    assert not make().expired(date(2999, 1, 1))
    with pytest.raises(ValidationError, match="lies before made"):
        make(expires=date(2026, 1, 1))
