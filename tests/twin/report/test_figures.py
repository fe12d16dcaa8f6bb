"""What the report's figures draw."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.twin.report_example import series
from twin.report.figures import over_time, planes


def test_in_the_plane_models_are_drawn_on_the_rows_of_what_was_measured() -> None:
    figure = planes.__wrapped__(series(2000))
    lines = [line for axes in figure.axes for line in axes.lines]
    assert len(lines) == 4
    assert all(np.array_equal(line.get_xdata(), lines[0].get_xdata(), equal_nan=True) for line in lines)


def test_only_rows_that_the_held_out_error_does_not_count_are_shaded() -> None:
    shown = series(2000)
    all_in, first_out = np.ones(2000, dtype=bool), np.arange(2000) >= 100

    def shades(held: np.ndarray) -> list[str]:
        top = over_time.__wrapped__(replace(shown, heldout=held), 0.1).axes[0]
        return [str(patch.get_label()) for patch in top.patches]

    assert shades(all_in) == []
    assert shades(first_out) == ["not counted"]
