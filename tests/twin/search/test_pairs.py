"""Two causes of which neither shows alone come first by their moves added up; the search names both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from control.design import DesignModel
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.choose.decide import decide
from twin.choose.rules import DecisionRules
from twin.fit.channel import Channel, position_channel
from twin.fit.fitting import Fit, fit
from twin.fit.larger_steps import in_larger_steps
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.claims import together
from twin.search.pairs import _best_of_each, _gains, promising_pairs
from twin.search.reform import better_of_each, in_laws, in_other_forms
from twin.search.screen import make_screen
from twin.search.search import Searcher
from twin.search.search_rules import SearchRules


def cause(name: str, form: str) -> Cause:
    return Cause(name, effect(name), effect(name).form(form))


def channel_of(plant: Plant) -> Channel:
    trial, _ = trial_of(plant, staircase())
    return position_channel([trial], SIGMA)


@pytest.mark.parametrize("larger", [1.0, 4.0])
def test_the_pair_that_is_there_is_among_the_first_and_alone_fits(larger: float) -> None:
    bow = Inserted("lvdt_nonlinearity", effect("lvdt_nonlinearity").form("bow"), (0.012,))
    drift = Inserted("friction_drift", effect("friction_drift").form("linear"), (4e-4,))
    channel = channel_of(Plant(DESIGN, (bow, drift)))
    base = Plant(DesignModel())
    alone = fit(channel, make_space(base, (), (), Scales()), [np.zeros(0)])
    screen = make_screen(in_larger_steps(channel, larger, least=100), base, alone)
    causes = [
        cause("lvdt_nonlinearity", "bow"),
        cause("friction_drift", "linear"),
        cause("linkage_lost_motion", "play"),
        cause("asymmetric_damping", "two_lags"),
        cause("creep", "one_tail"),
    ]
    found = promising_pairs(screen, causes, [], together)
    assert len(found) == 10
    fits = [fit(channel, pair.space, [pair.start]) for pair in found[:3]]
    assert [set(f.names) for f in fits if f.mse < 1.2] == [{"lvdt_nonlinearity", "friction_drift"}]


def test_pairs_are_tried_in_the_forms_that_did_not_do_best_alone() -> None:
    def alone(one: Cause, mse: float) -> Fit:
        space = make_space(Plant(DESIGN), (one,), (), Scales())
        return Fit(space, np.zeros(len(space.unknowns)), mse, 0.0, np.zeros(1), np.zeros((1, 1)), 1)

    play, one_sided = cause("linkage_lost_motion", "play"), cause("linkage_lost_motion", "one_sided")
    stops = [cause("reduced_travel", f.name) for f in effect("reduced_travel").forms]
    tried = [alone(c, 9.0) for c in (play, one_sided, *stops)]
    best = alone(one_sided, 3.0)
    both = replace(best, space=make_space(Plant(DESIGN), (one_sided, stops[0]), (), Scales()))
    number = replace(best, space=make_space(Plant(DESIGN), (one_sided, Cause("parameter:tau")), ("tau",), Scales()))
    [found] = in_other_forms([both, number], tried, 6)
    assert [one.space.causes for one, _ in found] == [(play,), (one_sided,)]
    assert [{c[1].form.name for c in todo if c[1].form} for _, todo in found] == [
        {f.name for f in effect("reduced_travel").forms},
        {f.name for f in effect("reduced_travel").forms[1:]},
    ]
    assert in_other_forms([both, number], tried, 0) == []


@pytest.mark.thorough
def test_a_pair_is_found_of_which_neither_form_did_best_beside_the_other_ones_best() -> None:
    stop = Inserted("reduced_travel", effect("reduced_travel").form("lower_stop"), (0.0275,))
    loose = Inserted("linkage_lost_motion", effect("linkage_lost_motion").form("play"), (0.02,))
    strokes = np.repeat(np.random.default_rng(1).uniform(4.0, 13.0, 16), 160)
    channel = position_channel([trial_of(Plant(DESIGN, (stop, loose)), strokes)[0]], SIGMA)
    rules = SearchRules(threads=2, most=2, paired=0)
    left = []
    for reformed in (8, 0):
        found = Searcher(channel, Plant(DesignModel()), Scales(), replace(rules, reformed=reformed)).run().fits
        left.append(min(f.mse for f in found if set(f.names) == {"reduced_travel", "linkage_lost_motion"}))
    assert left[0] < 1.1 and left[1] > 1.5


@given(st.integers(0, 10_000))
def test_the_promise_of_a_pair_is_what_it_takes_away(seed: int) -> None:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(4, 30))
    r = rng.normal(size=30)
    gains, sizes = _gains(directions @ directions.T, -directions @ r)
    for i in range(4):
        for j in range(i):
            moved = r + sizes[i, j] * directions[i] + sizes[j, i] * directions[j]
            np.testing.assert_allclose(gains[i, j], r @ r - moved @ moved, atol=1e-9)
            assert gains[i, j] >= -1e-9


@given(st.lists(st.integers(0, 5), min_size=2, max_size=12), st.integers(0, 10_000))
def test_the_best_of_every_two_names_is_what_a_plain_search_finds(which: list[int], seed: int) -> None:
    effects = ("creep", "stiction", "sensor_lag", "lvdt_drift", "friction_drift", "dead_time")
    causes = [Cause(effects[k], effect(effects[k]), effect(effects[k]).forms[n % 2 - 1]) for n, k in enumerate(which)]
    gains = np.random.default_rng(seed).normal(size=(len(which), len(which)))
    apart = {frozenset(effects[:2])}  # these two mean nothing beside each other
    best: dict[frozenset[str], tuple[float, int, int]] = {}
    for i in range(len(which)):
        for j in range(i + 1, len(which)):
            names = frozenset((causes[i].name, causes[j].name))
            if len(names) == 2 and names not in apart:
                best[names] = max(best.get(names, (-np.inf, 0, 0)), (float(gains[i, j]), i, j))
    found = _best_of_each(causes, gains, lambda a, b: frozenset((a.name, b.name)) not in apart)
    assert found == sorted(best.values(), reverse=True)


@pytest.mark.thorough
def test_a_wrong_number_beside_an_effect_is_named() -> None:
    # The effect alone explains everything with the number as its nuisance: only what that costs gives it away.
    creep = Inserted("creep", effect("creep").form("one_tail"), (0.12, 30.0))
    wrong = DesignModel(rate_limit=0.07)
    trial, _ = trial_of(Plant(wrong, (creep,)), staircase())
    channel = position_channel([trial], SIGMA)
    findings = Searcher(channel, Plant(DESIGN), Scales(), SearchRules(threads=2)).run()
    assert set(decide(findings, DecisionRules()).names) == {"creep", "parameter:rate_limit"}


@pytest.mark.thorough
def test_a_third_cause_is_not_looked_for_when_two_leave_most() -> None:
    # Whatever the dice do is in no vocabulary; it repeats nowhere, and no two causes make a dent in it.
    trial, _ = trial_of(Plant(DESIGN), staircase()[:2000])
    dice = np.random.default_rng(3).normal(0.0, 0.01, 125)
    lost = replace(trial.recording, position=trial.recording.position + np.repeat(dice, 16))
    channel = position_channel([replace(trial, recording=lost)], SIGMA)
    rules = SearchRules(threads=2, beam=1, rounds=2, polish=2, paired=1, screened=1, forms=1)
    sizes = {len(f.names) for f in Searcher(channel, Plant(DESIGN), Scales(), rules).run().fits}
    assert 2 in sizes and 3 not in sizes
    bold = Searcher(channel, Plant(DESIGN), Scales(), replace(rules, hopeless=1.0)).run().fits
    assert 3 in {len(f.names) for f in bold}


@pytest.mark.thorough
def test_a_third_cause_is_not_looked_for_where_it_would_not_be_accepted() -> None:
    assert SearchRules().scant == DecisionRules().share
    lag = Inserted("additional_lag", effect("additional_lag").form("behind_stem"), (0.9,))
    bow = Inserted("lvdt_nonlinearity", effect("lvdt_nonlinearity").form("bow"), (0.02,))
    trial, _ = trial_of(Plant(DESIGN, (lag, bow)), staircase()[:2000])
    slow = 1e-3 * np.sin(np.arange(trial.recording.n) / 90.0)
    channel = position_channel(
        [replace(trial, recording=replace(trial.recording, position=trial.recording.position + slow))], SIGMA
    )
    rules = SearchRules(threads=2, beam=1, rounds=4, polish=2, paired=4, screened=3, forms=1, enough_share=0.0)
    found = Searcher(channel, Plant(DESIGN), Scales(), rules).run()
    two = min(f.mse for f in found.fits if len(f.names) == 2)
    assert 1.5 < two < 1.0 + rules.scant * (found.none.mse - 1.0)
    assert 3 not in {len(f.names) for f in found.fits}
    bold = Searcher(channel, Plant(DESIGN), Scales(), replace(rules, scant=0.0)).run().fits
    assert 3 in {len(f.names) for f in bold}


def test_one_that_bends_all_numbers_does_not_end_the_search() -> None:
    """What leaves as little as noise at the price of numbers that nobody believes is no reason to look no further."""
    channel = channel_of(Plant(DESIGN))
    dice = np.random.default_rng(2).standard_normal(channel.use.size)

    def one(mse: float, prior: float) -> Fit:
        space = make_space(Plant(DESIGN), (cause("sensor_lag", "first_order"),), (), Scales())
        return Fit(space, np.zeros(1), mse, prior, np.sqrt(mse) * dice, np.eye(1), 1)

    searcher = Searcher(channel, Plant(DESIGN), Scales(), SearchRules(enough_share=0.001))
    none = one(3000.0, 0.0)
    assert searcher._nothing_left([one(3.0, 10.0), one(12.0, 2.0)], none)
    assert not searcher._nothing_left([one(3.0, 70_000.0), one(12.0, 2.0)], none)
    assert not searcher._nothing_left([one(12.0, 2.0)], none)


def test_without_either_cause_a_pair_is_fitted_from_where_the_pair_ended() -> None:
    """Alone in another form a cause may have done better; what the pair found for it is tried by itself, too."""
    bow = Inserted("lvdt_nonlinearity", effect("lvdt_nonlinearity").form("bow"), (0.012,))
    channel = channel_of(Plant(DESIGN, (bow,)))
    base = Plant(DesignModel())
    pair = (cause("lvdt_nonlinearity", "bow"), cause("creep", "one_tail"))
    others = (cause("friction_drift", "linear"), cause("lvdt_nonlinearity", "bow"))
    searcher = Searcher(channel, base, Scales(), SearchRules(threads=1))
    ended, worse = (
        fit(channel, make_space(base, causes, channel.numbers, Scales()), [start])
        for causes, start in ((pair, np.zeros(8)), (others, np.zeros(7)))
    )
    found = searcher._neighbours([replace(worse, mse=worse.mse + 1.0), ended])
    alone = [f for f in found if f.names == ("lvdt_nonlinearity",)]
    assert len(alone) == 1 and alone[0].mse < 1.2
    assert {f.names for f in found} >= {("lvdt_nonlinearity",), ("creep",), ("friction_drift",)}


def test_a_cause_that_had_stopped_far_from_its_best_alone_is_fitted_again_from_the_pair() -> None:
    """... and not where the pair is hardly better: then alone it is what it is."""
    bow = Inserted("lvdt_nonlinearity", effect("lvdt_nonlinearity").form("bow"), (0.012,))
    channel = channel_of(Plant(DESIGN, (bow,)))
    base = Plant(DesignModel())
    one, other = cause("lvdt_nonlinearity", "bow"), cause("creep", "one_tail")
    searcher = Searcher(channel, base, Scales(), SearchRules(threads=1))

    def ended(causes: tuple[Cause, ...], start: np.ndarray) -> Fit:
        return fit(channel, make_space(base, causes, channel.numbers, Scales()), [start])

    pair, alone = ended((one, other), np.zeros(8)), ended((one,), np.zeros(6))
    stuck = replace(alone, mse=20.0 * alone.mse)
    again = searcher._neighbours([pair, stuck])
    assert [f.mse < 1.2 for f in again if f.names == ("lvdt_nonlinearity",)] == [True]
    assert not [f for f in searcher._neighbours([pair, alone]) if f.names == ("lvdt_nonlinearity",)]
    best = better_of_each([pair, stuck, *again])
    assert [f.names for f in best] == [pair.names, ("lvdt_nonlinearity",), ("creep",)]
    assert best[1].mse < 1.2


def test_zeros_of_each_recordings_own_are_tried_as_a_law_beside_what_they_hide() -> None:
    base = Plant(DESIGN)
    candidates = [
        cause("lvdt_drift", "linear"),
        cause("lvdt_drift", "apart"),
        cause("lvdt_drift", "jump"),
        cause("lvdt_calibration", "zero"),
        cause("creep", "one_tail"),
        cause("position_dependent_friction", "spot"),
        cause("spring_asymmetry", "hinged_mid"),
    ]

    def laws(*causes: Cause) -> list[list[str]]:
        space = make_space(base, causes, (), Scales())
        one = Fit(space, np.zeros(len(space.unknowns)), 1.0, 0.0, np.zeros(1), np.zeros((1, 1)), 1)
        return [[f"{c.name} {c.form.name}" for c in some if c.form] for some in in_laws(one, candidates)]

    creeps = "creep one_tail"
    assert laws(candidates[4], candidates[1]) == [
        [creeps, "lvdt_calibration zero"],
        [creeps, "lvdt_drift linear", "lvdt_calibration zero"],
    ]
    assert laws(candidates[0]) == []
    assert laws(candidates[1], candidates[3]) == []
    assert laws(cause("position_dependent_friction", "profile")) == []  # what that hides is looked for like any pair
