"""When a single cause is enough, so that no pair is looked for: it explains all, with believable numbers beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.judged import a_record, judged
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import position_channel
from twin.fit.fitting import Fit
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.search import Searcher


def test_one_that_explains_all_by_bent_numbers_does_not_end_the_search_either() -> None:
    """The likeliest of all it may be, as long as nobody has looked at two causes that leave the numbers alone."""
    channel = position_channel([trial_of(Plant(DESIGN), staircase())[0]], SIGMA)
    calibration = effect("lvdt_calibration")
    causes = (Cause(calibration.name, calibration, calibration.form("gain_and_zero")),)

    def one(bent: float) -> Fit:
        space = make_space(Plant(DESIGN), causes, ("deadband", "compliance"), Scales())
        z = np.concatenate([[0.0, bent * space.spreads[1]], np.zeros(len(space.unknowns) - 2)])
        return Fit(space, z, 1.1, bent**2, channel.use * 1.0, np.eye(z.size), 1)

    searcher = Searcher(channel, Plant(DESIGN), Scales())
    assert searcher._nothing_left([one(1.0)], one(0.0))
    assert not searcher._nothing_left([one(5.0)], one(0.0))


@pytest.mark.parametrize(
    ("name", "left", "ends"), [("pressure", 1.6, True), ("pressure", 1.8, False), ("position", 1.6, False)]
)
def test_behind_a_pressure_that_passes_for_healthy_no_two_causes_are_looked_for(
    name: str, left: float, ends: bool
) -> None:
    """Its wandering alone makes it 1.25 times its noise, and no single cause explains any of that."""
    trial = trial_of(Plant(DESIGN), staircase())[0]
    channel = replace(position_channel([trial], SIGMA), name=name)
    space = make_space(Plant(DESIGN), (), (), Scales())
    design = Fit(space, np.zeros(0), left, 0.0, channel.use * left**0.5, np.zeros((0, 0)), 1)
    assert Searcher(channel, Plant(DESIGN), Scales())._nothing_left([design], design) is ends


@pytest.mark.thorough
@pytest.mark.parametrize("n", [1500, 3000])
def test_a_small_cause_beside_a_large_one_is_named(n: int) -> None:
    """Alone the travel leaves a two-thousandth of the gap, and of another calibration with other numbers no more."""
    stop = Inserted("reduced_travel", effect("reduced_travel").form("lower_stop"), (0.055,))
    play = Inserted("linkage_lost_motion", effect("linkage_lost_motion").form("play"), (0.00255,))
    _, judgement = judged(a_record(Plant(DESIGN, (stop, play)), n=n))
    assert {c.name for c in judgement.causes} == {"reduced_travel", "linkage_lost_motion"}
