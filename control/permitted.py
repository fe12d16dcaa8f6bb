"""What a scenario's physics permits at the best, whatever the controller: by its gauge and by its supply.

Friction sets no bound: a plate that slides stops where the pressure stops, so that a stroke (beyond the breakaway and
back) can end anywhere, however far the plate jumps when it breaks away.
"""

from __future__ import annotations

import math

from control.design import DesignModel
from control.scenarios import TRAVEL_IN, Scenario

NOISE_IN, SLOW_SHARE, SLOW_S = 0.0006, 0.2, 0.3  # one reading's deviation, the share of slow noise, how slow that is


def least_error_percent(scenario: Scenario, rest_s: float, tick_s: float) -> float:
    """Twice the standard deviation of the mean of all readings of `rest_s` at rest [percent of travel].

    Nobody can know better where the stem is; a gain error of the gauge is not in it, because the reading is judged.
    """
    one = scenario.noise * NOISE_IN * scenario.reading_gain
    variance = one**2 * ((1.0 - SLOW_SHARE) * tick_s + SLOW_SHARE * 2.0 * SLOW_S) / rest_s
    return 200.0 * math.sqrt(variance) / TRAVEL_IN


def reaches(scenario: Scenario, valve: DesignModel) -> bool:
    """Whether the supply and the vent carry the plate to the highest and to the lowest target of the scenario."""
    places = [place for part in scenario.segments for place in (part.start_in, part.end_in)]
    most_psi = min(scenario.supply.full_psi, scenario.supply.ceiling_psi)
    closes = valve.a1 + max(places) / valve.compliance <= most_psi
    return closes and valve.a2 + min(places) / valve.compliance >= scenario.supply.empty_psi
