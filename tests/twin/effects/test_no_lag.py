"""A design whose stem has no lag is legal: no effect divides by it."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from twin.model.catalog import effects
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording


@pytest.mark.parametrize("name", sorted(effects()))
def test_every_form_of_an_effect_can_be_simulated(name: str) -> None:
    record = a_record(Plant(DesignModel()), n=100)
    for form in effects()[name].forms:
        inserted = Inserted(name, form, tuple(p.starts[0] for p in form.parameters))
        for signal in simulate_recording(Plant(DesignModel(tau_s=0.0), (inserted,)), record):
            assert np.all(np.isfinite(signal)), form.name
