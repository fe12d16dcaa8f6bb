"""Design numbers that are far off: from where they are looked for."""

from __future__ import annotations

from dataclasses import replace

import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.case import make_case
from twin.fit.channel import chain_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.plant import Plant


@pytest.mark.parametrize("share", [0.35, 0.25])
def test_a_rate_limit_that_the_design_never_meets_is_found(share: float) -> None:
    """The design is never that fast, so that no small change of its limit makes a difference."""
    design = replace(DesignModel(), rate_limit=0.35)
    true = replace(design, rate_limit=share * design.rate_limit)
    case = make_case([replace(a_record(Plant(true)), pressure=None)], design)
    channel = chain_channel(case.trials, case.sigma_y)
    space = make_space(case.base, [Cause("parameter:rate_limit")], ["rate_limit"], case.scales)
    found = fit(channel, space, starts_of(space))
    assert found.values()[0] == pytest.approx(true.rate_limit, rel=0.03)
