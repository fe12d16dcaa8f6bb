"""The drawn figures of a report: over time, close up, in the pressure/position plane, and of the residual itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from logs.recording import FloatArray
from twin.report.series import Series, busiest_pressure, busiest_window, thin, thin_together
from twin.report.style import AFTER, BEFORE, FLOOR, INK, MEASURED, MUTED, RETUNED, UNCOUNTED, drawn, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_POINTS = 2400  # of a line across the page


@drawn("Position over time: measured, design model and updated model, with residuals")
def over_time(series: Series, floor_percent: float) -> Figure:
    """The whole data: readings and predictions above, residuals with the band of the noise floor below."""
    figure = new_figure(10.6, 4.5)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    time = series.run_time_s
    for axes in (top, bottom):
        _shade_uncounted(axes, series, time)
    broken = np.where(series.starts, np.nan, time)
    _line(top, broken, series.percent(series.position), MEASURED, "measured", 2.6, 0.35)
    _line(top, broken, series.percent(series.before), BEFORE, "design model", 1.0)
    _line(top, broken, series.percent(series.after), AFTER, "updated model", 1.0)
    _residuals(bottom, series, broken, floor_percent)
    tidy(top, "", "position [% of travel]")
    tidy(bottom, "run time [s]", "reading - model")
    _legend(top)
    top.margins(x=0.005)
    return figure


@drawn("Close-up of the stretch where the design model errs most")
def close_up(series: Series, floor_percent: float, seconds: float = 90.0) -> Figure:
    """The stretch where the design model errs most: command and pressure, position, residual."""
    rows = busiest_window(series, _rows_in(series, seconds))
    time = series.run_time_s[rows]
    figure = new_figure(10.6, 5.4)
    drive, top, bottom = figure.subplots(3, 1, sharex=True, height_ratios=[1.3, 3, 1.7])
    drive.step(time, series.command[rows], where="pre", color=MUTED, linewidth=1.1, label="command")
    if series.pressure is not None:
        _line(drive, time, series.pressure[rows], INK, "pressure", 0.9)
    _line(top, time, series.percent(series.position)[rows], MEASURED, "measured", 3.4, 0.33)
    _line(top, time, series.percent(series.before)[rows], BEFORE, "design model", 1.4)
    if series.retuned is not None:
        _line(top, time, series.percent(series.retuned)[rows], RETUNED, "re-tuned design", 1.1, dashed=True)
    _line(top, time, series.percent(series.after)[rows], AFTER, "updated model", 1.4)
    _residuals(bottom, series, time, floor_percent, rows)
    tidy(drive, "", f"[{series.pressure_unit}]")
    tidy(top, "", "position [% of travel]")
    tidy(bottom, "run time [s]", "reading - model")
    _legend(drive)
    _legend(top)
    top.margins(x=0.005)
    return figure


@drawn("Close-up of the stretch where the design model misses the pressure most")
def pressure_close_up(series: Series, seconds: float = 90.0) -> Figure:
    """The stretch where the design model misses the pressure most: command, reading and models; what they leave."""
    rows = busiest_pressure(series, _rows_in(series, seconds))
    time = series.run_time_s[rows]
    figure = new_figure(10.6, 4.2)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1.7])
    assert series.pressure is not None and series.pressure_before is not None and series.pressure_after is not None
    top.step(time, series.command[rows], where="pre", color=MUTED, linewidth=1.1, label="command")
    _line(top, time, series.pressure[rows], MEASURED, "measured", 3.4, 0.33)
    models = ((series.pressure_before, BEFORE, "design model"), (series.pressure_after, AFTER, "updated model"))
    for model, colour, label in models:
        _line(top, time, model[rows], colour, label, 1.4)
        _line(bottom, time, (series.pressure - model)[rows], colour, "", 0.9)
    tidy(top, "", f"pressure [{series.pressure_unit}]")
    tidy(bottom, "run time [s]", "reading - model")
    _legend(top)
    top.margins(x=0.005)
    return figure


@drawn("Hysteresis planes, position over pressure: measured against design and updated model")
def planes(series: Series) -> Figure:
    """Position over pressure (over the command, where no pressure was measured): readings against each model."""
    figure = new_figure(10.6, 4.2)
    both = figure.subplots(1, 2, sharex=True, sharey=True)
    driver = series.command if series.pressure is None else series.pressure
    name = "command" if series.pressure is None else "pressure"
    driver = np.where(series.starts, np.nan, driver)
    measured, before, after = (series.percent(v) for v in (series.position, series.before, series.after))
    rows = thin_together((driver, measured, before, after), 2 * _POINTS)
    for axes, model, colour, label in (
        (both[0], before, BEFORE, "design model"),
        (both[1], after, AFTER, "updated model"),
    ):
        axes.plot(driver[rows], measured[rows], color=MEASURED, label="measured", linewidth=2.4, alpha=0.33)
        axes.plot(driver[rows], model[rows], color=colour, label=label, linewidth=0.9, alpha=0.9)
        tidy(axes, f"{name} [{series.pressure_unit}]", "position [% of travel]" if axes is both[0] else "")
        _legend(axes)
    return figure


@drawn("How often the residual exceeds a size, and its spectrum, before and after")
def residual_shape(series: Series, floor_percent: float) -> Figure:
    """The residual before and after: share of held-out time above a size, with the floor, and spectrum of it all."""
    from matplotlib.ticker import LogLocator

    figure = new_figure(10.6, 2.9)
    left, right = figure.subplots(1, 2)
    rows = series.heldout if series.heldout.any() else np.ones_like(series.heldout)
    for model, colour, name in ((series.before, BEFORE, "design model"), (series.after, AFTER, "updated model")):
        residual = series.percent(series.position - model)
        size = np.sort(np.abs(residual[rows & np.isfinite(residual)]))
        share = 100.0 * (1.0 - np.arange(size.size) / max(size.size, 1))
        shown = np.unique(np.linspace(0, max(size.size - 1, 0), 400).astype(np.int64))
        left.plot(size[shown], share[shown], color=colour, linewidth=1.4, label=name)
        frequency, power = _spectrum(residual, series)
        right.loglog(frequency[1:], power[1:], color=colour, linewidth=1.2, label=name)
    if floor_percent > 0:
        from scipy.special import erfc

        size = np.geomspace(0.02 * floor_percent, 5.0 * floor_percent, 200)
        share = 100.0 * erfc(size / floor_percent / np.sqrt(2.0))
        left.fill_between(size, share, color=FLOOR, alpha=0.7, linewidth=0, label="noise floor")
        left.set_xlim(left=0.1 * floor_percent)
    left.set_xscale("log")
    left.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    left.xaxis.set_major_formatter(lambda value, _: f"{value:.2g}")
    left.minorticks_off()
    tidy(left, "size of the residual [% of travel]", "time above it [%]")
    tidy(right, "frequency [Hz]", "power density [%²/Hz]")
    right.minorticks_off()
    _legend(left)
    return figure


def _rows_in(series: Series, seconds: float) -> int:
    period = float(np.median(np.diff(series.run_time_s))) if series.time_s.size > 1 else 1.0
    return max(50, round(seconds / period))


def _spectrum(residual: FloatArray, series: Series) -> tuple[FloatArray, FloatArray]:
    from scipy.signal import welch

    step = np.diff(series.run_time_s)
    rate = 1.0 / float(np.median(step)) if step.size else 1.0
    length = int(min(residual.size, max(256, residual.size // 12)))
    frequency, power = welch(np.nan_to_num(residual), fs=rate, nperseg=length)
    return np.asarray(frequency), np.asarray(power)


def _residuals(axes: Axes, series: Series, time: FloatArray, floor: float, rows: slice = slice(None)) -> None:
    axes.axhspan(-2 * floor, 2 * floor, color=FLOOR, alpha=0.55, linewidth=0, label="noise floor (2 sigma)")
    for model, colour, width in ((series.before, BEFORE, 0.9), (series.after, AFTER, 0.9)):
        _line(axes, time, series.percent(series.position - model)[rows], colour, "", width)


def _line(
    axes: Axes,
    x: FloatArray,
    y: FloatArray,
    colour: str,
    label: str,
    width: float,
    alpha: float = 1.0,
    dashed: bool = False,
) -> None:
    rows = np.union1d(thin(y, _POINTS), np.flatnonzero(np.isnan(x))[:_POINTS])
    style = (0, (4, 2)) if dashed else "-"
    axes.plot(x[rows], y[rows], color=colour, label=label or None, linewidth=width, alpha=alpha, linestyle=style)


def _shade_uncounted(axes: Axes, series: Series, time: FloatArray) -> None:
    """Marks what the error on held-out data does not count; all else is held out in its turn."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], ~series.heldout, [False]]).astype(np.int8)))
    for number, (start, stop) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        label = "not counted" if number == 0 else None
        axes.axvspan(time[start], time[min(stop, time.size - 1)], color=UNCOUNTED, linewidth=0, zorder=0, label=label)


def _legend(axes: Axes) -> None:
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, frameon=False, labelcolor=MUTED, fontsize=9)
