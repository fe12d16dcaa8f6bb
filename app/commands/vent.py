"""Send the valve to its safe command, whatever state the bench is in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from hal.profile import Profile

_PATIENCE_S = 10.0  # for whoever has the port open to notice an emergency stop


@click.command()
@click.option("--port", metavar="PORT", required=True, help="Serial port, or tcp://HOST:PORT.")
@click.option("--profile", metavar="FILE|NAME", default="virtual", show_default=True, help="Bench profile.")
@click.option("--emergency", is_flag=True, help="Emergency stop: nothing moves again before it is acknowledged.")
def command(port: str, profile: str, emergency: bool) -> None:
    """Send the valve to its safe command, whatever state the bench is in.

    Also with the safe direction `hold`, after an emergency stop, and when the device has taken over. With --emergency
    the device is made to ignore commands, where it can, until `lostmotion set --acknowledge`.
    """
    from hal.errors import JobFailed
    from hal.latch import Latch
    from hal.profile import load_profile

    found = load_profile(profile)
    unit = found.command_unit
    click.echo(f"sending {found.safe_command:g} {unit} to the valve on {port}" + (" and latching" if emergency else ""))
    if emergency:
        Latch.of_port(port).engage("operator: lostmotion vent --emergency")
    if not _send(found, port, emergency):
        raise JobFailed(f"the device on {port} did NOT confirm {found.safe_command:g} {unit}: shut off the supply")
    click.echo(f"the device confirmed {found.safe_command:g} {unit}")


def _send(profile: Profile, port: str, emergency: bool) -> bool:
    """True when the device confirmed. In an emergency a port in use is waited for: who uses it sees the stop and ends.

    Raises: `PortFault`, and what the bench raises.
    """
    from hal.clock import RealClock
    from hal.errors import PortFault
    from hal.modbus_bench import ModbusBench

    clock = RealClock()
    until_s = clock.now_s() + (_PATIENCE_S if emergency else 0.0)
    waiting = False
    while True:
        try:
            with ModbusBench(profile, port, clock, read_only=True) as bench:
                return bench.emergency_stop() if emergency else bench.vent()
        except PortFault as error:
            if "is busy" not in str(error):
                raise
            if not emergency:
                reach = (
                    "or add --emergency, which reaches through: a run of lostmotion that has it then vents the valve"
                )
                raise PortFault(f"{error}, {reach}") from error
            if clock.now_s() >= until_s:
                raise
            if not waiting:
                click.echo("the program that has the port open will vent the valve at its next tick; waiting", err=True)
            waiting = True
            clock.sleep_until(clock.now_s() + 0.1)
