"""Say where the sim-to-real gap lies, which effect causes it, and how far it shrinks once that effect is added."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from app.options import bench_options, profile_of, sealed_option
from app.recordings import DEFAULTS, FROM_RECORD
from app.records import foreign_options

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from control.design import DesignModel
    from logs.recording import DataNote, Recording
    from twin.diagnose import Outcome
    from twin.diagnosis import Diagnosis
    from twin.fit.case import Margin

_NO_DESIGN = "no --design given"
#: What that means.
_WITHOUT_DESIGN = {
    DEFAULTS: "the thesis's numbers are what the record is held against; of another valve, identify a design "
    "first (lostmotion identify RUN... --out model.toml) and give it (--design model.toml)",
    "identified from the healthy recordings": "the gap is what has changed since",
    FROM_RECORD: "the gap is what no numbers of the design can explain; a wrong number cannot show",
}
#: `identify` refuses such a record, since its numbers would not be the valve's; a gap shows in it all the same.
_POSITIONS = "the position is the command, percent for percent, as where a positioner is told positions"


#: Relative standard deviation of numbers that were fitted to the record before its faults were known.
_IDENTIFIED = 0.2


@click.command()
@click.argument("runs", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--design",
    type=click.Path(path_type=Path),
    help="Design model file; without it the thesis's numbers, or the record's own outside of psi and in.",
)
@click.option(
    "--healthy",
    type=click.Path(path_type=Path),
    multiple=True,
    help="Recording of the machine with nothing wrong (may be repeated): what the design misses there is no gap.",
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for diagnosis.json, report, model.")
@foreign_options
@click.option("--active", is_flag=True, help="Run the experiments that tell most on the bench, until it is sure.")
@click.option(
    "--budget-minutes", type=float, default=60.0, show_default=True, metavar="N", help="Bench time of --active [min]."
)
@bench_options
@sealed_option
@click.option("--json", "as_json", is_flag=True, help="Print diagnosis.json to stdout.")
def command(
    runs: tuple[Path, ...],
    design: Path | None,
    healthy: tuple[Path, ...],
    out: Path,
    mapping: str | None,
    units: str | None,
    command_timing: str,
    active: bool,
    budget_minutes: float,
    as_json: bool,
    **bench: Any,
) -> None:
    """Diagnose RUNS (run folders, CSV or Parquet files) of one bench against a design model.

    With --active it goes on by itself: the experiment that best separates what is still confused is run on the bench
    (without --port: on the virtual valve) and diagnosed together with RUNS, which may then be left out.
    """
    from app.recordings import load_all
    from app.stoppable import stoppable
    from app.targets import check_folder
    from control.design import load_design
    from hal.errors import BadInput
    from twin.files import FILES

    if not runs and not active:
        raise BadInput("name a run to diagnose, or let --active make one: diagnose RUN... --out DIR")
    if not active and any(value for name, value in bench.items() if name != "seed"):
        raise BadInput("options that choose a bench need --active: without it nothing but files is touched")
    check_folder("--out", out, (*runs, *healthy, design), writes=FILES)
    if design is not None:
        load_design(design)  # a file that is no design is told at once, and leaves nothing
    with stoppable(out):
        recordings, golden = (load_all(paths, mapping, units, command_timing) for paths in (runs, healthy))
        if active:
            outcome = _pursued(recordings, golden, design, out, budget_minutes, bench)
        else:
            outcome = _diagnosed(recordings, golden, design, out)
    _print(outcome, out, as_json)


def _diagnosed(recordings: Sequence[Recording], golden: Sequence[Recording], design: Path | None, out: Path) -> Outcome:
    """Diagnoses and writes everything into `out`."""
    from app.progress import diagnosis_progress
    from app.recordings import design_for, without_design
    from twin.diagnose import Settings, diagnose
    from twin.judge.partial import Interrupted
    from twin.model.insert import inserted_from
    from twin.ready.identified import better_identified
    from twin.write import write_outcome

    outcome = None
    if design is None:
        recordings, golden, model, origin = without_design(recordings, golden)
    else:
        model, origin = design_for(design, recordings, golden)
    margin, known = _margin(golden, model)
    said = known if design else (*_without_design(origin, model, golden or recordings), *known)
    recordings = [replace(one, notes=(*one.notes, *said)) if k == 0 else one for k, one in enumerate(recordings)]
    try:
        with diagnosis_progress() as progress:
            identified = origin.startswith(FROM_RECORD)
            settings = Settings(margin=margin)
            settings = replace(settings, doubt=_IDENTIFIED) if identified else settings
            outcome = diagnose(recordings, model, inserted_from(model), settings, progress)
            named = [cause.name for cause in outcome.diagnosis.causes]
            if identified and (better := better_identified(named, outcome.model)) is not None:
                outcome = diagnose(recordings, better, (), settings, progress)
            write_outcome(outcome, out, progress)
    except Interrupted as stop:
        _leave(stop.diagnosis, model, out)
        raise
    except KeyboardInterrupt:
        if outcome is not None and (out / "model.toml").is_file():
            click.echo(f"Interrupted at the pictures; {out / 'diagnosis.json'} and model.toml beside it are complete.")
        raise
    return outcome


def _without_design(origin: str, model: DesignModel, records: Sequence[Recording]) -> Iterator[DataNote]:
    """What to say where no design was given: where it is from, and whether it is the valve's alone."""
    from control.identify_checks import told_positions
    from logs.recording import DataNote

    identified = origin.startswith(FROM_RECORD)
    means = _WITHOUT_DESIGN.get(FROM_RECORD if identified else origin, "")
    if identified:
        deadband = model.spoken.text(model.deadband, model.pressure_unit, 3)
        means += f"; a deadband of {deadband}, be it play or friction, is in the design"
    yield DataNote(f"{_NO_DESIGN}: {origin}", means)
    if told_positions(model, records):
        yield DataNote(
            _POSITIONS, "what is diagnosed is valve and positioner together, and no number is the valve's alone"
        )


