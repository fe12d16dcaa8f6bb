"""Closes the circle of diagnosis and experiment: diagnose, run what would tell most, diagnose again, until it is sure.

`pursue` knows neither bench nor diagnosis: it is handed one function that runs an experiment and one that diagnoses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from click import echo

if TYPE_CHECKING:
    from app.session import Session
    from control.experiment import Experiment
    from logs.recording import Recording
    from twin.diagnose import Outcome


@dataclass(frozen=True, slots=True)
class Round:
    """One diagnosis of the circle: after how many minutes on the bench, on how many records, and what it said."""

    number: int
    bench_minutes: float
    records: int
    verdict: str
    causes: tuple[tuple[str, float], ...]
    confusable: tuple[tuple[str, ...], ...]
    next: str


@dataclass(frozen=True, slots=True)
class Pursuit:
    """How it ended: `why` it stopped, the last diagnosis, all rounds."""

    why: str
    outcome: Outcome
    rounds: tuple[Round, ...]


def pursue(
    recordings: Sequence[Recording],
    first: Experiment | None,
    budget_minutes: float,
    run: Callable[[Experiment], Recording],
    diagnose: Callable[[Sequence[Recording]], Outcome],
    tell: Callable[[Round], None],
) -> Pursuit:
    """Goes round until the diagnosis is sure, no experiment would help, or the bench time is used up.

    `first` is run before anything is diagnosed; None where `recordings` are there already. `run` makes a
    record of an experiment, `tell` hears of each round as it is over.
    Raises: `BadInput` when not even the first experiment fits the budget.
    """
    known = list(recordings)
    spent, done, rounds = 0.0, list[str](), list[Round]()
    if first is not None:
        spent = _minutes(first, budget_minutes)
        known.append(run(first))
    while True:
        outcome = diagnose(known)
        rounds.append(_round(len(rounds) + 1, spent, len(known), outcome))
        tell(rounds[-1])
        text = outcome.next_file
        if is_sure(rounds[-1]):
            return Pursuit("it is sure", outcome, tuple(rounds))
        if text is None:
            return Pursuit(f"no experiment would tell more. {rounds[-1].next}".strip(), outcome, tuple(rounds))
        if done.count(text):
            return Pursuit("the experiment that it asks for has been made", outcome, tuple(rounds))
        experiment = experiment_of(text)
        minutes = experiment.duration_s / 60.0
        if spent + minutes > budget_minutes:
            why = f"the next experiment takes {minutes:.1f} min, and {budget_minutes - spent:.1f} min are left"
            return Pursuit(why, outcome, tuple(rounds))
        known.append(run(experiment))
        done.append(text)
        spent += minutes


def is_sure(last: Round) -> bool:
    """Whether causes are named, each beyond dispute, and none could be another."""
    from twin.next.rivals import SURE

    return bool(last.causes) and not last.confusable and min(p for _, p in last.causes) > SURE


def experiment_of(text: str) -> Experiment:
    """The experiment that a proposal's TOML text describes."""
    import tomllib

    from control.experiment_file import from_plain

    return from_plain(tomllib.loads(text), "next.toml")


def first_experiment(unit: str, budget_minutes: float) -> Experiment:
    """What a circle without records begins with: the nested sweep, or something shorter where time is short.

    Raises: `BadInput` when the budget allows neither.
    """
    from control.experiment_catalog import make_experiment
    from hal.errors import BadInput

    for kind, settings in (("nested", {}), ("random", {"count": 40, "dwell_max_s": 12.0}), ("random", {"count": 15})):
        experiment = make_experiment(kind, {"unit": unit, **settings})
        if experiment.duration_s <= 60.0 * budget_minutes:
            return experiment
    raise BadInput(
        f"--budget-minutes {budget_minutes:g} is too short: the shortest first experiment takes "
        f"{experiment.duration_s / 60.0:.1f} min"
    )


@contextmanager
def runner(out: Path, **bench: Any) -> Iterator[Callable[[Experiment], Recording]]:
    """Gives a function that runs an experiment on the bench and records it in the next free `out`/run-N.

    A virtual valve lives from the first experiment to the last; a real bench is let go of while it is diagnosed.
    """
    from app.session import open_bench

    if bench.get("port") is not None:

        def run_there(experiment: Experiment) -> Recording:
            with open_bench(**bench) as session:
                return _recorded(session, experiment, _free(out))

        yield run_there
        return
    with open_bench(**bench) as session:
        yield lambda experiment: _recorded(session, experiment, _free(out))


def _free(out: Path) -> Path:
    """The first of run-1, run-2, ... that is not there yet."""
    return next(folder for n in count(1) if not (folder := out / f"run-{n}").exists())


def _recorded(session: Session, experiment: Experiment, folder: Path) -> Recording:
    from app.job import Job, perform
    from control.drive import OpenLoopDrive
    from control.experiment_file import to_plain
    from control.plan import check_bench, plan_experiment
    from control.preview import duration_words
    from logs.load import load_recording

    plan = plan_experiment(experiment)
    low, high = experiment.range
    check_bench(plan, experiment.unit, low, high, session.bench.info)
    echo(
        f"{experiment.kind} on {session.title}: {duration_words(plan.duration_s)}, commands {low:g} to {high:g} "
        f"{experiment.unit}. The valve will move.",
        err=True,
    )
    about = {"experiment": to_plain(experiment), "note": experiment.note or "diagnose --active"}
    job = Job("sweep", plan, lambda _: OpenLoopDrive(), about=about)
    done = perform(session, job, out=folder, live=False, title=experiment.kind)
    return load_recording(done.folder)


def _minutes(first: Experiment, budget_minutes: float) -> float:
    from hal.errors import BadInput

    minutes = first.duration_s / 60.0
    if minutes > budget_minutes:
        raise BadInput(f"the first experiment takes {minutes:.1f} min, --budget-minutes is {budget_minutes:g}")
    return minutes


def _round(number: int, spent: float, records: int, outcome: Outcome) -> Round:
    said = outcome.diagnosis
    causes = tuple((cause.name, cause.probability) for cause in said.causes)
    next_ = said.next_experiment.why if said.next_experiment is not None else ""
    return Round(number, spent, records, said.verdict, causes, said.confusable, next_)
