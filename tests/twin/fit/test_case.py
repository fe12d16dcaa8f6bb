"""How sure a case is of the design's numbers."""

from __future__ import annotations

import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.fit.case import make_case
from twin.fit.space import ABSORBED_SPREAD, ACCUSED_SPREAD, Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Plant


@pytest.mark.parametrize("doubt", [Scales().doubt, 0.2])
def test_numbers_that_nobody_accuses_may_move_as_far_as_they_are_doubted(doubt: float) -> None:
    case = make_case([a_record(Plant(DesignModel())).slice(0, 600)], DesignModel(), doubt=doubt)
    asymmetric = effect("asymmetric_damping")
    causes = (Cause("parameter:offset"), Cause(asymmetric.name, asymmetric, asymmetric.forms[0]))
    space = make_space(case.base, causes, ("deadband", "offset", *asymmetric.absorbs), case.scales)
    spreads = dict(zip(space.numbers, space.spreads, strict=False))
    assert asymmetric.absorbs and spreads["offset"] == ACCUSED_SPREAD
    assert spreads["deadband"] == doubt
    assert all(spreads[name] == max(ABSORBED_SPREAD, doubt) for name in asymmetric.absorbs)
