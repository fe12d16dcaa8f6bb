"""What is known of a bench before it is touched, and what a run on it would be refused for."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from hal.bench import BenchInfo
    from hal.profile import Profile

WATCHDOG_SHARE = 0.6  # of a device's timeout that a tick may take: one lost reply must not vent the valve


def bench_unopened(profile: Profile, port: str | None) -> BenchInfo:
    """The bench as `open_bench` would open it; without a port the virtual one, which has no bits on a wire."""
    from hal.bench_info import info_of

    return info_of(profile.paced("none")) if port is None else info_of(profile, port)


def check_watchdogs(profile: Profile, period_s: float) -> None:
    """Raises: `BadInput` for a period that a device of the profile would take for silence."""
    from hal.errors import BadInput

    for name, device in profile.devices.items():
        if device.watchdog is not None and period_s > WATCHDOG_SHARE * device.watchdog.timeout_s:
            raise BadInput(
                f"a period of {period_s:g} s is too long: the watchdog of device '{name}' vents the valve after "
                f"{device.watchdog.timeout_s:g} s of silence; at most {WATCHDOG_SHARE:g} of that is safe"
            )


def check_files(profile: Profile, out: Path | None, twin: Path | None = None) -> None:
    """Raises: `BadInput` for a folder of the record, or a model beside the bench, that the run would be refused for."""
    from app.targets import check_new_run
    from app.twin_beside import plant_beside

    check_new_run(out)
    if twin is not None:
        plant_beside(twin, profile.command_unit)
