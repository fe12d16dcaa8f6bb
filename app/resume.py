"""Going on with a run that was stopped: what `sweep --resume` and `run --resume` have in common."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from hal.errors import BadInput

if TYPE_CHECKING:
    from logs.run import Run

_BENCH = ("port", "profile", "physics", "seed", "effects", "plant", "real_time", "sealed", "twin")


def stopped_run(text: str | Path, kind: str) -> tuple[Run, int]:
    """The run that `text` means, and the number of the step that it did not finish.

    Raises: `BadInput` when it is not of that kind, still goes on, or is complete.
    """
    from logs.find import find_record
    from logs.run import read_run

    path = find_record(str(text))
    run = read_run(path)
    if run.kind != kind:
        other = f"; try `lostmotion {run.kind} --resume`" if run.kind in ("sweep", "run") else ""
        raise BadInput(f"{path}: this is not a '{kind}' but a '{run.kind}'{other}")
    if run.running:
        raise BadInput(f"{path}: this run is still being recorded; stop it first")
    if run.status == "success":
        raise BadInput(f"{path}: this run is complete; there is nothing to go on with")
    steps = run.columns.get("step")
    return run, 0 if steps is None or not steps.size else max(0, int(steps[-1]))


def continues(run: Run, first: int) -> dict[str, object]:
    """What the record of the rest says about the run it continues."""
    return {"continues": str(run.start.get("uuid", run.path)), "first_step": first}


def hint(kind: str, folder: Path) -> str:
    """The command that goes on with a run that is being stopped, on the same bench."""
    words = ["lostmotion", kind, "--resume", str(folder)]
    context = click.get_current_context(silent=True)
    if context is not None:
        for option in _typed(context, _BENCH):
            value = context.params[str(option.name)]
            for each in value if isinstance(value, tuple) else (value,):
                words += [option.opts[0]] if each is True else [option.opts[0], str(each)]
    return shlex.join(words)


def _typed(context: click.Context, names: Sequence[str]) -> list[click.Parameter]:
    source = click.core.ParameterSource.COMMANDLINE
    return [
        option
        for option in context.command.params
        if option.name in names and context.get_parameter_source(option.name) is source
    ]


def refuse_given(*names: str) -> None:
    """Raises: `BadInput` when one of these options was typed: a run that goes on takes them from its record."""
    typed = [option.opts[0] for option in _typed(click.get_current_context(), names)]
    if typed:
        raise BadInput(f"--resume takes {', '.join(typed)} from the record of that run; leave it out")
