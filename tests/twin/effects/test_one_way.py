"""A time constant that is longer one way alone: two lags about another mean, and told without accusing that mean."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.twin.judged import a_record
from tests.twin.loops import D
from twin.diagnose import diagnose
from twin.model.catalog import effect
from twin.model.plant import Inserted, Plant


def damped(form: str, *values: float, tau_s: float = D.tau_s, rate_limit: float = D.rate_limit) -> Plant:
    one = Inserted("asymmetric_damping", effect("asymmetric_damping").form(form), values)
    return Plant(replace(D, tau_s=tau_s, rate_limit=rate_limit), (one,))


@given(st.floats(-0.9, 4.0), st.sampled_from([("closing_alone", 1.0), ("opening_alone", -1.0)]))
def test_it_is_two_lags_about_another_mean(longer: float, form: tuple[str, float]) -> None:
    mean = 1.0 + 0.5 * longer
    alone = damped(form[0], longer).coefficients(1.0).valve
    both = damped("two_lags", form[1] * 0.5 * longer / mean, tau_s=mean * D.tau_s).coefficients(1.0).valve
    np.testing.assert_allclose(alone, both, rtol=1e-12)


@given(
    st.floats(-0.9, 4.0),
    st.floats(-0.9, 0.9),
    st.sampled_from([("closing_throttled", 1.0), ("opening_throttled", -1.0)]),
)
def test_what_throttles_one_way_is_an_asymmetry_about_two_other_means(
    longer: float, slower: float, form: tuple[str, float]
) -> None:
    lag, speed = 1.0 + 0.5 * longer, 1.0 - 0.5 * slower
    alone = damped(form[0], longer, slower).coefficients(1.0).valve
    values = (form[1] * 0.5 * longer / lag, form[1] * 0.5 * slower / speed)
    means = {"tau_s": lag * D.tau_s, "rate_limit": speed * D.rate_limit}
    both = damped("two_lags_and_rates_apart", *values, **means).coefficients(1.0).valve
    np.testing.assert_allclose(alone, both, rtol=1e-12)


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["closing_alone", "opening_alone"])
def test_what_is_longer_one_way_alone_accuses_no_time_constant(form: str) -> None:
    found = diagnose([a_record(damped(form, 1.2), seed=3)], D).diagnosis
    assert [cause.name for cause in found.causes] == ["asymmetric_damping"]
    # the same with a throttle of no size says the same
    assert found.causes[0].form in (form, form.replace("alone", "throttled"))
    assert found.causes[0].parameters.get("slower") is None or abs(found.causes[0].parameters["slower"].value) < 0.01
    assert found.causes[0].parameters["longer"].value == pytest.approx(1.2, abs=0.05)


@pytest.mark.thorough
@pytest.mark.parametrize("form", ["closing_throttled", "opening_throttled"])
def test_what_throttles_one_way_alone_accuses_no_rate_limit(form: str) -> None:
    found = diagnose([a_record(damped(form, 0.6, 0.4), seed=3)], D).diagnosis
    assert [(cause.name, cause.form) for cause in found.causes] == [("asymmetric_damping", form)]
    assert found.causes[0].parameters["slower"].value == pytest.approx(0.4, abs=0.03)
