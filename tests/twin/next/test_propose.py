"""After a verdict: the experiment that separates, the sensor to add, or nothing more; and the file for `sweep`."""

from __future__ import annotations

import time
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner

from app.cli import cli
from control.design import DesignModel
from control.experiment_file import from_plain
from tests.twin.next.two_lags import dispute, record, result
from twin.choose.rules import DecisionRules
from twin.choose.weigh import Weights
from twin.diagnosis import Cause, EffectTest
from twin.judge.verdict import Judgement
from twin.model.effect import Scales
from twin.next.candidates import library
from twin.next.coverage import blind_spots
from twin.next.criterion import Scale
from twin.next.file import rounded, toml_text
from twin.next.fresh import poor_ground
from twin.next.limits import limits_of
from twin.next.propose import Proposal, _below_noise, _settled, propose
from twin.next.search import best_experiment
from twin.next.sensors import advice


def judged(*names: str, probability: float = 0.6, confusable: tuple[tuple[str, ...], ...] = ()) -> Judgement:
    causes = (Cause(names[0], "ep", probability),) if names else ()
    return Judgement("effect" if names else "no_gap", causes, (), confusable)


def proposed(found: SimpleNamespace, judgement: Judgement, tests: tuple[EffectTest, ...] = ()) -> Proposal:
    return propose(found, judgement, tests, DecisionRules(), Weights())  # type: ignore[arg-type]


PAIR = ("dead_time", "sensor_lag")


def test_proposes_what_separates_two_causes_as_a_file_that_sweep_runs(tmp_path: Path) -> None:
    proposal = proposed(result(*PAIR), judged("dead_time", confusable=(PAIR,)))
    assert proposal.next.file == "next.toml"
    assert "eparate" in proposal.next.why
    assert "dead time from sensor lag" in proposal.next.why
    assert proposal.file is not None
    (tmp_path / "next.toml").write_text(proposal.file, encoding="utf-8")
    said = CliRunner().invoke(cli, ["sweep", str(tmp_path / "next.toml"), "--dry-run"])
    assert said.exit_code == 0, said.output
    assert "Nothing was moved" in said.output


def test_two_causes_without_a_set_are_in_dispute_while_the_first_is_not_sure() -> None:
    unsure = proposed(result(*PAIR), judged("dead_time", probability=0.8))
    assert unsure.file is not None
    assert "(These records already make sensor lag far less likely; it only comes next.)" in unsure.next.why
    assert "comes next" not in proposed(result(*PAIR), judged("dead_time", confusable=(PAIR,))).next.why
    sure = proposed(result(*PAIR), judged("dead_time", probability=0.97))
    assert (sure.file, sure.next.file) == (None, None)
    assert "No further experiment is needed" in sure.next.why


@pytest.mark.parametrize("many", [1, 6])
def test_causes_that_are_not_beyond_doubt_are_left_open(many: int) -> None:
    causes = tuple(Cause(name, "ep", 0.85) for name in ("dead_time", "creep", "stiction", "a", "b", "c")[:many])
    why = proposed(result(*PAIR), Judgement("effects", causes, (), ())).next.why
    assert "needed" not in why
    assert "not beyond doubt: dead time (0.85)" in why
    assert ("that all 6 causes are there about 0.38" in why) == (many == 6)
    sure, second = Cause("dead_time", "ep", 0.97), Cause("creep", "actuator", 0.85)
    why = proposed(result(*PAIR), Judgement("effects", (sure, second), (), ())).next.why
    assert "not beyond doubt: creep (0.85), that all 2 causes are there about 0.82" in why


def test_asks_for_a_sensor_where_no_experiment_separates() -> None:
    names = ("sensor_lag", "additional_lag")
    proposal = proposed(result(*names), judged("sensor_lag", probability=0.99, confusable=(names,)))
    assert proposal.file is None
    assert "cannot be separated with these sensors" in proposal.next.why
    assert "second position signal" in proposal.next.why


