"""Look at a run in rerun: a window, or a picture without a screen."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from app.records import foreign_options, open_run, say_problems

if TYPE_CHECKING:
    from logs.run import Run


@click.command()
@click.argument("run")
@click.option("--rrd", type=click.Path(path_type=Path), help="Where to write the view (default: into the run folder).")
@click.option("--headless-png", "png", type=click.Path(path_type=Path), help="Render a picture; needs no screen.")
@click.option("--at", "at_s", type=float, help="Bench time of the picture's cursor [s]; the end by default.")
@click.option("--design", type=click.Path(path_type=Path), help="Design model whose curves are drawn.  [default: ours]")
@click.option("--no-window", is_flag=True, help="Only write the .rrd file.")
@foreign_options
def command(
    run: str,
    rrd: Path | None,
    png: Path | None,
    at_s: float | None,
    design: Path | None,
    no_window: bool,
    mapping: str | None,
    units: str | None,
    command_timing: str,
) -> None:
    """Open RUN in the rerun viewer: command and pressure, position, error, the hysteresis plane, states, events.

    RUN is a run folder, a name out of `lostmotion runs`, `latest`, a CSV or Parquet file, or the address of a live
    view (rerun+http://...). The view is made anew from the record, which stays as it is. A view that is there already,
    as a .rrd file of a run or of a diagnosis, is opened as it is. The viewer listens on this machine only and sends
    nothing out.
    """
    from app.targets import check_file
    from logs.viewer import has_screen, open_window

    for option, target in (("--rrd", rrd), ("--headless-png", png)):
        if target is not None:
            check_file(option, target, (Path(run), design))
    if run.startswith("rerun+"):
        _need_screen(has_screen(), run)
        click.echo(f"viewer opened, process {open_window(run).pid}")
        return
    if Path(run).suffix == ".rrd":
        file = _view_file(Path(run), any((rrd, design, mapping, units)))
    else:
        record = open_run(run, mapping, units, command_timing)
        say_problems(record)
        file = _write_view(record, rrd, design)
    click.echo(f"view: {file}")
    _show(file, png, at_s, no_window)


def _show(file: Path, png: Path | None, at_s: float | None, no_window: bool) -> None:
    from logs.viewer import has_screen, open_window, take_picture

    if png is not None:
        for complaint in take_picture(file, png, at_s=at_s):
            click.echo(f"note: the viewer says: {complaint}", err=True)
        click.echo(f"picture: {png}")
    elif no_window:
        return
    elif has_screen():
        click.echo(f"viewer opened, process {open_window(str(file)).pid}")
    else:
        click.echo(
            "There is no screen here. Open the view where there is one with `rerun FILE`, "
            "or make a picture here with --headless-png FILE."
        )


def _view_file(path: Path, told_how: bool) -> Path:
    """A view that was made before. Raises: `BadInput` when it is none, or when it should be made another way."""
    from hal.errors import BadInput

    try:
        with path.open("rb") as file:
            head = file.read(4)
    except OSError as error:
        raise BadInput(
            f"{path} cannot be read ({error.strerror}); `lostmotion runs` lists the recorded runs"
        ) from error
    if head[:2] != b"RR":
        raise BadInput(f"{path} is no rerun file; give the run itself, and its view is made")
    if told_how:
        raise BadInput(
            f"{path} is a finished view: --rrd, --design, --map and --units need the record it was made from"
        )
    return path


def _need_screen(there: bool, address: str) -> None:
    from hal.errors import BadInput

    if not there:
        port = address.partition("127.0.0.1:")[2].partition("/")[0] or "PORT"
        raise BadInput(
            f"there is no screen here; on a machine with one, run `ssh -L {port}:127.0.0.1:{port} THIS_MACHINE` "
            f"and then `rerun --connect {address}`"
        )


def _write_view(record: Run, rrd: Path | None, design: Path | None) -> Path:
    """Into the run folder; for a foreign file, or a folder that cannot be written, into the temporary folder."""
    import os
    import tempfile

    from logs.layout import VIEW
    from logs.rrd import write_rrd

    curves = _curves(record, design)
    if rrd is not None:
        return write_rrd(record, rrd, curves)
    if record.path.is_dir() and os.access(record.path, os.W_OK):
        return write_rrd(record, record.path / VIEW, curves)
    return write_rrd(record, Path(tempfile.gettempdir()) / f"{record.path.stem}.rrd", curves)


def _curves(record: Run, design: Path | None) -> dict[str, object] | None:
    """The design to draw: the one named, else the thesis's for a record in psi and in."""
    from app.recordings import bench_design
    from control.design import DesignModel

    if design is not None:
        return bench_design(design).to_plain()
    return DesignModel().to_plain() if {"psi", "in"} <= set(record.units.values()) else None
