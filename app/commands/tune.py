"""Derive controller numbers from an identified model and say what margins they leave."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from app.robustness import Job
    from control.robustness import Margin, Nominal
    from control.tune import Tuned

Answers = dict[str, dict[str, "Nominal | Margin"]]


@click.command(name="tune")
@click.argument("model", required=False, type=click.Path(path_type=Path, dir_okay=False))
@click.option("--margins", is_flag=True, help="Measure how far the valve may be off, for every controller; minutes.")
@click.option("--controllers", "-c", default="", help="Names with commas between.  [default: all]")
@click.option("--seeds", type=click.IntRange(1), default=1, show_default=True, help="Repeats with other noise.")
@click.option("--period", type=click.FloatRange(0.01, 1.0), default=0.1, show_default=True, help="Tick [s].")
@click.option("--dead-time", type=click.FloatRange(0.0, 5.0), default=0.0, show_default=True, help="Known one [s].")
@click.option("--processes", type=click.IntRange(1), default=2, show_default=True, help="Side by side.")
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def command(
    model: Path | None,
    margins: bool,
    controllers: str,
    seeds: int,
    period: float,
    dead_time: float,
    processes: int,
    as_json: bool,
) -> None:
    """Derive controller numbers from an identified model and say what margins they leave.

    MODEL is a design model file, as `lostmotion identify` writes it; without one, the thesis's numbers. Predicted
    margins are the describing function's, the others are measured on a virtual valve with the model's numbers; those
    of --margins by the criterion of `compare` for limit cycles.
    """
    from app.options import listed
    from app.recordings import bench_design
    from app.robustness import jobs
    from control.controller import controller_class
    from control.design import DesignModel
    from control.robustness import Plant, Subject
    from control.tune import tune

    design = bench_design(model) if model else DesignModel()
    names = listed(controllers)
    for name in names:
        controller_class(name)
    tuned = [t for t in tune(design, period, dead_time) if not names or t.controller in names]
    subjects = [Subject(t.controller, t.settings, design, period) for t in tuned]
    answers = _measure(jobs(subjects, Plant(design, dead_time), seeds, margins), processes)
    if as_json:
        click.echo(json.dumps(_plain(tuned, answers, margins), indent=1))
    else:
        _print(tuned, answers, f"for {model or 'the numbers of the thesis'}, one tick every {period:g} s")
        _print_margins(tuned, answers, margins, seeds)


def _measure(todo: Sequence[Job], processes: int) -> Answers:
    from app.progress import counted
    from app.robustness import run_all

    answers = Answers()
    for job, answer in zip(todo, counted(run_all(todo, processes), len(todo), "measuring"), strict=True):
        answers.setdefault(job.subject.name, {})[job.kind] = answer
    return answers


def _advice(answers: Mapping[str, Mapping[str, Any]], everything: bool) -> tuple[str | None, str]:
    from control.robustness import recommended

    as_designed = {name: each["nominal"] for name, each in answers.items()}
    return recommended(as_designed, answers if everything else None)


def _plain(tuned: Sequence[Tuned], answers: Answers, everything: bool) -> dict[str, object]:
    rows: dict[str, object] = {}
    for t in tuned:
        predicted = None if t.margins is None else {key: _finite(v) for key, v in asdict(t.margins).items()}
        kinds = {kind: asdict(found) for kind, found in answers[t.controller].items()}
        as_designed = {key: _finite(value) for key, value in kinds.pop("nominal").items()}
        rows[t.controller] = {
            "settings": t.settings,
            "predicted": predicted,
            "as_designed": as_designed,
            "measured": kinds,
            "why": t.why,
        }
    best, why = _advice(answers, everything)
    return {"controllers": rows, "recommended": {"controller": best, "why": why}}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _print(tuned: Sequence[Tuned], answers: Answers, title: str) -> None:
    from app.tables import console, new_table

    left = ("controller", "settings", "why")
    pairs = ("gain x\npredicted", "\nmeasured", "dead time [s]\npredicted", "\nmeasured", "late reading [s]\npredicted")
    headings = (*left[:2], "error\n[%]", "settling\n[s]", *pairs, "\nmeasured ", "phase\n[deg]", left[2])
    table = new_table(title, headings, left=left)
    for t in tuned:
        mine: Any = answers[t.controller]
        as_designed = mine["nominal"]
        settings = " ".join(f"{key}={value:g}" for key, value in t.settings.items())
        settles = f"{as_designed.settling_s:.1f}" if math.isfinite(as_designed.settling_s) else "never"
        error = f"{as_designed.error:.1f}" + (", hunts" if as_designed.cycle else "")
        table.add_row(t.controller, settings, error, settles, *_pairs(t, mine), t.why)
    console(width=220).print(table)
    click.echo(
        "error, settling: worst hold of 25, 75 and 50 % on the valve as designed; predicted: describing function;"
    )
    click.echo("measured: good | hunts, a swing that lasts after a step of 0.6 travels, as in lostmotion analyse")
    click.echo("Use them: lostmotion run --controller NAME --set key=value ...")


def _pairs(t: Tuned, mine: Mapping[str, Any]) -> list[str]:
    if t.margins is None:
        return ["-"] * 7
    m = t.margins
    cells = []
    for predicted, most, kind in (
        (m.gain, 50, "lasting_gain"),
        (m.delay_s, 20, "lasting_dead_time"),
        (m.late_s, 20, "lasting_late"),
    ):
        cells += [f"{predicted:.2f}" if math.isfinite(predicted) else f"> {most}", span(mine[kind])]
    return [*cells, f"{m.phase_deg:.0f}" if math.isfinite(m.phase_deg) else "-"]


def _print_margins(tuned: Sequence[Tuned], answers: Answers, everything: bool, seeds: int) -> None:
    from app.tables import console, new_table
    from control.robustness import AXES

    if everything:
        headings = ("controller", *(axis.heading for axis in AXES.values()))
        many = f"{seeds} seed{'s' if seeds > 1 else ''}"
        title = f"the last value without a limit cycle | the first with one, and its swing in % of travel; {many}"
        table = new_table(title, headings, left=("controller",))
        for t in tuned:
            mine: Any = answers[t.controller]
            cycle = mine["nominal"].cycle
            table.add_row(
                t.controller, *(f"hunts\n{cycle:.1f} %" if cycle else span_and_swing(mine[key]) for key in AXES)
            )
        console().print(table)
    best, why = _advice(answers, everything)
    click.echo(f"recommended: {best or 'none'}; {why}" + ("" if everything else "; --margins measures the others"))


def span(margin: Margin) -> str:
    """`0.3 | 0.4`: good at 0.3, hunts at 0.4; `at 0.1`: at the first value; `none to 3`: nowhere."""
    if margin.bad is None:
        return f"none to {margin.good:g}"
    return f"at {margin.bad:g}" if margin.good is None else f"{margin.good:g} | {margin.bad:g}"


def span_and_swing(margin: Margin) -> str:
    """The same with the size of that first limit cycle."""
    return span(margin) + (f"\n{margin.swing:.1f} %" if margin.bad is not None else "")
