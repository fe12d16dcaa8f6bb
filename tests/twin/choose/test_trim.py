"""What takes the place of causes that are left out, and what does not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from twin.choose import trim
from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.trim import _instead, doubtful, dropped, spoken, trimmed
from twin.choose.weigh import Weights
from twin.fit.space import Cause
from twin.model.catalog import effect


def one(name: str, mse: float, moved: float, unfelt: float = 0.0) -> Any:
    """A fit with one cause; `moved`: how far its design number went, as a share of itself."""
    found = None if name.startswith("parameter:") else effect(name)
    causes = [Cause(name, found, found.forms[0] if found else None)]
    space = SimpleNamespace(causes=causes, numbers=("deadband", "rate_limit"), spreads=np.ones(2), plant=lambda z: z)
    z = np.array([moved, unfelt])
    return SimpleNamespace(names=(name,), mse=mse, space=space, z=z, plant=z)


def best_instead(best: Any, left: Any, retuned: Any) -> Any:
    fits = (best, left)
    findings: Any = SimpleNamespace(
        none=one("parameter:tau", 16.2, 0.0),
        retuned=retuned,
        fits=fits,
        # nobody feels the rate limit, wherever it went
        channel=SimpleNamespace(residuals=lambda z: np.array([1e3, 1e-3]) * z),
        score=lambda f: -100.0 * f.mse,
        best_of_size=lambda _size: min(fits, key=lambda f: f.mse),
    )
    return _instead(findings, left, DecisionRules())


def test_an_effect_that_does_no_more_than_retuning_does_not_take_the_place_of_a_number() -> None:
    """Two wrong numbers of which one is left out: every effect beside re-tuned numbers explains both."""
    number, retuned = one("parameter:deadband", 1.24, 0.009), one("parameter:deadband", 0.97, 0.009, unfelt=-0.4)
    assert best_instead(one("reduced_travel", 0.97, 0.009), number, retuned) is number


def test_an_effect_that_spares_the_numbers_or_explains_more_does() -> None:
    number, retuned = one("parameter:deadband", 1.24, 0.009), one("parameter:deadband", 1.20, 0.009)
    for better in (one("reduced_travel", 0.97, 0.009), one("reduced_travel", 0.97, 0.001)):
        assert best_instead(better, number, retuned) is better


@pytest.mark.parametrize(
    ("own", "rival", "here", "sets", "kept"),
    [
        (0.5, 0.1, (), (), True),
        (0.44, 0.43, (), (("creep", "stiction"),), True),  # one of the two is sure
        (0.44, 0.43, (), (), False),  # not explained to the noise: another may be behind it
        (0.44, 0.30, (), (("creep", "stiction"),), False),  # a third may be
        (0.44, 0.43, (), (("stiction", "creep"),), False),  # the set of another cause
        (0.30, 0.30, ("stiction",), (("creep", "stiction"),), True),  # alike on this record
        (0.20, 0.20, ("stiction",), (("creep", "stiction"),), False),  # ... and not counted twice
    ],
)
def test_a_cause_is_doubtful_unless_it_or_one_of_two_is_likely(own, rival, here, sets, kept) -> None:
    assert doubtful("creep", {"creep": own, "stiction": rival}, here, sets) is not kept


def test_a_twin_is_no_rival_besides() -> None:
    """Its belief counts with the cause's own, and once."""
    probability = {"sensor_lag": 0.01, "additional_lag": 0.43}
    assert doubtful("sensor_lag", probability, (), (("sensor_lag", "additional_lag"),))


def pair(names: tuple[str, ...], mse: float, moved: float) -> Any:
    """A fit of several causes; `moved`: how far the deadband went, as a share of itself."""
    fit = one(names[0], mse, moved)
    return SimpleNamespace(**{**vars(fit), "names": names})


@pytest.mark.parametrize(("moved", "mse", "left"), [(0.24, 0.9, True), (0.02, 0.9, False), (0.24, 0.99, False)])
def test_a_number_that_an_effect_took_along_is_accused_when_the_effect_goes(moved, mse, left) -> None:
    """Unless it hardly moved, or accusing it explains no more."""
    alone = pair(("additional_lag",), 1.0, moved)
    with_number = pair(("additional_lag", "parameter:deadband"), mse, moved)
    both = pair(("additional_lag", "flow_force"), 0.8, 0.0)
    findings: Any = SimpleNamespace(
        none=one("parameter:tau", 16.2, 0.0), fits=(both, alone, with_number), score=lambda f: -200.0 * f.mse
    )
    decision = Decision(findings, both, True, True, 0.0)
    smaller = dropped(decision, "flow_force")
    assert smaller is not None
    assert smaller.accepted is (with_number if left else alone)
    number = dropped(replace(decision, accepted=with_number), "parameter:deadband")
    assert number is not None and number.accepted is alone  # what was dropped does not come back


def test_an_effect_and_the_number_that_stands_for_it_are_not_taken_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """The one went for the other without end: a case of a stranger's plant had no answer after 15 minutes."""
    force, pair = one("flow_force", 1.0, 0.0), one("creep", 1.0, 0.0)
    force.names, pair.names = ("flow_force", "linkage_lost_motion"), ("linkage_lost_motion", "parameter:tau")
    turns, left = {force.names: pair, pair.names: force}, iter(range(9))
    monkeypatch.setattr(trim, "weigh", lambda *_: SimpleNamespace(probability={}))
    monkeypatch.setattr(trim, "alike", lambda *_: ())
    monkeypatch.setattr(trim, "_without", lambda decision, *_: turns[decision.names] if next(left) < 8 else None)
    monkeypatch.setattr(trim, "_instead", lambda _findings, smaller, _rules: smaller)
    findings: Any = SimpleNamespace(none=one("parameter:tau", 50.0, 0.0))
    decision = Decision(findings, force, explained=True, gap=True, rest=0.0)
    assert trimmed(decision, DecisionRules(), Weights()).names == pair.names


@pytest.mark.parametrize(
    ("channel", "accused", "before", "heard"),
    [
        ("pressure", "parameter:ep_tau", 3.9, False),
        ("pressure", "parameter:ep_tau", 4.1, True),
        ("pressure", "dead_time", 3.9, True),  # an effect is there or not
        ("position", "parameter:tau", 3.9, True),
    ],
)
def test_a_converter_s_number_that_moves_no_stem_is_left_out_beside_a_clear_gap(
    monkeypatch: pytest.MonkeyPatch, channel: str, accused: str, before: float, heard: bool
) -> None:
    monkeypatch.setattr(trim, "_guess", lambda *_: False)
    monkeypatch.setattr(trim, "moved_square", lambda *_: 0.0)

    def decided(where: str, name: str, none: float) -> Decision:
        findings: Any = SimpleNamespace(channel=SimpleNamespace(name=where, sigma=1.0), none=one(name, none, 0.0))
        return Decision(findings, one(name, 1.0, 0.03), explained=True, gap=True, rest=0.0)

    clear = decided("position", "creep", 100.0)
    first, second = spoken((decided(channel, accused, before), clear), Weights(), False)
    assert first.explained is heard
    assert second is clear
    [alone] = spoken((decided(channel, accused, before),), Weights(), False)
    assert alone.explained
