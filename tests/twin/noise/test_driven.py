"""A cause that moves in jumps is judged given the measured pressure: from the command alone a slip comes too early."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.choose.decide import Decision
from twin.diagnosis import Cause as Named
from twin.fit.channel import Channel, chain_channel, position_channel
from twin.fit.fitting import Fit, fit
from twin.fit.space import Cause, make_space
from twin.judge.gap import GapParts, driven_errors
from twin.judge.heldout import errors_on_channel, tied_note
from twin.judge.upheld import upheld
from twin.judge.verdict import Judgement
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.record.sensing import Sensing
from twin.search.findings import Findings
from twin.search.score import yardstick_for
from twin.where.closure import rms

STUCK = Judgement("effect", (Named("stiction", "actuator", 0.9, None, {}),), (), ())


def inserted(name: str, form: str, *values: float) -> Inserted:
    return Inserted(name, effect(name).form(form), values)


def on_a_wrong_converter(one: Inserted) -> Channel:
    """The position, given the pressure of a converter that is a little off."""
    off = inserted("ep_calibration", "gain_and_zero", 0.0, 0.02)
    trial, _ = trial_of(Plant(DESIGN, (off, one)), np.round(staircase(), 1))
    return position_channel([trial], SIGMA)


def fitted(channel: Channel, one: Inserted) -> Fit:
    cause = Cause(one.effect, effect(one.effect), one.form)
    space = make_space(Plant(DESIGN), (cause,), (), Scales())
    z = [(v - p.neutral) / p.scale for v, p in zip(one.values, one.form.parameters, strict=True)]
    return fit(channel, space, [np.array(z)], rounds=0)


def decided(channel: Channel, accepted: Fit) -> Decision:
    none = fit(channel, make_space(Plant(DESIGN), (), (), Scales()), [np.zeros(0)])
    findings = Findings(channel, none, none, (accepted,), yardstick_for([none, accepted], channel.use))
    return Decision(findings, accepted, True, True, 0.0)


def test_slips_are_right_given_the_pressure_and_wrong_from_the_command() -> None:
    sticks = inserted("stiction", "target_sticks", 0.3, 0.03)
    channel = on_a_wrong_converter(sticks)
    one = fitted(channel, sticks)
    assert rms(errors_on_channel(one, channel)) == pytest.approx(1.0, abs=0.3)
    from_command = chain_channel(channel.trials, SIGMA).residuals(one.plant)
    assert rms(from_command) > 3.0
    before, after = driven_errors([decided(channel, one)]) or (0.0, 0.0)
    assert before == pytest.approx(SIGMA * rms(channel.residuals(Plant(DESIGN))[channel.use]))
    assert after == pytest.approx(SIGMA * rms(errors_on_channel(one, channel)))


def test_what_is_not_erratic_or_has_no_pressure_is_judged_from_the_command() -> None:
    slow = inserted("creep", "one_tail", 0.1, 8.0)
    channel = on_a_wrong_converter(slow)
    assert driven_errors([decided(channel, fitted(channel, slow))]) is None
    sticks = inserted("stiction", "target_sticks", 0.3, 0.03)
    chain = chain_channel(channel.trials, SIGMA)
    assert driven_errors([decided(chain, fitted(chain, sticks))]) is None


@pytest.mark.parametrize(
    ("driven", "verdict"), [(None, "unexplained"), ((16.0, 1.5), "effect"), ((16.0, 9.0), "unexplained")]
)
def test_it_stands_by_what_it_leaves_given_the_pressure(driven: tuple[float, float] | None, verdict: str) -> None:
    parts = GapParts(*(np.full(8, level) for level in (16.0, 12.0, 8.5)), {}, {}, driven)
    assert upheld(parts, STUCK, 1.0, Sensing((), {}, 0.0), True)[1].verdict == verdict


def test_the_answer_says_so() -> None:
    base = Plant(replace(DESIGN, travel=0.5))
    assert "from 2 to 0.2 % of travel" in tied_note(["stiction"], base, (0.01, 0.001))[0].handled
    assert "given" not in tied_note(["stiction"], base)[0].handled
    assert not tied_note(["creep"], base, (0.01, 0.001))
