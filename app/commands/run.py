"""Close the loop: hold a sequence of positions with a controller, and record it.

--controller is a name (`--list` shows them), --targets positions in inches, for example "0.1,0.4,0.25", --hold the time
on each. Without --port the virtual valve is controlled, over Modbus frames, in stepped time.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from app.session import bench_options, open_bench, record_options, sealed_option

if TYPE_CHECKING:
    from collections.abc import Sequence

    from app.job import Job
    from app.session import Session
    from control.design import DesignModel
    from control.plan import Plan
    from control.tracking import TargetResult


@click.command(name="run", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.option("--controller", metavar="NAME", help="Controller, by name.")
@click.option("--targets", metavar="X,X,...", help="Positions to hold one after the other [in].")
@click.option("--hold", "hold_s", type=float, default=60.0, show_default=True, metavar="S", help="Time on each [s].")
@click.option("--design", type=click.Path(path_type=Path), help="Design model file.  [default: the thesis's numbers]")
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Change a setting of the controller.")
@click.option("--twin", metavar="MODEL.toml", type=click.Path(path_type=Path), help="Run this model beside the bench.")
@click.option("--period", "period_s", type=float, default=0.1, show_default=True, metavar="S", help="Tick [s].")
@bench_options
@sealed_option
@record_options
@click.option("--list", "list_them", is_flag=True, help="List the controllers and their settings.")
@click.option("--dry-run", is_flag=True, help="Show duration and targets; touch nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print the outcome as JSON.")
def command(
    controller: str | None,
    targets: str | None,
    hold_s: float,
    design: Path | None,
    settings: tuple[str, ...],
    period_s: float,
    list_them: bool,
    dry_run: bool,
    as_json: bool,
    **bench: Any,
) -> None:
    from control.controller import make_controller, parse_settings
    from control.design import DesignModel, load_design
    from control.plan import plan_targets
    from hal.errors import BadInput
    from hal.profile import load_profile

    if list_them:
        _list(as_json)
        return
    if controller is None or targets is None:
        raise BadInput('give a controller and targets, for example: run --controller if_then_pi --targets "0.1,0.4"')
    model = DesignModel() if design is None else load_design(design)
    make_controller(controller, model, **parse_settings(settings))  # a wrong name or setting is said before anything
    found = load_profile(bench["profile"] or "virtual")
    plan = plan_targets(_numbers(targets), hold_s, period_s, found.travel_in)
    if dry_run:
        _preview(plan, controller, as_json)
    else:
        _run(plan, controller, settings, model, as_json, **{**bench, "profile": found})


def _run(
    plan: Plan,
    controller: str,
    settings: tuple[str, ...],
    model: DesignModel,
    as_json: bool,
    *,
    out: Path | None,
    note: str,
    operator: str,
    live: bool,
    seed: int,
    twin: Path | None,
    **bench: Any,
) -> None:
    from app.job import perform
    from app.twin_beside import with_twin
    from control.tracking import judge_targets
    from logs.run import read_run

    with open_bench(seed=seed, **bench) as session:
        job = _job(session, plan, controller, settings, model, {"note": note, "operator": operator, "seed": seed})
        if twin is not None:
            job = with_twin(job, twin, session.bench.info.command_unit)
        _announce(session, plan, controller, as_json)
        done = perform(session, job, out=out, live=live, title=controller)
        travel_in = session.profile.travel_in
    _report(judge_targets(read_run(done.folder), travel_in), done.folder, travel_in, as_json)


def _numbers(text: str) -> list[float]:
    from hal.errors import BadInput

    found = []
    for word in text.replace(";", ",").split(","):
        try:
            found.append(float(word))
        except ValueError as error:
            raise BadInput(f"--targets: {word.strip()!r} is not a position in inches") from error
    return found


def _job(
    session: Session,
    plan: Plan,
    controller: str,
    settings: tuple[str, ...],
    design: DesignModel,
    about: dict[str, object],
) -> Job:
    from dataclasses import asdict

    from app.job import Job
    from control.controller import make_controller, parse_settings
    from control.drive import ControllerDrive
    from control.plan import check_bench

    info = session.bench.info
    check_bench(plan, "psi", info.command_min, info.command_max, info)
    limits: dict[str, float | str] = {"min_psi": info.command_min, "max_psi": info.command_max}
    made = make_controller(controller, design, **{**limits, **parse_settings(settings)})
    about = {
        "controller": {"name": controller, "settings": dict(made.settings)},
        "design": asdict(design),
        "targets_in": [step.end for step in plan.steps],
        "hold_s": plan.steps[0].hold_s,
        **about,
    }
    return Job("run", plan, lambda begun: ControllerDrive(made, plan.period_s, begun), closed_loop=True, about=about)


def _announce(session: Session, plan: Plan, controller: str, as_json: bool) -> None:
    from control.preview import duration_words

    click.echo(
        f"{controller} on {session.title}: {len(plan.steps)} targets, {duration_words(plan.duration_s)}, "
        f"a tick every {plan.period_s:g} s. The valve will move.",
        err=as_json,
    )


def _preview(plan: Plan, controller: str, as_json: bool) -> None:
    from control.preview import duration_words

    targets = [step.end for step in plan.steps]
    if as_json:
        click.echo(json.dumps({"controller": controller, "targets_in": targets, "duration_s": plan.duration_s}))
        return
    words = ", ".join(f"{target:g}" for target in targets)
    click.echo(
        f"{controller}: {len(targets)} targets ({words} in), {duration_words(plan.duration_s)}, "
        f"a tick every {plan.period_s:g} s. Nothing was moved."
    )


def _list(as_json: bool) -> None:
    from control.controller import controller_names, setting_defaults

    names = {name: dict(setting_defaults(name)) for name in controller_names()}
    if as_json:
        click.echo(json.dumps(names))
        return
    for name, defaults in names.items():
        click.echo(f"{name:<22} " + ", ".join(f"{key}={value}" for key, value in defaults.items()))


def _report(results: Sequence[TargetResult], folder: Path, travel_in: float, as_json: bool) -> None:
    from dataclasses import asdict

    if as_json:
        worst = max((abs(r.final_error_in) for r in results), default=float("nan"))
        document = {
            "run": str(folder),
            "targets": [asdict(result) for result in results],
            "worst_final_error_percent": 100.0 * worst / travel_in,
        }
        click.echo(json.dumps(document))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(title="final error = mean over the last quarter of each hold")
    for heading in (
        "target [in]",
        "position [in]",
        "error [in]",
        "error [% of travel]",
        "swing [% of travel]",
        "settled [s]",
    ):
        table.add_column(heading, justify="right")
    for r in results:
        table.add_row(
            f"{r.target_in:.4f}",
            f"{r.final_in:.4f}",
            f"{r.final_error_in:+.4f}",
            f"{100 * r.final_error_in / travel_in:+.2f}",
            f"{100 * r.swing_in / travel_in:.2f}",
            "never" if r.settled_s is None else f"{r.settled_s:.1f}",
        )
    Console().print(table)
    click.echo(f"the valve is at its safe command; record: {folder}")
