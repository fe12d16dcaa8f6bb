"""Derive controller numbers from an identified model and say what margins they leave."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from control.tune import Margins, Tuned


@click.command(name="tune")
@click.argument("model", required=False, type=click.Path(path_type=Path, dir_okay=False))
@click.option("--period", type=click.FloatRange(0.01, 1.0), default=0.1, show_default=True, help="Tick [s].")
@click.option("--dead-time", type=click.FloatRange(0.0, 5.0), default=0.0, show_default=True, help="Known one [s].")
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def command(model: Path | None, period: float, dead_time: float, as_json: bool) -> None:
    """Derive controller numbers from an identified model and say what margins they leave.

    MODEL is a design model file, as `lostmotion identify` writes it; without one, the thesis's numbers.
    """
    from control.design import DesignModel, load_design
    from control.tune import tune

    tuned = tune(load_design(model) if model else DesignModel(), period, dead_time)
    if as_json:
        click.echo(json.dumps({t.controller: _plain(t) for t in tuned}, indent=1))
        return
    _print(tuned, f"for {model or 'the numbers of the thesis'}, one tick every {period:g} s")


def _plain(tuned: Tuned) -> dict[str, object]:
    left = tuned.margins
    return {
        "settings": tuned.settings,
        "margins": None
        if left is None
        else {"gain": _finite(left.gain), "delay_s": _finite(left.delay_s), "phase_deg": _finite(left.phase_deg)},
        "why": tuned.why,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _print(tuned: list[Tuned], title: str) -> None:
    from app.tables import console, new_table

    headings = ("controller", "settings", "gain margin", "delay margin", "phase margin", "why")
    table = new_table(title, headings, left=headings)
    for t in tuned:
        settings = " ".join(f"{key}={value:g}" for key, value in t.settings.items())
        table.add_row(t.controller, settings, *_margin_cells(t.margins), t.why)
    console().print(table)
    click.echo("Use them: lostmotion run --controller NAME --set key=value ...")


def _margin_cells(left: Margins | None) -> tuple[str, str, str]:
    if left is None:
        return "-", "-", "-"
    gain = f"x {left.gain:.2f}" if math.isfinite(left.gain) else "> 50"
    delay = f"{left.delay_s:.2f} s" if math.isfinite(left.delay_s) else "> 20 s"
    phase = f"{left.phase_deg:.0f} deg" if math.isfinite(left.phase_deg) else "no crossover"
    return gain, delay, phase
