"""Design numbers that are far off: from where they are looked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record
from tests.twin.trials import SIGMA, trial_of
from twin.fit.case import make_case
from twin.fit.channel import chain_channel, position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant


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


@pytest.mark.parametrize("covered", [0.1, 0.7, 4.0])
def test_a_deadband_is_looked_for_within_what_the_commands_cover(covered: float) -> None:
    """Of a loop about its set point: from a start wider than its commands, the stem never moves."""
    record = a_record(Plant(DesignModel()))
    command = 9.0 + covered * (record.command - record.command.min()) / np.ptp(record.command)
    channel = chain_channel(make_case([replace(record, command=command, pressure=None)], DesignModel()).trials, 4e-4)
    space = make_space(Plant(DesignModel()), (Cause("parameter:deadband"),), ["deadband"], Scales())
    started, always = (
        sorted(float(z[0] * space.unknowns[0].unit) for z in starts_of(space, (), records))
        for records in (channel.recordings, ())
    )
    near = sorted(set(started) - set(always))
    assert set(always) <= set(started)
    assert near == pytest.approx({0.1: [0.07], 0.7: [0.21, 0.49], 4.0: [1.2]}[covered])


@pytest.mark.parametrize("missing", [0.11, 0.17, 0.265, 0.32])
def test_a_stop_that_few_levels_pass_is_found(missing: float) -> None:
    """A start beyond what the record reached does nothing, and one far within it costs more than that."""
    stop = effect("reduced_travel")
    true = Plant(DesignModel(), (Inserted(stop.name, stop.form("upper_stop"), (missing,)),))
    highest = DesignModel().a1 + (1.019 - missing) * DesignModel().travel / DesignModel().compliance
    levels = np.array([7.0, 9.0, 6.0, highest, 5.5, 8.8, 6.5, 8.5])
    trial, _ = trial_of(true, np.repeat(levels, 250))
    channel = position_channel([trial], SIGMA)
    space = make_space(
        Plant(DesignModel()), (Cause(stop.name, stop, stop.form("upper_stop")),), channel.numbers, Scales()
    )
    found = fit(channel, space, starts_of(space, (), channel.recordings), rounds=6)
    assert found.values()[-1] == pytest.approx(missing, abs=2e-3)
    assert found.mse < 1.1


def test_a_deadband_as_wide_as_most_of_the_commands_is_found() -> None:
    """A design that stands still may be off by less than any that moves too much: no way leads on from there."""
    design = replace(DesignModel(), a1=8.0, a2=8.0)
    true = replace(design, a1=8.108, a2=7.892)
    levels = 10.0 + 0.12 * np.array([1.0, -1.0, 0.9, -0.9, 1.0, -1.0, 0.95, -0.95])
    whole = trial_of(Plant(true), np.repeat(levels, 150))[0].recording
    later = slice(300, None)  # it came to its first level from elsewhere
    rows = {name: getattr(whole, name)[later] for name in ("time_s", "command", "position")}
    channel = chain_channel(make_case([replace(whole, **rows, pressure=None)], design).trials, SIGMA)
    space = make_space(Plant(design), (Cause("parameter:deadband"),), ["deadband"], Scales())
    starts = starts_of(space, (), channel.recordings)
    still = min(starts, key=lambda z: float(np.sum(np.square(channel.residuals(space.plant(z))))))
    assert channel.stands(space.plant(still))
    assert fit(channel, space, starts, rounds=6).mse < 1.5


@pytest.mark.parametrize(("swing_psi", "period_s", "met"), [(2.2, 20.0, True), (1.5, 15.0, False)])
def test_a_lower_rate_limit_is_found_beside_a_longer_lag(swing_psi: float, period_s: float, met: bool) -> None:
    """The longer lag alone explains most, and beside it the design's own limit is never met; where no other is met
    either, it stays the design's."""
    true = replace(DesignModel(), rate_limit=0.084, tau_s=3.5)
    phase = 2.0 * np.pi * 0.1 / period_s * np.arange(1500)
    trial, _ = trial_of(Plant(true), 8.8 + swing_psi * np.sin(phase) + np.sin(phase / 0.31))
    channel = position_channel([trial], SIGMA)
    numbers = [Cause("parameter:tau"), Cause("parameter:rate_limit")]
    space = make_space(Plant(DesignModel()), numbers, ["tau", "rate_limit"], Scales())
    found = fit(channel, space, starts_of(space, (), channel.recordings), rounds=6)
    assert found.mse < 1.1
    assert found.values() == pytest.approx([3.5, 0.084 if met else DesignModel().rate_limit], rel=0.02)
