"""Show the readings of a bench until Ctrl-C; nothing is written."""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING, Unpack

import click

from app.options import BenchWords, bench_options

if TYPE_CHECKING:
    from hal.clock import Clock
    from hal.modbus_bench import ModbusBench
    from hal.sample import Sample
    from hal.signals import StopRequest


@click.command()
@bench_options
@click.option("--period", "period_s", type=click.FloatRange(min=0.005), default=0.5, show_default=True, metavar="S",
              help="Time between two readings [s].")  # fmt: skip
@click.option("--count", type=click.IntRange(min=1), metavar="N", help="Stop after N readings.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per reading.")
def command(
    period_s: float,
    count: int | None,
    as_json: bool,
    **words: Unpack[BenchWords],
) -> None:
    """Show the readings of a bench until Ctrl-C, or --count of them; nothing is written and the valve stays as it is.

    A port that is unplugged is waited for, ten seconds; its readings go on when the same device is back.
    With --count the virtual valve is read in stepped time, without waiting.
    """
    from app.readings import header, line, sample_row
    from app.watch import open_to_look
    from hal.errors import BadInput
    from hal.signals import stop_signals

    words["real_time"] |= count is None
    with stop_signals() as stop, open_to_look(**words) as (bench, clock):
        unit, least_s = bench.info.command_unit, bench.info.min_period_s
        if period_s < least_s:
            raise BadInput(f"--period {period_s:g} s is shorter than the line can carry; the least is {least_s:.4g} s")
        if not as_json:
            click.echo(header(unit))
        began_s = clock.now_s()
        for sample in islice(_readings(bench, clock, period_s, stop), count):
            click.echo(json.dumps(sample_row(sample, unit)) if as_json else line(sample, began_s))


def _readings(bench: ModbusBench, clock: Clock, period_s: float, stop: StopRequest) -> Iterator[Sample]:
    """One every period, for ever. Raises: what the bench raises; `Stopped`."""
    from hal.errors import PortFault

    due_s = clock.now_s()
    while True:
        stop.check()
        clock.sleep_until(due_s)
        try:
            yield bench.observe()
        except PortFault as gone:
            if not bench.reopen(gone):
                raise
        due_s = max(due_s + period_s, clock.now_s())
