"""Send the valve to its safe command, whatever state the bench is in."""

from __future__ import annotations

import click


@click.command()
@click.option("--port", metavar="PORT", required=True, help="Serial port, or tcp://HOST:PORT.")
@click.option("--profile", metavar="FILE|NAME", default="virtual", show_default=True, help="Bench profile.")
@click.option("--emergency", is_flag=True, help="Emergency stop: nothing moves again before it is acknowledged.")
def command(port: str, profile: str, emergency: bool) -> None:
    """Send the valve to its safe command, whatever state the bench is in.

    Also with the safe direction `hold`, after an emergency stop, and when the device has taken over. With --emergency
    the device is made to ignore commands, where it can, until `lostmotion set --acknowledge`.
    """
    from hal.clock import RealClock
    from hal.errors import JobFailed, PortFault
    from hal.latch import Latch
    from hal.modbus_bench import ModbusBench
    from hal.profile import load_profile

    found = load_profile(profile)
    unit = found.command_unit
    click.echo(f"sending {found.safe_command:g} {unit} to the valve on {port}" + (" and latching" if emergency else ""))
    if emergency:
        Latch.of_port(port).engage("operator: lostmotion vent --emergency")
    try:
        with ModbusBench(found, port, RealClock(), read_only=True) as bench:
            confirmed = bench.emergency_stop() if emergency else bench.vent()
    except PortFault as error:
        if emergency and "busy" in str(error):
            click.echo("the program that has the port open will vent the valve at its next tick", err=True)
        raise
    if not confirmed:
        raise JobFailed(f"the device on {port} did NOT confirm {found.safe_command:g} {unit}: shut off the supply")
    click.echo(f"the device confirmed {found.safe_command:g} {unit}")
