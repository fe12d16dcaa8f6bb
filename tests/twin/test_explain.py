"""Signatures: what an effect changes, which experiment shows it, the sketch, the figure and the generated page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hal.errors import BadInput
from twin.explain import KINDS, signature, typical_values, visibilities
from twin.model.catalog import effect, effects
from twin.report.effect_figure import effect_figure, save_effect_figure
from twin.report.effects_page import effects_page
from twin.report.sketch import plane


def test_typical_sizes_lie_within_the_bounds_and_are_no_neutral() -> None:
    for one in effects().values():
        for form in one.forms:
            for p, value in zip(form.parameters, typical_values(form), strict=True):
                assert p.lower <= value <= p.upper
                assert (value != p.neutral) == p.size


def test_a_sensor_zero_shifts_the_reading_and_nothing_else() -> None:
    one = effect("lvdt_calibration")
    shown = signature(one, one.form("zero"), "steps")
    assert np.allclose(shown.residual_percent, 100.0 * 0.01 / 0.5625)
    assert np.array_equal(shown.pressure, shown.base_pressure)


def test_retuning_takes_away_what_it_can_imitate() -> None:
    """A second lag looks like a longer first one: most of it is gone. A zero error of the sensor is not."""
    lag = {v.kind: v for v in visibilities(effect("additional_lag"), effect("additional_lag").form("after_play"))}
    zero = {v.kind: v for v in visibilities(effect("lvdt_calibration"), effect("lvdt_calibration").form("zero"))}
    assert set(lag) == set(KINDS)
    assert lag["steps"].beyond_retuning_percent < 0.4 * lag["steps"].rms_percent
    assert zero["steps"].beyond_retuning_percent > 0.8 * zero["steps"].rms_percent


def test_inner_reversals_show_distributed_hysteresis_better_than_a_ramp() -> None:
    one = effect("distributed_hysteresis")
    shown = {v.kind: v.beyond_retuning_percent for v in visibilities(one, one.form("uniform"))}
    assert shown["nested"] > 2.0 * shown["ramp"]
    assert list(shown.values()) == sorted(shown.values(), reverse=True)


def test_plane() -> None:
    diagonal = np.linspace(0.0, 1.0, 30)
    lines = plane((diagonal, diagonal), (diagonal, 1.0 - diagonal), columns=11, rows=11)
    assert len(lines) == 11
    assert lines[0][0] == "o"  # y = 1 - x begins top left
    assert lines[-1][0] == "."
    assert lines[5][5] == "#"
    with pytest.raises(ValueError, match="points"):
        plane((np.zeros(0), np.zeros(0)), (np.zeros(0), np.zeros(0)))


def test_figure(tmp_path: Path) -> None:
    one = effect("dead_time")
    figure = effect_figure(one, "delay 0.4 s", signature(one, one.forms[0], "steps"))
    svg, png = save_effect_figure(figure, tmp_path / "new" / "dead_time")
    assert "with dead_time" in svg.read_text()
    assert png.read_bytes().startswith(b"\x89PNG")
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        save_effect_figure(figure, tmp_path / "file" / "dead_time")


def test_the_page_in_docs_is_up_to_date() -> None:
    page = Path(__file__).parents[2] / "docs" / "effects.md"
    assert page.read_text(encoding="utf-8") == effects_page(), "run: lostmotion explain --markdown > docs/effects.md"
