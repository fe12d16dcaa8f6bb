"""The figure of an effect: its residual over time, and the hysteresis plane without and with it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hal.errors import BadInput
from twin.report.style import AFTER, BEFORE, MEASURED, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from twin.explain import Signature
    from twin.model.effect import Effect


def effect_figure(effect: Effect, words: str, one: Signature) -> Figure:
    """Left the time residual under the two readings, right the plane of pressure and reading."""
    figure = new_figure(10.0, 4.2)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.5, 1.0], height_ratios=[1.4, 1.0])
    readings = figure.add_subplot(grid[0, 0])
    residual = figure.add_subplot(grid[1, 0], sharex=readings)
    plane = figure.add_subplot(grid[:, 1])
    readings.plot(one.time_s, one.base_position, color=MEASURED, linewidth=1.0, label="design model")
    readings.plot(one.time_s, one.position, color=BEFORE, linewidth=1.0, label=f"with {effect.name}")
    readings.tick_params(labelbottom=False)
    residual.plot(one.time_s, one.residual_percent, color=AFTER, linewidth=1.0)
    plane.plot(one.base_pressure, one.base_position, color=MEASURED, linewidth=1.0)
    plane.plot(one.pressure, one.position, color=BEFORE, linewidth=1.0)
    _words(readings, residual, plane)
    figure.suptitle(f"{effect.name}: {effect.claim}\n{words}; experiment {one.kind}", fontsize=10)
    return figure


def _words(readings: Axes, residual: Axes, plane: Axes) -> None:
    tidy(readings, "", "reading [in]")
    readings.legend(frameon=False, fontsize=8, loc="upper right")
    tidy(residual, "time [s]", "difference\n[% of travel]")
    tidy(plane, "pressure [psi]", "reading [in]")


def save_effect_figure(figure: Figure, stem: Path) -> tuple[Path, Path]:
    """Writes `stem`.svg and `stem`.png. Raises: `BadInput` when they cannot be written."""
    files = stem.with_suffix(".svg"), stem.with_suffix(".png")
    try:
        stem.parent.mkdir(parents=True, exist_ok=True)
        for file in files:
            figure.savefig(file, dpi=120)
    except OSError as error:
        raise BadInput(f"{stem.parent}: cannot be written ({error.strerror}); name another folder") from error
    return files
