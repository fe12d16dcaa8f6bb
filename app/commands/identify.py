"""Identify the design model from recorded runs: both curves, travel, lags, rate limit, each with its interval.

RUN is a run folder, a CSV or a Parquet file; several of the same valve are fitted together.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from app.records import foreign_options
from app.targets import check_file

if TYPE_CHECKING:
    from control.identify_result import Estimate, Identified
    from logs.recording import Recording


@click.command(name="identify", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--out", metavar="MODEL.toml", required=True, type=click.Path(path_type=Path), help="The model file.")
@foreign_options
@click.option("--plot", metavar="FILE.png", type=click.Path(path_type=Path), help="Draw record, model and residual.")
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def command(
    runs: tuple[Path, ...],
    out: Path,
    mapping: str | None,
    units: str | None,
    command_timing: str,
    plot: Path | None,
    as_json: bool,
) -> None:
    from app.recordings import from_open, load_all
    from control.design import save_design
    from control.identify import identify
    from control.identify_checks import check_commands
    from hal.errors import BadInput
    from twin.model.model_units import as_spoken

    if out.suffix != ".toml":
        raise BadInput(f"--out {out}: a model file ends in .toml")
    check_file("--out", out, runs, parents=True)
    if plot is not None:
        from app.fit_picture import check_target

        check_target(plot, runs)
    recordings, _ = from_open(load_all(runs, mapping, units, command_timing))
    found = identify(recordings)
    check_commands(found.design, recordings)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        save_design(as_spoken(found.design), out, comment=_comment(found.answered()))
    except OSError as error:
        raise BadInput(f"{out}: the model cannot be written ({error.strerror}); name another file") from error
    if plot is not None:
        _draw(found, recordings, plot)
    if as_json:
        click.echo(json.dumps({**found.to_plain(), "model": str(out)}))
    else:
        _print(found.answered(), recordings, out)


def _draw(found: Identified, recordings: list[Recording], plot: Path) -> None:
    from app.fit_picture import Replay, draw
    from twin.model.insert import plant_of
    from twin.replay.simulate import simulate_recording

    plant = plant_of(found.design)
    replays = [Replay(each, simulate_recording(plant, each)[1]) for each in recordings]
    draw(plot, replays, found.design, curves=True)


def _comment(found: Identified) -> str:
    lines = [f"identified from {', '.join(found.runs)} ({found.rows} rows); 95 % intervals:"]
    for each in found.estimates:
        lines.append(f"  {each.name}: {_value(each)} {each.unit}  {_interval(each)}  {each.source}")
    return "\n".join([*lines, *found.notes])


def _value(each: Estimate) -> str:
    return f"{each.value:.5g}"


def _interval(each: Estimate) -> str:
    return "" if each.interval is None else f"{each.interval.low:.5g} .. {each.interval.high:.5g}"


def _print(found: Identified, recordings: list[Recording], out: Path) -> None:
    from app.tables import console, new_table

    words = ("number", "unit", "from")
    title = f"identified from {', '.join(found.runs)}"
    table = new_table(title, ("number", "value", "95 % interval", "unit", "from"), left=words)
    for each in found.estimates:
        table.add_row(
            each.name, _value(each), _interval(each) or "-", each.unit, each.source, end_section=each.name == "k_eq"
        )
    console().print(table)
    quality = found.quality
    unit = found.design.spoken.unit(found.design.position_unit)
    click.echo(
        f"model against record: RMS {quality.rms:.4g} {unit} = {quality.rms_percent_of_travel:.3f} % of travel, "
        f"fit {quality.fit_percent:.1f} % over {found.rows} rows"
    )
    if quality.commanded_percent_of_travel is not None:
        missed = f"RMS {quality.commanded_percent_of_travel:.3f} % of travel"
        click.echo(f"from the command alone, as the model file is used: {missed}")
    for note in found.notes:
        click.echo(f"note: {note}")
    for recording in recordings:
        for data_note in recording.notes:
            rows = f" ({data_note.rows} rows)" if data_note.rows else ""
            click.echo(f"data: {recording.name}: {data_note.what}: {data_note.handled}{rows}")
    click.echo(f"model: {out}")
