"""Causes that one record cannot tell apart and another could."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from control.design import DesignModel
from logs.recording import Recording
from tests.twin.judged import judged
from twin.choose.alike import alike
from twin.choose.decide import Decision
from twin.choose.rules import DecisionRules
from twin.choose.trim import LIKELY, belief, spoken
from twin.choose.twins import settled
from twin.choose.weigh import Weights, conspiracy, weigh
from twin.fit.fitting import Fit
from twin.judge.verdict import Judgement
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant
from twin.replay.simulate import simulate_recording

ZERO = Inserted("lvdt_calibration", effect("lvdt_calibration").form("zero"), (0.002,))

SPAN = ("lvdt_calibration", "reduced_travel")


@cache
def wrong_zero(highest_psi: float) -> tuple[Decision, Judgement]:
    """What the position says of a reading 2 thousandths of an inch too high, in steps up to some pressure."""
    dice, n = np.random.default_rng(3), 1500
    command = np.repeat(dice.uniform(5.0, highest_psi, 30), 50)
    blank = Recording("valve", np.arange(n) * 0.2, command, np.zeros(n), np.full(n, 5.0))
    pressure, position = simulate_recording(Plant(DesignModel(), (ZERO,)), blank)
    position = position + dice.normal(0.0, 0.001, n)
    found, judgement = judged(replace(blank, position=position, pressure=pressure + dice.normal(0.0, 0.006, n)))
    return found.decisions[-1], judgement


@pytest.mark.thorough
def test_a_wrong_zero_and_a_stop_that_is_off_are_alike_where_the_other_stop_is_never_reached() -> None:
    decision, judgement = wrong_zero(9.5)
    assert decision.names == ("lvdt_calibration",)
    assert "reduced_travel" in alike(decision, "lvdt_calibration")
    assert judgement.alike["lvdt_calibration"] == alike(decision, "lvdt_calibration")


@pytest.mark.thorough
def test_at_both_stops_a_wrong_zero_is_like_both_stops_elsewhere_and_like_no_single_one() -> None:
    decision, _ = wrong_zero(13.0)
    assert decision.names == ("lvdt_calibration",)
    assert "reduced_travel" in alike(decision, "lvdt_calibration")
    [stops] = [f for f in decision.findings.fits if f.names == ("reduced_travel",)]
    form = stops.space.causes[0].form
    assert form is not None and form.name.startswith("both_stops")


@pytest.mark.thorough
def test_what_is_not_explained_to_its_noise_is_like_nothing() -> None:
    decision, _ = wrong_zero(9.5)
    assert alike(replace(decision, floor=0.5 * decision.accepted.mse), "lvdt_calibration") == ()
    assert alike(decision, "creep") == ()


def three_alike(decision: Decision) -> Decision:
    """A decision whose accepted cause has two rivals that leave the same and weigh the same."""
    accepted = decision.accepted
    other = {f.names[0]: f for f in decision.findings.fits if len(f.names) == 1}
    twins = [replace(other[n], residuals=accepted.residuals, mse=accepted.mse) for n in ("reduced_travel", "stiction")]
    findings = replace(decision.findings, fits=(accepted, *twins), yardstick=_Level())  # type: ignore[arg-type]
    return replace(decision, findings=findings)


class _Level:
    """A yardstick by which whatever explains anything weighs the same."""

    phi = 1.0

    def score(self, fit: Fit) -> float:
        return 0.0 if fit.names else -1000.0


@pytest.mark.thorough
def test_one_of_three_that_are_alike_is_named_though_none_is_likely() -> None:
    """None is a guess: one of them is sure, and the set says so."""
    decision = three_alike(wrong_zero(9.5)[0])
    [name] = decision.names
    probability = weigh(decision, Weights()).probability
    assert probability[name] == pytest.approx(1.0 / 3.0, abs=0.01)  # but for numbers that are off by chance
    assert belief(name, probability) < LIKELY < belief(name, probability, alike(decision, name))
    assert spoken([decision], Weights(), seen=True)[0].names == (name,)
    apart = replace(decision, floor=0.5 * decision.accepted.mse)  # no longer explained to the noise: a guess
    assert spoken([apart], Weights(), seen=True)[0].names == ()


@pytest.mark.thorough
def test_a_second_cause_stays_though_another_could_stand_in_its_place() -> None:
    """A filter, and a span that a stop and a stiffer spring imitate: without it a wrong cause would be left."""
    dice, n = np.random.default_rng(3), 1500
    truth = (
        Inserted("lvdt_calibration", effect("lvdt_calibration").form("gain"), (-0.0068,)),
        Inserted("sensor_lag", effect("sensor_lag").form("first_order"), (0.057,)),
    )
    command = np.repeat(dice.uniform(4.5, 13.0, 30), 50)
    blank = Recording("valve", np.arange(n) * 0.2, command, np.zeros(n), np.full(n, 5.0))
    pressure, position = simulate_recording(Plant(DesignModel(), truth), blank)
    noisy = replace(blank, position=position + dice.normal(0.0, 4.5e-4, n), pressure=pressure)
    decision = settled(judged(noisy)[0].decisions[-1], DecisionRules(), Weights())
    assert set(decision.names) == {"lvdt_calibration", "sensor_lag"}
    assert "reduced_travel" in alike(decision, "lvdt_calibration")
    # how usual a lag is weighs beside each of the two alike, lest it make the one likelier than the record does
    probability = weigh(decision, Weights()).probability
    lead = {name: decision.findings.score(_pair(decision, name, "sensor_lag")) for name in probability if name in SPAN}
    odds = probability["reduced_travel"] / probability["lvdt_calibration"]
    other = _pair(decision, "reduced_travel", "sensor_lag")
    against = conspiracy(other, decision.accepted, decision.findings.phi)  # the stop needs a compliance that is off
    assert against > 0.5
    told = np.exp((lead["reduced_travel"] - lead["lvdt_calibration"]) / Weights().temperature - against)
    assert odds == pytest.approx(told, rel=0.2)


def _pair(decision: Decision, *names: str) -> Fit:
    return next(f for f in decision.findings.fits if set(f.names) == set(names))
