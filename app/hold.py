"""Commands held one after the other with the readings shown: what `set` and `jog` do."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from app.session import Session
    from hal.signals import StopRequest

_TICK_S = 0.1  # how often the valve is commanded; what is shown may be rarer


def hold(session: Session, steps: Iterable[tuple[float, float | None]], period_s: float, stop: StopRequest) -> None:
    """Holds each command for its time [s] (None: until Ctrl-C) and prints a reading every `period_s`.

    The command is repeated every 0.1 s, which also keeps the device's watchdog content.
    Raises: `Stopped` on Ctrl-C, after the tick is finished.
    """
    from app.readings import header, line

    bench, clock = session.bench, session.clock
    tick_s = max(_TICK_S, bench.info.min_period_s)
    if session.calibration_warning is not None:
        click.echo(f"warning: {session.calibration_warning}", err=True)
    click.echo(header(bench.info.command_unit))
    began_s, warned = clock.now_s(), False
    due_s = shown_s = began_s
    for command, hold_s in steps:
        until_s = float("inf") if hold_s is None else due_s + hold_s
        while due_s <= until_s:
            stop.check()
            clock.sleep_until(due_s)
            sample = bench.exchange(command)
            if sample.foreign_psi is not None and not warned:
                unit, warned = bench.info.command_unit, True
                click.echo(f"the device held {sample.foreign_psi:.4g} {unit}: does somebody else command it?", err=True)
            if sample.time_s >= shown_s:
                click.echo(line(sample, began_s))
                shown_s += period_s
            due_s += tick_s
