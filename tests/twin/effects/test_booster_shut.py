"""Converters with a booster whose air nobody knows well: a pilot that shuts, a port with little dirt."""

from __future__ import annotations

import numpy as np
import pytest

from tests.twin.judged import a_record
from tests.twin.kernels.test_booster import D, plant, pressure
from twin.diagnose import Settings, diagnose
from twin.fit.channel import pressure_channel
from twin.fit.trial import make_trial
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search import search
from twin.search.candidates import effect_causes
from twin.search.search_rules import SearchRules

#: A pilot with an overlap [psi], alone and with two fifths less air behind it than was known.
SHUT = {"overlap_and_chamber": (0.1, -0.4), "overlap": (0.1,)}


def test_a_port_with_little_dirt_is_found_with_the_chamber_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its starts are far off, for ports that never limited anything; the search begins again where `port` ended."""
    known = plant(0.0067, 0.0109, 3.7)
    port = Inserted("fill_exhaust_asymmetry", effect("fill_exhaust_asymmetry").form("port"), (0.8,))
    record = a_record(known.having((port,)), seed=5)
    channel = pressure_channel([make_trial(record, 0.05)], 0.008)
    causes = [c for c in effect_causes(channel) if c.form is not None and c.form.name.startswith("port")]
    monkeypatch.setattr(search, "effect_causes", lambda _channel, _base: causes)
    searcher = search.Searcher(channel, known, Scales(), SearchRules(most=1))
    searcher.run()
    plain, chamber = (next(f for f in searcher.tried if f.space.causes == (c,)) for c in causes)
    assert max(plain.mse, chamber.mse) < 1.3


def test_a_shut_pilot_shows_the_chamber() -> None:
    """Between its edges only the stem moves the pressure, by what it sweeps; without a booster it sweeps nothing."""
    shut, edges = ((effect("ep_deadband").form(name), values) for name, values in SHUT.items())
    other, same = Inserted("ep_deadband", *shut), Inserted("ep_deadband", *edges)
    want = pressure(plant(0.1, 0.15, 1.5).having((same,)))
    known = plant(0.1 * 1.75 / 2.25, 0.15 * 1.75 / 2.25, 2.5)  # with the same slopes, the stem half way
    np.testing.assert_allclose(pressure(known.having((other,))), want, atol=1e-12)
    assert np.abs(pressure(known.having((same,))) - want).max() > 0.05
    np.testing.assert_allclose(pressure(Plant(D, (other,))), pressure(Plant(D, (same,))), atol=1e-12)


@pytest.mark.thorough
def test_a_shut_pilot_is_named_alone_where_the_booster_is_not_known_well() -> None:
    """One that always opened hardly shows how much air the stem takes: the design has three times as much."""
    band = Inserted("ep_deadband", effect("ep_deadband").form("overlap"), (0.15,))
    record = a_record(plant(0.012, 0.016, 1.2).having((band,)), seed=5)
    known = plant(0.007, 0.011, 3.7)
    found = diagnose([record], D, known.inserted, Settings(search=SearchRules(most=2))).diagnosis
    assert [c.name for c in found.causes] == ["ep_deadband"]
    assert found.causes[0].parameters["band"].value == pytest.approx(0.15, rel=0.05)
