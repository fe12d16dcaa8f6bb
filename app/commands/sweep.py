"""Run an experiment on the valve and record it: KIND, or an experiment file.

KIND is one of staircase, nested, ramp, steps, random, multisine, hold, points; FILE.toml is an experiment file
(docs/experiments.md). Without --port the virtual valve is swept, over Modbus frames, in stepped time.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from app.options import bench_options, profile_of, record_options, sealed_option
from app.session import open_bench
from hal.counted import counted

if TYPE_CHECKING:
    from app.job import Job
    from app.session import Session
    from control.experiment import Experiment
    from hal.profile import Profile


@click.command(name="sweep", help=__doc__, short_help=(__doc__ or "").partition("\n")[0])
@click.argument("what", metavar="KIND|FILE.toml", required=False)
@bench_options
@sealed_option
@record_options
@click.option(
    "--set",
    "settings",
    metavar="KEY=VALUE",
    multiple=True,
    help="Change a number of the experiment; --write shows all of them.",
)
@click.option("--period", "period_s", type=float, metavar="S", help="Time between two samples [s].")
@click.option("--resume", metavar="RUN", type=click.Path(path_type=Path), help="Go on with a sweep that was stopped.")
@click.option(
    "--write",
    "write_to",
    metavar="FILE.toml",
    type=click.Path(path_type=Path),
    help="Only write the experiment's file.",
)
@click.option("--dry-run", is_flag=True, help="Show duration, range and a sketch; touch nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print the outcome as JSON.")
def command(
    what: str | None,
    settings: tuple[str, ...],
    period_s: float | None,
    resume: Path | None,
    write_to: Path | None,
    dry_run: bool,
    as_json: bool,
    **bench: Any,
) -> None:
    from app.targets import check_file
    from control.experiment_file import save_experiment

    found = profile_of(bench["profile"], bench["physics"])
    experiment, first, continues = _experiment(what, resume, settings, bench["seed"], found.command_unit)
    if period_s is not None:
        experiment = replace(experiment, period_s=period_s)
    if write_to is not None:
        check_file("--write", write_to, (Path(what or ""), resume))
        save_experiment(experiment, write_to)
        click.echo(f"wrote {write_to}")
    elif dry_run:
        _preview(experiment, first, as_json, found, bench["port"], bench["out"])
    else:
        _sweep(experiment, first, continues, as_json, **{**bench, "profile": found})


def _sweep(
    experiment: Experiment,
    first: int,
    continues: dict[str, object],
    as_json: bool,
    *,
    out: Path | None,
    note: str,
    operator: str,
    live: bool,
    seed: int,
    **bench: Any,
) -> None:
    from app.job import perform
    from app.targets import check_new_run

    check_new_run(out)
    with open_bench(seed=seed, **bench) as session:
        job = _job(session, experiment, first, {"note": note, "operator": operator, "seed": seed, **continues})
        _announce(session, experiment, job, as_json)
        done = perform(session, job, out=out, live=live, title=experiment.kind)
    if as_json:
        click.echo(json.dumps({"run": str(done.folder), **_plain(done.outcome)}))
        return
    click.echo(
        f"done: {counted(done.outcome.rows, 'sample')}, {done.outcome.missing} missing, "
        f"{counted(done.outcome.overruns, 'overrun')}, "
        f"worst lateness {done.outcome.worst_lateness_s * 1e3:.2f} ms; {session.bench.where}"
    )
    click.echo(f"record: {done.folder}")


def _plain(outcome: object) -> dict[str, object]:
    from dataclasses import asdict

    return asdict(outcome)  # type: ignore[call-overload, no-any-return]


def _experiment(
    what: str | None, resume: Path | None, settings: tuple[str, ...], seed: int, unit: str
) -> tuple[Experiment, int, dict[str, object]]:
    """The experiment, the step it begins with, and what the record says about the run it continues."""
    from control.experiment_catalog import make_experiment, parse_settings
    from control.experiment_file import from_plain, load_experiment, to_plain
    from hal.errors import BadInput

    if what is not None and resume is not None:
        raise BadInput(f"{what} and --resume exclude each other: a run goes on with its own experiment; name one")
    if what is None and resume is None:
        raise BadInput("name an experiment kind or file, or a run to go on with: sweep KIND|FILE.toml, or --resume RUN")
    given = parse_settings(settings)
    if resume is not None:
        if given:
            raise BadInput("--resume goes on with the experiment of that run as it is; leave out --set")
        return _resumed(resume)
    assert what is not None
    if what.endswith(".toml"):
        loaded = to_plain(load_experiment(Path(what)))
        return from_plain({**loaded, **given}, what), 0, {}
    _refuse_path(what)
    return make_experiment(what, {"unit": unit, "seed": seed, **given}), 0, {}


def _refuse_path(what: str) -> None:
    """Raises: `BadInput` for something that is there and is no experiment: a recording, most likely."""
    from control.experiment_catalog import experiment_kinds
    from hal.errors import BadInput

    path = Path(what)
    if path.exists() and what not in experiment_kinds():
        raise BadInput(
            f"{path} is a {'folder' if path.is_dir() else 'file'} but no experiment; sweep takes a kind "
            f"({', '.join(experiment_kinds())}) or an experiment file that ends in .toml"
            + ("; a run that was stopped goes on with --resume" if path.is_dir() else "")
        )


def _resumed(path: Path) -> tuple[Experiment, int, dict[str, object]]:
    from app.resume import continues, stopped_run
    from control.experiment_file import from_plain
    from hal.errors import BadInput

    run, first = stopped_run(path, "sweep")
    content = run.start.get("experiment")
    if not isinstance(content, dict):
        raise BadInput(f"{run.path}: its record has no experiment to go on with")
    return from_plain(content, str(run.path)), first, continues(run, first)


def _job(session: Session, experiment: Experiment, first: int, about: dict[str, object]) -> Job:
    from app.job import Job
    from control.drive import OpenLoopDrive
    from control.experiment_file import to_plain
    from control.plan import check_bench, plan_experiment

    plan = plan_experiment(experiment, first)
    check_bench(plan, experiment.unit, *experiment.range, session.bench.info)
    note = about.pop("note") or experiment.note
    return Job(
        "sweep", plan, lambda _: OpenLoopDrive(), about={"experiment": to_plain(experiment), "note": note, **about}
    )


def _announce(session: Session, experiment: Experiment, job: Job, as_json: bool) -> None:
    from control.preview import duration_words

    low, high = experiment.range
    longest = "at most " if experiment.until_settled else ""
    click.echo(
        f"{experiment.kind} on {session.title}: {longest}{duration_words(job.plan.duration_s)}, "
        f"commands {low:g} to {high:g} {experiment.unit} every {experiment.period_s:g} s. The valve will move.",
        err=as_json,
    )


def _preview(
    experiment: Experiment, first: int, as_json: bool, profile: Profile, port: str | None, out: Path | None
) -> None:
    from app.dry_run import bench_unopened, check_files
    from app.watchdogs import check_watchdogs
    from control.plan import check_bench, plan_experiment
    from control.preview import duration_words, with_scale

    plan = plan_experiment(experiment, first)
    check_bench(plan, experiment.unit, *experiment.range, bench_unopened(profile, port))
    check_watchdogs(profile, plan.period_s)
    check_files(profile, out)
    schedule = experiment.commands()
    low, high = experiment.range
    samples = round(plan.duration_s / experiment.period_s)
    facts = {
        "kind": experiment.kind,
        "duration_s": plan.duration_s,
        "low": low,
        "high": high,
        "unit": experiment.unit,
        "steps": len(plan.steps),
        "first_step": first,
        "samples": samples,
        "period_s": experiment.period_s,
    }
    if as_json:
        click.echo(json.dumps(facts))
        return
    longest = "at most " if experiment.until_settled else ""
    click.echo(
        f"{experiment.kind}: {longest}{duration_words(plan.duration_s)}, {low:g} to {high:g} {experiment.unit}, "
        f"{counted(len(plan.steps), 'step')}, {counted(samples, 'sample')}, one every {experiment.period_s:g} s. "
        "Nothing was moved."
    )
    for line in with_scale(schedule.command, experiment.unit):
        click.echo(line)
