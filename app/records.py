"""What every verb that reads a record has in common: the argument, the options for strangers' files, the opening."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import click

if TYPE_CHECKING:
    from logs.run import Run

Function = TypeVar("Function", bound=Callable[..., None])


def foreign_options(function: Function) -> Function:
    """Adds --map, --units and --command-timing."""
    for option in (
        click.option(
            "--command-timing",
            type=click.Choice(["before", "after", "unknown"]),
            default="before",
            show_default=True,
            help="Whether a row's command was in force before its readings or takes effect after them.",
        ),
        click.option("--units", metavar="ROLE=UNIT,...", help="Units of a foreign file: command=kPa,position=percent."),
        click.option("--map", "mapping", metavar="ROLE=COLUMN,...", help="Columns of a foreign file: time=t."),
    ):
        function = option(function)
    return function


def open_run(text: str, mapping: str | None, units: str | None, command_timing: str) -> Run:
    """The record that `text` means: a folder, a file, a name under logs/runs, or `latest`.

    Raises: `BadInput` when there is none or it cannot be read.
    """
    from typing import cast

    from logs.find import find_record
    from logs.open import open_record
    from logs.recording import CommandTiming

    timing = cast(CommandTiming, command_timing)
    return open_record(find_record(text), mapping=mapping, units=units, command_timing=timing)


def say_problems(run: Run) -> None:
    """What a crash has cost, on stderr, so that nobody takes half a record for a whole one."""
    for problem in run.problems:
        click.echo(f"note: {run.path}: {problem}", err=True)
