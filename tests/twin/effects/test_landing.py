"""Stops that a stem lands on softly: against a plain integration in small steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.springs import TIME_S, stem, stem_from, stepped
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant


@pytest.mark.parametrize("gives", [0.0, 0.04, 0.5])
def test_it_lands_softly_as_in_small_steps(gives: float) -> None:
    """Of what pulls the stem beyond a stop a share is left: it arrives, and not at its full speed."""
    form, short = effect("friction_in_motion").form("elastic_landing"), replace(DesignModel(), travel=0.9)
    got = stem(Plant(short, [Inserted("friction_in_motion", form, (0.02, gives, gives))]))
    assert np.max(np.abs(got - stepped(0.02, gives=gives, d=short))) < 0.001 * 0.5625
    assert bool(got.max() == short.travel) is (gives > 0.0)


def test_it_lands_alike_at_either_end() -> None:
    """The same valve upside down."""
    d, form = DesignModel(), effect("friction_in_motion").form("elastic_landing")
    about = d.offset + 0.5 * d.travel / d.compliance
    pressure = np.interp(TIME_S, [0, 10, 30, 35, 60], [4.0, 13.0, 13.0, 4.0, 4.0])
    ends = (pressure, 0.0, (0.0, 0.3)), (2.0 * about - pressure, d.travel, (0.3, 0.0))
    lands = [Plant(d, [Inserted("friction_in_motion", form, (0.02, *gives))]) for _, _, gives in ends]
    up, down = (stem_from(one, p, x) for one, (p, x, _) in zip(lands, ends, strict=True))
    np.testing.assert_allclose(up, d.travel - down, atol=1e-9)
    assert up.max() == d.travel and 0.0 < up[-1] < 1e-4