def test_after_no_gap_it_shows_what_the_records_could_not() -> None:
    blind = EffectTest("friction_in_motion", False, "this record does not excite it")
    proposal = proposed(result(*PAIR), judged(), (blind,))
    assert proposal.file is not None
    assert "friction in motion" in proposal.next.why
    seen = EffectTest("creep", True, "", "share", 0.001, "1")
    assert "no further experiment is needed" in proposed(result(*PAIR), judged(), (seen,)).next.why


def test_an_effect_seen_only_when_huge_counts_as_not_shown() -> None:
    huge = EffectTest("creep", True, "", "share", 0.5, "1")
    assert "creep" in proposed(result(*PAIR), judged(), (huge,)).next.why


def test_what_is_clear_is_clear_in_the_form_that_shows_first() -> None:
    def spots(share: float) -> list[str]:
        test = EffectTest("distributed_hysteresis", True, "", "soft_share", share, "1", "partly_soft")
        return [spot.inserted.form.name for spot in blind_spots([test], Scales(), DesignModel())]

    assert spots(0.5) == ["partly_soft"]
    assert spots(0.01) == []


def test_what_a_record_shows_only_from_a_size_on_is_said_with_that_size() -> None:
    huge = EffectTest("creep", True, "", "share", 0.5, "1")
    blind = EffectTest("friction_in_motion", False, "this record does not excite it")
    why = proposed(result(*PAIR), judged(), (huge, blind)).next.why
    assert "friction in motion (here not testable)" in why
    assert "creep (here only with a share above 0.5)" in why


def test_a_supply_shows_where_it_is_low_and_a_high_one_is_no_fault() -> None:
    """14 psi are more than a stroke takes, 11.7 psi; the record that shows a supply of that would show any that is
    too weak. One that was driven to 9 psi would not."""

    def why(psi: float) -> str:
        test = EffectTest("supply_saturation", True, "", "supply", psi, "psi", "ceiling")
        return proposed(result(*PAIR), judged(), (test,)).next.why

    assert "supply" not in why(14.0) and "no further experiment is needed" in why(14.0)
    assert "supply saturation (here only with a supply below 9 psi)" in why(9.0)


def in_closed_loop() -> SimpleNamespace:
    """The same records, as a controller would have made them."""
    found = result(*PAIR)
    looped = tuple(replace(r, target=r.position) for r in found.case.recordings)
    return SimpleNamespace(case=replace(found.case, recordings=looped), decisions=found.decisions)


def test_an_unexplained_gap_of_a_closed_loop_asks_for_an_open_sweep_with_reversals() -> None:
    unclear = Judgement("unexplained", (), (), ())
    blind = EffectTest("friction_in_motion", False, "this record does not excite it")
    proposal = proposed(in_closed_loop(), unclear, (blind,))
    assert "closed loop" in proposal.next.why
    assert proposal.file is not None
    assert tomllib.loads(proposal.file)["kind"] == "nested"
    # a gap that is explained, and one of an open loop over the whole stroke, ask for something else
    assert "closed loop" not in proposed(in_closed_loop(), judged(), (blind,)).next.why
    seen = EffectTest("creep", True, "", "share", 0.001, "1")
    assert "repeat them to see whether the gap repeats" in proposed(result(*PAIR), unclear, (seen,)).next.why


def test_a_stem_that_hardly_moves_is_a_poor_ground() -> None:
    [record] = result(*PAIR).case.recordings
    assert poor_ground([record], 0.5625) is None
    small = replace(record, position=0.3 * record.position)
    assert "of its travel only" in str(poor_ground([small], 0.5625))
    assert poor_ground([small, record], 0.5625) is None
    looped = replace(record, target=record.position)
    assert "closed loop" in str(poor_ground([looped], 0.5625))
    assert poor_ground([looped, record], 0.5625) is None


