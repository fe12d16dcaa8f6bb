"""Move the valve by hand in small steps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Unpack

import click

from app.options import BenchWords, bench_options, profile_of


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("steps", nargs=-1, metavar="[STEP]...")
@bench_options
@click.option("--dwell", "dwell_s", type=click.FloatRange(min=0.1), default=3.0, show_default=True, metavar="S",
              help="Time at each command [s].")  # fmt: skip
@click.option("--period", "period_s", type=click.FloatRange(min=0.01), default=1.0, show_default=True, metavar="S",
              help="Time between two readings [s].")  # fmt: skip
def command(
    steps: tuple[str, ...],
    dwell_s: float,
    period_s: float,
    **words: Unpack[BenchWords],
) -> None:
    """Move the valve by hand: STEPs like +0.5 -1 +0.25 (relative) or =8 (absolute), in psi, or percent.

    Without STEPs they are read from standard input, one a line, until an empty line or `q`. A step that would leave the
    limits ends at the limit. At the end the valve goes to its safe command, or with a profile that holds is left where
    it is. A line that is no step is said and passed over at a terminal; from a pipe it ends it all with exit code 2.
    """
    from app.hold import hold
    from app.session import open_bench
    from hal.latch import Latch
    from hal.signals import stop_signals

    found = words["profile"] = profile_of(words["profile"], words["physics"])
    moves = [_parse(step) for step in steps]
    limits, unit = found.limits, found.command_unit
    click.echo(
        f"the valve will move by your steps, between {limits.command_min:g} and {limits.command_max:g} {unit}, "
        f"{dwell_s:g} s each, then {found.in_the_end}"
    )
    if words["port"] is not None:
        Latch.of_port(words["port"]).check()
    words["real_time"] |= words["port"] is None and not steps
    with stop_signals() as stop, open_bench(**words) as session:
        at = session.command_in_force

        def commands() -> Iterator[tuple[float, float | None]]:
            nonlocal at
            for move in moves or _typed():
                if move is None:
                    yield at, 0.0
                    continue
                absolute, amount = move
                wanted = amount if absolute else at + amount
                at = min(max(wanted, limits.command_min), limits.command_max)
                click.echo(f"-> {at:g} {unit}" + (f" (the limit; {wanted:g} {unit} is beyond)" if at != wanted else ""))
                yield at, dwell_s

        hold(session, commands(), period_s, stop)
    click.echo(session.bench.where)


def _parse(step: str) -> tuple[bool, float]:
    """(absolute, amount). Raises: `BadInput`."""
    from math import isfinite

    from hal.errors import BadInput

    text = step.strip()
    try:
        amount = float(text.removeprefix("="))
    except ValueError:
        amount = float("nan")
    if not isfinite(amount):
        raise BadInput(f"step '{step}' must look like +0.5, -1 or =8")
    return text.startswith("="), amount


def _typed() -> Iterator[tuple[bool, float] | None]:
    """Steps typed one a line; None while nothing is typed, so that the bench is served and its watchdog content.

    Raises: `BadInput` for a line that is no step where nobody types who could correct it.
    """
    import sys

    from app.typed import typed_lines
    from hal.errors import BadInput

    for line in typed_lines():
        if line is None:
            yield None
        elif line in ("", "q", "quit"):
            return
        else:
            try:
                yield _parse(line)
            except BadInput as error:
                if not sys.stdin.isatty():  # what follows was meant to start from where that step would have led
                    raise
                click.echo(str(error), err=True)
