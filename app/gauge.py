"""Pairs of signal and gauge, typed by an operator who reads a dial gauge beside the bench."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Iterator
from statistics import fmean
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from app.session import Session
    from hal.signals import StopRequest

Pair = tuple[float, float]

_READINGS = 10  # that are averaged
_TICK_S = 0.1


def ask(profile: str, port: str, commands: str | None) -> list[Pair]:
    """(signal, position [in]) as often as the operator types a position.

    Raises: `BadInput` for `commands` that are no numbers or beyond the limits, and for a line of a pipe that is no
    position; what the bench raises.
    """
    return _ask_moved(profile, port, commands) if commands is not None else _ask_still(profile, port)


def _ask_still(profile: str, port: str) -> list[Pair]:
    from app.watch import open_to_look
    from hal.assemble import NO_VALUE

    pairs: list[Pair] = []
    with open_to_look(port, profile) as (bench, _):
        while text := click.prompt("gauge position [in], empty to end", default="", show_default=False).strip():
            position = _number(text)
            if position is None:
                continue
            seen = [sample.position for sample in (bench.observe() for _ in range(_READINGS))]
            values = [bench.profile.position_signal(r.value) for r in seen if not r.quality & NO_VALUE]
            if not values:
                click.echo("the bench gave no reading; try again", err=True)
                continue
            pairs.append((fmean(values), position))
            click.echo(f"  signal {pairs[-1][0]:.5f} at {position:g} in")
    return pairs


def _ask_moved(profile: str, port: str, commands: str) -> list[Pair]:
    """Holds each command until its position has been typed; the signal stands on the screen meanwhile."""
    from app.session import open_bench
    from app.typed import typed_lines
    from hal.latch import Latch
    from hal.profile import load_profile
    from hal.signals import stop_signals

    found = load_profile(profile)
    steps = _commands(commands, found.limits.command_min, found.limits.command_max, found.command_unit)
    Latch.of_port(port).check()
    click.echo(f"the valve will go to {commands} {found.command_unit}, wait at each, then {found.in_the_end}")
    pairs: list[Pair] = []
    with stop_signals() as stop, open_bench(port, found) as session:
        lines = typed_lines()
        for command in steps:
            click.echo(f"-> {command:g} {found.command_unit}: when it rests, type the gauge's position [in]")
            pair = _held(session, command, lines, stop)
            if pair is None:
                break
            pairs.append(pair)
            click.echo(f"  signal {pair[0]:.5f} at {pair[1]:g} in")
    click.echo(session.bench.where)
    return pairs


def _held(session: Session, command: float, lines: Iterator[str | None], stop: StopRequest) -> Pair | None:
    """The next pair, or None when the operator ends."""
    from hal.safety import UNTRUSTED

    bench, clock = session.bench, session.clock
    signals: deque[float] = deque(maxlen=_READINGS)
    tick_s = max(_TICK_S, bench.info.min_period_s)
    position: float | None = None
    due_s = clock.now_s()
    while position is None or len(signals) < _READINGS:
        stop.check()
        clock.sleep_until(due_s)
        due_s += tick_s
        reading = bench.exchange(command).position
        if not reading.quality & UNTRUSTED:
            signals.append(session.profile.position_signal(reading.value))
        if signals and sys.stderr.isatty():
            moved = max(signals) - min(signals)
            click.echo(f"\r  signal {signals[-1]:10.5f}, moved {moved:.5f} in the last second  ", nl=False, err=True)
        text = next(lines, "") if position is None else None
        if text == "":
            return None
        if text is not None:
            position = _number(text)
            signals.clear()  # what counts is the signal while the gauge was being read, not on the way there
    return fmean(signals), position


def _number(text: str) -> float | None:
    """None for what the operator may type again. Raises: `BadInput` where nobody types: what follows may belong to
    another place of the valve."""
    from hal.errors import BadInput

    try:
        return float(text)
    except ValueError as error:
        if not sys.stdin.isatty():
            raise BadInput(f"'{text}' is not a number, and what follows may belong to another reading") from error
        click.echo(f"'{text}' is not a number", err=True)
        return None


def _commands(text: str, low: float, high: float, unit: str) -> list[float]:
    from hal.errors import BadInput

    try:
        found = [float(word) for word in text.split(",")]
    except ValueError as error:
        raise BadInput(f"--at '{text}' must look like 4,8,9,10") from error
    for command in found:
        if not low <= command <= high:
            raise BadInput(f"--at: {command:g} {unit} is outside the limits, {low:g} to {high:g} {unit}")
    return found