def _margin(golden: Sequence[Recording], model: DesignModel) -> tuple[Margin, tuple[DataNote, ...]]:
    """What the design misses on the healthy machine anyway, and what to say of it."""
    from logs.recording import DataNote
    from twin.fit.case import Margin
    from twin.model.insert import plant_of
    from twin.ready.healthy import healthy_margin

    if not golden:
        return Margin(), ()
    margin = healthy_margin(golden, plant_of(model))
    what = f"the design misses the healthy machine by {100.0 * margin.position / model.travel:.2g} % of travel"
    pressure = f" and {model.spoken.text(margin.pressure, model.pressure_unit, 2)}" if margin.pressure else ""
    return margin, (DataNote(f"{what}{pressure} RMS", "a cause has to explain more than that"),)


def _leave(diagnosis: Diagnosis, model: DesignModel, out: Path) -> None:
    """What was known when Ctrl-C came, and the design as it was given."""
    from twin.write import write_known

    write_known(diagnosis, model, out)
    click.echo(diagnosis.statement)
    click.echo(f"What is known so far: {out / 'diagnosis.json'}")


def _pursued(
    recordings: list[Recording],
    golden: Sequence[Recording],
    design: Path | None,
    out: Path,
    budget_minutes: float,
    bench: dict[str, Any],
) -> Outcome:
    """The circle of diagnosis and experiment; every round is written, so that a stop leaves what is known."""
    import json
    from dataclasses import asdict

    from app.active import Round, first_experiment, pursue, runner

    found = profile_of(bench["profile"], bench["physics"])
    first = None if recordings else first_experiment(found.command_unit, budget_minutes)

    def tell(last: Round) -> None:
        causes = ", ".join(f"{name} {p:.2f}" for name, p in last.causes) or "no cause named"
        click.echo(
            f"round {last.number}, {last.bench_minutes:.1f} min on the bench: {last.verdict}: {causes}", err=True
        )
        for names in last.confusable:
            click.echo(f"  still confused: {', '.join(names)}", err=True)
        click.echo(f"  next: {last.next}", err=True)

    with runner(out, **{**bench, "profile": found}) as run:
        pursuit = pursue(
            recordings,
            first,
            budget_minutes,
            run,
            lambda known: _diagnosed(known, golden, design, out),
            tell,
        )
    document = {"why": pursuit.why, "rounds": [asdict(one) for one in pursuit.rounds]}
    (out / "rounds.json").write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    count = len(pursuit.rounds)
    click.echo(f"stopped after {count} round{'s' if count > 1 else ''}: {pursuit.why}", err=True)
    return pursuit.outcome


def _print(outcome: Outcome, out: Path, as_json: bool) -> None:
    import json

    if as_json:
        click.echo(json.dumps(outcome.diagnosis.to_json(), indent=2))
        return
    click.echo(outcome.diagnosis.statement)
    for note in outcome.diagnosis.data_quality:
        if note.what.startswith((_NO_DESIGN, _POSITIONS)):
            click.echo(f"Mind: {note.what}; {note.handled}.")
    for names in outcome.diagnosis.confusable:
        click.echo(f"This data cannot tell apart: {', '.join(names)}.")
    proposed = outcome.diagnosis.next_experiment
    if proposed is not None:
        how = f" Run it: lostmotion sweep {shlex.quote(str(out / proposed.file))}" if proposed.file else ""
        click.echo(f"Next: {proposed.why}{how}")
    click.echo(f"Report: {out / 'report.html'}; view: {out / 'diagnosis.rrd'}; updated model: {out / 'model.toml'}")
