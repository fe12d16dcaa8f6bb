"""The registers of the device's own dead man's handle, as a profile places them."""

from __future__ import annotations

from collections.abc import Callable

from hal.device import Watchdog as WatchdogProfile
from hal.profile import Profile
from hal.register import Register
from sim_device.registers import Cell
from sim_device.rig import EMERGENCY, Rig
from sim_device.signals import make_cell

_Access = tuple[Callable[[], float], Callable[[float], None], Callable[[float], bool]]


def watchdog_cells(profile: Profile, rig: Rig | None, device: str) -> list[Cell]:
    """The watchdog's cells of `device`; without a `rig` (a unit that drives nothing) they only remember.

    The watchdog starts switched off: a device that vents before anybody has spoken to it would be no use on a bench.
    """
    settings = profile.devices[device].watchdog
    if settings is None:
        return []
    prefix = f"devices.{device}.watchdog."
    placed = {
        key.removeprefix(prefix): register
        for key, register in profile.every_register().items()
        if key.startswith(prefix)
    }
    if rig is None:
        return [_memory_cell(profile, key, register) for key, register in placed.items()]
    # Where a switch of its own exists, the timeout is preset; otherwise a timeout above 0 is the switch.
    rig.watchdog.enabled = settings.enable is None
    rig.watchdog.timeout_s = settings.timeout_s if settings.enable is not None else 0.0
    access = _access(profile, settings, rig)
    return [make_cell(profile, f"watchdog.{key}", register, *access[key]) for key, register in placed.items()]


def _access(profile: Profile, settings: WatchdogProfile, rig: Rig) -> dict[str, _Access]:
    watchdog, limits = rig.watchdog, profile.limits

    def set_timeout(seconds: float) -> None:
        watchdog.timeout_s = seconds

    def set_enabled(state: float) -> None:
        watchdog.enabled = state != 0

    def set_safe(command: float) -> None:
        rig.safe_command = command

    def stop(state: float) -> None:
        if state:
            rig.emergency()

    return {
        "timeout": (lambda: watchdog.timeout_s, set_timeout, lambda seconds: seconds >= 0.0),
        "enable": (lambda: float(watchdog.enabled), set_enabled, lambda state: state in (0, 1)),
        "status": (lambda: float(watchdog.status), lambda _: rig.clear(), lambda value: value == settings.clear),
        "safe_value": (
            lambda: rig.safe_command,
            set_safe,
            lambda command: limits.command_min <= command <= limits.command_max,
        ),
        "emergency": (lambda: float(watchdog.status == EMERGENCY), stop, lambda state: state in (0, 1)),
    }


def _memory_cell(profile: Profile, key: str, register: Register) -> Cell:
    held = [0.0]

    def remember(value: float) -> None:
        held[0] = value

    return make_cell(profile, f"watchdog.{key}", register, lambda: held[0], remember)
