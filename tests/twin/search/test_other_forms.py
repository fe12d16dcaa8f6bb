"""Of a pair in its other forms, those are fitted that promise most."""

from __future__ import annotations

import numpy as np

from tests.twin.search.test_screen import cause
from tests.twin.trials import DESIGN
from twin.fit.space import make_space
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.search.reform import least_left
from twin.search.screen import Prospect


def test_of_each_pair_of_causes_those_forms_are_fitted_that_promise_to_leave_least() -> None:
    """However much they gain: one may begin from a worse form of the other effect."""
    play, stop = cause("linkage_lost_motion", "play"), cause("reduced_travel", "lower_stop")
    one_sided, tail = cause("linkage_lost_motion", "one_sided"), cause("creep", "one_tail")
    space, z = make_space(Plant(DESIGN), (), (), Scales()), np.zeros(0)
    looked = [
        Prospect((play, stop), space, z, gain=80.0, before=100.0),
        Prospect((one_sided, stop), space, z, gain=20.0, before=30.0),
        Prospect((one_sided, stop), space, z, gain=5.0, before=30.0),
        Prospect((play, tail), space, z, gain=1.0, before=100.0),
    ]
    assert least_left(looked, 2) == [looked[1], looked[0], looked[3]]
    assert least_left(looked, 1) == [looked[1], looked[3]]
