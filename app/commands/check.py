"""Look at a bench without moving anything: identity, readings, line, calibration, safe state."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Unpack

import click

from app.options import BenchWords, bench_options

if TYPE_CHECKING:
    from app.bench_check import Finding


@click.command()
@bench_options
@click.option("--period", "period_s", type=click.FloatRange(min=0.0001), metavar="S",
              help="A tick [s] that the line has to carry.")  # fmt: skip
@click.option("--leak", is_flag=True, help="Also pressurise the valve, and look at supply and leaks. This moves it.")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
def command(
    period_s: float | None,
    leak: bool,
    as_json: bool,
    **words: Unpack[BenchWords],
) -> None:
    """Look at a bench without moving anything: identity, readings, line, calibration, safe state.

    Nothing is written to the device. With --leak, afterwards, the valve is pressurised to the middle of its range for
    half a minute, to see whether the supply sags and the pressure holds, and then sent to its safe command.
    """
    from app.bench_check import look, pressurise
    from app.watch import open_to_look
    from hal.errors import JobFailed

    watched: BenchWords = {**words, "real_time": True}
    with open_to_look(**watched) as (bench, _):
        findings = look(bench, period_s)
    if not as_json:
        _print(findings)
    if leak:
        from app.options import profile_of
        from app.session import open_bench

        then = profile_of(words["profile"], words["physics"]).in_the_end
        click.echo(f"the valve will now be pressurised for half a minute, then {then}", err=as_json)
        with open_bench(**words) as session:
            found = pressurise(session)
        findings += found
        if not as_json:
            _print(found)
    if as_json:
        click.echo(
            json.dumps({f.name: {"ok": f.ok, "remark": f.remark, "text": f.text, **f.numbers} for f in findings})
        )
    bad = [finding.name for finding in findings if not finding.ok]
    if bad:
        raise JobFailed(f"the bench is not ready: {', '.join(bad)}")


def _print(findings: Sequence[Finding]) -> None:
    for finding in findings:
        word = "BAD " if not finding.ok else "NOTE" if finding.remark else "ok  "
        click.echo(f"{word} {finding.name:<12} {finding.text}")
