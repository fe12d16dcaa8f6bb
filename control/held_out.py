"""Scenarios that nobody has tuned on: other sizes of what is wrong, other targets, other noise."""

from __future__ import annotations

import zlib
from dataclasses import replace

import numpy as np

from control.design import DesignModel
from control.scenarios import TRAVEL_IN, Scenario, Segment

FIRST_SEED = 8000  # below it, draws were tuned on, or looked at and what failed there was mended


def held_out(scenario: Scenario, seed: int) -> Scenario:
    """The scenario with everything drawn anew for this seed: what is wrong is a half to all of the named size, with the
    same sign; the noise likewise; targets keep their kind of move (size of the steps, slope of the ramps) but not their
    place, except that the ends of the stroke stay where they are asked for."""
    chance = np.random.default_rng([seed, zlib.crc32(scenario.name.encode())])
    size = float(chance.uniform(0.5, 1.0))
    design = {"a1": DesignModel().a1, "a2": DesignModel().a2}
    numbers = {name: design[name] + size * (value - design[name]) for name, value in scenario.numbers.items()}
    return replace(
        scenario,
        segments=_moved(scenario.segments, chance),
        numbers=numbers,
        effects={name: size * value for name, value in scenario.effects.items()},
        noise=1.0 + float(chance.uniform(0.5, 1.0)) * (scenario.noise - 1.0),
    )


def _moved(segments: tuple[Segment, ...], chance: np.random.Generator) -> tuple[Segment, ...]:
    """Every place that is not an end of the stroke moves by up to 4 % of travel, the same place alike in a ramp."""
    places = sorted({place for part in segments for place in (part.start_in, part.end_in)})
    small = len(places) > 1 and places[-1] - places[0] < 0.2 * TRAVEL_IN
    common_in = float(chance.uniform(-0.25, 0.25)) * TRAVEL_IN  # small steps move together, or they would not be small
    moved = {}
    for place in places:
        by_in = common_in if small else float(chance.uniform(-0.04, 0.04)) * TRAVEL_IN
        ends = place <= 0.0 or place >= TRAVEL_IN
        moved[place] = place if ends else min(max(place + by_in, 0.02 * TRAVEL_IN), 0.98 * TRAVEL_IN)
    return tuple(Segment(moved[part.start_in], moved[part.end_in], part.duration_s) for part in segments)
