"""Whether a valve has come to rest: the means of the two halves of a window agree, in position and in pressure."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class SettleRule:
    """Tolerances on the change of the mean from one half of the window to the other.

    A first-order tail of time constant tau that passes has at most tolerance / (exp(window / (2 tau)) - 1) left to go.
    """

    window_s: float = 6.0
    position_in: float = 0.0006
    pressure_psi: float = 0.01


@dataclass(slots=True)
class SettleDetector:
    """Feed it every sample of a stay; it holds the last `rule.window_s` of them."""

    rule: SettleRule = SettleRule()
    _rows: deque[tuple[float, float, float]] = field(default_factory=deque)

    def reset(self) -> None:
        self._rows.clear()

    def update(self, time_s: float, position_in: float, pressure_psi: float | None) -> bool:
        """Takes a sample and says whether the valve has settled. Samples that are NaN are left out."""
        if not math.isfinite(position_in) or (pressure_psi is not None and not math.isfinite(pressure_psi)):
            return False
        rows = self._rows
        rows.append((time_s, position_in, 0.0 if pressure_psi is None else pressure_psi))
        full = time_s - rows[0][0] >= self.rule.window_s * (1.0 - 1e-9)
        while time_s - rows[0][0] > self.rule.window_s * (1.0 + 1e-9):
            rows.popleft()
        return full and self._agrees(time_s - 0.5 * self.rule.window_s)

    def _agrees(self, middle_s: float) -> bool:
        for column, tolerance in ((1, self.rule.position_in), (2, self.rule.pressure_psi)):
            older = [row[column] for row in self._rows if row[0] <= middle_s]
            newer = [row[column] for row in self._rows if row[0] > middle_s]
            if len(older) < 2 or len(newer) < 2:
                return False
            if abs(sum(newer) / len(newer) - sum(older) / len(older)) > tolerance:
                return False
        return True
