"""A record and what a model says to its commands, as a picture: curves over time, what is left, and the valve's curves.

`identify --plot` and `simulate --plot` draw it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from app.targets import check_file
from hal.errors import BadInput

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

    from control.design import DesignModel
    from logs.recording import FloatArray, Recording
    from logs.spoken import Spoken

MOST = 3  # records in one picture
RECORD, MODEL, REST = "#1f5fa8", "#b5322e", "#8a8a8a"


@dataclass(frozen=True, slots=True)
class Replay:
    """A record and the model's position at its rows, in the record's unit."""

    recording: Recording
    position: FloatArray


def fit_percent(measured: FloatArray, modelled: FloatArray) -> float | None:
    """100 (1 - |measured - modelled| / |measured - mean|) over the rows that were read; None where nothing varies."""
    import numpy as np

    seen = np.isfinite(measured)
    if not seen.any():
        return None
    spread = float(np.linalg.norm(measured[seen] - measured[seen].mean()))
    return 100.0 * (1.0 - float(np.linalg.norm(measured[seen] - modelled[seen])) / spread) if spread > 0.0 else None


def check_target(path: Path, inputs: Iterable[Path | None] = ()) -> None:
    """Whether a picture can go there and is none of `inputs`, said before the work is done. Raises: `BadInput`."""
    from matplotlib.figure import Figure as Canvas

    known = Canvas().canvas.get_supported_filetypes()
    if path.suffix.removeprefix(".").lower() not in known:
        raise BadInput(f"--plot {path}: a picture ends in .png, .svg or .pdf")
    check_file("--plot", path, inputs)


def draw(path: Path, replays: Sequence[Replay], design: DesignModel, *, curves: bool) -> None:
    """Draws up to three records; with `curves` also the two curves of `design` among the readings; all in the units in
    which one speaks of the design.

    Raises: `BadInput` when the file cannot be written.
    """
    from matplotlib.figure import Figure as Canvas

    from twin.model.model_units import as_spoken

    shown, design = [_spoken(each, design.spoken) for each in replays[:MOST]], as_spoken(design)
    rows = 2 * len(shown) + curves
    heights = [2.0, 1.0] * len(shown) + [2.5] * curves
    canvas = Canvas(figsize=(8.0, 0.9 * sum(heights) + 0.6), dpi=100, layout="constrained")
    axes = canvas.subplots(rows, 1, height_ratios=heights, squeeze=False)[:, 0]
    for number, replay in enumerate(shown):
        _over_time(axes[2 * number], axes[2 * number + 1], replay, design.travel)
    if curves:
        _curves(axes[-1], [replay.recording for replay in shown], design)
    if len(replays) > MOST:
        canvas.suptitle(f"the first {MOST} of {len(replays)} records", fontsize=9)
    _save(canvas, path)


def _spoken(replay: Replay, spoken: Spoken) -> Replay:
    run = replay.recording
    per_p, per_x = spoken.value(1.0, run.pressure_unit), spoken.value(1.0, run.position_unit)
    said = replace(
        run,
        command=run.command * per_p,
        pressure=None if run.pressure is None else run.pressure * per_p,
        position=run.position * per_x,
        pressure_unit=spoken.unit(run.pressure_unit),
        position_unit=spoken.unit(run.position_unit),
    )
    return Replay(said, replay.position * per_x)


def _over_time(upper, lower, replay: Replay, travel: float) -> None:  # type: ignore[no-untyped-def]
    run, fit = replay.recording, fit_percent(replay.recording.position, replay.position)
    said = "" if fit is None else f", fit {fit:.2f} %"
    upper.plot(run.time_s, run.position, color=RECORD, lw=1.6, label=run.name)
    upper.plot(run.time_s, replay.position, color=MODEL, lw=0.8, label=f"model{said}")
    upper.set_ylabel(f"position [{run.position_unit}]")
    upper.legend(frameon=False, fontsize=8, loc="upper right")
    upper.sharex(lower)
    upper.tick_params(labelbottom=False)
    lower.plot(run.time_s, 100.0 * (run.position - replay.position) / travel, color=REST, lw=0.7)
    lower.axhline(0.0, color="0.85", lw=0.6, zorder=0)
    lower.set(xlabel="time [s]", ylabel="record - model\n[% of travel]")


def _curves(axes, recordings: Sequence[Recording], design: DesignModel) -> None:  # type: ignore[no-untyped-def]
    import numpy as np

    for run in recordings:
        pressure = run.command if run.pressure is None else run.pressure
        axes.plot(pressure, run.position, color=RECORD, lw=0.5, alpha=0.7)
    for onset, name, style in ((design.a1, "a1, closing", "-"), (design.a2, "a2, opening", "--")):
        line = np.array([onset, onset + design.travel / design.compliance])
        label = f"{name}: {onset:.4g} {design.pressure_unit}"
        axes.plot(line, [0.0, design.travel], color=MODEL, lw=1.2, ls=style, label=label)
    axes.set(xlabel=f"pressure [{design.pressure_unit}]", ylabel=f"position [{design.position_unit}]")
    axes.legend(frameon=False, fontsize=8)


def _save(canvas: Canvas, path: Path) -> None:
    try:
        canvas.savefig(path)
    except OSError as error:
        raise BadInput(f"--plot {path}: cannot be written ({error.strerror})") from error
