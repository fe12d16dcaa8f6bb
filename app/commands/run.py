"""Close the loop: hold a sequence of positions with a controller, and record it.

--controller is a name (`--list` shows them), --targets positions in inches, for example "0.1,0.4,0.25", --hold the time
on each. Without --port the virtual valve is controlled, over Modbus frames, in stepped time. --resume goes on with the
target that a stopped run did not finish.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from app.options import bench_options, profile_of, record_options, sealed_option
from app.session import open_bench

if TYPE_CHECKING:
    from collections.abc import Sequence

    from app.job import Job
    from app.session import Session
    from control.controller import Controller
    from control.design import DesignModel
    from control.plan import Plan
    from hal.bench import BenchInfo
    from hal.profile import Profile


_OF_SLEW = 0.95  # of what the bench allows, that a controller reckons with: a tick may be a little early


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is asked for, as words or as the record of a stopped run says it."""

    controller: str
    settings: Mapping[str, Any]
    design: DesignModel
    plan: Plan
    targets_in: Sequence[float]
    continues: Mapping[str, object] = field(default_factory=dict)


@click.command(name="run", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.option("--controller", metavar="NAME", help="Controller, by name.")
@click.option("--targets", metavar="X,X,...", help="Positions to hold one after the other [in].")
@click.option("--hold", "hold_s", type=float, default=60.0, show_default=True, metavar="S", help="Time on each [s].")
@click.option("--design", type=click.Path(path_type=Path), help="Design model file.  [default: the thesis's numbers]")
@click.option("--set", "settings", metavar="KEY=VALUE", multiple=True, help="Change a setting of the controller.")
@click.option("--twin", metavar="MODEL.toml", type=click.Path(path_type=Path), help="Run this model beside the bench.")
@click.option("--period", "period_s", type=float, default=0.1, show_default=True, metavar="S", help="Tick [s].")
@click.option("--resume", metavar="RUN", type=click.Path(path_type=Path), help="Go on with a run that was stopped.")
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
    resume: Path | None,
    list_them: bool,
    dry_run: bool,
    as_json: bool,
    **bench: Any,
) -> None:
    from app.recordings import bench_design
    from control.controller import parse_settings
    from control.design import DesignModel
    from control.plan import plan_targets
    from hal.errors import BadInput

    if list_them:
        _list(as_json)
        return
    found = profile_of(bench["profile"], bench["physics"])
    if resume is not None:
        wanted = _resumed(resume, found.travel_in)
    elif controller is None or targets is None:
        raise BadInput('give a controller and targets, for example: run --controller if_then_pi --targets "0.1,0.4"')
    else:
        model = DesignModel() if design is None else bench_design(design)
        places = _numbers(targets)
        plan = plan_targets(places, hold_s, period_s, found.travel_in)
        wanted = Wanted(controller, parse_settings(settings), model, plan, places)
    _check(wanted)
    if dry_run:
        _preview(wanted, as_json, found, **{name: bench[name] for name in ("port", "out", "twin")})
    else:
        _run(wanted, as_json, **{**bench, "profile": found})


def _check(wanted: Wanted) -> None:
    """A wrong name or setting is said before anything. Raises: `BadInput`."""
    from control.controller import make_controller

    make_controller(wanted.controller, wanted.design, **wanted.settings)


def _resumed(path: Path, travel_in: float) -> Wanted:
    from app.resume import continues, refuse_given, stopped_run
    from control.design import DesignModel
    from control.plan import plan_targets
    from hal.errors import BadInput

    refuse_given("controller", "targets", "hold_s", "design", "settings", "period_s")
    run, first = stopped_run(path, "run")
    try:
        told: Any = run.start
        name, settings = told["controller"]["name"], dict(told["controller"]["settings"])
        plan = plan_targets(told["targets_in"], told["hold_s"], told["period_s"], travel_in, first)
        design = DesignModel(**told["design"])
    except (KeyError, TypeError) as error:
        raise BadInput(f"{run.path}: its record does not say what is needed to go on ({error})") from error
    for limit in ("min_psi", "max_psi"):  # those of the bench at hand, which may be another one
        settings.pop(limit, None)
    return Wanted(name, settings, design, plan, told["targets_in"], continues(run, first))


