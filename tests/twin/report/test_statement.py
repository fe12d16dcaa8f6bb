"""The sentence that an operator reads first: sizes, and not every number of a form."""

from __future__ import annotations

from dataclasses import replace

import pytest

from twin.diagnosis import Cause, Diagnosis, Estimate, Gap
from twin.report.statement import statement

GAP = Gap(3.0, 2.0, 0.12, 0.11, None)


def one(name: str, form: str, **numbers: float) -> Cause:
    found = {
        key: Estimate(value, (value, value), "in" if key.startswith("zero") else "1") for key, value in numbers.items()
    }
    return Cause(name, "actuator", 0.9, None, found, form)


def said(*causes: Cause) -> str:
    return statement(Diagnosis("effects" if len(causes) > 1 else "effect", "", causes, (), GAP))


def test_a_curve_of_many_numbers_is_said_by_its_largest() -> None:
    words = said(one("lvdt_drift", "wander", zero_1=0.001, zero_2=-0.044, zero_10=0.02))
    assert "lvdt_drift (up to -0.044 in; probability 0.90)" in words


def test_what_only_says_how_it_goes_is_left_to_the_table() -> None:
    assert "creep (share 0.2; probability" in said(one("creep", "one_tail", share=0.2, tail=20.0))
    assert "tail" not in said(one("creep", "one_tail", share=0.2, tail=20.0))


def test_where_no_number_says_how_large_it_is_all_are_said() -> None:
    assert "friction_in_motion (presliding 0.004; pro" in said(one("friction_in_motion", "elastic", presliding=0.004))


def test_a_cause_that_was_seen_in_the_readings_keeps_its_numbers() -> None:
    assert "sensor_dropouts (rate 0.01; probability" in said(one("sensor_dropouts", "", rate=0.01))


@pytest.mark.parametrize(("count", "word"), [(1, "With it the error"), (2, "With them the error")])
def test_one_cause_is_it_and_more_are_them(count: int, word: str) -> None:
    assert word in said(*[one("creep", "one_tail", share=0.2), one("stiction", "one_jump", breakaway=0.3)][:count])


def test_an_error_does_not_fall_to_more() -> None:
    """A display's step is named by its readings alone; the error that is left may be no smaller for it."""
    named = one("sensor_quantization", "", step=0.04)
    more = Diagnosis("effect", "", (named,), (), replace(GAP, before=0.93, after=1.1))
    assert "falls" in said(named)
    assert "falls" not in statement(more) and "1.1 % of travel with it and 0.93 % without" in statement(more)


def test_less_than_what_passed_for_noise_closes_all() -> None:
    """More than 100 % of what noise does not account for is no share of anything."""
    closed = Estimate(1.55, (1.3, 1.9), "1")
    better = Diagnosis("effect", "", (one("creep", "one_tail", share=0.2),), (), replace(GAP, reducible_closed=closed))
    assert "closes all of what noise" in statement(better)
    some = replace(GAP, reducible_closed=replace(closed, value=0.876))
    assert "closes 87.6 % of what noise" in statement(replace(better, gap=some))


def test_nothing_beside_its_doubt_is_nothing() -> None:
    sizes = {"up": Estimate(2.7e-25, (0.0, 0.07), "s/in"), "down": Estimate(0.26, (0.24, 0.27), "s/in")}
    limited = Cause("ep_rate_limit", "ep", 0.97, None, sizes, None)
    assert "up 0 s/in, down 0.26 s/in" in said(limited)


def test_what_all_numbers_together_account_for_is_said() -> None:
    """A plant's line through three days of a loop: nothing is at fault there, and nothing fits."""
    gap = replace(GAP, before=0.45, retuned=0.2, after=0.2, noise_floor=0.18)
    words = statement(Diagnosis("unexplained", "", (), (), gap))
    assert "re-tuned all together, account for that (0.2 % left), but no one of them does" in words
    assert "accounts for it" in statement(Diagnosis("unexplained", "", (), (), replace(gap, retuned=0.3)))
