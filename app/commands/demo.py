"""Show the whole story on the virtual valve: sweep, identify, control, then find what is wrong with a sealed valve."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import click

from app.targets import check_folder

#: A sealed valve of the thesis's family with one effect; chosen so that there is something to find. Try others.
SEED = "valve-8"
CONTROLLER = "brake"
TARGETS = "0.1,0.4,0.25,0.5,0.05"


@click.command()
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Folder for everything the demo makes.")
@click.option("--sealed", metavar="SEED", default=SEED, show_default=True, help="Which sealed valve to diagnose.")
def command(out: Path | None, sealed: str) -> None:
    """Run the main job without hardware: a virtual valve behind real Modbus RTU frames on a pseudo-terminal.

    Every line that starts with $ is a command that you can type yourself.
    """
    folder = out or Path("logs/runs") / f"{datetime.now(UTC):%Y%m%dT%H%M%S}-demo"
    check_folder("--out", folder)
    folder.mkdir(parents=True, exist_ok=True)
    healthy, model, loop, blind = (folder / name for name in ("sweep", "model.toml", "loop", "sealed"))
    _chapter("1. Sweep a valve over Modbus and find its two curves")
    _verb("sweep", "nested", "--out", str(healthy))
    _verb("identify", str(healthy), "--out", str(model))
    _compare(model)
    _chapter("2. Control it with the numbers found")
    _verb("run", "--controller", CONTROLLER, "--targets", TARGETS, "--design", str(model), "--out", str(loop))
    _chapter("3. A valve with something wrong that nobody here knows: record it, name it, close the gap, unseal it")
    _verb("sweep", "nested", "--sealed", sealed, "--out", str(blind))
    _verb("diagnose", str(blind), "--design", str(model), "--out", str(blind))
    _verb("unseal", str(blind), sealed)
    _chapter("Where everything is")
    for what, path in (
        ("records", f"{healthy}, {loop}, {blind}"),
        ("report", blind / "report.html"),
        ("view", f"lostmotion view {loop}   (rerun: {blind / 'diagnosis.rrd'})"),
    ):
        click.echo(f"  {what:8} {path}")


def _chapter(title: str) -> None:
    click.echo(f"\n=== {title}")


def _verb(*words: str) -> None:
    """Shows a command as one would type it and runs it.

    Raises: `JobFailed` when it does not succeed.
    """
    from app.cli import cli

    click.echo(f"\n$ lostmotion {' '.join(words)}")
    cli.main(args=list(words), prog_name="lostmotion", standalone_mode=False)


def _compare(model: Path) -> None:
    """The identified numbers beside the virtual valve's true ones."""
    from app.tables import console, new_table
    from control.design import DesignModel, load_design

    found, true = load_design(model), DesignModel()
    table = new_table("found over the wire, and true", ("number", "found", "true", "off by"), left=("number",))
    for name in ("a1", "a2", "compliance", "tau_s", "rate_limit", "travel", "ep_tau_s"):
        got, want = float(getattr(found, name)), float(getattr(true, name))
        table.add_row(name, f"{got:.5g}", f"{want:.5g}", f"{100.0 * (got / want - 1.0):+.2f} %")
    console().print(table)
