"""Does the device hold the command that it was sent? A read-back that differs again and again means another master.

Where function 23 writes before it reads, `hal.second_master` looks as well.
"""

from __future__ import annotations

from hal.errors import SafetyTrip
from hal.profile import Profile
from hal.tick import TickPlan

_MISMATCHES = 3  # ticks in a row in which the device may hold another command than the one it was sent


class ReadbackCheck:
    """Counts ticks whose read-back is not the command. `where` names the device in the sentence."""

    def __init__(self, profile: Profile, plan: TickPlan, where: str) -> None:
        self.tolerance = _tolerance(profile, plan)  # in the command's unit
        self.unit = profile.command_unit
        self.where = where
        self._mismatches = 0

    def judge(self, commanded: float, held: float | None) -> None:
        """Raises: `SafetyTrip` at the third tick in a row that does not fit."""
        if held is None:
            return
        self._mismatches = self._mismatches + 1 if abs(held - commanded) > self.tolerance else 0
        if self._mismatches >= _MISMATCHES:
            raise SafetyTrip(
                f"the device on {self.where} was sent {commanded:.4g} {self.unit} and holds "
                f"{held:.4g} {self.unit}, {_MISMATCHES} ticks in a row: does somebody else command it?"
            )


def _tolerance(profile: Profile, plan: TickPlan) -> float:
    if profile.readback_tolerance is not None:
        return profile.readback_tolerance
    limits, readback = profile.limits, profile.signals.readback
    counts = max(plan.command.resolution(), readback.resolution() if readback else 0.0)
    return 2.0 * counts + 1e-6 * (limits.command_max - limits.command_min)
