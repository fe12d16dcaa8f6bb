"""Replay a recording's command through a model, with its effects, and write what it should have read.

MODEL.toml is a design model file, as `identify` and `diagnose` write it; RUN is a run folder, a CSV or a Parquet file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from app.records import foreign_options
from app.targets import check_apart, check_file
from hal.counted import counted
from hal.errors import BadInput

if TYPE_CHECKING:
    from logs.recording import FloatArray, Recording
    from logs.spoken import Spoken


@click.command(name="simulate", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.argument("model", metavar="MODEL.toml", type=click.Path(path_type=Path))
@click.argument("run", metavar="RUN", type=click.Path(path_type=Path))
@click.option("--out", required=True, metavar="FILE.csv", type=click.Path(path_type=Path), help="Where the columns go.")
@foreign_options
@click.option("--plot", metavar="FILE.png", type=click.Path(path_type=Path), help="Draw record, model and residual.")
@click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON.")
def command(
    model: Path,
    run: Path,
    out: Path,
    mapping: str | None,
    units: str | None,
    command_timing: str,
    plot: Path | None,
    as_json: bool,
) -> None:
    check_file("--out", out, (model, run))
    check_apart({"--out": out, "--plot": plot})
    from app.fit_picture import Replay, check_target, draw
    from app.recordings import design_of_file, load_all
    from twin.model.insert import plant_of
    from twin.model.model_units import as_spoken
    from twin.replay.simulate import simulate_recording

    if plot is not None:
        check_target(plot, (model, run))
    (recording,) = load_all([run], mapping, units, command_timing)
    design = design_of_file(model, recording.pressure_unit, recording.position_unit)
    try:
        plant = plant_of(design)
    except BadInput as error:
        raise BadInput(f"{model}: {error}") from error
    pressure, position = simulate_recording(plant, recording)
    _write(out, recording, pressure, position)
    if plot is not None:
        draw(plot, [Replay(recording, position)], plant.design, curves=False)
    figures = _figures(recording, plant.design.travel, pressure, position)
    if as_json:
        click.echo(json.dumps({"file": str(out), "model": str(plant), **figures}))
        return
    said = plant_of(as_spoken(design))
    click.echo(f"{recording.name} through {said}: {counted(recording.n, 'row')} over {recording.duration_s:.6g} s")
    for note in recording.notes:
        click.echo(f"note: {note.what}: {note.handled}")
    click.echo(_sentence(recording, figures, design.spoken))
    click.echo(f"written: {out}")


def _figures(
    recording: Recording, travel: float, pressure: FloatArray, position: FloatArray
) -> dict[str, float | int | None]:
    """RMS differences model against record; None where the record has no such readings."""
    from app.fit_picture import fit_percent

    rms = _rms(recording.position, position)
    return {
        "rows": recording.n,
        "position_rms": rms,
        "position_rms_percent_of_travel": None if rms is None else 100.0 * rms / travel,
        "fit_percent": fit_percent(recording.position, position),
        "pressure_rms": None if recording.pressure is None else _rms(recording.pressure, pressure),
        "gaps": 0 if recording.gap_before is None else int(recording.gap_before.sum()),
    }


def _rms(measured: FloatArray, modelled: FloatArray) -> float | None:
    import numpy as np

    seen = np.isfinite(measured)
    return float(np.sqrt(np.mean((measured[seen] - modelled[seen]) ** 2))) if seen.any() else None


def _sentence(recording: Recording, figures: dict[str, float | int | None], spoken: Spoken) -> str:
    parts = []
    if figures["position_rms"] is not None:
        parts.append(
            f"position {spoken.text(figures['position_rms'], recording.position_unit, 4)} "
            f"({figures['position_rms_percent_of_travel']:.3g} % of travel"
            + (")" if figures["fit_percent"] is None else f", fit {figures['fit_percent']:.2f} %)")
        )
    if figures["pressure_rms"] is not None:
        parts.append(f"pressure {spoken.text(figures['pressure_rms'], recording.pressure_unit, 3)}")
    through = f"; the model went through {figures['gaps']} gaps with the command after them" if figures["gaps"] else ""
    return f"RMS between model and record: {', '.join(parts)}{through}" if parts else "the record has no readings"


def _write(out: Path, recording: Recording, pressure: FloatArray, position: FloatArray) -> None:
    """The fixed columns, one line a row; numbers read back as the same float64."""
    import pyarrow as pa
    from pyarrow import csv

    p, x = recording.pressure_unit, recording.position_unit
    columns = {
        "time_s": recording.time_s,
        f"command_{p}": recording.command,
        f"pressure_{p}": pressure,
        f"position_{x}": position,
    }
    if recording.target is not None:
        columns[f"target_{x}"] = recording.target
    try:
        with out.open("wb") as file:
            file.write((",".join(columns) + "\n").encode())  # the library would put the names in quotes
            csv.write_csv(pa.table(columns), file, csv.WriteOptions(include_header=False, quoting_style="none"))
    except OSError as error:
        raise BadInput(f"{out}: cannot be written ({error.strerror}); name a file in a folder that exists") from error
