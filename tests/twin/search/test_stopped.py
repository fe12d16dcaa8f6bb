"""A search that is stopped ends soon: its threads do not finish their portions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.search.test_pairs import channel_of
from tests.twin.trials import DESIGN
from twin.fit.fitting import fit
from twin.fit.space import Cause, make_space
from twin.model.effect import Scales
from twin.model.plant import Plant
from twin.search.search import Searcher
from twin.search.search_rules import SearchRules


def test_who_stops_the_search_does_not_wait_for_what_its_threads_have_before_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    channel, begun, by_then = channel_of(Plant(DESIGN)), [0], [0]

    def counted(*args: Any, **how: Any) -> Any:
        begun[0] += 1
        return fit(*args, **how)

    def stop(_what: str, _share: float) -> None:
        by_then[0] = begun[0]
        raise KeyboardInterrupt

    monkeypatch.setattr("twin.search.search.fit", counted)
    searcher = Searcher(channel, Plant(DesignModel()), Scales(), SearchRules(threads=2), stop)
    none = make_space(Plant(DesignModel()), (), channel.numbers, Scales())
    parent = fit(channel, none, [np.zeros(len(channel.numbers))])
    numbers = [(Cause(f"parameter:{name}"),) for name in channel.numbers]
    with pytest.raises(KeyboardInterrupt):
        searcher._each(lambda todo: searcher._beyond(parent, todo), [numbers[:1], *([numbers * 20] * 2)], "2 causes")
    assert begun[0] <= by_then[0] + 4 < 100  # what both had just begun
