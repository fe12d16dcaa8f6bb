"""Make the LVDT's calibration from dial-gauge readings."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from hal.counted import counted

if TYPE_CHECKING:
    from hal.dial_gauge import Fit


@click.command()
@click.argument("readings", type=click.Path(path_type=Path), required=False, metavar="[READINGS.csv]")
@click.option("--profile", metavar="FILE|NAME", default="virtual", show_default=True, help="Profile to start from.")
@click.option("--port", metavar="PORT", help="Read the signal from the bench, and type what the gauge shows.")
@click.option("--at", "commands", metavar="X,X,...", help="With --port: commands to hold one after the other.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE.toml", help="New profile.")
@click.option("--kind", type=click.Choice(["two-point", "table"]), default="table", show_default=True,
              help="A straight line, or a table through all positions.")  # fmt: skip
@click.option("--id", "name", help="Name of the calibration.  [default: today's date]")
@click.option("--expires", type=click.DateTime(["%Y-%m-%d"]), help="Last day on which it counts.")
@click.option("--instrument", default="dial gauge", show_default=True, help="What it was compared with.")
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
def command(
    readings: Path | None,
    profile: str,
    port: str | None,
    commands: str | None,
    out: Path | None,
    kind: str,
    name: str | None,
    expires: datetime | None,
    instrument: str,
    as_json: bool,
) -> None:
    """Make the LVDT's calibration from dial-gauge readings, and put it into a copy of the profile.

    READINGS.csv has the columns `signal` (in the unit of the profile's position register) and `position_in`. Without
    it, the bench at --port is read: type the gauge's position, one a line, and an empty line at the end. With --at the
    valve is moved from command to command and waits at each for what you type; then it goes to its safe command (with a
    profile that holds it is left).
    """
    from app.gauge import ask
    from hal.clock import utc_now
    from hal.dial_gauge import fit, read_pairs, write_profile
    from hal.errors import BadInput

    _check_files(profile, out)
    if (readings is None) == (port is None) or (commands is not None and port is None):
        raise BadInput("give either READINGS.csv, or --port and, if the valve is to be moved, --at")
    pairs = read_pairs(readings) if readings is not None else ask(profile, str(port), commands)
    today, until = utc_now().date(), None if expires is None else expires.date()
    found = fit(
        pairs,
        "two-point" if kind == "two-point" else "table",
        name=name or f"{kind}-{today}",
        made=today,
        expires=until,
        instrument=instrument,
    )
    if out is not None:
        write_profile(_file_of(profile), out, found.calibration)
    _show(found, out, as_json)


def _check_files(profile: str, out: Path | None) -> None:
    """Before anybody has typed a reading. Raises: `BadInput`."""
    from app.targets import check_file
    from hal.dial_gauge import check_new
    from hal.profile import load_profile

    load_profile(profile)
    if out is not None:
        check_new(out)
        check_file("--out", out)


def _file_of(profile: str) -> Path:
    from hal.profile import FOLDER

    ours = FOLDER / f"{profile}.toml"
    return ours if ours.is_file() else Path(profile)


def _show(found: Fit, out: Path | None, as_json: bool) -> None:
    points = [list(point) for point in found.calibration.points]
    if as_json:
        result = {
            "id": found.calibration.id,
            "points": points,
            "residuals_in": list(found.residuals_in),
            "worst_in": found.worst_in,
            "rms_in": found.rms_in,
            "profile": None if out is None else str(out),
        }
        click.echo(json.dumps(result))
        return
    size = f"{counted(len(points), 'point')} from {counted(len(found.pairs), 'reading')}"
    click.echo(f"calibration '{found.calibration.id}', {size}")
    click.echo(f"{'signal':>12}  {'position in':>11}  {'residual in':>11}")
    for (signal, position), residual in zip(found.pairs, found.residuals_in, strict=True):
        click.echo(f"{signal:12.5f}  {position:11.4f}  {residual:+11.5f}")
    click.echo(f"worst residual {found.worst_in:.5f} in, rms {found.rms_in:.5f} in")
    if out is None:
        click.echo("nothing was written; --out FILE.toml makes a profile with it")
    else:
        click.echo(f"wrote {out}; use it with --profile {out}")
