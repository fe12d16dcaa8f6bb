"""Of the same causes in several forms the likelier one goes on, by the measure by which causes are compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from tests.twin.choose.test_outside import a_fit
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import position_channel
from twin.fit.space import Cause
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search import search
from twin.search.claims import best_forms

BENT = effect("lvdt_nonlinearity")
TABLE, BOW = (Cause(BENT.name, BENT, BENT.form(name)) for name in ("table", "bow"))


def test_a_law_goes_on_where_a_curve_only_follows_what_wanders(monkeypatch: pytest.MonkeyPatch) -> None:
    """A table follows what wanders beside a bow, and leaves less; counted by what is independent it is not worth it."""
    trial, _ = trial_of(Plant(DESIGN, (Inserted(BENT.name, BENT.form("bow"), (0.012,)),)), staircase())
    slow = lfilter([1.0], [1.0, -0.98], np.random.default_rng(7).normal(0.0, 0.2 * SIGMA, trial.recording.n))
    recording = replace(trial.recording, position=trial.recording.position + slow)
    channel = position_channel([replace(trial, recording=recording)], SIGMA)
    monkeypatch.setattr(search, "effect_causes", lambda _channel, _base: [TABLE, BOW])
    searcher = search.Searcher(channel, Plant(DESIGN), Scales(), search.SearchRules(most=1))
    findings = searcher.run()
    table, bow = (next(f for f in searcher.tried if f.space.causes == (c,)) for c in (TABLE, BOW))
    assert table.mse < bow.mse - 0.01
    assert [f.space.causes for f in findings.fits if f.names == (BENT.name,)] == [bow.space.causes]


def test_of_nothing_there_is_no_best_form() -> None:
    none = a_fit((), 1.0)
    assert best_forms([], np.ones(1, dtype=np.bool_), none) == []
