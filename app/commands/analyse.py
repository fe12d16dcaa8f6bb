"""Predict limit cycles by describing function, check by harmonic balance, measure them on the virtual valve."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

    from app.gains import Sweep
    from app.hunting import Case
    from control.design import DesignModel

LAWS = ("p", "p_incremental", "pi")


@click.command(name="analyse")
@click.option("--law", type=click.Choice(LAWS), help="One loop instead of the study.")
@click.option("--kp", type=click.FloatRange(0.0), default=3.0, show_default=True, help="[psi/in]")
@click.option("--ki", type=click.FloatRange(0.0), default=0.0, show_default=True, help="[psi/(in s)], for pi")
@click.option("--dead-time", type=click.FloatRange(0.0, 5.0), default=0.0, show_default=True, metavar="S",
              help="Of the converter, besides the tick [s].")  # fmt: skip
@click.option("--late", type=click.FloatRange(0.0, 5.0), default=0.0, show_default=True, metavar="S",
              help="Delay of the position reading [s].")  # fmt: skip
@click.option("--sweep", metavar="NAME=FROM:TO:COUNT", help="With --law: kp=1:6:11; or ki, dead_time, late.")
@click.option("--modbus", is_flag=True, help="With --law: also over Modbus, with the real stops and noise.")
@click.option("--period", type=click.FloatRange(0.02, 1.0), default=0.1, show_default=True, help="Tick [s].")
@click.option("--design", type=click.Path(path_type=Path, dir_okay=False), help="Design model (TOML), valve included.")
@click.option("--csv", "csv_file", type=click.Path(path_type=Path, dir_okay=False), help="Write the table.")
@click.option("--plot", type=click.Path(path_type=Path, dir_okay=False),
              help="Picture (PNG or SVG): Nyquist curves, or swing and period over the sweep.")  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def command(
    law: str | None, kp: float, ki: float, dead_time: float, late: float, sweep: str | None, modbus: bool,
    period: float, design: Path | None, csv_file: Path | None, plot: Path | None, as_json: bool,
) -> None:  # fmt: skip
    """Predict limit cycles, check the prediction by harmonic balance, and measure them on the virtual valve.

    Without --law: the thesis's gains and others, for P in both readings and for PI.
    """
    from app.gains import parse_sweep, write_csv
    from app.hunting import gains, study
    from app.progress import counted
    from app.recordings import bench_design
    from control.analysis.loop import LinearLoop
    from control.design import DesignModel, check_for_control
    from hal.errors import BadInput

    if law is None and (sweep or modbus):
        raise BadInput("--sweep and --modbus are about one law; give --law as well")
    if law != "pi" and (ki or (sweep or "").startswith("ki=")):
        raise BadInput("only --law pi has a ki")
    _check_targets(csv_file, plot, design)
    model = bench_design(design) if design else DesignModel()
    check_for_control(model)
    base = LinearLoop("p", kp, ki if law == "pi" else 0.0, model.ep_tau_s, model.tau_s, dead_time, period, late)
    swept = parse_sweep(sweep) if sweep else None
    base = replace(base, law=law or "p")  # type: ignore[arg-type]
    loops = swept.loops(base) if swept else [base] if law else gains(base)
    cases = counted(study(loops, model, wired=modbus), len(loops), "loops")
    if csv_file is not None:
        write_csv(cases, model.travel, csv_file)
    if plot is not None:
        _draw(cases, model, swept, plot)
    if as_json:
        click.echo(json.dumps([asdict(case) for case in cases], indent=1))
    else:
        _print(cases, model.travel, modbus)


def _check_targets(csv_file: Path | None, plot: Path | None, design: Path | None) -> None:
    from app.fit_picture import check_target
    from app.targets import check_file

    if csv_file is not None:
        check_file("--csv", csv_file, (design,))
    if plot is not None:
        check_target(plot, (design,))


def _draw(cases: Sequence[Case], model: DesignModel, swept: Sweep | None, path: Path) -> None:
    from app.gains import draw_gains
    from app.gallery.nyquist_plot import draw_nyquist

    if swept is not None:
        draw_gains(cases, model.travel, swept, path)
    else:
        draw_nyquist([case.loop for case in cases], model, path)


def _print(cases: Sequence[Case], travel_in: float, modbus: bool) -> None:
    from app.hunting import CONDITIONS, WIRED
    from app.tables import console, new_table

    headings = ["law", "kp\n[psi/in]", "ki\n[psi/(in s)]", "dead\ntime [s]", "late\n[s]"]
    headings += ["describing\nfunction", "harmonic\nbalance", "measured", *(["over\nModbus"] if modbus else [])]
    table = new_table("limit cycle of the stem, peak to peak in % of travel, and period", headings, left=("law",))
    for case in cases:
        loop = case.loop
        numbers = (f"{value:g}" for value in (loop.kp, loop.ki, loop.dead_time_s, loop.late_s))
        first = _cell(case.predicted, travel_in, "grows" if case.grows else "none")
        balanced = "\n".join(_cell(found, travel_in, "") for found in case.balanced) or "not found"
        cells = [first, balanced, _cell(case.measured, travel_in, "none")]
        cells += [_cell(case.wired, travel_in, "none")] if modbus else []
        table.add_row(loop.law, *numbers, *cells)
    console().print(table)
    click.echo(f"{CONDITIONS}." + (f"\n{WIRED}." if modbus else ""))


def _cell(found: object, travel_in: float, absent: str) -> str:
    if found is None:
        return absent
    return f"{200.0 * found.stem_in / travel_in:.1f} %  {found.period_s:.1f} s"  # type: ignore[attr-defined]
