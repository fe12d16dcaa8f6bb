"""List the serial ports of this machine."""

from __future__ import annotations

import json

import click


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
def command(as_json: bool) -> None:
    """List the serial ports of this machine, with what their adapters say of themselves.

    A name under /dev/serial/by-id stays the same when the adapter is plugged in elsewhere; prefer it where shown.
    """
    from hal.port import list_serial_ports

    ports = list_serial_ports()
    if as_json:
        click.echo(json.dumps(ports))
        return
    if not ports:
        click.echo("no serial ports found; plug the adapter in, or try the virtual valve: lostmotion emulate")
    for port in ports:
        click.echo(f"{port['port']:<16} {port['description']}" + (f"  ({port['by_id']})" if port["by_id"] else ""))
