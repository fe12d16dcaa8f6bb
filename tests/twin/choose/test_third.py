"""What is claimed of a cause beside one larger one, and of two beside it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.choose.decide import Decision
from twin.choose.weigh import Weights, weigh
from twin.fit.channel import position_channel
from twin.fit.fitting import fit
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.findings import Findings
from twin.search.score import yardstick_for

THREE = (("lvdt_calibration", "zero", 0.02), ("linkage_lost_motion", "play", 0.03), ("lvdt_drift", "linear", 2e-5))


@pytest.mark.parametrize(("count", "most"), [(1, Weights().exact), (2, 0.8), (3, 0.5)])
def test_of_three_behind_one_signal_two_are_as_likely_false_as_true(count: int, most: float) -> None:
    there = [Inserted(name, effect(name).form(form), (value,)) for name, form, value in THREE[:count]]
    causes = [Cause(one.effect, effect(one.effect), one.form) for one in there]
    channel = position_channel([trial_of(Plant(DESIGN, tuple(there)), staircase())[0]], SIGMA)
    none, *fits = [
        fit(channel, space, [np.full(len(space.unknowns), 0.1)], rounds=8)
        for some in ([], *([one] for one in causes), *([causes] if count > 1 else []))
        for space in [make_space(Plant(DESIGN), some, (), Scales())]
    ]
    findings = Findings(channel, none, none, tuple(fits), yardstick_for([none, *fits], channel.use))
    probability = weigh(Decision(findings, fits[-1], True, True, 0.0, floor=1.0), Weights()).probability
    claimed = sorted(probability[name] for name in fits[-1].names)
    assert claimed == pytest.approx([*[most] * (count - 1), Weights().exact], abs=0.01)