def _run(
    wanted: Wanted,
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
    from app.held_targets import report
    from app.job import perform
    from app.targets import check_new_run
    from app.twin_beside import with_twin
    from control.tracking import judge_targets
    from logs.run import read_run

    check_new_run(out)
    with open_bench(seed=seed, **bench) as session:
        job = _job(session, wanted, {"note": note, "operator": operator, "seed": seed})
        if twin is not None:
            job = with_twin(job, twin, session.bench.info.command_unit)
        _announce(session, wanted, as_json)
        done = perform(session, job, out=out, live=live, title=wanted.controller)
        travel_in = session.profile.travel_in
    report(judge_targets(read_run(done.folder), travel_in), done.folder, travel_in, session.bench.where, as_json)


def _numbers(text: str) -> list[float]:
    from hal.errors import BadInput

    found = []
    for word in text.replace(";", ",").split(","):
        try:
            found.append(float(word))
        except ValueError as error:
            raise BadInput(f"--targets: {word.strip()!r} is not a position in inches") from error
    return found


def _fitted(wanted: Wanted, info: BenchInfo, slew: float | None) -> Controller[Any]:
    """The controller within the limits of a bench that can do what is wanted. Raises: `BadInput`."""
    from control.controller import SLEW, make_controller, setting_defaults
    from control.plan import check_bench

    check_bench(wanted.plan, "psi", info.command_min, info.command_max, info)
    limits: dict[str, float | str] = {"min_psi": info.command_min, "max_psi": info.command_max}
    if slew is not None and SLEW in setting_defaults(wanted.controller):
        limits[SLEW] = _OF_SLEW * slew
    return make_controller(wanted.controller, wanted.design, **{**limits, **wanted.settings})


def _job(session: Session, wanted: Wanted, about: dict[str, object]) -> Job:
    from app.job import Job
    from control.drive import ControllerDrive

    plan = wanted.plan
    made = _fitted(wanted, session.bench.info, session.profile.limits.slew_per_s)
    about = {
        "controller": {"name": wanted.controller, "settings": dict(made.settings)},
        "design": wanted.design.to_plain(),
        "targets_in": list(wanted.targets_in),
        "hold_s": plan.steps[0].hold_s,
        **wanted.continues,
        **about,
    }
    return Job("run", plan, lambda begun: ControllerDrive(made, plan.period_s, begun), closed_loop=True, about=about)


def _announce(session: Session, wanted: Wanted, as_json: bool) -> None:
    from control.preview import duration_words

    plan = wanted.plan
    click.echo(
        f"{wanted.controller} on {session.title}: {_counted(len(plan.steps))}, {duration_words(plan.duration_s)}, "
        f"a tick every {plan.period_s:g} s. The valve will move.",
        err=as_json,
    )


def _preview(
    wanted: Wanted, as_json: bool, profile: Profile, *, port: str | None, out: Path | None, twin: Path | None
) -> None:
    from app.dry_run import bench_unopened, check_files
    from app.watchdogs import check_watchdogs
    from control.preview import duration_words

    plan, controller = wanted.plan, wanted.controller
    _fitted(wanted, bench_unopened(profile, port), profile.limits.slew_per_s)
    check_watchdogs(profile, plan.period_s)
    check_files(profile, out, twin)
    targets = [step.end for step in plan.steps]
    if as_json:
        click.echo(json.dumps({"controller": controller, "targets_in": targets, "duration_s": plan.duration_s}))
        return
    words = ", ".join(f"{target:g}" for target in targets)
    click.echo(
        f"{controller}: {_counted(len(targets))} ({words} in), {duration_words(plan.duration_s)}, "
        f"a tick every {plan.period_s:g} s. Nothing was moved."
    )


def _counted(targets: int) -> str:
    return f"{targets} target" + "s" * (targets != 1)


def _list(as_json: bool) -> None:
    from control.controller import controller_names, setting_defaults

    names = {name: dict(setting_defaults(name)) for name in controller_names()}
    if as_json:
        click.echo(json.dumps(names))
        return
    for name, defaults in names.items():
        click.echo(f"{name:<22} " + ", ".join(f"{key}={value}" for key, value in defaults.items()))
