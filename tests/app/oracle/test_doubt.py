"""The filter is as sure as it should be: against the plant's own chance, and against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from app.oracle.doubt import Doubt, outside
from app.physics_bench import open_virtual


def test_the_unrest_of_the_pilot_is_known_as_well_as_it_says() -> None:
    """A command in force for long, four times the usual noise, many valves: misses over the deviation claimed."""
    misses = []
    for seed in range(40):
        opened = open_virtual(seed, noise=4.0)
        doubt, state = Doubt(4.0), opened.bench.physics.state  # type: ignore[attr-defined]
        opened.bench.exchange(9.0)
        for tick in range(1, 600):
            opened.clock.sleep_until(0.1 * tick)
            seen = opened.bench.exchange(9.0)
            assert seen.pressure is not None
            doubt = doubt.later(0.1)
            if tick > 40:
                doubt = doubt.read(seen.pressure.value - 9.0, 0.0, 0.0, 0.1)
        misses.append((doubt.wander_psi - 4.0 * float(state["wander"][0])) / np.sqrt(doubt.wander_var))
    assert np.sqrt(np.mean(np.square(misses))) == pytest.approx(1.0, abs=0.3)


def test_a_push_hands_on_what_the_unrest_is_mistaken_by() -> None:
    doubt = Doubt(1.0, wander_var=1e-6).pushed(0.19)
    assert doubt.off_sd_in == pytest.approx(0.19e-3)
    seen = doubt.read(0.0, 0.19e-3, 1.0, 0.1)
    assert 0.0 < seen.off_in < 0.19e-3 and seen.wander_psi > 0.0 and seen.off_sd_in < doubt.off_sd_in
    assert doubt.on_stop().off_sd_in == 0.0


@pytest.mark.parametrize(("mean", "sd"), [(0.0, 1.0), (0.7, 0.3), (-2.0, 0.5)])
def test_the_chance_to_be_outside(mean: float, sd: float) -> None:
    assert outside(mean, sd, 1.0) == pytest.approx(norm.cdf(-1.0, mean, sd) + norm.sf(1.0, mean, sd))
    assert outside(mean, 0.0, 1.0) == float(abs(mean) > 1.0)
