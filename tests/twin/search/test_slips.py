"""A design that is off in several numbers is told from a valve with an effect."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from control.design import DesignModel
from tests.twin.judged import a_record, judged
from tests.twin.trials import DESIGN, SIGMA, staircase, trial_of
from twin.fit.channel import position_channel
from twin.fit.fitting import fit, starts_of
from twin.fit.space import Cause, make_space
from twin.model.catalog import effect
from twin.model.effect import Scales
from twin.model.plant import Inserted, Plant
from twin.search.candidates import number_causes
from twin.search.slips import several_slips

OFF = DesignModel(compliance=0.205, a1=8.95, a2=5.80, tau_s=2.2, rate_limit=0.14)
EVERYTHING = {"deadband", "offset", "compliance", "tau", "rate_limit"}


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("design", "wrong"),
    [
        (OFF, EVERYTHING),
        (replace(OFF, rate_limit=DesignModel().rate_limit), EVERYTHING - {"rate_limit"}),
        (replace(DesignModel(), tau_s=2.2, compliance=0.2, rate_limit=0.14), {"tau", "compliance", "rate_limit"}),
    ],
)
def test_the_wrong_numbers_are_named_and_no_effect(design: DesignModel, wrong: set[str]) -> None:
    _, judgement = judged(a_record(Plant(DesignModel())), design)
    assert judgement.verdict == "parameter"
    assert {c.name for c in judgement.causes} == {f"parameter:{n}" for n in wrong}


@pytest.mark.thorough
def test_an_effect_is_not_put_down_to_the_numbers() -> None:
    lagged = Plant(DesignModel(), (Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (0.5,)),))
    _, judgement = judged(a_record(lagged), DesignModel())
    assert len(judgement.causes) == 1 and judgement.causes[0].name in {"sensor_lag", "additional_lag"}


@pytest.mark.thorough
def test_a_design_without_a_gap_is_not_taken_apart() -> None:
    result, _ = judged(a_record(Plant(DesignModel())), DesignModel())
    assert all(len(f.names) < 3 for d in result.decisions for f in d.findings.fits)


@pytest.mark.parametrize(
    ("none", "retuned", "sizes"),
    [(100.0, 1.5, [5, 4, 3]), (100.0, 5.0, []), (1.9, 1.0, [])],  # explained, not explained, nothing to explain
)
def test_numbers_are_taken_together_where_retuning_explains_a_gap(
    none: float, retuned: float, sizes: list[int]
) -> None:
    def refit(causes: tuple[Cause, ...], _from: object) -> SimpleNamespace:
        return SimpleNamespace(mse=float(len(causes)), space=SimpleNamespace(causes=causes))

    slips = [Cause(f"parameter:{name}") for name in sorted(EVERYTHING)]
    before, after = SimpleNamespace(mse=none), SimpleNamespace(mse=retuned)
    found = several_slips(slips, before, after, refit, 0.02)  # type: ignore[arg-type]
    assert [len(one.space.causes) for one in found] == sizes


def test_numbers_start_far_off_too_unless_they_are_known_from_another_fit() -> None:
    channel = position_channel([trial_of(Plant(DESIGN), staircase())[0]], SIGMA)
    space = make_space(Plant(DESIGN), number_causes(channel), channel.numbers, Scales())
    anywhere = starts_of(space)
    # compliance starts at its nominal only, a rate limit at three more
    assert len(anywhere) == len({tuple(z) for z in anywhere}) == 3**3 * 4
    known = fit(channel, space, [np.full(len(space.numbers), 0.01)], rounds=1)
    [start] = starts_of(space, [known])
    assert np.array_equal(start, known.z)


@pytest.mark.thorough
def test_a_lag_that_is_ten_times_too_short_is_a_wrong_number() -> None:
    _, judgement = judged(a_record(Plant(DesignModel())), replace(DesignModel(), ep_tau_s=0.035))
    assert [c.name for c in judgement.causes] == ["parameter:ep_tau"]
    assert judgement.causes[0].parameters["ep_tau"].value == pytest.approx(0.3, rel=0.02)
