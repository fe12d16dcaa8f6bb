"""How long a tick may be on a bench whose devices vent the valve when nobody speaks to them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hal.profile import Profile

WATCHDOG_SHARE = 0.6  # of a device's timeout that a tick may take: one lost reply must not vent the valve


def check_watchdogs(profile: Profile, period_s: float) -> None:
    """Raises: `BadInput` for a period that a device of the profile would take for silence."""
    from hal.errors import BadInput

    for name, device in profile.devices.items():
        if device.watchdog is not None and period_s > WATCHDOG_SHARE * device.watchdog.timeout_s:
            raise BadInput(
                f"a period of {period_s:g} s is too long: the watchdog of device '{name}' vents the valve after "
                f"{device.watchdog.timeout_s:g} s of silence; at most {WATCHDOG_SHARE:g} of that is safe"
            )
