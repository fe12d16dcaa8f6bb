"""One more cause beside each of the likeliest hypotheses: every pair once, numbers and effects, in their order."""

from __future__ import annotations

import numpy as np

from control.design import DesignModel
from tests.twin.search.test_pairs import cause, channel_of
from tests.twin.trials import DESIGN
from twin.fit.fitting import Fit, fit
from twin.fit.space import Cause, make_space
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.search.search import Searcher
from twin.search.search_rules import SearchRules

BASE = Plant(DesignModel())


def searcher() -> Searcher:
    return Searcher(channel_of(Plant(DESIGN)), BASE, Scales(), SearchRules(threads=2))


def alone(one: Searcher, what: Cause) -> Fit:
    space = make_space(BASE, (what,), one.channel.numbers, Scales())
    return fit(one.channel, space, [np.zeros(len(space.unknowns))], rounds=1)


def test_what_runs_side_by_side_comes_back_in_its_order() -> None:
    assert searcher()._each(lambda k: 2 * k, [3, 1, 2, 0], "one cause") == [6, 2, 4, 0]


def test_two_causes_are_put_together_once() -> None:
    one = searcher()
    bow, creep = cause("lvdt_nonlinearity", "bow"), cause("creep", "one_tail")
    found = one._further([alone(one, bow), alone(one, creep)], [bow, creep])
    assert sorted(len(todo) for _, todo in found) == [0, 1]


def test_numbers_and_effects_are_looked_for_beyond_a_hypothesis() -> None:
    one = searcher()
    parent = alone(one, cause("lvdt_nonlinearity", "bow"))
    more = [Cause("parameter:tau"), cause("creep", "one_tail")]
    fits = one._beyond(parent, [(*parent.space.causes, c) for c in more])
    assert [f.names[-1] for f in fits] == ["parameter:tau", "creep"]
