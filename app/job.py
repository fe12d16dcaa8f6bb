"""A recorded run from start to end: record, view, progress, signals; what `sweep`, `run` and `demo` have in common."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from click import echo

from app.session import Session

if TYPE_CHECKING:
    from control.drive import Drive
    from control.loop import Loop, Outcome, Sink
    from control.plan import Plan
    from logs.stream import RunView
    from logs.writer import RunWriter


_OFTEN = 0.05  # share of commands held to the limits of a bench from which on its operator is told
SWITCH_S = 0.0003  # how long one thread may keep the others of this process waiting


@dataclass(frozen=True, slots=True)
class Beside:
    """Something that runs beside the bench and adds `columns` (name to unit) to every row: a sink around the sinks."""

    columns: Mapping[str, str]
    around: Callable[[Sequence[Sink]], Sink]


@dataclass(frozen=True, slots=True)
class Job:
    """What to do and what the record should know of it. `about` goes into the start document as it is."""

    kind: str
    plan: Plan
    make_drive: Callable[[float], Drive]  # from the command in force at the start
    closed_loop: bool = False
    about: Mapping[str, object] = field(default_factory=dict)
    beside: Beside | None = None


@dataclass(frozen=True, slots=True)
class Finished:
    """Where the record is and how the run went."""

    folder: Path
    outcome: Outcome


def perform(session: Session, job: Job, *, out: Path | None, live: bool, title: str) -> Finished:
    """Runs the job on the bench of the session.

    Raises: `KeyboardInterrupt` when the operator stopped it, `JobFailed` when the bench did; in both cases after the
    valve has been sent to its safe command and the record is closed.
    """
    from app.console import KeyboardNotes, RunDisplay
    from app.watchdogs import check_watchdogs
    from control.loop import Hooks, Loop
    from control.supervise import supervised
    from hal.signals import stop_signals
    from logs.writer import RunWriter
    from sim_device.sealed import write as write_commitment

    check_watchdogs(session.profile, job.plan.period_s)
    columns = _columns(session, job)
    with ExitStack() as stack:
        stop = stack.enter_context(stop_signals())
        record = stack.enter_context(RunWriter.create(out, _start(session, job), columns))
        if session.sealed is not None:
            write_commitment(record.folder, session.sealed)
        sinks: list[Sink] = [record]
        if live:
            view = _open_view(record, columns)
            stack.callback(view.close)
            sinks.append(view)
        _warn(session, sinks)
        display = stack.enter_context(RunDisplay(title))
        notes = KeyboardNotes()
        stack.callback(notes.close)
        hooks = Hooks(progress=display.show, notes=notes, check=stop.check)
        told = sinks if job.beside is None else [job.beside.around(sinks)]
        loop = Loop(session.bench, session.clock, told, hooks, aux=tuple(session.aux_units))
        try:
            outcome = supervised(loop, record, lambda: _play(session, loop, job))
        except BaseException:
            display.close()
            _say_stopped(loop.rows, job.kind, record.folder)
            raise
    return Finished(record.folder, outcome)


def _columns(session: Session, job: Job) -> dict[str, str]:
    from control.row import columns_of

    columns = columns_of(session.bench.info, closed_loop=job.closed_loop, aux_units=session.aux_units)
    return columns | dict(job.beside.columns if job.beside is not None else {})


def _warn(session: Session, sinks: Sequence[Sink]) -> None:
    """What the operator and the record have to know before the first move."""
    text = session.calibration_warning
    if text is not None:
        echo(f"warning: {text}", err=True)
        for sink in sinks:
            sink.event(0.0, "warning", text)


def _say_stopped(rows: int, kind: str, folder: Path) -> None:
    """What is left of it, and how to go on. Where the valve is, is said last of all."""
    from app.resume import hint
    from hal.counted import counted

    echo(f"stopped after {counted(rows, 'sample')}; record: {folder}\ngo on with: {hint(kind, folder)}", err=True)


def _play(session: Session, loop: Loop, job: Job) -> Outcome:
    begun = session.command_in_force
    # Only now: making record and view has taken longer than a device's watchdog may be ready to wait.
    session.bench.arm(job.plan.period_s)
    with undisturbed():
        outcome = loop.run(job.plan, job.make_drive(begun), begun)
    _say_held(session, loop, outcome.rows)
    return outcome


def _say_held(session: Session, loop: Loop, rows: int) -> None:
    """That the bench has often not done what it was told: who reads the record has to know."""
    from hal.counted import counted

    held, slew = session.bench.clamped, session.profile.limits.slew_per_s
    if held <= _OFTEN * rows:
        return
    limits = "its range" if slew is None else f"its range and its slew of {slew:g} {session.profile.command_unit}/s"
    text = (
        f"{held} of {counted(rows, 'command')} were held to the limits of the bench, {limits}: see command and target"
    )
    echo(f"warning: {text}", err=True)
    loop.say("warning", text)


@contextmanager
def undisturbed() -> Iterator[None]:
    """While open, system and interpreter make the ticks of this thread as little late as they can.

    A thread may hold the interpreter for 5 ms by default, and a full garbage collection walks over every library that
    is loaded.
    """
    from hal.promptly import short_turns

    before_s = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    gc.freeze()
    try:
        with short_turns():
            yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(before_s)


def _start(session: Session, job: Job) -> dict[str, object]:
    bench = asdict(session.bench.info)
    profile = bench.pop("profile")
    calibration = session.profile.calibration
    return {
        "kind": job.kind,
        "bench": bench,
        "profile": profile,
        "calibration": None if calibration is None else calibration.id,
        "virtual": dict(session.virtual) or None,
        "period_s": job.plan.period_s,
        **job.about,
    }


def _open_view(record: RunWriter, columns: Mapping[str, str]) -> RunView:
    from logs.stream import RunView

    view = RunView.open(record.start, columns)
    if view.uri:
        echo(f"live view: {view.uri}  (rerun --connect {view.uri})", err=True)
    else:
        echo(f"live view: off ({view.trouble})", err=True)
    return view
