"""Say where the sim-to-real gap lies, which effect causes it, and how far it shrinks once that effect is added."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from control.design import DesignModel
    from logs.recording import Recording


@click.command()
@click.argument("runs", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--design", type=click.Path(path_type=Path), help="Design model file; without it the thesis's numbers.")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for diagnosis.json, report, model.")
@click.option("--map", "mapping", help="Columns of a foreign file: time=COL,command=COL,pressure=COL,position=COL.")
@click.option("--units", help="Units of a foreign file: command=kPa,position=mm,time=ms.")
@click.option(
    "--command-timing", type=click.Choice(["before", "after", "unknown"]), default="before", show_default=True
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the bootstrap.")
@click.option("--json", "as_json", is_flag=True, help="Print diagnosis.json to stdout.")
def command(
    runs: tuple[Path, ...],
    design: Path | None,
    out: Path,
    mapping: str | None,
    units: str | None,
    command_timing: str,
    seed: int,
    as_json: bool,
) -> None:
    """Diagnose RUNS (run folders, CSV or Parquet files) of one bench against a design model."""
    import json
    from typing import Literal, cast

    from app.progress import diagnosis_progress
    from logs.load import load_recording
    from twin.diagnose import Settings, diagnose
    from twin.insert import inserted_from
    from twin.write import write_outcome

    timing = cast(Literal["before", "after", "unknown"], command_timing)
    recordings = [load_recording(r, mapping=mapping, units=units, command_timing=timing) for r in runs]
    model = _design(design, recordings)
    out.mkdir(parents=True, exist_ok=True)
    with diagnosis_progress() as progress:
        outcome = diagnose(recordings, model, inserted_from(model), Settings(seed=seed), progress)
        write_outcome(outcome, out, progress)
    if as_json:
        click.echo(json.dumps(outcome.diagnosis.to_json(), indent=2))
        return
    click.echo(outcome.diagnosis.statement)
    for names in outcome.diagnosis.confusable:
        click.echo(f"This data cannot tell apart: {', '.join(names)}.")
    click.echo(f"Report: {out / 'report.html'}; view: {out / 'diagnosis.rrd'}; updated model: {out / 'model.toml'}")


def _design(path: Path | None, recordings: list[Recording]) -> DesignModel:
    """The design in the recordings' units; without a file the defaults, or identified where the units differ."""
    from control.design import DesignModel, load_design
    from hal.errors import BadInput
    from twin.model_units import in_units_of

    units = {(r.pressure_unit, r.position_unit) for r in recordings}
    if len(units) > 1:
        raise BadInput(f"the recordings have different units ({sorted(units)}); give --units so that they agree")
    pressure_unit, position_unit = units.pop()
    if path is not None:
        return in_units_of(load_design(path), pressure_unit, position_unit)
    if (pressure_unit, position_unit) == ("psi", "in"):
        return DesignModel()
    from control.identify import identify

    return identify(recordings).design