def test_the_rest_is_said_of_the_signal_in_which_it_is() -> None:
    found = result(*PAIR)
    [decision] = found.decisions
    pressure = SimpleNamespace(
        accepted=SimpleNamespace(mse=64.0), findings=SimpleNamespace(channel=SimpleNamespace(name="pressure", half=0.0))
    )
    both = SimpleNamespace(case=found.case, decisions=(decision, pressure))
    why = _settled(both, judged("dead_time", probability=0.97)).next.why  # type: ignore[arg-type]
    assert "in the pressure" in why
    assert "8 times its noise" in why


def test_the_rest_of_a_coarse_reading_is_held_against_its_noise() -> None:
    """Beyond the edges of its steps there is next to none, so that a little is hundreds of times as much."""
    found = result(*PAIR)
    channel = SimpleNamespace(name="position", half=0.002, sigma=0.01 * found.case.sigma_y)
    coarse = SimpleNamespace(accepted=SimpleNamespace(mse=300.0**2), findings=SimpleNamespace(channel=channel))
    one = SimpleNamespace(case=found.case, decisions=(coarse,))
    why = _settled(one, judged("dead_time", probability=0.97)).next.why  # type: ignore[arg-type]
    assert "3 times its noise" in why


def test_every_rival_is_named_with_the_signal_that_would_tell() -> None:
    names = ("dead_time", "sensor_lag", "additional_lag")
    both = dispute(*names)
    found = best_experiment(both, Scale("chain", 0.0006, 0.1), limits_of(DesignModel(), [record()]), 50.0)
    words = _below_noise(both, found, False, result(*names))  # type: ignore[arg-type]
    assert "from sensor lag or additional lag" in words
    assert "for sensor lag a second position signal" in words
    assert "for additional lag a measured pressure" in words


def test_an_experiment_that_is_not_enough_is_offered_beside_the_signal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("twin.next.propose._HELPS", 1e9)
    proposal = proposed(result(*PAIR), judged("dead_time", confusable=(PAIR,)))
    assert "cannot be separated from sensor lag with these sensors" in proposal.next.why
    assert "of what settles it" in proposal.next.why
    assert proposal.file is not None
    assert from_plain(tomllib.loads(proposal.file), "file").duration_s > 0.0


def test_the_best_experiment_is_worth_more_than_any_of_the_library() -> None:
    from twin.next.search import _evaluator  # the library one by one, without the shortcut

    found = dispute(*PAIR)
    limits = limits_of(result(*PAIR).case.base.design, result(*PAIR).case.recordings)
    scale, needed = Scale("chain", 0.0006, 0.1), 50.0
    best = best_experiment(found, scale, limits, needed)
    evaluate = _evaluator(found, scale, limits, needed)
    assert best.value >= max(evaluate(one).value for one in library(limits)[::4]) - 1e-12
    assert max(d.gain for d in best.distances) >= needed


def test_costs_less_than_two_seconds_of_processor_time() -> None:
    result(*PAIR)
    begun = time.process_time()
    proposed(result(*PAIR), judged("dead_time", confusable=(PAIR,)))
    assert time.process_time() - begun < 2.0


def test_every_experiment_survives_its_file() -> None:
    limits = limits_of(result(*PAIR).case.base.design, result(*PAIR).case.recordings)
    for one in library(limits):
        text = toml_text(rounded(one), "why\nand how")
        assert text.startswith("# why\n# and how\n")
        assert from_plain(tomllib.loads(text), "file") == rounded(one)


@pytest.mark.parametrize(
    ("first", "second", "pressure", "word"),
    [
        ("sensor_lag", "additional_lag", True, "second position"),
        ("flow_force", "nonlinear_spring", True, "pressure drop"),
        ("dead_time", "additional_lag", False, "measured pressure"),
        ("dead_time", "ep_rate_limit", True, "second pressure gauge"),
        ("stiction", "position_dependent_friction", True, "stem force"),
        ("lvdt_drift", "lvdt_calibration", True, "second position"),
    ],
)
def test_advice_names_the_signal_that_is_missing(first: str, second: str, pressure: bool, word: str) -> None:
    assert word in advice(first, second, pressure)
