"""Predict limit cycles by describing function, check by harmonic balance, measure them on the virtual valve."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from app.hunting import Case


@click.command(name="analyse")
@click.option("--law", type=click.Choice(["p", "p_incremental", "pi"]), help="One loop instead of the study.")
@click.option("--kp", type=float, default=3.0, show_default=True, help="[psi/in]")
@click.option("--ki", type=float, default=0.0, show_default=True, help="[psi/(in s)], for pi")
@click.option("--period", type=click.FloatRange(0.02, 1.0), default=0.1, show_default=True, help="Tick [s].")
@click.option("--design", type=click.Path(path_type=Path, dir_okay=False), help="Design model (TOML).")
@click.option("--plot", type=click.Path(path_type=Path, dir_okay=False), help="Nyquist picture (PNG or SVG).")
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def command(
    law: str | None, kp: float, ki: float, period: float, design: Path | None, plot: Path | None, as_json: bool
) -> None:
    """Predict limit cycles, check the prediction by harmonic balance, and measure them on the virtual valve.

    Without --law: the thesis's gains and others, for P in both readings and for PI.
    """
    from app.hunting import gains, study
    from control.analysis.loop import LinearLoop
    from control.design import DesignModel, load_design

    model = load_design(design) if design else DesignModel()
    timing = {"ep_tau_s": model.ep_tau_s, "stem_tau_s": model.tau_s, "tick_s": period}
    one = [LinearLoop(law, kp, ki, **timing)] if law else None  # type: ignore[arg-type]
    loops = one or [LinearLoop(g.law, g.kp, g.ki, **timing) for g in gains()]
    cases = study(loops, model)
    if plot is not None:
        from app.gallery.nyquist import draw_nyquist

        draw_nyquist(loops, model, plot)
    if as_json:
        click.echo(json.dumps([asdict(case) for case in cases], indent=1))
    else:
        _print(cases, model.travel)


def _print(cases: list[Case], travel_in: float) -> None:
    from app.tables import console, new_table

    headings = ("law", "kp\n[psi/in]", "ki\n[psi/(in s)]", "describing\nfunction", "harmonic\nbalance", "measured")
    title = "limit cycle of the stem, peak to peak in % of travel, and period"
    table = new_table(title, headings, left=("law",))
    for case in cases:
        cells = (_cell(found, travel_in) for found in (case.predicted, case.balanced, case.measured))
        table.add_row(case.loop.law, f"{case.loop.kp:g}", f"{case.loop.ki:g}", *cells)
    console().print(table)


def _cell(found: object, travel_in: float) -> str:
    if found is None:
        return "none"
    return f"{200.0 * found.stem_in / travel_in:.1f} %  {found.period_s:.1f} s"  # type: ignore[attr-defined]
