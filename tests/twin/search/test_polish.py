"""What a pair has moved is looked for again where the response jumps."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from logs.recording import Recording
from tests.twin.loops import D, plant
from twin.fit.case import make_case
from twin.fit.channel import Channel, pressure_channel
from twin.fit.fitting import Fit, fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.replay.simulate import simulate_recording
from twin.search.polish import polished

BAND_PSI, SIGMA_PSI = 0.28, 0.008


def near(channel: Channel, form: str, band_psi: float) -> Fit:
    """The fit of a converter that ignores errors, from a band that is somewhat off."""
    held = effect("ep_deadband")
    space = make_space(Plant(D), (Cause("ep_deadband", held, held.form(form)),), (), Scales())
    start = starts_of(space)[0]
    start[0] = band_psi / space.unknowns[0].unit
    return fit(channel, space, [start])


def waves(one: Plant) -> Recording:
    """Four minutes in which the command is never still, so that all that is accepted depends on all before."""
    time_s = np.arange(0.0, 240.0, 0.1)
    command = 9.5 + 3.0 * np.sin(time_s / 7.0) + 0.8 * np.sin(time_s / 2.3)
    record = Recording("valve", time_s, command, np.zeros(time_s.size), np.full(time_s.size, 9.5))
    pressure, _ = simulate_recording(one, record)
    noisy = pressure + np.random.default_rng(4).normal(0.0, SIGMA_PSI, time_s.size)
    return replace(record, pressure=noisy)


@pytest.mark.parametrize(("form", "truth"), [("hold", (BAND_PSI,)), ("overlap_latched", (BAND_PSI, 0.1))])
@pytest.mark.parametrize("off", [0.8, 1.05, 1.3])
def test_a_narrow_valley_beside_is_found(form: str, truth: tuple[float, ...], off: float) -> None:
    record = waves(plant("before the lag", "ep_deadband", form, truth))
    channel = pressure_channel(make_case([record], D, ()).trials, SIGMA_PSI)
    beside = near(channel, form, off * BAND_PSI)
    assert beside.mse > 1.2  # the descent alone finds no way there
    with ThreadPoolExecutor(2) as pool:
        found = polished(channel, [beside], 1, pool)[0]
    assert found.mse < 1.02
    assert found.values() == pytest.approx(truth, rel=0.02)
