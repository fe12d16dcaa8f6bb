"""Numbers that are all wrong at once: fitted together from the design, they may get stuck."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from logs.recording import FloatArray
from tests.twin.trials import DESIGN, SIGMA, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.retuning import retuned
from twin.fit.space import ACCUSED_SPREAD, make_space
from twin.model.effect import Scales
from twin.model.plant import Plant

PLAIN = Plant(replace(DESIGN, a1=7.3, a2=7.3, tau_s=5.0))  # without a deadband, as somebody may have written it
STEPS = np.repeat(np.random.default_rng(1).uniform(0.0, 1.0, 20), 150)
RAMPS = np.abs((np.arange(3000) / 500.0) % 2.0 - 1.0)


def channel_of(deadband_psi: float, tau_s: float, command_psi: FloatArray) -> Channel:
    true = Plant(replace(DESIGN, a1=7.3 + deadband_psi / 2.0, a2=7.3 - deadband_psi / 2.0, tau_s=tau_s))
    return position_channel([trial_of(true, command_psi)[0]], SIGMA)


def together(channel: Channel) -> float:
    space = make_space(PLAIN, (), channel.numbers, Scales(), ACCUSED_SPREAD)
    return fit(channel, space, starts_of(space, (), channel.recordings), rounds=20).mse


@pytest.mark.parametrize(
    ("deadband_psi", "tau_s", "command_psi", "stuck"),
    [
        (2.0, 5.0, 9.0 + 2.7 * STEPS, 100.0),  # one number more than alone is enough
        (1.0, 10.0, 9.0 + 2.5 * RAMPS, 20.0),  # here two are needed
    ],
)
def test_numbers_that_get_stuck_together_set_out_once_more_from_a_few_of_them(
    deadband_psi: float, tau_s: float, command_psi: FloatArray, stuck: float
) -> None:
    channel = channel_of(deadband_psi, tau_s, command_psi)
    assert together(channel) > stuck
    found = retuned(channel, PLAIN, Scales())
    assert found.mse < 1.1
    assert found.plant.design.a1 - found.plant.design.a2 == pytest.approx(deadband_psi, rel=0.02)
    assert found.names == ()


def test_numbers_that_explain_all_at_once_are_left_there(monkeypatch: pytest.MonkeyPatch) -> None:
    channel = channel_of(1.0, 5.0, 9.0 + 2.5 * RAMPS)
    monkeypatch.setattr("twin.fit.retuning._only", None)
    assert retuned(channel, Plant(DESIGN), Scales()).mse < 1.1
