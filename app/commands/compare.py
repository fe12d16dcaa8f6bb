"""Run controllers over the standard scenarios on the virtual valve and compare them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

    from control.compare import Result

COLUMNS = (
    ("steady_worst", "worst steady error", "%", 2),
    ("later_worst", "without the\nfirst hold", "%", 2),
    ("steady_median", "median", "%", 2),
    ("steady_spread", "over seeds", "%", 2),
    ("peak_worst", "worst moment", "%", 2),
    ("settling_s", "settling", "s", 1),
    ("ratio", "x floor", "", 2),
    ("close", "within 1.2", "share", 2),
    ("unsettled", "unsettled", "share", 2),
    ("overshoot", "overshoot", "%", 1),
    ("limit_cycles", "cycling", "share", 2),
    ("stem_in", "stem travel", "in", 1),
    ("air_psi", "air", "psi", 0),
)


@click.command(name="compare")
@click.option("--controllers", "-c", default="", help="Names with commas between.  [default: all]")
@click.option("--scenarios", "-s", default="", help="Names with commas between.  [default: all]")
@click.option("--seeds", type=click.IntRange(1), default=2, show_default=True, help="Repeats with other chance.")
@click.option("--first-seed", type=click.IntRange(0), help="Where they begin.  [default: 0, with --held-out 8000]")
@click.option("--held-out", is_flag=True, help="Other sizes and targets than those the controllers were tuned on.")
@click.option("--period", type=click.FloatRange(0.02, 0.5), default=0.1, show_default=True, help="Tick [s].")
@click.option("--design", type=click.Path(path_type=Path, dir_okay=False), help="What the controllers know (TOML).")
@click.option("--processes", type=click.IntRange(1), default=2, show_default=True, help="Side by side.")
@click.option("--detail", default="steady", show_default=True, help="Score shown per scenario.")
@click.option("--plot", type=click.Path(path_type=Path, dir_okay=False), help="Draw the table (PNG or SVG).")
@click.option("--json", "as_json", is_flag=True, help="Every trial, for scripts.")
def command(
    controllers: str,
    scenarios: str,
    seeds: int,
    first_seed: int | None,
    held_out: bool,
    period: float,
    design: Path | None,
    processes: int,
    detail: str,
    plot: Path | None,
    as_json: bool,
) -> None:
    """Run controllers over the standard scenarios on the virtual valve and compare them.

    Errors are in percent of travel on the true stem, in the last quarter of every hold; "x floor" is the median
    settling time (to 0.5 %) over the time in which no controller can be faster, "within 1.2" the share of steps that
    settle within 1.2 times that. The controllers were tuned on seeds below 10 without --held-out.
    """
    from dataclasses import fields

    from app.fit_picture import check_target
    from app.options import listed
    from app.progress import counted
    from app.recordings import bench_design
    from app.rivals import run_all
    from control.compare import as_json as everything
    from control.compare import jobs
    from control.controller import controller_class, controller_names
    from control.design import DesignModel
    from control.held_out import FIRST_SEED
    from control.metrics import Score
    from control.scenarios import chosen_scenarios
    from hal.errors import BadInput

    names = listed(controllers) or controller_names()
    for name in names:
        controller_class(name)
    if detail not in {f.name for f in fields(Score)}:
        raise BadInput(f"--detail {detail!r} is not a score; choose from {', '.join(f.name for f in fields(Score))}")
    chosen = [s.name for s in chosen_scenarios(listed(scenarios))]
    first = first_seed if first_seed is not None else FIRST_SEED if held_out else 0
    known = bench_design(design) if design else DesignModel()
    if plot is not None:
        check_target(plot, (design,))
    todo = jobs(names, chosen, range(first, first + seeds), period, known, held_out)
    results = counted(run_all(todo, processes), len(todo), f"{len(todo)} trials")
    if plot is not None:
        from app.gallery.rivals import draw_comparison

        draw_comparison(results, detail, plot)
    if as_json:
        click.echo(json.dumps(everything(results), indent=1))
    else:
        drawn = "sizes and targets drawn, held out" if held_out else "sizes and targets as the scenarios name them"
        _print(results, detail, f"over all scenarios, seeds {first} to {first + seeds - 1}, {drawn}")


def _print(results: Sequence[Result], detail: str, title: str) -> None:
    from app.tables import console, new_table
    from control.compare import by_scenario, summary

    headings = [f"{head}\n[{unit}]" if unit else head for _, head, unit, _ in COLUMNS]
    table = new_table(title, ("controller", *headings), left=("controller",))
    rows = summary(results)
    for name in sorted(rows, key=lambda n: rows[n]["steady_worst"]):
        table.add_row(name, *(f"{rows[name][key]:.{digits}f}" for key, _, _, digits in COLUMNS))
    console().print(table)
    click.echo("\n".join(_goal(results)))
    details = by_scenario(results, detail)
    names = [name.replace("_", "\n") for name in details]
    wide = new_table(f"{detail} by scenario, median over seeds (spread)", ("scenario", *names), left=("scenario",))
    for scenario in next(iter(details.values())):
        cells = (f"{row[scenario][0]:.2f}\n({row[scenario][1]:.2f})" for row in details.values())
        wide.add_row(scenario, *cells)
    console().print(wide)
    click.echo(_permitted(results))


def _goal(results: Sequence[Result]) -> list[str]:
    """How many trials reach the goal, with 95 % intervals (Wilson's)."""
    from app.interval import share
    from control.metrics import GOAL_PERCENT

    lines = []
    for name in dict.fromkeys(r.job.controller for r in results):
        mine = [r.score for r in results if r.job.controller == name]
        near, still = share([s.steady <= GOAL_PERCENT for s in mine]), share([s.cycle == 0.0 for s in mine])
        lines.append(f"{name}: {near} of {len(mine)} trials within {GOAL_PERCENT} %, {still} without a limit cycle")
    return lines


def _permitted(results: Sequence[Result]) -> str:
    """What gauge and supply permit, by the numbers of the scenarios as played."""
    from control.compare import true_valve
    from control.permitted import least_error_percent, reaches

    played = {(r.job.scenario, r.job.seed): (r.job.asked, r.job.period_s) for r in results}.values()
    rests = (0.25 * min(part.duration_s for part in asked.segments if part.is_hold) for asked, _ in played)
    least = max(least_error_percent(asked, rest, tick) for (asked, tick), rest in zip(played, rests, strict=True))
    short = sorted({asked.name for asked, _ in played if not reaches(asked, true_valve(asked))})
    supply = f"the supply is too low for {', '.join(short)}" if short else "the supply reaches every target"
    return f"permitted by the bench: the gauge tells the stem to {least:.2f} % in the last quarter of a hold; {supply}"
