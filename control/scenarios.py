"""The standard scenarios of `lostmotion compare`: what is asked of the valve, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from control.fastest import Supply
from hal.errors import BadInput

FloatArray = npt.NDArray[np.float64]
TRAVEL_IN = 0.5625


@dataclass(frozen=True, slots=True)
class Segment:
    """The target goes in a straight line `start_in` to `end_in` [in] within `duration_s`; a hold where they agree."""

    start_in: float
    end_in: float
    duration_s: float

    @property
    def is_hold(self) -> bool:
        return self.start_in == self.end_in


@dataclass(frozen=True, slots=True)
class Scenario:
    """A target profile on a valve. `numbers` replace design numbers of the valve (not of the controller's design),
    `effects` are imperfections by name with sizes in their natural unit, `noise` scales the reading noise.
    """

    name: str
    claim: str
    segments: tuple[Segment, ...]
    numbers: Mapping[str, float] = field(default_factory=dict)
    effects: Mapping[str, float] = field(default_factory=dict)
    noise: float = 1.0

    @property
    def reading_gain(self) -> float:
        """Reading over true position; where it is not 1, errors are judged on the reading: nobody can know better."""
        return 1.0 + self.effects.get("lvdt_calibration/gain", 0.0)

    @property
    def supply(self) -> Supply:
        """What the converter of this valve can do."""
        span_psi = self.effects.get("ep_calibration/span", 0.0)
        droop_psi = self.effects.get("supply_saturation/droop", 0.0)
        ceiling_psi = 15.0 - 0.9 * droop_psi if droop_psi else float("inf")
        full_psi, empty_psi = (u + span_psi * (u - 3.0) / 12.0 for u in (20.0, 0.0))
        return Supply(full_psi, empty_psi, ceiling_psi, self.effects.get("dead_time", 0.0))

    def targets(self, period_s: float) -> FloatArray:
        """One target per tick [in]."""
        parts = []
        for part in self.segments:
            n = round(part.duration_s / period_s)
            parts.append(np.linspace(part.start_in, part.end_in, n) if not part.is_hold else np.full(n, part.end_in))
        return np.concatenate(parts)


def holds(percents: tuple[float, ...], hold_s: float) -> tuple[Segment, ...]:
    """Steps between percents of travel, each held for `hold_s`."""
    return tuple(Segment(p * TRAVEL_IN / 100.0, p * TRAVEL_IN / 100.0, hold_s) for p in percents)


LADDER = holds((20, 40, 60, 80, 100, 80, 60, 40, 20, 0), 40.0)
MIXED = holds((30, 70, 50, 55, 53, 90, 35, 10, 60), 40.0)
REVERSALS = holds((50, 52, 50, 51, 49, 50, 55, 50, 47, 50), 40.0)
_RAMP = (
    *holds((20.0,), 30.0),
    Segment(0.2 * TRAVEL_IN, 0.8 * TRAVEL_IN, 60.0),
    *holds((80.0,), 20.0),
    Segment(0.8 * TRAVEL_IN, 0.3 * TRAVEL_IN, 50.0),
    *holds((30.0,), 20.0),
    Segment(0.3 * TRAVEL_IN, 0.5 * TRAVEL_IN, 60.0),
    *holds((50.0,), 20.0),
)

SCENARIOS: Mapping[str, Scenario] = MappingProxyType(
    {
        s.name: s
        for s in (
            Scenario("ladder", "20 % steps from 0 to 100 % and back, the valve as designed", LADDER),
            Scenario("reversals", "steps of 1 to 5 % around half travel", REVERSALS),
            Scenario("ramps", "slow ramps up and down", _RAMP),
            Scenario("noise", "reading noise four times as large", MIXED, noise=4.0),
            Scenario("ep_plus", "converter span 3 % high", MIXED, effects={"ep_calibration/span": 0.36}),
            Scenario("ep_minus", "converter span 3 % low", MIXED, effects={"ep_calibration/span": -0.36}),
            Scenario("lvdt_plus", "LVDT gain 3 % high", MIXED, effects={"lvdt_calibration/gain": 0.03}),
            Scenario("lvdt_minus", "LVDT gain 3 % low", MIXED, effects={"lvdt_calibration/gain": -0.03}),
            Scenario("deadband_plus", "deadband 20 % wider than designed", MIXED, numbers={"a1": 9.076, "a2": 5.524}),
            Scenario(
                "deadband_minus", "deadband 20 % narrower than designed", MIXED, numbers={"a1": 8.484, "a2": 6.116}
            ),
            Scenario("stiction", "0.3 psi breakaway friction", MIXED, effects={"stiction": 0.3}),
            Scenario("dead_time", "0.2 s dead time of the converter", MIXED, effects={"dead_time": 0.2}),
            Scenario(
                "supply_droop", "the supply droops with every filling", MIXED, effects={"supply_saturation/droop": 1.0}
            ),
            Scenario("ep_hysteresis", "converter hysteresis of 0.13 psi", MIXED, effects={"ep_deadband/play": 0.13}),
        )
    }
)


def chosen_scenarios(names: tuple[str, ...]) -> tuple[Scenario, ...]:
    """The scenarios of these names, all for none.

    Raises: `BadInput` with the names that exist.
    """
    for name in names:
        if name not in SCENARIOS:
            raise BadInput(f"scenario {name!r} does not exist; choose from {', '.join(SCENARIOS)}")
    return tuple(SCENARIOS[name] for name in names or SCENARIOS)
