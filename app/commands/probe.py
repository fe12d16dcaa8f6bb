"""Look for Modbus units on a serial line, and measure how long they take to answer."""

from __future__ import annotations

import json
from dataclasses import asdict
from math import isnan
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from hal.probe import Found


@click.command()
@click.option("--port", metavar="PORT", required=True, help="Serial port, pty, or rtu+tcp://HOST:PORT.")
@click.option("--units", default="1-16", show_default=True, metavar="LIST", help="Unit ids, like 1-5,10.")
@click.option("--bauds", default="9600,19200,38400,57600,115200", show_default=True, metavar="LIST", help="Speeds.")
@click.option("--parities", default="N,E", show_default=True, metavar="LIST", help="Parities out of N, E, O.")
@click.option("--timeout", "timeout_s", type=click.FloatRange(min=0.01, max=5), default=0.15, show_default=True,
              metavar="S", help="How long to wait for each answer [s].")  # fmt: skip
@click.option("--all", "find_all", is_flag=True, help="Go on after the first setting at which somebody answered.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
def command(port: str, units: str, bauds: str, parities: str, timeout_s: float, find_all: bool, as_json: bool) -> None:
    """Look for Modbus units on a serial line, and measure how long they take to answer.

    Only reads of one register are sent; nothing is written. On a pseudo-terminal every speed seems to work.
    """
    from hal.errors import BadInput, JobFailed
    from hal.port import parse_port
    from hal.probe import probe, settings_to_try

    where = parse_port(port)
    if where.kind == "tcp":
        raise BadInput(
            f"{port} speaks Modbus TCP, which has no speed to look for; try `lostmotion check --port {port}`"
        )
    try:
        settings = settings_to_try((int(baud) for baud in bauds.split(",")), parities.upper().split(","))
    except ValueError as error:
        raise BadInput(
            f"--bauds {bauds} --parities {parities}: speeds from 300 to 4000000, parities N, E, O"
        ) from error
    numbers = _units(units)
    found: list[Found] = []
    for unit in probe(where, settings, numbers, timeout_s=timeout_s, said=lambda text: click.echo(text, err=True)):
        if found and not find_all and unit.baud != found[0].baud:
            break
        found.append(unit)
        if not as_json:
            click.echo(
                f"unit {unit.unit} at {unit.baud} 8{unit.parity}{unit.stop_bits}: {unit.answer}, " + _turnaround(unit)
            )
    if as_json:
        click.echo(json.dumps([_plain(unit) for unit in found]))
    if not found:
        raise JobFailed(f"nobody answered on {port}; check power, A/B wiring, and whether the device is in Modbus mode")


def _turnaround(unit: Found) -> str:
    if isnan(unit.turnaround_ms):
        why = f"it answers faster than {unit.baud} baud carries the bytes; a line without bits?"
        return f"turnaround not measurable: {why}"
    return f"turnaround {unit.turnaround_ms:.2f} ms (worst {unit.worst_ms:.2f} ms)"


def _plain(unit: Found) -> dict[str, object]:
    """JSON knows no NaN."""
    return {key: None if isinstance(value, float) and isnan(value) else value for key, value in asdict(unit).items()}


def _units(text: str) -> list[int]:
    """Unit ids from `1-5,10`. Raises: `BadInput`."""
    from hal.errors import BadInput

    numbers: list[int] = []
    try:
        for part in text.split(","):
            first, _, last = part.partition("-")
            numbers += range(int(first), int(last or first) + 1)
    except ValueError as error:
        raise BadInput(f"--units '{text}' must look like 1-5,10") from error
    if not numbers or min(numbers) < 1 or max(numbers) > 247:
        raise BadInput(f"--units '{text}': unit ids go from 1 to 247")
    return numbers
