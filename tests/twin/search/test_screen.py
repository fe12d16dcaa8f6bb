"""The look at further causes picks the one that is there, and costs one simulation per start."""

from __future__ import annotations

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.larger_steps import in_larger_steps
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.screen import make_screen, prospects


def cause(name: str, form: str) -> Cause:
    return Cause(name, effect(name), effect(name).form(form))


def channel_with(*effects: Inserted) -> Channel:
    trial, _ = trial_of(Plant(DESIGN, effects), staircase())
    return position_channel([trial], SIGMA)


@pytest.mark.parametrize("larger", [1.0, 4.0])
def test_the_missing_cause_comes_first(larger: float) -> None:
    damping = Inserted("asymmetric_damping", effect("asymmetric_damping").form("two_lags"), (0.15,))
    bow = Inserted("lvdt_nonlinearity", effect("lvdt_nonlinearity").form("bow"), (0.012,))
    channel = channel_with(damping, bow)
    base, scales = Plant(DesignModel()), Scales()
    known = cause("asymmetric_damping", "two_lags")
    space = make_space(base, (known,), channel.numbers, scales)
    parent = fit(channel, space, starts_of(space))
    rivals = [
        cause("lvdt_nonlinearity", "bow"),
        cause("lvdt_drift", "linear"),
        cause("linkage_lost_motion", "play"),
        cause("friction_drift", "linear"),
        cause("sensor_lag", "first_order"),
    ]
    look = in_larger_steps(channel, larger, least=100)
    assert look.larger == (larger > 1.0)
    screen = make_screen(look, base, parent)
    found = prospects(screen, [(known, rival) for rival in rivals], [])
    assert found[0].causes[-1].name == "lvdt_nonlinearity"
    full = fit(channel, found[0].space, [found[0].start])
    assert full.mse < 1.2
    # the look promises about what the fit then gets, and that nothing else would
    assert found[0].gain / look.channel.rows > 0.5 * (parent.mse - full.mse)
    assert found[-1].gain < 0.5 * found[0].gain


@pytest.mark.parametrize("larger", [1.0, 4.0])
def test_what_is_to_be_explained_was_left_by_the_fit_and_not_by_larger_steps(larger: float) -> None:
    channel = channel_with()
    base = Plant(DesignModel())
    look = in_larger_steps(channel, larger, least=100)
    parent = fit(channel, make_space(base, (), (), Scales()), [np.zeros(0)])
    screen = make_screen(look, base, parent)
    left = np.concatenate([parent.residuals[look.rows], np.zeros(screen.z.size)])
    np.testing.assert_allclose(screen.r, left - screen.basis @ (screen.basis.T @ left), atol=1e-9)
    here = look.channel.residuals(screen.space.plant(screen.z))
    assert not screen._way(here).any()  # where it stands nothing moves
    assert (larger > 1.0) == bool(np.abs(here - left[: here.size]).max() > 1e-6)


@pytest.mark.parametrize("larger", [1.0, 4.0])
def test_nothing_is_promised_where_nothing_is_missing(larger: float) -> None:
    channel = channel_with()
    base = Plant(DesignModel())
    empty = make_space(base, (), (), Scales())
    screen = make_screen(in_larger_steps(channel, larger, least=100), base, fit(channel, empty, [np.zeros(0)]))
    one = screen.prospect((cause("lvdt_drift", "linear"),), [])
    assert 0.0 <= one.gain < 20.0  # of some four thousand squares


def test_a_form_whose_best_start_is_known_from_beside_another_is_looked_at_there_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spot = Inserted("position_dependent_friction", effect("position_dependent_friction").form("spot"), (0.3, 0.3, 0.1))
    channel = channel_with(spot)
    base, scales = Plant(DesignModel()), Scales()
    ends = [
        fit(channel, space, starts_of(space))
        for name in ("one_tail", "two_tails")
        for space in (make_space(base, (cause("creep", name),), channel.numbers, scales),)
    ]
    first, second = (make_screen(in_larger_steps(channel), base, end) for end in ends)
    zone = cause("position_dependent_friction", "spot")
    [seen] = prospects(first, [(*ends[0].space.causes, zone)], [])
    looks: list[int] = []
    residuals = Channel.residuals
    monkeypatch.setattr(Channel, "residuals", lambda *given: looks.append(1) or residuals(*given))
    [near] = prospects(second, [(*ends[1].space.causes, zone)], [], [seen])
    assert len(looks) == 1
    [far] = prospects(second, [(*ends[1].space.causes, zone)], [])
    assert len(looks) > 5
    np.testing.assert_array_equal(near.own, seen.own)
    assert len(near.own) == len(zone.form.parameters) if zone.form else False
    assert near.gain > 0.8 * far.gain
    assert far.left < far.before
    assert far.left == far.before - far.gain
