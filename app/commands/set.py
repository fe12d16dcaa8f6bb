"""Hold the valve at one command and show its readings; or acknowledge an emergency stop."""

from __future__ import annotations

from typing import Unpack

import click

from app.options import BenchWords, bench_options, profile_of


@click.command(name="set")
@click.argument("value", type=float, required=False)
@bench_options
@click.option("--hold", "hold_s", type=click.FloatRange(min=0), metavar="S", help="Stop after S seconds.")
@click.option("--period", "period_s", type=click.FloatRange(min=0.01), default=0.5, show_default=True, metavar="S",
              help="Time between two readings [s].")  # fmt: skip
@click.option("--acknowledge", is_flag=True, help="You have looked at the valve: lift the emergency stop first.")
def command(
    value: float | None,
    hold_s: float | None,
    period_s: float,
    acknowledge: bool,
    **words: Unpack[BenchWords],
) -> None:
    """Hold the valve at VALUE (psi, or percent) and show its readings until Ctrl-C or --hold.

    Then the valve goes to its safe command, as after everything that this program does; with a profile that holds it is
    left where it is. With --acknowledge and without VALUE only the emergency stop is lifted, and the valve stays put.
    """
    from app.hold import hold
    from app.session import open_bench
    from hal.errors import BadInput
    from hal.latch import Latch
    from hal.signals import stop_signals

    if value is None and not acknowledge:
        raise BadInput("give the command to hold, for example `lostmotion set 8.5`, or --acknowledge")
    found = words["profile"] = profile_of(words["profile"], words["physics"])
    low, high, unit = found.limits.command_min, found.limits.command_max, found.command_unit
    if value is not None and not low <= value <= high:
        raise BadInput(f"{value:g} {unit} is outside the limits of profile '{found.name}', {low:g} to {high:g} {unit}")
    if words["port"] is not None and not acknowledge:
        Latch.of_port(words["port"]).check()
    if value is None:
        click.echo("lifting the emergency stop; the valve stays at its safe command")
    else:
        end = "until Ctrl-C" if hold_s is None else f"for {hold_s:g} s"
        click.echo(f"the valve will go to {value:g} {unit} and be held there {end}, then {found.in_the_end}")
    words["real_time"] |= words["port"] is None and hold_s is None
    with stop_signals() as stop, open_bench(**words, acknowledge=acknowledge) as session:
        if value is not None:
            hold(session, [(value, hold_s)], period_s, stop)
    click.echo(session.bench.where)
