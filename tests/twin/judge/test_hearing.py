"""What the pressure shows by itself does not go down with a guess about the stem."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import twin.judge.hearing
import twin.judge.verdict
from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import a_record
from tests.twin.test_floor import RULES, findings_of
from twin.choose.decide import Decision, decide
from twin.choose.stages import StageResult
from twin.choose.weigh import Weights
from twin.diagnosis import Cause as Named
from twin.fit.case import make_case
from twin.fit.channel import chain_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.judge.gap import GapParts
from twin.judge.hearing import Hearing, weightiest_first
from twin.judge.upheld import upheld
from twin.judge.verdict import Judgement
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.record.sensing import Sensing
from twin.search.findings import Findings
from twin.search.score import make_yardstick

DESIGN = DesignModel()


@pytest.fixture(autouse=True)
def none_slips(monkeypatch: pytest.MonkeyPatch) -> None:
    """The channels of these tests have no readings in which to look for slips."""
    monkeypatch.setattr(twin.judge.hearing, "by_slips", lambda *_: None)


def accepted(channel: str, name: str, before: float, left: float = 1.0) -> Decision:
    findings = findings_of({(name,): (left, 1000.0)}, before)
    findings.channel.name, findings.channel.half, findings.channel.trials = channel, 0.0, ()
    return replace(decide(findings, RULES), accepted=findings.fits[0], explained=True, rest=0.0)


@pytest.mark.parametrize(
    ("shown", "before", "verdict", "names"),
    [
        (3000.0, 1.8, "effect", ["supply_saturation"]),
        (3000.0, 2.6, "unexplained", []),  # the stem is clearly off, and nothing is known of that
        (3.5, 1.8, "unexplained", []),
    ],
)
def test_a_guess_about_the_stem_is_left_out_alone(
    monkeypatch: pytest.MonkeyPatch, shown: float, before: float, verdict: str, names: list[str]
) -> None:
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), np.full(400, 9.0))
    case = make_case([record], DESIGN)
    decisions = (accepted("pressure", "supply_saturation", shown), accepted("position", "creep", 3.0))

    def heldout_parts(case: Any, result: StageResult, *rest: Any) -> GapParts:
        """With the guess it is predicted worse than with what the pressure shows alone."""
        after = 0.95 * before if result.decisions[1].names else 0.9 * before
        return GapParts(*(case.sigma_y * np.full(8, level) for level in (before, before, after)), {}, {})

    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", heldout_parts)
    hearing = Hearing(case, decisions[1].findings.none, Sensing((), {}, 0.0), 1.0, Weights(), False)
    result = StageResult(case, decisions, case.trials)
    result, judgement, parts = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)
    assert judgement.verdict == verdict
    assert [c.name for c in judgement.causes] == names
    assert bool(result.decisions[1].names) == (not names)
    assert parts.before[0] == before * case.sigma_y


@pytest.mark.parametrize(("gap", "verdict"), [(2.0, "effect"), (9.0, "unexplained")])
def test_what_a_stem_that_is_hardly_off_resembles_takes_nothing_with_it(
    monkeypatch: pytest.MonkeyPatch, gap: float, verdict: str
) -> None:
    """A converter shows its cause; behind it, something from outside of the vocabulary explains a slight rest best."""
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), np.full(400, 9.0))
    case = make_case([record], DESIGN)
    decisions = (accepted("pressure", "supply_saturation", 3000.0), accepted("position", "creep", gap))
    levels = GapParts(*(case.sigma_y * np.full(8, level) for level in (8.0, 6.0, 1.5)), {}, {})
    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", lambda *_: levels)
    for module in (twin.judge.hearing, twin.judge.verdict):
        monkeypatch.setattr(module, "outside_of", lambda d: "creep" if "creep" in d.names else None)
    hearing = Hearing(case, decisions[1].findings.none, Sensing((), {}, 0.0), 1.0, Weights(), False)
    result = StageResult(case, decisions, case.trials)
    result, judgement, _ = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)
    assert judgement.verdict == verdict
    assert [c.name for c in judgement.causes] == (["supply_saturation"] if verdict == "effect" else [])
    assert bool(result.decisions[1].names) == (verdict == "unexplained")


@pytest.mark.parametrize(
    ("swings", "left", "verdict"), [(True, 2.3, "unexplained"), (True, 1.0, "effect"), (False, 2.3, "effect")]
)
def test_a_creep_that_leaves_something_beside_a_swing_is_taken_back(
    monkeypatch: pytest.MonkeyPatch, swings: bool, left: float, verdict: str
) -> None:
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), np.full(400, 9.0))
    case = make_case([record], DESIGN)
    levels = GapParts(*(case.sigma_y * np.full(8, level) for level in (8.0, 1.7, 1.7)), {}, {})
    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", lambda *_: levels)
    decision = accepted("position", "creep", 68.0, left)
    hearing = Hearing(case, decision.findings.none, Sensing((), {}, 0.0), 0.0, Weights(), swings, swings)
    result = StageResult(case, (decision,), case.trials)
    told = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)[1]
    assert told.verdict == verdict


def test_a_cause_goes_also_where_the_others_were_never_fitted_without_it() -> None:
    creep = effect("creep").form("one_tail")
    case = make_case([a_record(Plant(DESIGN, (Inserted("creep", creep, (0.1, 20.0)),)))], DESIGN)
    channel = chain_channel(case.trials, case.sigma_y)
    drift = Cause("lvdt_drift", effect("lvdt_drift"), effect("lvdt_drift").form("linear"))
    none, both = (
        fit(channel, space, starts_of(space))
        for space in (
            make_space(case.base, causes, channel.numbers if causes else (), case.scales)
            for causes in ((), (Cause("creep", effect("creep"), creep), drift))
        )
    )
    findings = Findings(channel, none, none, (both,), make_yardstick(none.residuals, channel.use))
    hearing = Hearing(case, none, Sensing((), {}, 0.0), 0.0, Weights(), False)
    left = hearing._dropped(Decision(findings, both, True, True, 0.0), "lvdt_drift")
    assert left.names == ("creep",)
    assert left.accepted.mse == pytest.approx(both.mse, rel=0.01)
    assert left.accepted in left.findings.fits


@pytest.mark.parametrize(
    ("name", "after", "exact", "verdict"),
    [
        ("creep", 1.01, True, "effect"),
        ("creep", 1.05, True, "no_gap"),  # too much is left of so little
        ("creep", 1.01, False, "no_gap"),
        ("lvdt_drift", 1.01, True, "no_gap"),  # a pressure that wandered looks like this
    ],
)
def test_a_slight_error_without_a_measured_pressure_has_a_cause_if_a_law_of_the_commands_predicts_it(
    name: str, after: float, exact: bool, verdict: str
) -> None:
    levels = GapParts(*(np.full(8, level) for level in (1.2, 1.2, after)), {}, {})
    named = Judgement("effect", (Named(name, effect(name).stage, 0.9, None, {}),), (), ())
    assert upheld(levels, named, 1.0, Sensing((), {}, 0.0), False, exact=exact)[1].verdict == verdict


@pytest.mark.parametrize(
    ("further", "left", "after", "named", "spares"),
    [
        ("lvdt_drift", 1.1, 1.0, False, False),
        ("lvdt_drift", 1.2, 1.0, False, False),
        ("lvdt_drift", 1.2, 1.0, True, True),  # without it the numbers would have to do what nobody believes
        ("lvdt_drift", 1.3, 1.0, True, False),
        ("lvdt_drift", 1.2, 0.9, True, False),  # the noise was estimated too large
        ("lvdt_drift", 1.0, 0.9, False, False),
        ("parameter:tau", 1.25, 1.0, False, False),  # as the design says, to its tolerance
        ("parameter:tau", 1.35, 1.0, True, False),
    ],
)
def test_a_further_cause_is_named_where_the_rest_would_not_pass_for_healthy(
    monkeypatch: pytest.MonkeyPatch, further: str, left: float, after: float, named: bool, spares: bool
) -> None:
    record = Recording("r", 0.1 * np.arange(400), np.full(400, 9.0), np.full(400, 0.3), np.full(400, 9.0))
    case = make_case([record], DESIGN)
    findings = findings_of({("creep", further): (1.0, 1000.0), ("creep",): (1.2, 990.0)}, 400.0)
    findings.channel.name, findings.channel.half, findings.channel.trials = "position", 0.0, ()
    decision = replace(decide(findings, RULES), accepted=findings.fits[0], explained=True, rest=0.0)
    percent = 100.0 * case.sigma_y / case.travel

    def heldout_parts(case: Any, result: StageResult, *rest: Any) -> GapParts:
        without = {"creep": 9.0 * percent, further: left * percent}
        levels = (case.sigma_y * np.full(8, level) for level in (20.0, 20.0, after))
        return GapParts(*levels, {n: without[n] for n in result.decisions[0].names}, {})

    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", heldout_parts)
    monkeypatch.setattr(twin.judge.hearing, "spares_numbers", lambda *_: spares)
    monkeypatch.setattr(
        twin.judge.hearing, "within_tolerance", lambda causes, _: ["parameter:tau"] if len(causes) > 1 else []
    )
    hearing = Hearing(case, findings.none, Sensing((), {}, 0.0), 0.0, Weights(), False)
    result = StageResult(case, (decision,), case.trials)
    told = hearing.held_out(result, hearing.judgement(result), lambda *_: None, case.sigma_y)[1]
    assert sorted(c.name for c in told.causes) == ["creep", *([further] if named else [])]


def test_of_causes_that_are_as_likely_the_one_without_which_most_is_left_comes_first() -> None:
    chances = {"parameter:ep_tau": 0.97, "creep": 0.97, "stiction": 0.6, "sensor_dropouts": 0.97}
    named = tuple(Named(name, "sensor", p, None, {}) for name, p in chances.items())
    left = {"parameter:ep_tau": 1.2, "creep": 4.0, "stiction": 9.0}  # [percent of travel], with 10 % before
    parts = GapParts(*(np.full(8, level) for level in (0.05, 0.05, 0.002)), left, {})
    judgement = weightiest_first(Judgement("effects", named, (), ()), parts, 0.5)
    assert [c.name for c in judgement.causes] == ["sensor_dropouts", "creep", "parameter:ep_tau", "stiction"]


def test_what_unseen_data_leave_standing_comes_in_that_order(monkeypatch: pytest.MonkeyPatch) -> None:
    case = make_case([a_record(Plant(DESIGN))], DESIGN)
    named = tuple(Named(name, "sensor", 0.97, None, {}) for name in ("parameter:ep_tau", "creep"))
    parts = GapParts(np.ones(8), np.ones(8), np.ones(8), {"parameter:ep_tau": 1.2, "creep": 4.0}, {})
    heard = (None, Judgement("effects", named, (), ()), parts)
    monkeypatch.setattr(Hearing, "_heard", lambda *_: heard)
    hearing: Any = Hearing(case, None, Sensing((), {}, 0.0), 0.0, Weights(), False)  # type: ignore[arg-type]
    told = hearing.held_out(None, heard[1], None, 1.0)[1]
    assert [c.name for c in told.causes] == ["creep", "parameter:ep_tau"]


@pytest.mark.parametrize("verdict", ["unexplained", "effect"])
def test_slips_are_heard_last_and_told_what_has_stood(monkeypatch: pytest.MonkeyPatch, verdict: Any) -> None:
    case = make_case([a_record(Plant(DESIGN))], DESIGN)
    parts = GapParts(np.ones(8), np.ones(8), np.ones(8), {}, {})
    stood: Any = Judgement(verdict, (), (), ())
    slipped: Any = StageResult(case, (accepted("position", "stiction", 30.0),), case.trials)
    asked = []

    def by_slips(_case: Any, result: Any, unexplained: bool) -> Any:
        asked.append((result, unexplained))
        return slipped

    monkeypatch.setattr(Hearing, "_heard", lambda *_: ("heard", stood, parts))
    monkeypatch.setattr(twin.judge.hearing, "by_slips", by_slips)
    monkeypatch.setattr(twin.judge.hearing, "heldout_parts", lambda *_: parts)
    hearing: Any = Hearing(case, None, Sensing((), {}, 0.0), 0.0, Weights(), False)  # type: ignore[arg-type]
    result, judgement, _ = hearing.held_out(None, stood, None, 1.0)
    assert asked == [("heard", verdict == "unexplained")]
    assert result is slipped
    assert [cause.name for cause in judgement.causes] == ["stiction"]
